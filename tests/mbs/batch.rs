//! Many runs of one model: names of numbers, the same bytes as single runs.

use super::support::*;
use fallwerk::mbs::batch::{self, Table, varied};
use fallwerk::mbs::model::*;
use fallwerk::mbs::parameter::apply;
use fallwerk::mbs::{SolverOptions, simulate, simulate_with};

fn falling() -> Model {
    let mut m = model("fall", 0.5, 0.1);
    m.bodies.push(solid("a", [0.0, 0.0, 5.0], [1.0; 3]));
    m.bodies.push(solid("b", [3.0, 0.0, 5.0], [1.0; 3]));
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: RESTITUTION });
    track(&mut m, "b", [3.0, 0.0, 5.0]);
    m
}

#[test]
fn names_follow_the_file() {
    let mut m = falling();
    assert_eq!(apply(&mut m, "bodies.b.velocity_m_s.2", -3.0).unwrap(), 1);
    assert_eq!(apply(&mut m, "bodies.*.mass_factor", 2.0).unwrap(), 2);
    assert_eq!(apply(&mut m, "contact.ground.friction", 0.1).unwrap(), 1);
    assert_eq!((m.bodies[1].velocity_m_s[2], m.bodies[0].mass_kg), (-3.0, 5000.0));
    assert_eq!(m.bodies[0].inertia_kg_m2[0][0], 5000.0 / 6.0);
    // ids of generated models have dots
    (m.bodies[0].id, m.bodies[1].id) = ("C1-A1".into(), "C1-A1.top".into());
    assert_eq!(apply(&mut m, "bodies.C1-A1.top.mass_kg", 7.0).unwrap(), 1);
    assert_eq!(apply(&mut m, "bodies.C1-A1.position_m.1", 8.0).unwrap(), 1);
    assert_eq!((m.bodies[1].mass_kg, m.bodies[0].position_m[1]), (7.0, 8.0));
    let text = apply(&mut m, "bodies.C2-A1.top.velocity_m_s.2", 7.0).unwrap_err().to_string();
    assert!(text.contains("\"C2-A1.top\" is not the id of a body (did you mean \"C1-A1.top\"?)"), "{text}");
    (m.bodies[0].id, m.bodies[1].id) = ("a".into(), "b".into());
    for (name, expected) in [
        ("body.a.mass_kg", "begins with bodies, bushings"),
        ("bodies.c.mass_kg", "\"c\" is not the id of a body (did you mean"),
        ("bodies.a.colour", "expected mass_factor"),
        ("contact.bodies.friction", "no such contact"),
        ("contact.planes.p.friction", "surfaces of planes, obstacles and single pairs cannot be varied"),
        ("gravity_m_s2.3", "expected 0, 1 or 2"),
        ("settings.output_interval_s", "expected end_time_s, time_step_s or tolerance"),
    ] {
        let text = apply(&mut m, name, 1.0).unwrap_err().to_string();
        assert!(text.starts_with(name) && text.contains(expected), "{text}");
    }
}

#[test]
fn a_batch_gives_what_single_runs_give_and_a_bad_row_hurts_no_other() {
    let m = falling();
    let names = vec!["bodies.b.velocity_m_s.2".to_string(), "bodies.b.mass_factor".to_string()];
    let rows = vec![vec![-1.0, 1.0], vec![2.0, -1.0], vec![0.5, 3.0]];
    let table = Table { names, rows };
    let found = batch::run(&m, &table, &SolverOptions::default(), &|| {}).unwrap();
    assert!(found[1].as_ref().unwrap_err().to_string().contains("bodies[1].mass_kg"));
    for i in [0, 2] {
        let alone = simulate(&varied(&m, &table.names, &table.rows[i]).unwrap()).unwrap();
        assert_eq!(found[i].as_ref().unwrap().displacements_m[0], alone.tracked[0].displacement_m[5]);
        let wanted = 0.5 * table.rows[i][0] - 0.5 * G * 0.25;
        assert!((alone.tracked[0].displacement_m[5][2] - wanted).abs() < 1e-9);
    }
    let brief = SolverOptions { brief: true, ..SolverOptions::default() };
    let (all, few) = (simulate(&m).unwrap(), simulate_with(&m, &brief).unwrap());
    assert!(few.frames.is_empty() && !all.frames.is_empty());
    assert_eq!((few.tracked, few.energies, few.steps), (all.tracked, all.energies, all.steps));
    let short = Table { rows: vec![vec![1.0]], ..table };
    let text = batch::run(&m, &short, &SolverOptions::default(), &|| {}).unwrap_err().to_string();
    assert_eq!(text, "row 1 has 1 values, expected 2, one for each name");
}

/// A table of steps shows how the answer depends on them.
#[test]
fn steps_can_be_varied() {
    let m = falling();
    let table =
        Table { names: vec!["settings.time_step_s".into()], rows: vec![vec![0.01], vec![0.002], vec![0.0]] };
    let found = batch::run(&m, &table, &SolverOptions::default(), &|| {}).unwrap();
    assert!(found[2].as_ref().unwrap_err().to_string().contains("settings.time_step_s"));
    let [coarse, fine] = [0, 1].map(|i| found[i].as_ref().unwrap());
    assert!(
        coarse.steps >= 50 && fine.steps >= 250 && coarse.steps < fine.steps,
        "{} {}",
        coarse.steps,
        fine.steps
    );
    let alone = simulate(&varied(&m, &table.names, &table.rows[1]).unwrap()).unwrap();
    assert_eq!((fine.steps, fine.displacements_m[0]), (alone.steps, alone.tracked[0].displacement_m[5]));
    assert!((fine.displacements_m[0][2] + 0.5 * G * 0.25).abs() < 1e-3, "{:?}", fine.displacements_m);
}

#[test]
fn names_that_set_one_number_are_refused() {
    let m = falling();
    let names =
        |list: [&str; 2]| Table { names: list.map(String::from).to_vec(), rows: vec![vec![1.0, 2.0]] };
    let run = |list| batch::run(&m, &names(list), &SolverOptions::default(), &|| {}).map(|_| ());
    for list in [
        ["bodies.*.velocity_m_s.2", "bodies.b.velocity_m_s.2"],
        ["bodies.b.velocity_m_s.2", "bodies.*.velocity_m_s.2"],
        ["bodies.b.mass_kg", "bodies.b.mass_factor"],
    ] {
        let text = run(list).unwrap_err().to_string();
        let [earlier, later] = list;
        assert_eq!(text, format!("\"{later}\" sets what \"{earlier}\" sets as well: leave one of them out"));
    }
    // factors multiply in either order, and these are different numbers
    for list in [
        ["bodies.*.mass_factor", "bodies.b.mass_factor"],
        ["bodies.*.velocity_m_s.2", "bodies.b.velocity_m_s.1"],
        ["bodies.a.velocity_m_s.2", "bodies.b.velocity_m_s.2"],
    ] {
        run(list).unwrap();
    }
}

/// A lighter building is one with all its masses: what bodies have together, and the weight of spans, go along.
#[test]
fn masses_that_stand_beside_bodies_follow_them() {
    let mut m = falling();
    let added = [[-500.0, 0.0, 0.0], [0.0; 3], [0.0; 3]];
    let blocks = vec![MassBlock { pair: [0, 0], added }, MassBlock { pair: [1, 1], added }];
    m.shared_masses.push(SharedMass { bodies: vec!["a".into(), "b".into()], blocks });
    let factors = |names: &[&str], values: &[f64]| {
        let names: Vec<String> = names.iter().map(|n| n.to_string()).collect();
        varied(&m, &names, values).unwrap().shared_masses[0].blocks[0].added[0][0] / -500.0
    };
    assert_eq!(factors(&["bodies.*.mass_factor"], &[0.8]), 0.8);
    assert_eq!(factors(&["bodies.*.mass_factor"], &[1.5]), 1.5);
    // never more than bodies have
    assert_eq!(factors(&["bodies.a.mass_factor"], &[0.5]), 0.5);
    assert_eq!(factors(&["bodies.a.mass_factor", "bodies.b.mass_factor"], &[2.0, 4.0]), 2.0);
    assert_eq!(factors(&["gravity_m_s2.2"], &[-5.0]), 1.0);
}
