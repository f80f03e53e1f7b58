//! A hinge with cycles about one axis, at rest between steps: peak-oriented loops on a backbone, with the degradation of a [`CyclicRule`].
//!
//! In the elastic range and in unloading the moment changes with the unloading stiffness `K_u`. In loading it is bounded by a branch: from where the
//! moment was last zero a straight line to the point of the largest rotation in this sense on the degraded backbone, then that backbone
//! (Clough and Johnston 1966; Ibarra, Medina and Krawinkler 2005, section 2.2). The line is nowhere steeper than `K_u`.
//!
//! Energy: as in [`super::hinge`] the work of a step is `½ (M₀ + M₁) Δθ`, the elastic energy `½ M² / K_u`, and the rest is
//! dissipated; the sum is exact. `K_u` falls while the moment acts, which turns work into elastic energy: never more of it than the step has, so that no step
//! gives energy away by it. The energy rule acts where the moment is zero, and moves no energy.

use super::cyclic::{Backbone, CyclicRule};
use super::hinge::HingeStep;

/// State of the hinge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CyclicHinge {
    /// Rotation \[rad\].
    pub rotation_rad: f64,
    /// Moment \[N m\].
    pub moment_nm: f64,
    /// Energy dissipated so far \[J\].
    pub dissipated_j: f64,
    /// Strength that is left in the positive and the negative sense, over the backbone.
    pub strength: [f64; 2],
    /// Unloading stiffness over the elastic one.
    pub unloading: f64,
    /// Elastic energy \[J\].
    elastic_j: f64,
    /// The part of `unloading` that energy has left.
    stiffness_left: f64,
    /// Largest rotation in each sense \[rad\].
    reached_rad: [f64; 2],
    /// Sense of the moment, 1 or -1; 0 before the first.
    sense: f64,
    /// Rotation at which the moment was last zero \[rad\].
    zero_rad: f64,
    /// Energy dissipated when it was \[J\].
    zero_j: f64,
}

impl Default for CyclicHinge {
    fn default() -> Self {
        Self {
            rotation_rad: 0.0,
            moment_nm: 0.0,
            dissipated_j: 0.0,
            strength: [1.0; 2],
            unloading: 1.0,
            elastic_j: 0.0,
            stiffness_left: 1.0,
            reached_rad: [0.0; 2],
            sense: 0.0,
            zero_rad: 0.0,
            zero_j: 0.0,
        }
    }
}

fn side(sense: f64) -> usize {
    usize::from(sense < 0.0)
}

impl CyclicHinge {
    /// Advances to a rotation and sets [`Self::moment_nm`].
    pub fn step(&mut self, rule: &CyclicRule, backbone: &impl Backbone, rotation_rad: f64) -> HingeStep {
        let old = *self;
        let way = rotation_rad - old.rotation_rad;
        let mut stiffness = self.unloading * backbone.stiffness_nm_rad();
        if self.sense == 0.0 {
            self.sense = if way < 0.0 { -1.0 } else { 1.0 };
        }
        let mut trial = self.moment_nm + stiffness * way;
        if trial * self.sense < 0.0 {
            self.cross(rule, backbone, self.rotation_rad - self.moment_nm / stiffness);
            stiffness = self.unloading * backbone.stiffness_nm_rad();
            trial = stiffness * (rotation_rad - self.zero_rad);
        }
        let sense = self.sense;
        let bound = self.branch(backbone, sense * rotation_rad, stiffness);
        let flowing = sense * trial > bound;
        self.moment_nm = if flowing { sense * bound } else { trial };
        self.rotation_rad = rotation_rad;
        let reached = &mut self.reached_rad[side(sense)];
        *reached = reached.max(sense * rotation_rad);
        let work = 0.5 * (old.moment_nm + self.moment_nm) * way;
        self.soften(rule, backbone.stiffness_nm_rad(), old.elastic_j + work);
        self.elastic_j =
            0.5 * self.moment_nm * self.moment_nm / (self.unloading * backbone.stiffness_nm_rad());
        self.dissipated_j = old.dissipated_j + work - (self.elastic_j - old.elastic_j);
        HingeStep { elastic_j: self.elastic_j, flowing, ..HingeStep::default() }
    }

    /// The moment passes zero at a rotation: an excursion ends.
    fn cross(&mut self, rule: &CyclicRule, backbone: &impl Backbone, zero_rad: f64) {
        // up to there, the elastic energy is given back
        let dissipated = self.dissipated_j;
        let energy = dissipated - self.zero_j;
        let peak = backbone.peak_nm();
        self.sense = -self.sense;
        self.strength[side(self.sense)] *= rule.left(rule.strength_reference_rad, peak, energy, dissipated);
        if let Some(reference) = rule.unloading_reference_rad {
            let left = rule.left(reference, peak, energy, dissipated).max(LEAST_STIFFNESS);
            self.stiffness_left *= left;
            self.unloading *= left;
        }
        (self.zero_rad, self.zero_j) = (zero_rad, dissipated);
    }

    /// The moment that loading in the present sense cannot exceed, at a rotation counted in that sense \[N m\].
    fn branch(&self, backbone: &impl Backbone, rotation: f64, stiffness: f64) -> f64 {
        let strength = self.strength[side(self.sense)];
        let start = self.sense * self.zero_rad;
        let aim = self.reached_rad[side(self.sense)].max(backbone.elastic_rad());
        let aimed = strength * backbone.moment_nm(aim);
        let way = aim - start;
        let slope = if way * stiffness > aimed { aimed / way } else { stiffness };
        if rotation <= aim {
            return (slope * (rotation - start)).max(0.0);
        }
        let end = (slope * way).max(0.0);
        (end + stiffness * (rotation - aim)).min(strength * backbone.moment_nm(rotation))
    }

    /// Lowers the unloading stiffness with the largest rotation, as far as the energy that is there \[J\] allows.
    fn soften(&mut self, rule: &CyclicRule, stiffness: f64, energy_j: f64) {
        let reached = self.reached_rad[0].max(self.reached_rad[1]);
        let wanted = self.stiffness_left * rule.unloading_share(reached);
        if wanted >= self.unloading {
            return;
        }
        let square = 0.5 * self.moment_nm * self.moment_nm / stiffness;
        let least = if energy_j > 0.0 { square / energy_j } else { self.unloading };
        self.unloading = wanted.max(least).min(self.unloading);
    }
}

/// Share of the elastic stiffness that an excursion leaves at least.
const LEAST_STIFFNESS: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;
    use crate::curve::cyclic_fit::{MeasuredExcursion, fit};
    use crate::curve::{CapacityLevel, LevelBackbone, ResistanceCurve};

    fn curve(capacity: &[[f64; 2]]) -> ResistanceCurve {
        let fracture_rotation_rad = capacity[capacity.len() - 1][0];
        let level = CapacityLevel { axial_force_n: 0.0, capacity: capacity.to_vec(), fracture_rotation_rad };
        ResistanceCurve { stiffness_nm_rad: 1000.0, levels: vec![level], cyclic: None }
    }

    fn rule(reference: f64, unloading_exponent: f64) -> CyclicRule {
        CyclicRule {
            strength_reference_rad: reference,
            unloading_reference_rad: None,
            energy_exponent: 1.0,
            yield_rotation_rad: 0.01,
            unloading_exponent,
            fit: None,
        }
    }

    /// Rotations through turning points in small steps.
    fn path(turns: &[f64], steps: usize) -> Vec<f64> {
        let mut at = 0.0;
        let mut path = Vec::new();
        for turn in turns {
            path.extend((1..=steps).map(|i| at + (turn - at) * i as f64 / steps as f64));
            at = *turn;
        }
        path
    }

    /// Turning points that look random.
    fn wild(count: usize) -> Vec<f64> {
        let mut random = Random::of(1);
        (0..count).map(|_| 0.06 * random.symmetric()).collect()
    }

    #[test]
    fn work_is_elastic_and_dissipated_energy_and_steps_dissipate() {
        let curves = [
            curve(&[[0.0, 10.0], [0.2, 10.0]]),
            curve(&[[0.0, 5.0], [0.01, 9.0], [0.03, 10.0], [0.1, 2.0]]),
            curve(&[[0.0, 10.0], [0.005, 1.0], [0.1, 0.5]]),
        ];
        let mut with_energy = rule(1.0, 1.0);
        with_energy.unloading_reference_rad = Some(2.0);
        for curve in &curves {
            let backbone = LevelBackbone::of(curve, 0.0);
            for rule in [rule(1e6, 0.0), rule(2.0, 0.5), with_energy] {
                let mut hinge = CyclicHinge::default();
                let (mut work, mut before) = (0.0, CyclicHinge::default());
                for rotation in path(&wild(40), 500) {
                    let step = hinge.step(&rule, &backbone, rotation);
                    let way = rotation - before.rotation_rad;
                    work += 0.5 * (before.moment_nm + hinge.moment_nm) * way;
                    let books = step.elastic_j + hinge.dissipated_j;
                    assert!((work - books).abs() < 1e-12 * hinge.dissipated_j.max(1.0), "{work} {books}");
                    // the trapezoid of a step through zero is off by K h² / 8 at most
                    let least = -0.125 * 1000.0 * way * way - 1e-12;
                    assert!(hinge.dissipated_j - before.dissipated_j >= least, "at {rotation}");
                    assert!(hinge.moment_nm.abs() <= backbone.peak_nm() * (1.0 + 1e-12));
                    before = hinge;
                }
                assert!(hinge.dissipated_j > 0.0);
            }
        }
    }

    #[test]
    fn a_peak_oriented_loop_has_the_area_of_its_lines() {
        let curve = curve(&[[0.0, 10.0], [0.2, 10.0]]);
        let backbone = LevelBackbone::of(&curve, 0.0);
        let mut hinge = CyclicHinge::default();
        let mut ends = Vec::new();
        // zero moments: 0.02, -0.02, 0.02
        for turns in [&[0.03, 0.02][..], &[-0.03, -0.02], &[0.03, 0.02]] {
            let from = hinge.rotation_rad;
            let shifted: Vec<f64> = turns.iter().map(|t| t - from).collect();
            for rotation in path(&shifted, 20_000) {
                hinge.step(&rule(1e9, 0.0), &backbone, from + rotation);
            }
            ends.push(hinge.dissipated_j);
        }
        let energies = [ends[0], ends[1] - ends[0], ends[2] - ends[1]];
        // 0.02 × 10; half of 0.03 × 10, 0.02 × 10, less 10² / 2000; half of 0.05 × 10, less 10² / 2000
        for (found, wanted) in energies.iter().zip([0.2, 0.3, 0.2]) {
            assert!((found - wanted).abs() < 1e-4, "{energies:?}");
        }
    }

    #[test]
    fn a_hinge_that_is_only_pushed_follows_the_backbone() {
        let curve = curve(&[[0.0, 5.0], [0.01, 9.0], [0.03, 10.0], [0.1, 2.0]]);
        let backbone = LevelBackbone::of(&curve, 0.0);
        for sense in [1.0, -1.0] {
            let mut hinge = CyclicHinge::default();
            for rotation in path(&[sense * 0.12], 1000) {
                hinge.step(&rule(1.0, 0.5), &backbone, rotation);
                let wanted = sense * backbone.moment_nm(rotation.abs());
                assert!((hinge.moment_nm - wanted).abs() < 1e-9, "{rotation} {}", hinge.moment_nm);
            }
        }
    }

    #[test]
    fn the_rule_that_made_the_loops_is_found_again() {
        let curve = curve(&[[0.0, 10.0], [0.2, 10.0]]);
        let backbone = LevelBackbone::of(&curve, 0.0);
        let made = rule(0.5, 0.4);
        let turns: Vec<f64> = [0.02, 0.03, 0.04].iter().flat_map(|a| [*a, -a, *a, -a]).collect();
        let mut hinge = CyclicHinge::default();
        let (mut excursions, mut zero_j, mut top) = (Vec::new(), 0.0, CyclicHinge::default());
        let mut before = hinge;
        for rotation in path(&turns, 4000) {
            hinge.step(&made, &backbone, rotation);
            if hinge.moment_nm * before.moment_nm < 0.0 {
                excursions.push(MeasuredExcursion {
                    sense: before.moment_nm.signum(),
                    rotation_rad: top.rotation_rad,
                    moment_nm: top.moment_nm,
                    energy_j: before.dissipated_j - zero_j,
                    unloading_nm_rad: Some(before.unloading * 1000.0),
                });
                (zero_j, top) = (before.dissipated_j, hinge);
            }
            if hinge.moment_nm * rotation > 0.0 && rotation.abs() >= top.rotation_rad.abs()
                || top.moment_nm * hinge.moment_nm <= 0.0
            {
                top = hinge;
            }
            before = hinge;
        }
        assert_eq!(excursions.len(), turns.len() - 1);
        let found = fit(&excursions, &backbone, 0.01, 0.0).unwrap();
        assert!((found.strength_reference_rad / made.strength_reference_rad - 1.0).abs() < 0.03, "{found:?}");
        assert!((found.unloading_exponent - 0.4).abs() < 0.01, "{found:?}");
        let fit = found.fit.unwrap();
        assert!(fit.strength_residual < 0.01 && fit.lowest_strength < 0.9, "{fit:?}");
    }

    #[test]
    fn curves_without_a_rule_are_read_and_come_back() {
        let plain = r#"{"stiffness_nm_rad":1000.0,"levels":[{"axial_force_n":0.0,"capacity":[[0.0,10.0],[0.1,10.0],[0.2,0.0]],"fracture_rotation_rad":0.2}]}"#;
        let mut curve: ResistanceCurve = serde_json::from_str(plain).unwrap();
        assert_eq!(curve.cyclic, None);
        assert_eq!(serde_json::to_string(&curve).unwrap(), plain);
        curve.cyclic = Some(rule(1.5, 0.4));
        let text = serde_json::to_string(&curve).unwrap();
        assert_eq!(serde_json::from_str::<ResistanceCurve>(&text).unwrap(), curve);
        let mut wrong = curve.clone();
        wrong.cyclic = Some(rule(-1.0, 0.4));
        assert!(wrong.check().unwrap_err().to_string().contains("strength_reference_rad is -1"));
        let between = curve.between(&curve, 0.5).unwrap();
        assert_eq!(between.cyclic, curve.cyclic);
    }
}
