//! Rigid clusters and load paths.

use super::ends::is_upright;
use super::structure::{Connection, Link, Node, Structure};
use crate::base::geom::Aabb;
use crate::base::sets::groups;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::building::{Building, MemberKind, Preparation};
use petgraph::graph::NodeIndex;
use petgraph::unionfind::UnionFind;
use petgraph::visit::EdgeRef;
use serde::Serialize;
use std::collections::BTreeSet;

/// Whether what a member bears on is still carried straight down to the ground.
///
/// A lost path does not mean collapse: bending may bridge it. It names where bridging is asked for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum VerticalPath {
    /// Every column or wall under the member stands on a complete stack.
    Kept,
    /// Some stacks are interrupted.
    Partial {
        /// The columns or walls on whose place nothing stands any more, or whose stack is interrupted.
        lost: Vec<String>,
    },
    /// No complete stack is left, or there never was one.
    Lost,
}

/// Load paths of one member.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LoadPath {
    /// Index of the member.
    pub member: usize,
    /// Its id.
    pub member_id: String,
    /// Ids of the supports that it is connected to through the members left.
    pub supports: Vec<String>,
    /// Its vertical path.
    pub vertical: VerticalPath,
}

/// Members cut away before the dead-load state.
pub fn cut_members(building: &Building) -> BTreeSet<usize> {
    let ids = building.preparation.iter().filter_map(|p| match p {
        Preparation::Cut { member } => Some(member),
        Preparation::Weaken { .. } => None,
    });
    indices(building, ids)
}

/// Members that a charge removes or interrupts. A charge that takes a stretch counts as the whole member:
/// its stumps carry nothing.
pub fn charged_members(building: &Building) -> BTreeSet<usize> {
    indices(building, building.events.iter().map(|event| &event.member))
}

fn indices<'a>(building: &Building, ids: impl Iterator<Item = &'a String>) -> BTreeSet<usize> {
    ids.filter_map(|id| building.members.iter().position(|m| m.id == *id)).collect()
}

impl Structure {
    /// Sets of members held together by the connections for which `joined` is true (union-find).
    /// Each set ascending, sets by their first member; single members are sets too.
    pub fn clusters(&self, joined: impl Fn(&Connection) -> bool) -> Vec<Vec<usize>> {
        let count = self.members().count();
        let mut sets = UnionFind::new(count);
        for connection in self.connections().filter(|c| joined(c)) {
            sets.union(connection.members[0], connection.members[1]);
        }
        groups(&sets, 0..count)
    }

    /// Storey bodies: slabs with the beams and joint blocks that they touch; every column, wall and
    /// footing by itself.
    pub fn storey_bodies(&self) -> Vec<Vec<usize>> {
        let kinds: Vec<MemberKind> = self.members().map(|m| m.kind).collect();
        self.clusters(|c| c.members.iter().all(|m| matches!(kinds[*m], MemberKind::Slab | MemberKind::Beam)))
    }

    /// Load paths of all members left after `removed` has gone.
    pub fn load_paths(&self, building: &Building, removed: &BTreeSet<usize>) -> Vec<LoadPath> {
        let kept = self.complete_stacks(building, removed);
        (0..building.members.len())
            .filter(|m| !removed.contains(m))
            .map(|member| LoadPath {
                member,
                member_id: building.members[member].id.clone(),
                supports: self.supports_reached(member, removed),
                vertical: self.vertical_path(building, member, &kept),
            })
            .collect()
    }

    /// Ids of the supports that a member reaches through members that are not removed, in edge order.
    pub fn supports_reached(&self, member: usize, removed: &BTreeSet<usize>) -> Vec<String> {
        let mut seen = removed.clone();
        let mut queue = vec![member];
        let mut found: BTreeSet<(usize, &str)> = BTreeSet::new();
        seen.insert(member);
        while let Some(at) = queue.pop() {
            for edge in self.graph.edges(NodeIndex::new(at)) {
                match edge.weight() {
                    Link::Support(support) => {
                        found.insert((edge.id().index(), &support.id));
                    }
                    Link::Contact(c) => {
                        let next = c.members[usize::from(c.members[0] == at)];
                        if seen.insert(next) {
                            queue.push(next);
                        }
                    }
                }
            }
        }
        found.into_iter().map(|(_, id)| id.to_owned()).collect()
    }

    /// For every member whether it is a column or wall that stands, through members left, straight on the ground.
    ///
    /// From the base of a column or wall we go down through the cells under its section: first the joint (slab,
    /// beam), then the next column or wall, and so on to a supported face.
    fn complete_stacks(&self, building: &Building, removed: &BTreeSet<usize>) -> Vec<bool> {
        let mut order: Vec<usize> =
            (0..building.members.len()).filter(|m| is_upright(&building.members[*m])).collect();
        order.sort_by(|a, b| building.members[*a].solid.min[2].total_cmp(&building.members[*b].solid.min[2]));
        let mut complete = vec![false; building.members.len()];
        for member in order {
            complete[member] = !removed.contains(&member)
                && (self.is_supported(member)
                    || self.uprights_below(building, member).iter().any(|below| complete[*below])
                    || self.stands_on_footing(member, removed));
        }
        complete
    }

    fn is_supported(&self, member: usize) -> bool {
        self.supports().any(|s| s.member == member)
    }

    fn stands_on_footing(&self, member: usize, removed: &BTreeSet<usize>) -> bool {
        self.graph.neighbors(NodeIndex::new(member)).any(|n| match &self.graph[n] {
            Node::Member(m) => {
                m.kind == MemberKind::Footing && !removed.contains(&m.index) && self.is_supported(m.index)
            }
            Node::Ground => false,
        })
    }

    /// Columns and walls that end under the base of `member` with nothing but solid in between.
    fn uprights_below(&self, building: &Building, member: usize) -> Vec<usize> {
        let solid = &building.members[member].solid;
        let candidates = building.members.iter().enumerate().filter(|(index, other)| {
            *index != member
                && is_upright(other)
                && other.solid.min[2] < solid.min[2] - COORDINATE_TOLERANCE_M
                && plan_overlap(&other.solid, solid).is_some()
        });
        candidates
            .filter(|(_, other)| {
                let Some(center) = plan_overlap(&other.solid, solid) else { return false };
                self.is_solid_between(center, other.solid.max[2], solid.min[2])
            })
            .map(|(index, _)| index)
            .collect()
    }

    /// Whether a vertical line is inside owned cells between two levels (true if there is no room).
    pub(super) fn is_solid_between(&self, [x, y]: [f64; 2], low: f64, high: f64) -> bool {
        let cell_at = |axis: usize, value: f64| {
            let planes = &self.partition.planes[axis];
            planes.partition_point(|p| *p <= value).checked_sub(1).filter(|i| i + 1 < planes.len())
        };
        let (Some(i), Some(j)) = (cell_at(0, x), cell_at(1, y)) else { return false };
        let planes = &self.partition.planes[2];
        (0..planes.len().saturating_sub(1))
            .filter(|&k| {
                let middle = 0.5 * (planes[k] + planes[k + 1]);
                low < middle && middle < high
            })
            .all(|k| self.partition.owner_at([i, j, k]).is_some())
    }

    /// The vertical path of a member, given which columns and walls stand on a complete stack.
    fn vertical_path(&self, building: &Building, member: usize, complete: &[bool]) -> VerticalPath {
        let this = &building.members[member];
        if this.kind == MemberKind::Footing {
            return if self.is_supported(member) { VerticalPath::Kept } else { VerticalPath::Lost };
        }
        if is_upright(this) {
            return if complete[member] { VerticalPath::Kept } else { VerticalPath::Lost };
        }
        let bearings: Vec<usize> = (0..building.members.len())
            .filter(|&other| {
                let upright = &building.members[other];
                is_upright(upright) && bears(&upright.solid, &this.solid)
            })
            .collect();
        let lost: Vec<usize> = bearings.iter().copied().filter(|b| !complete[*b]).collect();
        if self.is_supported(member) || (lost.is_empty() && !bearings.is_empty()) {
            VerticalPath::Kept
        } else if lost.len() < bearings.len() {
            VerticalPath::Partial { lost: lost.iter().map(|b| building.members[*b].id.clone()).collect() }
        } else {
            VerticalPath::Lost
        }
    }
}

/// Whether a column or wall ends inside or under another solid and overlaps it or abuts on it in plan (a beam that
/// ends at the face of the column).
fn bears(upright: &Aabb, carried: &Aabb) -> bool {
    let top = upright.max[2];
    let reaches =
        top >= carried.min[2] - COORDINATE_TOLERANCE_M && top <= carried.max[2] + COORDINATE_TOLERANCE_M;
    let gaps = [0, 1].map(|i| (upright.min[i] - carried.max[i]).max(carried.min[i] - upright.max[i]));
    let meets =
        gaps.iter().all(|g| *g < COORDINATE_TOLERANCE_M) && gaps.iter().any(|g| *g < -COORDINATE_TOLERANCE_M);
    reaches && upright.min[2] < carried.min[2] && meets
}

/// Centre of the common area of two solids in plan \[m\].
pub(super) fn plan_overlap(a: &Aabb, b: &Aabb) -> Option<[f64; 2]> {
    let range = [0, 1].map(|i| [a.min[i].max(b.min[i]), a.max[i].min(b.max[i])]);
    range.iter().all(|r| r[1] - r[0] > COORDINATE_TOLERANCE_M).then(|| range.map(|r| 0.5 * (r[0] + r[1])))
}
