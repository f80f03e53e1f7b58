//! Which members touch, and which of them hang on a support.

use super::model::Member;
use super::partition::COORDINATE_TOLERANCE_M;
use super::turned::TurnedBox;
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::base::sets::groups;
use petgraph::unionfind::UnionFind;

/// Whether two gross solids overlap or share a face with an area.
pub fn touch(a: &Member, b: &Member) -> bool {
    if a.is_skew() || b.is_skew() {
        let [p, q] = [a, b].map(|m| TurnedBox::of(m).longer(m.axis, m.inclined.map_or(0.0, |i| i.slack_m())));
        return p.touches(&q);
    }
    touch_box(&a.solid, &b.solid)
}

/// A box beyond which a member touches nothing.
fn reach(member: &Member) -> Aabb {
    let slack = member.inclined.map_or(0.0, |i| i.slack_m());
    match member.is_skew() {
        true => TurnedBox::of(member).longer(member.axis, slack).bounds(),
        false => member.solid,
    }
}

/// Whether two boxes overlap or share a face with an area.
pub fn touch_box(a: &Aabb, b: &Aabb) -> bool {
    let mut with_extent = 0;
    for i in 0..3 {
        let overlap = a.max[i].min(b.max[i]) - a.min[i].max(b.min[i]);
        if overlap < -COORDINATE_TOLERANCE_M {
            return false;
        }
        with_extent += usize::from(overlap > COORDINATE_TOLERANCE_M);
    }
    with_extent >= 2
}

/// Groups of members that touch and contain no supported one; `present` leaves members out.
pub fn unsupported_groups(members: &[&Member], present: &[bool], supported: &[bool]) -> Vec<Vec<usize>> {
    let mut sets = UnionFind::<usize>::new(members.len());
    let bounds: Vec<Aabb> = members.iter().map(|m| reach(m)).collect();
    let boxes = Boxes::of(bounds.iter().copied());
    for i in (0..members.len()).filter(|&i| present[i]) {
        let near = boxes.near(&bounds[i], 2.0 * COORDINATE_TOLERANCE_M);
        for j in near.into_iter().filter(|&j| j > i && present[j]) {
            if touch(members[i], members[j]) {
                sets.union(i, j);
            }
        }
    }
    let groups = groups(&sets, (0..members.len()).filter(|&i| present[i]));
    groups.into_iter().filter(|group| !group.iter().any(|&i| supported[i])).collect()
}
