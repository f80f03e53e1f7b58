//! Cells of a floor between lines along x and y, and what of the floor lies in them.

use super::bodies::of_boxes;
use crate::base::geom::Aabb;
use crate::building::Building;
use crate::graph::Structure;
use crate::mbs::model::Body;
use std::collections::BTreeMap;

/// Cells of a floor.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    /// Members of the floor.
    pub members: Vec<usize>,
    /// Lower and upper bounds along x and y \[m\].
    pub bounds: [Vec<[f64; 2]>; 2],
}

/// A piece of a floor.
#[derive(Debug, Clone)]
pub struct Piece {
    /// Its cell, along x and y.
    pub cell: [usize; 2],
    /// Its boxes, with their members.
    pub boxes: Vec<(usize, Aabb)>,
}

impl Cells {
    /// The pieces that have a volume.
    pub fn pieces(&self, structure: &Structure) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for (i, [x0, x1]) in self.bounds[0].iter().enumerate() {
            for (j, [y0, y1]) in self.bounds[1].iter().enumerate() {
                let cell = Aabb { min: [*x0, *y0, f64::NEG_INFINITY], max: [*x1, *y1, f64::INFINITY] };
                let inside = |m: &usize| {
                    let own = structure.boxes(*m).iter().filter_map(|b| b.intersection(&cell, 1e-9));
                    own.map(|b| (*m, b)).collect::<Vec<_>>()
                };
                let boxes: Vec<(usize, Aabb)> = self.members.iter().flat_map(inside).collect();
                if !boxes.is_empty() {
                    pieces.push(Piece { cell: [i, j], boxes });
                }
            }
        }
        pieces
    }

    /// The same cells of some members more than those of the floor, columns for instance: none of them ends at an edge of the floor.
    #[must_use]
    pub fn with(mut self, members: &[usize]) -> Self {
        self.members = members.to_vec();
        for own in &mut self.bounds {
            own.first_mut().into_iter().for_each(|b| b[0] = f64::NEG_INFINITY);
            own.last_mut().into_iter().for_each(|b| b[1] = f64::INFINITY);
        }
        self
    }

    /// Lower and upper edge of some members along x and y \[m\].
    pub fn edges(structure: &Structure, members: &[usize]) -> [[f64; 2]; 2] {
        let boxes = || members.iter().flat_map(|m| structure.boxes(*m));
        [0, 1].map(|i| {
            [
                boxes().map(|b| b.min[i]).fold(f64::INFINITY, f64::min),
                boxes().map(|b| b.max[i]).fold(f64::NEG_INFINITY, f64::max),
            ]
        })
    }
}

impl Piece {
    /// Its body.
    pub fn body(&self, building: &Building, structure: &Structure, id: String, rules: Vec<String>) -> Body {
        of_boxes(building, structure, &self.boxes, id, rules)
    }

    /// Name of a piece: that of its floor, and its cell counted from one.
    pub fn name(&self, floor: &str) -> String {
        format!("{floor}/{}-{}", self.cell[0] + 1, self.cell[1] + 1)
    }

    /// Square of the distance of a point from it \[m²\].
    pub fn distance2(&self, point: [f64; 3]) -> f64 {
        let to = |b: &Aabb| -> f64 {
            (0..3).map(|i| (b.min[i] - point[i]).max(point[i] - b.max[i]).max(0.0).powi(2)).sum()
        };
        self.boxes.iter().map(|(_, b)| to(b)).fold(f64::INFINITY, f64::min)
    }
}

/// Pieces by their cells.
pub fn by_cell(pieces: &[Piece]) -> BTreeMap<[usize; 2], usize> {
    pieces.iter().enumerate().map(|(i, p)| (p.cell, i)).collect()
}

/// Pieces beside each other along x or y: `(axis, the lower one, the upper one)`.
pub fn neighbours(pieces: &[Piece]) -> Vec<(usize, usize, usize)> {
    let places = by_cell(pieces);
    let next = |a: usize, axis: usize| {
        let mut cell = pieces[a].cell;
        cell[axis] += 1;
        places.get(&cell).copied()
    };
    let of = |a: usize| [0, 1].into_iter().filter_map(move |axis| Some((axis, a, next(a, axis)?)));
    (0..pieces.len()).flat_map(of).collect()
}

/// Pieces that touch at a corner only.
pub fn diagonals(pieces: &[Piece]) -> Vec<[usize; 2]> {
    let places = by_cell(pieces);
    let across = |a: usize| {
        let [i, j] = pieces[a].cell;
        let cells = [j.checked_sub(1), Some(j + 1)].map(|k| k.map(|k| [i + 1, k]));
        cells.into_iter().flatten().filter_map(|cell| places.get(&cell)).map(|b| [a, *b]).collect::<Vec<_>>()
    };
    (0..pieces.len()).flat_map(across).collect()
}
