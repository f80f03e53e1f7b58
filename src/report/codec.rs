//! Compact binary data for the 3D view: 16 bit positions, time series as variable-length residuals,
//! base64. The reader of these formats is `templates/viewer.js`.

/// A map from positions within a box to 16 bit integers per axis.
///
/// `q = round((x - origin) / step)`, so that the error of a position inside the box is at most `step / 2`
/// per axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantiser {
    /// Lower corner of the box \[m\].
    pub origin_m: [f64; 3],
    /// Quantisation step per axis \[m\].
    pub step_m: [f64; 3],
}

impl Quantiser {
    /// The quantiser of a box; a box that is flat in some direction gets a step of 1 µm there.
    pub fn of_box(min_m: [f64; 3], max_m: [f64; 3]) -> Self {
        let step_m = std::array::from_fn(|i| ((max_m[i] - min_m[i]) / f64::from(u16::MAX)).max(1e-6));
        Self { origin_m: min_m, step_m }
    }

    /// One coordinate as an integer, clamped to the box.
    pub fn encode(&self, axis: usize, x_m: f64) -> u16 {
        let q = ((x_m - self.origin_m[axis]) / self.step_m[axis]).round();
        q.clamp(0.0, f64::from(u16::MAX)) as u16
    }

    /// The coordinate an integer stands for \[m\]; the viewer does this in the page.
    #[cfg(test)]
    pub fn decode(&self, axis: usize, q: u16) -> f64 {
        self.origin_m[axis] + f64::from(q) * self.step_m[axis]
    }
}

/// Appends an unsigned integer, seven bits a byte, lowest first, high bit: more follow.
pub fn push_varint(out: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        out.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Maps 0, -1, 1, -2, 2 … to 0, 1, 2, 3, 4 ….
pub fn zigzag(value: i32) -> u32 {
    ((value << 1) ^ (value >> 31)) as u32
}

/// Appends a series as residuals of linear extrapolation: a body in free fall or at rest leaves
/// residuals of a few units, one byte each.
pub fn push_series(out: &mut Vec<u8>, values: impl Iterator<Item = u16>) {
    let (mut last, mut before) = (0_i32, 0_i32);
    for (i, value) in values.enumerate() {
        let guess = if i < 2 { last } else { 2 * last - before };
        let value = i32::from(value);
        push_varint(out, zigzag(value - guess));
        (before, last) = (last, value);
    }
}

/// Standard base64 with padding (RFC 4648, section 4).
pub fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().fold(0_u32, |w, &b| w << 8 | u32::from(b)) << (8 * (3 - chunk.len()));
        for k in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * k)) as usize & 63];
            text.push(if k <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_meets_the_test_vectors_of_rfc_4648() {
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn quantisation_error_is_at_most_half_a_step() {
        let q = Quantiser::of_box([-3.0, 0.5, 2.0], [17.0, 0.5, 2.1]);
        for k in 0..=1000 {
            let f = f64::from(k) / 1000.0;
            let p = [-3.0 + 20.0 * f, 0.5, 2.0 + 0.1 * f];
            for (axis, x) in p.into_iter().enumerate() {
                let error = (q.decode(axis, q.encode(axis, x)) - x).abs();
                assert!(error <= 0.5 * q.step_m[axis] * (1.0 + 1e-9), "axis {axis}: {error}");
            }
        }
    }

    #[test]
    fn extrapolation_makes_uniform_motion_one_byte_a_value() {
        let mut out = Vec::new();
        push_series(&mut out, (0..100).map(|i| 1000 + 300 * i));
        // The first two values and the residual after them are not predictable.
        assert_eq!(out.len(), 2 + 2 + 98);
    }
}
