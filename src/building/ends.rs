//! The ends of columns and beams: where hinges may form.

use super::model::{Building, MemberKind};
use super::partition::Partition;
use super::tracked::clear_range;
use crate::base::boxes::Boxes;
use serde::{Deserialize, Serialize};

/// Which end of a member, along its axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// The end with the smaller coordinate: the bottom of a column, the start of a beam.
    Lower,
    /// The end with the larger coordinate: the top of a column, the end of a beam.
    Upper,
}

/// An end of a column's clear height or of a beam's clear span.
#[derive(Debug, Clone, PartialEq)]
pub struct MemberEnd {
    /// `C1-A1.top`, `C1-A1.bottom`, `B1-A1-B1.start`, `B1-A1-B1.end`.
    pub id: String,
    /// Index of the member.
    pub member: usize,
    /// Which end.
    pub end: End,
    /// Axis of the member: 0, 1 or 2.
    pub axis: usize,
    /// +1 if the member extends towards larger coordinates from this end.
    pub outward: f64,
    /// Centre of the end face \[m\].
    pub point_m: [f64; 3],
    /// Larger side of the section \[m\].
    pub depth_m: f64,
    /// Clear length of the member \[m\].
    pub clear_m: f64,
}

/// Ends of beams along one axis whose coordinates differ by less than this lie on one line \[m\].
pub const SAME_LINE_M: f64 = 0.05;

impl MemberEnd {
    /// The member just beyond the end.
    pub fn beyond(&self, partition: &Partition) -> Option<usize> {
        let mut probe = self.point_m;
        probe[self.axis] -= 1e-4 * self.outward;
        partition.member_at(probe)
    }

    /// Whether a column, wall or footing goes on beyond the floor at the end, so that the axial force passes into it.
    pub fn goes_on(&self, building: &Building, partition: &Partition) -> bool {
        let planes = &partition.planes[self.axis];
        let middle = |k: usize| 0.5 * (planes[k] + planes[k + 1]);
        let is_beyond = |at: &f64| (at - self.point_m[self.axis]) * self.outward < 0.0;
        let cells = (0..planes.len().saturating_sub(1)).map(middle).filter(is_beyond);
        let mut beyond: Vec<f64> = cells.collect();
        beyond.sort_by(|a, b| (self.outward * b).total_cmp(&(self.outward * a)));
        for at in beyond {
            let mut probe = self.point_m;
            probe[self.axis] = at;
            match partition.member_at(probe).map(|m| building.members[m].kind) {
                Some(MemberKind::Column | MemberKind::Wall | MemberKind::Footing) => return true,
                Some(_) => {}
                None => return false,
            }
        }
        false
    }

    /// Whether a floor that folds at one of two beam ends folds at the other as well: both lie on a line across it.
    pub fn on_line_of(&self, other: &Self) -> bool {
        let near = (self.point_m[self.axis] - other.point_m[self.axis]).abs() < SAME_LINE_M;
        near && self.axis == other.axis && self.outward == other.outward
    }
}

/// The names of the lower and the upper end of a bar; none if members of this kind have no ends.
pub fn end_names(kind: MemberKind) -> Option<[&'static str; 2]> {
    match kind {
        MemberKind::Column => Some(["bottom", "top"]),
        MemberKind::Beam => Some(["start", "end"]),
        _ => None,
    }
}

/// All ends of columns and beams, in member order, lower end first.
///
/// The clear span of a beam lies between the columns it frames into; where no column meets it, it is the beam's own extent.
pub fn member_ends(building: &Building, partition: &Partition) -> Vec<MemberEnd> {
    let columns = building.members.iter().enumerate().filter(|(_, m)| m.kind == MemberKind::Column);
    let columns = Boxes::numbered(columns.map(|(index, column)| (index, column.solid)));
    let mut ends = Vec::new();
    for (index, member) in building.members.iter().enumerate() {
        let Some(names) = end_names(member.kind) else { continue };
        let Some(mut range) = clear_range(partition, index, member.axis) else { continue };
        if member.kind == MemberKind::Beam {
            range = clear_span(building, &columns, index, range);
        }
        let depth_m =
            (0..3).filter(|i| *i != member.axis).map(|i| member.solid.size()[i]).fold(0.0, f64::max);
        for (end, name, at, outward) in
            [(End::Lower, names[0], range[0], 1.0), (End::Upper, names[1], range[1], -1.0)]
        {
            let mut point_m = member.solid.center();
            point_m[member.axis] = at;
            ends.push(MemberEnd {
                id: format!("{}.{name}", member.id),
                member: index,
                end,
                axis: member.axis,
                outward,
                point_m,
                depth_m,
                clear_m: range[1] - range[0],
            });
        }
    }
    ends
}

/// A beam's range without the joint blocks over the columns at its two ends \[m\].
fn clear_span(building: &Building, columns: &Boxes, beam: usize, range: [f64; 2]) -> [f64; 2] {
    let member = &building.members[beam];
    let axis = member.axis;
    let middle = 0.5 * (range[0] + range[1]);
    let mut clear = range;
    for column in columns.near(&member.solid, 1e-9).into_iter().map(|c| &building.members[c]) {
        if column.solid.intersection(&member.solid, 1e-9).is_none() {
            continue;
        }
        let at_end = |face: f64, end: f64| (face - end).abs() < column.solid.size()[axis] + 1e-9;
        if column.solid.center()[axis] < middle && at_end(column.solid.max[axis], range[0]) {
            clear[0] = clear[0].max(column.solid.max[axis]);
        }
        if column.solid.center()[axis] > middle && at_end(column.solid.min[axis], range[1]) {
            clear[1] = clear[1].min(column.solid.min[axis]);
        }
    }
    clear
}
