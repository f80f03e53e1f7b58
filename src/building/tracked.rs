//! The points whose displacement is compared between models: every column top and every slab corner
//! (mid-plane), without those of members that are taken away whole.

use super::clear::Clear;
use super::model::{Building, MemberKind};
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
    for (index, member) in building.members.iter().enumerate() {
        if is_taken_away(building, &member.id) {
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
    points
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
