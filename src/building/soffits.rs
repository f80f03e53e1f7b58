//! Columns that end below the beams on them: what lies above is the joint's, and of a joint that no member fills weight and stiffness are missing.
//!
//! Plans often give clear heights, up to the soffit of the beams. A building file wants columns up to the top of the joint: where solids
//! overlap, a beam comes before a column, and a column has what is left between the beams.

use super::fields::Placed;
use super::model::{Member, MemberKind};
use super::partition::COORDINATE_TOLERANCE_M;
use crate::base::boxes::Boxes;
use crate::base::diagnostic::{Diagnostic, quoted};
use crate::base::geom::Aabb;
use crate::base::units::{Dimension, round_to_digits, show};

/// Least share of a joint, or of a gap, without a member that is told.
pub(super) const LEAST_OPEN: f64 = 1e-3;

/// A column with a joint that is not filled.
struct Open<'a> {
    column: &'a Placed<Member>,
    /// Level of the top of the joint \[m\].
    top_m: f64,
    /// Volume of the joint in no member \[m³\].
    missing_m3: f64,
}

/// Warns of columns whose joints with the beams on them are not filled, all in one.
pub fn check(members: &[Placed<Member>], found: &mut Vec<Diagnostic>) {
    let near = Boxes::of(members.iter().map(|m| m.item.bounds()));
    let open: Vec<Open> = members.iter().filter_map(|column| open(column, members, &near)).collect();
    let Some(first) = open.first() else { return };
    let ids: Vec<&str> = open.iter().map(|o| o.column.item.id.as_str()).collect();
    let volume = round_to_digits(open.iter().map(|o| o.missing_m3).sum(), 3);
    let message = match ids.as_slice() {
        [one] => format!(
            "the column {} ends below the beams on it, and of the joint above it {volume} m3 belong to no member",
            quoted(one)
        ),
        more => format!(
            "{} columns end below the beams on them, and of the joints above them {volume} m3 belong to no member",
            more.len()
        ),
    };
    let [own, top] =
        [first.column.item.solid.max[2], first.top_m].map(|z| show(round_to_digits(z, 6), Dimension::Length));
    let help =
        format!("let columns end at the top of their beams, {} at {top} in place of {own}", quoted(ids[0]));
    found.push(
        Diagnostic::warning("open-joint", message)
            .at(first.column.span, super::check::some_of(&ids))
            .help(help),
    );
}

/// The joint over a column, if beams begin at or below its top and go on above it, and something is missing there.
fn open<'a>(column: &'a Placed<Member>, members: &'a [Placed<Member>], near: &Boxes) -> Option<Open<'a>> {
    let own = &column.item;
    if own.kind != MemberKind::Column || own.is_skew() {
        return None;
    }
    let around = |solid: &Aabb| -> Vec<&'a Member> {
        near.near(solid, COORDINATE_TOLERANCE_M).into_iter().map(|i| &members[i].item).collect()
    };
    let level = own.solid.max[2];
    let is_on = |b: &&&Member| {
        let solid = &b.solid;
        b.kind == MemberKind::Beam
            && (0..2).all(|i| {
                solid.max[i].min(own.solid.max[i]) - solid.min[i].max(own.solid.min[i])
                    > COORDINATE_TOLERANCE_M
            })
            && solid.min[2] < level + COORDINATE_TOLERANCE_M
            && solid.max[2] > level + COORDINATE_TOLERANCE_M
    };
    let top_m = around(&own.solid).iter().filter(is_on).map(|b| b.solid.max[2]).reduce(f64::max)?;
    let mut joint = own.solid;
    (joint.min[2], joint.max[2]) = (level, top_m);
    // what is turned fills a part that is not looked at
    let mut inside = around(&joint);
    inside.retain(|m| m.bounds().intersection(&joint, COORDINATE_TOLERANCE_M).is_some());
    if inside.iter().any(|m| m.is_skew()) {
        return None;
    }
    let missing_m3 = missing(&joint, &inside);
    (missing_m3 > LEAST_OPEN * joint.volume()).then_some(Open { column, top_m, missing_m3 })
}

/// The volume of a box that is in none of some members \[m³\]: the sum over the cells between their faces.
pub(super) fn missing(joint: &Aabb, members: &[&Member]) -> f64 {
    let solids = || members.iter().flat_map(|m| m.openings.iter().chain([&m.solid]));
    let faces = |i: usize| {
        let mut all = vec![joint.min[i], joint.max[i]];
        all.extend(
            solids().flat_map(|s| [s.min[i], s.max[i]]).filter(|x| (joint.min[i]..joint.max[i]).contains(x)),
        );
        all.sort_by(f64::total_cmp);
        all
    };
    let [x, y, z] = [0, 1, 2].map(faces);
    let is_filled = |at: [f64; 3]| {
        let fills = |m: &Member| m.solid.contains(at, 0.0) && !m.openings.iter().any(|o| o.contains(at, 0.0));
        members.iter().any(|m| fills(m))
    };
    let mut sum = 0.0;
    for a in x.windows(2) {
        for b in y.windows(2) {
            for c in z.windows(2) {
                let cell = Aabb { min: [a[0], b[0], c[0]], max: [a[1], b[1], c[1]] };
                if !is_filled(cell.center()) {
                    sum += cell.volume();
                }
            }
        }
    }
    sum
}
