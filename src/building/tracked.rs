//! The points whose displacement is compared between models: every column top and every slab corner
//! (mid-plane), without those of members that are taken away whole; and what a column bore that is taken away, where no column goes on above it.
//! Of a building that has none of these, a chimney or a shaft, the tops of its walls.

use super::clear::Clear;
use super::model::{Building, Member, MemberKind};
use super::partition::Partition;
use serde::{Deserialize, Serialize};

/// A material point of a member.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tracked {
    /// Unique id, such as `C1-A2.top` or `S3.corner-11`.
    pub id: String,
    /// Member id.
    pub member: String,
    /// Position in the undeformed building \[m\].
    pub point_m: [f64; 3],
}

/// All tracked points in the order of the members.
pub fn tracked_points(building: &Building, partition: &Partition) -> Vec<Tracked> {
    let mut points = Vec::new();
    let is_taken = |i: &usize| {
        is_taken_away(building, &building.members[*i].id) || loses_its_top(building, partition, *i)
    };
    for (index, member) in building.members.iter().enumerate() {
        if is_taken(&index) {
            continue;
        }
        let (low, high) = (member.solid.min, member.solid.max);
        match member.kind {
            MemberKind::Column => {
                let top = if member.is_skew() {
                    let members: Vec<_> = building.members.iter().collect();
                    let clear = Clear::of(&members, index);
                    clear.gross.center_m[2] + clear.range_m[2][1]
                } else {
                    clear_range(partition, index, 2).map_or(high[2], |r| r[1])
                };
                let c = member.solid.center();
                points.push(Tracked {
                    id: format!("{}.top", member.id),
                    member: member.id.clone(),
                    point_m: [c[0], c[1], top],
                });
            }
            MemberKind::Slab => {
                let z = 0.5 * (low[2] + high[2]);
                for (i, x) in [low[0], high[0]].into_iter().enumerate() {
                    for (j, y) in [low[1], high[1]].into_iter().enumerate() {
                        points.push(Tracked {
                            id: format!("{}.corner-{i}{j}", member.id),
                            member: member.id.clone(),
                            point_m: [x, y, z],
                        });
                    }
                }
            }
            _ => {}
        }
    }
    let taken = (0..building.members.len()).filter(is_taken);
    points.extend(taken.filter_map(|i| over_removed(building, &building.members[i])));
    if points.is_empty() {
        points.extend(wall_tops(building, partition));
    }
    points
}

/// The middles of the upper edges of all walls that stay.
fn wall_tops(building: &Building, partition: &Partition) -> Vec<Tracked> {
    let walls = building.members.iter().enumerate().filter(|(_, m)| m.kind == MemberKind::Wall);
    let top = |(index, wall): (usize, &Member)| {
        let [x, y, _] = wall.solid.center();
        let z = clear_range(partition, index, 2)?[1];
        Some(Tracked { id: format!("{}.top", wall.id), member: wall.id.clone(), point_m: [x, y, z] })
    };
    walls.filter(|(_, wall)| !is_taken_away(building, &wall.id)).filter_map(top).collect()
}

/// The point of a floor, or of a beam, over the middle of a column that is taken away or loses its top. Where a column stands on it the top of that one tells how it falls.
fn over_removed(building: &Building, column: &Member) -> Option<Tracked> {
    let is_upright = column.kind == MemberKind::Column && !column.is_skew();
    if !is_upright {
        return None;
    }
    let [x, y, middle] = column.solid.center();
    let top = column.solid.max[2];
    let reach = 0.5 * (top - column.solid.min[2]);
    let above = |m: &&Member| {
        let low = m.solid.min[2];
        let covers = m.solid.contains([x, y, low], 0.0);
        covers && low > middle && low < top + reach && !is_taken_away(building, &m.id)
    };
    let of_kind = |kind: MemberKind| building.members.iter().filter(move |m| m.kind == kind).filter(above);
    if of_kind(MemberKind::Column).next().is_some() {
        return None;
    }
    let lowest = |kind| of_kind(kind).min_by(|a, b| a.solid.min[2].total_cmp(&b.solid.min[2]));
    let borne = lowest(MemberKind::Slab).or_else(|| lowest(MemberKind::Beam))?;
    let z = borne.solid.center()[2];
    Some(Tracked {
        id: format!("{}.over-{}", borne.id, column.id),
        member: borne.id.clone(),
        point_m: [x, y, z],
    })
}

/// Shortest rest that charges leave of a column, over the smaller side of its section: what is shorter is less than an element, and goes with them.
pub const SHORTEST_REST: f64 = 0.5;

/// The stretches that charges take of an upright column, from its foot \[m\].
fn stretches<'a>(building: &'a Building, member: &'a Member) -> impl Iterator<Item = [f64; 2]> + 'a {
    let upright = member.kind == MemberKind::Column && !member.is_skew();
    let own = building.events.iter().filter(move |e| upright && e.member == member.id);
    own.filter_map(|e| e.stretch_m)
}

/// The level up to which charges take stretches of an upright column at most \[m\]: what is above carries its top.
pub fn stretches_to_m(building: &Building, column: &Member) -> Option<f64> {
    stretches(building, column).map(|[_, to]| column.solid.min[2] + to).reduce(f64::max)
}

/// The level up to which a member goes on standing on what supports it while charges act \[m\]: the middle of the lowest stretch that they take of an upright column; infinite of others.
pub fn stands_to_m(building: &Building, member: &Member) -> f64 {
    let middle = |[from, to]: [f64; 2]| member.solid.min[2] + 0.5 * (from + to);
    stretches(building, member).map(middle).fold(f64::INFINITY, f64::min)
}

/// Whether stretches that charges take of a column reach its upper end.
fn loses_its_top(building: &Building, partition: &Partition, member: usize) -> bool {
    let column = &building.members[member];
    let Some(to) = stretches_to_m(building, column) else { return false };
    let top = clear_range(partition, member, 2).map_or(column.solid.max[2], |range| range[1]);
    let size = column.solid.size();
    top - to < SHORTEST_REST * size[0].min(size[1])
}

/// Whether a member is cut, or removed or interrupted during the run.
pub fn is_charged_or_cut(building: &Building, member: &str) -> bool {
    building.events.iter().any(|e| e.member == member) || building.is_cut(member)
}

/// Whether a member is cut or removed whole during the run.
pub fn is_taken_away(building: &Building, member: &str) -> bool {
    building.events.iter().any(|e| e.member == member && e.stretch_m.is_none()) || building.is_cut(member)
}

/// The extent of a member's own volume along an axis \[m\]; `None` where other members own all of it.
pub fn clear_range(partition: &Partition, member: usize, axis: usize) -> Option<[f64; 2]> {
    partition.cells_of(member).map(|cell| partition.cell_box(cell)).fold(None, |range, own| {
        let [low, high]: [f64; 2] = range.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
        Some([low.min(own.min[axis]), high.max(own.max[axis])])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tree::Format;
    use crate::building::{EXAMPLE, parse};

    fn over(text: &str) -> Vec<String> {
        let building = parse(text, Format::Toml, "building.toml").unwrap_or_else(|e| panic!("{e}"));
        let points = tracked_points(&building, &Partition::of(&building));
        points.into_iter().map(|p| p.id).filter(|id| id.contains(".over-")).collect()
    }

    #[test]
    fn a_floor_is_tracked_where_it_loses_a_column_that_nothing_stands_on() {
        assert!(over(EXAMPLE).is_empty(), "columns stand on those of the first storey");
        let hall = EXAMPLE.replace("[\"3.5 m\", \"3.5 m\", \"3.5 m\"]", "[\"3.5 m\"]");
        let found = over(&hall);
        assert!(found.len() == 2 && found.iter().all(|id| id.starts_with("S1.over-C1-")), "{found:?}");
    }
}
