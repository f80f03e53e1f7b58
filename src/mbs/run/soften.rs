//! Softer springs in what has come down, so that steps may be longer.
//!
//! Bushings are as stiff along their axes as members are, and columns between two floors vibrate at thousands of rad/s on them, which bounds the explicit step. While a building stands they decide how its loads are
//! shared. Once nearly all of it has moved by decimetres they only hold its parts together, within a millimetre of each other: [`super::relate`] has ended, and what is in the way of steps of [`LARGEST_SOFT_STEP_S`] becomes as soft as
//! they need. A spring keeps its force, so that nothing jumps; the elastic energy that it has more is booked as released.

use super::{LARGEST_SOFT_STEP_S, Run};
use crate::mbs::joint::{JointData, Row};
use crate::mbs::system::System;
use crate::mbs::{frequency, math};

/// Share of the stiffness with which bodies on one spring alone would be as fast as steps allow: a column has one at either end.
const SHARE: f64 = 0.7;
/// Share of the mass that has to have moved. By the mean of all of it storeys below a charged one were softened as what had fallen freely struck them, and columns bore the blow on springs that give more back: of six storeys whose
/// third is blasted (`buildings/mid-storey/mid-07.toml`) the roof was 5.02 m down after 1.4 s for 5.29 m in FE, with this 5.36 m.
const COME_DOWN: f64 = 0.9;
/// By how much longer steps may become at least.
const WORTH_IT: f64 = 1.05;

impl Run<'_> {
    /// Makes springs softer once bodies have moved as far as the model asks for. Forces are known, and stay.
    pub(super) fn soften(&mut self) {
        let Some(distance_m) = self.file.settings.soft_after_m else { return };
        let is_fixed = self.is_soft || self.file.settings.time_step_s.is_some();
        let longest_s = self.share * LARGEST_SOFT_STEP_S;
        let may_gain = self.system.relative.is_none() && WORTH_IT * self.step_limit <= longest_s;
        if is_fixed || !may_gain || !self.has_come_down && !self.have_moved(distance_m) {
            return;
        }
        self.has_come_down = true;
        self.is_soft = true;
        self.end_all_sharing();
        for i in 0..self.system.joints.len() {
            if let Some(soft) = softer(&self.system.joints[i], &self.system) {
                let System { joints, bodies, .. } = &mut self.system;
                self.released -= joints[i].soften(soft, bodies);
            }
        }
        self.system.pack();
        let highest = frequency::highest_rad_s(&mut self.system);
        let step_s = self.share * (frequency::STEP_FRACTION * 2.0 / highest).min(LARGEST_SOFT_STEP_S);
        self.step_limit = self.step_limit.max(step_s);
    }

    /// Whether more than [`COME_DOWN`] of the mass have moved by a distance \[m\].
    fn have_moved(&self, distance_m: f64) -> bool {
        let alive = (0..self.system.count()).filter(|i| self.system.data[*i].alive);
        let (mut whole_kg, mut moved_kg) = (0.0, 0.0);
        for i in alive {
            let own_kg = self.system.data[i].mass;
            whole_kg += own_kg;
            if math::norm(math::sub(self.system.bodies[i].x, self.origin[i])) >= distance_m {
                moved_kg += own_kg;
            }
        }
        moved_kg > COME_DOWN * whole_kg
    }
}

/// Stiffnesses along the axes of a joint with which its bodies are no faster on it than steps allow \[N/m\]; none if they are not. Of a beam that is the one along it: those across are part of its bending.
fn softer(joint: &JointData, system: &System) -> Option<math::V3> {
    if !joint.alive {
        return None;
    }
    let most_rad_s = frequency::STEP_FRACTION * 2.0 / LARGEST_SOFT_STEP_S;
    let rows = joint.rows(&system.bodies);
    let mut soft = joint.translation;
    let axes = if joint.beam.is_some() { 1 } else { 3 };
    for (k, row) in rows[..axes].iter().enumerate() {
        soft[k] = soft[k].min(SHARE * most_rad_s * most_rad_s / inverse_mass(row, system));
    }
    (soft != joint.translation).then_some(soft)
}

/// Inverse of the mass that vibrates on a spring by itself \[1/kg\].
fn inverse_mass(row: &Row, system: &System) -> f64 {
    let of = |i: usize, turn: math::V3| {
        if i == system.count() {
            return 0.0;
        }
        let (body, data) = (&system.bodies[i], &system.data[i]);
        let turn = math::mul_t(&body.r, turn);
        let turned = math::dot(turn, math::mul(&data.inverse_inertia, turn));
        data.inverse_mass * math::dot(row.force, row.force) + turned
    };
    of(row.a, row.turn_a) + of(row.b, row.turn_b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mbs::model::{Body, Bushing, Model, Origin};

    /// Two blocks that lean, on a spring that is stretched along and across its axis.
    fn stretched() -> System {
        let mut m = Model::empty("pair", [0.0; 3], 1.0, 0.1);
        for (i, x) in [0.0, 1.0].into_iter().enumerate() {
            m.bodies.push(Body {
                id: format!("b{i}"),
                mass_kg: 1e3,
                inertia_kg_m2: [[100.0, 0.0, 0.0], [0.0, 150.0, 0.0], [0.0, 0.0, 200.0]],
                position_m: [x, 0.0, 0.0],
                orientation: [0.8, 0.0, 0.6, 0.0],
                velocity_m_s: [0.0; 3],
                angular_velocity_rad_s: [0.0; 3],
                shapes: Vec::new(),
                origin: Origin::default(),
            });
        }
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        m.bushings.push(Bushing {
            axial_stiffness_n_m: 4e9,
            shear_stiffness_n_m: [2e9; 2],
            ..Bushing::free("spring".into(), Some("b0".into()), "b1".into(), [0.5, 0.0, 0.0], axes)
        });
        let mut system = System::new(&m).unwrap();
        let body = &mut system.bodies[1];
        body.x = math::add(body.x, [3e-4, -2e-4, 1e-4]);
        body.rotate([0.0, 1e-4, 0.0]);
        system
    }

    #[test]
    fn a_softer_spring_keeps_its_force_and_stores_what_it_says() {
        let mut system = stretched();
        let soft = softer(&system.joints[0], &system).unwrap();
        let most = frequency::STEP_FRACTION * 2.0 / LARGEST_SOFT_STEP_S;
        // along the axis two masses of 1000 kg, of which each has half of the stretch
        assert!((soft[0] / (SHARE * most * most * 500.0) - 1.0).abs() < 0.1, "{soft:?}");
        let loads = |system: &mut System| {
            system.reset_forces();
            system.add_joint_forces();
            (system.bodies[1].force, system.bodies[1].torque, system.joints[0].elastic_j)
        };
        let before = loads(&mut system);
        let System { joints, bodies, .. } = &mut system;
        let more_j = joints[0].soften(soft, bodies);
        system.pack();
        let after = loads(&mut system);
        let size = math::norm(before.0);
        assert!(size > 1e5);
        assert!(math::norm(math::sub(before.0, after.0)) < 1e-6 * size, "{before:?} {after:?}");
        // forces act at the same point
        assert!(math::norm(math::sub(before.1, after.1)) < 1e-6 * size, "{before:?} {after:?}");
        assert!(
            more_j > 0.0 && (after.2 - before.2 - more_j).abs() < 1e-6 * after.2,
            "{more_j} {before:?} {after:?}"
        );
    }
}
