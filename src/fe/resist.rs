//! The second half of the one-point hexahedron, after the return to the yield surface: what an element's stress resists with at its nodes ([`super::kernel`]).

use super::hexahedron::{to_global, to_nodes};
use super::hourglass::{self, Control};
use super::kernel::{BlockForce, BlockMaterial, BlockState, Lane, Scratch};
use super::limit::{bulk_viscosity, frequency_bound};
use crate::base::vector::{add, dot, scale};

/// Final stress, viscosity, hourglass stress, work, nodal forces and frequency bound.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "a hot loop on plain arrays")]
pub(super) fn resist<const ASQBI: bool>(
    l: usize,
    rate_1_s: f64,
    control: &Control,
    material: &BlockMaterial,
    s: &Scratch,
    state: &mut BlockState,
    force: &mut BlockForce,
    bound: &mut Lane,
) {
    let share = state.share[l];
    let acts = share > 0.0;
    let (lambda, mu, volume) = (material.lambda_pa[l], material.mu_pa[l], s.volume[l]);
    let (stress, power) = final_stress(l, s, state);
    let trace = s.strain[0][l] + s.strain[1][l] + s.strain[2][l];
    let mut g = [0.0; 6];
    for k in 0..6 {
        let b = [s.b[3 * k][l], s.b[3 * k + 1][l], s.b[3 * k + 2][l]];
        for i in 0..3 {
            g[i] += b[i] * b[i];
            g[i + 3] += b[i] * b[(i + 1) % 3];
        }
    }
    let inverse_mass = 1.0 / material.mass_kg[l];
    let limit = frequency_bound(&g, volume * inverse_mass, lambda, mu, s.distortion[l]);
    let limit = if ASQBI { limit } else { control.bound * limit };
    let (pressure, damped) =
        bulk_viscosity(rate_1_s * trace, volume, material.mass_kg[l], lambda + 2.0 * mu, limit);
    let acting = if acts { volume * share } else { 0.0 };
    state.internal_j[l] += acting * power;
    // the force of this step acts over half of the next increment too: only the mean of two steps books its true work
    state.viscous_j[l] += acting * 0.5 * (state.viscous_pa[l] + pressure) * trace;
    state.viscous_pa[l] = pressure;
    let hourglass = final_hourglass::<ASQBI>(l, control, s, state);
    // S_ij by rows
    let local = [
        [stress[0] + pressure, stress[3], stress[5]],
        [stress[3], stress[1] + pressure, stress[4]],
        [stress[5], stress[4], stress[2] + pressure],
    ];
    nodal_forces(l, s, (&local, acting), (&hourglass, share), force);
    bound[l] = if acts { damped * limit } else { 0.0 };
}

/// Stress at the end of the step \[Pa\], and its work in the step over the volume \[J/m³\].
#[inline(always)]
fn final_stress(l: usize, s: &Scratch, state: &mut BlockState) -> ([f64; 6], f64) {
    const WEIGHT: [f64; 6] = [0.5, 0.5, 0.5, 1.0, 1.0, 1.0];
    let acts = state.share[l] > 0.0;
    let mut stress = [0.0; 6];
    let mut power = 0.0;
    for i in 0..6 {
        let mean = if i < 3 { s.mean[l] } else { 0.0 };
        let old = state.stress[i][l];
        let returned = mean + s.ratio[l] * (s.trial[i][l] - mean);
        let new = if s.ratio[l] < 1.0 { returned } else { s.trial[i][l] };
        stress[i] = if acts { new } else { old };
        power += WEIGHT[i] * (old + stress[i]) * s.strain[i][l];
        state.stress[i][l] = stress[i];
    }
    (stress, power)
}

/// Generalised stresses against hourglass patterns at the end of the step, whose work is booked.
#[inline(always)]
fn final_hourglass<const ASQBI: bool>(
    l: usize,
    control: &Control,
    s: &Scratch,
    state: &mut BlockState,
) -> [f64; 12] {
    let acts = state.share[l] > 0.0;
    let mut hourglass = [0.0; 12];
    let mut power = 0.0;
    for i in 0..12 {
        let before = state.hourglass[i][l];
        let after = if ASQBI {
            s.ratio[l] * (before + s.tangent[l] * s.rate[i][l])
        } else {
            hourglass::returned(control, before, s.rate[i][l], s.ratio[l], s.tangent[l])
        };
        hourglass[i] = if acts { after } else { before };
        power += 0.5 * (before + after) * s.q[i][l];
        state.hourglass[i][l] = hourglass[i];
    }
    state.hourglass_j[l] += if acts { state.share[l] * power } else { 0.0 };
    hourglass
}

/// Nodal forces of a stress in the element's frame, over the volume that acts, and of its hourglass stresses, by way of the coefficients of patterns.
#[inline(always)]
fn nodal_forces(
    l: usize,
    s: &Scratch,
    (stress, acting): (&[[f64; 3]; 3], f64),
    (hourglass, share): (&[f64; 12], f64),
    force: &mut BlockForce,
) {
    let mut rows = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            rows[i][j] = s.frame[3 * i + j][l];
        }
    }
    let half = [to_global(&rows, stress[0]), to_global(&rows, stress[1]), to_global(&rows, stress[2])];
    let mut total = [[0.0; 3]; 3];
    for i in 0..3 {
        total[i] = scale(acting, to_global(&half, [rows[0][i], rows[1][i], rows[2][i]]));
    }
    let mut coefficient = [[0.0; 7]; 3];
    for m in 0..4 {
        let q = to_global(&rows, [hourglass[3 * m], hourglass[3 * m + 1], hourglass[3 * m + 2]]);
        let q = scale(0.125 * share, q);
        let warp = [s.warp[3 * m][l], s.warp[3 * m + 1][l], s.warp[3 * m + 2][l]];
        for i in 0..3 {
            coefficient[i][3 + m] = q[i];
            total[i] = add(total[i], scale(-q[i], warp));
        }
    }
    for k in 0..6 {
        let b = [s.b[3 * k][l], s.b[3 * k + 1][l], s.b[3 * k + 2][l]];
        for i in 0..3 {
            coefficient[i][k] += dot(total[i], b);
        }
    }
    for i in 0..3 {
        for k in 0..7 {
            coefficient[i][k] = if share > 0.0 { coefficient[i][k] } else { 0.0 };
        }
        let nodal = to_nodes(coefficient[i]);
        for node in 0..8 {
            force[3 * node + i][l] = nodal[node];
        }
    }
}
