//! Beams in their joints: how much farther a beam bends than to the faces of the columns.
//!
//! The moment of a beam goes on through a joint to the beam behind it. The joint is as high as the beam, and what holds its fibres there is what of a column stands on it or under it: a column under it holds the web, far from the neutral axis, one on it the slab, near to it.
//! In FE models of studies that cannot yield (vertical forces where columns were taken away) the faces of a joint turn against each other by a share of what the beam would over that length (65 joints of 16 studies): 0.51 in the mean with columns on both sides (0.42 to 0.56), 0.62 with one under it (0.48 to 0.73; 0.66 at edges, 0.52 where beams come from all sides), 0.94 with one on it (two joints). With none (two joints) it is 1.1 to 1.2, for moments are at their peak there and flanges narrower: taken as the beam that it is.
//!
//! Half of a joint belongs to each of its beams, also where there is only one.

use super::axes::FloorAxes;
use crate::base::geom::Aabb;
use crate::building::rows::MEETS_M;
use crate::building::tracked::is_charged_or_cut;
use crate::building::{Building, Member, MemberKind};

/// How much a joint bends in comparison with its beams: without a column, with one on it, with one under it, with both.
const SHARES: [f64; 4] = [1.0, 0.95, 0.6, 0.5];
/// A column nearer to the crossing of two axes than this, along both of them, stands there \[m\].
const NEAR_M: f64 = 0.75;

/// The columns that stand on and under the joints of a floor when those that are cut or charged are gone.
#[derive(Debug)]
pub struct BeamJoints {
    on: Vec<Aabb>,
    under: Vec<Aabb>,
}

impl BeamJoints {
    /// Of a floor between two heights.
    pub fn of(building: &Building, [low_m, high_m]: [f64; 2]) -> Self {
        let stands = |m: &&Member| m.kind == MemberKind::Column && !is_charged_or_cut(building, &m.id);
        let columns = building.members.iter().filter(stands);
        let meets = |s: &&Aabb| s.min[2] <= high_m + MEETS_M && s.max[2] >= low_m - MEETS_M;
        let middle_m = 0.5 * (low_m + high_m);
        let (on, under) = columns.map(|m| &m.solid).filter(meets).partition(|s| s.center()[2] > middle_m);
        Self { on, under }
    }

    /// Length over which a beam bends in its half of the joint of a cell, of which the columns on that axis have a width \[m\].
    pub fn half_m(&self, axes: &FloorAxes, cell: [usize; 2], half_width_m: f64) -> f64 {
        let at_m = [0, 1].map(|i| axes.list[i][cell[i]].at_m);
        let is_there = |s: &Aabb| (0..2).all(|i| (s.center()[i] - at_m[i]).abs() < NEAR_M);
        let [on, under] = [&self.on, &self.under].map(|list| usize::from(list.iter().any(is_there)));
        SHARES[on + 2 * under] * half_width_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building::rows::Row;
    use crate::generate::axes::Kind;

    #[test]
    fn columns_on_and_under_a_joint_hold_its_beams() {
        let column = |x: f64, z: [f64; 2]| Aabb { min: [x - 0.2, -0.2, z[0]], max: [x + 0.2, 0.2, z[1]] };
        let joints = BeamJoints {
            on: vec![column(5.0, [3.5, 6.5]), column(10.0, [3.5, 6.5])],
            under: vec![column(10.0, [0.0, 3.0]), column(15.1, [0.0, 3.0])],
        };
        let axis = |at_m: f64| Row { at_m, width_m: 0.4 };
        let list = [[0.0, 5.0, 10.0, 15.0].map(axis).to_vec(), vec![axis(0.0)]];
        let axes = FloorAxes { list, kind: Kind::Columns };
        for (i, share) in SHARES.iter().enumerate().map(|(i, s)| ([0, 1, 3, 2][i], s)) {
            assert_eq!(joints.half_m(&axes, [i, 0], 0.2), 0.2 * share);
        }
    }
}
