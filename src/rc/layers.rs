//! Bending of a section of the mesh, layer of elements by layer, by the kernel's own rule and without a run.
//!
//! A row of elements across a member bends with plane sections: in the element whose centre lies at `z` the strain is `ε_0 + κ z` in the centre and `± κ d / 2` more at its faces, `d` its depth. The one-point
//! hexahedron ([`crate::fe`], `kernel.rs`) has a stress in its centre and a hourglass stress `h` for the difference, which both count in its yield condition: `q² = σ² + 6 G U / V`, with `U / V = h² / (6 E)` for a
//! stress that is linear across the element. A return scales both; in a flowing element the hourglass stress grows with the tangent modulus only, not below a floor. At the critical plastic strain the element is gone.
//! While a section hardens, as one layer after the other yields and by its law, plastic rotation spreads along the member ([`Rows`]); behind the peak it is in one row. A joint lends strength to the row at it, since it holds the strain across the member, the more the more axial force there is, and the pole of the
//! rotation lies farther from the joint than the middle of the row. How much that is, was measured on the column ends of the library, each computed by pushes of the piece of mesh around it ([`AT_JOINT`], [`POLE`]; `tests/rc/layers.rs`).

use crate::base::piecewise::{interpolate, places};
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
/// Most rows that yield beside the first one.
const MOST_ROWS: usize = 10_000;
/// Most increments.
const MOST: usize = 500;
/// Share of the largest moment below which a section has broken.
const BROKEN: f64 = 0.1;
/// Change of moment, of the largest one, below which a point of a curve says nothing new.
const STRAIGHT: f64 = 5e-3;
/// Resistance of the row at a joint over that of a free row, at axial forces over the squash load: medians of 42 column ends of the library; from the tenth to the ninetieth percentile 1.10 to 1.16, 1.09 to 1.16, 1.16 to 1.22, 1.19 to
/// 1.36 and 1.29 to 1.55.
pub const AT_JOINT: [[f64; 2]; 5] = [[-0.1, 1.12], [0.0, 1.11], [0.1, 1.18], [0.2, 1.27], [0.4, 1.375]];
/// Resistance of the row at a joint over that of its section, against plastic rotation over the elastic rotation of the row under its largest moment (`row M / E I`): a joint gives way bit by bit before the whole section flows. Inverse medians of the same column ends; from the tenth to the
/// ninetieth percentile 0.49 to 0.65, 0.76 to 0.84, 0.81 to 0.88, 0.84 to 0.93, 0.88 to 0.96, 0.93 to 1.0, 0.96 to 1.03.
pub const KNEE: [[f64; 2]; 7] =
    [[0.0, 0.51], [0.1, 0.79], [0.25, 0.84], [0.5, 0.885], [1.0, 0.92], [2.0, 0.98], [4.0, 1.0]];
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
    /// Whether it is a plate, far wider than a row of elements is long: what is beside the row holds its strain across.
    pub is_plate: bool,
    /// Its law.
    pub law: &'a Homogenised,
}

impl<'a> Layer<'a> {
    /// The layers between edges \[m\] of a rectangle of some width \[m\].
    pub fn between(
        edges: &[f64],
        width_m: f64,
        strength: f64,
        is_plate: bool,
        law: &'a Homogenised,
    ) -> impl Iterator<Item = Self> {
        edges.windows(2).map(move |z| Self {
            area_m2: width_m * (z[1] - z[0]),
            at_m: 0.5 * (z[0] + z[1]),
            depth_m: z[1] - z[0],
            strength,
            is_plate,
            law,
        })
    }
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

/// What holds the rows of elements that yield at an end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    /// Nothing, neither a plate.
    Free,
    /// The joint that the member ends at lends the first one strength, [`AT_JOINT`] times that of a free row, and plates have that of plane strain in all of them, [`ONE_WAY`].
    AtJoint,
    /// The plate across: it bends one way, with [`ONE_WAY`] times the resistance of a free row.
    OneWay,
    /// The same of a plate over columns, where the line along which it yields runs across as well. It yields beside the columns first, for want of a better figure with the same knee as a joint ([`KNEE`]).
    OverColumns,
}

impl Held {
    /// Strength of a layer in the first row, or in the others, over that of a free one, at a share of the squash load.
    fn lends(self, layer: &Layer, is_first: bool, share: f64) -> f64 {
        match self {
            Self::Free => 1.0,
            Self::OneWay | Self::OverColumns => ONE_WAY,
            Self::AtJoint if layer.is_plate => ONE_WAY,
            Self::AtJoint if is_first => interpolate(&AT_JOINT, share),
            Self::AtJoint => 1.0,
        }
    }
}

/// The rows of elements of an end, up to where the moment is zero.
#[derive(Debug, Clone, Copy)]
pub struct Rows {
    /// Length of a row along the member \[m\].
    pub row_m: f64,
    /// From the pole of the first row to the point without moment \[m\].
    pub shear_span_m: f64,
    /// What holds them.
    pub held: Held,
}

impl Rows {
    /// Adds to the plastic rotations of a push of the first row those of the others, of whom there is a push too. They have the less of the moment the nearer they are to the point without moment: up to its peak a section hardens as one layer after the
    /// other yields, and the rows beside the first one follow it; behind the peak they keep what they have.
    fn spread(&self, first: &mut [[f64; 2]], other: &[[f64; 2]]) {
        // plastic rotation of a row over moment
        let mut rising: Vec<[f64; 2]> = vec![[0.0; 2]];
        for [rotation, moment] in other.iter().copied() {
            if moment > rising[rising.len() - 1][0] {
                rising.push([moment, rotation]);
            }
        }
        let mut most = 0.0_f64;
        for [rotation, moment] in first {
            most = most.max(*moment);
            let share = |row: usize| 1.0 - (row as f64 + 0.5 - POLE) * self.row_m / self.shear_span_m;
            let shares = (1..=MOST_ROWS).map(share).take_while(|share| *share > 0.0);
            *rotation += shares.map(|share| interpolate(&rising, most * share)).sum::<f64>();
        }
    }
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
        let squash_n = squash_n(&layers, &tables);
        (stiffness > 0.0).then_some(Self { layers, tables, middle_m, bending_nm2, squash_n })
    }

    /// The numbers that a curve follows from, besides length and stiffness.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        self.layers.iter().flat_map(|l| {
            let law = l.law.hardening.iter().flat_map(|p| [p.plastic_strain, p.stress_pa]);
            [l.area_m2, l.at_m - self.middle_m, l.depth_m, l.strength, f64::from(u8::from(l.is_plate))]
                .into_iter()
                .chain([l.law.youngs_modulus_pa, l.law.poisson_ratio, l.law.critical_plastic_strain])
                .chain(law)
        })
    }

    /// The smallest critical plastic strain of its laws.
    pub fn critical_strain(&self) -> f64 {
        self.layers.iter().map(|l| l.law.critical_plastic_strain).fold(f64::INFINITY, f64::min)
    }

    /// Resistance of the rows of elements of an end, the smaller of both senses of bending, for a given elastic stiffness \[N m/rad\].
    pub fn curve(&self, rows: &Rows, stiffness_nm_rad: f64) -> ResistanceCurve {
        self.pushes(rows.row_m, rows.held).curve(rows.shear_span_m, stiffness_nm_rad)
    }

    /// The level at a share of the squash load, the smaller of both senses of bending.
    pub fn weaker(&self, rows: &Rows, share: f64) -> CapacityLevel {
        self.pushed(rows.row_m, rows.held, share).weaker(rows, self.bending_nm2)
    }

    /// Pushes of rows of a length \[m\], of which curves for any way to the point without moment follow ([`Pushes::curve`]).
    pub fn pushes(&self, row_m: f64, held: Held) -> Pushes {
        let levels = LEVELS.into_par_iter().map(|share| self.pushed(row_m, held, share)).collect();
        Pushes { row_m, held, bending_nm2: self.bending_nm2, levels }
    }

    /// Pushes under a share of the squash load in both senses of bending.
    fn pushed(&self, row_m: f64, held: Held, share: f64) -> Pushed {
        let axial_force_n = share * self.squash_n;
        let of = |sense: f64| self.push_in(row_m, held, axial_force_n, sense);
        let (sagging, hogging) = rayon::join(|| of(1.0), || of(-1.0));
        Pushed { axial_force_n, senses: [sagging, hogging] }
    }

    /// Pushes under an axial force \[N\] (compression positive) in one sense, of the first row and of another one.
    fn push_in(&self, row_m: f64, held: Held, axial_force_n: f64, sense: f64) -> [Vec<[f64; 2]>; 2] {
        let share = axial_force_n / self.squash_n;
        let push = |is_first: bool| {
            // the same share of its own squash load: what is lent was measured on moments
            let lent = self.lent(|layer| held.lends(layer, is_first, share));
            lent.push(row_m, share * lent.squash_n, sense)
        };
        let first = push(true);
        let other = if held == Held::AtJoint { push(false) } else { first.clone() };
        [first, other]
    }

    /// The same section with other strengths, by layer a factor.
    fn lent(&self, factor: impl Fn(&Layer) -> f64) -> Self {
        let mut layers = self.layers.clone();
        layers.iter_mut().for_each(|layer| layer.strength *= factor(layer));
        Self { squash_n: squash_n(&layers, &self.tables), layers, tables: self.tables.clone(), ..*self }
    }

    /// Plastic rotation of a row of some length and moment, increment by increment until the section has broken.
    fn push(&self, row_m: f64, axial_force_n: f64, sense: f64) -> Vec<[f64; 2]> {
        let farthest = self.layers.iter().map(|l| (l.at_m - self.middle_m).abs() + 0.5 * l.depth_m);
        let farthest = farthest.fold(0.0, f64::max);
        let yields =
            |(l, t): (&Layer, &HardeningTable)| l.strength * t.lowest_stress_pa() / l.law.youngs_modulus_pa;
        let least = self.layers.iter().zip(&self.tables).map(yields).fold(f64::INFINITY, f64::min);
        let mut states = vec![State::default(); self.layers.len()];
        // from the elastic strain: a brittle section has a second state of balance, without its layers
        let stiffness: f64 = self.layers.iter().map(|l| l.law.youngs_modulus_pa * l.area_m2).sum();
        self.balance(&mut states, 0.0, axial_force_n, -axial_force_n / stiffness);
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
            peak = peak.max(moment);
            points.push([row_m * (curvature - moment / self.bending_nm2), moment.max(0.0)]);
            if moment < BROKEN * peak {
                break;
            }
        }
        points
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

/// Pushes of a section, which take nearly all of the time of its curves.
#[derive(Debug, Clone)]
pub struct Pushes {
    row_m: f64,
    held: Held,
    bending_nm2: f64,
    levels: Vec<Pushed>,
}

impl Pushes {
    /// The curve of an end whose pole is so far from the point without moment \[m\], for a given elastic stiffness \[N m/rad\].
    pub fn curve(&self, shear_span_m: f64, stiffness_nm_rad: f64) -> ResistanceCurve {
        let rows = Rows { row_m: self.row_m, shear_span_m, held: self.held };
        // the force acts in the centre of stiffness: beside a weakened part a large one leaves no moment in one sense
        let levels = self.levels.iter().map(|pushed| pushed.weaker(&rows, self.bending_nm2));
        let levels = levels.filter(|level| level.peak_nm() > 0.0).collect();
        ResistanceCurve { stiffness_nm_rad, levels, cyclic: None }
    }
}

/// Pushes under one axial force.
#[derive(Debug, Clone)]
struct Pushed {
    axial_force_n: f64,
    /// In both senses of bending, of the first row and of another one.
    senses: [[Vec<[f64; 2]>; 2]; 2],
}

impl Pushed {
    /// The level of the weaker sense.
    fn weaker(&self, rows: &Rows, bending_nm2: f64) -> CapacityLevel {
        let [sagging, hogging] = [0, 1].map(|sense| self.level(&self.senses[sense], rows, bending_nm2));
        if hogging.peak_nm() < sagging.peak_nm() { hogging } else { sagging }
    }

    fn level(&self, [first, other]: &[Vec<[f64; 2]>; 2], rows: &Rows, bending_nm2: f64) -> CapacityLevel {
        let mut points = first.clone();
        rows.spread(&mut points, other);
        let mut level = finished(&points, self.axial_force_n);
        if matches!(rows.held, Held::AtJoint | Held::OverColumns) {
            let elastic_rad = rows.row_m * level.peak_nm() / bending_nm2;
            round_off(&mut level, elastic_rad);
        }
        level
    }
}

/// Axial force at which all layers flow \[N\].
fn squash_n(layers: &[Layer], tables: &[HardeningTable]) -> f64 {
    layers.iter().zip(tables).map(|(l, t)| l.strength * t.at(0.0).0 * l.area_m2).sum()
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
fn finished(points: &[[f64; 2]], axial_force_n: f64) -> CapacityLevel {
    let peak = points.iter().map(|p| p[1]).fold(0.0, f64::max);
    let tiny = 1e-3 * points.last().map_or(1.0, |p| p[0]);
    let first = points.iter().take_while(|p| p[0] < tiny).map(|p| p[1]).fold(0.0, f64::max);
    // what breaks as it yields has its peak only
    let first = if first > 0.0 { first } else { peak };
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

/// Puts the knee of the row at a joint ([`KNEE`]) into a curve, for the elastic rotation of that row \[rad\].
fn round_off(level: &mut CapacityLevel, elastic_rad: f64) {
    let knee = KNEE.map(|[x, share]| [x * elastic_rad, share]);
    let mut rotations = places(level.capacity.iter().chain(&knee));
    rotations.retain(|x| *x <= level.fracture_rotation_rad);
    level.capacity =
        rotations.iter().map(|x| [*x, interpolate(&knee, *x) * interpolate(&level.capacity, *x)]).collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building::HardeningPoint;

    /// One row, as long as a member whose second row has no moment.
    const FREE: Rows = Rows { row_m: 0.4, shear_span_m: 0.1, held: Held::Free };

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
            is_plate: false,
            law,
        };
        Layers::of((0..count).map(layer).collect()).unwrap()
    }

    #[test]
    fn many_layers_are_plastic_theory() {
        let law = law();
        let section = slices(&law, 0.4, 0.4, 100);
        let curve = section.curve(&FREE, 1e7);
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
        let one = slices(&law, 0.4, 0.4, 1).curve(&FREE, 1e7).levels[2].peak_nm();
        let ratio = 4.0 / 6.0 / (1.0_f64 / 2.4).sqrt();
        assert!((one / plastic / ratio - 1.0).abs() < 0.01, "{}", one / plastic);
        // two: s² (1 + G / E) = f² in both, and M = (1/4 + 1/12) s b d²
        let two = slices(&law, 0.4, 0.4, 2).curve(&FREE, 1e7).levels[2].peak_nm();
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
        let peak = section.curve(&Rows { held: Held::OneWay, ..FREE }, 1e7).levels[2].peak_nm();
        assert!((peak / plastic - 1.0).abs() < 0.01, "{}", peak / plastic);
    }

    #[test]
    fn plastic_rotation_spreads_while_a_section_hardens() {
        // bilinear rows: with a moment that falls linearly to zero, ∫ κ_p dx = κ_p(M) L (1 - M_y / M) / 2
        let (yields, moment, shear_span_m, row_m) = (100.0, 150.0, 4.0, 0.001);
        let plastic = |m: f64| row_m * 1e-4 * (m - yields).max(0.0);
        let push: Vec<[f64; 2]> =
            [yields, moment, 0.9 * moment].into_iter().map(|m| [plastic(m), m]).collect();
        let rows = Rows { row_m, shear_span_m, held: Held::Free };
        let mut spread = push.clone();
        rows.spread(&mut spread, &push);
        let wanted = plastic(moment) / row_m * shear_span_m * (1.0 - yields / moment) / 2.0;
        assert!((spread[1][0] / wanted - 1.0).abs() < 2e-3, "{} {wanted}", spread[1][0]);
        // what softens keeps what has spread
        let [kept, own] = [spread[2][0] - push[2][0], spread[1][0] - push[1][0]];
        assert!((kept / own - 1.0).abs() < 1e-12);
        assert_eq!(spread[0][0], 0.0);
    }

    #[test]
    fn a_plate_at_a_joint_is_in_plane_strain_and_its_web_is_not() {
        let law = law();
        let peak = |is_plate: bool| {
            let mut section = slices(&law, 0.4, 0.4, 100);
            section.layers.iter_mut().for_each(|layer| layer.is_plate = is_plate);
            section.curve(&Rows { held: Held::AtJoint, ..FREE }, 1e7).levels[2].peak_nm()
        };
        let lent = interpolate(&AT_JOINT, 0.0);
        assert!(
            (peak(true) / peak(false) * lent / ONE_WAY - 1.0).abs() < 5e-3,
            "{} {}",
            peak(true),
            peak(false)
        );
    }

    #[test]
    fn what_breaks_as_it_yields_has_its_peak() {
        let law = Homogenised { critical_plastic_strain: 1e-4, ..law() };
        for held in [Held::Free, Held::AtJoint, Held::OneWay] {
            let rows = Rows { shear_span_m: 2.0, held, ..FREE };
            for count in [1, 2, 3] {
                let curve = slices(&law, 0.4, 0.4, count).curve(&rows, 1e7);
                assert!(curve.check().is_ok(), "{held:?} {count}: {:?}", curve.check());
            }
        }
    }

    #[test]
    fn layers_are_lost_one_after_the_other() {
        let law = law();
        let curve = slices(&law, 0.4, 0.4, 4).curve(&FREE, 1e7);
        let level = &curve.levels[2];
        // the outer layer, 0.15 m from the middle, is lost at a curvature of 0.1 / 0.15 m
        let lost = 0.4 * 0.1 / 0.15;
        let at = |x: f64| crate::base::piecewise::interpolate(&level.capacity, x);
        assert!(at(1.1 * lost) < 0.6 * at(0.9 * lost), "{} {}", at(0.9 * lost), at(1.1 * lost));
        assert!(level.fracture_rotation_rad > 1.5 * lost);
    }
}
