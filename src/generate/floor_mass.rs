//! The inertia of a floor that bends, between the pieces that it is cut into.
//!
//! The mass between the axes of columns moves as the floor bends: along x and along y by the cubic of a beam whose ends move with the pieces, and by the product of both in a panel. Where all four pieces about a
//! panel move as one rigid body, so does the mass.

use super::axes::FloorAxes;
use super::bodies::Bodies;
use super::cells::{Piece, by_cell};
use crate::base::geom::Aabb;
use crate::building::Building;
use crate::building::rows::Row;
use crate::mbs::model::{MassBlock, SharedMass};
use std::collections::BTreeMap;

/// Size of the parts that the mass is taken in \[m\].
const PART_M: f64 = 0.5;

/// Displacement and slope of an axis, as they move a place between it and the next one.
type Share = (usize, [f64; 2]);

/// Motion of a piece: its place in the list, and what its velocity along z and its angular velocities about x and y do to the velocity along z somewhere.
type Motion = (usize, [f64; 3]);

/// What the pieces of a floor, whose bodies begin at some place in the list, have together beside what each has alone.
pub fn shared(
    building: &Building,
    axes: &FloorAxes,
    pieces: &[Piece],
    (bodies, first): (&Bodies, usize),
) -> SharedMass {
    let places = by_cell(pieces);
    let centre = |p: usize| bodies.list[first + p].position_m;
    let mut sum = Sum::default();
    for (own, piece) in pieces.iter().enumerate() {
        for (member, solid) in &piece.boxes {
            let density = building.law_of(&building.members[*member]).density_kg_m3;
            for (at, volume) in parts(solid) {
                let together = moved(axes, &places, at, &centre).filter(|list| list.len() > 1);
                let Some(together) = together else { continue };
                let [x, y, _] = centre(own);
                sum.add(&[(own, [1.0, at[1] - y, x - at[0]])], -density * volume);
                sum.add(&together, density * volume);
            }
        }
    }
    SharedMass {
        bodies: (0..pieces.len()).map(|p| bodies.list[first + p].id.clone()).collect(),
        blocks: sum.0.into_iter().map(|(pair, added)| MassBlock { pair, added }).collect(),
    }
}

/// The parts of a solid in plan: middle \[m\] and volume \[m³\].
fn parts(solid: &Aabb) -> Vec<([f64; 2], f64)> {
    let size = solid.size();
    let counts = [0, 1].map(|i| (size[i] / PART_M).ceil().max(1.0));
    let volume = size[0] * size[1] * size[2] / (counts[0] * counts[1]);
    let middle = |i: usize, k: usize| solid.min[i] + (k as f64 + 0.5) * size[i] / counts[i];
    let row = |i: usize| (0..counts[1] as usize).map(move |j| ([middle(0, i), middle(1, j)], volume));
    (0..counts[0] as usize).flat_map(row).collect()
}

/// Blocks of a matrix of inertia by pairs of pieces.
#[derive(Default)]
struct Sum(BTreeMap<[usize; 2], [[f64; 3]; 3]>);

impl Sum {
    /// Adds a mass that moves with pieces, which are in order.
    fn add(&mut self, moved: &[Motion], mass: f64) {
        for (k, (a, u)) in moved.iter().enumerate() {
            for (b, v) in &moved[k..] {
                let block = self.0.entry([*a, *b]).or_default();
                for (row, u) in block.iter_mut().zip(u) {
                    row.iter_mut().zip(v).for_each(|(x, v)| *x += mass * (u * v));
                }
            }
        }
    }
}

/// Vertical velocity of a place over the velocities of pieces, in the order of the pieces; nothing where a piece that it needs is missing.
fn moved(
    axes: &FloorAxes,
    places: &BTreeMap<[usize; 2], usize>,
    at: [f64; 2],
    centre: &impl Fn(usize) -> [f64; 3],
) -> Option<Vec<Motion>> {
    let [along_x, along_y] = [0, 1].map(|i| shares(&axes.list[i], at[i]));
    let mut list = Vec::new();
    for (i, [w_x, s_x]) in &along_x {
        for (j, [w_y, s_y]) in &along_y {
            let piece = *places.get(&[*i, *j])?;
            let [x, y, _] = centre(piece);
            let [x, y] = [axes.list[0][*i].at_m - x, axes.list[1][*j].at_m - y];
            // w = v + ω_x y - ω_y x there, slopes -ω_y and ω_x
            let w = w_x * w_y;
            list.push((piece, [w, w * y + w_x * s_y, -w * x - s_x * w_y]));
        }
    }
    list.sort_by_key(|(piece, _)| *piece);
    Some(list)
}

/// What the axes on both sides of a place do to it: rigidly with an axis up to the faces of its columns and beyond the last one, by the cubic of a clamped beam between faces.
fn shares(axes: &[Row], at_m: f64) -> Vec<Share> {
    let after = axes.partition_point(|a| a.at_m <= at_m);
    let rigid = |k: usize| vec![(k, [1.0, at_m - axes[k].at_m])];
    if after == 0 {
        return rigid(0);
    }
    if after == axes.len() {
        return rigid(after - 1);
    }
    let [low, high] = [axes[after - 1], axes[after]];
    let [start, end] = [0.5 * low.width_m, -0.5 * high.width_m];
    let length = high.at_m + end - low.at_m - start;
    let x = (at_m - low.at_m - start) / length;
    if length <= 0.0 || x <= 0.0 || x >= 1.0 {
        return rigid(if x <= 0.0 { after - 1 } else { after });
    }
    let (x2, x3) = (x * x, x * x * x);
    let [w_low, s_low] = [1.0 - 3.0 * x2 + 2.0 * x3, length * (x - 2.0 * x2 + x3)];
    let [w_high, s_high] = [3.0 * x2 - 2.0 * x3, length * (x3 - x2)];
    vec![(after - 1, [w_low, w_low * start + s_low]), (after, [w_high, w_high * end + s_high])]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The entries of the consistent mass matrix of a beam between faces, which the axes move rigidly (Przemieniecki 1968, eq. 11.17).
    #[test]
    fn mass_between_axes_moves_as_a_clamped_beam() {
        let axes = [Row { at_m: 1.0, width_m: 0.4 }, Row { at_m: 7.0, width_m: 0.6 }];
        let (start, length) = (1.2, 5.5);
        let n = 4000;
        let mut sums = [[0.0; 4]; 4];
        for i in 0..n {
            let at = start + (f64::from(i) + 0.5) * length / f64::from(n);
            let [(_, [w_low, s_low]), (_, [w_high, s_high])] = shares(&axes, at)[..] else { panic!("{at}") };
            // slopes about the faces instead of the axes
            let moved = [w_low, s_low - 0.2 * w_low, w_high, s_high + 0.3 * w_high];
            for (row, u) in sums.iter_mut().zip(moved) {
                row.iter_mut().zip(moved).for_each(|(x, v)| *x += u * v / f64::from(n));
            }
        }
        let l = length;
        let wanted = [
            [156.0, 22.0 * l, 54.0, -13.0 * l],
            [22.0 * l, 4.0 * l * l, 13.0 * l, -3.0 * l * l],
            [54.0, 13.0 * l, 156.0, -22.0 * l],
            [-13.0 * l, -3.0 * l * l, -22.0 * l, 4.0 * l * l],
        ];
        for (row, wanted) in sums.iter().zip(wanted) {
            for (found, wanted) in row.iter().zip(wanted) {
                assert!((420.0 * found - wanted).abs() < 1e-3, "{found} {wanted}");
            }
        }
    }

    #[test]
    fn axes_move_their_columns_and_what_is_beyond_them_rigidly() {
        let axes = [Row { at_m: 1.0, width_m: 0.4 }, Row { at_m: 7.0, width_m: 0.6 }];
        for (at, axis) in [(0.5, 0), (1.0, 0), (1.15, 0), (6.8, 1), (7.4, 1)] {
            let moved = shares(&axes, at);
            assert_eq!(moved.len(), 1, "{at}");
            assert!(moved[0].0 == axis && moved[0].1 == [1.0, at - axes[axis].at_m], "{at}: {moved:?}");
        }
        // a rigid motion of both is one of all between them
        for at in [1.3, 2.0, 4.0, 6.5] {
            let [w, s] = shares(&axes, at)
                .iter()
                .fold([0.0; 2], |[w, s], (k, [own, slope])| [w + own, s + own * axes[*k].at_m + slope]);
            assert!((w - 1.0).abs() < 1e-12 && (s - at).abs() < 1e-12, "{at}: {w} {s}");
        }
    }
}
