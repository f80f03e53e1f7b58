//! What is written is read back to the last bit.

use super::super::mesh::{bilinear, elastic, grid, point};
use super::{CUBE, good, same};
use fallwerk::base::random::Random;
use fallwerk::base::tree::Format;
use fallwerk::fe::deck::{normalised, of_building, write};
use fallwerk::fe::law::{CowperSymonds, ElementForm, Erosion, Hourglass, Law};
use fallwerk::fe::mesh::Truss;
use fallwerk::fe::model::{
    BodyLoad, Constraint, ContactSettings, Curve, DrivenNode, Model, NodalLoad, RigidPlane,
};
use fallwerk::fe::run::FeOptions;

/// A model with all that a deck can say and awkward numbers.
fn rich() -> Model {
    let mut random = Random::after(7);
    let mut mesh = grid([3, 2, 2], [1.0, 0.7, 0.3], elastic(), |p| p[0] == 0.0);
    for x in mesh.nodes.as_flattened_mut() {
        *x += 1e-3 * random.symmetric();
    }
    mesh.nodes[0][0] = -1.2246467991473532e-16; // 17 digits, negative, small: needs a parameter
    mesh.nodes[1][1] = -0.0;
    let with = |form, law: Law| Law { form, ..law };
    let long: Vec<_> = (0..12).map(|i| point(0.013 * f64::from(i), 1e6 / 3.0 + 1e4 * f64::from(i))).collect();
    mesh.laws = vec![
        with(ElementForm::OnePoint(Hourglass::Viscous { coefficient: 0.1 / 3.0 }), elastic()),
        Law {
            hardening: long,
            rate: Some(CowperSymonds { c_1_s: 40.4, p: 5.0 }),
            erosion: Erosion { plastic_strain: 0.1, principal_strain: 0.2 },
            ..elastic()
        },
        with(ElementForm::FullyIntegrated, bilinear(30e9, 0.2, 2500.0, 2e6, 300e6)),
        with(
            ElementForm::OnePoint(Hourglass::Stiffness { coefficient: 0.05 }),
            bilinear(2e9 / 7.0, 0.3, 1e3 / 3.0, 2e6, 0.0),
        ),
    ];
    mesh.parts = vec!["one".into(), "two".into(), "$odd".into()];
    for (i, element) in mesh.elements.iter_mut().enumerate() {
        element.law = i / 3;
        element.part = i % 2;
        element.smear = [1.0, 1.1][i % 2];
        element.strength = [1.0, 0.3][i / 6];
    }
    mesh.trusses = vec![Truss { nodes: [0, 5], area_m2: 1e-4 / 3.0, part: 2, law: 2 }];
    let curve = |v: f64| Curve::new(vec![[0.0, v], [0.1, -v / 3.0], [7.0, 0.0]]);
    let mut model = Model {
        title: " Rich ".into(),
        mesh,
        constraints: vec![Constraint { node: 30, held: [true, false, true] }],
        initial_velocity_m_s: vec![(20, [1.0, -2.0 / 3.0, 0.0]), (4, [0.0, 0.0, 1e-7])],
        body_loads: vec![BodyLoad { axis: 2, acceleration_m_s2: Curve::constant(-9.81) }],
        nodal_loads: vec![NodalLoad { node: 7, axis: 1, force_n: curve(1e6) }],
        driven: vec![DrivenNode { node: 6, axis: 0, velocity_m_s: curve(0.1) }],
        walls: vec![
            RigidPlane { point_m: [0.0, 0.0, -0.35], normal: [0.0, 0.0, 1.0], friction: 0.3, nodes: None },
            RigidPlane {
                point_m: [3.0, 2.0, 1.0 / 3.0],
                normal: [-1.0, 0.0, 0.0],
                friction: f64::INFINITY,
                nodes: Some(vec![1, 2, 9]),
            },
            RigidPlane { point_m: [30.0, 0.1, 0.2], normal: [-0.6, 0.48, 0.64], friction: 0.0, nodes: None },
        ],
        body_contact: Some(ContactSettings { friction: 0.4 }),
        ..Model::default()
    };
    model.control.end_time_s = 1.0 / 3.0;
    model.control.step_safety = 0.67;
    model.control.mass_scaling_step_s = Some(1.7e-5);
    model.control.history_interval_s = 1e-3 / 7.0;
    model.control.history_nodes = vec![3, 1];
    model
}

#[test]
fn a_rich_model_comes_back() {
    let model = rich();
    let (normal, notes) = normalised(&model);
    assert!(notes.is_empty(), "{notes:?}");
    same(&normal, &normalised(&normal).0);
    let written = write(&model, &["a comment".into()]);
    let deck = good(&written.text);
    same(&normal, &deck.model);
    assert_eq!(write(&deck.model, &["a comment".into()]), written);
    assert!(written.text.contains("*PARAMETER+") && written.text.contains("-&v1"));
    assert_eq!(deck.model.walls[0], model.walls[0]);
    assert_eq!(deck.model.control, model.control);
    assert_eq!(deck.model.mesh.nodes, model.mesh.nodes);
    // the factors are in the laws: 1.1 of the density, 1.1 * 0.3 of the strength
    let heavy = deck.model.mesh.laws.iter().any(|l| l.density_kg_m3 == 2500.0 * 1.1);
    let weak = deck
        .model
        .mesh
        .laws
        .iter()
        .any(|l| l.hardening.first().is_some_and(|p| p.stress_pa == 2e6 * (1.1 * 0.3)));
    assert!(heavy && weak);
}

#[test]
fn a_read_deck_is_written_as_it_was() {
    let model = good(CUBE).model;
    same(&model, &normalised(&model).0);
    same(&model, &good(&write(&model, &[]).text).model);
}

#[test]
fn a_building_comes_back() {
    let building = fallwerk::building::parse(fallwerk::building::EXAMPLE, Format::Toml, "a.toml").unwrap();
    let deck = of_building(&building, &FeOptions::default()).unwrap();
    let written = write(&deck.model, &deck.comments);
    assert!(written.text.contains("$ Charge") && written.text.contains("*ELEMENT_SOLID\n"));
    let read = good(&written.text);
    same(&normalised(&deck.model).0, &read.model);
    assert_eq!(read.model.mesh.elements.len(), deck.model.mesh.elements.len());
    assert_eq!(read.model.walls[0].point_m[2], building.ground.level_m);
    assert_eq!(read.model.body_loads[0].acceleration_m_s2.at(1.0), -9.81);
}

/// The parts of a building touch each other in its deck as in its run, unless that is switched off; the head of the deck says which.
#[test]
fn contact_of_a_building_is_in_its_deck() {
    let building = fallwerk::building::parse(fallwerk::building::EXAMPLE, Format::Toml, "a.toml").unwrap();
    for body_contact in [true, false] {
        let deck = of_building(&building, &FeOptions { body_contact, ..FeOptions::default() }).unwrap();
        let text = write(&deck.model, &deck.comments).text;
        let head = text.split("*TITLE").next().unwrap();
        assert_eq!(head.contains("$ The parts touch each other"), body_contact, "{head}");
        assert_eq!(head.contains("$ There is no contact between the parts"), !body_contact, "{head}");
        assert_eq!(text.contains("_SINGLE_SURFACE"), body_contact);
        let friction = good(&text).model.body_contact.map(|c| c.friction);
        assert_eq!(friction, body_contact.then_some(building.ground.friction));
    }
}
