//! Random numbers that are the same everywhere.

/// A linear congruential generator (constants of Knuth's MMIX; TAOCP 2, 3.3.4).
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// A sequence of its own for every seed.
    pub fn of(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03);
        (0..4).for_each(|_| _ = random.share());
        random
    }

    /// The sequence after a state of the generator.
    pub const fn after(state: u64) -> Self {
        Self(state)
    }

    /// The next number from 0 to 1, 1 excluded.
    pub fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// The next number from -1 to 1, 1 excluded.
    pub fn symmetric(&mut self) -> f64 {
        2.0 * self.share() - 1.0
    }

    /// Between two numbers.
    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.share()
    }

    /// Between two numbers, even over decades.
    pub fn decades(&mut self, a: f64, b: f64) -> f64 {
        a * libm::pow(b / a, self.share())
    }

    /// An integer below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.share() * n as f64) as usize).min(n - 1)
    }

    /// True with a probability.
    pub fn is(&mut self, probability: f64) -> bool {
        self.share() < probability
    }
}
