//! Islands at rest fall asleep: the same histories, and what wakes them.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::{RunResult, math, simulate};

const SPEED_M_S: f64 = 0.05;

fn on_ground(name: &str, end_s: f64) -> Model {
    let mut m = model(name, end_s, 0.01);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    m
}

fn stack(count: usize, end_s: f64) -> Model {
    let mut m = on_ground("stack", end_s);
    for i in 0..count {
        let off = 0.02 * (i % 3) as f64;
        m.bodies.push(solid(&format!("box{i}"), [off, -off, 0.2 + 0.4 * i as f64], [0.6, 0.5, 0.4]));
    }
    m
}

/// A run without and one with sleep.
fn both(mut m: Model) -> [RunResult; 2] {
    let awake = simulate(&m).unwrap();
    m.settings.sleep_speed_m_s = Some(SPEED_M_S);
    [awake, simulate(&m).unwrap()]
}

/// Largest distance of a body from where it is in the other run, at any output [m].
fn apart([a, b]: &[RunResult; 2]) -> f64 {
    let frames = a.frames.iter().zip(&b.frames);
    let pairs = frames.flat_map(|(f, g)| f.position_m.iter().zip(&g.position_m));
    pairs.map(|(x, y)| math::norm(math::sub(*x, *y))).fold(0.0, f64::max)
}

/// From which time on no pose changes by a bit [s].
fn still_from(run: &RunResult) -> f64 {
    let end = run.frames.last().unwrap();
    let first = run.frames.iter().rposition(|f| f != end).map_or(0, |i| i + 1);
    run.times_s[first]
}

#[test]
fn a_stack_asleep_stands_where_it_stands_awake() {
    let runs = both(stack(10, 5.0));
    println!(
        "stack: {:.1e} m apart, still from {:.2} s (awake: {:.2} s), {:.1} and {:.1} ms, energy error {:.1e} and {:.1e}",
        apart(&runs),
        still_from(&runs[1]),
        still_from(&runs[0]),
        1e3 * runs[0].cpu_s,
        1e3 * runs[1].cpu_s,
        runs[0].energy_error,
        runs[1].energy_error
    );
    let [awake, asleep] = [0, 1].map(|i: usize| runs[i].body_work);
    assert_eq!((awake.body_steps, awake.asleep_steps), (10 * runs[0].steps as u64, 0));
    let share = asleep.asleep_steps as f64 / asleep.body_steps as f64;
    assert!((share - (1.0 - still_from(&runs[1]) / 5.0)).abs() < 0.01, "{share}");
    // The manual's bound of a stack at rest: awake, it trembles by that much.
    assert!(apart(&runs) < 1e-3);
    // after one to three spans at rest: as it settles, a box comes farther in one half of a span than in the other
    assert!(still_from(&runs[1]) < 2.0);
    assert!(runs[1].energy_error < 1e-6);
    assert_eq!(runs[0].events, runs[1].events);
}

#[test]
fn a_ball_wakes_the_stack_that_it_falls_on() {
    let mut m = stack(3, 2.5);
    let mut ball = solid("ball", [0.02, -0.02, 1.8], [0.3; 3]);
    ball.shapes = vec![Shape::Sphere { center_m: [0.0; 3], radius_m: 0.15 }];
    ball.velocity_m_s = [0.1, 0.0, 7.0];
    m.bodies.push(ball);
    let runs = both(m.clone());
    // Without the ball the stack sleeps well before it comes down.
    m.bodies.pop();
    m.settings.sleep_speed_m_s = Some(SPEED_M_S);
    assert!(still_from(&simulate(&m).unwrap()) < 1.2);
    let hit = |run: &RunResult| run.events.iter().map(|e| e.time_s).find(|t| *t > 0.5).unwrap();
    println!("ball: {:.1e} m apart, hits at {:.4} and {:.4} s", apart(&runs), hit(&runs[0]), hit(&runs[1]));
    assert!(hit(&runs[0]) > 1.3 && (hit(&runs[0]) - hit(&runs[1])).abs() < 1e-3);
    assert!(apart(&runs) < 1e-3);
    assert!(runs[1].energy_error < 1e-6, "{}", runs[1].energy_error);
    let top = |i: usize| runs[1].frames[i].position_m[2];
    assert!(top(100) == top(130) && top(130) != top(180), "asleep, then struck");
}

#[test]
fn an_event_wakes_all_from_rest() {
    let mut m = stack(4, 1.6);
    m.events.push(Event { remove_bodies: vec!["box0".into()], ..Event::at("charge", 1.4) });
    let runs = both(m);
    let fall = runs[1].frames[140].position_m[3][2] - runs[1].frames[160].position_m[3][2];
    println!("event: {:.1e} m apart, falls {fall:.6} m in 0.2 s", apart(&runs));
    // Awake, the boxes begin to fall from a tremble of up to one step of gravity.
    assert!(apart(&runs) < 1e-3 * G * 0.2);
    assert!((fall - 0.5 * G * 0.04).abs() < 1e-4);
    assert!(runs[1].energy_error < 1e-6, "{}", runs[1].energy_error);
}

#[test]
fn bodies_on_a_bushing_sleep_together() {
    let mut m = on_ground("pair", 2.0);
    m.bodies.push(solid("left", [0.0, 0.0, 0.2], [0.6, 0.5, 0.4]));
    m.bodies.push(solid("right", [1.0, 0.0, 0.2], [0.6, 0.5, 0.4]));
    m.bushings.push(joint(
        "tie",
        Some("left"),
        "right",
        [0.5, 0.0, 0.2],
        1e6,
        1e4,
        [elastic(1e5), elastic(1e5)],
    ));
    let runs = both(m.clone());
    println!("bushing: {:.1e} m apart, still from {:.2} s", apart(&runs), still_from(&runs[1]));
    assert!(apart(&runs) < 1e-6 && still_from(&runs[1]) < 1.5);
    // One that slides keeps the other awake.
    m.bodies[1].velocity_m_s = [4.0, 0.0, 0.0];
    let runs = both(m);
    assert!(apart(&runs) < 1e-3, "{}", apart(&runs));
}

#[test]
fn sleep_is_for_models_without_ideal_joints_and_forces() {
    let mut m = stack(1, 0.1);
    m.settings.sleep_speed_m_s = Some(SPEED_M_S);
    m.forces.push(Force::Torque {
        id: "wind".into(),
        body: "box0".into(),
        torque_nm: [1.0, 0.0, 0.0],
        from_to_s: None,
    });
    let text = simulate(&m).unwrap_err().to_string();
    assert!(text.contains("settings.sleep_speed_m_s") && text.contains("leave it out"), "{text}");
    m.forces.clear();
    m.settings.sleep_speed_m_s = Some(-1.0);
    assert!(simulate(&m).unwrap_err().to_string().contains("settings.sleep_speed_m_s"));
}

/// What rests has kinetic energy at outputs, which its weight adds in half a step and its contacts take with the next one: they make none.
#[test]
fn nothing_is_said_of_bodies_at_rest() {
    let mut cube = on_ground("cube", 1.0);
    cube.bodies.push(solid("a", [0.0, 0.0, 0.5], [1.0; 3]));
    // a plank that leans on a wall, held by friction at its foot
    let mut plank = on_ground("plank", 1.0);
    let (lean, half) = (0.5_f64, [0.02, 0.3, 1.5]);
    let wall_m = 0.0;
    plank.contact.obstacles.push(ObstacleBox {
        id: "wall".into(),
        min_m: [wall_m, -5.0, -1.0],
        max_m: [1.0, 5.0, 10.0],
        friction: 0.4,
        restitution: 0.0,
    });
    let across = half[0] * lean.cos() + half[2] * lean.sin();
    let height = half[0] * lean.sin() + half[2] * lean.cos();
    let mut leaning = solid("plank", [wall_m - across, 0.0, height], half.map(|h| 2.0 * h));
    leaning.orientation = [(0.5 * lean).cos(), 0.0, (0.5 * lean).sin(), 0.0];
    plank.bodies.push(leaning);
    let mut slope = model("slope", 1.0, 0.01);
    let (sin, cos) = 0.45_f64.sin_cos();
    slope.contact.planes.push(ObstaclePlane {
        id: "slope".into(),
        point_m: [0.0; 3],
        normal: [sin, 0.0, cos],
        friction: 0.5,
        restitution: 0.0,
    });
    let mut block = solid("block", [0.3 * sin, 0.0, 0.3 * cos], [1.0, 1.0, 0.6]);
    block.orientation = [0.225_f64.cos(), 0.0, 0.225_f64.sin(), 0.0];
    slope.bodies.push(block);
    for m in [cube, plank, slope] {
        let result = simulate(&m).unwrap();
        let moved = result.frames.iter().map(|f| f.position_m[0]);
        let moved = moved.map(|x| math::norm(math::sub(x, m.bodies[0].position_m))).fold(0.0, f64::max);
        assert!(moved < 1e-3, "{}: {moved}", m.name);
        assert!(result.warnings.is_empty(), "{}: {:?}", m.name, result.warnings);
    }
}

/// A pendulum is slow for more than half a second where it turns round, and gathers speed there.
#[test]
fn what_turns_round_does_not_fall_asleep() {
    let mut m = model("pendulum", 6.0, 0.1);
    let mut bob = solid("bob", [0.0, 0.0, -9.81], [0.4; 3]);
    bob.velocity_m_s = [0.35, 0.0, 0.0];
    m.bodies.push(bob);
    m.bushings.push(joint("pivot", None, "bob", [0.0; 3], 1e7, 1e3, [elastic(0.0), elastic(0.0)]));
    m.settings.sleep_speed_m_s = Some(0.1);
    let result = simulate(&m).unwrap();
    assert_eq!(result.body_work.asleep_steps, 0);
    // l = g: one radian a second
    let off = result.times_s.iter().zip(&result.frames);
    let off = off.map(|(t, f)| (f.position_m[0][0] - 0.35 * t.sin()).abs()).fold(0.0, f64::max);
    println!("largest distance from the harmonic motion {off:.1e} m");
    assert!(off < 2e-3, "{off}");
}

/// A column that leans next to nothing past its balance tips over, however slowly it begins.
#[test]
fn what_begins_to_tip_over_does_not_fall_asleep() {
    let size: [f64; 3] = [0.4, 0.4, 3.5];
    let lean = (size[0] / size[2]).atan() + 1e-4;
    let half = 0.5 * (size[0] * size[0] + size[2] * size[2]).sqrt();
    let mut m = on_ground("leaning", 6.0);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.8, restitution: 0.0 });
    let height = half * ((size[0] / size[2]).atan() - lean).cos();
    m.bodies.push(Body {
        orientation: [(0.5 * lean).cos(), 0.0, (0.5 * lean).sin(), 0.0],
        ..solid("column", [0.0, 0.0, height], size)
    });
    m.settings.time_step_s = Some(1e-3);
    m.settings.sleep_speed_m_s = Some(0.1);
    let run = simulate(&m).unwrap();
    let end = run.frames.last().unwrap().position_m[0][2];
    assert!((end - 0.2).abs() < 1e-3, "stands at {end}");
}
