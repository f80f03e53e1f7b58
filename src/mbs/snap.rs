//! A bushing that separates does so within a step, not at its end.
//!
//! The leapfrog has given its force at the begin of the step to the half of it, and would give that at the end, which is beyond what it bears, to half a step behind. With forces that grow in proportion to the stretch, which the
//! velocities of the step tell, the capacity is reached at a share `s` of the step; until then the force has done the impulse `h (s F_0 + s² ΔF / 2)`, of which `h F_0 / 2` is given. The elastic energy set free is that at `s`. A hinge or an axial spring that flows does so at its capacity, and the share of its flow in the step that is beyond fracture tells `s`. Moments are treated likewise: elastic ones grow in proportion, one of a hinge that flows is as at the end of the step.

use super::joint::JointData;
use super::math::{self, V3};
use super::stance::{bend, loads, torque};
use super::system::BodyState;

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
        let mut change: V3 = std::array::from_fn(|k| h * joint.translation[k] * speed[k]);
        if joint.is_stretching() {
            change[0] = 0.0;
        }
        let begin = math::sub(end.along, change);
        let overrun_m = joint.overrun_m();
        let stretched_beyond = overrun_m / (h * speed[0].abs()).max(overrun_m).max(f64::MIN_POSITIVE);
        let within = (1.0 - joint.hinge.beyond).min(1.0 - stretched_beyond);
        let share = share(joint, begin, change).clamp(0.0, within);
        let force = |s: f64| math::axpy(begin, s, change);
        let given = math::scale(-0.5, begin);
        let local = math::scale(h, math::axpy(given, share, force(0.5 * share)));
        let (theta, c) = bend(at.turn);
        let turn: V3 = std::array::from_fn(|k| {
            let mut unit = [0.0; 3];
            unit[k] = 1.0;
            h * math::dot(torque(&at.frame, theta, unit, c), math::sub(b.w, a.w))
        });
        let hinge = Torn::of(joint, end.moment, turn, share);
        let stretched_j = |f: V3| {
            let stiff = (0..3).filter(|k| joint.translation[*k] > 0.0);
            stiff.map(|k| 0.5 * f[k] * f[k] / joint.translation[k]).sum::<f64>()
        };
        let moment = math::scale(h, hinge.mean);
        Self {
            early_s: h * (1.0 - share),
            impulse: loads(&at.frame, at.arms, theta, chord.force(local), moment, c),
            elastic_j: joint.elastic_j - stretched_j(end.along) + stretched_j(force(share)) - hinge.elastic_j,
            beyond_j: [hinge.plastic_j, joint.axial_force.abs() * overrun_m],
        }
    }
}

/// What moments have left to do at a share of a step at which their bushing separates.
struct Torn {
    /// Their impulses over the length of the step, less what was given \[N m\].
    mean: V3,
    /// By how much elastic and dissipated energy are smaller than at the end of the step \[J\].
    elastic_j: f64,
    plastic_j: f64,
}

impl Torn {
    /// For the moments at the end of a step \[N m\] that turns it so about its axes \[rad\]: elastic ones grow in proportion, one of a hinge that flows is as at the end. What has snapped back within the step was stored, so that only the flow counts that it went on with at that moment.
    fn of(joint: &JointData, end: V3, turn: V3, share: f64) -> Self {
        let mut torn = Self { mean: [0.0; 3], elastic_j: 0.0, plastic_j: 0.0 };
        let left = 1.0 - share;
        for k in 0..3 {
            let flow = if k > 0 { joint.hinge.flow_rad[k - 1] } else { 0.0 };
            let in_beam = joint.beam.as_ref().is_some_and(|beam| beam.axis == k);
            let stiffness = joint.rotation[k];
            if flow != 0.0 || in_beam || stiffness == 0.0 {
                torn.mean[k] = (share - 0.5) * end[k];
                torn.plastic_j += left * end[k] * flow;
                torn.elastic_j += left * end[k] * (turn[k] - flow);
            } else {
                let change = stiffness * turn[k];
                let (begin, then) = (end[k] - change, end[k] - left * change);
                torn.mean[k] = 0.5 * share * (begin + then) - 0.5 * begin;
                torn.elastic_j += 0.5 * (end[k] * end[k] - then * then) / stiffness;
            }
        }
        torn
    }
}

/// Share of the step at which the force along the axes, `begin` and its `change` \[N\], reaches a capacity.
fn share(joint: &JointData, begin: V3, change: V3) -> f64 {
    let [from, grows] = [begin, change].map(|f| joint.outward * f[0]);
    let pulled = if from + grows > joint.tensile_capacity {
        (joint.tensile_capacity - from) / grows.max(f64::MIN_POSITIVE)
    } else {
        f64::INFINITY
    };
    // the ellipse of the shear forces: a s² + b s + c = 0
    let product = |f: V3, g: V3| (0..2).map(|k| joint.shear_ease[k] * f[k + 1] * g[k + 1]).sum::<f64>();
    let (a, b, c) = (product(change, change), 2.0 * product(begin, change), product(begin, begin) - 1.0);
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
    let sheared = if a + b + c < 0.0 || a == 0.0 { f64::INFINITY } else { (root - b) / (2.0 * a) };
    pulled.min(sheared)
}
