//! Where slabs and walls may yield: strips of a slab between neighbouring columns, and the feet and heads of walls.

use super::model::{Building, Member, MemberKind};
use super::partition::Partition;
use super::rows::{MEETS_M, Row, rows};
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use std::collections::BTreeMap;

/// A place across which a slab or a wall bends.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// `S1:C1-A1|C1-B1` of a slab between two columns, `W1.bottom`, `W1.top` of a wall.
    pub id: String,
    /// Index of the slab or wall.
    pub member: usize,
    /// The columns that a slab is between there, by index; none of a wall.
    pub columns: Option<[usize; 2]>,
    /// Direction in which it is passed on: from column to column, or upwards.
    pub axis: usize,
    /// What may bend: a slab between the faces of its columns, a wall in the half of its height next to its end \[m\].
    pub clear: Aabb,
    /// What lies behind its lower and its upper side; a side that is free, or goes on in the member, has nothing \[m\].
    pub behind: [Option<Aabb>; 2],
    /// Thickness of the plate \[m\].
    pub depth_m: f64,
}

impl Line {
    /// Length of what bends along its axis: a clear span of a slab, half the clear height of a wall \[m\].
    pub fn clear_m(&self) -> f64 {
        self.clear.size()[self.axis]
    }

    /// Whether it is the foot of a wall.
    pub fn is_foot(&self) -> bool {
        self.columns.is_none() && self.behind[0].is_some()
    }
}

/// All places, those of slabs by slab and column, then those of walls, the foot first.
pub fn lines(building: &Building, partition: &Partition) -> Vec<Line> {
    let members: Vec<&Member> = building.members.iter().collect();
    let mut lines = of_slabs(&members);
    // what walls have for themselves, in one pass over all cells
    let mut own: BTreeMap<usize, Option<Aabb>> =
        of_kind(&members, MemberKind::Wall).map(|i| (i, None)).collect();
    for (cell, owner) in partition.cells() {
        if let Some(held) = own.get_mut(&owner) {
            let part = partition.cell_box(cell);
            *held = Some(held.map_or(part, |held| held.around(part)));
        }
    }
    for (wall, solid) in own {
        lines.extend(solid.into_iter().flat_map(|solid| of_wall(wall, &building.members[wall], solid)));
    }
    lines
}

/// Those of the slabs among some members.
pub fn of_slabs(members: &[&Member]) -> Vec<Line> {
    let columns = of_kind(members, MemberKind::Column).map(|column| (column, members[column].solid));
    let columns = Boxes::numbered(columns);
    of_kind(members, MemberKind::Slab).flat_map(|slab| of_slab(members, &columns, slab)).collect()
}

/// The members of a kind that are not turned out of the axes.
fn of_kind<'a>(members: &'a [&Member], kind: MemberKind) -> impl Iterator<Item = usize> + 'a {
    (0..members.len()).filter(move |i| members[*i].kind == kind && !members[*i].is_skew())
}

fn of_slab(members: &[&Member], columns: &Boxes, slab: usize) -> Vec<Line> {
    let solid = members[slab].solid;
    let of = |column: usize| &members[column].solid;
    let inside = |c: &usize| (0..2).all(|i| (solid.min[i]..=solid.max[i]).contains(&of(*c).center()[i]));
    let mut columns = columns.near(&solid, MEETS_M);
    columns.retain(inside);
    columns.sort_unstable();
    let rows = [0, 1].map(|i| rows(columns.iter().map(|c| [of(*c).center()[i], of(*c).size()[i]]).collect()));
    // of the columns in a place the lowest one gives the name
    let mut at = BTreeMap::<[usize; 2], usize>::new();
    for column in columns {
        let centre = of(column).center();
        let held = at.entry([0, 1].map(|i| Row::nearest(&rows[i], centre[i]))).or_insert(column);
        if of(column).min[2] < of(*held).min[2] {
            *held = column;
        }
    }
    let mut list = Vec::new();
    for (place, from) in &at {
        for axis in 0..2 {
            let mut next = *place;
            next[axis] += 1;
            let Some(to) = at.get(&next) else { continue };
            let strip = strip(&rows[1 - axis], place[1 - axis], [solid.min[1 - axis], solid.max[1 - axis]]);
            list.extend(between(members, slab, [*from, *to], (axis, strip)));
        }
    }
    list
}

/// The line of a slab between two columns along an axis, in a strip of it.
fn between(
    members: &[&Member],
    slab: usize,
    columns: [usize; 2],
    (axis, strip_m): (usize, [f64; 2]),
) -> Option<Line> {
    let member = members[slab];
    let [from, to] = columns.map(|c| members[c]);
    let (a, b) = (&from.solid, &to.solid);
    let part = |[low, high]: [f64; 2]| {
        let mut part = member.solid;
        (part.min[axis], part.max[axis]) = (low, high);
        (part.min[1 - axis], part.max[1 - axis]) = (strip_m[0], strip_m[1]);
        part
    };
    let faces_m = [a.max[axis], b.min[axis]];
    (faces_m[0] < faces_m[1]).then(|| Line {
        id: format!("{}:{}|{}", member.id, from.id, to.id),
        member: slab,
        columns: Some(columns),
        axis,
        clear: part(faces_m),
        behind: [Some(part([a.center()[axis], faces_m[0]])), Some(part([faces_m[1], b.center()[axis]]))],
        depth_m: member.solid.size()[2],
    })
}

/// The strip of a slab about one of its rows of columns: to the middle between the rows, or to its edges \[m\].
fn strip(rows: &[Row], own: usize, edges_m: [f64; 2]) -> [f64; 2] {
    let middle = |i: usize| Some(0.5 * (rows.get(i)?.at_m + rows.get(i + 1)?.at_m));
    [own.checked_sub(1).and_then(middle).unwrap_or(edges_m[0]), middle(own).unwrap_or(edges_m[1])]
}

/// The foot and the head of a wall.
fn of_wall(wall: usize, member: &Member, own: Aabb) -> [Line; 2] {
    let (height_m, middle_m) = (own.size()[2], own.center()[2]);
    let depth_m = own.size()[0].min(own.size()[1]);
    let of = |is_foot: bool| {
        let (mut clear, mut behind) = (own, own);
        if is_foot {
            clear.max[2] = middle_m;
            (behind.min[2], behind.max[2]) = (own.min[2] - height_m, own.min[2]);
        } else {
            clear.min[2] = middle_m;
            (behind.min[2], behind.max[2]) = (own.max[2], own.max[2] + height_m);
        }
        let name = if is_foot { "bottom" } else { "top" };
        let behind = if is_foot { [Some(behind), None] } else { [None, Some(behind)] };
        Line {
            id: format!("{}.{name}", member.id),
            member: wall,
            columns: None,
            axis: 2,
            clear,
            behind,
            depth_m,
        }
    };
    [of(true), of(false)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tree::Format;
    use crate::building;

    #[test]
    fn a_slab_has_a_line_between_any_two_neighbouring_columns() {
        let building = building::parse(building::EXAMPLE, Format::Toml, "example.toml").unwrap();
        let lines = lines(&building, &Partition::of(&building));
        // three floors of two by two columns: four spans each
        assert_eq!(lines.len(), 12);
        let first = &lines[0];
        assert_eq!(first.id, "S1:C1-A1|C1-B1");
        let names = first.columns.unwrap().map(|c| building.members[c].id.as_str());
        assert_eq!(names, ["C1-A1", "C1-B1"]);
        let [a, b] = first.columns.unwrap().map(|c| building.members[c].solid);
        assert!((first.clear_m() - (b.min[0] - a.max[0])).abs() < 1e-12);
        // strips share out the slab across their span
        let (other, slab) = (&lines[2], &building.members[first.member].solid);
        assert_eq!(other.axis, 0);
        assert_eq!((first.clear.min[1], other.clear.max[1]), (slab.min[1], slab.max[1]));
        assert_eq!(first.clear.max[1], other.clear.min[1]);
    }

    #[test]
    fn a_wall_has_foot_and_head() {
        let text = include_str!("../../buildings/six-storey.toml");
        let building = building::parse(text, Format::Toml, "six.toml").unwrap();
        let walls: Vec<&Member> = building.members.iter().filter(|m| m.kind == MemberKind::Wall).collect();
        let lines = lines(&building, &Partition::of(&building));
        let own: Vec<&Line> = lines.iter().filter(|l| l.columns.is_none()).collect();
        assert_eq!(own.len(), 2 * walls.len());
        for pair in own.chunks_exact(2) {
            assert!(pair[0].is_foot() && !pair[1].is_foot());
            assert!(pair[0].id.ends_with(".bottom") && pair[1].id.ends_with(".top"));
            assert_eq!(pair[0].clear.max[2], pair[1].clear.min[2]);
        }
    }
}
