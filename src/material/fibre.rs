//! Moment over curvature of a reinforced rectangular section: the reference for curves found with solid elements.
//!
//! Plane sections, full bond. The section is cut into strips normal to the direction of bending (or, for a skew direction, into cells), core and cover apart;
//! bars are points. At each curvature the strain at the centre follows from the axial force; of several solutions the one that continues the last
//! step is taken. Strain, axial force and concrete stress are positive in **compression** here, the bars' law ([`super::rebar`]) takes tension positive.
//!
//! Direction of bending: angle from the width to the depth axis, pointing to the compressed side. In a skew direction the neutral axis is held normal to it
//! and the moment is its component about that axis.

use super::fibre_concrete::{ConcreteCurve, ConcreteLaw, Confinement, TieInput, area_m2};
use super::rebar::{RebarLaw, RebarState};
use crate::base::root::{Close, root};
use crate::building::{Bar, Concrete, Section, SectionShape};
use serde::{Deserialize, Serialize};

/// Strips over the height of the core; cells along each side of it in a skew direction.
const STRIPS: usize = 600;
/// Cells along each side of the core in a skew direction.
const CELLS: usize = 80;

/// When the axial force is in balance \[N\], or the strain at the centre is known.
const CLOSE: Close = Close { value: 1e-3, width: 1e-13 };

/// A reinforced rectangle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SectionInput {
    /// Width and depth \[m\].
    pub size_m: [f64; 2],
    /// Bars, from the centre.
    pub bars: Vec<Bar>,
    /// Strength of the concrete \[Pa\].
    pub concrete_strength_pa: f64,
    /// Tensile strength \[Pa\].
    pub tensile_strength_pa: f64,
    /// Secant modulus E_cm \[Pa\]; for the strain at cracking only.
    pub youngs_modulus_pa: f64,
    /// Ties.
    pub ties: Option<TieInput>,
    /// Law of the bars.
    pub steel: RebarLaw,
    /// How bars count.
    pub options: FibreOptions,
}

/// How bars count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FibreOptions {
    /// Whether the concrete that bars displace is deducted.
    pub deduct_bars: bool,
    /// Whether bars and crushed concrete remember: a bar unloads on its cyclic branch and stays ruptured, a crushed fibre stays empty. Otherwise stresses depend
    /// on the present strain alone.
    pub history: bool,
}

impl SectionInput {
    /// A section of a building with perimeter ties: ties lie on the bars, legs are two, bars are held in the corners, `f_t = 0.3 f_c^(2/3)` (EN 1992-1-1 table 3.1);
    /// `None` for a plate or a section without bars. `steel` is the bars' law, the ties yield at `tie_yield_pa` \[Pa\].
    pub fn of_building(
        section: &Section,
        concrete: &Concrete,
        steel: RebarLaw,
        tie_yield_pa: f64,
        options: FibreOptions,
    ) -> Option<Self> {
        let SectionShape::Rectangle { width_m, depth_m, bars, ties } = &section.shape else { return None };
        let edge = |b: &Bar| {
            let gap = (0.5 * width_m - b.x_m.abs()).min(0.5 * depth_m - b.y_m.abs());
            gap - 0.5 * b.diameter_m
        };
        let clear = bars.iter().map(edge).fold(f64::INFINITY, f64::min);
        let ties = ties.map(|t| TieInput {
            diameter_m: t.diameter_m,
            spacing_m: t.spacing_m,
            yield_strength_pa: tie_yield_pa,
            ultimate_strain: 0.10,
            legs: [2.0; 2],
            cover_m: (clear - t.diameter_m).max(0.0),
            all_bars_held: false,
        });
        (!bars.is_empty()).then(|| Self {
            size_m: [*width_m, *depth_m],
            bars: bars.clone(),
            concrete_strength_pa: concrete.strength_pa,
            tensile_strength_pa: 0.3e6 * super::rate::power(concrete.strength_pa / 1e6, 2.0 / 3.0),
            youngs_modulus_pa: concrete.youngs_modulus_pa,
            ties,
            steel,
            options,
        })
    }

    /// Gross area \[m²\].
    pub fn area_m2(&self) -> f64 {
        self.size_m[0] * self.size_m[1]
    }
}

/// A piece of concrete: place along the direction \[m\], area \[m²\], 0 core or 1 cover.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Fibre {
    place_m: f64,
    area_m2: f64,
    kind: usize,
}

/// A bar: place along the direction \[m\], area \[m²\], state.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rod {
    place_m: f64,
    area_m2: f64,
    state: RebarState,
}

/// One state on the way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurvaturePoint {
    /// Curvature \[1/m\].
    pub curvature_1_m: f64,
    /// Moment \[N m\].
    pub moment_nm: f64,
    /// Axial force of the profile found, compression positive \[N\].
    pub axial_force_n: f64,
    /// Strain of the most compressed edge or corner, compression positive.
    pub compressed_strain: f64,
    /// Strain of the opposite edge or corner, compression positive.
    pub opposite_strain: f64,
    /// Largest tensile strain of a bar.
    pub bar_strain: f64,
}

/// A section with the curves of its concrete.
#[derive(Debug, Clone, PartialEq)]
pub struct FibreSection {
    input: SectionInput,
    curves: [ConcreteCurve; 2],
}

/// A section cut for one direction.
struct Cut<'a> {
    section: &'a FibreSection,
    fibres: Vec<Fibre>,
    crushed: Vec<bool>,
    rods: Vec<Rod>,
    edge_m: f64,
}

impl FibreSection {
    /// A section whose concrete follows a law.
    pub fn of(input: &SectionInput, law: ConcreteLaw) -> Self {
        Self { input: input.clone(), curves: ConcreteCurve::pair(law, input) }
    }

    /// The section.
    pub fn input(&self) -> &SectionInput {
        &self.input
    }

    /// Curves of core and cover.
    pub fn curves(&self) -> [ConcreteCurve; 2] {
        self.curves
    }

    /// States at the given curvatures \[1/m\], increasing, under an axial force \[N\] (compression positive); ends before the first curvature at which
    /// no strain near the last one carries the axial force.
    pub fn moment_curvature(
        &self,
        axial_force_n: f64,
        direction_rad: f64,
        curvatures_1_m: &[f64],
    ) -> Vec<CurvaturePoint> {
        let mut cut = Cut::of(self, direction_rad);
        let mut points: Vec<CurvaturePoint> = Vec::with_capacity(curvatures_1_m.len());
        let (mut centre, mut slope, mut last) = (0.0, 0.0, 0.0);
        for &curvature in curvatures_1_m {
            let guess = centre + slope * (curvature - last);
            let Some(found) = cut.balance(axial_force_n, curvature, guess) else { break };
            slope = if curvature > last && !points.is_empty() {
                (found - centre) / (curvature - last)
            } else {
                0.0
            };
            (centre, last) = (found, curvature);
            points.push(cut.commit(found, curvature));
        }
        points
    }

    /// Curvatures \[1/m\] from zero to a limit: 600 steps, each 1.5 % larger than the one before.
    pub fn curvatures_to(limit_1_m: f64) -> Vec<f64> {
        let mut curvatures = vec![0.0; 601];
        let mut at = limit_1_m;
        for place in curvatures[1..].iter_mut().rev() {
            *place = at;
            at /= 1.015;
        }
        curvatures
    }
}

impl<'a> Cut<'a> {
    fn of(section: &'a FibreSection, direction_rad: f64) -> Self {
        let input = &section.input;
        let (sin, cos) = libm::sincos(direction_rad);
        let core = Confinement::of(input).map_or([0.0; 2], |c| c.core_m);
        let fibres = if sin.abs() < 1e-9 {
            strips(input.size_m, core)
        } else if cos.abs() < 1e-9 {
            strips([input.size_m[1], input.size_m[0]], [core[1], core[0]])
        } else {
            cells(input.size_m, core, [cos, sin])
        };
        let rods = input.bars.iter().map(|b| Rod {
            place_m: b.x_m * cos + b.y_m * sin,
            area_m2: area_m2(b),
            state: RebarState::default(),
        });
        let edge_m = 0.5 * (input.size_m[0] * cos.abs() + input.size_m[1] * sin.abs());
        Self { section, crushed: vec![false; fibres.len()], fibres, rods: rods.collect(), edge_m }
    }

    /// Axial force \[N\] and moment \[N m\] of a strain profile; the state stays.
    fn resultants(&self, centre: f64, curvature: f64) -> [f64; 2] {
        let (curves, options) = (&self.section.curves, self.section.input.options);
        let (mut force, mut moment) = (0.0, 0.0);
        for (fibre, crushed) in self.fibres.iter().zip(&self.crushed) {
            if !crushed {
                let stress = curves[fibre.kind].stress_pa(centre + curvature * fibre.place_m);
                force += stress * fibre.area_m2;
                moment += stress * fibre.area_m2 * fibre.place_m;
            }
        }
        for rod in &self.rods {
            let strain = centre + curvature * rod.place_m;
            let displaced = if options.deduct_bars { curves[0].stress_pa(strain) } else { 0.0 };
            let pull = (self.bar_stress_pa(rod.state, -strain).0 + displaced) * rod.area_m2;
            force -= pull;
            moment -= pull * rod.place_m;
        }
        [force, moment]
    }

    /// Stress of a bar at a strain, both tension positive, and its state after it.
    fn bar_stress_pa(&self, mut state: RebarState, strain: f64) -> (f64, RebarState) {
        let law = &self.section.input.steel;
        let stress = if self.section.input.options.history {
            law.stress(&mut state, strain)
        } else if strain >= law.ultimate_strain {
            0.0
        } else if strain >= 0.0 {
            law.monotonic_pa(strain)
        } else {
            -law.compressed_pa(-strain)
        };
        (stress, state)
    }

    /// The strain at the centre, nearest to a guess, that carries the axial force \[N\].
    fn balance(&self, axial_force_n: f64, curvature: f64, guess: f64) -> Option<f64> {
        let excess = |centre: f64| self.resultants(centre, curvature)[0] - axial_force_n;
        let here = excess(guess);
        let mut step = 1e-6 + 1e-3 * curvature * self.edge_m;
        let (mut below, mut above) = ([guess, here], [guess, here]);
        let bracket = loop {
            let lower = [below[0] - step, excess(below[0] - step)];
            let upper = [above[0] + step, excess(above[0] + step)];
            // more strain carries more force: the ascending side first
            if above[1] <= 0.0 && upper[1] >= 0.0 {
                break [above, upper];
            }
            if below[1] >= 0.0 && lower[1] <= 0.0 {
                break [lower, below];
            }
            if above[1] >= 0.0 && upper[1] <= 0.0 {
                break [above, upper];
            }
            if below[1] <= 0.0 && lower[1] >= 0.0 {
                break [lower, below];
            }
            (below, above, step) = (lower, upper, 1.5 * step);
            if step > 0.05 {
                return None;
            }
        };
        Some(root(excess, bracket, CLOSE))
    }

    /// Keeps a profile and gives its point.
    fn commit(&mut self, centre: f64, curvature: f64) -> CurvaturePoint {
        let [axial_force_n, moment_nm] = self.resultants(centre, curvature);
        let states: Vec<RebarState> = self
            .rods
            .iter()
            .map(|r| self.bar_stress_pa(r.state, -(centre + curvature * r.place_m)).1)
            .collect();
        let mut bar_strain = f64::NEG_INFINITY;
        for (rod, state) in self.rods.iter_mut().zip(states) {
            rod.state = state;
            bar_strain = bar_strain.max(-(centre + curvature * rod.place_m));
        }
        if self.section.input.options.history {
            for (fibre, crushed) in self.fibres.iter().zip(&mut self.crushed) {
                let end = self.section.curves[fibre.kind].end_strain();
                *crushed |= centre + curvature * fibre.place_m > end;
            }
        }
        CurvaturePoint {
            curvature_1_m: curvature,
            moment_nm,
            axial_force_n,
            compressed_strain: centre + curvature * self.edge_m,
            opposite_strain: centre - curvature * self.edge_m,
            bar_strain,
        }
    }
}

/// Strips of a rectangle of `height` x `breadth` \[m\] with its core.
fn strips([height, breadth]: [f64; 2], core: [f64; 2]) -> Vec<Fibre> {
    let (cover, inner) = (0.5 * (height - core[0]), if core[0] > 0.0 { STRIPS } else { 0 });
    let outer = (STRIPS as f64 * cover / height).ceil().max(1.0) as usize;
    let mut fibres = Vec::new();
    let mut piece = |from: f64, to: f64, count: usize, width: f64, kind: usize| {
        let dz = (to - from) / count as f64;
        fibres.extend((0..count).map(|k| Fibre {
            place_m: from + (k as f64 + 0.5) * dz,
            area_m2: width * dz,
            kind,
        }));
    };
    let (low, high) = (-0.5 * height, 0.5 * height);
    piece(low, low + cover, outer, breadth, 1);
    piece(high - cover, high, outer, breadth, 1);
    if inner > 0 {
        piece(low + cover, high - cover, inner, core[1], 0);
        piece(low + cover, high - cover, inner, breadth - core[1], 1);
    }
    fibres
}

/// Cells of a rectangle of `size` \[m\] with its core, projected on a unit vector.
fn cells(size: [f64; 2], core: [f64; 2], unit: [f64; 2]) -> Vec<Fibre> {
    let axes: [Vec<[f64; 3]>; 2] = [0, 1].map(|i| {
        let pieces = strips([size[i], 1.0], [core[i], 1.0]);
        let count = STRIPS.div_ceil(CELLS);
        let mut sides: Vec<[f64; 3]> = Vec::new();
        for kind in [0, 1] {
            let mut own: Vec<Fibre> = pieces.iter().copied().filter(|f| f.kind == kind).collect();
            own.retain(|f| f.area_m2 > 0.0);
            own.sort_by(|a, b| a.place_m.total_cmp(&b.place_m));
            let (low, high): (Vec<Fibre>, Vec<Fibre>) = own.iter().partition(|f| f.place_m < 0.0);
            for half in [low, high] {
                sides.extend(half.chunks(count).map(|c| {
                    let length: f64 = c.iter().map(|f| f.area_m2).sum();
                    let first: f64 = c.iter().map(|f| f.area_m2 * f.place_m).sum();
                    [first / length, length, kind as f64]
                }));
            }
        }
        sides
    });
    let mut fibres = Vec::with_capacity(axes[0].len() * axes[1].len());
    for a in &axes[0] {
        for b in &axes[1] {
            let kind = if a[2] > 0.5 || b[2] > 0.5 { 1 } else { 0 };
            fibres.push(Fibre { place_m: a[0] * unit[0] + b[0] * unit[1], area_m2: a[1] * b[1], kind });
        }
    }
    fibres
}

#[cfg(test)]
#[path = "fibre_tests.rs"]
mod tests;
