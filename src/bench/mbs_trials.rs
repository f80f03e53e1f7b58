//! Small models at and beyond the limits of the multibody solver, and random hinge structures.

use crate::base::random::Random;
use crate::mbs::math::{V3, norm, qunit};
use crate::mbs::model::{Body, BodyContact, Force, GroundPlane, Joint, JointKind, Model, Origin, Shape};

/// A model to be run, and what was varied in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// What was varied.
    pub parameter: &'static str,
    /// Its value with unit.
    pub value: String,
    /// The model.
    pub model: Model,
}

/// All trials, in the order of the page.
pub fn trials() -> Vec<Trial> {
    let mut all = Vec::new();
    let mut add = |parameter: &'static str, values: &[f64], unit: &str, model: &dyn Fn(f64) -> Model| {
        for v in values {
            let value = if unit.is_empty() { format!("{v:e}") } else { format!("{v} {unit}") };
            all.push(Trial { parameter, value, model: model(*v) });
        }
    };
    let decades = |from: i32, to: i32| (from..=to).map(|e| 10f64.powi(e)).collect::<Vec<f64>>();
    add("time step, hinge that flows", &[0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0], "ms", &|ms| {
        let mut m = chain(&[2.5e3], &[(2e7, 3e3, None)]);
        m.settings.time_step_s = Some(1e-3 * ms);
        m
    });
    add("ratio of two hinges' stiffnesses", &decades(0, 8), "", &|r| {
        chain(&[2.5e3; 2], &[(1e4, 1e9, None), (1e4 * r, 1e9, None)])
    });
    add("mass ratio across a joint", &decades(0, 6), "", &|r| {
        chain(&[2.5e3, 2.5e3 / r], &[(1e6, 5e3, None), (1e6 / r, 5e3 / r, None)])
    });
    add("mass ratio, light below heavy in a chain", &decades(0, 6), "", &|r| {
        chain(&[2.5e3 / r, 2.5e3], &[(1e6, 5e3, None), (1e6, 5e3, None)])
    });
    add("mass ratio of two blocks on each other", &decades(0, 6), "", &|r| blocks([2.5e3 / r, 2.5e3], 0.5));
    add("friction of a thrown block", &[0.0, 0.1, 0.5, 1.0, 1.5], "", &|mu| {
        thrown([8.0, 0.0, -1.0], [0.0, 3.0, 1.0], mu)
    });
    add("rotation over which a hinge loses its strength", &[0.1, 1e-2, 1e-3, 1e-4, 1e-6], "rad", &|w| {
        let mut m = chain(&[2.5e3; 2], &[(2e7, 6e3, None), (2e7, 3e3, Some(w))]);
        m.settings.end_time_s = 1.5;
        m
    });
    add("times that each joint of a loop is there", &[1.0, 2.0, 4.0, 8.0], "", &|n| portal(n as usize));
    add("thickness of a slab that falls on its edge", &[0.1, 1e-2, 1e-3, 1e-4], "m", &|t| {
        let mut m = thrown([0.0, 0.0, -3.0], [0.3, 0.0, 0.0], 0.5);
        m.bodies[0] = cuboid("slab", 2500.0 * t, [1.0, t, 1.0], [0.0, 0.0, 1.0]);
        m.bodies[0].velocity_m_s = [0.0, 0.0, -3.0];
        m
    });
    add("size of a block", &[10.0, 1.0, 0.1, 1e-2, 1e-3], "m", &|a| {
        let mut m = thrown([1.0, 0.0, -1.0], [0.0; 3], 0.5);
        m.bodies[0] = cuboid("block", 2500.0 * a * a * a, [a; 3], [0.0, 0.0, a]);
        m
    });
    add("speed at which a block meets the ground", &[1.0, 10.0, 100.0, 1000.0], "m/s", &|v| {
        thrown([0.3 * v, 0.0, -v], [0.0; 3], 0.5)
    });
    add("spin of a block that falls", &[10.0, 100.0, 1e3, 1e4], "rad/s", &|w| {
        thrown([0.0, 0.0, -1.0], [w, 0.4 * w, 0.1 * w], 0.5)
    });
    add("speed of a body on a pendulum", &[10.0, 100.0, 1000.0], "m/s", &|v| {
        let mut m = chain(&[2.5e3], &[(1.0, 1.0, None)]);
        m.forces.clear();
        m.bodies[0].velocity_m_s = [v, 0.0, 0.0];
        m
    });
    all
}

fn model(name: &str, end_time_s: f64) -> Model {
    Model::empty(name, [0.0, 0.0, -9.81], end_time_s, 0.01)
}

fn cuboid(id: &str, mass_kg: f64, size: V3, position_m: V3) -> Body {
    let s = size.map(|v| v * v * mass_kg / 12.0);
    Body {
        id: id.into(),
        mass_kg,
        inertia_kg_m2: [[s[1] + s[2], 0.0, 0.0], [0.0, s[0] + s[2], 0.0], [0.0, 0.0, s[0] + s[1]]],
        position_m,
        orientation: [1.0, 0.0, 0.0, 0.0],
        velocity_m_s: [0.0; 3],
        angular_velocity_rad_s: [0.0; 3],
        shapes: vec![Shape::cuboid([0.0; 3], size.map(|v| 0.5 * v))],
        origin: Origin::default(),
    }
}

fn joint(id: String, kind: JointKind, a: Option<String>, b: &str, point_m: V3) -> Joint {
    let axis = (kind == JointKind::Revolute).then_some([0.0, 1.0, 0.0]);
    Joint {
        id,
        kind,
        body_a: a,
        body_b: b.into(),
        point_m,
        point_b_m: None,
        axis,
        axis_b: None,
        origin: Origin::default(),
    }
}

/// Stiffness and capacity of a hinge, and the rotation over which it loses its capacity from 0.02 rad on, if it does.
type HingeOf = (f64, f64, Option<f64>);

fn hinge(
    id: String,
    a: Option<String>,
    b: &str,
    (k, capacity, width): HingeOf,
    joint: Option<String>,
) -> Force {
    let lost = width.map(|w| vec![[0.0, capacity], [0.02, capacity], [0.02 + w, 0.0]]);
    Force::Hinge {
        id,
        body_a: a,
        body_b: b.into(),
        stiffness_nm_rad: k,
        capacity: lost.unwrap_or_else(|| vec![[0.0, capacity]]),
        fracture_rad: None,
        joint,
    }
}

/// Columns of one metre on each other, pinned in a plane, with hinges; they lean by a push.
fn chain(masses: &[f64], hinges: &[HingeOf]) -> Model {
    let mut m = model("chain", 1.0);
    for (i, (mass, hinge_of)) in masses.iter().zip(hinges).enumerate() {
        let id = format!("link{i}");
        let below = i.checked_sub(1).map(|k| format!("link{k}"));
        let foot = [0.0, 0.0, i as f64];
        let mut body = cuboid(&id, *mass, [0.2, 0.2, 1.0], [0.0, 0.0, i as f64 + 0.5]);
        body.velocity_m_s = [0.2 * (i as f64 + 0.5), 0.0, 0.0];
        body.angular_velocity_rad_s = [0.0, 0.2, 0.0];
        m.bodies.push(body);
        m.joints.push(joint(format!("pin{i}"), JointKind::Revolute, below.clone(), &id, foot));
        m.forces.push(hinge(format!("hinge{i}"), below, &id, *hinge_of, None));
    }
    m
}

fn grounded(mut m: Model, friction: f64) -> Model {
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction, restitution: 0.1 });
    m.contact.bodies = Some(BodyContact { friction, restitution: 0.1 });
    m
}

/// A block on another.
fn blocks(masses: [f64; 2], friction: f64) -> Model {
    let mut m = grounded(model("blocks", 1.0), friction);
    for (i, mass) in masses.into_iter().enumerate() {
        m.bodies.push(cuboid(
            &format!("block{i}"),
            mass,
            [0.5; 3],
            [0.01 * i as f64, 0.0, 0.26 + 0.52 * i as f64],
        ));
    }
    m
}

/// A block of half a metre that is thrown.
fn thrown(velocity_m_s: V3, angular_velocity_rad_s: V3, friction: f64) -> Model {
    let mut m = grounded(model("block", 1.0), friction);
    m.bodies.push(Body {
        velocity_m_s,
        angular_velocity_rad_s,
        ..cuboid("block", 312.5, [0.5; 3], [0.0, 0.0, 1.0])
    });
    m
}

/// Two columns under a beam, each of whose four joints is there several times; pushed sideways.
fn portal(times: usize) -> Model {
    let mut m = model("portal", 1.0);
    m.bodies.push(cuboid("left", 1400.0, [0.4, 0.4, 3.5], [0.0, 0.0, 1.75]));
    m.bodies.push(cuboid("right", 1400.0, [0.4, 0.4, 3.5], [6.0, 0.0, 1.75]));
    m.bodies.push(cuboid("beam", 4000.0, [6.4, 0.4, 0.6], [3.0, 0.0, 3.5]));
    m.bodies[2].velocity_m_s = [1.0, 0.0, 0.0];
    let ends = [("left", 0.0, 0.0), ("right", 6.0, 0.0), ("left", 0.0, 3.5), ("right", 6.0, 3.5)];
    for k in 0..times {
        for (i, (column, x, z)) in ends.iter().enumerate() {
            let above = (*z > 0.0).then(|| "beam".to_string());
            m.joints.push(joint(format!("pin{i}-{k}"), JointKind::Revolute, above, column, [*x, 0.0, *z]));
        }
    }
    for (column, x) in [("left", 0.0), ("right", 6.0)] {
        let _ = x;
        m.forces.push(hinge(format!("foot-{column}"), None, column, (1e6, 2e4, None), None));
    }
    m
}

/// A random hinge structure: up to eight blocks, each joined to the ground or to one before it, sometimes closed to loops; hinges that are stiff or soft, flow, soften and fracture; in half of
/// the structures over ground.
pub fn random(seed: u64) -> Model {
    let mut r = Random::of(seed);
    let mut m = model(&format!("random {seed}"), 1.0);
    m.settings.output_interval_s = 0.05;
    let count = 1 + r.below(8);
    for i in 0..count {
        let id = format!("body{i}");
        let size = [r.decades(0.2, 3.0), r.decades(0.2, 3.0), r.decades(0.2, 3.0)];
        let mass = 2500.0 * size.iter().product::<f64>() * r.decades(0.1, 10.0);
        let place = [r.between(-4.0, 4.0), r.between(-4.0, 4.0), r.between(3.0, 9.0)];
        let mut body = cuboid(&id, mass, size, place);
        let q = [r.between(-1.0, 1.0), r.between(-1.0, 1.0), r.between(-1.0, 1.0), r.between(0.1, 1.0)];
        body.orientation = qunit(q);
        body.velocity_m_s = [r.between(-2.0, 2.0), r.between(-2.0, 2.0), r.between(-2.0, 2.0)];
        body.angular_velocity_rad_s = [r.between(-3.0, 3.0), r.between(-3.0, 3.0), r.between(-3.0, 3.0)];
        m.bodies.push(body);
        let links = 1 + usize::from(r.share() < 0.25);
        for k in 0..links {
            connect(&mut m, &mut r, i, k);
        }
    }
    if r.share() < 0.5 { grounded(m, 0.5) } else { m }
}

/// Joins body `i` to the ground or to one before it, mostly with a hinge.
fn connect(m: &mut Model, r: &mut Random, i: usize, k: usize) {
    let other = (i > 0 && r.share() < 0.8).then(|| r.below(i));
    let a = other.map(|o| format!("body{o}"));
    let b = format!("body{i}");
    let near = other.map_or([0.0, 0.0, 6.0], |o| m.bodies[o].position_m);
    let own = m.bodies[i].position_m;
    let share = r.share();
    let point: V3 = std::array::from_fn(|c| near[c] + share * (own[c] - near[c]));
    let kind =
        [JointKind::Spherical, JointKind::Revolute, JointKind::Spherical, JointKind::Fixed][r.below(4)];
    let id = format!("joint{i}-{k}");
    let mut held = joint(id.clone(), kind, a.clone(), &b, point);
    let axis = [r.between(-1.0, 1.0), r.between(-1.0, 1.0), r.between(-1.0, 1.0)];
    held.axis = (kind == JointKind::Revolute && norm(axis) > 0.1).then_some(axis).or(held.axis);
    m.joints.push(held);
    if kind != JointKind::Fixed && r.share() < 0.8 {
        let capacity = r.decades(1e2, 1e6);
        let mut force =
            hinge(format!("hinge{i}-{k}"), a, &b, (r.decades(1e3, 1e8), capacity, None), Some(id));
        if let (Force::Hinge { capacity: points, fracture_rad, .. }, true) = (&mut force, r.share() < 0.5) {
            *points = vec![
                [0.0, capacity],
                [0.03, capacity],
                [0.03 + r.decades(1e-3, 0.3), r.between(0.0, 0.5) * capacity],
            ];
            *fracture_rad = Some(r.between(0.2, 1.0));
        }
        m.forces.push(force);
    }
}
