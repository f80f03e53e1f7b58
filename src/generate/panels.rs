//! Slabs bend both ways at once: springs across the panels between four pieces.
//!
//! A plate of bending stiffness `D = E t³ / (12 (1 - ν²))` bears `M_x = D (κ_x + ν κ_y)` (Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells, 1959, eqs. 37 and 38): a beam `D (1 - ν²) κ_x` whatever the other curvature. With springs along the axes alone a slab whose
//! curvatures have different signs, as about columns beside a lost one, is up to `1 / (1 - ν)` times too stiff. In each panel of the sides `a` and `b` two more springs join the pieces at opposite corners; they bend about the line across. A diagonal of length `L` has
//! the curvature `κ_d = (a² κ_x + b² κ_y ± 2 a b κ_xy) / L²`, and with `k = ν D L² / (2 a b)` against the rotation `L κ_d` both store
//!
//! `½ ν D (a³/b κ_x² + b³/a κ_y² + 2 a b κ_x κ_y + 4 a b κ_xy²)`,
//!
//! which is the term that springs along the axes lack. What else is in it is taken from these: along `a` they keep `D (1 - ν a²/b²)` of a unit of width, and `D (1 - 3 ν)` of the twist. In panels of unlike sides less of `ν` is coupled, so that [`LEAST_KEPT`] is kept.
//!
//! A span whose ends are clamped and sink apart is bent in both senses, and the diagonals do not turn: its stiffness against displacement across stays what it is. A diagonal yields at `½ ν L m_p` with the plastic moment `m_p` of a unit of width, which
//! springs along bear less by [`GIVEN`] of that.

use super::beam_ends::YieldingEnds;
use super::cells::Piece;
use super::crossing::Cut;
use crate::building::Building;
use crate::mbs::model::{Bending, Body, Bushing, Origin};
use std::collections::BTreeMap;

/// Least share of their bending stiffness that springs along the axes keep.
const LEAST_KEPT: f64 = 0.3;
/// Least share of their stiffnesses that is left to them by each panel: beside an opening there is less slab in a cut than a panel takes for its own.
const LEAST_LEFT: f64 = 0.05;
/// Largest Poisson's ratio that is coupled: the twist keeps `1 - 3 ν`.
const MOST_COUPLED: f64 = 0.3;
/// How much of the resistance of springs across is taken from those along: all of it where a span is bent one way, nothing where its ends are clamped and sink, since springs across do not turn then.
const GIVEN: f64 = 0.5;

/// The panel between four pieces of a floor.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Its pieces at opposite corners.
    diagonals: [[usize; 2]; 2],
    /// The cuts through its sides along x and along y.
    cuts: [[usize; 2]; 2],
    /// What of its sides bends along x and y, and its middle \[m\].
    sides_m: [f64; 2],
    middle_m: [f64; 3],
    /// Poisson's ratio as far as it is coupled, and the share of the width that bends as a plate.
    poisson: f64,
    share: f64,
    /// Bending stiffness of the slab by itself, `E t³ / 12` \[N m\].
    bending_nm: f64,
}

/// What springs across panels have of the resistance of the slab in a cut.
#[derive(Debug, Clone, Default)]
pub struct Given {
    /// As much of its width \[m\].
    width_m: f64,
    /// How the slab yields, if it does.
    slab: Option<Yielding>,
}

/// The resistance of the slab in a cut.
#[derive(Debug, Clone)]
struct Yielding {
    /// The curve of the cut.
    curve: String,
    /// Its moment without axial force \[N m\], and that of a unit of width of the slab \[N m / m\].
    whole_nm: f64,
    per_width_nm_m: f64,
}

impl Panel {
    /// Those between four pieces that are joined along all sides.
    pub fn all(cuts: &[Cut]) -> Vec<Self> {
        let after: BTreeMap<(usize, usize), usize> =
            cuts.iter().enumerate().map(|(i, c)| ((c.axis, c.pieces[0]), i)).collect();
        let panel = |(low_x, cut): (usize, &Cut)| {
            let [corner, beside] = cut.pieces;
            let [low_y, high_y] = [*after.get(&(1, corner))?, *after.get(&(1, beside))?];
            let above = cuts[low_y].pieces[1];
            let high_x = *after.get(&(0, above)).filter(|i| cuts[**i].pieces[1] == cuts[high_y].pieces[1])?;
            Self::of(cuts, [[low_x, high_x], [low_y, high_y]])
        };
        cuts.iter().enumerate().filter(|(_, c)| c.axis == 0).filter_map(panel).collect()
    }

    fn of(cuts: &[Cut], sides: [[usize; 2]; 2]) -> Option<Self> {
        let mean = |[i, j]: [usize; 2], of: &dyn Fn(&Cut) -> f64| 0.5 * (of(&cuts[i]) + of(&cuts[j]));
        let [a, b] = sides.map(|pair| mean(pair, &|c| c.length_m));
        let all = || sides.iter().flatten().map(|i| &cuts[*i]);
        let slabs: Vec<(f64, f64)> = all().map(|c| c.plane.slab_nm()).collect::<Option<_>>()?;
        let bending_nm = 0.25 * slabs.iter().map(|s| s.0).sum::<f64>();
        let least = (a / b).powi(2).min((b / a).powi(2));
        let poisson = slabs[0].1.min(MOST_COUPLED).min((1.0 - LEAST_KEPT) * least);
        let share = all().map(|c| c.sum.plate_share).fold(1.0, f64::min);
        let [[low_x, high_x], [low_y, high_y]] = sides;
        let (low, high) = (cuts[low_x].pieces, cuts[high_x].pieces);
        let middle_m = [cuts[low_x].point_m[0], cuts[low_y].point_m[1], mean(sides[0], &|c| c.point_m[2])];
        debug_assert!(cuts[low_y].pieces[1] == high[0] && cuts[high_y].pieces == [low[1], high[1]]);
        (poisson * share > 0.0).then(|| Self {
            diagonals: [[low[0], high[1]], [low[1], high[0]]],
            cuts: sides,
            sides_m: [a, b],
            middle_m,
            poisson,
            share,
            bending_nm,
        })
    }

    /// Bending stiffness as a plate, as far as the curvatures are coupled \[N m\].
    fn plate_nm(&self) -> f64 {
        self.bending_nm / (1.0 - self.poisson * self.poisson)
    }

    /// Stiffness of the springs across it \[N m/rad\].
    fn stiffness_nm_rad(&self) -> f64 {
        let [a, b] = self.sides_m;
        self.share * self.poisson * self.plate_nm() * (a * a + b * b) / (2.0 * a * b)
    }

    /// Takes from the springs along its sides what those across it have.
    pub fn take(&self, cuts: &mut [Cut]) {
        for (axis, pair) in self.cuts.iter().enumerate() {
            let along = self.poisson * (self.sides_m[axis] / self.sides_m[1 - axis]).powi(2);
            // each of both sides has half of the panel beside it
            let width_m = 0.5 * self.share * self.sides_m[1 - axis];
            for cut in pair {
                let Cut { sum, given, .. } = &mut cuts[*cut];
                let left = |stiffness: f64, more: f64| (stiffness + more).max(LEAST_LEFT * stiffness);
                sum.bending =
                    left(sum.bending, width_m * (self.plate_nm() * (1.0 - along) - self.bending_nm));
                sum.torsion = left(sum.torsion, -2.0 * width_m * self.poisson * self.plate_nm());
                given.width_m += GIVEN * width_m * along;
            }
        }
    }

    /// Its springs between the bodies of a floor.
    pub fn springs(&self, cuts: &[Cut], bodies: &[Body], yielding: &mut YieldingEnds) -> [Bushing; 2] {
        let [a, b] = self.sides_m;
        let length_m = libm::hypot(a, b);
        let stiffness_nm_rad = self.stiffness_nm_rad();
        let width_m = 0.5 * self.share * self.poisson * length_m;
        // beside an opening a cut may have no slab at the faces of its columns
        let slabs = self.cuts.iter().flatten().filter_map(|i| cuts[*i].given.slab.as_ref());
        let slabs = slabs.filter(|slab| slab.per_width_nm_m > 0.0);
        let weakest = slabs.min_by(|s, t| s.per_width_nm_m.total_cmp(&t.per_width_nm_m));
        let bending = match weakest {
            Some(slab) => {
                let share = width_m * slab.per_width_nm_m / slab.whole_nm;
                let curve = yielding.across(&slab.curve, share, stiffness_nm_rad);
                Bending::Curve { curve, strength_factor: 1.0 }
            }
            None => Bending::Elastic { stiffness_nm_rad },
        };
        [1.0, -1.0].map(|sense| {
            let [of_a, of_b] = self.diagonals[usize::from(sense < 0.0)].map(|p| &bodies[p]);
            let [x, y] = [sense * a / length_m, b / length_m];
            Bushing {
                bending: [bending.clone(), Bending::Elastic { stiffness_nm_rad: 0.0 }],
                origin: Origin { entries: Vec::new(), ..of_a.origin.clone() },
                ..Bushing::free(
                    format!("{}|{}", of_a.id, of_b.id),
                    Some(of_a.id.clone()),
                    of_b.id.clone(),
                    self.middle_m,
                    [[x, y, 0.0], [-y, x, 0.0], [0.0, 0.0, 1.0]],
                )
            }
        })
    }
}

impl Cut {
    /// Bending of its spring without what springs across panels have of its resistance.
    pub fn give(
        &mut self,
        building: &Building,
        pieces: &[Piece],
        bending: Bending,
        yielding: &mut YieldingEnds,
    ) -> Bending {
        let Bending::Curve { curve, .. } = &bending else { return bending };
        if self.given.width_m == 0.0 {
            return bending;
        }
        let Some([slab_nm, whole_nm]) = yielding.moments_of(building, curve, &self.beam(pieces)) else {
            return bending;
        };
        let curve = curve.clone();
        let per_width_nm_m = slab_nm / self.plane.slab_m;
        let strength_factor = (1.0 - self.given.width_m * per_width_nm_m / whole_nm).max(LEAST_LEFT);
        self.given.slab = Some(Yielding { curve: curve.clone(), whole_nm, per_width_nm_m });
        Bending::Curve { curve, strength_factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::crossing::{Crossing, InPlane, Plate};
    use crate::rc::layers::Held;

    const E: f64 = 16.5e9;
    const T: f64 = 0.2;

    /// The cuts of two by two panels of the sides `a` and `b`, with springs of beams.
    fn cuts(sides_m: [f64; 2], poisson: f64) -> Vec<Cut> {
        let g = E / (2.0 * (1.0 + poisson));
        let of = |axis: usize, cell: [usize; 2]| {
            // pieces at the edges are half as wide
            let width_m = sides_m[1 - axis] * if cell[1 - axis] == 1 { 1.0 } else { 0.5 };
            let plate = Plate { width_m, thickness_m: T, level_m: 3.0, moduli_pa: [E, g] };
            let plane = InPlane::of_slab(plate);
            let bending = E * width_m * T.powi(3) / 12.0;
            let sum = Crossing {
                bending,
                across: bending,
                torsion: g * width_m * T.powi(3) / 6.0,
                plate_share: 1.0,
                ..Crossing::default()
            };
            let place = |[i, j]: [usize; 2]| 3 * i + j;
            let mut next = cell;
            next[axis] += 1;
            Cut {
                axis,
                pieces: [place(cell), place(next)],
                point_m: [0.0; 3],
                faces_m: [0.0, sides_m[axis]],
                held: Held::OneWay,
                axes_m: [0.0, sides_m[axis]],
                length_m: sides_m[axis],
                bends_m: sides_m[axis],
                plane,
                sum,
                given: Given::default(),
                lines: Vec::new(),
                yields: true,
            }
        };
        let cells = |axis: usize| {
            (0..2).flat_map(move |k| (0..3).map(move |l| if axis == 0 { [k, l] } else { [l, k] }))
        };
        [0, 1]
            .into_iter()
            .flat_map(|axis| cells(axis).map(move |cell| (axis, cell)))
            .map(|(a, c)| of(a, c))
            .collect()
    }

    /// What springs along and across store in a field of curvatures, over what the plate stores.
    fn stored(sides_m: [f64; 2], poisson: f64, [x, y, xy]: [f64; 3]) -> f64 {
        let mut cuts = cuts(sides_m, poisson);
        let panels = Panel::all(&cuts);
        assert_eq!(panels.len(), 4);
        panels.iter().for_each(|p| p.take(&mut cuts));
        let along = |c: &Cut| c.length_m * (c.sum.bending * [x, y][c.axis].powi(2) + c.sum.torsion * xy * xy);
        let [a, b] = sides_m;
        let across = |p: &Panel| {
            let turn = |sense: f64| (a * a * x + b * b * y + sense * 2.0 * a * b * xy) / a.hypot(b);
            p.stiffness_nm_rad() * (turn(1.0).powi(2) + turn(-1.0).powi(2))
        };
        let all = cuts.iter().map(along).sum::<f64>() + panels.iter().map(across).sum::<f64>();
        let d = E * T.powi(3) / (12.0 * (1.0 - poisson * poisson));
        let plate = x * x + y * y + 2.0 * poisson * x * y + 2.0 * (1.0 - poisson) * xy * xy;
        all / (4.0 * a * b * d * plate)
    }

    /// In each field of constant curvatures the springs store what an isotropic plate does (Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells, 1959, eq. 47).
    #[test]
    fn springs_along_and_across_are_an_isotropic_plate() {
        let fields = [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.7, -0.4, 0.9],
        ];
        for field in fields {
            for (sides_m, poisson) in
                [([3.0, 3.0], 0.2), ([3.0, 2.5], 0.2), ([2.0, 3.6], 0.15), ([3.0, 3.2], 0.3)]
            {
                let ratio = stored(sides_m, poisson, field);
                assert!((ratio - 1.0).abs() < 1e-12, "{sides_m:?} {poisson} {field:?}: {ratio}");
            }
        }
    }

    #[test]
    fn long_panels_couple_less_and_keep_springs_along() {
        let mut cuts = cuts([6.0, 2.0], 0.2);
        let before: Vec<f64> = cuts.iter().map(|c| c.sum.bending).collect();
        Panel::all(&cuts).iter().for_each(|p| p.take(&mut cuts));
        for (cut, before) in cuts.iter().zip(before) {
            assert!(
                cut.sum.bending > LEAST_KEPT * before && cut.sum.torsion > 0.0,
                "{}",
                cut.sum.bending / before
            );
        }
    }
}
