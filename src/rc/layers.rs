//! Bending of a section of the mesh, layer of elements by layer, by the kernel's own rule and without a run.
//!
//! A row of elements across a member bends with plane sections: in the element whose centre lies at `z` the strain is `ε_0 + κ z` in the centre and `± κ d / 2` more at its faces, `d` its depth. The one-point
//! hexahedron ([`crate::fe`], `kernel.rs`) has a stress in its centre and a hourglass stress `h` for the difference, which both count in its yield condition: `q² = σ² + 6 G U / V`, with `U / V = h² / (6 E)` for a
//! stress that is linear across the element. A return scales both; in a flowing element the hourglass stress grows with the tangent modulus only, not below a floor. At the critical plastic strain the element is gone.
//! All of the plastic rotation is in one row of elements. A joint lends strength to the row at it, since it holds the strain across the member, the more the more axial force there is, and the pole of the
//! rotation lies farther from the joint than the middle of the row. How much that is, was measured on the column ends of the library, each computed by pushes of the piece of mesh around it ([`AT_JOINT`], [`POLE`]; `tests/rc/layers.rs`).

use crate::base::piecewise::interpolate;
use crate::base::root::{self, Close};
use crate::building::Homogenised;
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::fe::kernel::HOURGLASS_FLOOR;
use crate::material::j2::HardeningTable;
use rayon::prelude::*;

/// Axial forces of the levels over the force at which the whole section flows (compression positive).
const LEVELS: [f64; 5] = [-0.6, -0.3, 0.0, 0.3, 0.6];
/// Increment of curvature, of that at which the outer layer yields; how many are equal, and the growth of the later ones.
const FIRST: f64 = 0.02;
const EQUAL: usize = 150;
const GROWTH: f64 = 1.06;
/// Most increments.
const MOST: usize = 500;
/// Share of the largest moment below which a section has broken.
const BROKEN: f64 = 0.1;
/// Change of moment, of the largest one, below which a point of a curve says nothing new.
const STRAIGHT: f64 = 5e-3;
/// Resistance of the row at a joint over that of a free row, at axial forces over the squash load: medians of 42 column ends of the library; from the tenth to the ninetieth percentile 1.10 to 1.16, 1.09 to 1.16, 1.16 to 1.22, 1.19 to
/// 1.36 and 1.29 to 1.55.
pub const AT_JOINT: [[f64; 2]; 5] = [[-0.1, 1.12], [0.0, 1.11], [0.1, 1.18], [0.2, 1.27], [0.4, 1.375]];
/// Distance of the pole of the plastic rotation from the joint over the length of the row: median of the same column ends (0.58 to 0.90).
pub const POLE: f64 = 0.8;
/// Resistance of a plate that bends one way over that of a beam: its curvature across is held, and in plane strain a material of von Mises flows at `2/√3` of its uniaxial strength (Hill, The Mathematical Theory of Plasticity, 1950, chapter IV).
pub const ONE_WAY: f64 = 1.154_700_538_379_251_5;
/// Part of the squash load, and of the range of strains, to which the axial force is in balance.
const EXACT: f64 = 1e-12;

/// A layer of elements of a section.
#[derive(Debug, Clone, Copy)]
pub struct Layer<'a> {
    /// Its area, as far as the elements are filled \[m²\].
    pub area_m2: f64,
    /// Height of its centre \[m\].
    pub at_m: f64,
    /// Its depth \[m\].
    pub depth_m: f64,
    /// Factor on the strength.
    pub strength: f64,
    /// Its law.
    pub law: &'a Homogenised,
}

/// The state of a layer.
#[derive(Debug, Clone, Copy, Default)]
struct State {
    /// Stress in the centre, hourglass stress at the upper face \[Pa\], tension positive.
    stress_pa: f64,
    bending_pa: f64,
    plastic_strain: f64,
    gone: bool,
}

/// A section bent about its horizontal axis.
#[derive(Debug, Clone)]
pub struct Layers<'a> {
    layers: Vec<Layer<'a>>,
    tables: Vec<HardeningTable>,
    /// Centre of its stiffness \[m\].
    middle_m: f64,
    /// Bending stiffness \[N m²\].
    bending_nm2: f64,
    /// Axial force at which all of it flows \[N\].
    pub squash_n: f64,
}

impl<'a> Layers<'a> {
    /// Of layers with an area; none if there is none.
    pub fn of(layers: Vec<Layer<'a>>) -> Option<Self> {
        let tables: Vec<HardeningTable> =
            layers.iter().map(|l| HardeningTable::new(&l.law.hardening)).collect();
        let stiffness: f64 = layers.iter().map(|l| l.law.youngs_modulus_pa * l.area_m2).sum();
        let middle_m =
            layers.iter().map(|l| l.law.youngs_modulus_pa * l.area_m2 * l.at_m).sum::<f64>() / stiffness;
        let own = |l: &Layer| (l.at_m - middle_m).powi(2) + l.depth_m * l.depth_m / 12.0;
        let bending_nm2 = layers.iter().map(|l| l.law.youngs_modulus_pa * l.area_m2 * own(l)).sum();
        let squash_n = layers.iter().zip(&tables).map(|(l, t)| l.strength * t.at(0.0).0 * l.area_m2).sum();
        (stiffness > 0.0).then_some(Self { layers, tables, middle_m, bending_nm2, squash_n })
    }

    /// The numbers that a curve follows from, besides length and stiffness.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        self.layers.iter().flat_map(|l| {
            let law = l.law.hardening.iter().flat_map(|p| [p.plastic_strain, p.stress_pa]);
            [l.area_m2, l.at_m - self.middle_m, l.depth_m, l.strength]
                .into_iter()
                .chain([l.law.youngs_modulus_pa, l.law.poisson_ratio, l.law.critical_plastic_strain])
                .chain(law)
        })
    }

    /// The smallest critical plastic strain of its laws.
    pub fn critical_strain(&self) -> f64 {
        self.layers.iter().map(|l| l.law.critical_plastic_strain).fold(f64::INFINITY, f64::min)
    }

    /// Resistance of the row of elements at a joint about its pole: that of a free row, times [`AT_JOINT`].
    pub fn curve_at_joint(&self, row_m: f64, stiffness_nm_rad: f64) -> ResistanceCurve {
        let mut curve = self.curve(row_m, stiffness_nm_rad);
        for level in &mut curve.levels {
            let lent = interpolate(&AT_JOINT, level.axial_force_n / self.squash_n);
            level.scale(lent);
        }
        curve
    }

    /// Resistance of a row of a plate that bends one way, [`ONE_WAY`] times that of a free row.
    pub fn curve_one_way(&self, row_m: f64, stiffness_nm_rad: f64) -> ResistanceCurve {
        let mut curve = self.curve(row_m, stiffness_nm_rad);
        curve.levels.iter_mut().for_each(|level| level.scale(ONE_WAY));
        curve
    }

    /// Resistance of a free row of elements of some length \[m\], the smaller of both senses of bending, for a given elastic stiffness \[N m/rad\].
    pub fn curve(&self, row_m: f64, stiffness_nm_rad: f64) -> ResistanceCurve {
        let level = |share: f64| {
            let of = |sense: f64| self.level(row_m, share * self.squash_n, sense);
            let (sagging, hogging) = rayon::join(|| of(1.0), || of(-1.0));
            if hogging.peak_nm() < sagging.peak_nm() { hogging } else { sagging }
        };
        let levels = LEVELS.into_par_iter().map(level).collect();
        ResistanceCurve { stiffness_nm_rad, levels, cyclic: None }
    }

    /// Bending under an axial force \[N\] (compression positive) in one sense.
    fn level(&self, row_m: f64, axial_force_n: f64, sense: f64) -> CapacityLevel {
        let farthest = self.layers.iter().map(|l| (l.at_m - self.middle_m).abs() + 0.5 * l.depth_m);
        let farthest = farthest.fold(0.0, f64::max);
        let yields =
            |(l, t): (&Layer, &HardeningTable)| l.strength * t.lowest_stress_pa() / l.law.youngs_modulus_pa;
        let least = self.layers.iter().zip(&self.tables).map(yields).fold(f64::INFINITY, f64::min);
        let mut states = vec![State::default(); self.layers.len()];
        self.balance(&mut states, 0.0, axial_force_n, 0.0);
        let (mut curvature, mut increment) = (0.0, FIRST * least / farthest);
        let (mut points, mut peak): (Vec<[f64; 2]>, f64) = (Vec::new(), 0.0);
        let mut strain = 0.0;
        for step in 0..MOST {
            strain = self.balance(&mut states, sense * increment, axial_force_n, strain);
            curvature += increment;
            if step > EQUAL {
                (increment, strain) = (increment * GROWTH, strain * GROWTH);
            }
            let moment = sense * self.moment(&states);
            let plastic = row_m * (curvature - moment / self.bending_nm2);
            peak = peak.max(moment);
            if moment < BROKEN * peak {
                points.push([plastic, moment.max(0.0)]);
                break;
            }
            points.push([plastic, moment]);
        }
        finished(&points, peak, axial_force_n)
    }

    /// Strains the layers by an increment of curvature and by that of the strain in the middle which leaves the axial force as it is given, near a guess. Returns that strain.
    fn balance(&self, states: &mut [State], curvature: f64, axial_force_n: f64, guess: f64) -> f64 {
        let of = |i: usize, strain: f64| {
            let layer = &self.layers[i];
            let centre = strain + curvature * (layer.at_m - self.middle_m);
            states[i].strained(layer, &self.tables[i], centre, 0.5 * curvature * layer.depth_m)
        };
        let excess = |strain: f64| {
            let force = |(i, layer): (usize, &Layer)| of(i, strain).stress_pa * layer.area_m2;
            self.layers.iter().enumerate().map(force).sum::<f64>() + axial_force_n
        };
        let reach = 1e-6 + curvature.abs();
        let close = Close { value: EXACT * self.squash_n, width: EXACT * reach };
        let strain = root::near(guess, FIRST * reach, 1.0, excess, close);
        let after: Vec<State> = (0..states.len()).map(|i| of(i, strain)).collect();
        states.copy_from_slice(&after);
        strain
    }

    /// Moment about the middle, positive where it lengthens what lies above it \[N m\].
    fn moment(&self, states: &[State]) -> f64 {
        let of = |(s, l): (&State, &Layer)| {
            l.area_m2 * (s.stress_pa * (l.at_m - self.middle_m) + s.bending_pa * l.depth_m / 6.0)
        };
        states.iter().zip(&self.layers).map(of).sum()
    }
}

impl State {
    /// After an increment of strain in the centre, and of what its upper face has more.
    fn strained(self, layer: &Layer, table: &HardeningTable, centre: f64, more: f64) -> Self {
        if self.gone {
            return self;
        }
        let (young, shear) = (layer.law.youngs_modulus_pa, layer.law.shear_modulus_pa());
        let stress = self.stress_pa + young * centre;
        let trial = |bending: f64| (stress * stress + shear / young * bending * bending).sqrt();
        let elastic = self.bending_pa + young * more;
        let (yields, slope) = table.at(self.plastic_strain);
        if trial(elastic) <= layer.strength * yields {
            return Self { stress_pa: stress, bending_pa: elastic, ..self };
        }
        // in one direction Young's modulus stands in the place of 3 G
        let size = trial(elastic);
        let (flow, _) = table.plastic_increment(size, self.plastic_strain, young / 3.0, layer.strength);
        let tangent = layer.strength * slope;
        let left = (tangent / (3.0 * shear + tangent)).max(HOURGLASS_FLOOR);
        let plastic_strain = self.plastic_strain + flow;
        let ratio = layer.strength * table.at(plastic_strain).0 / size;
        let gone = plastic_strain >= layer.law.critical_plastic_strain;
        let [stress_pa, bending_pa] =
            if gone { [0.0; 2] } else { [ratio * stress, ratio * (self.bending_pa + left * young * more)] };
        Self { stress_pa, bending_pa, plastic_strain, gone }
    }
}

/// Capacity over plastic rotation from the points of a push: from where it begins to flow, without points on straight stretches.
fn finished(points: &[[f64; 2]], peak: f64, axial_force_n: f64) -> CapacityLevel {
    let tiny = 1e-3 * points.last().map_or(1.0, |p| p[0]);
    let first = points.iter().take_while(|p| p[0] < tiny).map(|p| p[1]).fold(0.0, f64::max);
    let mut capacity = vec![[0.0, first]];
    let later: Vec<[f64; 2]> = points.iter().copied().filter(|p| p[0] >= tiny).collect();
    let mut from = 0;
    while from < later.len() {
        let start = capacity[capacity.len() - 1];
        let fits = |to: &usize| {
            let [x, y] = later[*to];
            let on_line = |p: &[f64; 2]| start[1] + (y - start[1]) * (p[0] - start[0]) / (x - start[0]);
            x > start[0] && later[from..*to].iter().all(|p| (on_line(p) - p[1]).abs() <= STRAIGHT * peak)
        };
        let to = (from..later.len()).take_while(|to| *to == from || fits(to)).last().unwrap_or(from);
        if later[to][0] > start[0] {
            capacity.push(later[to]);
        }
        from = to + 1;
    }
    let fracture_rotation_rad = points.last().map_or(0.0, |p| p[0]).max(tiny.max(1e-6));
    CapacityLevel { axial_force_n, capacity, fracture_rotation_rad }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building::HardeningPoint;

    fn law() -> Homogenised {
        let point = |plastic_strain, stress_pa| HardeningPoint { plastic_strain, stress_pa };
        Homogenised {
            density_kg_m3: 2500.0,
            youngs_modulus_pa: 16.5e9,
            poisson_ratio: 0.2,
            hardening: vec![point(0.0, 10e6)],
            critical_plastic_strain: 0.1,
            rate_factor: None,
            critical_principal_strain: None,
        }
    }

    fn slices<'a>(law: &'a Homogenised, width: f64, depth: f64, count: usize) -> Layers<'a> {
        let d = depth / count as f64;
        let layer = |i: usize| Layer {
            area_m2: width * d,
            at_m: (i as f64 + 0.5) * d,
            depth_m: d,
            strength: 1.0,
            law,
        };
        Layers::of((0..count).map(layer).collect()).unwrap()
    }

    #[test]
    fn many_layers_are_plastic_theory() {
        let law = law();
        let section = slices(&law, 0.4, 0.4, 100);
        let curve = section.curve(0.4, 1e7);
        let plastic = 10e6 * 0.4 * 0.4 * 0.4 / 4.0;
        for level in &curve.levels {
            let share = level.axial_force_n / section.squash_n;
            let wanted = plastic * (1.0 - share * share);
            assert!((level.peak_nm() / wanted - 1.0).abs() < 0.01, "{share}: {} {wanted}", level.peak_nm());
        }
        assert!(curve.check().is_ok());
    }

    #[test]
    fn one_layer_yields_by_its_hourglass_stress_and_two_by_both() {
        let law = law();
        let plastic = 10e6 * 0.4 * 0.16 / 4.0;
        // one: h sqrt(G / E) = f, and M = h b d² / 6
        let one = slices(&law, 0.4, 0.4, 1).curve(0.4, 1e7).levels[2].peak_nm();
        let ratio = 4.0 / 6.0 / (1.0_f64 / 2.4).sqrt();
        assert!((one / plastic / ratio - 1.0).abs() < 0.01, "{}", one / plastic);
        // two: s² (1 + G / E) = f² in both, and M = (1/4 + 1/12) s b d²
        let two = slices(&law, 0.4, 0.4, 2).curve(0.4, 1e7).levels[2].peak_nm();
        let ratio = (4.0 / 3.0) / (1.0 + 1.0_f64 / 2.4).sqrt();
        assert!((two / plastic / ratio - 1.0).abs() < 0.02, "{} {ratio}", two / plastic);
    }

    #[test]
    fn a_plate_that_bends_one_way_is_in_plane_strain() {
        assert!((ONE_WAY - 2.0 / 3.0_f64.sqrt()).abs() < 1e-15);
        let law = law();
        let section = slices(&law, 1.0, 0.2, 100);
        // σ²(1 - 1/2 + 1/4) = f² with the stress across half of that along, as long as plastic strains rule
        let plastic = 10e6 * 0.2 * 0.2 / 4.0 / 0.75_f64.sqrt();
        let peak = section.curve_one_way(0.4, 1e7).levels[2].peak_nm();
        assert!((peak / plastic - 1.0).abs() < 0.01, "{}", peak / plastic);
    }

    #[test]
    fn layers_are_lost_one_after_the_other() {
        let law = law();
        let curve = slices(&law, 0.4, 0.4, 4).curve(0.4, 1e7);
        let level = &curve.levels[2];
        // the outer layer, 0.15 m from the middle, is lost at a curvature of 0.1 / 0.15 m
        let lost = 0.4 * 0.1 / 0.15;
        let at = |x: f64| crate::base::piecewise::interpolate(&level.capacity, x);
        assert!(at(1.1 * lost) < 0.6 * at(0.9 * lost), "{} {}", at(0.9 * lost), at(1.1 * lost));
        assert!(level.fracture_rotation_rad > 1.5 * lost);
    }
}
