//! Pendulums and slides on single joints against MSC Adams' own results, as they lie in the tests of Project Chrono (`data/testing/joints`, BSD licence).
//!
//! A body of 1 kg, centre of mass at 2 m from the joint, inertia 0.04 kg m² along and 0.1 kg m² across, released level at rest under 9.80665 m/s², 5 s. Two of the pendulums, on a spherical and
//! a universal joint, move as that on the revolute does; there the steps of Adams' run left up to 8e-4 m, within the 1e-3 that Chrono's tests allow.

use crate::mbs::model::{
    Body, Contact, Force, Joint, JointKind, MODEL_SCHEMA, Model, Origin, RunSettings, TrackedPoint,
};
use crate::mbs::{RunResult, simulate};
use crate::verify::{Case, Figure};

const ADAMS: &str = "MSC Adams (Project Chrono, data/testing/joints)";

/// A time \[s\], the place of the centre of mass \[m\], the force of the joint on the body \[N\].
type Wanted = (f64, [f64; 3], [f64; 3]);

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    let falls = |kind: JointKind| {
        figures(
            &model(kind, [0.0, 0.0, 1.0], None),
            &[
                (0.5, [2.0, 0.0, -1.225830], [0.0; 3]),
                (2.0, [2.0, 0.0, -19.61330], [0.0; 3]),
                (5.0, [2.0, 0.0, -122.5830], [0.0; 3]),
            ],
            [1e-3, 1e-6],
        )
    };
    vec![
        Case::short("adams-revolute", "Pendulum on a revolute.", || {
            figures(
                &model(JointKind::Revolute, [0.0, 1.0, 0.0], None),
                &[
                    (0.5, [1.660810, 0.0, -1.114320], [-13.27970, 0.0, 9.149250]),
                    (2.0, [-1.951120, 0.0, -0.439479], [6.152950, 0.0, 1.625120]),
                    (5.0, [-1.999680, 0.0, -0.0355587], [0.5102250, 0.0, 0.2482590]),
                ],
                [1e-5, 1e-3],
            )
        }),
        Case::short("adams-spherical", "Pendulum on a ball.", || {
            figures(
                &model(JointKind::Spherical, [0.0, 1.0, 0.0], None),
                &[
                    (0.5, [1.660810, 0.0, -1.114320], [-13.28000, 0.0, 9.149470]),
                    (2.0, [-1.951060, 0.0, -0.439720], [6.154050, 0.0, 1.626150]),
                    (5.0, [-1.999670, 0.0, -0.0361929], [0.5116710, 0.0, 0.2484480]),
                ],
                [1e-3, 1e-2],
            )
        }),
        Case::short("adams-universal", "Pendulum along y on a universal joint with axes x and z.", || {
            figures(
                &model(JointKind::Universal, [1.0, 0.0, 0.0], None),
                &[
                    (0.5, [0.0, 1.660810, -1.114320], [0.0, -13.27960, 9.149180]),
                    (2.0, [0.0, -1.951060, -0.439720], [0.0, 6.154050, 1.626150]),
                    (5.0, [0.0, -1.999670, -0.0361929], [0.0, 0.5116690, 0.2484480]),
                ],
                [1e-3, 1e-2],
            )
        }),
        Case::short("adams-cylindrical", "Fall along the axis of a cylindrical joint.", move || {
            falls(JointKind::Cylindrical)
        }),
        Case::short("adams-prismatic", "Fall along the axis of a prismatic joint.", move || {
            falls(JointKind::Prismatic)
        }),
        Case::short(
            "adams-rotspring",
            "Pendulum on a revolute with a spring of 200 N m/rad and a damper of 10 N m s/rad; its moment as well.",
            || {
                let model = model(JointKind::Revolute, [0.0, 1.0, 0.0], Some([200.0, 10.0]));
                let mut all = figures(
                    &model,
                    &[
                        (0.5, [1.977294, 0.0, -0.3005134], [0.6784321, 0.0, 14.44829]),
                        (2.0, [1.991260, 0.0, -0.1867703], [-0.01787927, 0.0, 9.686980]),
                        (5.0, [1.990439, 0.0, -0.1953254], [0.002108525, 0.0, 9.828137]),
                    ],
                    [1e-5, 1e-3],
                )?;
                let run = run(&model)?;
                for (time, moment) in [(0.5, 29.00693), (2.0, 19.27992), (5.0, 19.56380)] {
                    let ours = run.turns[0].moment_nm[place(time)][0];
                    all.push(Figure::absolute(
                        format!("moment at {time} s"),
                        "N m",
                        [moment, ours],
                        1e-3,
                        ADAMS,
                    ));
                }
                Ok(all)
            },
        ),
    ]
}

fn model(kind: JointKind, axis: [f64; 3], spring: Option<[f64; 2]>) -> Model {
    let is_universal = kind == JointKind::Universal;
    // along the body 0.04: x, or y of the one that lies along y
    let (along, center) = if is_universal { (1, [0.0, 2.0, 0.0]) } else { (0, [2.0, 0.0, 0.0]) };
    let moment = |i: usize| if i == along { 0.04 } else { 0.1 };
    let inertia = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { moment(i) } else { 0.0 }));
    let body = Body {
        id: "body".into(),
        mass_kg: 1.0,
        inertia_kg_m2: inertia,
        position_m: center,
        orientation: [1.0, 0.0, 0.0, 0.0],
        velocity_m_s: [0.0; 3],
        angular_velocity_rad_s: [0.0; 3],
        shapes: Vec::new(),
        origin: Origin::default(),
    };
    let joint = Joint {
        id: "joint".into(),
        kind,
        body_a: None,
        body_b: "body".into(),
        point_m: [0.0; 3],
        point_b_m: None,
        axis: (kind != JointKind::Spherical).then_some(axis),
        axis_b: is_universal.then_some([0.0, 0.0, 1.0]),
        origin: Origin::default(),
    };
    let torsion = spring.map(|[stiffness_nm_rad, damping_nm_s_rad]| Force::Torsion {
        id: "spring".into(),
        body_a: None,
        body_b: "body".into(),
        axis,
        stiffness_nm_rad,
        damping_nm_s_rad,
    });
    Model {
        schema: MODEL_SCHEMA.into(),
        name: "pendulum".into(),
        gravity_m_s2: [0.0, 0.0, -9.80665],
        bodies: vec![body],
        shared_masses: Vec::new(),
        curves: Default::default(),
        joints: vec![joint],
        bushings: Vec::new(),
        forces: torsion.into_iter().collect(),
        contact: Contact::default(),
        events: Vec::new(),
        event_rules: Vec::new(),
        tracked: vec![TrackedPoint { id: "center".into(), body: "body".into(), point_m: center }],
        settings: RunSettings {
            end_time_s: 5.0,
            output_interval_s: OUTPUT_S,
            tolerance: 1e-9,
            reactions: true,
            ..RunSettings::default()
        },
    }
}

const OUTPUT_S: f64 = 0.5;

fn place(time: f64) -> usize {
    (time / OUTPUT_S).round() as usize
}

fn run(model: &Model) -> Result<RunResult, String> {
    simulate(model).map_err(|e| e.to_string())
}

/// Distances and differences of forces, with what is allowed of both.
fn figures(model: &Model, wanted: &[Wanted], [metres, newtons]: [f64; 2]) -> Result<Vec<Figure>, String> {
    let run = run(model)?;
    let point = &run.tracked[0];
    let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    let mut all = Vec::new();
    for (time, center, force) in wanted {
        let moved = point.displacement_m[place(*time)];
        let away = apart(std::array::from_fn(|i| point.origin_m[i] + moved[i]), *center);
        all.push(Figure::absolute(format!("distance at {time} s"), "m", [0.0, away], metres, ADAMS));
        let off = apart(run.reactions[0].force_n[place(*time)], *force);
        all.push(Figure::absolute(format!("reaction off at {time} s"), "N", [0.0, off], newtons, ADAMS));
    }
    Ok(all)
}
