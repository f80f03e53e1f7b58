//! Where slabs and walls may yield: strips of a slab between neighbouring columns, and the bases and tops of walls.

use super::connect::unsupported_groups;
use super::model::{Building, Member, MemberKind};
use super::partition::Partition;
use super::rows::{MEETS_M, Row, rows};
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use std::collections::{BTreeMap, BTreeSet};

/// A place across which a slab or a wall bends.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// `S1:C1-A1|C1-B1` of a slab between two columns, `W1.bottom`, `W1.top` of a wall.
    pub id: String,
    /// Index of the slab or wall.
    pub member: usize,
    /// The columns in the two places that a slab is between there, by index, the lowest ones, which it is called after, first; none of a wall.
    pub columns: Option<[Vec<usize>; 2]>,
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

/// Those of the slabs among some members, by floor, direction and row.
pub fn of_slabs(members: &[&Member]) -> Vec<Line> {
    let columns = of_kind(members, MemberKind::Column).map(|column| (column, members[column].solid));
    let columns = Boxes::numbered(columns);
    let beams = Boxes::numbered(of_kind(members, MemberKind::Beam).map(|beam| (beam, members[beam].solid)));
    let is_slab: Vec<bool> = members.iter().map(|m| m.kind == MemberKind::Slab && !m.is_skew()).collect();
    // slabs that touch are one floor
    let floors = unsupported_groups(members, &is_slab, &vec![false; members.len()]);
    floors.iter().flat_map(|floor| of_floor(members, &columns, &beams, floor)).collect()
}

/// The members of a kind that are not turned out of the axes.
fn of_kind<'a>(members: &'a [&Member], kind: MemberKind) -> impl Iterator<Item = usize> + 'a {
    (0..members.len()).filter(move |i| members[*i].kind == kind && !members[*i].is_skew())
}

/// Columns that stand in one place of a floor, one on the other or side by side, the lowest first.
type Place = Vec<usize>;

/// Whether a member with this solid stands under, on or in another one, by their plans.
fn carries(c: &Aabb, s: &Aabb) -> bool {
    (0..2).all(|i| c.max[i] > s.min[i] + MEETS_M && c.min[i] < s.max[i] - MEETS_M)
}

/// The columns below a slab that end at the beams under it, or in them.
fn under_beams(members: &[&Member], columns: &Boxes, beams: &Boxes, slab: &Aabb) -> Vec<usize> {
    let of = |member: usize| &members[member].solid;
    let on = beams.near(slab, MEETS_M).into_iter().filter(|b| of(*b).min[2] < slab.min[2]);
    on.flat_map(|beam| columns.near(of(beam), MEETS_M).into_iter().map(move |column| (beam, column)))
        .filter(|(beam, column)| {
            let top_m = of(*column).max[2];
            let ends_there = top_m > of(*beam).min[2] - MEETS_M && top_m < slab.min[2];
            ends_there && carries(of(*column), of(*beam)) && carries(of(*column), slab)
        })
        .map(|(_, column)| column)
        .collect()
}

fn of_floor(members: &[&Member], columns: &Boxes, beams: &Boxes, slabs: &[usize]) -> Vec<Line> {
    let of = |column: usize| &members[column].solid;
    let mut own = BTreeSet::new();
    for solid in slabs.iter().map(|slab| &members[*slab].solid) {
        own.extend(columns.near(solid, MEETS_M).into_iter().filter(|c| carries(of(*c), solid)));
        own.extend(under_beams(members, columns, beams, solid));
    }
    let rows = [0, 1].map(|i| rows(own.iter().map(|c| [of(*c).center()[i], of(*c).size()[i]]).collect()));
    let mut list = Vec::new();
    for axis in 0..2 {
        let across = 1 - axis;
        // by row, then along it
        let mut places = BTreeMap::<[usize; 2], Place>::new();
        for column in &own {
            let centre = of(*column).center();
            let at = [across, axis].map(|i| Row::nearest(&rows[i], centre[i]));
            places.entry(at).or_default().push(*column);
        }
        places.values_mut().for_each(|place| place.sort_by(|a, b| of(*a).min[2].total_cmp(&of(*b).min[2])));
        let all: Vec<([usize; 2], Place)> = places.into_iter().collect();
        for pair in all.windows(2).filter(|pair| pair[0].0[0] == pair[1].0[0]) {
            let row = pair[0].0[0];
            let ends = [&pair[0].1, &pair[1].1];
            list.extend(between(
                members,
                slabs,
                ends,
                (axis, strip(&rows[across], row), rows[across][row].at_m),
            ));
        }
    }
    list
}

/// The line of a floor between two places along an axis, in a strip across it about the middle of a row \[m\]; none where no slab is half-way.
fn between(
    members: &[&Member],
    slabs: &[usize],
    places: [&Place; 2],
    (axis, strip_m, row_m): (usize, [f64; 2], f64),
) -> Option<Line> {
    let solids = |place: &'_ Place| place.iter().map(|c| members[*c].solid).collect::<Vec<Aabb>>();
    let [a, b] = places.map(solids);
    let low_m = a.iter().map(|c| c.max[axis]).fold(f64::NEG_INFINITY, f64::max);
    let high_m = b.iter().map(|c| c.min[axis]).fold(f64::INFINITY, f64::min);
    let across = 1 - axis;
    let half_way = |s: &Aabb| {
        let mut at = [row_m; 2];
        at[axis] = 0.5 * (low_m + high_m);
        (0..2).all(|i| (s.min[i] - MEETS_M..=s.max[i] + MEETS_M).contains(&at[i]))
    };
    let slab = *slabs.iter().find(|slab| half_way(&members[**slab].solid))?;
    let (id, solid) = (&members[slab].id, members[slab].solid);
    let part = |[low, high]: [f64; 2]| {
        let mut part = solid;
        (part.min[axis], part.max[axis]) = (low, high);
        part.min[across] = part.min[across].max(strip_m[0]);
        part.max[across] = part.max[across].min(strip_m[1]);
        part
    };
    let [from, to] = places.map(|place| &members[place[0]].id);
    (low_m < high_m).then(|| Line {
        id: format!("{id}:{from}|{to}"),
        member: slab,
        columns: Some(places.map(Clone::clone)),
        axis,
        clear: part([low_m, high_m]),
        behind: [Some(part([a[0].center()[axis], low_m])), Some(part([high_m, b[0].center()[axis]]))],
        depth_m: solid.size()[2],
    })
}

/// The strip of a floor about one of its rows of columns: to the middle between the rows, or as far as it goes \[m\].
fn strip(rows: &[Row], own: usize) -> [f64; 2] {
    let middle = |i: usize| Some(0.5 * (rows.get(i)?.at_m + rows.get(i + 1)?.at_m));
    let low = own.checked_sub(1).and_then(middle).unwrap_or(f64::NEG_INFINITY);
    [low, middle(own).unwrap_or(f64::INFINITY)]
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
        let places = first.columns.as_ref().unwrap();
        let names =
            places.each_ref().map(|p| p.iter().map(|c| building.members[*c].id.as_str()).collect::<Vec<_>>());
        assert_eq!(names, [["C1-A1", "C2-A1"], ["C1-B1", "C2-B1"]]);
        let [a, b] = places.each_ref().map(|p| building.members[p[0]].solid);
        assert!((first.clear_m() - (b.min[0] - a.max[0])).abs() < 1e-12);
        // strips share out the slab across their span
        let (other, slab) = (&lines[1], &building.members[first.member].solid);
        assert_eq!(other.axis, 0);
        assert_eq!((first.clear.min[1], other.clear.max[1]), (slab.min[1], slab.max[1]));
        assert_eq!(first.clear.max[1], other.clear.min[1]);
    }

    /// A slab and columns of 0.4 m in some places.
    fn floor(edges: [[f64; 2]; 2], places: &[[f64; 2]]) -> Vec<Member> {
        let base = building::parse(building::EXAMPLE, Format::Toml, "example.toml").unwrap();
        let like = |id: &str| base.members.iter().find(|m| m.id == id).unwrap().clone();
        let solid = Aabb { min: [edges[0][0], edges[1][0], 3.0], max: [edges[0][1], edges[1][1], 3.2] };
        let slab = Member { id: "S".into(), solid, ..like("S1") };
        let column = |(i, [x, y]): (usize, &[f64; 2])| {
            let solid = Aabb { min: [x - 0.2, y - 0.2, 0.0], max: [x + 0.2, y + 0.2, 3.0] };
            Member { id: format!("C{i}"), solid, ..like("C1-A1") }
        };
        places.iter().enumerate().map(column).chain([slab]).collect()
    }

    fn ids(members: &[Member]) -> Vec<String> {
        of_slabs(&members.iter().collect::<Vec<_>>()).into_iter().map(|l| l.id).collect()
    }

    #[test]
    fn neighbours_are_next_in_their_row_whatever_stands_in_others() {
        let grid = [[0.0, 0.0], [5.0, 0.0], [0.0, 5.0], [5.0, 5.0], [2.5, 5.0]];
        assert_eq!(
            ids(&floor([[0.0, 5.0], [0.0, 5.0]], &grid)),
            ["S:C0|C1", "S:C2|C4", "S:C4|C3", "S:C0|C2", "S:C1|C3"]
        );
        // on the very edge, by round-off beyond it
        let members = floor([[0.1, 5.0], [0.3, 5.0]], &[[0.1, 0.1 + 0.2], [5.0, 0.3]]);
        assert_eq!(ids(&members), ["S:C0|C1"]);
    }

    #[test]
    fn strips_go_on_from_slab_to_slab_but_not_over_a_gap() {
        let mut members =
            floor([[-0.3, 5.3], [-0.3, 0.3]], &[[0.0, 0.0], [5.0, 0.0], [0.0, 5.0], [5.0, 5.0]]);
        let wing = Aabb { min: [-0.3, 0.3, 3.0], max: [0.3, 5.3, 3.2] };
        members.push(Member { id: "T".into(), solid: wing, ..members[4].clone() });
        // C1|C3 and C2|C3 are bridged by nothing
        assert_eq!(ids(&members), ["S:C0|C1", "T:C0|C2"]);
    }

    #[test]
    fn columns_side_by_side_are_one_place() {
        let members = floor([[-0.3, 9.3], [-0.3, 0.3]], &[[0.0, 0.0], [0.5, 0.0], [9.0, 0.0]]);
        let lines = of_slabs(&members.iter().collect::<Vec<_>>());
        assert_eq!((lines.len(), lines[0].columns.as_ref().unwrap()[0].len()), (1, 2));
        assert!((lines[0].clear_m() - (9.0 - 0.2 - 0.7)).abs() < 1e-9, "{}", lines[0].clear_m());
    }

    #[test]
    fn columns_that_end_at_beams_under_the_slab_are_its_own() {
        let mut members = floor([[-0.3, 5.3], [-0.3, 0.3]], &[[0.0, 0.0], [5.0, 0.0]]);
        members[..2].iter_mut().for_each(|column| column.solid.max[2] = 2.7);
        assert!(ids(&members).is_empty(), "nothing is between column and slab");
        let base = building::parse(building::EXAMPLE, Format::Toml, "example.toml").unwrap();
        let solid = Aabb { min: [0.0, -0.15, 2.7], max: [5.0, 0.15, 3.2] };
        let beam = base.members.iter().find(|m| m.kind == MemberKind::Beam).unwrap();
        members.push(Member { id: "B".into(), solid, axis: 0, ..beam.clone() });
        assert_eq!(ids(&members), ["S:C0|C1"]);
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
