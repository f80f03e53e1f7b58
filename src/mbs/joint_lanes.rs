//! Joints, eight at a time.
//!
//! Poses and constants of eight joints lie in lanes; kinematics, elastic forces and their moments on the bodies are the functions of [`super::stance`] in loops over lanes, which the compiler turns into vector code.
//! A joint whose angle is not small, or that may flow, crush or break ([`JointData::elastic_range`]), has its law evaluated by itself in between. So all joints give the same bytes as if each were
//! evaluated by [`JointData::apply`] in turn.

use super::joint::{ElasticRange, JointData, Pace, Stride};
use super::lanes::{LANES, Lane, ZERO, get, get_matrix, put};
use super::math::{self, M3};
use super::stance::{self, Chord, Stance};
use super::system::{BodyData, BodyState};
use crate::base::isa::for_each_isa;
use crate::curve::CapacityTable;
use crate::curve::hinge::WELL_INSIDE;

/// Eight joints: what of them the lanes need.
#[derive(Debug, Clone)]
pub(super) struct JointBlock {
    /// Which ones, and their bodies.
    joints: Vec<u32>,
    bodies: [[u32; LANES]; 2],
    points: [[Lane; 3]; 2],
    frames: [[Lane; 4]; 2],
    relative: [Lane; 4],
    translation: [Lane; 3],
    rotation: [Lane; 3],
    outward: Lane,
    crushed: Lane,
    plastic: [Lane; 2],
    lean: [Lane; 2],
    /// What is plastic of the gap across.
    slip: [Lane; 2],
    /// Of beams: whether they bend about axis 2, what a gap across adds to the moments at the ends, and what the load does to the moment in the middle and from there to them.
    bends_about_2: [u64; LANES],
    shear_lever: Lane,
    reach: Lane,
    free: Lane,
    load: [Lane; 2],
    drop: Lane,
    /// Where the joint is elastic.
    force: [Lane; 2],
    inverse_shear2: [Lane; 2],
    ease: [Lane; 2],
    ends: [Lane; 2],
}

/// What a block does in a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Act {
    x: [[Lane; 3]; 2],
    q: [[Lane; 4]; 2],
    frame: [[Lane; 3]; 3],
    arms: [[Lane; 3]; 2],
    gap: [Lane; 3],
    stretch: Lane,
    axis: [Lane; 3],
    arm: [Lane; 3],
    turn: [Lane; 4],
    theta: [Lane; 3],
    local: [Lane; 3],
    moment: [Lane; 3],
    tangent: Lane,
    axial: Lane,
    elastic: Lane,
    /// Of beams: elastic rotation in the middle, moments at the ends.
    sag: Lane,
    ends: [Lane; 2],
    plain: [u64; LANES],
    loads: [[Lane; 3]; 3],
}

impl JointBlock {
    /// The blocks of all intact joints, in their order.
    pub fn all(joints: &[JointData], tables: &[CapacityTable]) -> Vec<Self> {
        let intact: Vec<u32> = (0..joints.len() as u32).filter(|i| joints[*i as usize].alive).collect();
        intact.chunks(LANES).map(|own| Self::of(own, joints, tables)).collect()
    }

    /// The joints in it, in the order of the lanes.
    pub fn joints(&self) -> &[u32] {
        &self.joints
    }

    fn of(own: &[u32], joints: &[JointData], tables: &[CapacityTable]) -> Self {
        let mut block = Self {
            joints: own.to_vec(),
            bodies: [[0; LANES]; 2],
            points: [[ZERO; 3]; 2],
            frames: [[[1.0; LANES], ZERO, ZERO, ZERO]; 2],
            relative: [[1.0; LANES], ZERO, ZERO, ZERO],
            translation: [ZERO; 3],
            rotation: [ZERO; 3],
            outward: [1.0; LANES],
            crushed: ZERO,
            plastic: [ZERO; 2],
            lean: [ZERO; 2],
            slip: [ZERO; 2],
            bends_about_2: [0; LANES],
            shear_lever: ZERO,
            reach: ZERO,
            free: ZERO,
            load: [ZERO; 2],
            drop: ZERO,
            force: [[f64::NEG_INFINITY; LANES], [f64::INFINITY; LANES]],
            inverse_shear2: [ZERO; 2],
            ease: [ZERO; 2],
            ends: [[f64::INFINITY; LANES]; 2],
        };
        for (l, i) in own.iter().enumerate() {
            let joint = &joints[*i as usize];
            for (side, body) in [joint.a, joint.b].into_iter().enumerate() {
                block.bodies[side][l] = body as u32;
                put(&mut block.points[side], l, joint.points[side]);
                put(&mut block.frames[side], l, joint.frames[side]);
            }
            put(&mut block.translation, l, joint.translation);
            put(&mut block.rotation, l, joint.rotation);
            block.outward[l] = joint.outward;
            put(&mut block.relative, l, joint.relative);
            if let Some(beam) = &joint.beam {
                block.bends_about_2[l] = u64::from(beam.axis == 2);
                block.shear_lever[l] = beam.shear_lever_n(joint.translation);
                (block.reach[l], block.free[l]) = (beam.reach_m, beam.free_m);
            }
            put(&mut block.inverse_shear2, l, joint.shear.inverse2);
            block.bear(l, joint);
            block.learn(l, joint, tables);
        }
        block
    }

    /// Takes over what may have changed by the law of a joint.
    #[inline]
    fn learn(&mut self, l: usize, joint: &JointData, tables: &[CapacityTable]) {
        self.crushed[l] = joint.crushed;
        put(&mut self.plastic, l, joint.hinge.plastic_rad);
        put(&mut self.slip, l, joint.shear.slid);
        if let Some(beam) = &joint.beam {
            [self.plastic[beam.axis - 1][l], self.slip[beam.across() - 1][l]] = beam.plastic();
        }
        self.lean(l, joint);
        // what flows will do so in the next step as well
        let range = if joint.flowing || joint.begins_to_flow() { None } else { joint.elastic_range(tables) };
        let ElasticRange { force, ease, ends } = range.unwrap_or(ElasticRange::NONE);
        put(&mut self.force, l, force);
        put(&mut self.ease, l, ease);
        put(&mut self.ends, l, ends);
    }

    /// Takes over what the other end of its member turns a joint by; of a beam that is nothing.
    #[inline]
    pub fn lean(&mut self, l: usize, joint: &JointData) {
        put(&mut self.lean, l, if joint.beam.is_some() { [0.0; 2] } else { joint.lean });
    }

    /// Whether a joint that is no beam is elastic under an axial force \[N\] and moments about its bending axes \[N m\].
    #[inline]
    pub fn is_elastic(&self, l: usize, axial_force_n: f64, moment_nm: [f64; 2]) -> bool {
        let used =
            moment_nm[0] * moment_nm[0] * self.ease[0][l] + moment_nm[1] * moment_nm[1] * self.ease[1][l];
        axial_force_n >= self.force[0][l] && axial_force_n < self.force[1][l] && used < WELL_INSIDE
    }

    /// Takes over how much of its weight a beam bears.
    #[inline]
    pub fn bear(&mut self, l: usize, joint: &JointData) {
        if let Some(beam) = &joint.beam {
            let load = beam.load();
            (self.load[beam.axis - 1][l], self.drop[l]) = (load.middle_nm, load.drop_nm);
        }
    }

    /// Kinematics and, where a joint is plain, its law.
    #[inline(always)]
    fn look(&self, act: &mut Act) {
        for l in 0..LANES {
            let (qa, qb) = (get(&act.q[0], l), get(&act.q[1], l));
            let (ra, rb) = (math::qmat(qa), math::qmat(qb));
            let poses = [(get(&act.x[0], l), qa, &ra), (get(&act.x[1], l), qb, &rb)];
            let points = [get(&self.points[0], l), get(&self.points[1], l)];
            let frames = [get(&self.frames[0], l), get(&self.frames[1], l)];
            let Stance { frame, arms, gap, turn } =
                stance::stance(poses, points, frames, get(&self.relative, l));
            let axis = [turn[1], turn[2], turn[3]];
            let sine2 = math::dot(axis, axis);
            let (theta, tangent) = stance::bend_by(math::log_factor(sine2, turn[0]), turn);
            put(&mut act.gap, l, gap);
            let chord = Chord::new(gap, turn, self.reach[l], self.free[l]);
            act.stretch[l] = chord.stretch;
            put(&mut act.axis, l, chord.axis);
            put(&mut act.arm, l, chord.arm);
            let along = chord.stretch - self.crushed[l];
            let k = get(&self.translation, l);
            let axial = -self.outward[l] * k[0] * along;
            let gap = [along, gap[1] - self.slip[0][l], gap[2] - self.slip[1][l]];
            let local = [k[0] * gap[0], k[1] * gap[1], k[2] * gap[2]];
            let own = [theta[1] - self.lean[0][l], theta[2] - self.lean[1][l]];
            let e = [own[0] - self.plastic[0][l], own[1] - self.plastic[1][l]];
            let bent = [self.rotation[1][l] * e[0], self.rotation[2][l] * e[1]];
            let moment =
                [self.rotation[0][l] * theta[0], bent[0] + self.load[0][l], bent[1] + self.load[1][l]];
            let about_2 = self.bends_about_2[l] != 0;
            let (sag, middle, across) =
                if about_2 { (e[1], moment[2], gap[1]) } else { (e[0], moment[1], gap[2]) };
            let (middle, of_shear) = (middle - self.drop[l], self.shear_lever[l] * across);
            let ends = [middle - of_shear, middle + of_shear];
            let used = bent[0] * bent[0] * self.ease[0][l] + bent[1] * bent[1] * self.ease[1][l];
            let sheared2 = local[1] * local[1] * self.inverse_shear2[0][l]
                + local[2] * local[2] * self.inverse_shear2[1][l];
            let stretch = math::dot(local, gap);
            act.elastic[l] = 0.5 * (bent[0] * e[0] + bent[1] * e[1]) + 0.5 * (stretch + moment[0] * theta[0]);
            act.axial[l] = axial;
            let inside = (axial >= self.force[0][l]) & (axial < self.force[1][l]) & (used < WELL_INSIDE);
            let inside = inside
                & (sheared2 < WELL_INSIDE)
                & (ends[0].abs() < self.ends[0][l])
                & (ends[1].abs() < self.ends[1][l]);
            act.sag[l] = sag;
            put(&mut act.ends, l, ends);
            act.plain[l] = u64::from(inside & (turn[0] > math::LOG_NEAR));
            act.tangent[l] = tangent;
            put(&mut act.frame[0], l, frame[0]);
            put(&mut act.frame[1], l, frame[1]);
            put(&mut act.frame[2], l, frame[2]);
            put(&mut act.arms[0], l, arms[0]);
            put(&mut act.arms[1], l, arms[1]);
            put(&mut act.turn, l, turn);
            put(&mut act.theta, l, theta);
            put(&mut act.local, l, local);
            put(&mut act.moment, l, moment);
        }
    }
}

impl Act {
    /// Forces and moments on the bodies.
    #[inline(always)]
    fn load(&mut self) {
        for l in 0..LANES {
            let frame: M3 = get_matrix(&self.frame, l);
            let arms = [get(&self.arms[0], l), get(&self.arms[1], l)];
            let (theta, local, moment) = (get(&self.theta, l), get(&self.local, l), get(&self.moment, l));
            let force = self.chord(l).force(local);
            let all = stance::loads(&frame, arms, theta, force, moment, self.tangent[l]);
            put(&mut self.loads[0], l, all[0]);
            put(&mut self.loads[1], l, all[1]);
            put(&mut self.loads[2], l, all[2]);
        }
    }

    #[inline(always)]
    fn chord(&self, l: usize) -> Chord {
        Chord { stretch: self.stretch[l], axis: get(&self.axis, l), arm: get(&self.arm, l) }
    }

    fn stance(&self, l: usize) -> Stance {
        Stance {
            frame: get_matrix(&self.frame, l),
            arms: [get(&self.arms[0], l), get(&self.arms[1], l)],
            gap: get(&self.gap, l),
            turn: get(&self.turn, l),
        }
    }
}

for_each_isa! {
    /// Adds the forces of all joints in blocks to their bodies and advances their histories; joints between bodies at rest are left out. Whether any of them may have flowed or broken.
    pub(super) fn apply_all = apply_any(
        blocks: &mut [JointBlock],
        joints: &mut [JointData],
        bodies: &mut [BodyState],
        data: &[BodyData],
        tables: &[CapacityTable],
        stride: Stride,
        act: &mut Act,
    ) -> bool
}

#[inline(always)]
fn apply_any(
    blocks: &mut [JointBlock],
    joints: &mut [JointData],
    bodies: &mut [BodyState],
    data: &[BodyData],
    tables: &[CapacityTable],
    stride: Stride,
    act: &mut Act,
) -> bool {
    let mut eventful = false;
    for block in blocks {
        for side in 0..2 {
            for l in 0..LANES {
                let body = &bodies[block.bodies[side][l] as usize];
                put(&mut act.x[side], l, body.x);
                put(&mut act.q[side], l, body.q);
            }
        }
        block.look(act);
        for l in 0..block.joints.len() {
            let joint = &mut joints[block.joints[l] as usize];
            if rests(joint, data) {
                continue;
            }
            joint.flowing = false;
            put(&mut block.relative, l, get(&act.turn, l));
            if act.plain[l] == 0 {
                eventful = true;
                joint.expect(stride);
                yield_alone(joint, act, l, tables);
                block.learn(l, joint, tables);
            } else {
                joint.pace = Pace::Steps;
                joint.relative = get(&act.turn, l);
                joint.theta = get(&act.theta, l);
                joint.axial_force = act.axial[l];
                joint.shear.force = [act.local[1][l], act.local[2][l]];
                joint.elastic_j = act.elastic[l];
                joint.hinge.moment_nm = [act.moment[1][l], act.moment[2][l]];
                if let Some(beam) = &mut joint.beam {
                    let load = beam.load();
                    (beam.chord, beam.gap) = (act.chord(l), get(&act.gap, l));
                    beam.against_load_j += beam.ends.stay(act.sag[l], get(&act.ends, l), load);
                }
            }
        }
        act.load();
        for (l, i) in block.joints.iter().enumerate() {
            if rests(&joints[*i as usize], data) {
                continue;
            }
            let force = get(&act.loads[0], l);
            let a = &mut bodies[block.bodies[0][l] as usize];
            a.force = math::add(a.force, force);
            a.torque = math::add(a.torque, get(&act.loads[1], l));
            let b = &mut bodies[block.bodies[1][l] as usize];
            b.force = math::sub(b.force, force);
            b.torque = math::sub(b.torque, get(&act.loads[2], l));
        }
    }
    eventful
}

/// Whether neither body of a joint moves.
#[inline(always)]
fn rests(joint: &JointData, data: &[BodyData]) -> bool {
    let still = |i: usize| i + 1 == data.len() || data[i].asleep;
    still(joint.a) && still(joint.b)
}

/// The law of one joint.
#[inline(never)]
fn yield_alone(joint: &mut JointData, act: &mut Act, l: usize, tables: &[CapacityTable]) {
    let at = act.stance(l);
    let (theta, tangent) = stance::bend(at.turn);
    let [local, moment] = joint.resist(&at, &act.chord(l), theta, tables);
    act.tangent[l] = tangent;
    put(&mut act.theta, l, theta);
    put(&mut act.local, l, local);
    put(&mut act.moment, l, moment);
}

#[cfg(test)]
mod tests {
    use super::super::math;
    use super::super::model::{Beam, Bending, Body, Bushing, Model, Origin, Span};
    use super::super::step;
    use super::super::system::System;
    use crate::base::isa::Isa;
    use crate::curve::{CapacityLevel, ResistanceCurve};

    /// Eleven columns, one on top of the other, that fall over; some of their joints are beams with hinges at their ends, some of those with a weight.
    fn chain() -> Model {
        let mut m = Model::empty("chain", [1.0, 2.0, -9.81], 1.0, 0.1);
        let level = |axial_force_n: f64, peak: f64| CapacityLevel {
            axial_force_n,
            capacity: vec![[0.0, peak], [0.1, 1.2 * peak], [0.6, 0.1 * peak]],
            fracture_rotation_rad: 2.0,
        };
        let levels = vec![level(0.0, 4e3), level(2e5, 9e3)];
        m.curves.insert("c".into(), ResistanceCurve { stiffness_nm_rad: 1e6, levels, cyclic: None });
        for i in 0..11 {
            m.bodies.push(Body {
                id: format!("b{i}"),
                mass_kg: 1e3,
                inertia_kg_m2: [[900.0, 10.0, 0.0], [10.0, 800.0, 0.0], [0.0, 0.0, 100.0]],
                position_m: [0.0, 0.0, 1.5 + 3.0 * f64::from(i)],
                orientation: [1.0, 0.0, 0.0, 0.0],
                velocity_m_s: [0.0; 3],
                angular_velocity_rad_s: if i == 10 {
                    [0.0, 20.0, 0.0]
                } else {
                    [0.1 * f64::from(i), 0.0, 0.2]
                },
                shapes: Vec::new(),
                origin: Origin::default(),
            });
            let curve = Bending::Curve { curve: "c".into(), strength_factor: 1.0 + 0.1 * f64::from(i) };
            let soft = Bending::Elastic { stiffness_nm_rad: 2e4 };
            let ends = [format!("e{i}"), format!("f{i}")];
            let span = (i < 6).then_some(Span { length_m: 3.0, mass_kg_m: 2e2 });
            let beam = (i % 3 == 0).then_some(Beam { half_length_m: 1.2, ends, span });
            m.bushings.push(Bushing {
                axial_stiffness_n_m: 1e8,
                shear_stiffness_n_m: [1e8; 2],
                torsional_stiffness_nm_rad: 1e5,
                bending: match i % 6 {
                    0 => [soft, curve],
                    3 => [curve, soft],
                    _ => [curve.clone(), curve],
                },
                beam,
                tensile_capacity_n: Some(2e5),
                shear_capacity_n: Some([2e5, 3e5]),
                compressive_capacity_n: Some(3e5),
                associated_flow: true,
                tensile_elongation_m: Some(0.5),
                ..Bushing::free(
                    format!("j{i}"),
                    (i > 0).then(|| format!("b{}", i - 1)),
                    format!("b{i}"),
                    [0.0, 0.0, 3.0 * f64::from(i)],
                    [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
                )
            });
        }
        m
    }

    #[test]
    fn eight_at_a_time_is_one_after_the_other_byte_for_byte() {
        let h = 1e-3;
        let mut alone = System::new(&chain()).unwrap();
        alone.joints.iter_mut().for_each(|joint| joint.lean = [1e-4, -2e-4]);
        alone.pack();
        let mut together = vec![alone.clone(); Isa::available().count()];
        together.iter_mut().zip(Isa::available()).for_each(|(system, isa)| system.isa = isa);
        let (mut eventful, mut largest) = (0, 0.0_f64);
        for _ in 0..2000 {
            alone.reset_forces();
            let stride = alone.stride();
            for joint in &mut alone.joints {
                joint.expect(stride);
                joint.apply(&mut alone.bodies, &alone.tables);
            }
            let n = alone.count();
            for (body, data) in alone.bodies[..n].iter_mut().zip(&alone.data) {
                step::push(body, h);
                step::find_velocities(body, data, h);
            }
            step::drift(&mut alone, h);
            for system in &mut together {
                system.reset_forces();
                eventful += usize::from(system.add_joint_forces());
                step::kick(system, h, h);
                step::drift(system, h);
                assert_eq!(system.bodies[..n], alone.bodies[..n]);
            }
            largest = alone.joints.iter().fold(largest, |m, j| m.max(math::norm(j.theta)));
        }
        for system in &together {
            for (a, b) in system.joints.iter().zip(&alone.joints) {
                assert_eq!((a.hinge.dissipated_j, a.crush_j), (b.hinge.dissipated_j, b.crush_j));
                assert_eq!((a.elastic_j, a.axial_force, a.theta), (b.elastic_j, b.axial_force, b.theta));
                let of_beam = |j: &super::JointData| j.beam.as_ref().map(|b| (b.ends, b.against_load_j));
                assert_eq!(of_beam(a), of_beam(b));
            }
        }
        // All cases have been there: elastic and flowing steps, small and large angles.
        assert!(eventful > 100 && eventful < 2000 * together.len(), "{eventful}");
        let turned = |j: &super::JointData| j.beam.as_ref().is_some_and(|b| b.ends.plastic_rad() != 0.0);
        assert!(alone.joints.iter().any(turned));
        assert!(largest > 2.4 && alone.joints.iter().any(|j| j.crush_j > 0.0), "{largest}");
    }
}
