//! The IFToMM library of computational benchmark problems (González, Dopico, Lugrís and Cuadrado, Multibody Syst. Dyn. 16 (2006) 345-368).
//!
//! References: the exact solution for the pendulum; for the four-bars the one equation `M θ'' = V sin θ` that they are together, solved to 1e-9; for the squeezer
//! that of the Test Set for IVP Solvers (Mazzia and Magherini 2008, at 0.03 s) and the same equations solved to 1e-9; for Bricard's mechanism a solution in one
//! coordinate to 1e-9.

use super::Known;
use crate::mbs::ideal::force::Force;
use crate::mbs::ideal::joint::{Joint, Kind};
use crate::mbs::ideal::{Body, GROUND, Mechanism};
use crate::mbs::math::{V3, qexp};
use crate::verify::{Case, Figure};

const A01: &str = "exact: 2 asin(k sn(K(k) + ω t, k)), k = sin 45°";
const A02: &str = "its equation of one coordinate, to 1e-9";
const A03: &str = "Test Set for IVP Solvers (0.03 s); its equations, to 1e-9";
const A04: &str = "one coordinate, to 1e-9";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "iftomm-a01",
            "Simple pendulum: 1 kg on a rod of 1 m without mass, released level, 10 s.",
            || a01().figures(1e-9, 1e-6, A01, Some(1e-6)),
        ),
        Case::short(
            "iftomm-a02-40",
            "40 four-bars in a row, 81 bars of 1 kg and 1 m: the first bar's end over 20 s, through poses in which all bars lie on one line and every loop could move by itself.",
            || a02_40().figures(1e-7, 1e-3, A02, Some(0.6)),
        ),
        Case::long("iftomm-a02-80", "80 four-bars in a row, as before.", || {
            a02_80().figures(1e-7, 1e-3, A02, Some(1.2))
        }),
        Case::short(
            "iftomm-a03",
            "Andrews' squeezer: seven bodies, a spring, a motor, three loops, 0.05 s: the point F of the crank.",
            || a03().figures(1e-9, 1e-7, A03, None),
        ),
        Case::short(
            "iftomm-a04",
            "Bricard's mechanism: five rods on six revolutes, 30 conditions of which 29 are independent, 10 s: the second rod's last point.",
            || {
                let known = a04();
                let course = known.run(1e-9)?;
                let mut figures = known.figures_of(&course, 1e-4, A04, Some(1e-4));
                let rows = course.rows;
                figures.push(Figure::absolute("dependent conditions", "-", [1.0, rows[1] as f64], 0.0, A04));
                Ok(figures)
            },
        ),
    ]
}

/// The simple pendulum.
pub fn a01() -> Known {
    let track = vec![(1.0, [0.9862917512, -0.1650108531, 0.0]), (10.0, [-0.2750874626, -0.9614192051, 0.0])];
    Known {
        name: "pendulum (A01)",
        file: "a01-pendulum",
        track,
        end_s: 10.0,
        output_s: 0.05,
        ..Known::of(pendulum(), 0, [0.0; 3])
    }
}

/// Two four-bars.
pub fn a02_2() -> Known {
    let track = vec![
        (1.0, [-0.195020302, -0.980799206, 0.0]),
        (2.0, [0.057815796, 0.998327268, 0.0]),
        (5.0, [-0.811310461, -0.584615545, 0.0]),
        (10.0, [0.328458112, 0.944518538, 0.0]),
        (20.0, [0.839746574, 0.542978536, 0.0]),
    ];
    Known { name: "2 four-bars (A02)", file: "a02-four-bars-2", track, end_s: 20.0, ..four_bars(2) }
}

/// 40 four-bars.
pub fn a02_40() -> Known {
    let track = vec![
        (1.0, [-0.115356881, -0.993324111, 0.0]),
        (2.0, [0.034466307, 0.999405860, 0.0]),
        (5.0, [-0.540190051, -0.841543052, 0.0]),
        (10.0, [0.180512227, 0.983572741, 0.0]),
        (20.0, [0.410901154, 0.911679901, 0.0]),
    ];
    Known { name: "40 four-bars (A02)", file: "a02-four-bars-40", track, end_s: 20.0, ..four_bars(40) }
}

/// 80 four-bars.
pub fn a02_80() -> Known {
    let track = vec![
        (1.0, [-0.112975932, -0.993597725, 0.0]),
        (5.0, [-0.530445206, -0.847719224, 0.0]),
        (10.0, [0.176512018, 0.984298485, 0.0]),
        (20.0, [0.399979663, 0.916524015, 0.0]),
    ];
    Known { name: "80 four-bars (A02)", file: "a02-four-bars-80", track, end_s: 20.0, ..four_bars(80) }
}

fn four_bars(count: usize) -> Known {
    Known { output_s: 0.05, ..Known::of(mechanism_of_four_bars(count), 0, [0.0, 0.5, 0.0]) }
}

/// Andrews' squeezer.
pub fn a03() -> Known {
    let track = vec![
        (0.01, [-0.0038905524, 0.0058192441, 0.0]),
        (0.03, [-0.0069630394, -0.0007183884, 0.0]),
        (0.05, [-0.0052085047, 0.0046766953, 0.0]),
    ];
    let known = Known::of(squeezer(), 0, [RR - RA, 0.0, 0.0]);
    Known { name: "squeezer (A03)", file: "a03-squeezer", track, end_s: 0.05, output_s: 0.005, ..known }
}

/// Bricard's mechanism.
pub fn a04() -> Known {
    let track = vec![
        (0.5, [0.774717808, -0.979815048, -0.199906159]),
        (1.0, [0.274481319, -0.886707939, -0.462330003]),
        (2.5, [-0.999983185, -1.0, -0.000016815]),
        (5.0, [0.999932742, -0.999999998, -0.000067255]),
        (10.0, [0.999730987, -0.999999964, -0.000268977]),
    ];
    Known {
        name: "Bricard (A04)",
        file: "a04-bricard",
        track,
        end_s: 10.0,
        output_s: 0.05,
        ..Known::of(bricard(), 1, [0.0, -0.5, 0.0])
    }
}

const DOWN: V3 = [0.0, -9.81, 0.0];
const Z: V3 = [0.0, 0.0, 1.0];

fn pendulum() -> Mechanism {
    Mechanism {
        bodies: vec![Body::at_rest(1.0, [1.0; 3], [-1.0, 0.0, 0.0])],
        joints: vec![Joint::rod([GROUND, 0], [[0.0; 3], [-1.0, 0.0, 0.0]])],
        gravity_m_s2: DOWN,
        ..Mechanism::default()
    }
}

/// So many four-bars in a row: verticals first, then couplers.
fn mechanism_of_four_bars(count: usize) -> Mechanism {
    let bar = |x: f64, y: f64| Body::at_rest(1.0, [1.0 / 12.0; 3], [x, y, 0.0]);
    let mut m = Mechanism { gravity_m_s2: DOWN, ..Mechanism::default() };
    for i in 0..=count {
        let x = i as f64;
        let vertical =
            Body { velocity_m_s: [0.5, 0.0, 0.0], angular_velocity_rad_s: [0.0, 0.0, -1.0], ..bar(x, 0.5) };
        m.bodies.push(vertical);
        m.joints.push(Joint::at(Kind::Revolute, [GROUND, i], [x, 0.0, 0.0], Z));
    }
    for i in 0..count {
        let (x, coupler) = (i as f64, count + 1 + i);
        m.bodies.push(Body { velocity_m_s: [1.0, 0.0, 0.0], ..bar(x + 0.5, 1.0) });
        m.joints.push(Joint::at(Kind::Revolute, [i, coupler], [x, 1.0, 0.0], Z));
        m.joints.push(Joint::at(Kind::Revolute, [coupler, i + 1], [x + 1.0, 1.0, 0.0], Z));
    }
    m
}

// Andrews' squeezer: masses, moments of inertia and lengths of the Test Set for IVP Solvers
const MASSES: [f64; 7] = [0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498];
const MOMENTS: [f64; 7] = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5];
const POINT_A: V3 = [-0.06934, -0.00227, 0.0];
const POINT_B: V3 = [-0.03635, 0.03273, 0.0];
const POINT_C: V3 = [0.014, 0.072, 0.0];
const RR: f64 = 7e-3;
const RA: f64 = 0.92e-3;
/// Angles β, Θ, γ, δ, ε at the start.
const ANGLES: [f64; 5] = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_4,
    0.487_364_979_543_842_55,
    1.230_547_444_549_821_2,
];

/// Andrews' squeezer in its pose at the start.
pub(super) struct Squeezer {
    /// Angle of the crank \[rad\].
    pub crank_rad: f64,
    /// Mass \[kg\] and moment of inertia \[kg m²\] of each body.
    pub masses: [(f64, f64); 7],
    /// Centres of mass \[m\].
    pub centres_m: [V3; 7],
    /// Pins: the bodies (`None` is the ground) and the place \[m\]; the second is F.
    pub pins: [([Option<usize>; 2], V3); 10],
    /// Ends of the spring on the third body and on the ground \[m\].
    pub spring_m: [V3; 2],
}

/// The squeezer's measures.
pub(super) fn squeezer_layout() -> Squeezer {
    let [beta, theta, gamma, delta, epsilon] = ANGLES;
    let unit = |a: f64| [libm::cos(a), libm::sin(a), 0.0];
    let plus = |p: V3, s: f64, d: V3| [p[0] + s * d[0], p[1] + s * d[1], 0.0];
    // a point of a body's frame: origin, angle of its axes, coordinates
    let on =
        |p: V3, a: f64, x: f64, y: f64| plus(plus(p, x, unit(a)), -y, [libm::sin(a), -libm::cos(a), 0.0]);
    let f = plus([0.0; 3], RR, unit(beta));
    let e = plus(f, -28e-3, unit(beta + theta));
    let g = plus(POINT_A, 40e-3, unit(delta));
    let h = plus(POINT_A, 40e-3, [libm::sin(epsilon), -libm::cos(epsilon), 0.0]);
    let d = on(POINT_B, gamma, 20e-3, -18e-3);
    let from_e = |p: V3, arm: f64, back: f64| {
        let length = libm::hypot(e[0] - p[0], e[1] - p[1]);
        plus(p, (arm - back) / length, [e[0] - p[0], e[1] - p[1], 0.0])
    };
    Squeezer {
        crank_rad: beta,
        masses: std::array::from_fn(|i| (MASSES[i], MOMENTS[i])),
        centres_m: [
            plus([0.0; 3], RA, unit(beta)),
            plus(f, -11.5e-3, unit(beta + theta)),
            on(POINT_B, gamma, 10.43e-3, -18.74e-3),
            from_e(g, 20e-3, 14.21e-3),
            on(POINT_A, delta, 23.08e-3, 9.16e-3),
            from_e(h, 20e-3, 14.21e-3),
            on(POINT_A, epsilon, -4.49e-3, -12.28e-3),
        ],
        pins: [
            ([None, Some(0)], [0.0; 3]),
            ([Some(0), Some(1)], f),
            ([None, Some(2)], POINT_B),
            ([Some(1), Some(2)], e),
            ([Some(1), Some(3)], e),
            ([Some(3), Some(4)], g),
            ([None, Some(4)], POINT_A),
            ([Some(1), Some(5)], e),
            ([Some(5), Some(6)], h),
            ([None, Some(6)], POINT_A),
        ],
        spring_m: [d, POINT_C],
    }
}

fn squeezer() -> Mechanism {
    let layout = squeezer_layout();
    let body = |i: usize| Body {
        orientation: qexp([0.0, 0.0, if i == 0 { layout.crank_rad } else { 0.0 }]),
        ..Body::at_rest(layout.masses[i].0, [layout.masses[i].1; 3], layout.centres_m[i])
    };
    let pin = |(bodies, at): &([Option<usize>; 2], V3)| {
        Joint::at(Kind::Revolute, bodies.map(|b| b.unwrap_or(GROUND)), *at, Z)
    };
    Mechanism {
        bodies: (0..7).map(body).collect(),
        joints: layout.pins.iter().map(pin).collect(),
        forces: vec![
            Force::Spring {
                bodies: [2, GROUND],
                points_m: layout.spring_m,
                length_m: 0.07785,
                stiffness_n_m: 4530.0,
                damping_n_s_m: 0.0,
            },
            Force::Torque { body: 0, torque_nm: [0.0, 0.0, 0.033] },
        ],
        ..Mechanism::default()
    }
}

/// Joints of Bricard's mechanism \[m\].
pub(super) fn bricard_points() -> [V3; 6] {
    [[0.0; 3], [1.0, 0.0, 0.0], [1.0, -1.0, 0.0], [1.0, -1.0, 1.0], [0.0, -1.0, 1.0], [0.0, 0.0, 1.0]]
}

fn bricard() -> Mechanism {
    let points = bricard_points();
    let axes = [1, 2, 0, 1, 2, 0];
    let rod = |i: usize| {
        let (a, b) = (points[i], points[i + 1]);
        let centre: V3 = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
        let along = (0..3).position(|k| a[k] != b[k]).unwrap_or(0);
        let mut principal = [1.01 / 12.0; 3];
        principal[along] = 0.02 / 12.0;
        Body::at_rest(1.0, principal, centre)
    };
    let joint = |i: usize| {
        let mut axis = [0.0; 3];
        axis[axes[i]] = 1.0;
        let bodies = [if i == 0 { GROUND } else { i - 1 }, if i == 5 { GROUND } else { i }];
        Joint::at(Kind::Revolute, bodies, points[i], axis)
    };
    Mechanism {
        bodies: (0..5).map(rod).collect(),
        joints: (0..6).map(joint).collect(),
        gravity_m_s2: DOWN,
        ..Mechanism::default()
    }
}
