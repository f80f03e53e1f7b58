//! Runs that are not sound: made unstable, given energy, broken.

use super::mesh::{elastic, grid};
use fallwerk::base::tree::Format;
use fallwerk::building::{Building, parse};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::deck::of_building;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::model_run::{ModelError, ModelOptions, run_model};
use fallwerk::fe::run::{FeError, FeOptions, run};
use fallwerk::fe::watch::{Books, Diagnosis, Trouble, Watch};

fn frame() -> Building {
    parse(include_str!("../../src/bench/mini.toml"), Format::Toml, "mini.toml").unwrap()
}

fn forced(share: f64) -> FeOptions {
    FeOptions { step_safety: Some(share), step_forced: true, end_time_s: Some(0.2), ..FeOptions::default() }
}

/// A building run with a step a sixth beyond the limit: found before it loses elements to it, and said where.
#[test]
fn a_building_with_too_long_a_step_is_stopped() {
    for share in [1.17, 1.44, 2.25] {
        let error = run(&frame(), &forced(share), &mut |_| ()).unwrap_err();
        let FeError::Unsound(diagnosis) = &error else { panic!("{error}") };
        let Diagnosis { trouble, smallest, fastest, sound_s, time_s, .. } = &**diagnosis;
        let found = match trouble {
            Trouble::Alternates(part, over) if *over > 1.0 && *over < share => part.clone(),
            Trouble::Released(over) if *over > 0.1 => "died".to_string(),
            Trouble::Hourglass(over) if *over < -0.1 => "hourglass".to_string(),
            _ => panic!("{error}"),
        };
        assert!(sound_s <= time_s && *time_s < 0.1, "{error}");
        assert!(fastest.as_ref().is_some_and(|n| n.value > 0.1), "{error}");
        let smallest = smallest.as_ref().expect("an element acts");
        let text = error.to_string();
        for word in [found.as_str(), &format!("element {}", smallest.index), "finer mesh", "limit"] {
            assert!(text.contains(word), "{word}: {text}");
        }
    }
    assert!(run(&frame(), &forced(0.9), &mut |_| ()).is_ok());
    let refused = run(&frame(), &FeOptions { step_forced: false, ..forced(1.17) }, &mut |_| ());
    assert_eq!(refused.unwrap_err(), FeError::StepShare { share: 1.17 });
}

/// The same as a deck's model, recorded so seldom that only the looks between records can find it.
#[test]
fn a_model_with_too_long_a_step_is_stopped() {
    let without = FeOptions { body_contact: false, ..FeOptions::default() };
    let mut model = of_building(&frame(), &without).unwrap().model;
    model.control.end_time_s = 0.1;
    model.control.history_interval_s = 0.1;
    model.control.step_safety = 1.44;
    let options = ModelOptions { step_forced: true, ..ModelOptions::default() };
    let error = run_model(&model, &options, None, &mut |_| ()).unwrap_err();
    let ModelError::Broken(FeError::Unsound(diagnosis)) = &error else { panic!("{error}") };
    assert!(matches!(diagnosis.trouble, Trouble::Alternates(..) | Trouble::Released(_)), "{error}");
    assert!(diagnosis.time_s < 0.05, "{error}");
    let refused = run_model(&model, &ModelOptions::default(), None, &mut |_| ()).unwrap_err();
    assert!(matches!(refused, ModelError::Broken(FeError::StepShare { .. })), "{refused}");
    model.control.step_safety = 0.9;
    assert!(run_model(&model, &options, None, &mut |_| ()).is_ok());
}

/// A block with a node that vibrates, 100 steps on.
fn vibrating() -> (fallwerk::fe::mesh::Mesh, Dynamics, f64, f64) {
    let mesh = grid([3, 3, 3], [3.0; 3], elastic(), |p| p[2] == 0.0);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let top = mesh.nodes.iter().position(|p| *p == [3.0; 3]).unwrap();
    body.v[top] = [0.0, 0.0, 0.1];
    let initial_j = body.kinetic_j();
    let kinetic_j = (0..100).map(|_| body.step(true)).last().unwrap();
    (mesh, body, initial_j, kinetic_j)
}

fn trouble(
    watch: &mut Watch,
    mesh: &fallwerk::fe::mesh::Mesh,
    body: &Dynamics,
    books: &Books,
) -> Option<Diagnosis> {
    match watch.look(mesh, body, books) {
        Ok(()) => None,
        Err(FeError::Unsound(d)) => Some(*d),
        Err(e) => panic!("{e}"),
    }
}

/// Energy from nowhere and energy lost, each by an entry of the books that changes without its counterpart.
#[test]
fn energy_from_nowhere_or_lost_is_found() {
    let (mesh, mut body, initial_j, kinetic_j) = vibrating();
    let mut watch = Watch::new(0.0);
    let sound = Books::of(&body, kinetic_j, initial_j, 0.0);
    assert_eq!(trouble(&mut watch, &mesh, &body, &sound), None);
    body.v.as_flattened_mut().iter_mut().for_each(|v| *v *= 1.5);
    let kinetic_j = body.step(true);
    let found = trouble(&mut watch, &mesh, &body, &Books::of(&body, kinetic_j, initial_j, 0.0)).unwrap();
    assert!(matches!(found.trouble, Trouble::Balance(share) if share > 0.1), "{found}");
    assert_eq!((found.grown.0, found.sound_s), ("kinetic energy", sound.time_s), "{found}");
    for (factor, found) in [(0.95, false), (0.8, true)] {
        let less =
            Books { internal_j: factor * sound.internal_j, kinetic_j: factor * sound.kinetic_j, ..sound };
        let diagnosis = trouble(&mut Watch::new(0.0), &mesh, &body, &less);
        assert_eq!(diagnosis.is_some(), found, "{factor} {diagnosis:?}");
    }
    let released =
        Books { released_j: 0.2 * initial_j, internal_j: sound.internal_j + 0.2 * initial_j, ..sound };
    let found = trouble(&mut Watch::new(0.0), &mesh, &body, &released).unwrap();
    assert!(matches!(found.trouble, Trouble::Released(share) if (share - 0.2).abs() < 1e-9), "{found}");
    assert_eq!(trouble(&mut Watch::new(1e9), &mesh, &body, &released), None, "far below what is judged");
}

#[test]
fn what_is_no_number_is_found() {
    let (mesh, mut body, initial_j, kinetic_j) = vibrating();
    let sound = Books::of(&body, kinetic_j, initial_j, 0.0);
    for bad in [f64::NAN, f64::INFINITY] {
        let books = Books { viscous_j: bad, ..sound };
        let found = trouble(&mut Watch::new(0.0), &mesh, &body, &books).unwrap();
        assert_eq!((&found.trouble, found.grown.0), (&Trouble::NotFinite(None), "work of bulk viscosity"));
    }
    body.v[7][1] = f64::NAN;
    let found = trouble(&mut Watch::new(0.0), &mesh, &body, &sound).unwrap();
    assert_eq!(found.trouble, Trouble::NotFinite(Some(7)));
    assert!(found.to_string().contains("node 7 has no finite"), "{found}");
}
