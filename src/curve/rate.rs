//! The rate factor of Cowper and Symonds on the strength of what flows in a hinge: `1 + (α̇ / c)^(1/p)` with the rate of plastic rotation `α̇`, or of elongation, and the one at which the strength is doubled.
//!
//! The law of the material has it with the rate of strain (Cowper and Symonds, Brown University Technical Report 28, 1957); a section that turns by `θ` until it is strained by `ε` has it with `c θ / ε`. As there, the rate is that of the plastic
//! flow of the step itself, found together with it (Perzyna, Adv. Appl. Mech. 9 (1966) 243): with the rate of the whole rotation elastic vibrations would strengthen a hinge, and with that of the step before it would swing.

/// A rate factor within a step of known length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Flow in the step at which the strength is doubled \[rad or m\].
    pub doubled: f64,
    /// `p`.
    pub exponent: f64,
}

impl Rate {
    /// The factor at a flow in the step, and its derivative to that; without a derivative at none, where it is infinite.
    #[inline]
    pub fn at(&self, flow: f64) -> [f64; 2] {
        if flow <= 0.0 {
            return [1.0, 0.0];
        }
        let more = libm::pow(flow / self.doubled, 1.0 / self.exponent);
        [1.0 + more, more / (self.exponent * flow)]
    }

    /// That within a share of the step.
    pub fn within(self, share: f64) -> Self {
        Self { doubled: share * self.doubled, ..self }
    }

    /// That of a flow in a direction, by those along two axes.
    pub fn along([a, b]: [Self; 2], direction: [f64; 2]) -> Self {
        let length = libm::hypot(direction[0], direction[1]);
        let slowness = libm::hypot(direction[0] / a.doubled, direction[1] / b.doubled);
        if slowness > 0.0 { Self { doubled: length / slowness, ..a } } else { a }
    }

    /// What is borne after a flow, and its slope, for that at rest.
    #[inline]
    pub fn on(&self, flow: f64, [at_rest, slope]: [f64; 2]) -> [f64; 2] {
        let [factor, growth] = self.at(flow);
        [at_rest * factor, slope * factor + at_rest * growth]
    }
}

/// Change of a force over itself that is rounding.
const SAME: f64 = 1e-12;

/// Whether a force is that of the same pose once more: no time has passed then, in which anything could flow at a rate.
pub fn is_same(before: f64, after: f64) -> bool {
    (after - before).abs() <= SAME * after.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::hinge::AxisLaw;
    use crate::curve::onset::{Search, flow};
    use crate::curve::{
        BeamEnds, CapacityLevel, CapacityTable, Hinge2, MiddleSprings, ResistanceCurve, SpanLoad,
    };

    const CAPACITY_NM: f64 = 2e5;
    /// Rotation of a step, and that at which the strength is doubled.
    const STEP_RAD: f64 = 1e-3;
    const RATE: Rate = Rate { doubled: 0.05, exponent: 5.0 };

    fn table() -> CapacityTable {
        let capacity = vec![[0.0, CAPACITY_NM], [9.0, CAPACITY_NM]];
        let level = CapacityLevel { axial_force_n: 0.0, capacity, fracture_rotation_rad: 9.0 };
        CapacityTable::new(&ResistanceCurve { stiffness_nm_rad: 4e7, levels: vec![level], cyclic: None }, 1.0)
            .unwrap()
    }

    #[test]
    fn a_hinge_in_steady_flow_bears_what_the_rate_says() {
        let own = table();
        let slow = Rate { doubled: 0.2, ..RATE };
        for (turn, rates, rate) in [
            ([1.0, 0.0], [RATE, slow], RATE),
            ([0.0, 1.0], [RATE, slow], slow),
            ([0.6, 0.8], [RATE; 2], RATE),
        ] {
            let mut hinge = Hinge2::default();
            hinge.rates = Some(rates);
            for i in 1..=100 {
                let theta = turn.map(|t| f64::from(i) * STEP_RAD * t);
                hinge.step([AxisLaw::Plastic(&own); 2], theta, 0.0);
            }
            let moment = hinge.moment_nm[0].hypot(hinge.moment_nm[1]);
            let expected = CAPACITY_NM * rate.at(STEP_RAD)[0];
            assert!((moment / expected - 1.0).abs() < 1e-9, "{turn:?}: {moment} {expected}");
        }
    }

    #[test]
    fn the_same_pose_once_more_is_no_time_to_flow_in() {
        let own = table();
        let mut hinge = Hinge2::default();
        hinge.rates = Some([RATE; 2]);
        let turn = |i: u32| [f64::from(i) * STEP_RAD, 0.0];
        for i in 1..=20 {
            hinge.step([AxisLaw::Plastic(&own); 2], turn(i), 0.0);
        }
        let before = hinge;
        let step = hinge.step([AxisLaw::Plastic(&own); 2], turn(20), 0.0);
        assert!(!step.flowing && hinge.moment_nm == before.moment_nm && hinge.alpha_rad == before.alpha_rad);
    }

    #[test]
    fn the_end_of_a_beam_in_steady_flow_bears_what_the_rate_says() {
        let own = table();
        let springs =
            MiddleSprings { turn_nm_rad: 8e6, shear_n_m: 4e6, lever_m: 2.5, load: SpanLoad::default() };
        let mut beam = BeamEnds::default();
        beam.rate = Some(RATE);
        for i in 1..=400 {
            // turned in its middle, so that both ends flow alike
            beam.step(&own, &springs, [2.0 * f64::from(i) * STEP_RAD, 0.0], 0.0);
        }
        let expected = CAPACITY_NM * RATE.at(STEP_RAD)[0];
        for end in beam.ends {
            assert!((end.moment_nm / expected - 1.0).abs() < 1e-9, "{} {expected}", end.moment_nm);
        }
    }

    #[test]
    fn a_flow_solves_its_equation() {
        let hardening = |x: f64| [1e6 + 3e7 * x.min(0.01), if x < 0.01 { 3e7 } else { 0.0 }];
        for doubled in [1e-9, 1e-4, 1.0, 1e4] {
            for trial in [1.0001e6, 1.2e6, 5e7] {
                let rate = Rate { doubled, exponent: 5.0 };
                let from = Search { start: f64::INFINITY, tolerance: 1e-13 * trial };
                let x = flow(trial, 1e9, from, |x| rate.on(x, hardening(x)));
                let excess = trial - 1e9 * x - hardening(x)[0] * rate.at(x)[0];
                assert!(x > 0.0 && excess.abs() < 1e-9 * trial, "{doubled} {trial}: {x} {excess}");
            }
        }
    }
}
