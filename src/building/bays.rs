//! Which bays of a grid are built, and the rectangles of slab that cover them: plans other than rectangles.

use super::fields::Fields;
use super::grid::clean;
use super::openings;
use super::partition::COORDINATE_TOLERANCE_M;
use crate::base::diagnostic::Diagnostic;
use crate::base::tree::Node;

/// The bays between axes, those along x first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bays {
    /// Along x and y; none along a direction with one axis.
    count: [usize; 2],
    built: Vec<bool>,
}

/// Bays from one pair of axes to another: places among the axes along x and y.
pub type BayRange = [[usize; 2]; 2];

impl Bays {
    /// All between so many axes along x and y.
    pub fn all(axes: [usize; 2]) -> Self {
        let count = axes.map(|n| n.saturating_sub(1));
        Self { count, built: vec![true; count[0] * count[1]] }
    }

    /// Leaves the bays of a block out.
    pub fn leave_out(&mut self, [[i0, j0], [i1, j1]]: BayRange) {
        for j in j0..j1 {
            self.built[j * self.count[0] + i0..j * self.count[0] + i1].fill(false);
        }
    }

    /// Those of a grid but for the rectangles of its key `without_bays`; `None` after an error.
    pub(super) fn read(fields: Fields<'_>, axes: [&[f64]; 2], found: &mut Vec<Diagnostic>) -> Option<Self> {
        let mut bays = Self::all(axes.map(<[f64]>::len));
        let corners = openings::rectangles(fields, "without_bays")?;
        let nodes = fields.child("without_bays").map_or(&[][..], Node::items);
        let before = found.len();
        for (rectangle, node) in corners.into_iter().zip(nodes) {
            let on_axis = |d: usize, at: f64| {
                axes[d].iter().position(|axis| (axis - at).abs() < COORDINATE_TOLERANCE_M)
            };
            let range = |d: usize| {
                let [a, b] = [on_axis(d, rectangle[0][d])?, on_axis(d, rectangle[1][d])?];
                (a != b).then(|| [a.min(b), a.max(b)])
            };
            match (range(0), range(1)) {
                (Some([i0, i1]), Some([j0, j1])) => bays.leave_out([[i0, j0], [i1, j1]]),
                _ => found.push(
                    Diagnostic::error("bad-bays", "this rectangle is not one of bays")
                        .at(node.span, "its corners are not on different axes along x and y")
                        .help("give as `from` and `to` the coordinates of axes of the grid, such as [x[1], y[1]] and [x[2], y[2]]"),
                ),
            }
        }
        if found.len() == before && !nodes.is_empty() && !bays.built.contains(&true) {
            let error = Diagnostic::error("bad-bays", "no bay of the grid is left")
                .at(fields.span("without_bays"), "these are all of them");
            found.push(error);
        }
        (found.len() == before).then_some(bays)
    }

    /// Whether a bay is built; none is beyond the outer axes.
    fn has(&self, i: isize, j: isize) -> bool {
        let inside = |k: isize, d: usize| usize::try_from(k).ok().filter(|k| *k < self.count[d]);
        match (inside(i, 0), inside(j, 1)) {
            (Some(i), Some(j)) => self.built[j * self.count[0] + i],
            _ => false,
        }
    }

    fn is_whole(&self) -> bool {
        !self.built.contains(&false)
    }

    /// Whether a column stands where two axes meet: at a bay that is built, or in a grid without bays.
    pub fn has_column(&self, i: usize, j: usize) -> bool {
        let (i, j) = (i as isize, j as isize);
        self.is_whole() || [i - 1, i].iter().any(|i| [j - 1, j].iter().any(|j| self.has(*i, *j)))
    }

    /// Whether a beam runs along a direction (0: x, 1: y) from where two axes meet to the next ones: at a bay that is built, on the outline only or on all axes.
    pub fn has_beam(&self, along: usize, [i, j]: [usize; 2], outline_only: bool) -> bool {
        if [i, j][along] >= self.count[along] {
            return false;
        }
        if self.count[1 - along] == 0 {
            return true;
        }
        let (i, j) = (i as isize, j as isize);
        let beside = if along == 0 { [[i, j - 1], [i, j]] } else { [[i - 1, j], [i, j]] };
        match beside.iter().filter(|[i, j]| self.has(*i, *j)).count() {
            0 => false,
            1 => true,
            _ => !outline_only,
        }
    }

    /// Rectangles of bays that cover what is built: rows along x, joined with the next ones where these are alike. One for a grid without bays.
    pub fn blocks(&self) -> Vec<BayRange> {
        if self.is_whole() {
            return vec![[[0, 0], self.count]];
        }
        let mut blocks: Vec<BayRange> = Vec::new();
        for j in 0..self.count[1] {
            let mut i = 0;
            while i < self.count[0] {
                let run = (i..self.count[0]).take_while(|k| self.has(*k as isize, j as isize)).count();
                let end = i + run;
                match blocks.iter_mut().find(|b| run > 0 && b[1] == [end, j] && b[0][0] == i) {
                    Some(below) => below[1][1] = j + 1,
                    None if run > 0 => blocks.push([[i, j], [end, j + 1]]),
                    None => {}
                }
                i = end + 1;
            }
        }
        blocks
    }

    /// Edges of the slab over a block along a direction, lower and upper \[m\]. It reaches beyond its axes where a bay beside it is not built, and begins where such a neighbour ends.
    pub fn edges(&self, block: &BayRange, along: usize, axes: &[f64], overhang_m: f64) -> [f64; 2] {
        let [low, high] = [block[0][along], block[1][along]];
        let reaches = |outside: isize, of: [usize; 2]| {
            (of[0]..of[1].max(of[0] + 1)).any(|k| match along {
                0 => !self.has(outside, k as isize),
                _ => !self.has(k as isize, outside),
            })
        };
        let own = [block[0][1 - along], block[1][1 - along]];
        let edge = |axis: usize, outside: isize, outward: f64| {
            if reaches(outside, own) {
                return clean(axes[axis] + outward * overhang_m);
            }
            // the blocks beyond the axis reach over it towards this one if a part of their side is free
            let facing = self.blocks().into_iter().filter(|other| {
                let at = if outward < 0.0 { other[1][along] } else { other[0][along] };
                at == axis && other[0][1 - along] < own[1] && own[0] < other[1][1 - along]
            });
            let inside = outside - outward as isize;
            let mut facing = facing.map(|other| [other[0][1 - along], other[1][1 - along]]);
            let over = if facing.any(|of| reaches(inside, of)) { -outward * overhang_m } else { 0.0 };
            clean(axes[axis] + over)
        };
        [edge(low, low as isize - 1, -1.0), edge(high, high as isize, 1.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bays between so many axes without some single ones.
    fn without(axes: [usize; 2], out: &[[usize; 2]]) -> Bays {
        let mut bays = Bays::all(axes);
        out.iter().for_each(|[i, j]| bays.leave_out([[*i, *j], [i + 1, j + 1]]));
        bays
    }

    #[test]
    fn an_angle_has_eight_columns_a_beam_on_each_edge_and_two_slabs_that_meet() {
        let (bays, axes) = (without([3, 3], &[[1, 1]]), [0.0, 5.0, 10.0]);
        let columns = |b: &Bays| (0..9).filter(|k| b.has_column(k % 3, k / 3)).count();
        assert_eq!((columns(&bays), columns(&Bays::all([3, 3]))), (8, 9));
        let beams = |b: &Bays, outline| {
            let at = |along| (0..9).filter(|k| b.has_beam(along, [k % 3, k / 3], outline)).count();
            (at(0), at(1))
        };
        // the outline has two long edges, two short ones and two inner ones of one bay each, either way
        assert_eq!((beams(&bays, true), beams(&bays, false)), ((4, 4), (5, 5)));
        assert_eq!((beams(&Bays::all([3, 3]), true), beams(&Bays::all([3, 3]), false)), ((4, 4), (6, 6)));
        let blocks = bays.blocks();
        assert_eq!(blocks, [[[0, 0], [2, 1]], [[0, 1], [1, 2]]]);
        let edges = |k: usize| [0, 1].map(|along| bays.edges(&blocks[k], along, &axes, 0.25));
        // the first reaches over the axis in the middle beside the bay that is not there, and the second begins at its edge
        assert_eq!(edges(0), [[-0.25, 10.25], [-0.25, 5.25]]);
        assert_eq!(edges(1), [[-0.25, 5.25], [5.25, 10.25]]);
    }

    #[test]
    fn slabs_meet_whichever_is_the_wider() {
        let (bays, axes) = (without([4, 3], &[[0, 0], [2, 0]]), [0.0, 4.0, 8.0, 12.0]);
        let blocks = bays.blocks();
        assert_eq!(blocks, [[[1, 0], [2, 1]], [[0, 1], [3, 2]]]);
        assert_eq!(bays.edges(&blocks[0], 1, &axes[..3], 0.25), [-0.25, 3.75]);
        assert_eq!(bays.edges(&blocks[1], 1, &axes[..3], 0.25), [3.75, 8.25]);
        assert_eq!(bays.edges(&blocks[0], 0, &axes, 0.25), [3.75, 8.25]);
    }

    #[test]
    fn a_row_of_columns_is_a_grid_without_bays() {
        let row = Bays::all([3, 1]);
        assert!((0..3).all(|i| row.has_column(i, 0)));
        assert!(
            row.has_beam(0, [0, 0], true) && row.has_beam(0, [1, 0], true) && !row.has_beam(0, [2, 0], true)
        );
        assert_eq!(row.blocks(), [[[0, 0], [2, 0]]]);
        assert_eq!(row.edges(&row.blocks()[0], 1, &[3.0], 0.2), [2.8, 3.2]);
    }
}
