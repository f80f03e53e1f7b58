//! Columns in their joints: how much longer a column is for the force that it bears, which goes on through the floor.
//!
//! A joint is as high as the beams and slabs in it and shortens under the force that passes it from column to column, less than the columns do: the force spreads into what is beside it. In FE models of 18 studies that cannot
//! yield (vertical forces where columns were taken away; 207 joints of two columns) the strain of a joint is a share of the mean strain of its columns, the smaller the more of its sides the floor goes on to: 0.78 with two
//! (0.4 to 1.7 in single joints), 0.65 with three, 0.49 with four (5 joints), the same with beams and without.
//!
//! Half of a joint belongs to each of its columns, also where there is only one: floors hand their forces over along the height of the joint.

use super::joints::Place;
use crate::building::MemberKind;
use crate::building::ends::MemberEnd;

/// Strain of a joint over that of its columns, by the number of sides to which the floor goes on.
const SHARES: [f64; 5] = [1.0, 1.0, 0.78, 0.65, 0.49];
/// How far beyond the face of a column a floor goes on, as a share of the column's width.
const BEYOND: f64 = 0.25;
/// How far into a floor it is looked for \[m\].
const INTO_M: f64 = 1e-3;

/// Length of a column that would shorten like its half of the joint at an end \[m\]; none where it stands on the ground.
pub fn half_joint_m(place: &Place, end: &MemberEnd) -> f64 {
    let heights = floor_at(place, end);
    if heights.is_empty() {
        return 0.0;
    }
    let height_m: f64 = heights.iter().map(|[low, high]| high - low).sum();
    // beams are no higher than their slab
    let top_m = heights.iter().map(|h| h[1]).fold(f64::NEG_INFINITY, f64::max) - INTO_M;
    let width_m = place.building.members[end.member].solid.size();
    let goes_on = |axis: usize, sign: f64| {
        let mut point_m = [end.point_m[0], end.point_m[1], top_m];
        point_m[axis] += sign * (0.5 + BEYOND) * width_m[axis];
        place.partition.member_at(point_m).is_some()
    };
    let sides = (0..2).flat_map(|axis| [-1.0, 1.0].map(|sign| (axis, sign)));
    0.5 * height_m * SHARES[sides.filter(|(axis, sign)| goes_on(*axis, *sign)).count()]
}

/// Lowest and highest level of the beams and slabs in which a column ends, one behind the other \[m\].
fn floor_at(place: &Place, end: &MemberEnd) -> Vec<[f64; 2]> {
    let mut list = Vec::new();
    if end.axis != 2 {
        return list;
    }
    let mut point_m = end.point_m;
    loop {
        let from_m = point_m[2];
        point_m[2] -= INTO_M * end.outward;
        let Some(member) = place.partition.member_at(point_m) else { return list };
        let member = &place.building.members[member];
        if !matches!(member.kind, MemberKind::Beam | MemberKind::Slab) {
            return list;
        }
        let to_m = if end.outward > 0.0 { member.solid.min[2] } else { member.solid.max[2] };
        list.push([from_m.min(to_m), from_m.max(to_m)]);
        point_m[2] = to_m;
    }
}
