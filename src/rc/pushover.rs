//! Bends a member end to failure under constant axial force.
//!
//! The far section is pushed sideways on its centre line, free to turn and to shorten, while the axial force follows the
//! member's chord. The moment of the end section is the sum of the nodal forces of the member's own elements about the
//! section's current centre: the integral of the section's stresses in the discrete sense. It does not
//! contain the second-order moment `N w`; the MBS model has that from its geometry, so P-Δ acts once.
//!
//! **Where the hinge is.** A plastic region has a length, so the member turns about a point at some distance `c` from the end
//! section. It is found from the motion of the far section while the hinge flows: the pole of its plane
//! displacement between two rotations. The envelope is given about this point: with `l` the distance of the sections, the rotation is
//! `atan2(l sin θ, l cos θ - c)` for the chord rotation θ, and the moment there is `M (1 - c / l)`, as the moment vanishes at the far
//! section. Work of the push is the same in both descriptions; that of the axial force is not, since it has a moment about the hinge and none about the end section,
//! which models put in ([`crate::curve::ResistanceCurve::at_distance`]). The rotation is that of the chord, not of the section, so that the
//! curve contains the flexibility of half the member and of the joint; an MBS hinge between rigid bodies then has the
//! member's stiffness.
//!
//! Quasi-static by explicit integration: the speed rises from zero, and the ratio of kinetic to internal energy is
//! recorded as a quality figure.

use super::cut::EndModel;
use crate::base::median::median;
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::preload;
use crate::material::j2::HardeningTable;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Axial forces of the curves over the squash load `σ_y A` (compression positive).
pub const AXIAL_SHARES: [f64; 5] = [-0.1, 0.0, 0.1, 0.2, 0.4];
/// Rotation at which a push ends if the section has not failed \[rad\].
pub const LARGEST_ROTATION: f64 = 1.2;
/// A section whose moment has fallen below this share of its peak has failed.
pub const FAILED_SHARE: f64 = 0.05;
/// Speed of the chord: slow in the elastic range, then fast \[rad/s\].
const SPEEDS: [f64; 2] = [0.1, 0.8];
/// Times at which the two speeds are reached \[s\].
const RAMPS: [f64; 2] = [0.1, 0.4];
/// Chord rotations between which the pole is found \[rad\].
const POLE_ROTATIONS: [f64; 2] = [0.08, 0.2];
/// Largest distance of the hinge from the end section, in section depths.
pub(super) const POLE_LIMIT_DEPTHS: f64 = 1.5;
/// Interval of rotation over which shortening is measured \[rad\].
const SINKS: f64 = 0.02;
/// Interval over which section forces are averaged \[rad\], elastic and later.
const SAMPLE: [f64; 2] = [2.0e-4, 4.0e-3];

/// One envelope: moment over chord rotation at constant axial force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Push {
    /// Axial force, compression positive \[N\].
    pub axial_force_n: f64,
    /// `[chord rotation (rad), moment (N m)]`, from zero.
    pub points: Vec<[f64; 2]>,
    /// Whether the section failed within [`LARGEST_ROTATION`].
    pub failed: bool,
    /// Largest kinetic over internal energy beyond 1 % rotation, while the section bears 80 % of its peak.
    pub kinetic_share: f64,
    /// Distance from the end section of the point about which the far section turned while the hinge flowed \[m\].
    pub pole_m: Option<f64>,
    /// Chord rotation about the end section from which on the member gets shorter by more than its depth for each radian, so that it turns about no point of its section: what is left of it does not bear the axial force \[rad\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sinks_rad: Option<f64>,
}

/// All curves of one member end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EndCurves {
    /// Envelopes about the directions `axis + 1` and `axis + 2`, by axial force.
    pub axes: [Vec<Push>; 2],
    /// Distance of the hinge from the end section, along the member \[m\].
    pub hinge_offset_m: f64,
    /// Axial stiffness of the end: half the member and the joint \[N/m\].
    pub axial_stiffness_n_m: f64,
    /// Shear stiffness `G A_s / l` along `axis + 1` and `axis + 2` \[N/m\].
    pub shear_stiffness_n_m: [f64; 2],
    /// Torsional stiffness `G I_t / l` \[N m/rad\].
    pub torsional_stiffness_nm_rad: f64,
    /// Tension at which the section separates, `σ_y(ε_crit) A` \[N\].
    pub tensile_capacity_n: f64,
    /// Compression at which the section crushes, or that what it stands on does not bear with a column that goes on beyond it either \[N\].
    pub compressive_capacity_n: f64,
    /// Compression that the floor at the end does not bear where no column goes on beyond it \[N\]; none if it bears all that were tried.
    pub bearing_capacity_n: Option<f64>,
    /// Plastic elongation at that tension, `ε_crit l`: the law hardens, so that the bar stretches along its whole length \[m\].
    pub tensile_elongation_m: f64,
    /// Difference of the peaks for the two senses of rotation over their mean, larger of both axes.
    pub asymmetry: f64,
    /// Elements of the submodel.
    pub elements: usize,
}

/// A push that cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PushoverError {
    /// The static state under axial force does not exist.
    #[error("member end under N = {axial_force_n:.0} N: {reason}")]
    Preload {
        /// Axial force \[N\].
        axial_force_n: f64,
        /// Why.
        reason: String,
    },
    /// The run produced numbers that are not finite.
    #[error("member end under N = {axial_force_n:.0} N: not finite at a rotation of {rotation_rad:.3} rad")]
    NotFinite {
        /// Axial force \[N\].
        axial_force_n: f64,
        /// Rotation reached \[rad\].
        rotation_rad: f64,
    },
}

/// All curves of a member end; `progress` is told after each push (done, all).
///
/// A large compression that what the member stands on does not bear (a thin slab under a strong column) passes on into the column beyond it, which the pushes with compressions of more than a tenth of the squash load
/// then have: the axial force acts on the opposite face of the joint as well. Where no column goes on, it is [`EndCurves::bearing_capacity_n`]. One for which there is no push with that either bounds the compressive capacity.
///
/// # Errors
/// If a push cannot be made at an axial force of up to a tenth of the squash load, or does not stay finite.
pub fn derive(
    model: &EndModel,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<EndCurves, PushoverError> {
    let law = &model.mesh.laws[model.mesh.elements[model.section_elements[0]].law];
    let sample = &model.mesh.elements[model.section_elements[0]];
    let area = model.area_m2;
    let table = HardeningTable::new(&law.hardening);
    let scale = sample.smear * sample.strength;
    let squash = scale * table.at(0.0).0 * area;
    let mut jobs: Vec<(usize, f64, f64)> =
        (0..2).flat_map(|axis| AXIAL_SHARES.map(|share| (axis, share * squash, 1.0))).collect();
    jobs.extend([(0, 0.1 * squash, -1.0), (1, 0.1 * squash, -1.0)]);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let all = jobs.len();
    let run = |(axis, force, sense): &(usize, f64, f64), goes_on: bool| {
        let result = push(model, *axis, *force, *sense, goes_on);
        let number = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        progress(number.min(all), all);
        result
    };
    let is_large = |force_n: f64| force_n > 0.15 * squash;
    let unborne = |r: &Result<_, PushoverError>| match r {
        Err(PushoverError::Preload { axial_force_n, .. }) => Some(*axial_force_n).filter(|n| is_large(*n)),
        _ => None,
    };
    let least = |results: &[Result<_, _>]| results.iter().filter_map(unborne).fold(f64::INFINITY, f64::min);
    let mut results: Vec<Result<(Push, f64), PushoverError>> =
        jobs.par_iter().map(|job| run(job, false)).collect();
    let borne_by_floor = least(&results);
    if borne_by_floor < f64::INFINITY && !model.opposite_nodes.is_empty() {
        let redo = |(job, result): (&(usize, f64, f64), &mut Result<_, _>)| {
            if is_large(job.1) {
                *result = run(job, true);
            }
        };
        jobs.par_iter().zip(results.par_iter_mut()).for_each(redo);
    }
    let limit = least(&results);
    let kept = jobs.iter().zip(results).filter(|((_, force, _), _)| *force < limit);
    let pushes: Vec<(Push, f64)> = kept.map(|(_, result)| result).collect::<Result<_, _>>()?;
    let count = AXIAL_SHARES.iter().filter(|share| **share * squash < limit).count();
    let peak = |p: &Push| p.points.iter().map(|q| q[1]).fold(0.0, f64::max);
    let asymmetry = (0..2)
        .map(|axis| {
            let (a, b) = (peak(&pushes[axis * count + 2].0), peak(&pushes[2 * count + axis].0));
            2.0 * (a - b).abs() / (a + b)
        })
        .fold(0.0, f64::max);
    let rupture = law.erosion.plastic_strain.min(law.erosion.principal_strain);
    let shear_modulus = 0.5 * law.youngs_modulus_pa * sample.smear / (1.0 + law.poisson_ratio);
    let shear = shear_modulus * 5.0 / 6.0 * area / model.length_m;
    let depth = model.section_m[0].max(model.section_m[1]);
    let poles: Vec<f64> = pushes[..2 * count].iter().filter_map(|p| p.0.pole_m).collect();
    let hinge_offset_m = median(poles).clamp(0.0, POLE_LIMIT_DEPTHS * depth);
    let about_hinge =
        |p: &Push| Push { points: moved(&p.points, model.length_m, hinge_offset_m), ..p.clone() };
    let tensile_capacity_n = scale * table.at(rupture).0 * area;
    Ok(EndCurves {
        axes: [0, 1]
            .map(|axis| pushes[axis * count..(axis + 1) * count].iter().map(|p| about_hinge(&p.0)).collect()),
        hinge_offset_m,
        axial_stiffness_n_m: pushes[2].1,
        shear_stiffness_n_m: [shear; 2],
        torsional_stiffness_nm_rad: shear_modulus * model.torsion_m4 / model.length_m,
        tensile_capacity_n,
        compressive_capacity_n: tensile_capacity_n.min(limit),
        bearing_capacity_n: Some(borne_by_floor).filter(|n| *n < f64::INFINITY),
        tensile_elongation_m: rupture * model.length_m,
        asymmetry,
        elements: model.mesh.elements.len(),
    })
}

/// An envelope over chord rotation about the end section, described about a point `c` further along the member.
pub(super) fn moved(points: &[[f64; 2]], length: f64, c: f64) -> Vec<[f64; 2]> {
    let turn = |r: f64| libm::atan2(length * libm::sin(r), length * libm::cos(r) - c);
    points.iter().map(|[r, m]| [turn(*r), m * (1.0 - c / length)]).collect()
}

/// Pole of a plane motion: `p`, `q` two positions of a point and `angle` the rotation between them, in a frame whose first axis
/// points along the member. Returns its coordinate along the member.
fn pole(p: [f64; 2], q: [f64; 2], angle: f64) -> f64 {
    0.5 * (p[0] + q[0]) - 0.5 * (q[1] - p[1]) / libm::tan(0.5 * angle)
}

/// Torsion constant of a rectangle (Roark's formulas for stress and strain, table 10.1, case 4) \[m⁴\].
pub fn torsion_constant(section_m: [f64; 2]) -> f64 {
    let (a, b) = (0.5 * section_m[0].max(section_m[1]), 0.5 * section_m[0].min(section_m[1]));
    a * b.powi(3) * (16.0 / 3.0 - 3.36 * b / a * (1.0 - b.powi(4) / (12.0 * a.powi(4))))
}

/// One push about the direction `axis + 1 + bending` under an axial force \[N\] (compression positive), in the sense 1 or -1; also returns the axial stiffness \[N/m\]. `goes_on`: a column beyond the joint bears
/// the axial force.
///
/// # Errors
/// If there is no state under the axial force, or the run does not stay finite.
pub fn push(
    model: &EndModel,
    bending: usize,
    axial_force_n: f64,
    sense: f64,
    goes_on: bool,
) -> Result<(Push, f64), PushoverError> {
    let mut body = Dynamics::new(&model.mesh, 0.0, RigidSurfaces::default(), false);
    let apply = |body: &mut Dynamics| {
        let (chord, length) = chord(model, body);
        for (n, share) in &model.tip_nodes {
            body.applied_n[*n] = std::array::from_fn(|i| -axial_force_n * share * chord[i] / length);
        }
        // what is along the member passes on; what is across it the floor bears
        let along = axial_force_n * chord[model.axis] / length;
        for (n, share) in model.opposite_nodes.iter().filter(|_| goes_on) {
            body.applied_n[*n][model.axis] = along * share;
        }
    };
    let rest = tip_center(model, &body)[model.axis];
    apply(&mut body);
    let force_or_probe = if axial_force_n == 0.0 { 1.0 } else { axial_force_n };
    preload::equilibrate(&mut body).map_err(|reason| PushoverError::Preload { axial_force_n, reason })?;
    let shortening = -model.outward * (tip_center(model, &body)[model.axis] - rest);
    let axial_stiffness = force_or_probe / shortening;
    // rotation about `axis + 1` moves the tip along `axis + 2` and the other way round
    let direction = if bending == 0 { (model.axis + 2) % 3 } else { (model.axis + 1) % 3 };
    let guides = center_line(model, direction);
    let start = tip_center(model, &body);
    let mut recorder = Recorder::default();
    let mut poses: Vec<([f64; 2], f64)> = Vec::new();
    let depth_m = model.section_m[1 - bending];
    let (mut told, mut sinks_rad) = ([0.0; 2], None);
    loop {
        let rotation = chord_rotation(model, &body, start, direction);
        let speed = speed_at(body.time_s) * model.length_m * libm::cos(rotation).max(0.1);
        for n in &guides {
            body.prescribed_m_s[*n][direction] = Some(sense * speed);
        }
        if body.steps.is_multiple_of(16) {
            apply(&mut body);
        }
        body.step(false);
        if body.steps.is_multiple_of(8) {
            recorder.add(rotation, section_moment(model, &body, direction));
            if rotation - told[0] >= SINKS {
                let shorter_m = model.length_m - chord(model, &body).1;
                if told[0] > 0.0 && shorter_m - told[1] > depth_m * (rotation - told[0]) {
                    sinks_rad = sinks_rad.or(Some(told[0]));
                }
                told = [rotation, shorter_m];
            }
        }
        if body.steps.is_multiple_of(1024) {
            if body.broken_node().is_some() {
                return Err(PushoverError::NotFinite { axial_force_n, rotation_rad: rotation });
            }
            recorder.note_kinetic(rotation, body.kinetic_j() / body.blocks.energies_j()[0].max(1.0));
        }
        if poses.len() < 2 && rotation >= POLE_ROTATIONS[poses.len()] {
            poses.push(tip_pose(model, &body, start, direction));
        }
        let separated = !body.deaths.is_empty() && is_separated(model, &body);
        if separated {
            recorder.points.push([rotation.max(recorder.from + 1e-6), 0.0]);
        }
        let failed = separated || recorder.failed();
        if failed || rotation >= LARGEST_ROTATION {
            let pole_m = match poses[..] {
                [(p, a), (q, b)] => Some(pole(p, q, b - a)),
                _ => None,
            };
            let push = Push {
                axial_force_n,
                points: recorder.points,
                failed,
                kinetic_share: recorder.kinetic,
                pole_m,
                sinks_rad,
            };
            return Ok((push, axial_stiffness));
        }
    }
}

/// Chord speed \[rad/s\].
fn speed_at(time_s: f64) -> f64 {
    if time_s < RAMPS[0] {
        SPEEDS[0] * time_s / RAMPS[0]
    } else {
        let share = ((time_s - RAMPS[0]) / (RAMPS[1] - RAMPS[0])).min(1.0);
        SPEEDS[0] + (SPEEDS[1] - SPEEDS[0]) * share
    }
}

/// Averages moments over intervals of rotation.
#[derive(Debug)]
struct Recorder {
    points: Vec<[f64; 2]>,
    sum: [f64; 2],
    count: f64,
    from: f64,
    peak: f64,
    kinetic: f64,
}

impl Default for Recorder {
    fn default() -> Self {
        Self { points: vec![[0.0, 0.0]], sum: [0.0; 2], count: 0.0, from: 0.0, peak: 0.0, kinetic: 0.0 }
    }
}

impl Recorder {
    /// Takes in a sample; one that falls back behind the last point (a section that has failed vibrates) is left out.
    fn add(&mut self, rotation: f64, moment: f64) {
        if rotation < self.from {
            return;
        }
        self.sum[0] += rotation;
        self.sum[1] += moment;
        self.count += 1.0;
        let interval = if rotation < 0.02 { SAMPLE[0] + 0.1 * rotation } else { SAMPLE[1] };
        if rotation - self.from >= interval && self.count >= 4.0 {
            self.points.push([self.sum[0] / self.count, self.sum[1] / self.count]);
            self.peak = self.peak.max(self.sum[1] / self.count);
            (self.sum, self.count, self.from) = ([0.0; 2], 0.0, rotation);
        }
    }

    fn note_kinetic(&mut self, rotation: f64, share: f64) {
        let bears = self.points.last().is_some_and(|p| p[1] >= 0.8 * self.peak);
        if rotation > 0.01 && bears {
            self.kinetic = self.kinetic.max(share);
        }
    }

    fn failed(&self) -> bool {
        let n = self.points.len();
        n > 8 && self.points[n - 3..].iter().all(|p| p[1] < FAILED_SHARE * self.peak)
    }
}

/// From the centre of the end section to that of the far one, and how far that is \[m\].
fn chord(model: &EndModel, body: &Dynamics) -> ([f64; 3], f64) {
    let (base, tip) = (section_center(model, body), tip_center(model, body));
    let chord: [f64; 3] = std::array::from_fn(|i| tip[i] - base[i]);
    (chord, chord.iter().map(|c| c * c).sum::<f64>().sqrt())
}

fn section_center(model: &EndModel, body: &Dynamics) -> [f64; 3] {
    let n = model.section_nodes.len() as f64;
    std::array::from_fn(|i| model.section_nodes.iter().map(|k| body.x[*k][i]).sum::<f64>() / n)
}

pub(super) fn tip_center(model: &EndModel, body: &Dynamics) -> [f64; 3] {
    std::array::from_fn(|i| model.tip_nodes.iter().map(|(k, share)| body.x[*k][i] * share).sum())
}

/// Position of the far section's centre, along the member from the end section and sideways in the sense of the push, and the
/// rotation of the section in that sense \[rad\].
fn tip_pose(model: &EndModel, body: &Dynamics, start: [f64; 3], direction: usize) -> ([f64; 2], f64) {
    let tip = tip_center(model, body);
    let side = tip[direction] - start[direction];
    let middle = model.point_m[direction];
    let (mut across, mut along) = (0.0, 0.0);
    for (n, share) in &model.tip_nodes {
        let sign = (model.mesh.nodes[*n][direction] - middle).signum();
        if (model.mesh.nodes[*n][direction] - middle).abs() > 1e-9 {
            across += share * sign * body.x[*n][direction];
            along += share * sign * body.x[*n][model.axis];
        }
    }
    let rotation = libm::atan2(-model.outward * along * side.signum(), across);
    ([model.outward * (tip[model.axis] - model.point_m[model.axis]), side.abs()], rotation)
}

/// Rotation of the chord from the end section's undeformed centre to the far section \[rad\], positive.
pub(super) fn chord_rotation(model: &EndModel, body: &Dynamics, start: [f64; 3], direction: usize) -> f64 {
    let tip = tip_center(model, body);
    let along = model.outward * (tip[model.axis] - model.point_m[model.axis]);
    libm::atan2((tip[direction] - start[direction]).abs(), along.max(0.05 * model.length_m))
}

/// Moment of the end section that resists the push \[N m\].
pub(super) fn section_moment(model: &EndModel, body: &Dynamics, direction: usize) -> f64 {
    let center = section_center(model, body);
    let mut moment = 0.0;
    for e in &model.section_elements {
        if body.blocks.share(*e) == 0.0 {
            continue;
        }
        let force = body.blocks.element_force(*e, &body.x);
        for (local, n) in model.mesh.elements[*e].nodes.iter().enumerate() {
            if model.section_nodes.contains(n) {
                let r: [f64; 3] = std::array::from_fn(|i| body.x[*n][i] - center[i]);
                moment += r[direction] * force[local][model.axis] - r[model.axis] * force[local][direction];
            }
        }
    }
    moment.abs()
}

/// Tip nodes on the line through the centre of the far section across the push direction.
fn center_line(model: &EndModel, direction: usize) -> Vec<usize> {
    let offset = |n: usize| (model.mesh.nodes[n][direction] - model.point_m[direction]).abs();
    let least = model.tip_nodes.iter().map(|(n, _)| offset(*n)).fold(f64::INFINITY, f64::min);
    model.tip_nodes.iter().map(|(n, _)| *n).filter(|n| offset(*n) < least + 1e-9).collect()
}

/// Whether a whole layer of the member has eroded, so that the far section hangs on nothing.
fn is_separated(model: &EndModel, body: &Dynamics) -> bool {
    let mut alive = std::collections::BTreeMap::new();
    for e in &model.own_elements {
        let element = &model.mesh.elements[*e];
        let low =
            element.nodes.map(|n| model.mesh.nodes[n][model.axis]).into_iter().fold(f64::INFINITY, f64::min);
        *alive.entry((low * 1e6).round() as i64).or_insert(false) |= body.blocks.share(*e) > 0.0;
    }
    alive.values().any(|a| !a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pole_of_a_rotation_about_a_known_point() {
        let (c, radius) = (0.31, 1.2);
        let at = |angle: f64| [c + radius * angle.cos(), radius * angle.sin()];
        assert!((pole(at(0.1), at(0.45), 0.35) - c).abs() < 1e-12);
    }

    #[test]
    fn moving_an_envelope_keeps_its_work() {
        let points: Vec<[f64; 2]> = (0..400).map(|i| [1e-4 * f64::from(i), 250e3]).collect();
        let work = |p: &[[f64; 2]]| {
            p.windows(2).map(|w| 0.5 * (w[0][1] + w[1][1]) * (w[1][0] - w[0][0])).sum::<f64>()
        };
        let about = moved(&points, 1.5, 0.3);
        assert!((work(&about) / work(&points) - 1.0).abs() < 1e-3);
    }
}
