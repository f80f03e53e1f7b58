//! Contact against closed forms.

use super::pile;
use crate::mbs::contact::{ContactSet, Settings};
use crate::mbs::math;
use crate::mbs::model::{Body, BodyContact, GroundPlane, Model, ObstacleBox, ObstaclePlane, Origin, Shape};
use crate::mbs::result::RunResult;
use crate::mbs::step;
use crate::mbs::system::System;
use crate::mbs::{SolverOptions, simulate, simulate_with};
use crate::verify::{Case, Figure};

pub(super) const G: f64 = 9.81;
const SIM: &str = "SimBenchmark (leggedrobotics), closed form";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short("contact-slide", "Box with 5 m/s on rough ground (0.5): where it stops.", slide),
        Case::short(
            "contact-seam",
            "Box with 5 m/s over two slabs without friction that lie flush, 10 mm apart, and 0.1 mm one below the other, with a restitution of 0.5; and one that falls 0.1 mm beside a wall: none of them strikes an edge.",
            seam,
        ),
        Case::short(
            "contact-incline",
            "Box on a plane of 30°: way in 1 s for four coefficients of friction.",
            incline,
        ),
        Case::short(
            "contact-roll",
            "Sphere on a plane of 30°, rolling and slipping: way and turn in 0.5 s.",
            roll,
        ),
        Case::short(
            "contact-bounce",
            "Ball dropped from 1 m with a restitution of 0.5: heights, and that it comes to rest.",
            bounce,
        ),
        Case::short(
            "contact-bounce-elastic",
            "Ball dropped from 5 m with a restitution of 1: height after 20 s, energy.",
            elastic,
        ),
        Case::short(
            "contact-rocking",
            "Housner's rocking column, 0.4 m by 3.5 m, from 0.6 of the angle at which it topples.",
            rocking,
        ),
        Case::short(
            "contact-train",
            "A slab of 10 m/s hits three others one after the other without rebound.",
            train,
        ),
        Case::short(
            "contact-push",
            "SimBenchmark: 25 balls of 1 kg on a box of 10 kg pushed with 150 N along the diagonal.",
            push,
        ),
        Case::short(
            "contact-666",
            "SimBenchmark: 216 balls in a cube fall on the ground without rebound or friction: largest penetration.",
            balls,
        ),
        Case::short(
            "contact-49",
            "SimBenchmark: 49 balls bounce from 5 m without loss or friction for 20 s: height and energy.",
            bouncing,
        ),
        Case::short(
            "contact-thin",
            "Slabs of 50 mm meet a slab on the ground at 10 to 50 m/s: none passes through.",
            thin,
        ),
        Case::long("contact-stack", "A stack of ten boxes for 60 s: how far any of them moves.", stack),
        Case::long(
            "contact-cards",
            "A house of cards of two storeys for 60 s: how far any card moves.",
            cards,
        ),
        Case::long(
            "contact-pile",
            "1000 cubes dropped in random orientation, 5 s: penetration by separating axes.",
            || heap(10, 5.0),
        ),
        Case::short("contact-pile-64", "64 cubes, 2 s, likewise.", || heap(4, 2.0)),
    ]
}

pub(super) fn model(end_time_s: f64, output_interval_s: f64) -> Model {
    Model::empty("contact", [0.0, 0.0, -G], end_time_s, output_interval_s)
}

pub(super) fn ground(friction: f64, restitution: f64) -> Option<GroundPlane> {
    Some(GroundPlane { level_m: 0.0, friction, restitution })
}

fn body(model: &mut Model, mass_kg: f64, inertia: [f64; 3], position_m: [f64; 3], shape: Shape) -> &mut Body {
    let [x, y, z] = inertia;
    model.bodies.push(Body {
        id: format!("body{}", model.bodies.len()),
        mass_kg,
        inertia_kg_m2: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]],
        position_m,
        orientation: [1.0, 0.0, 0.0, 0.0],
        velocity_m_s: [0.0; 3],
        angular_velocity_rad_s: [0.0; 3],
        shapes: vec![shape],
        origin: Origin::default(),
    });
    model.bodies.last_mut().expect("just entered")
}

/// A solid box of 2500 kg/m³.
pub(super) fn solid(model: &mut Model, position_m: [f64; 3], size: [f64; 3]) -> &mut Body {
    let mass = 2500.0 * size.iter().product::<f64>();
    let s = size.map(|v| v * v * mass / 12.0);
    let shape = Shape::cuboid([0.0; 3], size.map(|v| 0.5 * v));
    body(model, mass, [s[1] + s[2], s[0] + s[2], s[0] + s[1]], position_m, shape)
}

pub(super) fn ball(model: &mut Model, mass: f64, radius_m: f64, position_m: [f64; 3]) -> &mut Body {
    let inertia = 0.4 * mass * radius_m * radius_m;
    body(model, mass, [inertia; 3], position_m, Shape::Sphere { center_m: [0.0; 3], radius_m })
}

pub(super) fn run(model: &Model) -> Result<RunResult, String> {
    simulate(model).map_err(|e| e.to_string())
}

pub(super) fn energy(result: &RunResult, allowed: f64) -> Figure {
    Figure::absolute(
        "energy error, share of the turnover",
        "-",
        [0.0, result.energy_error],
        allowed,
        "conservation",
    )
}

pub(super) fn last(result: &RunResult) -> &crate::mbs::result::Frame {
    result.frames.last().expect("a run has outputs")
}

fn seam() -> Result<Vec<Figure>, String> {
    const SPEED_M_S: f64 = 5.0;
    let slab = |id: &str, min_m: [f64; 3], max_m: [f64; 3]| ObstacleBox {
        id: id.into(),
        min_m,
        max_m,
        friction: 0.0,
        restitution: 0.5,
    };
    let mut all = Vec::new();
    for (name, gap_m, lower_m) in
        [("speed, flush", 0.0, 0.0), ("speed, a gap", 0.01, 0.0), ("speed, a step down", 0.0, 1e-4)]
    {
        let mut m = model(0.5, 0.01);
        let body = solid(&mut m, [-1.0, 0.0, 0.1], [0.4, 0.3, 0.2]);
        body.velocity_m_s = [SPEED_M_S, 0.0, 0.0];
        m.contact.obstacles = vec![
            slab("first", [-3.0, -1.0, -1.0], [0.0, 1.0, 0.0]),
            slab("second", [gap_m, -1.0, -1.0], [3.0, 1.0, -lower_m]),
        ];
        let result = run(&m)?;
        let x = |k: usize| result.frames[k].position_m[0][0];
        let last = result.frames.len() - 1;
        let found = (x(last) - x(0)) / result.times_s[last];
        all.push(Figure::relative(name, "m/s", [SPEED_M_S, found], 2e-4, "nothing is in its way"));
    }
    let mut m = model(0.7, 0.01);
    solid(&mut m, [-0.2001, 0.0, 1.0], [0.4, 0.3, 0.2]);
    m.contact.obstacles = vec![slab("wall", [0.0, -1.0, -3.0], [0.3, 1.0, 0.0])];
    let result = run(&m)?;
    let end = result.frames.last().map_or([f64::NAN; 3], |f| f.position_m[0]);
    let fall = 1.0 - end[2];
    all.push(Figure::relative("way beside a wall", "m", [0.5 * G * 0.49, fall], 1e-6, "g t²/2"));
    all.push(Figure::absolute("thrown aside", "m", [-0.2001, end[0]], 1e-9, "nothing is in its way"));
    Ok(all)
}

fn slide() -> Result<Vec<Figure>, String> {
    let mut m = model(1.5, 0.1);
    m.contact.ground = ground(0.5, 0.0);
    solid(&mut m, [0.0, 0.0, 0.2], [1.0, 1.0, 0.4]).velocity_m_s = [3.0, 4.0, 0.0];
    let result = run(&m)?;
    let way = |i: usize| math::norm(math::sub(result.frames[i].position_m[0], [0.0, 0.0, 0.2]));
    let exact = |t: f64| 5.0 * t - 0.25 * G * t * t;
    Ok(vec![
        Figure::relative("way in 0.5 s", "m", [exact(0.5), way(5)], 1e-5, "v t - μ g t²/2"),
        Figure::relative("way in 1 s", "m", [exact(1.0), way(10)], 1e-5, "v t - μ g t²/2"),
        Figure::relative("way until it stops", "m", [2.548419980, way(15)], 1e-5, "v²/(2 μ g)"),
        energy(&result, 1e-6),
    ])
}

fn tilted(friction: f64, restitution: f64, end_s: f64) -> Model {
    let mut m = model(end_s, end_s);
    let tilt = 30.0_f64.to_radians();
    m.contact.planes.push(ObstaclePlane {
        id: "slope".into(),
        point_m: [0.0; 3],
        normal: [2.0 * libm::sin(tilt), 0.0, 2.0 * libm::cos(tilt)],
        friction,
        restitution,
    });
    m
}

fn incline() -> Result<Vec<Figure>, String> {
    let tilt = 30.0_f64.to_radians();
    let mut figures = Vec::new();
    for friction in [0.0, 0.3, 0.57, 0.58] {
        let mut m = tilted(friction, 0.0, 1.0);
        let at = [0.2 * libm::sin(tilt), 0.0, 0.2 * libm::cos(tilt)];
        solid(&mut m, at, [1.0, 1.0, 0.4]).orientation =
            [libm::cos(0.5 * tilt), 0.0, libm::sin(0.5 * tilt), 0.0];
        let result = run(&m)?;
        let way = math::norm(math::sub(last(&result).position_m[0], at));
        let exact = 0.5 * (G * (libm::sin(tilt) - friction * libm::cos(tilt))).max(0.0);
        figures.push(Figure::absolute(
            format!("way in 1 s, friction {friction}"),
            "m",
            [exact, way],
            5e-5,
            "g (sin α - μ cos α) t²/2",
        ));
    }
    Ok(figures)
}

fn roll() -> Result<Vec<Figure>, String> {
    let tilt = 30.0_f64.to_radians();
    let mut figures = Vec::new();
    for (friction, acceleration, spin) in [(0.4, 3.503571, 3.503571), (0.1, 4.055429, 2.123927)] {
        let mut m = tilted(friction, 0.0, 0.5);
        let at = [0.5 * libm::sin(tilt), 0.0, 0.5 * libm::cos(tilt)];
        ball(&mut m, 10.0, 0.5, at);
        let result = run(&m)?;
        let way = math::norm(math::sub(last(&result).position_m[0], at));
        let turn = 2.0 * libm::acos(last(&result).orientation[0][0].abs().min(1.0));
        figures.push(Figure::relative(
            format!("way, friction {friction}"),
            "m",
            [0.125 * acceleration, way],
            1e-5,
            "rigid body on an incline",
        ));
        figures.push(Figure::relative(
            format!("turn, friction {friction}"),
            "rad",
            [0.25 * spin, turn],
            1e-5,
            "rigid body on an incline",
        ));
    }
    Ok(figures)
}

fn bounce() -> Result<Vec<Figure>, String> {
    let mut m = model(1.5, 1e-3);
    m.contact.ground = ground(0.0, 0.5);
    ball(&mut m, 10.0, 0.1, [0.0, 0.0, 1.1]);
    let result = run(&m)?;
    let height = |t: f64| result.frames[(t * 1e3).round() as usize].position_m[0][2] - 0.1;
    let fall = (2.0 / G).sqrt();
    let mut figures = Vec::new();
    let mut begin = fall;
    for n in 1..=4 {
        let flight = 2.0 * fall * 0.5_f64.powi(n);
        let (from, to) = ((begin * 1e3) as usize, ((begin + flight) * 1e3) as usize);
        let peak = (from..=to).map(|i| height(1e-3 * i as f64)).fold(0.0, f64::max);
        let exact = 0.25_f64.powi(n);
        figures.push(Figure::absolute(format!("height of bounce {n}"), "m", [exact, peak], 5e-6, "e^(2n)"));
        begin += flight;
    }
    let after = (1_356..1_500).map(|i| height(1e-3 * f64::from(i)).abs()).fold(0.0, f64::max);
    figures.push(Figure::absolute(
        "height after 1.354570923 s",
        "m",
        [0.0, after],
        2e-5,
        "fall time (1 + e)/(1 - e)",
    ));
    figures.push(energy(&result, 1e-9));
    Ok(figures)
}

fn elastic() -> Result<Vec<Figure>, String> {
    let mut m = model(20.0, 1.0);
    m.contact.ground = ground(0.0, 1.0);
    ball(&mut m, 10.0, 0.1, [0.0, 0.0, 5.1]);
    let result = run(&m)?;
    let fall = (10.0 / G).sqrt();
    let phase = (20.0 + fall) % (2.0 * fall) - fall;
    let exact = 5.1 - 0.5 * G * phase * phase;
    let height = last(&result).position_m[0][2];
    let taken = result.energies.contact_damping_j.last().copied().unwrap_or(f64::NAN);
    Ok(vec![
        Figure::absolute("height after 20 s", "m", [exact, height], 1e-6, "parabolas"),
        Figure::absolute("energy taken by the contact", "J", [0.0, taken], 1e-6, "conservation"),
    ])
}

fn rocking() -> Result<Vec<Figure>, String> {
    let (b, h) = (0.2_f64, 1.75_f64);
    let radius = libm::hypot(b, h);
    let alpha = libm::atan(b / h);
    let p2 = 0.75 * G / radius;
    let mut m = model(1.2, 5e-4);
    m.contact.ground = ground(2.0, 0.0);
    let start = 0.6 * alpha;
    // Turned about the lower edge at x = b: the centre moves on a circle about it.
    let lean = alpha - start;
    let column =
        solid(&mut m, [b - radius * libm::sin(lean), 0.0, radius * libm::cos(lean)], [0.4, 0.4, 3.5]);
    column.orientation = [libm::cos(0.5 * start), 0.0, libm::sin(0.5 * start), 0.0];
    let result = run(&m)?;
    let angle = |i: usize| 2.0 * libm::asin(result.frames[i].orientation[0][2]);
    let speed = |i: usize| (angle(i + 1) - angle(i - 1)) / 1e-3;
    let hit = (1..result.frames.len()).find(|i| angle(*i) <= 0.0).ok_or("it does not come back")?;
    let quarter = 5e-4 * (hit as f64 - 4.0) - angle(hit - 4) / speed(hit - 4);
    // Speed at the impact from that at an angle, by the energy on either side.
    let at_impact = |i: usize| {
        (speed(i).powi(2) + 2.0 * p2 * (libm::cos(alpha - angle(i).abs()) - libm::cos(alpha))).sqrt()
    };
    let (before, after) = (at_impact(hit - 20), at_impact(hit + 20));
    Ok(vec![
        Figure::relative("time to the impact", "s", [0.76683327, quarter], 2e-4, "Housner 1963, exact"),
        Figure::relative("angular velocity before", "rad/s", [0.21301821, before], 5e-4, "Housner 1963"),
        Figure::relative(
            "ratio of the angular velocities",
            "-",
            [0.98066076, after / before],
            1e-4,
            "1 - 1.5 sin²α",
        ),
    ])
}

fn train() -> Result<Vec<Figure>, String> {
    let mut m = model(1.0, 0.01);
    m.gravity_m_s2 = [0.0; 3];
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    for i in 0..4 {
        solid(&mut m, [1.1 * f64::from(i), 0.0, 0.0], [0.1, 2.0, 2.0]);
    }
    m.bodies[0].velocity_m_s[0] = 10.0;
    let result = run(&m)?;
    let n = result.frames.len();
    let v = (result.frames[n - 1].position_m[3][0] - result.frames[n - 11].position_m[3][0]) / 0.1;
    let t = 0.1 + 0.2 + 0.3;
    let place = 3.3 + 2.5 * (1.0 - t);
    let kinetic = result.energies.kinetic_j.last().copied().unwrap_or(f64::NAN);
    Ok(vec![
        Figure::relative("velocity after three hits", "m/s", [2.5, v], 1e-5, "momentum: v n/(n + 1)"),
        Figure::relative(
            "place of the last one after 1 s",
            "m",
            [place, result.frames[n - 1].position_m[3][0]],
            1e-5,
            "momentum",
        ),
        Figure::relative("kinetic energy left", "J", [0.5 * 4000.0 * 6.25, kinetic], 1e-6, "momentum"),
    ])
}

fn push() -> Result<Vec<Figure>, String> {
    let mut m = model(4.0, 4.0);
    m.contact.ground = ground(0.4, 0.0);
    m.contact.bodies = Some(BodyContact { friction: 0.8, restitution: 0.0 });
    let inertia = 10.0 / 12.0 * (400.0 + 0.01);
    let plate = Shape::cuboid([0.0; 3], [10.0, 10.0, 0.05]);
    body(&mut m, 10.0, [inertia, inertia, 10.0 / 12.0 * 800.0], [0.0, 0.0, 0.05], plate);
    for i in 0..25 {
        ball(&mut m, 1.0, 0.5, [2.0 * f64::from(i % 5) - 4.0, 2.0 * f64::from(i / 5) - 4.0, 0.6]);
    }
    let mut system = System::new(&m).map_err(|e| e.to_string())?;
    let mut contacts = ContactSet::new(&m, Settings::default());
    let (h, steps) = (1e-3, 4000);
    let mut moving = Vec::new();
    for i in 0..steps {
        system.reset_forces();
        let f = 150.0 * 0.5_f64.sqrt();
        system.bodies[0].force = math::add(system.bodies[0].force, [f, f, 0.0]);
        step::kick(&mut system, if i == 0 { 0.5 * h } else { h }, h);
        if !step::is_quiet(&system, &mut contacts, h) {
            step::meet(&mut system, &mut contacts, &mut moving, &mut Vec::new(), h)
                .map_err(|deep| format!("{} m inside each other", deep.depth_m))?;
        }
        step::drift(&mut system, h);
    }
    let way = |i: usize| math::norm(math::sub(system.bodies[i].x, m.bodies[i].position_m));
    // The balls roll without slipping: with a ball's acceleration 2/7 of the plate's, F - μ M g = m a + 25 · 2/7 a.
    let plate_a = (150.0 - 0.4 * 35.0 * G) / (10.0 + 25.0 * 2.0 / 7.0);
    let most = (1..26).map(|i| (way(i) - 8.0 * plate_a * 2.0 / 7.0).abs()).fold(0.0, f64::max);
    Ok(vec![
        Figure::relative("acceleration of the box", "m/s²", [plate_a, way(0) / 8.0], 1e-4, SIM),
        Figure::absolute("largest error of a ball's acceleration", "m/s²", [0.0, most / 8.0], 1e-4, SIM),
    ])
}

fn bouncing() -> Result<Vec<Figure>, String> {
    let mut m = model(20.0, 1.0);
    m.contact.ground = ground(0.0, 1.0);
    m.contact.bodies = Some(BodyContact { friction: 0.0, restitution: 1.0 });
    for i in 0..49 {
        ball(&mut m, 10.0, 0.1, [f64::from(i % 7), f64::from(i / 7), 5.1]);
    }
    let result = run(&m)?;
    let fall = (10.0 / G).sqrt();
    let phase = (20.0 + fall) % (2.0 * fall) - fall;
    let exact = 5.1 - 0.5 * G * phase * phase;
    let off = last(&result).position_m.iter().map(|p| (p[2] - exact).abs()).fold(0.0, f64::max);
    Ok(vec![
        Figure::absolute("largest error of a height after 20 s", "m", [0.0, off], 1e-6, "parabolas"),
        energy(&result, 1e-9),
    ])
}

fn balls() -> Result<Vec<Figure>, String> {
    let mut m = model(1.0, 1.0);
    m.contact.ground = ground(0.0, 0.0);
    m.contact.bodies = Some(BodyContact { friction: 0.0, restitution: 0.0 });
    for i in 0..216 {
        let (x, y, z) = (i % 6, i / 6 % 6, i / 36);
        let shake = 1e-3 * f64::from((i * 7 + 3) % 11) / 11.0;
        let at = [x, y, z].map(|v| 0.21 * f64::from(v));
        ball(&mut m, 10.0, 0.1, [at[0] + shake, at[1] - shake, at[2] + 0.101]);
    }
    let result = run(&m)?;
    let x = &last(&result).position_m;
    let mut depth = x.iter().map(|p| 0.1 - p[2]).fold(0.0, f64::max);
    for i in 0..x.len() {
        for j in 0..i {
            depth = depth.max(0.2 - math::norm(math::sub(x[i], x[j])));
        }
    }
    Ok(vec![
        Figure::absolute("largest penetration after 1 s", "m", [0.0, depth], 1e-4, "rigid"),
        energy(&result, 1e-3),
    ])
}

fn thin() -> Result<Vec<Figure>, String> {
    let mut figures = Vec::new();
    for speed in [10.0, 25.0, 50.0] {
        let mut m = model(0.5, 0.5);
        m.contact.ground = ground(0.5, 0.1);
        m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.1 });
        solid(&mut m, [0.0, 0.0, 0.025], [3.0, 3.0, 0.05]);
        for i in 1..4 {
            let falling = solid(&mut m, [0.0, 0.0, 1.5 * f64::from(i)], [2.0, 2.0, 0.05]);
            falling.velocity_m_s[2] = -speed;
            let tilt = 0.05 * f64::from(i - 1);
            falling.orientation = [libm::cos(0.5 * tilt), libm::sin(0.5 * tilt), 0.0, 0.0];
        }
        let result = run(&m)?;
        let z: Vec<f64> = last(&result).position_m.iter().map(|p| p[2]).collect();
        let least = (1..4).map(|i| z[i] - z[i - 1]).fold(z[0] - 0.025, f64::min);
        figures.push(Figure::absolute(
            format!("a slab below the next lower one, {speed} m/s"),
            "m",
            [0.0, (-least).max(0.0)],
            1e-3,
            "no tunnelling",
        ));
    }
    Ok(figures)
}

fn moved(result: &RunResult) -> f64 {
    let first = &result.frames[0].position_m;
    let away = |i: usize| math::norm(math::sub(last(result).position_m[i], first[i]));
    (0..first.len()).map(away).fold(0.0, f64::max)
}

fn stack() -> Result<Vec<Figure>, String> {
    let mut m = model(60.0, 1.0);
    m.contact.ground = ground(0.5, 0.0);
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    for i in 0..10 {
        let off = 0.02 * f64::from(i % 3);
        solid(&mut m, [off, -off, 0.2 + 0.4 * f64::from(i)], [0.6, 0.5, 0.4]);
    }
    let result = run(&m)?;
    Ok(vec![Figure::absolute("largest displacement", "m", [0.0, moved(&result)], 1e-3, "rest")])
}

/// Pairs of cards that lean on each other, flat cards on top, one more pair on these.
fn cards() -> Result<Vec<Figure>, String> {
    let mut m = model(60.0, 1.0);
    m.contact.ground = ground(0.6, 0.0);
    m.contact.bodies = Some(BodyContact { friction: 0.6, restitution: 0.0 });
    let (length, width, thick, lean) = (1.0_f64, 0.7, 0.02, 0.3_f64);
    // A card that leans by `lean`: its upper inner edge is at the plane of symmetry, its lower outer edge on the floor.
    let (s, c) = libm::sincos(lean);
    let height = length * c + thick * s;
    let pair = |m: &mut Model, x: f64, floor: f64| {
        for side in [-1.0, 1.0] {
            let inner = [0.5 * thick * c + 0.5 * length * s, -0.5 * thick * s + 0.5 * length * c];
            let card = solid(
                m,
                [x + side * inner[0], 0.0, floor + height - inner[1] - thick * s],
                [thick, width, length],
            );
            card.orientation = [libm::cos(0.5 * lean), 0.0, -side * libm::sin(0.5 * lean), 0.0];
        }
    };
    let reach = length * s + thick * c;
    pair(&mut m, -reach, 0.0);
    pair(&mut m, reach, 0.0);
    solid(&mut m, [0.0, 0.0, height + 0.5 * thick], [4.0 * reach, width, thick]);
    pair(&mut m, 0.0, height + thick);
    let result = run(&m)?;
    Ok(vec![Figure::absolute("largest displacement", "m", [0.0, moved(&result)], 5e-3, "rest")])
}

fn heap(side: usize, end_s: f64) -> Result<Vec<Figure>, String> {
    let m = pile::model(side, end_s, pile::STEP_S);
    let result = simulate_with(&m, &SolverOptions::default()).map_err(|e| e.to_string())?;
    let depths = pile::depths(last(&result));
    Ok(vec![
        Figure::absolute("largest penetration of cubes", "m", [0.0, depths.largest_m], 1e-3, "rigid"),
        Figure::absolute("deepest corner below the ground", "m", [0.0, depths.ground_m], 1e-3, "rigid"),
        energy(&result, 1e-6),
    ])
}
