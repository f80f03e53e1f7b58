//! Beams whose slab ends at an edge of the floor: there the flange bears nothing yet.
//!
//! The force in a flange comes in by shear along the beam. Over a wave of moments of half-wave `l` a share `η` of the slab beside the beam acts ([`super::idealise`]); a flange that slips by the same shear
//! stiffness (Newmark, Siess and Viest, Proc. Soc. Exp. Stress Anal. 9 (1951) 75) has `η = α² / (α² + π²/l²)`. Under moments `M` that change linearly its force is that of the beam far from any edge, less
//! `M_edge e^{-α d} / (1 + tanh(α r))` over the moment, with `d` from the face of the column, and the slab that goes on beyond it by `r` without a moment to bear: what it bears less bends the beam more,
//!
//! ```text
//! E κ = M / I_flange + (1 / I_apart - 1 / I_flange) M_edge e^{-α d} / (1 + tanh(α r))
//! ```
//!
//! Where a column at an edge is gone and the floors above it act as a frame, moments are largest just there; where it held up the only floor, they are zero there.

use super::frame::BeamSection;
use std::f64::consts::PI;

/// A stretch of a beam between the faces of its columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Length between the faces \[m\].
    pub span_m: f64,
    /// Its ends \[m\].
    pub ends_m: [f64; 2],
    /// How far the slab goes on beyond an end where it ends there, with nothing beyond \[m\].
    pub beyond_m: [Option<f64>; 2],
}

/// Bending stiffness of a stretch against rotation and against displacement across \[N m²\], both of them that of a prismatic beam with the same springs in its middle.
///
/// Moments of one sense over a whole span are those of a longer wave than opposite ones at both ends, so that more of the slab acts against rotation.
/// A beam that is softer at one end has its centre of flexibility nearer to that end, which springs in the middle cannot tell: with one edge they are right for opposite moments at both ends of a whole span and for none at
/// the edge; for a part of a span in the mean of both.
pub fn bending_n_m2(section: &BeamSection, stretch: &Stretch) -> [f64; 2] {
    let e = section.youngs_modulus_pa;
    let with = section.inertia_m4[0];
    let length_m = stretch.ends_m[1] - stretch.ends_m[0];
    let edges = stretch.beyond_m.iter().flatten().count();
    let is_span = length_m >= stretch.span_m;
    let Some(flange) = section.flange.filter(|f| length_m > 0.0 && f.apart_m4 < with) else {
        return [e * with; 2];
    };
    let one_sense = if is_span { flange.long_m4 } else { with };
    let slip = 1.0 / flange.apart_m4 - 1.0 / with;
    let acts = slip / (1.0 / flange.apart_m4 - 1.0 / flange.whole_m4);
    // a slab that acts as a whole has no shear lag
    if edges == 0 || acts >= 1.0 {
        return [e * one_sense, e * with];
    }
    let rate = PI / stretch.span_m * (acts / (1.0 - acts)).sqrt();
    // moments of e^{-α d} over the stretch, which begins at the edge and has length one
    let z = rate * length_m;
    let end = libm::exp(-z);
    let zeroth = (1.0 - end) / z;
    let first = (1.0 - end * (1.0 + z)) / (z * z);
    let (mut turn, mut across) = (1.0, 1.0);
    for beyond in stretch.beyond_m.iter().flatten() {
        let more = slip * with / (1.0 + libm::tanh(rate * beyond));
        turn += more * zeroth;
        // M = 1 - 2 x, three times its integral
        across += 3.0 * more * (zeroth - 2.0 * first);
    }
    if edges == 1 && is_span {
        // M = x bends as a prismatic beam under moments of one sense: turn / 4 + across / 12 = 1 / 3 of its flexibility
        turn = (4.0 * with / one_sense - across) / 3.0;
    }
    [e * with / turn, e * with / across]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::frame::Flange;

    fn section() -> BeamSection {
        let mut section = BeamSection::rectangle(16.5e9, 0.2, [0.45, 0.6]);
        let own = section.inertia_m4[0];
        section.inertia_m4[0] = 1.8 * own;
        section.flange = Some(Flange { apart_m4: 1.05 * own, whole_m4: 2.2 * own, long_m4: 1.8 * own });
        section
    }

    /// One over the second moments of area apart and with the flange, and `α l / π`.
    fn flexibilities(section: &BeamSection) -> ([f64; 2], f64) {
        let flange = section.flange.unwrap();
        let [apart, with, whole] = [flange.apart_m4, section.inertia_m4[0], flange.whole_m4].map(|i| 1.0 / i);
        let acts = (apart - with) / (apart - whole);
        ([apart, with], (acts / (1.0 - acts)).sqrt())
    }

    fn stretch(beyond_m: [Option<f64>; 2]) -> Stretch {
        Stretch { span_m: 5.0, ends_m: [1.0, 6.0], beyond_m }
    }

    #[test]
    fn a_floor_that_goes_on_is_the_prismatic_beam() {
        let section = section();
        let plain = section.youngs_modulus_pa * section.inertia_m4[0];
        assert_eq!(bending_n_m2(&section, &stretch([None; 2])), [plain; 2]);
        let without = BeamSection { flange: None, ..section };
        assert_eq!(bending_n_m2(&without, &stretch([Some(0.2); 2])), [plain; 2]);
    }

    /// A span with moments of one sense has more of the slab, also where one of its ends is an edge at which there is no moment.
    #[test]
    fn flanges_are_wider_under_moments_of_one_sense() {
        let mut section = section();
        let flange = section.flange.unwrap();
        let with = section.inertia_m4[0];
        let long_m4 = 1.1 * with;
        section.flange = Some(Flange { long_m4, ..flange });
        let e = section.youngs_modulus_pa;
        assert_eq!(bending_n_m2(&section, &stretch([None; 2])), [e * long_m4, e * with]);
        let [turn, across] = bending_n_m2(&section, &stretch([Some(0.3), None])).map(|k| e * long_m4 / k);
        assert!((0.75 * turn + 0.25 * across - 1.0).abs() < 1e-12, "{turn} {across}");
        // a part of a span does not tell
        let part = Stretch { span_m: 10.0, ..stretch([None; 2]) };
        assert_eq!(bending_n_m2(&section, &part), [e * with; 2]);
    }

    /// Two edges at the faces: Newmark's beam has `N ∝ 1 - cosh(α s) / cosh(α l / 2)` under a constant moment.
    #[test]
    fn slabs_that_end_at_the_faces_are_newmarks_beam() {
        let section = section();
        let ([apart, with], waves) = flexibilities(&section);
        let z = 0.5 * PI * waves;
        let [turn, across] = bending_n_m2(&section, &stretch([Some(0.0); 2]));
        let e = section.youngs_modulus_pa;
        // in units of what the flange takes where it acts in full
        let lost = |found: f64| (e / found - with) / (apart - with);
        let newmark = z.tanh() / z;
        assert!((lost(turn) / newmark - 1.0).abs() < 0.02, "{} {newmark}", lost(turn));
        // under opposite moments: 1 - 3 ∫ s (s - sinh(z s) / sinh z), s from -1 to 1
        let newmark = 3.0 * (z / z.tanh() - 1.0) / (z * z);
        assert!((lost(across) / newmark - 1.0).abs() < 0.02, "{} {newmark}", lost(across));
    }

    /// Curvatures integrated numerically against the moments.
    #[test]
    fn one_edge_is_exact_for_opposite_moments_and_for_none_at_the_edge() {
        let section = section();
        let ([apart, with], waves) = flexibilities(&section);
        let rate = PI / 5.0 * waves;
        let share = 1.0 / (1.0 + (rate * 0.3).tanh());
        let integral = |moment: &dyn Fn(f64) -> f64| -> f64 {
            let n = 20_000;
            let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n);
            let curvature =
                |x: f64| with * moment(x) + (apart - with) * share * moment(0.0) * (-rate * 5.0 * x).exp();
            (0..n).map(|i| moment(at(i)) * curvature(at(i)) / f64::from(n)).sum()
        };
        let e = section.youngs_modulus_pa;
        let [turn, across] = bending_n_m2(&section, &stretch([Some(0.3), None])).map(|k| e / k);
        let opposite = 3.0 * integral(&|x| 1.0 - 2.0 * x);
        assert!((across / opposite - 1.0).abs() < 1e-6, "{across} {opposite}");
        let none_at_the_edge = integral(&|x| x);
        let found = turn / 4.0 + across / 12.0;
        assert!((found / none_at_the_edge - 1.0).abs() < 1e-6, "{found} {none_at_the_edge}");
        // the other way round it is the same
        let mirrored = bending_n_m2(&section, &stretch([None, Some(0.3)]));
        assert!((mirrored[0] * turn / e - 1.0).abs() < 1e-12);
    }
}
