//! The one-point hexahedron with assumed-strain co-rotational stiffness hourglass control, eight elements at a time.
//!
//! Sources: uniform gradient operator and hourglass vectors γ: Flanagan and Belytschko, Int. J. Numer. Meth.
//! Engng 17 (1981) 679-706. Hourglass stiffness: Belytschko and Bindeman, Comput. Methods Appl. Mech. Engng 105
//! (1993) 225-260, form ASQBI.
//!
//! Per step from configuration n to n+1, with the displacement increment Δu:
//! * `B_iI = ∫ ∂N_I/∂x_i dV` at n+1, exact for any hexahedron; `V = x_iI B_iI / 3`; `b = B / V`;
//! * `L = Δu_iI b_jI`, taken to the mid-step configuration by `L_mid = L (I - L/2)^-1` (series to third order): a finite
//!   rotation increment then strains nothing (Hughes and Winget 1980);
//! * the strain increment is turned into the element's own frame, where the stress lives; no spin terms are needed;
//! * twelve generalised hourglass strains `q_iα = γ_αI Δu_iI` in the element's frame drive the stresses `Q_iα`.
//!
//! **Plastic hourglass stress.** A stabilisation that stays elastic while the element flows locks plastic bending.
//! While the centre flows, an off-centre point on the same yield surface carries the same deviator plus a difference δs with
//! `δs' = C_ep δε' - 3 G p' δs / σ_y`: its driving modulus falls to the tangent modulus, and what it has already
//! gathered fades with the same radial return as the centre. So `Q` is updated with the modulus ratio `H / (3G + H)`, not below
//! [`HOURGLASS_FLOOR`], and scaled by `σ_y / q_trial`.
//!
//! All arrays are `[component][lane]`; a lane is an element. No fused multiply-add: results are the same bytes on every instruction set.

use crate::material::j2::HardeningTable;

/// Elements a block holds.
pub const LANES: usize = 8;
/// One value for each element of a block.
pub type Lane = [f64; LANES];

/// Smallest share of the elastic hourglass stiffness left in a flowing element. Without it flowing regions develop zigzag
/// modes (the hourglass energy turns negative at 0.02). Tip of the plastic cantilever of the verification at 0.5 s, 20 and 40
/// elements long: 0.05: 698, 669 mm; 0.1: 684, 664 mm; 0.2: 655, 655 mm; converged value 655 to 665 mm.
pub const HOURGLASS_FLOOR: f64 = 0.1;
/// Linear bulk viscosity coefficient (usual value of explicit codes).
pub const BULK_LINEAR: f64 = 0.06;
/// Quadratic bulk viscosity coefficient, compression only.
pub const BULK_QUADRATIC: f64 = 1.5;

/// Signs of the reference coordinates ξ, η, ζ at the nodes.
const LAMBDA: [[f64; 8]; 3] = [
    [-1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0],
    [-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0],
];

/// Hourglass base vectors: ηζ, ξζ, ξη, ξηζ.
const HOURGLASS: [[f64; 8]; 4] = [
    [1.0, 1.0, -1.0, -1.0, -1.0, -1.0, 1.0, 1.0],
    [1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0],
];

/// Node order seen from each node, for the uniform gradient (Flanagan and Belytschko 1981, eq. 79 and table 1).
const TURN: [[usize; 8]; 8] = [
    [0, 1, 2, 3, 4, 5, 6, 7],
    [1, 2, 3, 0, 5, 6, 7, 4],
    [2, 3, 0, 1, 6, 7, 4, 5],
    [3, 0, 1, 2, 7, 4, 5, 6],
    [4, 7, 6, 5, 0, 3, 2, 1],
    [5, 4, 7, 6, 1, 0, 3, 2],
    [6, 5, 4, 7, 2, 1, 0, 3],
    [7, 6, 5, 4, 3, 2, 1, 0],
];

/// Material constants of eight elements that share a hardening table.
#[derive(Debug, Clone, Copy, Default)]
pub struct BlockMaterial {
    /// First Lamé constant \[Pa\].
    pub lambda_pa: Lane,
    /// Shear modulus \[Pa\].
    pub mu_pa: Lane,
    /// Factor on the table's yield stress.
    pub yield_scale: Lane,
    /// Mass of the element \[kg\].
    pub mass_kg: Lane,
    /// Plastic strain at which the element erodes.
    pub critical_strain: Lane,
    /// Index of the hardening table.
    pub table: usize,
}

/// What a block of elements remembers.
#[derive(Debug, Clone, Copy, Default)]
pub struct BlockState {
    /// Cauchy stress in the element's frame \[Pa\]: xx, yy, zz, xy, yz, zx.
    pub stress: [Lane; 6],
    /// Generalised hourglass stresses, `3 * α + i` \[N m ... per unit q\].
    pub hourglass: [Lane; 12],
    /// Equivalent plastic strain.
    pub plastic_strain: Lane,
    /// Net strain since the last reset, same order as `stress`, tensor components.
    pub window_strain: [Lane; 6],
    /// Work done on the element by its stress \[J\].
    pub internal_j: Lane,
    /// Work done against hourglass control \[J\].
    pub hourglass_j: Lane,
    /// Work done against bulk viscosity \[J\].
    pub viscous_j: Lane,
    /// Share of the element's forces that acts: 1, falling to 0 while it is removed, 0 once eroded or removed.
    pub share: Lane,
}

/// Forces of a block: `[3 * node + direction]` \[N\].
pub type BlockForce = [Lane; 24];

/// Options of one kernel call.
#[derive(Debug, Clone, Copy)]
pub struct KernelStep {
    /// Time step \[s\] (only the bulk viscosity needs it).
    pub dt_s: f64,
    /// Bulk viscosity on or off (off in static solves).
    pub viscous: bool,
}

/// Updates a block and writes the internal nodal forces; returns the largest squared frequency bound of each
/// element \[1/s²\].
///
/// `x` are the positions at n+1, `du` the displacement increment from n to n+1, both `[3 * node + direction]`.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
pub fn update_block(
    x: &BlockForce,
    du: &BlockForce,
    material: &BlockMaterial,
    table: &HardeningTable,
    state: &mut BlockState,
    force: &mut BlockForce,
    step: KernelStep,
) -> Lane {
    let mut b = [[0.0; LANES]; 24];
    let mut volume = [0.0; LANES];
    gradient(x, &mut b, &mut volume);
    let mut frame = [[0.0; LANES]; 9];
    let mut edge = [[0.0; LANES]; 3];
    element_frame(x, &mut frame, &mut edge);
    let mut strain = [[0.0; LANES]; 6];
    strain_increment(du, &b, &frame, &mut strain);
    let mut ratio = [1.0; LANES];
    let mut tangent = [1.0; LANES];
    let old = state.stress;
    trial_stress(material, &strain, &mut state.stress);
    let mut gamma = [[0.0; LANES]; 32];
    hourglass_vectors(x, &b, &mut gamma);
    let (mut q, mut rate) = ([[0.0; LANES]; 12], [[0.0; LANES]; 12]);
    hourglass_strains(du, &gamma, &frame, &mut q);
    let mut extra = [0.0; LANES];
    hourglass_trial(&q, &edge, &volume, material, state, &mut rate, &mut extra);
    radial_return(material, table, &extra, state, &mut ratio, &mut tangent);
    let mut pressure = [0.0; LANES];
    if step.viscous {
        bulk_viscosity(material, &strain, &volume, step.dt_s, &mut pressure);
    }
    work(&old, &strain, &volume, &pressure, state);
    hourglass_finish(&q, &rate, &ratio, &tangent, state);
    nodal_forces(&b, &volume, &gamma, &frame, &pressure, state, force);
    frequency_bound(&b, &volume, material)
}

/// Uniform gradient `b = B / V` and volume.
#[inline(always)]
fn gradient(x: &BlockForce, b: &mut BlockForce, volume: &mut Lane) {
    for (node, turn) in TURN.iter().enumerate() {
        for axis in 0..3 {
            let (p, r) = ((axis + 1) % 3, (axis + 2) % 3);
            let y = |n: usize, l: usize| x[3 * turn[n] + p][l];
            let z = |n: usize, l: usize| x[3 * turn[n] + r][l];
            for l in 0..LANES {
                let z24 = z(1, l) - z(3, l);
                let z52 = z(4, l) - z(1, l);
                let z45 = z(3, l) - z(4, l);
                b[3 * node + axis][l] = (y(1, l) * ((z(5, l) - z(2, l)) - z45)
                    + y(2, l) * z24
                    + y(3, l) * ((z(2, l) - z(7, l)) - z52)
                    + y(4, l) * ((z(7, l) - z(5, l)) - z24)
                    + y(5, l) * z52
                    + y(7, l) * z45)
                    / 12.0;
            }
        }
    }
    for l in 0..LANES {
        let mut sum = 0.0;
        for i in 0..24 {
            sum += x[i][l] * b[i][l];
        }
        volume[l] = sum / 3.0;
    }
    let mut inverse = [0.0; LANES];
    for l in 0..LANES {
        inverse[l] = 1.0 / volume[l];
    }
    for row in b.iter_mut() {
        for l in 0..LANES {
            row[l] *= inverse[l];
        }
    }
}

/// The element's frame, rows of a rotation, from its mean edge directions by Gram-Schmidt, and the projections
/// of the mean edges on it (`Λ_i · x_i`, eight times the half edge).
#[inline(always)]
fn element_frame(x: &BlockForce, frame: &mut [Lane; 9], edge: &mut [Lane; 3]) {
    let mut mean = [[0.0; LANES]; 9];
    for (axis, signs) in LAMBDA.iter().enumerate() {
        for i in 0..3 {
            for l in 0..LANES {
                let mut sum = 0.0;
                for node in 0..8 {
                    sum += signs[node] * x[3 * node + i][l];
                }
                mean[3 * axis + i][l] = sum;
            }
        }
    }
    for l in 0..LANES {
        let m = |i: usize| mean[i][l];
        let n1 = 1.0 / (m(0) * m(0) + m(1) * m(1) + m(2) * m(2)).sqrt();
        let e1 = [m(0) * n1, m(1) * n1, m(2) * n1];
        let along = e1[0] * m(3) + e1[1] * m(4) + e1[2] * m(5);
        let r2 = [m(3) - along * e1[0], m(4) - along * e1[1], m(5) - along * e1[2]];
        let n2 = 1.0 / (r2[0] * r2[0] + r2[1] * r2[1] + r2[2] * r2[2]).sqrt();
        let e2 = [r2[0] * n2, r2[1] * n2, r2[2] * n2];
        let e3 = [e1[1] * e2[2] - e1[2] * e2[1], e1[2] * e2[0] - e1[0] * e2[2], e1[0] * e2[1] - e1[1] * e2[0]];
        for i in 0..3 {
            frame[i][l] = e1[i];
            frame[3 + i][l] = e2[i];
            frame[6 + i][l] = e3[i];
        }
        edge[0][l] = e1[0] * m(0) + e1[1] * m(1) + e1[2] * m(2);
        edge[1][l] = e2[0] * m(3) + e2[1] * m(4) + e2[2] * m(5);
        edge[2][l] = e3[0] * m(6) + e3[1] * m(7) + e3[2] * m(8);
    }
}

/// Strain increment in the element's frame (tensor components xx, yy, zz, xy, yz, zx).
#[inline(always)]
fn strain_increment(du: &BlockForce, b: &BlockForce, frame: &[Lane; 9], strain: &mut [Lane; 6]) {
    let mut g = [[0.0; LANES]; 9];
    for i in 0..3 {
        for j in 0..3 {
            for l in 0..LANES {
                let mut sum = 0.0;
                for node in 0..8 {
                    sum += du[3 * node + i][l] * b[3 * node + j][l];
                }
                g[3 * i + j][l] = sum;
            }
        }
    }
    for l in 0..LANES {
        let m: [f64; 9] = std::array::from_fn(|i| g[i][l]);
        let product = |a: &[f64; 9], c: &[f64; 9]| -> [f64; 9] {
            std::array::from_fn(|k| {
                let (i, j) = (k / 3, k % 3);
                a[3 * i] * c[j] + a[3 * i + 1] * c[3 + j] + a[3 * i + 2] * c[6 + j]
            })
        };
        let m2 = product(&m, &m);
        let m3 = product(&m2, &m);
        let mid: [f64; 9] = std::array::from_fn(|k| m[k] + 0.5 * m2[k] + 0.25 * m3[k]);
        let d = [mid[0], mid[4], mid[8], 0.5 * (mid[1] + mid[3]), 0.5 * (mid[5] + mid[7]), 0.5 * (mid[2] + mid[6])];
        let r: [f64; 9] = std::array::from_fn(|k| frame[k][l]);
        let turned = |p: usize| -> [f64; 3] {
            let e = [r[3 * p], r[3 * p + 1], r[3 * p + 2]];
            [
                d[0] * e[0] + d[3] * e[1] + d[5] * e[2],
                d[3] * e[0] + d[1] * e[1] + d[4] * e[2],
                d[5] * e[0] + d[4] * e[1] + d[2] * e[2],
            ]
        };
        let dot = |a: [f64; 3], p: usize| a[0] * r[3 * p] + a[1] * r[3 * p + 1] + a[2] * r[3 * p + 2];
        let (t0, t1, t2) = (turned(0), turned(1), turned(2));
        strain[0][l] = dot(t0, 0);
        strain[1][l] = dot(t1, 1);
        strain[2][l] = dot(t2, 2);
        strain[3][l] = dot(t0, 1);
        strain[4][l] = dot(t1, 2);
        strain[5][l] = dot(t2, 0);
    }
}

/// Adds the elastic stress increment.
#[inline(always)]
fn trial_stress(material: &BlockMaterial, strain: &[Lane; 6], stress: &mut [Lane; 6]) {
    for l in 0..LANES {
        let (lambda, two_mu) = (material.lambda_pa[l], 2.0 * material.mu_pa[l]);
        let trace = lambda * (strain[0][l] + strain[1][l] + strain[2][l]);
        for i in 0..3 {
            stress[i][l] += trace + two_mu * strain[i][l];
            stress[i + 3][l] += two_mu * strain[i + 3][l];
        }
    }
}

/// Radial return of the lanes that exceed their yield stress. `ratio` is the factor on the deviator, `tangent`
/// the share of the elastic stiffness left to the hourglass strains.
#[inline(always)]
fn radial_return(
    material: &BlockMaterial,
    table: &HardeningTable,
    extra: &Lane,
    state: &mut BlockState,
    ratio: &mut Lane,
    tangent: &mut Lane,
) {
    let mut mises = [0.0; LANES];
    let mut mean = [0.0; LANES];
    let s = &state.stress;
    for l in 0..LANES {
        let (xx, yy, zz) = (s[0][l], s[1][l], s[2][l]);
        mean[l] = (xx + yy + zz) / 3.0;
        let (a, b, c) = (xx - yy, yy - zz, zz - xx);
        let shear = s[3][l] * s[3][l] + s[4][l] * s[4][l] + s[5][l] * s[5][l];
        mises[l] = (0.5 * (a * a + b * b + c * c) + 3.0 * shear + extra[l]).sqrt();
    }
    let lowest = table.lowest_stress_pa();
    if (0..LANES).all(|l| mises[l] <= lowest * material.yield_scale[l]) {
        return;
    }
    for l in 0..LANES {
        let g = material.mu_pa[l];
        let (increment, slope) =
            table.plastic_increment(mises[l], state.plastic_strain[l], g, material.yield_scale[l]);
        if increment > 0.0 {
            state.plastic_strain[l] += increment;
            ratio[l] = 1.0 - 3.0 * g * increment / mises[l];
            tangent[l] = (slope / (3.0 * g + slope)).max(HOURGLASS_FLOOR);
        }
    }
    for l in 0..LANES {
        for i in 0..3 {
            state.stress[i][l] = mean[l] + ratio[l] * (state.stress[i][l] - mean[l]);
            state.stress[i + 3][l] *= ratio[l];
        }
    }
}

/// Bulk viscosity pressure (negative: compression), von Neumann and Richtmyer (1950) with a linear term.
#[inline(always)]
fn bulk_viscosity(material: &BlockMaterial, strain: &[Lane; 6], volume: &Lane, dt_s: f64, pressure: &mut Lane) {
    for l in 0..LANES {
        let rate = (strain[0][l] + strain[1][l] + strain[2][l]) / dt_s;
        let density = material.mass_kg[l] / volume[l];
        let length = volume[l].cbrt();
        let speed = ((material.lambda_pa[l] + 2.0 * material.mu_pa[l]) / density).sqrt();
        let quadratic = if rate < 0.0 { BULK_QUADRATIC * BULK_QUADRATIC * length * rate.abs() } else { 0.0 };
        pressure[l] = density * length * rate * (BULK_LINEAR * speed + quadratic);
    }
}

/// Work of stress and viscosity over the increment; accumulates the strain window.
#[inline(always)]
fn work(old: &[Lane; 6], strain: &[Lane; 6], volume: &Lane, pressure: &Lane, state: &mut BlockState) {
    const WEIGHT: [f64; 6] = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0];
    for l in 0..LANES {
        let mut power = 0.0;
        for i in 0..6 {
            power += WEIGHT[i] * 0.5 * (old[i][l] + state.stress[i][l]) * strain[i][l];
            state.window_strain[i][l] += strain[i][l];
        }
        let scaled = volume[l] * state.share[l];
        state.internal_j[l] += scaled * power;
        state.viscous_j[l] += scaled * pressure[l] * (strain[0][l] + strain[1][l] + strain[2][l]);
    }
}

/// Hourglass vectors `γ_α = (h_α - (h_α · x_i) b_i) / 8`, stored `[8 * α + node]`.
#[inline(always)]
fn hourglass_vectors(x: &BlockForce, b: &BlockForce, gamma: &mut [Lane; 32]) {
    for (mode, signs) in HOURGLASS.iter().enumerate() {
        let mut along = [[0.0; LANES]; 3];
        for i in 0..3 {
            for l in 0..LANES {
                let mut sum = 0.0;
                for node in 0..8 {
                    sum += signs[node] * x[3 * node + i][l];
                }
                along[i][l] = sum;
            }
        }
        for node in 0..8 {
            for l in 0..LANES {
                let linear = along[0][l] * b[3 * node][l]
                    + along[1][l] * b[3 * node + 1][l]
                    + along[2][l] * b[3 * node + 2][l];
                gamma[8 * mode + node][l] = 0.125 * (signs[node] - linear);
            }
        }
    }
}

/// Generalised hourglass strain increments in the element's frame, `3 * α + i`.
#[inline(always)]
fn hourglass_strains(du: &BlockForce, gamma: &[Lane; 32], frame: &[Lane; 9], q: &mut [Lane; 12]) {
    for mode in 0..4 {
        let mut global = [[0.0; LANES]; 3];
        for i in 0..3 {
            for l in 0..LANES {
                let mut sum = 0.0;
                for node in 0..8 {
                    sum += gamma[8 * mode + node][l] * du[3 * node + i][l];
                }
                global[i][l] = sum;
            }
        }
        for i in 0..3 {
            for l in 0..LANES {
                q[3 * mode + i][l] = frame[3 * i][l] * global[0][l]
                    + frame[3 * i + 1][l] * global[1][l]
                    + frame[3 * i + 2][l] * global[2][l];
            }
        }
    }
}

/// Elastic increments of the generalised hourglass stresses, ASQBI (Belytschko and Bindeman 1993, integrated form):
/// with i, j, k a permutation and `H_ii = (Λ_j x_j)(Λ_k x_k) / (3 Λ_i x_i)`, `H_ij = Λ_k x_k / 3`,
/// `Q_ii' = μ[(H_jj + H_kk) q_ii' + H_ij q_jj' + H_ik q_kk']`,
/// `Q_ij' = 2μ/(1-ν) [H_ii q_ij' + ν H_ij q_ji']`, `Q_i4' = 2μ(1+ν)/3 H_ii q_i4'`.
///
/// `extra` is the mean square of the von Mises stress that the trial hourglass stresses stand for, from their elastic energy `U`
/// with the relation of pure shear, `q² = 6 G U / V`.
#[inline(always)]
fn hourglass_trial(
    q: &[Lane; 12],
    edge: &[Lane; 3],
    volume: &Lane,
    material: &BlockMaterial,
    state: &BlockState,
    rate: &mut [Lane; 12],
    extra: &mut Lane,
) {
    for l in 0..LANES {
        let a = [edge[0][l], edge[1][l], edge[2][l]];
        let mu = material.mu_pa[l];
        let nu = 0.5 * material.lambda_pa[l] / (material.lambda_pa[l] + mu);
        let h: [f64; 3] = [a[1] * a[2] / (3.0 * a[0]), a[2] * a[0] / (3.0 * a[1]), a[0] * a[1] / (3.0 * a[2])];
        let cross = |i: usize, j: usize| a[3 - i - j] / 3.0;
        let bending = 2.0 * mu / (1.0 - nu);
        let volumetric = 2.0 * mu * (1.0 + nu) / 3.0;
        let mut energy = 0.0;
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            rate[3 * i + i][l] =
                mu * ((h[j] + h[k]) * q[4 * i][l] + cross(i, j) * q[4 * j][l] + cross(i, k) * q[4 * k][l]);
            let twist = state.hourglass[4 * i][l] + rate[4 * i][l];
            energy += twist * twist / (mu * (h[j] + h[k]));
            for m in [j, k] {
                rate[3 * m + i][l] = bending * (h[i] * q[3 * m + i][l] + nu * cross(i, m) * q[3 * i + m][l]);
                let bend = state.hourglass[3 * m + i][l] + rate[3 * m + i][l];
                energy += bend * bend / (bending * h[i]);
            }
            rate[9 + i][l] = volumetric * h[i] * q[9 + i][l];
            let last = state.hourglass[9 + i][l] + rate[9 + i][l];
            energy += last * last / (volumetric * h[i]);
        }
        extra[l] = 3.0 * mu * energy / volume[l];
    }
}

/// Returns the hourglass stresses with the centre and books their work.
#[inline(always)]
fn hourglass_finish(q: &[Lane; 12], rate: &[Lane; 12], ratio: &Lane, tangent: &Lane, state: &mut BlockState) {
    let mut power = [0.0; LANES];
    for i in 0..12 {
        for l in 0..LANES {
            let before = state.hourglass[i][l];
            let after = ratio[l] * (before + tangent[l] * rate[i][l]);
            power[l] += 0.5 * (before + after) * q[i][l];
            state.hourglass[i][l] = after;
        }
    }
    for l in 0..LANES {
        state.hourglass_j[l] += state.share[l] * power[l];
    }
}

/// Internal nodal forces `V σ b + γ Q`, turned to the global frame and scaled by the acting share.
#[inline(always)]
fn nodal_forces(
    b: &BlockForce,
    volume: &Lane,
    gamma: &[Lane; 32],
    frame: &[Lane; 9],
    pressure: &Lane,
    state: &BlockState,
    force: &mut BlockForce,
) {
    let mut sigma = [[0.0; LANES]; 6];
    for l in 0..LANES {
        let s: [f64; 6] = std::array::from_fn(|i| state.stress[i][l]);
        let local = [
            [s[0] + pressure[l], s[3], s[5]],
            [s[3], s[1] + pressure[l], s[4]],
            [s[5], s[4], s[2] + pressure[l]],
        ];
        let scale = volume[l] * state.share[l];
        let r = |p: usize, i: usize| frame[3 * p + i][l];
        let half: [[f64; 3]; 3] = std::array::from_fn(|p| {
            std::array::from_fn(|i| local[p][0] * r(0, i) + local[p][1] * r(1, i) + local[p][2] * r(2, i))
        });
        let full = |i: usize, j: usize| scale * (r(0, i) * half[0][j] + r(1, i) * half[1][j] + r(2, i) * half[2][j]);
        sigma[0][l] = full(0, 0);
        sigma[1][l] = full(1, 1);
        sigma[2][l] = full(2, 2);
        sigma[3][l] = full(0, 1);
        sigma[4][l] = full(1, 2);
        sigma[5][l] = full(2, 0);
    }
    const AT: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];
    let mut turned = [[0.0; LANES]; 12];
    for mode in 0..4 {
        for i in 0..3 {
            for l in 0..LANES {
                turned[3 * mode + i][l] = state.share[l]
                    * (frame[i][l] * state.hourglass[3 * mode][l]
                        + frame[3 + i][l] * state.hourglass[3 * mode + 1][l]
                        + frame[6 + i][l] * state.hourglass[3 * mode + 2][l]);
            }
        }
    }
    for node in 0..8 {
        for i in 0..3 {
            for l in 0..LANES {
                force[3 * node + i][l] = sigma[AT[i][0]][l] * b[3 * node][l]
                    + sigma[AT[i][1]][l] * b[3 * node + 1][l]
                    + sigma[AT[i][2]][l] * b[3 * node + 2][l]
                    + gamma[node][l] * turned[i][l]
                    + gamma[8 + node][l] * turned[3 + i][l]
                    + gamma[16 + node][l] * turned[6 + i][l]
                    + gamma[24 + node][l] * turned[9 + i][l];
            }
        }
    }
}

/// Upper bound of the element's largest squared frequency: with `G_ij = b_iI b_jI`,
/// `ω² <= (8 V / m) (λ tr G + 2 μ λ_max(G))`, `λ_max` by the largest row sum (Gershgorin).
#[inline(always)]
fn frequency_bound(b: &BlockForce, volume: &Lane, material: &BlockMaterial) -> Lane {
    let mut bound = [0.0; LANES];
    for l in 0..LANES {
        let mut g = [0.0; 6];
        for node in 0..8 {
            let c = [b[3 * node][l], b[3 * node + 1][l], b[3 * node + 2][l]];
            g[0] += c[0] * c[0];
            g[1] += c[1] * c[1];
            g[2] += c[2] * c[2];
            g[3] += c[0] * c[1];
            g[4] += c[1] * c[2];
            g[5] += c[2] * c[0];
        }
        let (xy, yz, zx) = (g[3].abs(), g[4].abs(), g[5].abs());
        let largest = (g[0] + xy + zx).max(g[1] + xy + yz).max(g[2] + yz + zx);
        bound[l] = 8.0 * volume[l] / material.mass_kg[l]
            * (material.lambda_pa[l] * (g[0] + g[1] + g[2]) + 2.0 * material.mu_pa[l] * largest);
    }
    bound
}
