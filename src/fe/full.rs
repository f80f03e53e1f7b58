//! The fully integrated hexahedron: 2 x 2 x 2 Gauss points, volume strain averaged over the element.
//!
//! It is there to compare with: no hourglass modes, no stabilisation to trust, eight stress states that flow each for itself; some
//! thirty times slower than the one-point element. Volume strain is the mean over the element (Hughes, Int. J. Numer. Meth.
//! Engng 15 (1980) 1413-1418, with the mean dilatation of Nagtegaal, Parks and Rice, Comput. Methods Appl. Mech. Engng 4 (1974) 153-177): plastic
//! incompressibility then costs one condition an element instead of eight and does not lock. Shear is that of the displacements: long thin
//! elements lock in bending.
//!
//! Per step, as in the one-point kernel ([`super::kernel`]): at each point `L = ∂Δu/∂x` at n+1, taken to mid-step, turned into the element's frame;
//! its trace is replaced by that of the mean gradient `b`, which the eight points integrate exactly. All points share one pressure `p`, so the
//! nodal forces are `Σ_p w_p s_p ∇N_I + V p b_I` with the deviators `s_p`.
//!
//! **Frequency.** With displacements u, `u·K u = Σ_p w_p [2μ |ε_p|² - (2/3)μ (tr ε_p)²] + V (λ + 2μ/3) (tr ε̄)²`, and by Jensen's inequality the
//! `μ` terms with traces are negative together, so with `G_p = Σ_I ∇N_I ∇N_I` at a point and `Ḡ` that of `b`
//! `ω² <= (8/m) [λ V tr Ḡ + 2μ Σ_p w_p λ_max(G_p)]`, each `λ_max` by the largest row sum.

use super::hexahedron::{frame, gradient, to_global, to_nodes};
use super::kernel::{
    BlockForce, BlockMaterial, BlockState, KernelStep, LANES, Lane, patterns, turned_strain,
};
use super::limit::bulk_viscosity;
use crate::base::vector::{V3, add, cross, dot, scale};
use crate::material::j2::HardeningTable;
use serde::{Deserialize, Serialize};

/// Integration points.
pub const POINTS: usize = 8;

/// What the points of a block remember besides the block's own state, which holds their means by volume.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct FullState {
    /// Cauchy stress in the element's frame at each point \[Pa\]: xx, yy, zz, xy, yz, zx.
    pub stress: [[Lane; 6]; POINTS],
    /// Equivalent plastic strain at each point.
    pub plastic_strain: [Lane; POINTS],
}

impl FullState {
    /// Takes one lane of another block.
    pub fn copy_lane(&mut self, to: usize, other: &Self, from: usize) {
        for (here, there) in self.stress.as_flattened_mut().iter_mut().zip(other.stress.as_flattened()) {
            here[to] = there[from];
        }
        for (here, there) in self.plastic_strain.iter_mut().zip(&other.plastic_strain) {
            here[to] = there[from];
        }
    }
}

/// Geometry and motion at a point of one element.
struct Point {
    /// Gradients of the pattern functions, `8 ∇N_I = Σ_k Λ_kI slope_k` \[1/m\].
    slope: [V3; 7],
    /// Volume that the point stands for \[m³\].
    weight: f64,
    /// Strain increment in the element's frame.
    strain: [f64; 6],
}

/// Updates a block of fully integrated elements; arguments and result are those of the one-point kernel, with the state of the points.
/// The displacement increment is `factor * v`.
#[expect(clippy::too_many_arguments, reason = "the arguments of the one-point kernel and the points")]
pub fn update(
    x: &BlockForce,
    v: &BlockForce,
    factor: f64,
    material: &BlockMaterial,
    table: &HardeningTable,
    state: &mut BlockState,
    points: &mut FullState,
    force: &mut BlockForce,
    step: KernelStep,
) -> Lane {
    let mut bound = [0.0; LANES];
    for l in 0..LANES {
        let nodal = if state.share[l] > 0.0 {
            let (nodal, highest) = element(l, x, v, factor, material, table, state, points, step);
            bound[l] = highest;
            nodal
        } else {
            [[0.0; 8]; 3]
        };
        for i in 0..3 {
            for node in 0..8 {
                force[3 * node + i][l] = nodal[i][node];
            }
        }
    }
    bound
}

/// One element: nodal forces by direction, and its frequency bound, zero once it is turned inside out at a point.
#[expect(clippy::too_many_arguments, reason = "the arguments of the one-point kernel and the points")]
fn element(
    l: usize,
    x: &BlockForce,
    v: &BlockForce,
    factor: f64,
    material: &BlockMaterial,
    table: &HardeningTable,
    state: &mut BlockState,
    points: &mut FullState,
    step: KernelStep,
) -> ([[f64; 8]; 3], f64) {
    let (at, moved) = (patterns(x, l), patterns(v, l).map(|u| scale(factor, u)));
    let (e, volume) = gradient(&at);
    let rows = frame(at[0], at[1]);
    let (lambda, mu) = (material.lambda_pa[l], material.mu_pa[l]);
    let (mean, trace_of_g) = mean_gradient(&e, volume, &moved);
    let strain = turned_strain(&mean, &rows);
    let trace = strain[0] + strain[1] + strain[2];

    let mut coefficient = [[0.0; 7]; 3];
    let (mut power, mut largest, mut whole) = (0.0, 0.0, true);
    let (mut stress_mean, mut plastic_mean) = ([0.0; 6], 0.0);
    for p in 0..POINTS {
        let point = point(p, &at, &moved, &rows, trace);
        let (old, new) = respond(l, p, &point.strain, material, table, points, step);
        for i in 0..6 {
            let factor = if i < 3 { 0.5 } else { 1.0 };
            power += point.weight * factor * (old[i] + new[i]) * point.strain[i];
            stress_mean[i] += point.weight * new[i];
        }
        plastic_mean += point.weight * points.plastic_strain[p][l];
        let pressure = (new[0] + new[1] + new[2]) / 3.0;
        add_force(&mut coefficient, &point, &rows, &new, pressure);
        largest += point.weight * largest_row(&point.slope);
        whole &= point.weight > 0.0;
    }
    for i in 0..6 {
        state.stress[i][l] = stress_mean[i] / volume;
    }
    state.plastic_strain[l] = plastic_mean / volume;

    let share = state.share[l];
    let mass = material.mass_kg[l];
    let bound = 8.0 / mass * (lambda.max(0.0) * volume * trace_of_g + 2.0 * mu * largest);
    let (viscous, damped) = bulk_viscosity(step.rate_1_s() * trace, volume, mass, lambda + 2.0 * mu, bound);
    state.internal_j[l] += share * power;
    state.viscous_j[l] += share * volume * 0.5 * (state.viscous_pa[l] + viscous) * trace;
    state.viscous_pa[l] = viscous;
    // V p b_I: p is the same at all points
    let pressure = (0..3).map(|i| points.stress[0][i][l]).sum::<f64>() / 3.0 + viscous;
    let mut nodal = [[0.0; 8]; 3];
    for i in 0..3 {
        for k in 0..6 {
            coefficient[i][k] += pressure * e[k][i] / 64.0;
        }
        nodal[i] = to_nodes(coefficient[i].map(|c| share * c));
    }
    (nodal, if whole { damped * bound } else { 0.0 })
}

/// Mean displacement gradient by rows, and the trace of `Σ_I b_I b_I`.
fn mean_gradient(e: &[V3; 6], volume: f64, moved: &[V3; 7]) -> ([V3; 3], f64) {
    let (mut mean, mut trace) = ([[0.0; 3]; 3], 0.0);
    for k in 0..6 {
        let b = scale(1.0 / (64.0 * volume), e[k]);
        trace += 8.0 * dot(b, b);
        for i in 0..3 {
            mean[i] = add(mean[i], scale(moved[k][i], b));
        }
    }
    (mean, trace)
}

/// Point `p` of an element, whose volume strain is `trace`.
fn point(p: usize, at: &[V3; 7], moved: &[V3; 7], rows: &[V3; 3], trace: f64) -> Point {
    let side = |bit: usize| if p >> bit & 1 == 0 { -1.0 } else { 1.0 } / 3f64.sqrt();
    let (xi, eta, zeta) = (side(0), side(1), side(2));
    // derivatives of the pattern functions ξ, η, ζ, ηζ, ξζ, ξη, ξηζ
    let derivative = [
        [1.0, 0.0, 0.0, 0.0, zeta, eta, eta * zeta],
        [0.0, 1.0, 0.0, zeta, 0.0, xi, xi * zeta],
        [0.0, 0.0, 1.0, eta, xi, 0.0, xi * eta],
    ];
    let along = |field: &[V3; 7], a: usize| {
        (0..7).fold([0.0; 3], |sum, k| add(sum, scale(0.125 * derivative[a][k], field[k])))
    };
    let tangent: [V3; 3] = std::array::from_fn(|a| along(at, a));
    let normal =
        [cross(tangent[1], tangent[2]), cross(tangent[2], tangent[0]), cross(tangent[0], tangent[1])];
    let weight = dot(tangent[0], normal[0]);
    let dual = normal.map(|n| scale(1.0 / weight, n));
    let slope =
        std::array::from_fn(|k| (0..3).fold([0.0; 3], |sum, a| add(sum, scale(derivative[a][k], dual[a]))));
    let mut g = [[0.0; 3]; 3];
    for a in 0..3 {
        let u = along(moved, a);
        for i in 0..3 {
            g[i] = add(g[i], scale(u[i], dual[a]));
        }
    }
    let mut strain = turned_strain(&g, rows);
    let excess = (trace - (strain[0] + strain[1] + strain[2])) / 3.0;
    strain[..3].iter_mut().for_each(|s| *s += excess);
    Point { slope, weight, strain }
}

/// Stress at a point before and after a strain increment.
fn respond(
    l: usize,
    p: usize,
    strain: &[f64; 6],
    material: &BlockMaterial,
    table: &HardeningTable,
    points: &mut FullState,
    step: KernelStep,
) -> ([f64; 6], [f64; 6]) {
    let (mu, scale) = (material.mu_pa[l], material.yield_scale[l]);
    let volumetric = material.lambda_pa[l] * (strain[0] + strain[1] + strain[2]);
    let old: [f64; 6] = std::array::from_fn(|i| points.stress[p][i][l]);
    let mut new: [f64; 6] =
        std::array::from_fn(|i| old[i] + 2.0 * mu * strain[i] + if i < 3 { volumetric } else { 0.0 });
    let (a, b, c) = (new[0] - new[1], new[1] - new[2], new[2] - new[0]);
    let shear = new[3] * new[3] + new[4] * new[4] + new[5] * new[5];
    let mises = (0.5 * (a * a + b * b + c * c) + 3.0 * shear).sqrt();
    let before = points.plastic_strain[p][l];
    let (increment, _) = if table.has_rate() && step.viscous {
        table.rated_increment(mises, before, mu, scale, step.dt_s)
    } else {
        table.plastic_increment(mises, before, mu, scale)
    };
    if increment > 0.0 {
        let ratio = 1.0 - 3.0 * mu * increment / mises;
        let mean = (new[0] + new[1] + new[2]) / 3.0;
        for (i, s) in new.iter_mut().enumerate() {
            let mean = if i < 3 { mean } else { 0.0 };
            *s = mean + ratio * (*s - mean);
        }
        points.plastic_strain[p][l] = before + increment;
    }
    for i in 0..6 {
        points.stress[p][i][l] = new[i];
    }
    (old, new)
}

/// Adds the pattern coefficients of the nodal forces `w s ∇N_I` of the deviator.
fn add_force(coefficient: &mut [[f64; 7]; 3], point: &Point, rows: &[V3; 3], stress: &[f64; 6], mean: f64) {
    let local = [
        [stress[0] - mean, stress[3], stress[5]],
        [stress[3], stress[1] - mean, stress[4]],
        [stress[5], stress[4], stress[2] - mean],
    ];
    let half = local.map(|row| to_global(rows, row));
    for i in 0..3 {
        let global = to_global(&half, [rows[0][i], rows[1][i], rows[2][i]]);
        for k in 0..7 {
            coefficient[i][k] += 0.125 * point.weight * dot(global, point.slope[k]);
        }
    }
}

/// Bound of the largest eigenvalue of `Σ_I ∇N_I ∇N_I`: the largest row sum.
fn largest_row(slope: &[V3; 7]) -> f64 {
    let mut g = [[0.0; 3]; 3];
    for s in slope {
        for i in 0..3 {
            g[i] = add(g[i], scale(0.125 * s[i], *s));
        }
    }
    g.iter().map(|row| row.iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max)
}
