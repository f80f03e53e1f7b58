//! Bends a reinforced member end: axial force first, then the free end is pushed sideways.
//!
//! The moment is that of the stress resultants in the end section, from the reactions of the clamped base: it contains the second-order
//! moment, so it is what the section bears; a hinge gets its P-Δ from the geometry of the model it is used in. Rotation is that of the chord. Quasi-static by explicit
//! integration: the ratio of kinetic to internal energy is recorded.

use super::gauge::{EndStrains, Gauge};
use super::member::{Joint, RcMember};
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use nalgebra::{Matrix3, Vector3};

/// Time over which the axial force is applied, and in which it comes to rest \[s\].
const AXIAL_S: [f64; 2] = [0.02, 0.02];
/// Damping while it is \[1/s\].
const AXIAL_DAMPING_1_S: f64 = 1500.0;
/// Time over which the push speeds up \[s\].
const RAMP_S: f64 = 0.05;
/// Speed of the chord \[rad/s\].
const SPEED_RAD_S: f64 = 0.15;
/// Damping while pushed \[1/s\].
const PUSH_DAMPING_1_S: f64 = 20.0;
/// Share of its peak at which a section has failed.
pub const FAILED_SHARE: f64 = 0.2;
/// Interval of rotation over which forces are averaged, at the start and at most \[rad\].
const SAMPLE_RAD: [f64; 2] = [5e-5, 5e-4];

/// How a member end is bent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// Axial force, compression positive \[N\].
    pub axial_n: f64,
    /// Direction in which the free end is pushed: 0 along x, 90 along y \[deg\].
    pub direction_deg: f64,
    /// Rotation at which to stop \[rad\].
    pub until_rad: f64,
}

/// A bent member end.
#[derive(Debug, Clone, PartialEq)]
pub struct Bent {
    /// `[chord rotation (rad), moment (N m), shortening (m)]`, from the axially loaded state.
    pub points: Vec<[f64; 3]>,
    /// Strains at each point.
    pub strains: Vec<EndStrains>,
    /// Largest kinetic over internal energy beyond a tenth of the peak rotation.
    pub kinetic_share: f64,
    /// Time steps.
    pub steps: u64,
    /// Whether the moment fell below [`FAILED_SHARE`] of its peak.
    pub failed: bool,
}

/// A run that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BendError {
    /// The section does not bear its axial force.
    #[error(
        "the member does not bear N = {axial_n:.0} N: it shortened by {shortening_m:.4} m; use a smaller axial force"
    )]
    Crushed {
        /// Axial force \[N\].
        axial_n: f64,
        /// Shortening \[m\].
        shortening_m: f64,
    },
    /// Numbers that are not finite.
    #[error("not finite at a rotation of {rotation_rad:.4} rad")]
    NotFinite {
        /// Rotation \[rad\].
        rotation_rad: f64,
    },
}

/// Shortening over length at which the axial force counts as not borne.
const CRUSHED_STRAIN: f64 = 0.01;

struct Run<'a> {
    member: &'a RcMember,
    body: Dynamics,
    direction: [f64; 2],
    rest_m: f64,
    /// How a plane of symmetry is held.
    spread: Option<Spread>,
}

/// A section on a plane of symmetry: no displacement along the member; across it, it spreads by `a_1 x + a_2 x² + a_3 x y` along x and
/// `b_1 y + b_2 y² + b_3 x y` along y, and nothing else. Single nodes must not yield to the shear force, which the cracked part of the section could not
/// take up.
struct Spread {
    nodes: Vec<usize>,
    shares: Vec<f64>,
    /// Patterns of each node by axis.
    patterns: [Vec<Vector3<f64>>; 2],
    /// Inverse of `Σ share p pᵀ` by axis.
    inverse: [Matrix3<f64>; 2],
}

impl Spread {
    fn of(member: &RcMember) -> Self {
        let (nodes, shares): (Vec<usize>, Vec<f64>) = member.base.iter().copied().unzip();
        let half = (0..3).map(|i| nodes.iter().map(|n| member.mesh.nodes[*n][i].abs()).fold(0.0, f64::max));
        let half: Vec<f64> = half.collect();
        let patterns = [0, 1].map(|axis: usize| {
            let of = |n: &usize| {
                let x = member.mesh.nodes[*n];
                let (a, b) = (x[axis] / half[axis], x[1 - axis] / half[1 - axis]);
                Vector3::new(a, a * a, a * b)
            };
            nodes.iter().map(of).collect::<Vec<_>>()
        });
        let inverse = [0, 1].map(|axis: usize| {
            let sum: Matrix3<f64> =
                patterns[axis].iter().zip(&shares).map(|(p, s)| p * p.transpose() * *s).sum();
            sum.try_inverse().unwrap_or_else(Matrix3::zeros)
        });
        Self { nodes, shares, patterns, inverse }
    }

    /// Takes the last step's motion of the section to the nearest one that it can have.
    fn hold(&self, body: &mut Dynamics) {
        for axis in 0..3 {
            let parts = || self.nodes.iter().zip(&self.shares).enumerate();
            let amplitudes = (axis < 2).then(|| {
                let sum: Vector3<f64> =
                    parts().map(|(i, (n, s))| self.patterns[axis][i] * (s * body.v[*n][axis])).sum();
                self.inverse[axis] * sum
            });
            for (i, n) in self.nodes.iter().enumerate() {
                let held = amplitudes.map_or(0.0, |a| a.dot(&self.patterns[axis][i]));
                body.x[*n][axis] += body.taken_s * (held - body.v[*n][axis]);
                body.v[*n][axis] = held;
            }
        }
    }
}

/// Bends a member end. `parallel`: use the rayon pool. `progress` is told the rotation reached \[rad\].
pub fn bend(
    member: &RcMember,
    bend: &Bend,
    parallel: bool,
    progress: &dyn Fn(f64),
) -> Result<Bent, BendError> {
    let angle = bend.direction_deg.to_radians();
    let mut run = Run {
        member,
        body: Dynamics::new(&member.mesh, 0.0, RigidSurfaces::default(), parallel),
        direction: [angle.cos(), angle.sin()],
        rest_m: 0.0,
        spread: (member.joint == Joint::Symmetry).then(|| Spread::of(member)),
    };
    run.load(bend.axial_n)?;
    run.push(bend, progress)
}

impl Run<'_> {
    /// One step, with the end section held by its joint.
    fn step(&mut self) {
        self.body.step(false);
        if let Some(spread) = &self.spread {
            spread.hold(&mut self.body);
        }
    }

    /// Applies the axial force.
    fn load(&mut self, axial_n: f64) -> Result<(), BendError> {
        let start = self.height_m();
        self.body.damping_1_s = AXIAL_DAMPING_1_S;
        while self.body.time_s < AXIAL_S[0] + AXIAL_S[1] {
            let s = (self.body.time_s / AXIAL_S[0]).min(1.0);
            let force = -axial_n * s * s * (3.0 - 2.0 * s);
            for (n, share) in &self.member.tip {
                self.body.applied_n[*n] = [0.0, 0.0, force * share];
            }
            self.step();
        }
        let shortening_m = start - self.height_m();
        if shortening_m.is_nan() || shortening_m > CRUSHED_STRAIN * self.member.length_m {
            return Err(BendError::Crushed { axial_n, shortening_m });
        }
        self.rest_m = self.height_m();
        Ok(())
    }

    fn push(&mut self, bend: &Bend, progress: &dyn Fn(f64)) -> Result<Bent, BendError> {
        self.body.damping_1_s = PUSH_DAMPING_1_S;
        let from = self.body.time_s;
        let mut gauge = Gauge::of(self.member, self.direction);
        gauge.take(&self.body);
        let mut bent = Bent {
            points: vec![[0.0; 3]],
            strains: vec![gauge.read()],
            kinetic_share: 0.0,
            steps: 0,
            failed: false,
        };
        let (mut sum, mut count, mut since, mut peak) = ([0.0; 3], 0.0, 0.0, 0.0f64);
        loop {
            let ramp = ((self.body.time_s - from) / RAMP_S).min(1.0);
            let speed = SPEED_RAD_S * ramp * self.member.length_m;
            for (n, _) in &self.member.tip {
                let held = &mut self.body.prescribed_m_s[*n];
                held[0] = Some(speed * self.direction[0]);
                held[1] = Some(speed * self.direction[1]);
            }
            self.step();
            if !self.body.steps.is_multiple_of(4) {
                continue;
            }
            let rotation = self.rotation_rad();
            let moment = self.moment_nm();
            for (s, v) in sum.iter_mut().zip([rotation, moment, self.rest_m - self.height_m()]) {
                *s += v;
            }
            count += 1.0;
            gauge.take(&self.body);
            let interval = (SAMPLE_RAD[0] + 0.05 * rotation).min(SAMPLE_RAD[1]);
            if rotation - since < interval {
                continue;
            }
            let point = sum.map(|s| s / count);
            (sum, count, since) = ([0.0; 3], 0.0, rotation);
            if point.iter().any(|v| !v.is_finite()) || self.body.broken_node().is_some() {
                return Err(BendError::NotFinite { rotation_rad: rotation });
            }
            bent.points.push(point);
            bent.strains.push(gauge.read());
            progress(rotation);
            peak = peak.max(point[1]);
            if rotation > 2e-3 && point[1] > 0.8 * peak {
                let internal = self.body.blocks.energies_j()[0] + self.body.trusses.internal_j();
                bent.kinetic_share = bent.kinetic_share.max(self.body.kinetic_j() / internal.max(1.0));
            }
            bent.failed = point[1] < FAILED_SHARE * peak;
            if bent.failed || rotation >= bend.until_rad {
                bent.steps = self.body.steps;
                return Ok(bent);
            }
        }
    }

    /// Mean of a coordinate over the free end \[m\].
    fn tip_m(&self, axis: usize) -> f64 {
        self.member.tip.iter().map(|(n, share)| share * self.body.x[*n][axis]).sum()
    }

    fn height_m(&self) -> f64 {
        self.tip_m(2)
    }

    /// Displacement of the free end along the push over the length.
    fn rotation_rad(&self) -> f64 {
        let moved = self.direction[0] * self.tip_m(0) + self.direction[1] * self.tip_m(1);
        moved / self.member.length_m
    }

    /// Moment of the stress resultants in the end section about the axis across the push \[N m\].
    fn moment_nm(&self) -> f64 {
        let [c, s] = self.direction;
        let (mut moment, mut shear) = (0.0, 0.0);
        for (n, _) in &self.member.base {
            let mut force = self.body.internal_n(*n);
            if let Some(other) = self.body.other_n.get(*n) {
                (0..3).for_each(|i| force[i] -= other[i]); // elements: what they bear; bars: what they do to the node
            }
            let x = self.body.x[*n];
            moment += (c * x[0] + s * x[1]) * force[2];
            shear += c * force[0] + s * force[1];
        }
        moment.abs() - self.member.block_m * shear.abs()
    }
}
