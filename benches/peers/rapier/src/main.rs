//! A model file in Rapier, double precision: maximal coordinates, impulse joints, hinges as torques that are held over a step.
//!
//! usage: peer-rapier MODEL PATH|- STEP SUBSTEPS
//! PATH is the table of the known path (its times are the outputs). With `-` the model runs to its end, and the deepest penetration of the last second is told.
//! Prints one line of JSON: processor time, places of the first tracked point, energies, penetration.

use cpu_time::ProcessTime;
use rapier3d_f64::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A hinge of the model file.
struct Hinge {
    bodies: [Option<RigidBodyHandle>; 2],
    start: Rotation,
    stiffness: f64,
    capacity: Vec<[f64; 2]>,
    fracture: f64,
    joint: Option<ImpulseJointHandle>,
    plastic: [f64; 3],
    largest: [f64; 3],
    elastic: f64,
    broken: bool,
}

/// A spring between two points.
struct Spring {
    bodies: [Option<RigidBodyHandle>; 2],
    points: [Vector; 2],
    law: [f64; 3],
}

struct Scene {
    world: PhysicsWorld,
    hinges: Vec<Hinge>,
    springs: Vec<Spring>,
    torques: Vec<(RigidBodyHandle, Vector)>,
    point: Option<(RigidBodyHandle, Vector)>,
}

fn vector(v: &Value) -> Vector {
    let at = |i: usize| v[i].as_f64().unwrap_or(0.0);
    Vector::new(at(0), at(1), at(2))
}

fn rotation(q: &Value) -> Rotation {
    let at = |i: usize| q[i].as_f64().unwrap_or(f64::from(u8::from(i == 0)));
    Rotation::from_xyzw(at(1), at(2), at(3), at(0)).normalize()
}

fn list(v: &Value) -> &[Value] {
    v.as_array().map_or(&[], Vec::as_slice)
}

fn turn(world: &PhysicsWorld, body: Option<RigidBodyHandle>) -> Rotation {
    body.map_or(Rotation::IDENTITY, |b| *world.bodies[b].rotation())
}

fn scene(model: &Value, step: f64, substeps: usize, touching: bool) -> Scene {
    let mut world = PhysicsWorld::new();
    world.gravity = vector(&model["gravity_m_s2"]);
    let p = &mut world.integration_parameters;
    p.dt = step;
    p.num_solver_iterations = substeps;
    p.warmstart_joints = true;
    p.contact_recycling = false;
    let ground = world.bodies.insert(RigidBodyBuilder::fixed());
    let mut handles = BTreeMap::new();
    let touches = !model["contact"]["bodies"].is_null();
    for b in list(&model["bodies"]) {
        let m = &b["inertia_kg_m2"];
        let column = |j: usize| Vector::new(m[0][j].as_f64().unwrap(), m[1][j].as_f64().unwrap(), m[2][j].as_f64().unwrap());
        let inertia = Matrix::from_cols(column(0), column(1), column(2));
        let diagonal = Vector::new(inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z);
        let mass = b["mass_kg"].as_f64().unwrap();
        let flat = Matrix::from_diagonal(diagonal) == inertia;
        let properties = if flat {
            MassProperties::new(Vector::ZERO, mass, diagonal)
        } else {
            MassProperties::with_inertia_matrix(Vector::ZERO, mass, inertia)
        };
        let body = RigidBodyBuilder::dynamic()
            .pose(Pose::from_parts(vector(&b["position_m"]), rotation(&b["orientation"])))
            .linvel(vector(&b["velocity_m_s"]))
            .angvel(vector(&b["angular_velocity_rad_s"]))
            .additional_mass_properties(properties)
            .gyroscopic_forces_enabled(true)
            .can_sleep(false);
        let handle = world.bodies.insert(body);
        handles.insert(b["id"].as_str().unwrap().to_string(), handle);
        for shape in list(&b["shapes"]).iter().filter(|_| touching) {
            let half = vector(&shape["half_extents_m"]);
            let groups = InteractionGroups::new(
                Group::GROUP_1,
                if touches { Group::ALL } else { Group::GROUP_2 },
                InteractionTestMode::And,
            );
            let collider = ColliderBuilder::cuboid(half.x, half.y, half.z)
                .translation(vector(&shape["center_m"]))
                .density(0.0)
                .friction(0.5)
                .collision_groups(groups);
            world.colliders.insert_with_parent(collider, handle, &mut world.bodies);
        }
    }
    if touching && !model["contact"]["ground"].is_null() {
        let level = model["contact"]["ground"]["level_m"].as_f64().unwrap();
        let friction = model["contact"]["ground"]["friction"].as_f64().unwrap();
        let groups = InteractionGroups::new(Group::GROUP_2, Group::ALL, InteractionTestMode::And);
        let floor = ColliderBuilder::cuboid(100.0, 100.0, 1.0)
            .translation(Vector::new(0.0, 0.0, level - 1.0))
            .friction(friction)
            .collision_groups(groups);
        world.colliders.insert_with_parent(floor, ground, &mut world.bodies);
    }
    // masses count from the first step on unless asked for
    for (_, own) in world.bodies.iter_mut() {
        own.recompute_mass_properties_from_colliders(&world.colliders);
    }
    let body = |v: &Value| v.as_str().map(|id| handles[id]);
    let mut joints = BTreeMap::new();
    for j in list(&model["joints"]) {
        let ends = [body(&j["body_a"]).unwrap_or(ground), body(&j["body_b"]).unwrap()];
        let at = vector(&j["point_m"]);
        let local = |world: &PhysicsWorld, b: RigidBodyHandle, p: Vector| {
            let own = &world.bodies[b];
            own.rotation().inverse() * (p - own.translation())
        };
        let data: GenericJoint = match j["kind"].as_str().unwrap() {
            "revolute" => {
                let axis = vector(&j["axis"]).normalize();
                let along = ends.map(|b| world.bodies[b].rotation().inverse() * axis);
                let built = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES).local_axis1(along[0]).local_axis2(along[1]);
                built.local_anchor1(local(&world, ends[0], at)).local_anchor2(local(&world, ends[1], at)).build()
            }
            "spherical" => GenericJointBuilder::new(JointAxesMask::LOCKED_SPHERICAL_AXES)
                .local_anchor1(local(&world, ends[0], at))
                .local_anchor2(local(&world, ends[1], at))
                .build(),
            "rod" => {
                let end = vector(&j["point_b_m"]);
                let rope = RopeJointBuilder::new((end - at).length());
                rope.local_anchor1(local(&world, ends[0], at)).local_anchor2(local(&world, ends[1], end)).build().into()
            }
            other => panic!("no joint of kind {other}"),
        };
        let handle = world.impulse_joints.insert(ends[0], ends[1], data, true);
        joints.insert(j["id"].as_str().unwrap().to_string(), handle);
    }
    let mut s = Scene { world, hinges: Vec::new(), springs: Vec::new(), torques: Vec::new(), point: None };
    for f in list(&model["forces"]) {
        let bodies = [body(&f["body_a"]), body(&f["body_b"])];
        match f["kind"].as_str().unwrap() {
            "hinge" => s.hinges.push(Hinge {
                bodies,
                start: turn(&s.world, bodies[0]).inverse() * turn(&s.world, bodies[1]),
                stiffness: f["stiffness_nm_rad"].as_f64().unwrap(),
                capacity: list(&f["capacity"]).iter().map(|p| [p[0].as_f64().unwrap(), p[1].as_f64().unwrap()]).collect(),
                fracture: f["fracture_rad"].as_f64().unwrap_or(f64::INFINITY),
                joint: f["joint"].as_str().map(|id| joints[id]),
                plastic: [0.0; 3],
                largest: [0.0; 3],
                elastic: 0.0,
                broken: false,
            }),
            "spring" => {
                let local = |b: Option<RigidBodyHandle>, p: Vector| {
                    b.map_or(p, |b| s.world.bodies[b].rotation().inverse() * (p - s.world.bodies[b].translation()))
                };
                let points = [local(bodies[0], vector(&f["point_a_m"])), local(bodies[1], vector(&f["point_b_m"]))];
                let law = ["length_m", "stiffness_n_m", "damping_n_s_m"].map(|k| f[k].as_f64().unwrap());
                s.springs.push(Spring { bodies, points, law });
            }
            "torque" => s.torques.push((body(&f["body"]).unwrap(), vector(&f["torque_nm"]))),
            other => panic!("no force of kind {other}"),
        }
    }
    if let Some(t) = list(&model["tracked"]).first() {
        let b = body(&t["body"]).unwrap();
        let own = &s.world.bodies[b];
        s.point = Some((b, own.rotation().inverse() * (vector(&t["point_m"]) - own.translation())));
    }
    s
}

fn interpolate(points: &[[f64; 2]], x: f64) -> f64 {
    for pair in points.windows(2) {
        let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
        if x <= x1 {
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0);
        }
    }
    points.last().map_or(0.0, |p| p[1])
}

impl Scene {
    fn forces(&mut self) {
        let loaded = self.hinges.iter().any(|h| !h.broken) || !self.springs.is_empty() || !self.torques.is_empty();
        if !loaded {
            return;
        }
        for (_, body) in self.world.bodies.iter_mut() {
            body.reset_forces(false);
            body.reset_torques(false);
        }
        for h in self.hinges.iter_mut().filter(|h| !h.broken) {
            let ra = turn(&self.world, h.bodies[0]);
            let rb = turn(&self.world, h.bodies[1]);
            let mut back = ra.inverse() * rb * h.start.inverse();
            if back.w < 0.0 {
                back = -back;
            }
            let r = back.to_scaled_axis();
            if r.length() > h.fracture {
                h.broken = true;
                h.elastic = 0.0;
                if let Some(joint) = h.joint {
                    self.world.impulse_joints.remove(joint, true);
                }
                continue;
            }
            let mut moment = [0.0; 3];
            h.elastic = 0.0;
            for k in 0..3 {
                h.largest[k] = h.largest[k].max(r[k].abs());
                let limit = interpolate(&h.capacity, h.largest[k]);
                let elastic = h.stiffness * (r[k] - h.plastic[k]);
                moment[k] = elastic.clamp(-limit, limit);
                if moment[k] != elastic {
                    h.plastic[k] = r[k] - moment[k] / h.stiffness;
                }
                h.elastic += 0.5 * moment[k] * moment[k] / h.stiffness;
            }
            let torque = ra * Vector::from(moment);
            if let Some(a) = h.bodies[0] {
                self.world.bodies[a].add_torque(torque, true);
            }
            if let Some(b) = h.bodies[1] {
                self.world.bodies[b].add_torque(-torque, true);
            }
        }
        for s in &self.springs {
            let place = |i: usize| s.bodies[i].map_or(s.points[i], |b| self.world.bodies[b].position() * s.points[i]);
            let gap = place(1) - place(0);
            let pull = gap.normalize() * (s.law[1] * (gap.length() - s.law[0]));
            let ends = [place(0), place(1)];
            for (i, sign) in [(0, 1.0), (1, -1.0)] {
                if let Some(b) = s.bodies[i] {
                    self.world.bodies[b].add_force_at_point(pull * sign, ends[i], true);
                }
            }
        }
        for (body, torque) in &self.torques {
            self.world.bodies[*body].add_torque(*torque, true);
        }
    }

    fn energy(&self) -> f64 {
        let mut sum: f64 = self.hinges.iter().map(|h| h.elastic).sum();
        for (_, b) in self.world.bodies.iter().filter(|(_, b)| b.is_dynamic()) {
            let local = &b.mass_properties().local_mprops;
            let w = (b.rotation() * local.principal_inertia_local_frame).inverse() * b.angvel();
            let i = local.principal_inertia();
            sum += 0.5 * b.mass() * b.linvel().length_squared() + 0.5 * w.dot(i * w);
            sum -= b.mass() * self.world.gravity.dot(b.translation());
        }
        sum
    }

    fn deepest(&self) -> f64 {
        let pairs = self.world.narrow_phase.contact_pairs();
        let points = pairs.flat_map(|p| p.manifolds().iter().flat_map(|m| m.points.iter().map(|c| -c.dist)));
        points.fold(0.0, f64::max)
    }
}

fn main() {
    let a: Vec<String> = std::env::args().collect();
    let model: Value = serde_json::from_str(&std::fs::read_to_string(&a[1]).unwrap()).unwrap();
    let (step, substeps): (f64, usize) = (a[3].parse().unwrap(), a[4].parse().unwrap());
    let touching = a[2] == "-";
    let times: Vec<f64> = if touching {
        vec![model["settings"]["end_time_s"].as_f64().unwrap()]
    } else {
        let text = std::fs::read_to_string(&a[2]).unwrap();
        text.lines().skip(1).map(|l| l.split(',').next().unwrap().parse().unwrap()).collect()
    };
    let mut s = scene(&model, step, substeps, touching);
    s.forces();
    let began = s.energy();
    let (mut places, mut drift, mut deepest, mut done, mut cpu) = (Vec::new(), 0.0f64, 0.0f64, 0, 0.0);
    for time in &times {
        let until = (time / step).round() as usize;
        while done < until {
            let watch = ProcessTime::now();
            s.forces();
            s.world.step();
            cpu += watch.elapsed().as_secs_f64();
            done += 1;
            if touching && done as f64 * step > time - 1.0 {
                deepest = deepest.max(s.deepest());
            }
        }
        s.forces();
        drift = drift.max((s.energy() - began).abs());
        if let Some((b, local)) = s.point {
            let p = s.world.bodies[b].position() * local;
            places.push([p.x, p.y, p.z]);
        }
    }
    println!("{}", json!({"cpu_s": cpu, "places": places, "energy_j": drift, "penetration_m": deepest}));
}
