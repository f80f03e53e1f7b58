//! Overlapping gross solids resolved into disjoint cells, each owned by one member.
//!
//! The grid of all face coordinates cuts every solid into cells; a cell under several solids
//! belongs to the one of highest precedence (footing, slab, wall, beam, column; then file order).
//! An opening of a plate is no part of it; what else lies there, such as a beam, owns its cells.
//! Volumes, masses, contact faces and the FE mesh all start from these cells, so that no volume is
//! counted twice. Members turned out of the axes own no cells: they yield to all others ([`super::clear`]), and only
//! their volumes are known here.

use super::clear::Clear;
use super::model::{Building, Member, MemberKind};
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;

/// Coordinates closer than this are the same plane \[m\]. Formwork tolerances are millimetres.
pub const COORDINATE_TOLERANCE_M: f64 = 1e-6;

/// Disjoint cells of a building.
#[derive(Debug, Clone)]
pub struct Partition {
    /// Sorted grid planes in x, y and z \[m\].
    pub planes: [Vec<f64>; 3],
    /// Owner (index into `Building::members`) of cell `(i, j, k)`, x fastest; `None` is air.
    pub owner: Vec<Option<usize>>,
    /// Turned members with the volume that their neighbours leave them \[m³\].
    turned_m3: Vec<(usize, f64)>,
    /// Cells of each member, x fastest.
    own: Vec<Vec<usize>>,
}

/// The rank that decides who owns a common volume; higher wins.
pub fn precedence(kind: MemberKind) -> u8 {
    match kind {
        MemberKind::Footing => 4,
        MemberKind::Slab => 3,
        MemberKind::Wall => 2,
        MemberKind::Beam => 1,
        MemberKind::Column | MemberKind::Brace => 0,
    }
}

impl Partition {
    /// Cuts the building's gross solids into disjoint cells.
    pub fn of(building: &Building) -> Self {
        let planes = std::array::from_fn(|axis| {
            let along_axes = building.members.iter().filter(|m| !m.is_skew());
            let solids = along_axes.flat_map(|m| m.openings.iter().chain([&m.solid]));
            distinct(solids.flat_map(|s| [s.min[axis], s.max[axis]]).collect())
        });
        let members: Vec<&Member> = building.members.iter().collect();
        let turned = (0..members.len()).filter(|i| members[*i].is_skew());
        let turned_m3 = turned.map(|i| (i, Clear::of(&members, i).volume_m3())).collect();
        Self { turned_m3, ..Self::on_planes(building, planes) }
    }

    /// The same on given planes, which must contain all faces of the solids: a cell belongs to the
    /// member of highest precedence (the first of equals) that contains it, but see `give_blocks`. Turned members are left out.
    pub fn on_planes(building: &Building, planes: [Vec<f64>; 3]) -> Self {
        let mut partition = Self::with_planes(planes, building);
        for kind in [MemberKind::Beam, MemberKind::Slab] {
            partition.give_blocks(building, kind);
        }
        partition.own = vec![Vec::new(); building.members.len()];
        for (index, owner) in partition.owner.iter().enumerate() {
            owner.iter().for_each(|member| partition.own[*member].push(index));
        }
        partition
    }

    /// Gives blocks of columns over their whole section to beams, then to slabs that meet there, the first of each kind first.
    ///
    /// The joint block where beams frame into a column belongs to the first of these beams: the column's clear height ends at the soffit of the deepest beam. Where a slab ends over a column, the
    /// column's head belongs to the slab: it would else go on beside the slab, with a part of its section and nothing above. What is cut away in preparation is cut clear of columns.
    fn give_blocks(&mut self, building: &Building, kind: MemberKind) {
        let n = self.count();
        let of_kind =
            |kind| building.members.iter().enumerate().filter(move |(_, m)| m.kind == kind && !m.is_skew());
        let takers = of_kind(kind).filter(|(_, taker)| !building.is_cut(&taker.id));
        let takers = Boxes::numbered(takers.map(|(index, taker)| (index, taker.solid)));
        for (column_index, column) in of_kind(MemberKind::Column) {
            let section =
                [0, 1].map(|i| cells_within(&self.planes[i], column.solid.min[i], column.solid.max[i]));
            for taker in takers.near(&column.solid, COORDINATE_TOLERANCE_M) {
                let solid = &building.members[taker].solid;
                let Some(common) = column.solid.intersection(solid, COORDINATE_TOLERANCE_M) else {
                    continue;
                };
                for k in cells_within(&self.planes[2], common.min[2], common.max[2]) {
                    let row = |j: usize| section[0].clone().map(move |i| (k * n[1] + j) * n[0] + i);
                    let layer: Vec<usize> = section[1].clone().flat_map(row).collect();
                    // none in an opening of a slab
                    if kind == MemberKind::Slab && layer.iter().all(|cell| self.owner[*cell] != Some(taker)) {
                        continue;
                    }
                    for cell in layer {
                        let slot = &mut self.owner[cell];
                        if *slot == Some(column_index) {
                            *slot = Some(taker);
                        }
                    }
                }
            }
        }
    }

    fn with_planes(planes: [Vec<f64>; 3], building: &Building) -> Self {
        let count: [usize; 3] = std::array::from_fn(|i| planes[i].len().saturating_sub(1));
        let mut owner: Vec<Option<usize>> = vec![None; count[0] * count[1] * count[2]];
        let within = |solid: &Aabb| -> [std::ops::Range<usize>; 3] {
            std::array::from_fn(|i| cells_within(&planes[i], solid.min[i], solid.max[i]))
        };
        // what is cut away in preparation leaves to others what it shares with them
        let is_cut: Vec<bool> = building.members.iter().map(|m| building.is_cut(&m.id)).collect();
        let rank = |index: usize| (!is_cut[index]).then(|| precedence(building.members[index].kind));
        for (index, member) in building.members.iter().enumerate().filter(|(_, m)| !m.is_skew()) {
            let range = within(&member.solid);
            let openings: Vec<_> = member.openings.iter().map(within).collect();
            for k in range[2].clone() {
                for j in range[1].clone() {
                    for i in range[0].clone() {
                        let slot = &mut owner[(k * count[1] + j) * count[0] + i];
                        let cut = |o: &[std::ops::Range<usize>; 3]| {
                            o[0].contains(&i) && o[1].contains(&j) && o[2].contains(&k)
                        };
                        if openings.iter().any(cut) {
                            continue;
                        }
                        if slot.is_none_or(|held| rank(held) < rank(index)) {
                            *slot = Some(index);
                        }
                    }
                }
            }
        }
        Self { planes, owner, turned_m3: Vec::new(), own: Vec::new() }
    }

    /// Number of cells in x, y and z.
    pub fn count(&self) -> [usize; 3] {
        std::array::from_fn(|i| self.planes[i].len().saturating_sub(1))
    }

    /// Owner of cell `(i, j, k)`.
    pub fn owner_at(&self, cell: [usize; 3]) -> Option<usize> {
        let n = self.count();
        self.owner[(cell[2] * n[1] + cell[1]) * n[0] + cell[0]]
    }

    /// The box of cell `(i, j, k)` \[m\].
    pub fn cell_box(&self, cell: [usize; 3]) -> Aabb {
        Aabb {
            min: std::array::from_fn(|i| self.planes[i][cell[i]]),
            max: std::array::from_fn(|i| self.planes[i][cell[i] + 1]),
        }
    }

    /// All owned cells with their owner, x fastest.
    pub fn cells(&self) -> impl Iterator<Item = ([usize; 3], usize)> + '_ {
        let owned = self.owner.iter().enumerate();
        owned.filter_map(|(index, owner)| owner.map(|owner| (self.cell(index), owner)))
    }

    /// The cells of a member, x fastest.
    pub fn cells_of(&self, member: usize) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.own[member].iter().map(|index| self.cell(*index))
    }

    /// The cells between two levels along an axis whose centres a solid contains along the others, with their owners.
    pub fn layer_within(&self, axis: usize, layer: usize, solid: &Aabb) -> Vec<([usize; 3], usize)> {
        let [x, y, z] = [0, 1, 2].map(|i| match i == axis {
            true => layer..(layer + 1).min(self.count()[i]),
            false => {
                let first = self.planes[i].partition_point(|p| *p <= solid.min[i]).saturating_sub(1);
                first..self.planes[i].partition_point(|p| *p < solid.max[i]).min(self.count()[i])
            }
        });
        let cells = z.flat_map(|k| y.clone().map(move |j| (j, k)));
        let cells = cells.flat_map(|(j, k)| x.clone().map(move |i| [i, j, k]));
        let inside = |cell: &[usize; 3]| {
            let center = self.cell_box(*cell).center();
            (0..3).all(|i| i == axis || (solid.min[i] < center[i] && center[i] < solid.max[i]))
        };
        cells.filter(inside).filter_map(|cell| Some((cell, self.owner_at(cell)?))).collect()
    }

    fn cell(&self, index: usize) -> [usize; 3] {
        let n = self.count();
        [index % n[0], (index / n[0]) % n[1], index / (n[0] * n[1])]
    }

    /// The member that owns a place.
    pub fn member_at(&self, point_m: [f64; 3]) -> Option<usize> {
        const NEAR_M: f64 = 1e-9;
        let n = self.count();
        // a point on a plane lies in the cells on both sides of it
        let [x, y, z] = [0, 1, 2].map(|axis: usize| {
            let (planes, at) = (&self.planes[axis], point_m[axis]);
            let first = planes.partition_point(|p| *p < at - NEAR_M).saturating_sub(1);
            first..planes.partition_point(|p| *p <= at + NEAR_M).min(n[axis])
        });
        for k in z {
            for j in y.clone() {
                for i in x.clone().filter(|i| self.cell_box([*i, j, k]).contains(point_m, NEAR_M)) {
                    if let Some(owner) = self.owner[i + n[0] * (j + n[1] * k)] {
                        return Some(owner);
                    }
                }
            }
        }
        None
    }

    /// Volume owned by each member \[m³\], indexed like `Building::members`.
    pub fn volumes(&self, members: usize) -> Vec<f64> {
        let mut volume = vec![0.0; members];
        for (cell, owner) in self.cells() {
            volume[owner] += self.cell_box(cell).volume();
        }
        for (member, own) in &self.turned_m3 {
            volume[*member] += own;
        }
        volume
    }

    /// The boxes that make up one member's own volume, merged along x, then y, then z.
    pub fn boxes_of(&self, member: usize) -> Vec<Aabb> {
        let cells: Vec<Aabb> = self.cells_of(member).map(|cell| self.cell_box(cell)).collect();
        merged(&cells)
    }
}

/// Boxes of a grid merged along x, then y, then z where they fill a larger box.
pub fn merged(cells: &[Aabb]) -> Vec<Aabb> {
    (0..3).fold(cells.to_vec(), merge_along)
}

/// Sorted coordinates with those closer than the tolerance merged.
fn distinct(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.dedup_by(|a, b| *a - *b < COORDINATE_TOLERANCE_M);
    values
}

/// The cells between two planes.
fn cells_within(planes: &[f64], low: f64, high: f64) -> std::ops::Range<usize> {
    let at = |value: f64| planes.partition_point(|p| *p < value - COORDINATE_TOLERANCE_M);
    at(low)..at(high)
}

/// Merges boxes that touch along one axis and agree in the two others.
fn merge_along(mut boxes: Vec<Aabb>, axis: usize) -> Vec<Aabb> {
    let others = [(axis + 1) % 3, (axis + 2) % 3];
    boxes.sort_by(|a, b| {
        let key =
            |x: &Aabb| [x.min[others[1]], x.min[others[0]], x.max[others[1]], x.max[others[0]], x.min[axis]];
        key(a)
            .iter()
            .zip(key(b))
            .map(|(p, q)| p.total_cmp(&q))
            .find(|o| o.is_ne())
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let mut merged: Vec<Aabb> = Vec::new();
    for next in boxes {
        if let Some(last) = merged.last_mut() {
            let same = others.iter().all(|&o| {
                (last.min[o] - next.min[o]).abs() < COORDINATE_TOLERANCE_M
                    && (last.max[o] - next.max[o]).abs() < COORDINATE_TOLERANCE_M
            });
            if same && (last.max[axis] - next.min[axis]).abs() < COORDINATE_TOLERANCE_M {
                last.max[axis] = next.max[axis];
                continue;
            }
        }
        merged.push(next);
    }
    merged
}
