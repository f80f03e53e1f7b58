//! Axes on which the columns of a floor stand, and axes in the middle of the spans that a slab bridges by itself.
//!
//! A slab without beams bends across its spans as well as along them: what is far from a column does not turn with it, yields later than what is near, and has its own weight to bear. A piece about a column as wide as half of the spans beside it is too stiff and
//! too strong for that (docs/decisions/floors.md has the figures). With a piece in the middle of each span and of each panel the floor is a coarse grillage (Hambly, Bridge Deck Behaviour, 1976, chapter 3) with its yield lines.

use crate::base::geom::Aabb;
use crate::building::rows::{MEETS_M, Row, SAME_ROW_M, rows};
use crate::building::{Building, MemberKind};
use std::collections::BTreeSet;

/// The axes of a floor along x and y.
#[derive(Debug, Clone)]
pub struct FloorAxes {
    /// In order.
    pub list: [Vec<Row>; 2],
    /// What they are.
    pub kind: Kind,
}

/// What the axes of a floor are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Those of columns, with beams in all spans.
    Columns,
    /// Also those in the middle of spans, with beams in all of them.
    Middles,
    /// Also those in the middle of spans, of which a slab bridges one by itself.
    OpenSpans,
}

/// What lies between two axes beside each other.
#[derive(Debug, Clone, Copy)]
pub struct Gap {
    /// The axes \[m\].
    pub axes_m: [f64; 2],
    /// Where the joints at the axes end, or the axes themselves where no columns stand \[m\].
    pub faces_m: [f64; 2],
    /// Length between the faces of the columns of the span that it is in \[m\].
    pub span_m: f64,
    /// Whether columns stand on the axis along it.
    pub has_columns: bool,
}

impl FloorAxes {
    /// Of the columns that meet a floor between two heights and its edges, removed ones included; with middles of spans where a slab bridges one by itself, or if they are wanted `everywhere`.
    pub fn of(building: &Building, edges: &[[f64; 2]; 2], [low, high]: [f64; 2], everywhere: bool) -> Self {
        let meets = |s: &Aabb| s.min[2] <= high + MEETS_M && s.max[2] >= low - MEETS_M;
        let inside = |s: &Aabb| (0..2).all(|i| (edges[i][0]..=edges[i][1]).contains(&s.center()[i]));
        let (mut columns, mut beams, mut walls) = (Vec::new(), Vec::new(), Vec::new());
        for member in building.members.iter().filter(|m| meets(&m.solid)) {
            match member.kind {
                MemberKind::Column if inside(&member.solid) => columns.push(member.solid),
                MemberKind::Beam => beams.push(member.solid),
                MemberKind::Wall => walls.push(member.solid),
                _ => {}
            }
        }
        let along = |i: usize| rows(columns.iter().map(|s| [s.center()[i], s.size()[i]]).collect());
        let list = [along(0), along(1)];
        let floor = Spans { columns, beams, walls, list: &list };
        let kind = match (floor.any_without_beam(), everywhere) {
            (true, _) => Kind::OpenSpans,
            (false, true) => Kind::Middles,
            (false, false) => return Self { list, kind: Kind::Columns },
        };
        Self { list: [0, 1].map(|i| floor.with_middles(i)), kind }
    }

    /// From a cell to the next one along x or y. Only where columns stand the floor is as stiff as a joint.
    pub fn gap(&self, cell: [usize; 2], i: usize) -> Gap {
        let [own, next] = [0, 1].map(|k| self.list[i][cell[i] + k]);
        let has_columns = self.list[1 - i][cell[1 - i]].width_m > 0.0;
        let half = |axis: Row| if has_columns { 0.5 * axis.width_m } else { 0.0 };
        let faces_m = [own.at_m + half(own), next.at_m - half(next)];
        // a span has one axis without columns at most, in its middle
        let parts = if own.width_m > 0.0 && next.width_m > 0.0 { 1.0 } else { 2.0 };
        let span_m = parts * (faces_m[1] - faces_m[0]);
        Gap { axes_m: [own.at_m, next.at_m], faces_m, span_m, has_columns }
    }
}

/// What stands on and between the axes of a floor.
struct Spans<'a> {
    columns: Vec<Aabb>,
    beams: Vec<Aabb>,
    walls: Vec<Aabb>,
    list: &'a [Vec<Row>; 2],
}

impl Spans<'_> {
    /// Whether two columns are neighbours without a beam between them.
    fn any_without_beam(&self) -> bool {
        let pairs = |a: Vec<usize>, b: Vec<usize>| -> Vec<[usize; 2]> {
            a.iter().flat_map(|a| b.iter().map(|b| [*a, *b])).collect()
        };
        let columns = self.columns.iter().flat_map(|c| pairs(self.near(0, c), self.near(1, c)));
        let columns: BTreeSet<[usize; 2]> = columns.collect();
        (0..2).any(|i| {
            let bridged = self.beams.iter().flat_map(|b| pairs(self.crossed(i, b), self.near(1 - i, b)));
            let bridged: BTreeSet<[usize; 2]> = bridged.collect();
            columns.iter().any(|column| {
                let mut next = *column;
                next[i] += 1;
                columns.contains(&next) && !bridged.contains(&[column[i], column[1 - i]])
            })
        })
    }

    /// The axes along x or y that a member stands on.
    fn near(&self, i: usize, solid: &Aabb) -> Vec<usize> {
        let is_on = |axis: &Row| (solid.center()[i] - axis.at_m).abs() < SAME_ROW_M;
        (0..self.list[i].len()).filter(|k| is_on(&self.list[i][*k])).collect()
    }

    /// The spans along x or y, by the axes that they begin at, whose middles a member crosses.
    fn crossed(&self, i: usize, solid: &Aabb) -> Vec<usize> {
        self.middles(i).enumerate().filter(|(_, at_m)| crosses(solid, i, *at_m)).map(|(k, _)| k).collect()
    }

    /// The middles of the spans along x or y \[m\].
    fn middles(&self, i: usize) -> impl Iterator<Item = f64> {
        self.list[i].windows(2).map(|span| 0.5 * (span[0].at_m + span[1].at_m))
    }

    /// The axes along x or y, and those in the middles between them; none where a wall in the span holds the floor.
    fn with_middles(&self, i: usize) -> Vec<Row> {
        let mut all = self.list[i].clone();
        let is_held =
            |at_m: &f64| self.walls.iter().any(|w| w.size()[i] > w.size()[1 - i] && crosses(w, i, *at_m));
        all.extend(self.middles(i).filter(|m| !is_held(m)).map(|at_m| Row { at_m, width_m: 0.0 }));
        all.sort_by(|a, b| a.at_m.total_cmp(&b.at_m));
        all
    }
}

/// Whether a member extends to both sides of a place along x or y.
fn crosses(solid: &Aabb, i: usize, at_m: f64) -> bool {
    solid.min[i] < at_m && solid.max[i] > at_m
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(x: f64, y: f64) -> Aabb {
        Aabb { min: [x - 0.2, y - 0.2, 0.0], max: [x + 0.2, y + 0.2, 3.0] }
    }

    fn beam(from: [f64; 2], to: [f64; 2]) -> Aabb {
        Aabb { min: [from[0] - 0.1, from[1] - 0.1, 2.5], max: [to[0] + 0.1, to[1] + 0.1, 3.0] }
    }

    #[test]
    fn spans_without_a_beam_get_middles_but_over_walls() {
        let columns: Vec<Aabb> =
            [0.0, 6.0, 12.0].iter().flat_map(|x| [column(*x, 0.0), column(*x, 5.0)]).collect();
        let along = |i: usize| rows(columns.iter().map(|s| [s.center()[i], s.size()[i]]).collect());
        let list = [along(0), along(1)];
        let perimeter = vec![
            beam([0.0, 0.0], [12.0, 0.0]),
            beam([0.0, 5.0], [12.0, 5.0]),
            beam([0.0, 0.0], [0.0, 5.0]),
            beam([12.0, 0.0], [12.0, 5.0]),
        ];
        let wall = Aabb { min: [6.2, -0.1, 0.0], max: [11.8, 0.1, 3.0] };
        let mut spans = Spans { columns: columns.clone(), beams: perimeter, walls: vec![wall], list: &list };
        // the span in the middle, across, has none
        assert!(spans.any_without_beam());
        assert_eq!(spans.with_middles(0).iter().map(|a| a.at_m).collect::<Vec<_>>(), [0.0, 3.0, 6.0, 12.0]);
        assert_eq!(spans.with_middles(1).iter().map(|a| a.at_m).collect::<Vec<_>>(), [0.0, 2.5, 5.0]);
        spans.beams.push(beam([6.0, 0.0], [6.0, 5.0]));
        assert!(!spans.any_without_beam());
    }
}
