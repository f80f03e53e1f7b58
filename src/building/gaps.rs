//! Gaps that are narrower than any joint: slips of the input.
//!
//! Members touch where their faces are one plane to within [`COORDINATE_TOLERANCE_M`], which is what decimal fractions differ by once they are added. The mesh
//! joins them up to [`LEAST_GAP_M`], where faces become one plane anyway; load paths and multibody models do not. Between the two the same file would be two
//! structures, and it is refused. Wider gaps are joints of the building, and a mesh that would close one is refused later (`fe::weld`).

use super::check::MAX_REPORTED;
use super::fields::Placed;
use super::model::{Member, Preparation};
use super::partition::COORDINATE_TOLERANCE_M;
use super::read::Draft;
use super::soffits::{LEAST_OPEN, missing};
use crate::base::boxes::Boxes;
use crate::base::diagnostic::{Diagnostic, quoted};
use crate::base::geom::Aabb;
use crate::base::units::round_to_digits;

/// Gaps up to this are none that a building has, and the mesh closes them \[m\].
pub const LEAST_GAP_M: f64 = 1e-3;
/// How far beyond a face its neighbour is looked for \[m\]: more than touching faces differ by, less than the narrowest gap.
pub const JUST_BEYOND_M: f64 = 0.1 * LEAST_GAP_M;

/// Boxes of the solid of a member that is not turned, without its openings \[m\].
pub fn solids(member: &Member) -> Vec<Aabb> {
    let mut boxes = vec![member.solid];
    for opening in &member.openings {
        boxes = boxes.iter().flat_map(|solid| without(*solid, opening)).collect();
    }
    boxes
}

/// What is left of a box outside of another one.
fn without(mut solid: Aabb, hole: &Aabb) -> Vec<Aabb> {
    if solid.intersection(hole, COORDINATE_TOLERANCE_M).is_none() {
        return vec![solid];
    }
    let mut left = Vec::new();
    for i in 0..3 {
        if hole.min[i] > solid.min[i] + COORDINATE_TOLERANCE_M {
            let mut below = solid;
            below.max[i] = hole.min[i];
            solid.min[i] = hole.min[i];
            left.push(below);
        }
        if hole.max[i] < solid.max[i] - COORDINATE_TOLERANCE_M {
            let mut above = solid;
            above.min[i] = hole.max[i];
            solid.max[i] = hole.max[i];
            left.push(above);
        }
    }
    left
}

/// Axis along which two boxes are farthest apart, and how far \[m\].
pub fn gap(a: &Aabb, b: &Aabb) -> (usize, f64) {
    let along = |i: usize| (a.min[i] - b.max[i]).max(b.min[i] - a.max[i]);
    let axis = (0..3).max_by(|i, j| along(*i).total_cmp(&along(*j))).unwrap_or(0);
    (axis, along(axis))
}

/// Refuses members that face each other across less than [`LEAST_GAP_M`] and touch nowhere, but for gaps that others fill, as a column does between beams.
pub fn check(draft: &Draft, found: &mut Vec<Diagnostic>) {
    let is_cut = |id: &str| {
        draft.preparation.iter().any(|p| matches!(&p.item, Preparation::Cut { member } if member == id))
    };
    let there = draft.members.list.iter().filter(|m| !m.item.is_skew() && !is_cut(&m.item.id));
    let there: Vec<&Placed<Member>> = there.collect();
    let boxes: Vec<Vec<Aabb>> = there.iter().map(|m| solids(&m.item)).collect();
    let places = Boxes::of(there.iter().map(|m| m.item.solid));
    let mut reported = 0;
    for (a, member) in there.iter().enumerate() {
        let near = places.near(&member.item.solid, LEAST_GAP_M + COORDINATE_TOLERANCE_M);
        for b in near.into_iter().filter(|b| *b > a) {
            let Some((axis, between)) = narrow(&boxes[a], &boxes[b]) else { continue };
            let third = |i: &usize| *i != a && *i != b;
            let others = places.near(&between, 0.0).into_iter().filter(third);
            let others: Vec<&Member> = others.map(|i| &there[i].item).collect();
            if missing(&between, &others) <= LEAST_OPEN * between.volume() {
                continue;
            }
            reported += 1;
            if reported > MAX_REPORTED {
                return;
            }
            found.push(told(there[a], there[b], axis, &between));
        }
    }
}

/// The gap between two members that face each other and touch nowhere, with its axis.
fn narrow(a: &[Aabb], b: &[Aabb]) -> Option<(usize, Aabb)> {
    let mut widest: Option<(usize, Aabb)> = None;
    for (p, q) in a.iter().flat_map(|p| b.iter().map(move |q| (p, q))) {
        let (axis, gap_m) = gap(p, q);
        if gap_m <= COORDINATE_TOLERANCE_M {
            return None;
        }
        let (mut low, mut high) = (p.max, q.min);
        for i in 0..3 {
            (low[i], high[i]) = match i == axis {
                true => (p.max[i].min(q.max[i]), p.min[i].max(q.min[i])),
                false => (p.min[i].max(q.min[i]), p.max[i].min(q.max[i])),
            };
        }
        let between = Aabb { min: low, max: high };
        let faces = (0..3).all(|i| i == axis || high[i] - low[i] > COORDINATE_TOLERANCE_M);
        let is_larger = widest.is_none_or(|(_, old)| old.volume() < between.volume());
        if faces && gap_m < LEAST_GAP_M + COORDINATE_TOLERANCE_M && is_larger {
            widest = Some((axis, between));
        }
    }
    widest
}

/// The smaller of the two members is the one to change.
fn told(a: &Placed<Member>, b: &Placed<Member>, axis: usize, between: &Aabb) -> Diagnostic {
    let [small, large] = if a.item.solid.volume() <= b.item.solid.volume() { [a, b] } else { [b, a] };
    let is_below = small.item.solid.center()[axis] < large.item.solid.center()[axis];
    let [own_m, other_m] = match is_below {
        true => [between.min[axis], between.max[axis]],
        false => [between.max[axis], between.min[axis]],
    };
    let metres = |at_m: f64| round_to_digits(at_m, 9);
    let (letter, gap_mm) = (['x', 'y', 'z'][axis], round_to_digits(1e3 * between.size()[axis], 3));
    let [x, y, z] = between.center().map(|c| format!("{c:.3}"));
    let name = |m: &Placed<Member>| format!("the {} {}", m.item.kind.name(), quoted(&m.item.id));
    let message = format!(
        "{} and {} are {gap_mm} mm apart, at ({x}, {y}, {z}) m, where they should touch",
        name(small),
        name(large)
    );
    let label = format!("its face is at {letter} = {} m", metres(own_m));
    let mut error = Diagnostic::error("narrow-gap", message).at(small.span, label);
    if small.span != large.span {
        error = error.also(large.span, "the other member");
    }
    error.help(format!(
        "end {} at {letter} = {} m, or leave more than {} mm between them: the mesh closes what is narrower, the multibody model does not",
        quoted(&small.item.id),
        metres(other_m),
        1e3 * LEAST_GAP_M
    ))
}
