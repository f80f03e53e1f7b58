//! Ends of the clear columns, walls and beams: where hinges may form.
//!
//! The clear length leaves out the joint block: a column's reaches from the top of the slab to the
//! soffit of the deepest beam (the cells that it owns over at least half of its section), a beam's from
//! column face to column face. A beam that runs through over a column has several clear spans.

use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::building::partition::{COORDINATE_TOLERANCE_M, Partition};
use crate::building::{Building, Member, MemberKind};
use serde::Serialize;

/// An end of a clear length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// At the smaller coordinate: bottom of a column, start of a beam.
    Low,
    /// At the larger coordinate: top of a column, end of a beam.
    High,
}

impl End {
    /// The name used in ids.
    pub fn name(self, kind: MemberKind) -> &'static str {
        match (kind, self) {
            (MemberKind::Beam, End::Low) => "start",
            (MemberKind::Beam, End::High) => "end",
            (_, End::Low) => "bottom",
            (_, End::High) => "top",
        }
    }

    /// Direction out of the clear length along its axis: -1 or 1.
    pub fn outward(self) -> f64 {
        if self == End::Low { -1.0 } else { 1.0 }
    }
}

/// One end of a clear member.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MemberEnd {
    /// Id, such as `C1-A1.top`, `B1-A1-B1.start`, or `B7.2.start` for the second clear span.
    pub id: String,
    /// Index of the member in `Building::members`.
    pub member: usize,
    /// Member id.
    pub member_id: String,
    /// Number of the clear span, from 0.
    pub span: usize,
    /// Which end of the span.
    pub end: End,
    /// Centre of the end section of the gross member \[m\].
    pub point_m: [f64; 3],
    /// Axis of the member: 0 = x, 1 = y, 2 = z.
    pub axis: usize,
    /// Local axes as rows (orthonormal, right-handed): along the member from low to high; the section's
    /// width direction; the section's depth direction.
    pub axes: [[f64; 3]; 3],
    /// Width and depth of the gross section \[m\].
    pub size_m: [f64; 2],
    /// Area of the gross section \[m²\].
    pub area_m2: f64,
    /// Length of the clear span \[m\].
    pub clear_length_m: f64,
    /// Ids of the members beyond the end, in the order of the building.
    pub connected: Vec<String>,
    /// Whether the end is held by a support (its own, or that of the footing it stands on).
    pub supported: bool,
    /// The footings that hold it, where it has no support of its own.
    #[serde(skip)]
    pub footings: Vec<usize>,
}

/// The long axis of a member that acts as a bar: columns and beams as given, walls along z.
pub fn bar_axis(member: &Member) -> Option<usize> {
    match member.kind {
        MemberKind::Column | MemberKind::Beam => Some(member.axis),
        MemberKind::Wall => Some(2),
        MemberKind::Slab | MemberKind::Footing | MemberKind::Brace => None,
    }
}

/// Whether a member is a bar along z, which carries loads down: a column or a wall.
pub fn is_upright(member: &Member) -> bool {
    bar_axis(member) == Some(2)
}

/// Local axes of a bar: `[along, width, depth]`, width horizontal (x for a column, along the wall
/// for a wall), depth vertical for a beam.
pub fn local_axes(member: &Member) -> [[f64; 3]; 3] {
    const UNIT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let negative = |axis: usize| UNIT[axis].map(|c| -c);
    match (bar_axis(member), member.kind) {
        (Some(0), _) => [UNIT[0], UNIT[1], UNIT[2]],
        (Some(1), _) => [UNIT[1], negative(0), UNIT[2]],
        (_, MemberKind::Wall) if member.axis == 0 => [UNIT[2], UNIT[1], negative(0)],
        _ => [UNIT[2], UNIT[0], UNIT[1]],
    }
}

/// Extent of a solid along the width and depth direction of its member \[m\].
pub fn section_size_m(member: &Member) -> [f64; 2] {
    let (axes, size) = (local_axes(member), member.solid.size());
    [1, 2].map(|row: usize| (0..3).map(|i| axes[row][i].abs() * size[i]).sum())
}

/// The clear spans of a bar along its axis \[m\], ascending; empty if other members own all of it.
pub fn clear_spans_m(
    building: &Building,
    uprights: &Boxes,
    partition: &Partition,
    index: usize,
) -> Vec<[f64; 2]> {
    let member = &building.members[index];
    let Some(axis) = bar_axis(member) else { return Vec::new() };
    let planes = &partition.planes[axis];
    let others = [(axis + 1) % 3, (axis + 2) % 3];
    let size = member.solid.size();
    let needed = if is_upright(member) { 0.5 * size[others[0]] * size[others[1]] } else { 0.0 };
    let mut owned = vec![0.0; planes.len().saturating_sub(1)];
    for cell in partition.cells_of(index) {
        let cell_size = partition.cell_box(cell).size();
        owned[cell[axis]] += cell_size[others[0]] * cell_size[others[1]];
    }
    let is_beam = member.kind == MemberKind::Beam;
    let near = if is_beam { uprights.near(&member.solid, COORDINATE_TOLERANCE_M) } else { Vec::new() };
    let mut spans: Vec<[f64; 2]> = Vec::new();
    for (layer, area) in owned.iter().enumerate().filter(|(_, area)| **area > 0.0) {
        let mut slice = member.solid;
        slice.min[axis] = planes[layer];
        slice.max[axis] = planes[layer + 1];
        let meets = |other: &usize| {
            building.members[*other].solid.intersection(&slice, COORDINATE_TOLERANCE_M).is_some()
        };
        let in_column = near.iter().any(meets);
        if *area < needed - COORDINATE_TOLERANCE_M || in_column {
            continue;
        }
        match spans.last_mut() {
            Some(last) if last[1] == planes[layer] => last[1] = planes[layer + 1],
            _ => spans.push([planes[layer], planes[layer + 1]]),
        }
    }
    spans
}

/// All ends of all bars in the order of the building. `supported` tells whether a member's low or high
/// end is held.
pub fn member_ends(
    building: &Building,
    partition: &Partition,
    supported: &dyn Fn(usize, End) -> bool,
) -> Vec<MemberEnd> {
    let uprights = building.members.iter().enumerate().filter(|(_, m)| is_upright(m));
    let uprights = Boxes::numbered(uprights.map(|(index, upright)| (index, upright.solid)));
    let mut ends = Vec::new();
    for (index, member) in building.members.iter().enumerate() {
        let Some(axis) = bar_axis(member) else { continue };
        let spans = clear_spans_m(building, &uprights, partition, index);
        for (span, &range) in spans.iter().enumerate() {
            for end in [End::Low, End::High] {
                let coordinate = if end == End::Low { range[0] } else { range[1] };
                let mut point_m = member.solid.center();
                point_m[axis] = coordinate;
                let beyond = members_beyond(building, &uprights, partition, index, (axis, coordinate, end));
                let outermost = span == if end == End::Low { 0 } else { spans.len() - 1 };
                let is_held =
                    |i: &usize| building.members[*i].kind == MemberKind::Footing && supported(*i, End::Low);
                let is_own = outermost && supported(index, end);
                let footings: Vec<usize> =
                    beyond.iter().copied().filter(|i| outermost && !is_own && is_held(i)).collect();
                let number = if spans.len() > 1 { format!(".{}", span + 1) } else { String::new() };
                let size_m = section_size_m(member);
                ends.push(MemberEnd {
                    id: format!("{}{number}.{}", member.id, end.name(member.kind)),
                    member: index,
                    member_id: member.id.clone(),
                    span,
                    end,
                    point_m,
                    axis,
                    axes: local_axes(member),
                    size_m,
                    area_m2: size_m[0] * size_m[1],
                    clear_length_m: range[1] - range[0],
                    supported: is_own || !footings.is_empty(),
                    footings,
                    connected: beyond.iter().map(|i| building.members[*i].id.clone()).collect(),
                });
            }
        }
    }
    ends
}

/// Members whose cells, or (for a beam) columns whose gross solids, lie just beyond an end section.
fn members_beyond(
    building: &Building,
    uprights: &Boxes,
    partition: &Partition,
    index: usize,
    (axis, coordinate, end): (usize, f64, End),
) -> Vec<usize> {
    let solid = &building.members[index].solid;
    let plane = partition.planes[axis].partition_point(|p| *p < coordinate - COORDINATE_TOLERANCE_M);
    let layer = if end == End::Low { plane.checked_sub(1) } else { Some(plane) };
    let mut beyond: Vec<usize> = Vec::new();
    for (cell, owner) in layer.map_or(Vec::new(), |layer| partition.layer_within(axis, layer, solid)) {
        let center = partition.cell_box(cell).center();
        beyond.push(owner);
        if !is_upright(&building.members[index]) {
            let columns = uprights.near(&Aabb { min: center, max: center }, COORDINATE_TOLERANCE_M);
            beyond.extend(columns.into_iter().filter(|i| building.members[*i].solid.contains(center, 0.0)));
        }
    }
    beyond.sort_unstable();
    beyond.dedup();
    beyond.retain(|i| *i != index);
    beyond
}
