//! Bends a reinforced member end: axial force first, then the free end is pushed sideways, once or to and fro.
//!
//! The moment is that of the stress resultants in the end section, from the reactions of the clamped base: it contains the second-order
//! moment, so it is what the section bears; a hinge gets its P-Δ from the geometry of the model it is used in. Rotation is that of the chord. Quasi-static by explicit
//! integration: the ratio of kinetic energy (without that of the member's turn as a whole) to internal energy and the energy balance are recorded, and a
//! run whose balance is off is refused.

use super::anchorage::Anchored;
use super::bar_bending::BarBending;
use super::cover::Cover;
use super::drive::{ENERGY_LIMIT, Energies, EnergyWatch, Means, Path, SPEED_RAD_S};
use super::events::{Event, Watch};
use super::gauge::{EndStrains, Gauge};
use super::member::{Joint, RcMember};
use super::symmetry::Plane;
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use serde::Serialize;

/// Time over which the axial force is applied, and in which it comes to rest \[s\].
const AXIAL_S: [f64; 2] = [0.02, 0.02];
/// Damping while it is \[1/s\].
const AXIAL_DAMPING_1_S: f64 = 1500.0;
/// Damping while pushed \[1/s\].
const PUSH_DAMPING_1_S: f64 = 20.0;
/// Share of its peak at which a section has failed.
pub const FAILED_SHARE: f64 = 0.2;
/// Interval of rotation over which forces are averaged, at the start and at most \[rad\].
const SAMPLE_RAD: [f64; 2] = [5e-5, 5e-4];
/// Steps between two looks at forces and motion.
const LOOK_STEPS: u64 = 4;
/// Shortening over length at which the axial force counts as not borne; of a bent member without the part that a straight chord has from turning.
pub const CRUSHED_STRAIN: f64 = 0.01;
/// Elongation over length at which a pulled member counts as torn; opening cracks make a third of it.
const TORN_STRAIN: f64 = 0.05;
/// Least rotation from which on a moment can be lost \[rad\], see [`bears_from_rad`].
const BEARS_FROM_RAD: f64 = 1e-3;
/// Squared length over depth \[m\] up to which it is that.
const STOCKY_M: f64 = 50.0;
/// Rotation from which on the kinetic energy counts, over that from which on a moment can be lost.
const KINETIC_FROM: f64 = 2.0;

/// How a member end is bent.
#[derive(Debug, Clone, PartialEq)]
pub struct Bend {
    /// Axial force, compression positive \[N\].
    pub axial_n: f64,
    /// Direction in which the free end is pushed: 0 along x, 90 along y \[deg\].
    pub direction_deg: f64,
    /// Turning points of the rotation, see [`Path::through`]; one alone is a monotonic push \[rad\].
    pub turns_rad: Vec<f64>,
    /// Share of the ordinary speed at which it is pushed.
    pub pace: f64,
}

impl Bend {
    /// A push in one sense up to a rotation \[rad\].
    pub fn monotonic(axial_n: f64, direction_deg: f64, until_rad: f64) -> Self {
        Self { axial_n, direction_deg, turns_rad: vec![until_rad], pace: 1.0 }
    }
}

/// What ended a bend.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Ending {
    /// The end of its path.
    Path,
    /// The moment fell below [`FAILED_SHARE`] of its peak, in every sense in which the member is bent.
    Moment,
    /// The member no longer bore its axial force.
    Axial {
        /// Rotation \[rad\].
        rotation_rad: f64,
        /// Shortening since the bending began \[m\].
        shortening_m: f64,
    },
}

impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Path => write!(f, "end of the path"),
            Self::Moment => write!(f, "moment below {:.0} % of its peak", 100.0 * FAILED_SHARE),
            Self::Axial { rotation_rad, shortening_m } => write!(
                f,
                "axial failure at drift {:.2} %: shortened by {:.1} mm",
                100.0 * rotation_rad,
                1e3 * shortening_m
            ),
        }
    }
}

/// A bent member end.
#[derive(Debug, Clone, PartialEq)]
pub struct Bent {
    /// `[chord rotation (rad), moment (N m), shortening (m)]`, from the axially loaded state.
    pub points: Vec<[f64; 3]>,
    /// Strains at each point.
    pub strains: Vec<EndStrains>,
    /// Index of the first point behind each turning point that was passed.
    pub turned_at: Vec<usize>,
    /// Largest kinetic energy beside that of a turn of the whole member over internal energy, beyond a rotation of 2 mrad (more of slender members); of a monotonic push as
    /// long as it bears 80 % of its peak.
    pub kinetic_share: f64,
    /// Energies at the end.
    pub energies: Energies,
    /// Time steps.
    pub steps: u64,
    /// What ended it.
    pub ending: Ending,
    /// Largest slip of a bar out of the joint at each point \[m\].
    pub slips_m: Vec<f64>,
    /// What happened to single bars and ties.
    pub events: Vec<Event>,
}

impl Bent {
    /// Whether it ended because the section had failed.
    pub fn failed(&self) -> bool {
        self.ending != Ending::Path
    }
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
    /// A member that is pulled came off.
    #[error(
        "the member is torn by N = {axial_n:.0} N: longer by {elongation_m:.3} m at a rotation of {rotation_rad:.4} rad; use a smaller tension"
    )]
    Torn {
        /// Axial force \[N\].
        axial_n: f64,
        /// Elongation \[m\].
        elongation_m: f64,
        /// Rotation \[rad\].
        rotation_rad: f64,
    },
    /// Energy came from nowhere or got lost.
    #[error(
        "the energy balance is off by {:.1} % of the internal energy at a rotation of {rotation_rad:.4} rad (limit {:.0} %); use other elements (--mesh)",
        100.0 * share,
        100.0 * ENERGY_LIMIT
    )]
    Energy {
        /// Residual over internal energy.
        share: f64,
        /// Rotation \[rad\].
        rotation_rad: f64,
    },
}

/// Rotation from which on a moment can be lost \[rad\]: before it a slender member still swings about rest by more than it bears. `speed_rad_s` is that of the chord.
///
/// While the chord speeds up by α and is damped (rate c), the mass of the member presses its end section back with `M = 7/120 ρ A (α + c ω) L³` (a load that
/// grows from the clamped end to the pushed one), and swings about that; a rotation θ bends it by `3 E I θ / L`. Both are equal at `θ ~ (L² / h)²`, in proportion to the speed. An
/// elastic beam with 0.35 of the stiffness of uncracked concrete bears less than 20 % of its peak up to 1.0, 6.9, 12 mrad at L² / h = 62, 160, 250 m.
fn bears_from_rad(length_m: f64, depth_m: f64, speed_rad_s: f64) -> f64 {
    let slender = length_m * length_m / (depth_m * STOCKY_M);
    BEARS_FROM_RAD * (slender * slender * speed_rad_s / SPEED_RAD_S).max(1.0)
}

struct Run<'a> {
    member: &'a RcMember,
    body: Dynamics,
    direction: [f64; 2],
    rest_m: f64,
    axial_n: f64,
    /// The end section, if it is a plane of symmetry.
    plane: Option<Plane>,
    /// Bars that slip.
    anchored: Anchored<'a>,
    /// Bars that their cover keeps straight.
    cover: Cover,
    bars: BarBending,
    energy: EnergyWatch,
}

/// Bends a member end. `parallel`: use the rayon pool. `progress` is told the share of the run's time that is done (0 to 1).
///
/// # Errors
/// If the member does not bear the axial force before it is bent, or the run cannot be used.
pub fn bend(
    member: &RcMember,
    bend: &Bend,
    parallel: bool,
    progress: &dyn Fn(f64),
) -> Result<Bent, BendError> {
    let angle = bend.direction_deg.to_radians();
    let mut body = Dynamics::new(&member.mesh, 0.0, RigidSurfaces::default(), parallel);
    let anchored = Anchored::of(member, &mut body);
    let cover = Cover::of(member, &mut body);
    let mass_kg = body.mass_kg.iter().sum();
    let mut run = Run {
        member,
        body,
        anchored,
        cover,
        bars: BarBending::of(member),
        direction: [libm::cos(angle), libm::sin(angle)],
        rest_m: 0.0,
        axial_n: bend.axial_n,
        plane: (member.joint == Joint::Symmetry).then(|| Plane::of(member)),
        energy: EnergyWatch::new(mass_kg),
    };
    if let Some(axis) = member.mirror {
        for n in &member.mirrored {
            run.body.prescribed_m_s[*n][axis] = Some(0.0);
        }
    }
    let path = Path::through(&bend.turns_rad, bend.pace);
    let whole_s = AXIAL_S[0] + AXIAL_S[1] + path.duration_s();
    let tell = |time_s: f64| progress((time_s / whole_s).min(0.999));
    run.load(bend.axial_n, &tell)?;
    run.push(&path, &tell)
}

impl Run<'_> {
    /// One step, with the end section held by its joint; every so many steps, the books of damping are kept and the answer is true.
    fn step(&mut self) -> bool {
        self.anchored.pull(&mut self.body);
        self.bars.push(&mut self.body);
        self.body.step(false);
        if let Some(plane) = &mut self.plane {
            self.energy.held_j += plane.hold(&mut self.body);
        }
        self.energy.held_j += self.anchored.hold(&mut self.body);
        self.bars.release(&mut self.body);
        let look = self.body.steps.is_multiple_of(LOOK_STEPS);
        if look {
            self.energy.damped(&self.body, LOOK_STEPS as f64);
            self.cover.look(&mut self.body);
        }
        look
    }

    /// Applies the axial force.
    fn load(&mut self, axial_n: f64, progress: &dyn Fn(f64)) -> Result<(), BendError> {
        let start = self.height_m();
        self.body.damping_1_s = AXIAL_DAMPING_1_S;
        while self.body.time_s < AXIAL_S[0] + AXIAL_S[1] {
            let s = (self.body.time_s / AXIAL_S[0]).min(1.0);
            let force = -axial_n * self.member.share * s * s * (3.0 - 2.0 * s);
            let nodes = if axial_n < 0.0 { &self.member.pulled } else { &self.member.tip };
            for (n, share) in nodes {
                self.body.applied_n[*n] = [0.0, 0.0, force * share];
            }
            if self.step() {
                let shortening_m = start - self.height_m();
                if shortening_m.is_nan() || shortening_m > CRUSHED_STRAIN * self.member.length_m {
                    return Err(BendError::Crushed { axial_n, shortening_m });
                }
                progress(self.body.time_s);
            }
        }
        self.rest_m = self.height_m();
        Ok(())
    }

    fn push(&mut self, path: &Path, progress: &dyn Fn(f64)) -> Result<Bent, BendError> {
        self.body.damping_1_s = PUSH_DAMPING_1_S;
        let from = self.body.time_s;
        let length_m = self.member.length_m;
        let bears_from_rad = bears_from_rad(length_m, self.depth_m(), path.speed_rad_s());
        let mut course = Course::new(path, length_m, bears_from_rad);
        let mut means = Means::<3>::default();
        let mut watch = Watch::of(self.member);
        let (mut events, mut slips_m) = (Vec::new(), vec![0.0]);
        let mut gauge = Gauge::of(self.member, self.direction);
        gauge.take(&self.body);
        let mut strains = vec![gauge.read()];
        let (mut next, mut since, mut turn) = (0, 0.0, 0.0);
        let (ending, energies) = loop {
            let motion = path.motion(self.body.time_s - from);
            if motion.next != next {
                if let Some(point) = means.take() {
                    course.add(point, next);
                    slips_m.push(self.anchored.largest_slip_m());
                    strains.push(gauge.read());
                }
                course.turned(next);
                (since, turn, next) = (self.rotation_rad(), self.rotation_rad(), motion.next);
            }
            self.drive(motion.rate_rad_s);
            if !self.step() {
                continue;
            }
            let (rotation, sense) = (self.rotation_rad(), path.sense(next));
            watch.look(&self.body, self.anchored.sliding(), rotation, &mut events);
            means.add([rotation, self.moment_nm(), self.rest_m - self.height_m()]);
            gauge.take(&self.body);
            let interval = (SAMPLE_RAD[0] + 0.05 * (sense * (rotation - turn))).min(SAMPLE_RAD[1]);
            if sense * (rotation - since) < interval {
                continue;
            }
            since = rotation;
            let Some(point) = means.take() else { continue };
            let energies = self.energy.look(&self.body);
            self.check(rotation, &point, &energies)?;
            progress(self.body.time_s);
            course.add(point, next);
            slips_m.push(self.anchored.largest_slip_m());
            strains.push(gauge.read());
            course.kinetic(self.vibration_j(motion.rate_rad_s) / energies.internal_j.max(1.0));
            let passed = next + 1 == path.turns() && sense * (rotation - path.turn_rad(next)) >= 0.0;
            if let Some(ending) = course.ending().or(passed.then_some(Ending::Path)) {
                break (ending, energies);
            }
        };
        let Course { points, turned_at, kinetic_share, .. } = course;
        let steps = self.body.steps;
        let energies = energies.of_whole(self.member.share);
        Ok(Bent { points, strains, turned_at, kinetic_share, energies, steps, ending, slips_m, events })
    }

    /// Gives the free end a rate of rotation \[rad/s\].
    fn drive(&mut self, rate_rad_s: f64) {
        let speed = rate_rad_s * self.member.length_m;
        for (n, _) in &self.member.tip {
            let held = &mut self.body.prescribed_m_s[*n];
            held[0] = Some(speed * self.direction[0]);
            held[1] = Some(speed * self.direction[1]);
        }
    }

    fn check(&self, rotation_rad: f64, point: &[f64; 3], energies: &Energies) -> Result<(), BendError> {
        if point.iter().any(|v| !v.is_finite()) || self.body.broken_node().is_some() {
            return Err(BendError::NotFinite { rotation_rad });
        }
        let elongation_m = -point[2];
        if elongation_m > TORN_STRAIN * self.member.length_m {
            return Err(BendError::Torn { axial_n: self.axial_n, elongation_m, rotation_rad });
        }
        let share = energies.residual_share;
        if share.is_nan() || share > ENERGY_LIMIT {
            return Err(BendError::Energy { share, rotation_rad });
        }
        Ok(())
    }

    /// Kinetic energy of what is left of the motion without a turn of the whole member about the end section \[J\]: that turn strains nothing.
    fn vibration_j(&self, rate_rad_s: f64) -> f64 {
        let [c, s] = self.direction;
        let of_node = |((x, v), mass): ((&[f64; 3], &[f64; 3]), &f64)| {
            let (along, height) = (c * x[0] + s * x[1], x[2].max(0.0));
            let turn = [c * height, s * height, if x[2] < 0.0 { 0.0 } else { -along }];
            0.5 * mass * (0..3).map(|i| (v[i] - rate_rad_s * turn[i]).powi(2)).sum::<f64>()
        };
        self.body.x.iter().zip(&self.body.v).zip(&self.body.mass_kg).map(of_node).sum()
    }

    /// Mean of a coordinate over the free end \[m\].
    fn tip_m(&self, axis: usize) -> f64 {
        self.member.tip.iter().map(|(n, share)| share * self.body.x[*n][axis]).sum()
    }

    fn height_m(&self) -> f64 {
        self.tip_m(2)
    }

    /// Depth of the section along the push \[m\].
    fn depth_m(&self) -> f64 {
        let [c, s] = self.direction;
        let at = |(n, _): &(usize, f64)| {
            let x = self.member.mesh.nodes[*n];
            c * x[0] + s * x[1]
        };
        let places = || self.member.tip.iter().map(at);
        places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
    }

    /// Displacement of the free end along the push over the length.
    fn rotation_rad(&self) -> f64 {
        let moved = self.direction[0] * self.tip_m(0) + self.direction[1] * self.tip_m(1);
        moved / self.member.length_m
    }

    /// Moment of the stress resultants in the end section about the axis across the push, positive where it resists a push in its
    /// direction \[N m\].
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
        (moment + self.member.block_m * shear) / self.member.share
    }
}

/// Index of a sense: positive 0, negative 1.
fn index(sense: f64) -> usize {
    usize::from(sense < 0.0)
}

/// What a bend has met so far.
struct Course<'a> {
    path: &'a Path,
    length_m: f64,
    /// Rotation from which on a moment can be lost \[rad\].
    bears_from_rad: f64,
    points: Vec<[f64; 3]>,
    turned_at: Vec<usize>,
    kinetic_share: f64,
    /// Largest moment by sense, and that of the present way \[N m\].
    peak: [f64; 2],
    way_peak: f64,
    /// Largest rotation by sense \[rad\].
    reach: [f64; 2],
    /// Whether the moment is lost, by sense.
    lost: [bool; 2],
}

impl<'a> Course<'a> {
    fn new(path: &'a Path, length_m: f64, bears_from_rad: f64) -> Self {
        Self {
            path,
            length_m,
            bears_from_rad,
            points: vec![[0.0; 3]],
            turned_at: Vec::new(),
            kinetic_share: 0.0,
            peak: [0.0; 2],
            way_peak: 0.0,
            reach: [0.0; 2],
            lost: [false; 2],
        }
    }

    /// A point on the way to a turning point.
    fn add(&mut self, point: [f64; 3], next: usize) {
        self.points.push(point);
        let sense = self.path.sense(next);
        let (side, [rotation, moment]) = (index(sense), [sense * point[0], sense * point[1]]);
        self.peak[side] = self.peak[side].max(moment);
        self.way_peak = self.way_peak.max(moment);
        if rotation > self.reach[side] {
            self.reach[side] = rotation;
            self.lost[side] = rotation > self.bears_from_rad && moment < FAILED_SHARE * self.peak[side];
        }
    }

    /// A turning point was passed.
    fn turned(&mut self, passed: usize) {
        let (sense, at) = (self.path.sense(passed), self.path.turn_rad(passed));
        if sense * at > 0.0 {
            self.lost[index(sense)] |= self.way_peak < FAILED_SHARE * self.peak[index(sense)];
        }
        self.way_peak = 0.0;
        self.turned_at.push(self.points.len());
    }

    fn kinetic(&mut self, share: f64) {
        let sense = self.path.sense(0);
        let bears = sense * self.points[self.points.len() - 1][1] > 0.8 * self.peak[index(sense)];
        let far = self.reach[0].max(self.reach[1]) > KINETIC_FROM * self.bears_from_rad;
        if far && (bears || self.path.turns() > 1) {
            self.kinetic_share = self.kinetic_share.max(share);
        }
    }

    /// Whether the bend is over before its path is.
    fn ending(&self) -> Option<Ending> {
        let [rotation_rad, _, shortening_m] = self.points[self.points.len() - 1];
        // a straight chord that turns comes down by θ² L / 2
        let lost_m = shortening_m - 0.5 * rotation_rad * rotation_rad * self.length_m;
        if lost_m > CRUSHED_STRAIN * self.length_m {
            return Some(Ending::Axial { rotation_rad, shortening_m });
        }
        let used =
            [1.0, -1.0].map(|sense| (0..self.path.turns()).any(|i| sense * self.path.turn_rad(i) > 0.0));
        (0..2).all(|i| self.lost[i] || !used[i]).then_some(Ending::Moment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slender_members_swing_longer() {
        let from = |length_m, depth_m| bears_from_rad(length_m, depth_m, SPEED_RAD_S);
        for (length_m, depth_m) in [(0.4, 0.2), (1.75, 0.4), (2.0, 0.5), (3.0, 0.3), (4.0, 0.4)] {
            assert_eq!((from(length_m, depth_m), KINETIC_FROM * from(length_m, depth_m)), (1e-3, 2e-3));
        }
        // twice the length: 16 times the rotation; half the speed: half of it
        assert!((from(8.0, 0.4) / (1e-3 * 3.2 * 3.2) - 1.0).abs() < 1e-12);
        assert!((from(16.0, 0.4) / from(8.0, 0.4) - 16.0).abs() < 1e-12);
        assert!((bears_from_rad(16.0, 0.4, 0.5 * SPEED_RAD_S) / from(16.0, 0.4) - 0.5).abs() < 1e-12);
        // cracked beams of elastic elements, L and h in m, rotation in mrad up to which they bear less than 20 % of their peak
        for (length_m, depth_m, lost_mrad) in
            [(5.0, 0.4, 0.99), (6.0, 0.4, 2.31), (8.0, 0.4, 6.91), (8.0, 0.2, 16.3)]
        {
            assert!(1e3 * from(length_m, depth_m) > lost_mrad, "{length_m} {depth_m}");
        }
    }
}
