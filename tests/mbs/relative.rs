//! Inertia against relative motion: fast vibrations slow down by a known factor, nothing else changes, and it ends where something touches.

use super::shared_mass::{halves, shared};
use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::RunResult;
use fallwerk::mbs::{math, simulate};

/// Bound of all frequencies [rad/s].
const MOST_RAD_S: f64 = 1600.0;

/// A load on a soft spring, and a block on a stiff one that hangs below it: modes of about `10` and `soft` to `5000` rad/s.
fn pair(end_s: f64) -> Model {
    let mut m = model("pair", end_s, 1e-3);
    let soft = [elastic(1e9), elastic(1e9)];
    m.bodies.push(solid("load", [0.0, 0.0, 4.0], [1.0; 3]));
    m.bodies.push(solid("block", [0.0, 0.0, 3.0], [0.4; 3]));
    let spring = |id: &str, a: Option<&str>, b: &str, z: f64, k: f64| Bushing {
        shear_stiffness_n_m: [1e8; 2],
        ..joint(id, a, b, [0.0, 0.0, z], k, 1e8, soft.clone())
    };
    m.bushings.push(spring("soft", None, "load", 4.5, 1e6));
    m.bushings.push(spring("stiff", Some("load"), "block", 3.5, 4e9));
    track(&mut m, "load", [0.0, 0.0, 4.0]);
    m
}

fn with(mut m: Model) -> [RunResult; 2] {
    let plain = simulate(&m).unwrap();
    m.settings.relative_inertia_rad_s = Some(MOST_RAD_S);
    [plain, simulate(&m).unwrap()]
}

/// Angular frequency of the height of the first point about its mean, from its first and last upward passage [rad/s].
fn frequency(run: &RunResult) -> f64 {
    let z: Vec<f64> = run.tracked[0].displacement_m.iter().map(|u| u[2]).collect();
    let mean =
        0.5 * (z.iter().cloned().fold(f64::MIN, f64::max) + z.iter().cloned().fold(f64::MAX, f64::min));
    let up = |i: &usize| z[i - 1] < mean && z[*i] >= mean;
    let at = |i: usize| {
        let share = (mean - z[i - 1]) / (z[i] - z[i - 1]);
        run.times_s[i - 1] + share * (run.times_s[i] - run.times_s[i - 1])
    };
    let passages: Vec<f64> = (1..z.len()).filter(up).map(at).collect();
    2.0 * std::f64::consts::PI * (passages.len() - 1) as f64 / (passages[passages.len() - 1] - passages[0])
}

#[test]
fn slow_motion_is_as_fast_and_steps_are_longer() {
    let [plain, related] = with(pair(3.0));
    let [before, after] = [&plain, &related].map(frequency);
    println!("{before} and {after} rad/s in {} and {} steps", plain.steps, related.steps);
    // ω / sqrt(1 + ω²/ω_m²), 2e-4 below ω at 20 rad/s
    let slower = (1.0 + (before / MOST_RAD_S).powi(2)).sqrt().recip();
    assert!((after / before - slower).abs() < 2e-5, "{before} {after}");
    assert!(2 * related.steps < plain.steps, "{} for {}", related.steps, plain.steps);
    assert!(related.energy_error < 1e-4, "{}", related.energy_error);
    let mean = |run: &RunResult| {
        run.tracked[0].displacement_m.iter().map(|u| u[2]).sum::<f64>() / run.times_s.len() as f64
    };
    assert!((mean(&related) / mean(&plain) - 1.0).abs() < 1e-3);
}

/// A single mass on a spring: its frequency is that of `M + K / ω²`.
#[test]
fn a_fast_mode_slows_down_by_the_factor_of_its_frequency() {
    let mut m = model("one", 0.5, 1e-4);
    // its weight sets it going
    m.bodies.push(solid("block", [0.0, 0.0, 1.0], [0.4; 3]));
    let mass = m.bodies[0].mass_kg;
    // what bounds the steps
    m.bodies.push(solid("other", [5.0, 0.0, 1.0], [0.4; 3]));
    let omega: f64 = 400.0;
    let ends = || [elastic(1e7), elastic(1e7)];
    let k = mass * omega * omega;
    m.bushings.push(Bushing {
        axial_stiffness_n_m: k,
        ..joint("spring", None, "block", [0.0, 0.0, 1.0], 1e7, 1e6, ends())
    });
    m.bushings.push(joint("stiff", None, "other", [5.0, 0.0, 1.0], 1e10, 1e6, ends()));
    track(&mut m, "block", [0.0, 0.0, 1.0]);
    let [plain, related] = with(m);
    let h = related.times_s[1] - related.times_s[0];
    let expected = omega / (1.0 + (omega / MOST_RAD_S).powi(2)).sqrt();
    // steps end at outputs; a leapfrog is faster by (ω h)² / 24
    let leap = 1.0 + (expected * h).powi(2) / 24.0;
    let found = frequency(&related);
    println!("{} and {found} rad/s, expected {expected}", frequency(&plain));
    assert!((frequency(&plain) / omega - 1.0).abs() < 1e-3);
    assert!((found / (expected * leap) - 1.0).abs() < 1e-3, "{found} {expected}");
}

/// Rigid motion has nothing to do with it: two blocks on a stiff spring fly and turn as without, and keep their momentum.
#[test]
fn rigid_motion_is_as_without() {
    let mut m = pair(0.5);
    m.bushings.remove(0);
    m.gravity_m_s2 = [0.0, 0.0, -G];
    // velocities of a rigid body about the common centre of mass, slow enough to stay upright
    let spin = [0.0, 0.02, 0.0];
    let mass: f64 = m.bodies.iter().map(|b| b.mass_kg).sum();
    let centre = m.bodies.iter().map(|b| b.mass_kg * b.position_m[2]).sum::<f64>() / mass;
    for body in &mut m.bodies {
        let arm = [0.0, 0.0, body.position_m[2] - centre];
        body.velocity_m_s = math::add([1.0, 0.0, 0.0], math::cross(spin, arm));
        body.angular_velocity_rad_s = spin;
    }
    let masses: Vec<f64> = m.bodies.iter().map(|b| b.mass_kg).collect();
    let [plain, related] = with(m);
    assert!(related.steps < plain.steps);
    for (a, b) in plain.frames.iter().zip(&related.frames) {
        for (x, y) in a.position_m.iter().zip(&b.position_m) {
            assert!(math::norm(math::sub(*x, *y)) < 1e-6);
        }
    }
    let place = |i: usize| {
        let of =
            |k: usize| -> f64 { (0..2).map(|b| masses[b] / mass * related.frames[i].position_m[b][k]).sum() };
        [of(0), of(2)]
    };
    let ([x0, z0], t) = (place(0), related.times_s[related.times_s.len() - 1]);
    let [x, z] = place(related.times_s.len() - 1);
    assert!((x - x0 - t).abs() < 1e-9 && (z - z0 + 0.5 * G * t * t).abs() < 1e-9, "{x} {z}");
}

/// Velocities that strain a stiff spring would have to give its inertia energy that they have not: all goes on as without.
#[test]
fn it_does_not_begin_where_velocities_strain_springs() {
    let mut m = pair(0.3);
    m.bodies[1].velocity_m_s = [0.0, 0.0, 2.0];
    let [plain, related] = with(m);
    println!("energy error {:.1e} and {:.1e}", plain.energy_error, related.energy_error);
    assert_eq!((&plain.frames, &plain.energies), (&related.frames, &related.energies));
    let said = related.warnings.iter().filter(|w| w.contains("settings.relative_inertia_rad_s is not used"));
    assert_eq!(said.count(), 1, "{:?}", related.warnings);
    // with what is slow it begins, and energies hold
    let mut m = pair(1.0);
    m.bodies.iter_mut().for_each(|b| b.velocity_m_s = [0.0, 0.0, 0.5]);
    let [plain, related] = with(m);
    println!("energy error {:.1e} in {} for {} steps", related.energy_error, related.steps, plain.steps);
    assert!(2 * related.steps < plain.steps, "{} for {}", related.steps, plain.steps);
    assert!(related.energy_error < 1e-3 && related.energy_growth < 1e-4, "{}", related.energy_error);
    assert!(related.warnings.iter().all(|w| !w.contains("relative_inertia")), "{:?}", related.warnings);
}

/// A blow acts on the masses of the bodies alone: it ends then, and all goes on as without.
#[test]
fn it_ends_where_something_strikes() {
    let mut m = pair(0.6);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    m.bushings.remove(0);
    m.bodies[0].position_m[2] -= 2.5;
    m.bodies[1].position_m[2] -= 2.5;
    m.bushings.iter_mut().for_each(|b| b.point_m[2] -= 2.5);
    let [plain, related] = with(m);
    assert_eq!(plain.events.len(), related.events.len(), "{:?} {:?}", plain.events, related.events);
    let [a, b] = [&plain, &related].map(|run| run.first_ground_contact_s.unwrap());
    let fallen = (2.0 * 0.3 / G).sqrt();
    // to a step of the run without
    assert!((a - fallen).abs() < 1.1e-4 && (b - a).abs() < 1e-6, "{a} {b} {fallen}");
    assert!(related.steps < plain.steps);
    // the stiff spring rings from the blow on, at steps of 0.8 of the limit, in both
    let [a, b] = [&plain, &related].map(|run| run.energy_error);
    assert!((a - b).abs() < 1e-6, "{a} {b}");
}

/// Both bodies fly, a tenth of a metre a second against each other, and turn.
fn flying(spin_rad_s: f64) -> Model {
    let mut m = pair(1.2);
    m.bushings.remove(0);
    m.gravity_m_s2 = [0.0; 3];
    m.bodies[0].velocity_m_s = [0.0, 0.0, 10.0];
    m.bodies[1].velocity_m_s = [-spin_rad_s, 0.0, 9.9];
    m.bodies.iter_mut().for_each(|b| b.angular_velocity_rad_s = [0.0, spin_rad_s, 0.0]);
    m
}

/// Inertia that the stiff spring of [`flying`] begins with \[J\].
fn taken_j() -> f64 {
    0.5 * 4e9 / MOST_RAD_S.powi(2) * 0.1 * 0.1
}

/// It ends while a stiff spring vibrates: the last step is finished with it, so that the plain spring is not pushed for half a long step.
#[test]
fn a_vibration_keeps_its_energy_when_it_ends() {
    let mut m = flying(0.05);
    // somewhere else a block strikes the ground after 0.6 s
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    let stone = Body { velocity_m_s: [0.0, 0.0, -5.0], ..solid("stone", [10.0, 0.0, 3.2], [0.4; 3]) };
    m.bodies.push(stone);
    let [plain, related] = with(m);
    assert!(related.steps > plain.steps / 2 && related.steps < plain.steps, "{}", related.steps);
    let e = &related.energies;
    let released = e.released_j.last().unwrap();
    println!("growth {:.1e}, {released} J of {} released", related.energy_growth, e.kinetic_j[0]);
    assert!(related.energy_growth < 1e-4, "{}", related.energy_growth);
    // at the start the vibration takes over `½ k/ω² v²` of inertia, in the end it gives back what it has then
    assert!(*released > -1.01 * taken_j() && *released < 0.01 * taken_j(), "{released} J, {} J", taken_j());
}

/// It begins anew in the poses of the time whenever bodies have turned by 0.1 rad: steps stay long, and energies hold.
#[test]
fn it_goes_on_while_bodies_turn() {
    let [plain, related] = with(flying(0.5));
    assert!(2 * related.steps < plain.steps, "{} for {}", related.steps, plain.steps);
    let e = &related.energies;
    // at steps of up to 1.8 / ω a vibration seems to have more energy at some of its phases than at others, no more in the end than at the start
    let most =
        |from: usize, to: usize| (from..to).map(|i| (e.total_j(i) - e.total_j(0)).abs()).fold(0.0, f64::max);
    let (count, first) = (related.times_s.len(), most(0, related.times_s.len() / 6));
    let last = most(5 * count / 6, count);
    assert!(first < 2.0 * taken_j() && last < 1.1 * first, "{first} and {last} J of {}", taken_j());
    let ends = [&plain, &related].map(|run| run.frames[run.frames.len() - 1].position_m[0]);
    assert!(math::norm(math::sub(ends[0], ends[1])) < 1e-3, "{ends:?}");
}

/// What turns fast ends it: all goes on as without, and nothing is taken from the rotation.
#[test]
fn it_does_not_slow_what_spins() {
    let [plain, related] = with(flying(30.0));
    assert_eq!(plain.frames, related.frames);
    assert_eq!(related.energies.released_j.last(), Some(&0.0));
}

/// What floors share is part of it.
#[test]
fn shared_inertia_is_part_of_it() {
    let mut m = halves();
    m.bodies[0].velocity_m_s = [0.0, 0.0, 0.1];
    m.bodies[1].velocity_m_s = [0.0, 0.0, 0.1];
    m.bodies[0].angular_velocity_rad_s = [0.0, 0.1, 0.0];
    m.bodies[1].angular_velocity_rad_s = [0.0, -0.1, 0.0];
    m.shared_masses.push(shared());
    m.settings.end_time_s = 0.2;
    let [plain, related] = with(m);
    assert!(related.steps < plain.steps);
    assert!(related.energy_error < 1e-3, "{}", related.energy_error);
    let apart = plain.frames.iter().zip(&related.frames).flat_map(|(a, b)| {
        a.position_m.iter().zip(&b.position_m).map(|(x, y)| math::norm(math::sub(*x, *y)))
    });
    let largest = apart.fold(0.0, f64::max);
    println!("{largest} m apart");
    assert!(largest < 5e-4, "{largest}");
}

#[test]
fn it_needs_a_positive_frequency() {
    let mut m = pair(0.1);
    m.settings.relative_inertia_rad_s = Some(0.0);
    let text = simulate(&m).unwrap_err().to_string();
    assert!(text.contains("settings.relative_inertia_rad_s"), "{text}");
}

/// A floor on columns that bear half of it falls as they do without inertia against relative motion: springs that flow ask for none.
#[test]
fn what_springs_let_go_at_their_capacity_falls_freely() {
    let run = |related: Option<f64>| {
        let mut m = model("crushed", 0.3, 1e-2);
        m.bodies.push(solid("floor", [0.0, 0.0, 6.0], [4.0, 4.0, 0.5]));
        let mass = m.bodies[0].mass_kg;
        m.settings.preload = false;
        for (i, [x, y]) in [[-3.0, -3.0], [-3.0, 3.0], [3.0, -3.0], [3.0, 3.0]].into_iter().enumerate() {
            m.bushings.push(Bushing {
                compressive_capacity_n: Some(0.125 * mass * 9.81),
                ..joint(
                    &format!("c{i}"),
                    None,
                    "floor",
                    [x, y, 5.75],
                    1.5e9,
                    1e8,
                    [elastic(1e8), elastic(1e8)],
                )
            });
        }
        track(&mut m, "floor", [0.0, 0.0, 6.0]);
        m.settings.relative_inertia_rad_s = related;
        let run = simulate(&m).unwrap();
        -run.tracked[0].displacement_m.last().unwrap()[2]
    };
    let free = 0.5 * (0.5 * 9.81) * 0.3 * 0.3;
    for related in [None, Some(640.0)] {
        let fell = run(related);
        // it ends with the output that shows it: until then it holds the floor back
        assert!((fell / free - 1.0).abs() < 0.04, "{related:?}: {fell} of {free}");
    }
}
