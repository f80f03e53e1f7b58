//! The one-point hexahedron with assumed-strain co-rotational stiffness hourglass control, eight elements at a time.
//!
//! Sources: uniform gradient operator and hourglass vectors γ: Flanagan and Belytschko, Int. J. Numer. Meth.
//! Engng 17 (1981) 679-706. Hourglass stiffness: [`super::hourglass`], by default ASQBI of Belytschko and Bindeman (1993).
//!
//! Per step from configuration n to n+1, with the displacement increment Δu:
//! * `B_iI = ∫ ∂N_I/∂x_i dV` at n+1, exact for any hexahedron; `b = B / V`;
//! * `L = Δu_iI b_jI`, taken to the mid-step configuration by `L_mid = L (I - L/2)^-1`: a finite
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
//! The hourglass stresses count in the yield condition: `q_trial² = q(σ)² + 6 G U / V` with their elastic energy `U`. An element whose
//! centre is still elastic, but whose bending stress is not, flows too. Without this the end of a column two elements
//! deep bore up to three times its plastic moment.
//!
//! **Pattern coefficients.** Nodal fields are handled by their sums with the sign patterns of [`super::hexahedron`], where `b` has six
//! coefficients, and `γ_α = (h_α - (h_α · x_j) b_j) / 8` needs no nodal form at all:
//! `q_iα = (h_α · Δu_i - (h_α · x_j) L_ij) / 8`, and the nodal forces `V σ_ij b_jI + Q_iα γ_αI` are
//! `S_ij b_jI + Q_iα h_αI / 8` with `S_ij = V σ_ij - Q_iα (h_α · x_j) / 8`.
//!
//! **Lanes.** All arrays are `[component][lane]`; a lane is an element. The work is two loops over lanes without a branch or call, which the
//! compiler turns into vector code, and between them the return to the yield surface, which most blocks skip.
//! No fused multiply-add: results are the same bytes on every instruction set. Elements with share 0 strain no more: their
//! state is frozen and their forces are zero, whatever their nodes do.

use super::hexahedron::{frame, gradient, to_local, to_patterns};
use super::hourglass::{self, Brick, Control};
use super::law::{ElementForm, Hourglass};
use super::resist::resist;
use crate::base::isa::{Isa, for_each_isa};
use crate::base::vector::{V3, add, cross, dot, scale};
use crate::material::j2::HardeningTable;
use serde::{Deserialize, Serialize};

/// Elements a block holds.
pub const LANES: usize = 8;
/// One value for each element of a block.
pub type Lane = [f64; LANES];

/// Smallest share of the elastic hourglass stiffness left in a flowing element. Without it flowing regions develop zigzag
/// modes (at 0.02 the hourglass energy turns negative). Tip of the plastic cantilever of the verification at 0.5 s, 20 and 40
/// elements long: 698 and 667 mm; converged value 655 to 665 mm.
pub const HOURGLASS_FLOOR: f64 = 0.1;

/// Material constants of eight elements that share a hardening table.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
#[repr(C, align(64))]
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
    /// How the elements are integrated; the fully integrated form has a kernel of its own ([`super::full`]).
    pub form: ElementForm,
}

/// What a block of elements remembers.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
#[repr(C, align(64))]
pub struct BlockState {
    /// Cauchy stress in the element's frame \[Pa\]: xx, yy, zz, xy, yz, zx.
    pub stress: [Lane; 6],
    /// Generalised hourglass stresses `Q_iα`, `3 * α + i` \[N\]: work per unit of `q_iα`, which is a length since γ has no unit.
    pub hourglass: [Lane; 12],
    /// Equivalent plastic strain.
    pub plastic_strain: Lane,
    /// Work done on the element by its stress \[J\].
    pub internal_j: Lane,
    /// Work done against hourglass control \[J\].
    pub hourglass_j: Lane,
    /// Work done against bulk viscosity \[J\].
    pub viscous_j: Lane,
    /// Bulk viscosity pressure of the last step \[Pa\], negative in compression.
    pub viscous_pa: Lane,
    /// Share of the element's forces that acts: 1, falling to 0 while it is removed, 0 once eroded or removed.
    pub share: Lane,
}

impl BlockMaterial {
    /// Takes one lane of another block.
    pub fn copy_lane(&mut self, to: usize, other: &Self, from: usize) {
        let pairs = [
            (&mut self.lambda_pa, &other.lambda_pa),
            (&mut self.mu_pa, &other.mu_pa),
            (&mut self.yield_scale, &other.yield_scale),
            (&mut self.mass_kg, &other.mass_kg),
            (&mut self.critical_strain, &other.critical_strain),
        ];
        for (here, there) in pairs {
            here[to] = there[from];
        }
    }
}

impl BlockState {
    /// Takes one lane of another block.
    pub fn copy_lane(&mut self, to: usize, other: &Self, from: usize) {
        let mut theirs = *other;
        for (here, there) in self.lanes_mut().zip(theirs.lanes_mut()) {
            here[to] = there[from];
        }
    }

    /// Empties a lane: it holds no element.
    pub fn clear_lane(&mut self, lane: usize) {
        self.lanes_mut().for_each(|values| values[lane] = 0.0);
    }

    /// All its numbers.
    fn lanes_mut(&mut self) -> impl Iterator<Item = &mut Lane> {
        let Self { stress, hourglass, plastic_strain, internal_j, hourglass_j, viscous_j, viscous_pa, share } =
            self;
        let single = [plastic_strain, internal_j, hourglass_j, viscous_j, viscous_pa, share];
        stress.iter_mut().chain(hourglass.iter_mut()).chain(single)
    }
}

/// Forces of a block: `[3 * node + direction]` \[N\].
pub type BlockForce = [Lane; 24];

/// Options of one kernel call.
#[derive(Debug, Clone, Copy)]
pub struct KernelStep {
    /// Time step \[s\], for all that depends on rates.
    pub dt_s: f64,
    /// Whether there are rates: bulk viscosity, viscous hourglass control and rate factors are off in static solves.
    pub viscous: bool,
}

impl KernelStep {
    /// Steps per second, 0 in static solves \[1/s\].
    #[inline(always)]
    pub(super) fn rate_1_s(self) -> f64 {
        if self.viscous { 1.0 / self.dt_s } else { 0.0 }
    }
}

/// What the first loop hands to the second.
#[repr(C, align(64))]
pub(super) struct Scratch {
    /// Trial stress, local frame.
    pub(super) trial: [Lane; 6],
    /// Mises stress and mean stress of the trial.
    pub(super) mises: Lane,
    pub(super) mean: Lane,
    /// Strain increment, local frame.
    pub(super) strain: [Lane; 6],
    /// Rows of the frame.
    pub(super) frame: [Lane; 9],
    /// Pattern coefficients of `b`, `3 * pattern + axis`.
    pub(super) b: [Lane; 18],
    /// `h_α · x_j`, `3 * α + j`.
    pub(super) warp: [Lane; 12],
    /// Generalised hourglass strain increments, local frame, `3 * α + i`.
    pub(super) q: [Lane; 12],
    /// Their elastic stress increments, same order.
    pub(super) rate: [Lane; 12],
    pub(super) volume: Lane,
    /// `Σ_αj ((h_α · x_j) / (Λ_j · x_j))²` in the frame: 0 for a parallelepiped.
    pub(super) distortion: Lane,
    /// Factor on the deviator, and share of the hourglass stiffness that is left.
    pub(super) ratio: Lane,
    pub(super) tangent: Lane,
}

const ZERO: Lane = [0.0; LANES];

impl Scratch {
    #[inline(always)]
    fn new() -> Self {
        Self {
            trial: [ZERO; 6],
            mises: ZERO,
            mean: ZERO,
            strain: [ZERO; 6],
            frame: [ZERO; 9],
            b: [ZERO; 18],
            warp: [ZERO; 12],
            q: [ZERO; 12],
            rate: [ZERO; 12],
            volume: ZERO,
            distortion: ZERO,
            ratio: [1.0; LANES],
            tangent: [1.0; LANES],
        }
    }
}

/// Updates a block and writes the internal nodal forces; returns the largest squared frequency bound of each
/// element \[1/s²\], zero for elements that do not act.
///
/// `x` are the positions at n+1, `du` the displacement increment from n to n+1, both `[3 * node + direction]`.
pub fn update_block(
    x: &BlockForce,
    du: &BlockForce,
    material: &BlockMaterial,
    table: &HardeningTable,
    state: &mut BlockState,
    force: &mut BlockForce,
    step: KernelStep,
) -> Lane {
    update_block_in(Isa::best(), x, du, material, table, state, force, step)
}

for_each_isa! {
    /// [`update_block`] in the code of an instruction set; the same bytes.
    pub fn update_block_in = update_any(
        x: &BlockForce,
        du: &BlockForce,
        material: &BlockMaterial,
        table: &HardeningTable,
        state: &mut BlockState,
        force: &mut BlockForce,
        step: KernelStep,
    ) -> Lane
}

/// The kernel of any form.
#[inline(always)]
fn update_any(
    x: &BlockForce,
    du: &BlockForce,
    material: &BlockMaterial,
    table: &HardeningTable,
    state: &mut BlockState,
    force: &mut BlockForce,
    step: KernelStep,
) -> Lane {
    if material.form == ElementForm::OnePoint(Hourglass::Asqbi) {
        update::<true>(x, du, 1.0, material, table, state, force, step)
    } else {
        update::<false>(x, du, 1.0, material, table, state, force, step)
    }
}

for_each_isa! {
    /// The kernel of the forms other than ASQBI in the code of an instruction set, out of the way of the usual one.
    pub(super) fn update_other_in = update_other(
        x: &BlockForce,
        v: &BlockForce,
        factor: f64,
        material: &BlockMaterial,
        table: &HardeningTable,
        state: &mut BlockState,
        force: &mut BlockForce,
        step: KernelStep,
    ) -> Lane
}

/// The kernel of the forms other than ASQBI.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "a hot loop on plain arrays")]
fn update_other(
    x: &BlockForce,
    v: &BlockForce,
    factor: f64,
    material: &BlockMaterial,
    table: &HardeningTable,
    state: &mut BlockState,
    force: &mut BlockForce,
    step: KernelStep,
) -> Lane {
    update::<false>(x, v, factor, material, table, state, force, step)
}

/// The kernel, to be inlined where the instruction set is known. The displacement increment is `factor * v`.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "a hot loop on plain arrays")]
pub(super) fn update<const ASQBI: bool>(
    x: &BlockForce,
    v: &BlockForce,
    factor: f64,
    material: &BlockMaterial,
    table: &HardeningTable,
    state: &mut BlockState,
    force: &mut BlockForce,
    step: KernelStep,
) -> Lane {
    let mut s = Scratch::new();
    let rate_1_s = step.rate_1_s();
    let control = Control::of(material.form, rate_1_s);
    for l in 0..LANES {
        deform::<ASQBI>(l, x, v, factor, &control, material, state, &mut s);
    }
    radial_return(material, table, state, &mut s, rate_1_s);
    let mut bound = ZERO;
    for l in 0..LANES {
        resist::<ASQBI>(l, rate_1_s, &control, material, &s, state, force, &mut bound);
    }
    bound
}

/// The first half of the kernel for a law of its own at the centre; with it the Mises stress that the trial hourglass stresses
/// stand for \[Pa\]. Then `trial` becomes the stress, `tangent` the share of the elastic stiffness left to the hourglass strains, and what the law takes
/// from the hourglass stresses is taken from the state before [`resist_lanes`].
#[inline(always)]
pub(super) fn deform_lanes(
    x: &BlockForce,
    v: &BlockForce,
    factor: f64,
    material: &BlockMaterial,
    state: &BlockState,
    step: KernelStep,
) -> (Scratch, Lane) {
    let mut s = Scratch::new();
    let control = Control::of(material.form, step.rate_1_s());
    for l in 0..LANES {
        deform::<true>(l, x, v, factor, &control, material, state, &mut s);
    }
    let mut bent = ZERO;
    for l in 0..LANES {
        let centre = mises(&s.trial, l);
        let square = s.mises[l] * s.mises[l] - centre * centre;
        bent[l] = if square > 0.0 { square.sqrt() } else { 0.0 };
    }
    (s, bent)
}

/// The second half.
#[inline(always)]
pub(super) fn resist_lanes(
    s: &Scratch,
    material: &BlockMaterial,
    state: &mut BlockState,
    force: &mut BlockForce,
    step: KernelStep,
) -> Lane {
    let control = Control::of(material.form, step.rate_1_s());
    let mut bound = ZERO;
    for l in 0..LANES {
        resist::<true>(l, step.rate_1_s(), &control, material, s, state, force, &mut bound);
    }
    bound
}

/// Von Mises stress of a lane.
#[inline(always)]
fn mises(t: &[Lane; 6], l: usize) -> f64 {
    let (a, b, c) = (t[0][l] - t[1][l], t[1][l] - t[2][l], t[2][l] - t[0][l]);
    let shear = t[3][l] * t[3][l] + t[4][l] * t[4][l] + t[5][l] * t[5][l];
    (0.5 * (a * a + b * b + c * c) + 3.0 * shear).sqrt()
}

/// Positions and displacement increments to strain increments and trial stress.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "a hot loop on plain arrays")]
fn deform<const ASQBI: bool>(
    l: usize,
    x: &BlockForce,
    v: &BlockForce,
    factor: f64,
    control: &Control,
    material: &BlockMaterial,
    state: &BlockState,
    s: &mut Scratch,
) {
    let acts = state.share[l] > 0.0;
    let at = patterns(x, l);
    let (e, volume) = gradient(&at);
    let inverse = if acts { (1.0 / 64.0) / volume } else { 0.0 };
    let factor = if acts { factor } else { 0.0 };
    let rows = frame(at[0], at[1]);
    let mut edge = [0.0; 3];
    for i in 0..3 {
        edge[i] = dot(rows[i], at[i]);
        for j in 0..3 {
            s.frame[3 * i + j][l] = rows[i][j];
        }
    }
    s.volume[l] = volume;
    // L_ij = Σ_k U_ki b_kj, stored by rows i
    let moved = patterns(v, l);
    let mut g = [[0.0; 3]; 3];
    for k in 0..6 {
        let b = scale(inverse, e[k]);
        let u = scale(factor, moved[k]);
        for i in 0..3 {
            s.b[3 * k + i][l] = b[i];
            g[i] = add(g[i], scale(u[i], b));
        }
    }
    let unit = 1.0 / hourglass::divisor(edge[0] * edge[1] * edge[2], volume);
    let per_edge = [unit * edge[1] * edge[2], unit * edge[2] * edge[0], unit * edge[0] * edge[1]];
    let mut distortion = 0.0;
    for m in 0..4 {
        let warp = at[3 + m];
        let turned = to_local(&rows, warp);
        for i in 0..3 {
            let share = turned[i] * per_edge[i];
            distortion += share * share;
        }
        let global = [
            0.125 * (factor * moved[3 + m][0] - dot(g[0], warp)),
            0.125 * (factor * moved[3 + m][1] - dot(g[1], warp)),
            0.125 * (factor * moved[3 + m][2] - dot(g[2], warp)),
        ];
        let local = to_local(&rows, global);
        for i in 0..3 {
            s.warp[3 * m + i][l] = warp[i];
            s.q[3 * m + i][l] = local[i];
        }
    }
    s.distortion[l] = distortion;
    let strain = turned_strain(&g, &rows);
    let (lambda, two_mu) = (material.lambda_pa[l], 2.0 * material.mu_pa[l]);
    let mut brick =
        Brick { edge, volume, gradient: 0.0, mass: material.mass_kg[l], lambda, mu: material.mu_pa[l] };
    let extra = if ASQBI {
        hourglass::asqbi(l, &brick, state, s)
    } else {
        for b in &e {
            brick.gradient += 8.0 * inverse * inverse * dot(*b, *b);
        }
        hourglass::general(l, control, &brick, state, s)
    };
    let volumetric = lambda * (strain[0] + strain[1] + strain[2]);
    let mut t = [0.0; 6];
    for i in 0..3 {
        t[i] = state.stress[i][l] + (volumetric + two_mu * strain[i]);
        t[i + 3] = state.stress[i + 3][l] + two_mu * strain[i + 3];
    }
    for i in 0..6 {
        s.strain[i][l] = if acts { strain[i] } else { 0.0 };
        s.trial[i][l] = if acts { t[i] } else { 0.0 };
    }
    let (a, b, c) = (t[0] - t[1], t[1] - t[2], t[2] - t[0]);
    let shear = t[3] * t[3] + t[4] * t[4] + t[5] * t[5];
    let mises = (0.5 * (a * a + b * b + c * c) + 3.0 * shear + extra).sqrt();
    s.mises[l] = if acts { mises } else { 0.0 };
    s.mean[l] = (t[0] + t[1] + t[2]) * (1.0 / 3.0);
}

/// Pattern sums of a nodal vector field of one lane.
#[inline(always)]
pub(super) fn patterns(field: &BlockForce, l: usize) -> [V3; 7] {
    let mut out = [[0.0; 3]; 7];
    for i in 0..3 {
        let mut nodal = [0.0; 8];
        for node in 0..8 {
            nodal[node] = field[3 * node + i][l];
        }
        let sums = to_patterns(nodal);
        for k in 0..7 {
            out[k][i] = sums[k];
        }
    }
    out
}

/// Symmetric part of `L (I - L/2)^-1`, turned into the frame: xx, yy, zz, xy, yz, zx.
#[inline(always)]
pub(super) fn turned_strain(g: &[V3; 3], rows: &[V3; 3]) -> [f64; 6] {
    let m = [
        [1.0 - 0.5 * g[0][0], -0.5 * g[0][1], -0.5 * g[0][2]],
        [-0.5 * g[1][0], 1.0 - 0.5 * g[1][1], -0.5 * g[1][2]],
        [-0.5 * g[2][0], -0.5 * g[2][1], 1.0 - 0.5 * g[2][2]],
    ];
    let columns = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
    let inverse = 1.0 / dot(m[0], columns[0]);
    let mut mid = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            mid[i][j] = inverse * dot(g[i], columns[j]);
        }
    }
    let (xy, yz, zx) =
        (0.5 * (mid[0][1] + mid[1][0]), 0.5 * (mid[1][2] + mid[2][1]), 0.5 * (mid[0][2] + mid[2][0]));
    let d = [[mid[0][0], xy, zx], [xy, mid[1][1], yz], [zx, yz, mid[2][2]]];
    let (t0, t1, t2) = (to_local(&d, rows[0]), to_local(&d, rows[1]), to_local(&d, rows[2]));
    [
        dot(t0, rows[0]),
        dot(t1, rows[1]),
        dot(t2, rows[2]),
        dot(t0, rows[1]),
        dot(t1, rows[2]),
        dot(t2, rows[0]),
    ]
}

/// Radial return of the lanes that exceed their yield stress: factor on the deviator, share of the elastic
/// stiffness left to the hourglass strains.
#[inline(always)]
fn radial_return(
    material: &BlockMaterial,
    table: &HardeningTable,
    state: &mut BlockState,
    s: &mut Scratch,
    rate_1_s: f64,
) {
    let lowest = table.lowest_stress_pa();
    let mut yields = 0;
    for l in 0..LANES {
        yields += u64::from(s.mises[l] > lowest * material.yield_scale[l]);
    }
    if yields == 0 {
        return;
    }
    let (mut increment, mut slope) = (ZERO, ZERO);
    table.plastic_increments(
        &s.mises,
        &state.plastic_strain,
        &material.mu_pa,
        &material.yield_scale,
        &mut increment,
        &mut slope,
    );
    if table.has_rate() && rate_1_s > 0.0 {
        for l in 0..LANES {
            if increment[l] > 0.0 {
                let trial = [s.mises[l], state.plastic_strain[l]];
                let (mu, scale) = (material.mu_pa[l], material.yield_scale[l]);
                (increment[l], slope[l]) =
                    table.with_rate_factor(trial, mu, scale, 1.0 / rate_1_s, increment[l]);
            }
        }
    }
    for l in 0..LANES {
        let three_g = 3.0 * material.mu_pa[l];
        let flows = increment[l] > 0.0;
        let left = slope[l] / (three_g + slope[l]);
        let left = if left > HOURGLASS_FLOOR { left } else { HOURGLASS_FLOOR };
        state.plastic_strain[l] += increment[l];
        s.ratio[l] = if flows { 1.0 - three_g * increment[l] / s.mises[l] } else { 1.0 };
        s.tangent[l] = if flows { left } else { 1.0 };
    }
}
