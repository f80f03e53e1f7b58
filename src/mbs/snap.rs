//! Separation of a bushing within a step, at the time at which its capacity is reached, not at the end of the step.
//!
//! The leapfrog has given its force at the start of the step to the half of it, and would give that at the end, which is beyond what it bears, to half a step behind. With forces that grow in proportion to the stretch, which the
//! velocities of the step tell, the capacity is reached at a share `s` of the step; until then the force has done the impulse `h (s F_0 + s² ΔF / 2)`, of which `h F_0 / 2` is given. The elastic energy set free is that at `s`. A hinge or an axial spring that flows does so at its capacity, from
//! where it reached it in the step ([`Course`]), and the share of its flow that is beyond fracture tells `s`. Moments are treated likewise: elastic ones grow in proportion, one of a hinge that flows is as at the end of the step. Of a beam the moments at its ends do so, and those in its middle and the shear follow from them.

use super::joint::JointData;
use super::math::{self, V3};
use super::mid_beam::MidBeam;
use super::stance::{bend, loads, torque};
use super::system::BodyState;
use crate::curve::onset::Course;

/// What is left to do for a bushing that has separated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Snap {
    /// How long before the end of the step it did \[s\].
    pub early_s: f64,
    /// Impulse on the first body and angular impulses on both about their centres of mass (the second one feels the opposite) \[N s, N m s\].
    pub impulse: [V3; 3],
    /// The elastic energy that it had \[J\].
    pub elastic_j: f64,
    /// What its hinge has dissipated beyond fracture, and its axial spring \[J\].
    pub beyond_j: [f64; 2],
    /// The same of the work against the load of a beam \[J\].
    pub against_load_j: f64,
}

impl Snap {
    /// Of a bushing that has separated by the end of a step of `h` \[s\].
    pub fn of(joint: &JointData, bodies: &[BodyState], h: f64) -> Self {
        let at = joint.stance(bodies);
        let [a, b] = [joint.a, joint.b].map(|i| &bodies[i]);
        let chord = joint.chord(&at);
        let moves = |body: &BodyState, arm: V3| math::add(body.v, math::cross(body.w, arm));
        let opens = |off: V3| {
            let to = at.arms.map(|arm| math::add(arm, off));
            math::mul_t(&at.frame, math::sub(moves(b, to[1]), moves(a, to[0])))
        };
        let across = opens([0.0; 3]);
        let along = math::dot(chord.axis, opens(math::mul(&at.frame, chord.arm)));
        let speed = [along, across[1], across[2]];
        let end = joint.latest();
        let way = math::scale(h, speed);
        let mut along: [Course; 3] = std::array::from_fn(|k| {
            Course::elastic(end.along[k] - joint.translation[k] * way[k], end.along[k])
        });
        let is_stretching = joint.is_stretching();
        if is_stretching {
            along[0] = joint.course.times(-joint.outward);
        }
        if let Some(beam) = &joint.beam {
            let k = beam.across();
            let begin = beam.of_ends(beam.ends.ends.map(|e| e.course.at(0.0)))[1];
            along[k] = Course::elastic(begin, end.along[k]);
        }
        let slips = joint.shear.course();
        if let Some((courses, _)) = slips {
            [along[1], along[2]] = courses;
        }
        let overrun_m = joint.overrun_m();
        let stretched_beyond = overrun_m / (h * speed[0].abs()).max(overrun_m).max(f64::MIN_POSITIVE);
        let within = joint.broke_at().min(1.0 - stretched_beyond).min(slips.map_or(1.0, |(_, share)| share));
        let share = share(joint, &along, is_stretching).clamp(0.0, within);
        let (theta, c) = bend(at.turn);
        let turn: V3 = std::array::from_fn(|k| {
            let mut unit = [0.0; 3];
            unit[k] = 1.0;
            h * math::dot(torque(&at.frame, theta, unit, c), math::sub(b.w, a.w))
        });
        let mut torn = Torn::of(joint, end.moment, turn, share);
        let (mut left, mut force) = (along.map(|f| f.left(share)), along.map(|f| f.at(share)));
        if let Some(beam) = &joint.beam {
            let k = beam.across();
            [left[k], force[k]] = torn.bend(beam, joint.rotation[beam.axis], end.moment[beam.axis], share);
            torn.undone_j += turn[beam.axis] * (0.5 * end.moment[beam.axis] - torn.left[beam.axis]);
            torn.undone_j += way[k] * (0.5 * end.along[k] - left[k]);
        }
        let stretched_j = |k: usize, f: f64| {
            if joint.translation[k] > 0.0 { 0.5 * f * f / joint.translation[k] } else { 0.0 }
        };
        let set_free_j: V3 = std::array::from_fn(|k| stretched_j(k, end.along[k]) - stretched_j(k, force[k]));
        let sheared_j = joint.beam.as_ref().map_or(0.0, |beam| set_free_j[beam.across()]);
        let flows = [is_stretching, slips.is_some(), slips.is_some()];
        let undone = |k: usize| if flows[k] { along[k].undone_j(share, way[k]) - set_free_j[k] } else { 0.0 };
        let [local, moment] = [left, torn.left].map(|of| math::scale(h, of));
        Self {
            early_s: h * (1.0 - share),
            impulse: loads(&at.frame, at.arms, theta, chord.force(local), moment, c),
            elastic_j: joint.elastic_j - set_free_j.iter().sum::<f64>() - torn.elastic_j,
            beyond_j: [
                torn.undone_j - torn.elastic_j - torn.against_load_j - sheared_j,
                (0..3).map(undone).sum(),
            ],
            against_load_j: torn.against_load_j,
        }
    }
}

/// What moments have left to do at a share of a step at which their bushing separates.
struct Torn {
    /// Their impulses over the length of the step, less what was given \[N m\].
    left: V3,
    /// Of the work that they would do in a whole step, what is left undone \[J\].
    undone_j: f64,
    /// By how much the elastic energy, and the work against the load of a beam, are smaller than at the end of the step \[J\]. The rest of that work is not dissipated.
    elastic_j: f64,
    against_load_j: f64,
}

impl Torn {
    /// For the moments at the end of a step \[N m\] that turns it so about its axes \[rad\], but for that in the middle of a beam.
    fn of(joint: &JointData, end: V3, turn: V3, share: f64) -> Self {
        let mut torn = Self { left: [0.0; 3], undone_j: 0.0, elastic_j: 0.0, against_load_j: 0.0 };
        let bent = joint.beam.as_ref().map(|beam| beam.axis);
        for k in (0..3).filter(|k| bent != Some(*k) && joint.rotation[*k] > 0.0) {
            let flow = if k > 0 { joint.hinge.flow_rad[k - 1] } else { 0.0 };
            let (stiffness, from) = (joint.rotation[k], joint.hinge.begins);
            let begin = end[k] - stiffness * (turn[k] - flow);
            let course = if flow == 0.0 {
                Course::elastic(begin, end[k])
            } else {
                let onset = [from, begin + from * stiffness * turn[k]];
                Course::flowing(begin, end[k], flow, (from > 0.0).then_some(onset))
            };
            torn.left[k] = course.left(share);
            torn.undone_j += course.undone_j(share, turn[k]);
            torn.elastic_j += 0.5 * (end[k] * end[k] - course.at(share).powi(2)) / stiffness;
        }
        torn
    }

    /// Adds those of a beam with a stiffness \[N m/rad\] and a moment \[N m\] in its middle, but for the work; what its shear has left to do over the length of the step, and how large it is at its share \[N\].
    fn bend(&mut self, beam: &MidBeam, stiffness: f64, end: f64, share: f64) -> [f64; 2] {
        let (courses, load) = (beam.ends.ends.map(|e| e.course), beam.load());
        let [bends, shears] = beam.of_ends(courses.map(|c| c.left(share)));
        let [bent, sheared] = beam.of_ends(courses.map(|c| c.at(share)));
        self.left[beam.axis] = bends + (share - 0.5) * load.drop_nm;
        let elastic_rad = |moment: f64| (moment - load.middle_nm) / stiffness;
        let (then, now) = (elastic_rad(bent + load.drop_nm), elastic_rad(end));
        self.elastic_j += 0.5 * stiffness * (now * now - then * then);
        let flow: f64 = courses.iter().map(|c| c.flow_after(share)).sum();
        self.against_load_j += load.middle_nm * (now - then) + load.drop_nm * flow;
        [shears, sheared]
    }
}

/// Share of the step at which the forces along the axes reach a capacity; along the first one not if its spring flows.
fn share(joint: &JointData, along: &[Course; 3], is_stretching: bool) -> f64 {
    let begin = along.map(|f| f.at(0.0));
    let change: V3 = std::array::from_fn(|k| along[k].at(1.0) - begin[k]);
    let [from, grows] = [begin, change].map(|f| joint.outward * f[0]);
    let pulled = if !is_stretching && from + grows > joint.tensile_capacity {
        (joint.tensile_capacity - from) / grows.max(f64::MIN_POSITIVE)
    } else {
        f64::INFINITY
    };
    pulled.min(joint.shear.parts_at([along[1], along[2]]))
}
