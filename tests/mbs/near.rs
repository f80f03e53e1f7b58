//! Ideal joints where something could touch: steps without points know nothing of contact, those with points find events as well.

use super::support::*;
use fallwerk::bench::mbs_trials::random;
use fallwerk::bench::soundness::Finished;
use fallwerk::mbs::model::*;
use fallwerk::mbs::{RunResult, SolverOptions, simulate, simulate_with};

/// A beam on a ball joint with a hinge, without weight, above the ground, that turns about a skew axis.
fn turning(omega: f64, stiffness_nm_rad: f64, capacity_nm: f64) -> Model {
    let mut m = model("turning", 1.0, 0.05);
    m.gravity_m_s2 = [0.0; 3];
    let beam = solid("beam", [0.0, 0.0, 2.0], [2.0, 0.3, 0.4]);
    m.bodies.push(Body { angular_velocity_rad_s: [0.2 * omega, 0.3 * omega, omega], ..beam });
    m.joints.push(ideal("ball", JointKind::Spherical, None, "beam", [0.0, 0.0, 2.0]));
    m.forces.push(Force::Hinge {
        id: "hinge".into(),
        body_a: None,
        body_b: "beam".into(),
        stiffness_nm_rad,
        capacity: vec![[0.0, capacity_nm]],
        fracture_rad: None,
        joint: None,
    });
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.1 });
    m
}

fn run(m: &Model, skip: bool) -> RunResult {
    let mut options = SolverOptions::default();
    options.contact.skip = skip;
    simulate_with(m, &options).unwrap()
}

/// The paths of a vibration use up the bound on what can touch again and again.
#[test]
fn looking_for_contact_leaves_the_method_of_a_step_alone() {
    let mut near = turning(2.0, 2e7, 1e9);
    near.contact.ground.as_mut().unwrap().level_m = 1.6;
    let mut alone = near.clone();
    alone.contact.ground = None;
    alone.settings.reactions = true;
    alone.settings.output_interval_s = 1.0;
    let [near, alone] = [&near, &alone].map(|m| run(m, true));
    let looks = near.contact_work.pairs_looked_at;
    println!("{} steps, {looks} looks, energy error {:.1e}", near.steps, near.energy_error);
    assert_eq!(near.steps, alone.steps);
    let [a, b] = [&near, &alone].map(|r| *r.energies.kinetic_j.last().unwrap());
    assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    assert!(looks > 3 && near.contact_work.quiet_steps as usize == near.steps);
}

/// A stiff hinge that flows from the first microseconds on: the estimate of the error of a step sees nothing of its elastic part.
#[test]
fn a_hinge_that_flows_at_once_takes_what_its_capacity_does() {
    let result = simulate(&turning(2.0, 4e7, 500.0)).unwrap();
    let plastic_j = result.energies.plastic_j.last().unwrap();
    println!("plastic work {plastic_j:.1} J, energy error {:.1e}", result.energy_error);
    assert!(*plastic_j > 0.5 * result.energies.kinetic_j[0]);
    assert!(result.energy_error < 1e-5, "{}", result.energy_error);
}

/// A beam that begins in an obstacle has points in all of its steps.
#[test]
fn a_hinge_of_a_body_in_contact_takes_what_its_capacity_does() {
    let mut m = turning(2.0, 4e7, 500.0);
    m.contact.obstacles.push(ObstacleBox {
        id: "post".into(),
        min_m: [-0.1, -0.1, 0.0],
        max_m: [0.1, 0.1, 1.9],
        friction: 0.0,
        restitution: 0.0,
    });
    let result = simulate(&m).unwrap();
    let work = result.contact_work;
    println!(
        "{} of {} steps without search, energy error {:.1e}",
        work.quiet_steps, result.steps, result.energy_error
    );
    assert!(work.quiet_steps * 2 < result.steps as u64);
    assert!(result.energy_error < 1e-5, "{}", result.energy_error);
}

/// A block that turns as it falls beside a pendulum: long steps have its corners on the ground that the steps in contact, which follow, do not.
fn tumbling() -> Model {
    let mut m = turning(2.0, 2e3, 500.0);
    m.gravity_m_s2 = [0.0, 0.0, -G];
    m.settings.end_time_s = 0.8;
    let block = solid("block", [4.0, 0.0, 1.2], [0.4, 0.5, 0.3]);
    m.bodies.push(Body {
        velocity_m_s: [-1.0, 0.5, -1.0],
        angular_velocity_rad_s: [-1.9, -1.5, -2.5],
        ..block
    });
    m
}

/// A prop under a beam is taken away: the points of the last step are gone with it.
fn propped() -> Model {
    let mut m = turning(0.0, 2e5, 500.0);
    m.gravity_m_s2 = [0.0, 0.0, -G];
    let prop = solid("prop", [0.8, 0.0, 0.9], [0.2, 0.2, 1.8]);
    m.bodies.push(prop);
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    m.events.push(Event { remove_bodies: vec!["prop".into()], ..Event::at("cut", 0.2) });
    m
}

#[test]
fn what_is_skipped_changes_nothing_on_ideal_joints() {
    let mut falling = turning(2.0, 2e5, 500.0);
    falling.gravity_m_s2 = [0.0, 0.0, -G];
    let release = vec!["ball".into(), "hinge".into()];
    falling.events.push(Event { release, ..Event::at("cut", 0.2) });
    for m in [falling, tumbling(), propped(), random(17), random(108)] {
        let [some, all] = [true, false].map(|skip| run(&m, skip));
        assert_eq!(some.frames, all.frames, "{}", m.name);
        assert_eq!(some.energies, all.energies, "{}", m.name);
        assert_eq!((all.contact_work.quiet_steps, all.contact_work.pairs_left_alone), (0, 0));
        assert!(some.contact_work.quiet_steps > 0, "{}", m.name);
    }
}

/// Random hinge structures whose energy grew by 4e-4 to 1.6e-3 as long as steps that looked for contact were those of contact (17 to 1859), and such as are over ground and pass singular poses again and again (139 to 9503).
#[test]
fn random_structures_keep_their_energy() {
    for seed in [17, 46, 184, 1859, 139, 1378, 9503] {
        let model = random(seed);
        let result = simulate(&model).unwrap();
        let shown = Finished::of(&model, &result);
        let (error, depth_m) = (shown.energy_error, shown.passing.ground.depth_m);
        println!("{seed}: energy error {error:.1e}, depth {depth_m:.1e} m, {} steps", result.steps);
        assert!(error < 2e-4 && shown.growth < 1e-4 && depth_m < 1e-4, "{seed}: {shown:?}");
    }
}
