//! Slabs that twist bend no beams.
//!
//! A panel that loses a corner is twisted, `w = c x y`. What a slab bears of that are twisting moments `m_xy` all along its edges, and these are four forces `2 m_xy` at its corners: a square plate bears them by itself (Timoshenko and Woinowsky-Krieger, Theory of Plates
//! and Shells, 1959, articles 11 and 22), and beams along its edges stay straight. In a floor of pieces about its columns the twist of the slab is in torsion springs between these, whose torque comes in at the joints only, by moments at the ends of the beams across: these bend as
//! `M = ± k L² / 2` against an equal rotation of both ends (`k` against displacement across in the middle, `L` from axis to axis), in series with the slab. That makes a panel with slender beams up to a fifth too soft.
//!
//! With `r` the stiffness of both joints of a cut, one after the other, `a` and `b` of its slab and of its beams against twist, the panel has `a + b r / (b + r)`: the torque of a beam does come in at the joints. So its spring is what gives that in series with `r`.

use super::crossing::Cut;
use std::collections::BTreeMap;

/// Most by which a spring becomes stiffer: beams that are softer than their slab hold no joint.
const MOST: f64 = 3.0;

/// Lets the slabs of the cuts through a floor twist without its joints, and beams with what slabs on them add ([`super::junction`]).
pub fn without_joints(cuts: &mut [Cut]) {
    for cut in cuts.iter_mut() {
        cut.sum.torsion += cut.sum.junctions;
    }
    // against rotation about x and y, of the joint of a piece
    let mut held: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for cut in cuts.iter() {
        let [_, across] = cut.in_the_middle();
        let span_m = cut.axes_m[1] - cut.axes_m[0];
        for piece in cut.pieces {
            *held.entry((1 - cut.axis, piece)).or_default() += 0.5 * across * span_m * span_m;
        }
    }
    for cut in cuts {
        let joints = cut.pieces.map(|p| held.get(&(cut.axis, p)).copied().unwrap_or(0.0));
        if joints.iter().all(|j| *j > 0.0) {
            let joints = 1.0 / (1.0 / joints[0] + 1.0 / joints[1]);
            let slab = cut.sum.slab_torsion / cut.length_m;
            let beams = cut.sum.torsion / cut.length_m - slab;
            cut.sum.torsion = spring(slab, beams, joints) * cut.length_m;
        }
    }
}

/// The spring that, in series with joints, twists as a slab beside them and beams between them \[N m/rad\].
fn spring(slab: f64, beams: f64, joints: f64) -> f64 {
    let wanted = slab + beams * joints / (beams + joints);
    let most = MOST * (slab + beams);
    if wanted < joints { (wanted * joints / (joints - wanted)).min(most) } else { most }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_give_way_to_beams_only() {
        let series = |a: f64, b: f64| a * b / (a + b);
        for (slab, beams, joints) in [(3.0, 1.0, 20.0), (1.0, 0.0, 5.0), (0.0, 2.0, 7.0)] {
            let found = series(spring(slab, beams, joints), joints);
            assert!((found - slab - series(beams, joints)).abs() < 1e-12, "{found}");
        }
        // a beam by itself is what it was, and no spring is more than three times as stiff
        assert!((spring(0.0, 2.0, 7.0) - 2.0).abs() < 1e-12);
        assert_eq!(spring(2.0, 1.0, 1.0), 9.0);
    }
}
