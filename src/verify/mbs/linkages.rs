//! Mechanisms that strike something, and bodies that lose what they rest on.

use super::contact::{ball, energy, ground, last, model, run, solid};
use super::models::{joint, revolute};
use crate::mbs::model::{Body, BodyContact, Event, JointKind, Model, ObstacleBox, Shape};
use crate::verify::{Case, Figure};

const G: f64 = 9.81;
const Y: [f64; 3] = [0.0, 1.0, 0.0];

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "impact-slider-crank",
            "A slider-crank whose slider strikes a stop, with restitutions of 1 (two impacts in a second) and 0.5 (one).",
            slider_crank,
        ),
        Case::short(
            "impact-rod",
            "A rod of 2 m on a pin near the ground falls from 1 rad and strikes the ground with the ball at its tip, restitution 0.8.",
            rod,
        ),
        Case::short(
            "contact-support",
            "A cube of one metre on another one, which vanishes after 0.3 s, with ideal joints in the model and without.",
            support,
        ),
    ]
}

/// A crank of 0.3 m and a rod of 1 m in the x-z plane drive a slider along x, on which there is a ball.
fn crank_model(restitution: f64) -> Model {
    let mut m = model(1.0, 0.02);
    m.gravity_m_s2 = [0.0; 3];
    let (angle, spin) = (2.0_f64, 10.0);
    let knee = [0.3 * libm::cos(angle), 0.0, 0.3 * libm::sin(angle)];
    let along = (1.0 - knee[2] * knee[2]).sqrt();
    let end = [knee[0] + along, 0.0, 0.0];
    // the far end of the rod moves along x only
    let turn = -spin * knee[0] / along;
    let crank = solid(&mut m, knee.map(|x| 0.5 * x), [0.3, 0.05, 0.05]);
    moves(crank, spin, [0.5 * spin * knee[2], 0.0, -0.5 * spin * knee[0]]);
    let rod = solid(&mut m, [0, 1, 2].map(|i| 0.5 * (knee[i] + end[i])), [1.0, 0.05, 0.05]);
    let middle = [(spin - 0.5 * turn) * knee[2], 0.0, -spin * knee[0] - 0.5 * turn * along];
    moves(rod, turn, middle);
    let slider = ball(&mut m, 20.0, 0.1, end);
    moves(slider, 0.0, [(spin - turn) * knee[2], 0.0, 0.0]);
    m.bodies[..2].iter_mut().for_each(|b| b.shapes.clear());
    m.joints.push(revolute("shaft".into(), [None, Some("body0")], [0.0; 3], Y));
    m.joints.push(revolute("knee".into(), [Some("body0"), Some("body1")], knee, Y));
    m.joints.push(revolute("pin".into(), [Some("body1"), Some("body2")], end, Y));
    m.joints.push(joint(
        "guide".into(),
        JointKind::Prismatic,
        [None, Some("body2")],
        end,
        Some([1.0, 0.0, 0.0]),
    ));
    m.contact.obstacles.push(ObstacleBox {
        id: "stop".into(),
        min_m: [1.35, -1.0, -1.0],
        max_m: [2.0, 1.0, 1.0],
        friction: 0.0,
        restitution,
    });
    m
}

fn moves(body: &mut Body, spin: f64, velocity_m_s: [f64; 3]) {
    body.angular_velocity_rad_s = [0.0, spin, 0.0];
    body.velocity_m_s = velocity_m_s;
}

fn slider_crank() -> Result<Vec<Figure>, String> {
    let source = "one degree of freedom: an impact multiplies all velocities by -e";
    let mut figures = Vec::new();
    for (restitution, known, what) in
        [(1.0, 1.0, "kinetic energy after two impacts, e = 1"), (0.5, 0.25, "the same after one, e = 0.5")]
    {
        let result = run(&crank_model(restitution))?;
        let kinetic = &result.energies.kinetic_j;
        let share = kinetic[kinetic.len() - 1] / kinetic[0];
        figures.push(Figure::relative(what, "of that before", [known, share], 3e-5, source));
        figures.push(energy(&result, 3e-5));
    }
    Ok(figures)
}

fn rod() -> Result<Vec<Figure>, String> {
    let restitution = 0.8;
    let mut m = model(1.3, 1e-3);
    m.contact.ground = ground(0.0, restitution);
    let tilt = 1.0_f64;
    let (radius, middle) = (0.1, [libm::cos(tilt), 0.0, 0.1 + libm::sin(tilt)]);
    let body = solid(&mut m, middle, [2.0, 0.1, 0.1]);
    body.orientation = [libm::cos(0.5 * tilt), 0.0, -libm::sin(0.5 * tilt), 0.0];
    body.shapes = vec![Shape::Sphere { center_m: [1.0, 0.0, 0.0], radius_m: radius }];
    m.joints.push(revolute("pin".into(), [None, Some("body0")], [0.0, 0.0, radius], Y));
    let result = run(&m)?;
    let rises: Vec<f64> = result.frames.iter().map(|f| f.position_m[0][2] - radius).collect();
    let hit_s = result.first_ground_contact_s.ok_or("it does not come down")?;
    let after = result.times_s.iter().position(|t| *t > hit_s).unwrap_or(0);
    let highest = rises[after..].iter().copied().fold(0.0, f64::max);
    let known = restitution * restitution * libm::sin(tilt);
    Ok(vec![
        Figure::relative(
            "time of the impact",
            "s",
            [fall_s(tilt, &m.bodies[0]), hit_s],
            1e-6,
            "energy integral",
        ),
        Figure::relative(
            "height of the centre after it",
            "m",
            [known, highest],
            1e-5,
            "ω⁺ = -e ω⁻: e² of the height before",
        ),
        energy(&result, 1e-6),
    ])
}

/// Time in which a rod of 2 m on a pin falls from rest at a tilt to level \[s\]: `∫ dφ / ω` with `ω² = 2 m g (sin φ_0 - sin φ) / I`, substituted by `φ = φ_0 - u²`.
fn fall_s(tilt: f64, body: &Body) -> f64 {
    let inertia = body.inertia_kg_m2[1][1] + body.mass_kg;
    let rate = |u: f64| {
        let drop =
            if u == 0.0 { libm::cos(tilt) } else { (libm::sin(tilt) - libm::sin(tilt - u * u)) / (u * u) };
        2.0 / (2.0 * body.mass_kg * G * drop / inertia).sqrt()
    };
    // Simpson's rule
    let (count, end) = (1000, tilt.sqrt());
    let h = end / f64::from(count);
    let weight = |i: i32| {
        if i == 0 || i == count {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    (0..=count).map(|i| weight(i) * rate(h * f64::from(i))).sum::<f64>() * h / 3.0
}

fn support() -> Result<Vec<Figure>, String> {
    let source = "g t² / 2 from rest";
    let mut figures = Vec::new();
    for (is_jointed, what) in [(true, "fall in 0.2 s, with joints"), (false, "the same without")] {
        let mut m = model(0.5, 0.1);
        m.contact.ground = ground(0.5, 0.0);
        m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
        for level in [0.5, 1.5] {
            solid(&mut m, [0.0, 0.0, level], [1.0; 3]);
        }
        if is_jointed {
            m.joints.push(joint("base".into(), JointKind::Fixed, [None, Some("body0")], [0.0; 3], None));
        }
        m.events.push(Event { remove_bodies: vec!["body0".into()], ..Event::at("cut", 0.3) });
        let result = run(&m)?;
        let fall = 1.5 - last(&result).position_m[1][2];
        figures.push(Figure::absolute(what, "m", [0.5 * G * 0.04, fall], 1e-6, source));
        figures.push(energy(&result, 1e-9));
    }
    Ok(figures)
}
