//! What limits the time step of an element: the bound of its frequencies, and its bulk viscosity.

/// Linear bulk viscosity coefficient (usual value of explicit codes).
pub const BULK_LINEAR: f64 = 0.06;
/// Quadratic bulk viscosity coefficient, compression only.
pub const BULK_QUADRATIC: f64 = 1.5;
/// Damping ratio of the quadratic term beyond which it shortens the time step: up to here a step of 0.9 of the limit without it is
/// within the limit with it. Reached when an element closes with 2.2 % of its wave speed (60 m/s in concrete).
pub const VISCOUS_SLACK: f64 = 0.1;
/// Factor on the distortion of an element in its frequency bound, and the most that it adds: see [`frequency_bound`].
const DISTORTION: f64 = 0.9;
const MOST_DISTORTION: f64 = 1.0 / 3.0;

/// Bulk viscosity pressure \[Pa\] (negative: compression) from the rate of volume strain, von Neumann and Richtmyer
/// (1950) with a linear term; none in an element that has lost its volume.
///
/// Its length is `2 c / ω` with the frequency bound `limit = ω²`: a flat element is then damped by the same ratio as a cube. With
/// the cube root of the volume the ratio grows with flatness, and the time step that [`BULK_LINEAR`] allows is unstable.
///
/// Also returns a factor on `limit` by which the quadratic term enters the time step, which knows the linear one only. The slope of the
/// pressure over the rate D adds `δ = 2 Q² l |D| / c` to the damping ratio ξ, and `sqrt(1 + ξ²) + ξ` grows by less than `1 + δ + δ²/2`. The
/// safety of the step covers δ up to [`VISCOUS_SLACK`]; the rest shortens it.
#[inline(always)]
pub(super) fn bulk_viscosity(
    rate_1_s: f64,
    volume: f64,
    mass: f64,
    modulus_pa: f64,
    limit: f64,
) -> (f64, f64) {
    let valid = volume > f64::MIN_POSITIVE && limit > 0.0;
    let (safe, limit) = if valid { (volume, limit) } else { (1.0, 1.0) };
    let density = mass / safe;
    let speed = (modulus_pa / density).sqrt();
    let length = 2.0 * speed / limit.sqrt();
    let compression = if rate_1_s < 0.0 { -rate_1_s } else { 0.0 };
    let quadratic = BULK_QUADRATIC * BULK_QUADRATIC * length * compression;
    let pressure = density * length * rate_1_s * (BULK_LINEAR * speed + quadratic);
    let more = 2.0 * quadratic / speed - VISCOUS_SLACK;
    let growth = if more > 0.0 { 1.0 + more * (1.0 + 0.5 * more) } else { 1.0 };
    if valid { (pressure, growth * growth) } else { (0.0, 1.0) }
}

/// Upper bound of the element's largest squared frequency. Of its mean stress: with `G_ij = b_iI b_jI`,
/// `ω² <= (8 V / m) (λ tr G + 2 μ λ_max(G))`. `λ_max` starts from the largest row sum (Gershgorin) and takes two steps of Newton on the characteristic
/// polynomial: from above the largest root they stay above it. `g` is `G / 8`: xx, yy, zz, xy, yz, zx.
///
/// The hourglass stiffness alone has at most a third of that. In a parallelepiped both act on orthogonal nodal
/// patterns, and the larger counts. In a distorted element they do not: the bound grows by [`DISTORTION`] times the
/// distortion w, to at most [`MOST_DISTORTION`]. Tapered bricks need w / 2, the worst of 12,000 random shapes 0.89 w (`docs/fe-time-step.md`).
#[inline(always)]
pub(super) fn frequency_bound(
    g: &[f64; 6],
    specific_volume: f64,
    lambda: f64,
    mu: f64,
    distortion: f64,
) -> f64 {
    let (xy, yz, zx) = (g[3].abs(), g[4].abs(), g[5].abs());
    let (r0, r1, r2) = (g[0] + xy + zx, g[1] + xy + yz, g[2] + yz + zx);
    let r01 = if r0 > r1 { r0 } else { r1 };
    let mut largest = if r01 > r2 { r01 } else { r2 };
    let trace = g[0] + g[1] + g[2];
    let minors = (g[0] * g[1] - xy * xy) + (g[1] * g[2] - yz * yz) + (g[2] * g[0] - zx * zx);
    let determinant = g[0] * (g[1] * g[2] - yz * yz) - g[3] * (g[3] * g[2] - g[4] * g[5])
        + g[5] * (g[3] * g[4] - g[1] * g[5]);
    for _ in 0..2 {
        let value = ((largest - trace) * largest + minors) * largest - determinant;
        let slope = (3.0 * largest - 2.0 * trace) * largest + minors;
        // near a double root neither is known well enough: stay
        let known = slope > 1e-3 * largest * largest;
        let step = value / if known { slope } else { 1.0 };
        largest -= if known && step > 0.0 { step } else { 0.0 };
    }
    // with a negative one (ν < 0) less is stored than by μ alone
    let lambda = if lambda > 0.0 { lambda } else { 0.0 };
    let more = DISTORTION * distortion;
    let more = if more < MOST_DISTORTION { more } else { MOST_DISTORTION };
    64.0 * specific_volume * (1.0 + more) * (lambda * trace + 2.0 * mu * largest)
}
