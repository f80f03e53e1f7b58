//! A piece of a member between two plane sections, shortened, lengthened, sheared or twisted until it has failed.
//!
//! The lower section is held; the upper one is shortened or pulled, moved across without turning, or turned about the axis of the member. Across and about
//! the axis it is free to move along the member under a constant axial force. Both may spread by smooth patterns ([`super::plate`]). The resistance is the mean of
//! what both sections bear. Quasi-static by explicit integration: the speed rises with the deformation, kinetic energy and the balance of the curve's work with the
//! energy of the elements are recorded.

use super::bar_bending::BarBending;
use super::cover::Cover;
use super::drive;
use super::member::RcMember;
use super::plate::{Motion, Plate};
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use serde::Serialize;

/// Time over which the axial force is applied, and in which it comes to rest \[s\].
const AXIAL_S: [f64; 2] = [0.02, 0.02];
/// Steps between two looks at forces and motion.
const LOOK_STEPS: u64 = 4;
/// Damping while it is \[1/s\].
const AXIAL_DAMPING_1_S: f64 = 1500.0;
/// Shortening over length at which the axial force counts as not borne.
const CRUSHED_STRAIN: f64 = 0.01;
/// Time over which the motion speeds up \[s\].
const RAMP_S: f64 = 0.05;
/// Rate of deformation \[1/s\], and the deformation at which it has doubled.
const RATE: [f64; 2] = [0.04, 0.005];
/// Damping while loaded \[1/s\].
const DAMPING_1_S: f64 = 50.0;
/// Interval of deformation over which forces are averaged: at the start, growth, at most.
const SAMPLE: [f64; 3] = [2e-6, 0.02, 2e-4];
/// Share of its peak at which a piece has failed.
pub const FAILED_SHARE: f64 = 0.2;
/// Deformation below which a fall of the force is one of cracking, not of failure.
const CRACKING: f64 = 0.004;
/// Largest error of the balance of energy of a curve that counts as quasi-static.
const BALANCE_LIMIT: f64 = 0.1;
/// Share of the initial stiffness at which a piece counts as softened.
const SOFT_SHARE: f64 = 0.8;

/// What is done to the upper section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// Pressed down.
    Crush,
    /// Pulled up.
    Tension,
    /// Moved across, parallel to the lower one.
    Shear,
    /// Turned about the axis of the member.
    Torsion,
}

/// How a piece is loaded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PieceLoad {
    /// What is done.
    pub drive: Drive,
    /// Direction of shear: 0 along x, 90 along y \[deg\].
    pub direction_deg: f64,
    /// Constant axial force of shear and torsion, compression positive \[N\].
    pub axial_n: f64,
    /// Shortening or elongation over length, drift, or rotation times width over length at which to stop.
    pub until: f64,
    /// Whether the lower section is rough: it cannot spread, as at a contact.
    pub rough: bool,
}

/// A state on the way.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct PiecePoint {
    /// Shortening, elongation, relative displacement \[m\], or rotation \[rad\].
    pub at: f64,
    /// Resistance \[N\], or torque \[N m\].
    pub force: f64,
    /// Shortening since the axial force came to rest \[m\].
    pub shortening_m: f64,
    /// Energy of concrete and of steel, dissipated and stored, since then \[J\].
    pub energy_j: [f64; 2],
    /// Kinetic energy \[J\].
    pub kinetic_j: f64,
}

impl PiecePoint {
    fn add(&mut self, other: &Self, factor: f64) {
        self.at += factor * other.at;
        self.force += factor * other.force;
        self.shortening_m += factor * other.shortening_m;
        self.energy_j = [0, 1].map(|i: usize| self.energy_j[i] + factor * other.energy_j[i]);
        self.kinetic_j += factor * other.kinetic_j;
    }
}

/// A loaded piece.
#[derive(Debug, Clone, PartialEq)]
pub struct PieceRun {
    /// The curve, from zero.
    pub points: Vec<PiecePoint>,
    /// Displacement and force when concrete in the middle third of the length first cracked.
    pub first_crack: Option<[f64; 2]>,
    /// When the first longitudinal bar, and the first tie, yielded.
    pub first_yield: [Option<[f64; 2]>; 2],
    /// Elements of longitudinal bars and of ties that ruptured.
    pub ruptured: [usize; 2],
    /// Largest kinetic over internal energy between a tenth of the peak's displacement and the fall to 80 %.
    pub kinetic_share: f64,
    /// Largest difference of the curve's work from the energy of the elements, over the last work.
    pub energy_error: f64,
    /// Time steps.
    pub steps: u64,
    /// Whether the force fell below [`FAILED_SHARE`] of its peak.
    pub failed: bool,
}

/// A run that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PieceError {
    /// The section does not bear its axial force.
    #[error(
        "the piece does not bear N = {axial_n:.0} N: it shortened by {shortening_m:.4} m; use a smaller axial force"
    )]
    Crushed {
        /// Axial force \[N\].
        axial_n: f64,
        /// Shortening \[m\].
        shortening_m: f64,
    },
    /// Numbers that are not finite.
    #[error("not finite at a deformation of {deformation:.4}")]
    NotFinite {
        /// Over the length, as in [`PieceLoad::until`].
        deformation: f64,
    },
    /// The curve has no positive resistance.
    #[error("no resistance up to a deformation of {deformation:.4}")]
    NoResistance {
        /// Over the length, as in [`PieceLoad::until`].
        deformation: f64,
    },
}

impl PieceRun {
    /// Index of the largest resistance.
    pub fn peak(&self) -> usize {
        (0..self.points.len()).fold(0, |a, b| if self.points[b].force > self.points[a].force { b } else { a })
    }

    /// Displacement beyond the peak at which a share of it is left; `None`: not reached.
    pub fn fall_to(&self, share: f64) -> Option<f64> {
        let peak = self.peak();
        let level = share * self.points[peak].force;
        let pair = self.points[peak..].windows(2).find(|w| w[0].force >= level && w[1].force < level)?;
        let part = (level - pair[0].force) / (pair[1].force - pair[0].force);
        Some(pair[0].at + part * (pair[1].at - pair[0].at))
    }

    /// Initial stiffness: the slope of the line through the origin that fits the points up to half of the first crack, or of the peak.
    pub fn stiffness(&self) -> f64 {
        let peak = self.points[self.peak()].force;
        let level = 0.5 * self.first_crack.map_or(peak, |c| c[1].min(peak));
        let rising = || self.points.iter().take_while(|p| p.force <= level);
        let (top, below) = rising().fold([0.0; 2], |s, p| [s[0] + p.at * p.force, s[1] + p.at * p.at]).into();
        if below > 0.0 { top / below } else { 0.0 }
    }

    /// Where the secant stiffness has fallen to 80 % of the initial one for good: displacement and force.
    pub fn softened(&self) -> Option<[f64; 2]> {
        let level = SOFT_SHARE * self.stiffness();
        let last = self.points.iter().rposition(|p| p.at > 0.0 && p.force >= level * p.at)?;
        self.points.get(last + 1).map(|p| [p.at, p.force])
    }

    /// Work of the curve and of the axial force up to each point \[J\].
    fn works_j(&self, axial_n: f64) -> Vec<f64> {
        let mut works = vec![0.0];
        for w in self.points.windows(2) {
            let own = 0.5 * (w[0].force + w[1].force) * (w[1].at - w[0].at);
            let axial = axial_n * (w[1].shortening_m - w[0].shortening_m);
            works.push(works[works.len() - 1] + own + axial);
        }
        works
    }

    /// Fills in the figures of quality.
    fn judge(&mut self, axial_n: f64) {
        let peak = self.peak();
        let (top, from) = (self.points[peak].force, 0.1 * self.points[peak].at);
        let works = self.works_j(axial_n);
        let whole = works[works.len() - 1].abs().max(1e-9);
        for (i, p) in self.points.iter().enumerate().filter(|(_, p)| p.at >= from) {
            let internal = p.energy_j[0] + p.energy_j[1];
            self.energy_error = self.energy_error.max((works[i] - internal).abs() / whole);
            if i <= peak || p.force > 0.8 * top {
                self.kinetic_share = self.kinetic_share.max(p.kinetic_j / internal.max(1e-9));
            }
        }
    }

    /// Why the curve is not quasi-static, in words.
    pub fn fault(&self) -> Option<String> {
        if let Some(moves) = drive::moves(self.kinetic_share) {
            Some(moves)
        } else if self.energy_error > BALANCE_LIMIT {
            let share = 100.0 * self.energy_error;
            Some(format!("work and energy of the elements differ by {share:.1} %"))
        } else {
            None
        }
    }
}

struct Run<'a> {
    member: &'a RcMember,
    load: &'a PieceLoad,
    body: Dynamics,
    cover: Cover,
    /// Bending of the bars; none across the member, where it would be dowel action of bars that stay elastic.
    bars: BarBending,
    plates: [Plate; 2],
    /// Displacement per unit of deformation \[m or rad\].
    scale: f64,
    at: f64,
    rest_m: f64,
    start_j: [f64; 2],
    /// Elements watched for cracks.
    middle: Vec<usize>,
    is_bar: Vec<bool>,
}

/// Loads a piece. `width_m`: smaller side of the section. `progress` is told the deformation reached.
///
/// # Errors
/// If the axial force is not borne, numbers break, or there is no resistance.
pub fn run(
    member: &RcMember,
    width_m: f64,
    load: &PieceLoad,
    progress: &dyn Fn(f64),
) -> Result<PieceRun, PieceError> {
    let mut body = Dynamics::new(&member.mesh, 0.0, RigidSurfaces::default(), false);
    let cover = Cover::of(member, &mut body);
    let bars = match load.drive {
        Drive::Crush | Drive::Tension => BarBending::of(member),
        Drive::Shear | Drive::Torsion => BarBending::default(),
    };
    let plates =
        [Plate::of(member, &body, &member.base, !load.rough), Plate::of(member, &body, &member.tip, true)];
    let mut is_bar = vec![false; member.mesh.trusses.len()];
    member.bars.iter().for_each(|b| is_bar[*b] = true);
    let scale = member.length_m / if load.drive == Drive::Torsion { width_m } else { 1.0 };
    let middle = middle_third(member);
    let mut run = Run {
        member,
        load,
        body,
        cover,
        bars,
        plates,
        scale,
        at: 0.0,
        rest_m: 0.0,
        start_j: [0.0; 2],
        middle,
        is_bar,
    };
    run.press()?;
    run.drive(progress)
}

/// Elements in the middle third of the length; of a piece without any the nearest to mid-length.
fn middle_third(member: &RcMember) -> Vec<usize> {
    let elements = 0..member.mesh.elements.len();
    let off = |e: usize| (member.mesh.center(e)[2] / member.length_m - 0.5).abs();
    let least = elements.clone().map(off).fold(f64::INFINITY, f64::min);
    let near = (1.0 / 6.0f64).max(least + 1e-6);
    elements.filter(|e| off(*e) < near).collect()
}

impl Run<'_> {
    /// One step, with both sections held.
    fn step(&mut self, upper: &Motion) {
        self.bars.push(&mut self.body);
        self.body.step(false);
        self.bars.release(&mut self.body);
        let lower = Motion { along_m_s: Some(0.0), ..Motion::default() };
        self.plates[0].hold(&mut self.body, &lower);
        self.plates[1].hold(&mut self.body, upper);
        if self.body.steps.is_multiple_of(LOOK_STEPS) {
            self.cover.look(&mut self.body);
        }
    }

    /// Applies the axial force.
    fn press(&mut self) -> Result<(), PieceError> {
        let axial_n = self.load.axial_n;
        self.body.damping_1_s = AXIAL_DAMPING_1_S;
        while axial_n != 0.0 && self.body.time_s < AXIAL_S[0] + AXIAL_S[1] {
            let s = (self.body.time_s / AXIAL_S[0]).min(1.0);
            let force = -axial_n * s * s * (3.0 - 2.0 * s);
            for (n, share) in &self.member.tip {
                self.body.applied_n[*n] = [0.0, 0.0, force * share];
            }
            self.step(&Motion::default());
        }
        self.rest_m = self.plates[1].height_m(&self.body);
        let shortening_m = self.member.length_m - self.rest_m;
        if shortening_m.is_nan() || shortening_m.abs() > CRUSHED_STRAIN * self.member.length_m {
            return Err(PieceError::Crushed { axial_n, shortening_m });
        }
        self.start_j = self.energy_j();
        self.body.damping_1_s = DAMPING_1_S;
        Ok(())
    }

    fn energy_j(&self) -> [f64; 2] {
        let [internal, hourglass, viscous] = self.body.blocks.energies_j();
        [internal + hourglass + viscous, self.body.trusses.internal_j()]
    }

    /// Motion of the upper section at a speed \[m/s or rad/s\].
    fn motion(&self, speed: f64) -> Motion {
        let (sin, cos) = libm::sincos(self.load.direction_deg.to_radians());
        match self.load.drive {
            Drive::Crush => Motion { along_m_s: Some(-speed), ..Motion::default() },
            Drive::Tension => Motion { along_m_s: Some(speed), ..Motion::default() },
            Drive::Shear => Motion { across_m_s: [speed * cos, speed * sin], ..Motion::default() },
            Drive::Torsion => Motion { spin_rad_s: speed, ..Motion::default() },
        }
    }

    /// Resistance \[N or N m\].
    fn resistance(&self) -> f64 {
        let [lower, upper] = [0, 1].map(|i: usize| self.plates[i].resultants(&self.body));
        let (sin, cos) = libm::sincos(self.load.direction_deg.to_radians());
        let mean = |i: usize| 0.5 * (upper.force_n[i] - lower.force_n[i]);
        match self.load.drive {
            Drive::Crush => -mean(2),
            Drive::Tension => mean(2),
            Drive::Shear => cos * mean(0) + sin * mean(1),
            Drive::Torsion => 0.5 * (upper.torque_nm - lower.torque_nm),
        }
    }

    fn point(&self) -> PiecePoint {
        let now = self.energy_j();
        PiecePoint {
            at: self.at,
            force: self.resistance(),
            shortening_m: self.rest_m - self.plates[1].height_m(&self.body),
            energy_j: [now[0] - self.start_j[0], now[1] - self.start_j[1]],
            kinetic_j: self.body.kinetic_j(),
        }
    }

    fn drive(&mut self, progress: &dyn Fn(f64)) -> Result<PieceRun, PieceError> {
        let from = self.body.time_s;
        let mut found = PieceRun {
            points: vec![PiecePoint::default()],
            first_crack: None,
            first_yield: [None; 2],
            ruptured: [0; 2],
            kinetic_share: 0.0,
            energy_error: 0.0,
            steps: 0,
            failed: false,
        };
        let (mut sum, mut count, mut since, mut peak) = (PiecePoint::default(), 0.0, 0.0, 0.0f64);
        loop {
            let ramp = ((self.body.time_s - from) / RAMP_S).min(1.0);
            let deformation = self.at / self.scale;
            let speed = RATE[0] * (1.0 + deformation / RATE[1]) * ramp * self.scale;
            self.step(&self.motion(speed));
            self.at += self.body.taken_s * speed;
            for index in &self.body.trusses.ruptured {
                found.ruptured[usize::from(!self.is_bar[*index])] += 1;
            }
            if !self.body.steps.is_multiple_of(LOOK_STEPS) {
                continue;
            }
            sum.add(&self.point(), 1.0);
            count += 1.0;
            let interval = (SAMPLE[0] + SAMPLE[1] * deformation).min(SAMPLE[2]);
            if deformation - since < interval {
                continue;
            }
            let mut point = PiecePoint::default();
            point.add(&sum, 1.0 / count);
            (sum, count, since) = (PiecePoint::default(), 0.0, deformation);
            if !(point.force.is_finite() && point.at.is_finite()) || self.body.broken_node().is_some() {
                return Err(PieceError::NotFinite { deformation });
            }
            peak = peak.max(point.force);
            found.failed = deformation > CRACKING && point.force < FAILED_SHARE * peak;
            if found.failed {
                point.force = point.force.max(0.0); // the rebound of a piece torn apart is not a resistance
            }
            self.watch(&point, &mut found);
            found.points.push(point);
            progress(deformation);
            if found.failed || deformation >= self.load.until {
                if peak <= 0.0 {
                    return Err(PieceError::NoResistance { deformation });
                }
                found.steps = self.body.steps;
                found.judge(self.load.axial_n);
                return Ok(found);
            }
        }
    }

    /// Notes the first crack and the first bars that yield.
    fn watch(&self, point: &PiecePoint, found: &mut PieceRun) {
        let now = [point.at, point.force];
        if found.first_crack.is_none() && self.middle.iter().any(|e| self.body.blocks.crack_strain(*e) > 0.0)
        {
            found.first_crack = Some(now);
        }
        for (bar, longitudinal) in self.body.trusses.bars.iter().zip(&self.is_bar) {
            let slot = &mut found.first_yield[usize::from(!longitudinal)];
            let law = self.member.mesh.laws[bar.law].rebar;
            if slot.is_none() && law.is_some_and(|law| bar.rebar.strain.abs() > law.yield_strain()) {
                *slot = Some(now);
            }
        }
    }
}
