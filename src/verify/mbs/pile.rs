//! A pile of cubes dropped in random orientation, and how far they end up in each other.

use crate::mbs::math::{self, M3, V3};
use crate::mbs::model::{
    Body, BodyContact, Contact, GroundPlane, MODEL_SCHEMA, Model, Origin, RunSettings, Shape, TOLERANCE,
};
use crate::mbs::result::Frame;
use std::f64::consts::PI;

/// Edge of a cube \[m\].
pub const EDGE_M: f64 = 0.4;
/// Spacing of their grid, height of the lowest ones \[m\].
const SPACING_M: f64 = 0.72;
const LOWEST_M: f64 = 0.5;
const DENSITY_KG_M3: f64 = 2500.0;
const FRICTION: f64 = 0.5;
const GRAVITY_M_S2: f64 = 9.81;
/// The step with which the pile is run \[s\].
pub const STEP_S: f64 = 5e-3;

/// Draws of the linear congruential generator `s' = (1103515245 s + 12345) mod 2³¹`, between 0 and 1.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = (1_103_515_245 * self.0 + 12345) % (1 << 31);
        self.0 as f64 / f64::from(1_u32 << 31)
    }

    /// A rotation, all equally likely (Shoemake, Graphics Gems III, 1992).
    fn rotation(&mut self) -> [f64; 4] {
        let (u1, u2, u3) = (self.next(), self.next(), self.next());
        let (low, high) = ((1.0 - u1).sqrt(), u1.sqrt());
        [
            high * libm::cos(2.0 * PI * u3),
            low * libm::sin(2.0 * PI * u2),
            low * libm::cos(2.0 * PI * u2),
            high * libm::sin(2.0 * PI * u3),
        ]
    }
}

/// `side³` cubes above the ground, at rest.
pub fn model(side: usize, end_time_s: f64, time_step_s: f64) -> Model {
    let mut draws = Draws(12345);
    let mass_kg = DENSITY_KG_M3 * EDGE_M.powi(3);
    let inertia = mass_kg * EDGE_M * EDGE_M / 6.0;
    let place = |i: usize| (i as f64 - 0.5 * (side as f64 - 1.0)) * SPACING_M;
    let mut bodies = Vec::with_capacity(side.pow(3));
    for z in 0..side {
        for y in 0..side {
            for x in 0..side {
                bodies.push(Body {
                    id: format!("cube{}", bodies.len()),
                    mass_kg,
                    inertia_kg_m2: [[inertia, 0.0, 0.0], [0.0, inertia, 0.0], [0.0, 0.0, inertia]],
                    position_m: [place(x), place(y), LOWEST_M + z as f64 * SPACING_M],
                    orientation: draws.rotation(),
                    velocity_m_s: [0.0; 3],
                    angular_velocity_rad_s: [0.0; 3],
                    shapes: vec![Shape::cuboid([0.0; 3], [0.5 * EDGE_M; 3])],
                    origin: Origin::default(),
                });
            }
        }
    }
    Model {
        schema: MODEL_SCHEMA.into(),
        name: format!("pile of {} cubes", side.pow(3)),
        gravity_m_s2: [0.0, 0.0, -GRAVITY_M_S2],
        bodies,
        shared_masses: Vec::new(),
        curves: Default::default(),
        joints: Vec::new(),
        bushings: Vec::new(),
        forces: Vec::new(),
        contact: Contact {
            ground: Some(GroundPlane { level_m: 0.0, friction: FRICTION, restitution: 0.0 }),
            bodies: Some(BodyContact { friction: FRICTION, restitution: 0.0 }),
            ..Contact::default()
        },
        events: Vec::new(),
        event_rules: Vec::new(),
        tracked: Vec::new(),
        settings: RunSettings {
            end_time_s,
            output_interval_s: 0.05,
            preload: false,
            time_step_s: Some(time_step_s),
            tolerance: TOLERANCE,
            reactions: false,
            sleep_speed_m_s: None,
            relative_inertia_rad_s: None,
            soft_after_m: None,
        },
    }
}

/// How far cubes are in each other and in the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Depths {
    /// Largest of the pairs that overlap \[m\].
    pub largest_m: f64,
    /// Lowest corner below the ground \[m\].
    pub ground_m: f64,
}

/// Depths by the separating axes of all pairs: 6 face normals and 9 products of edges, nothing of the solver.
pub fn depths(frame: &Frame) -> Depths {
    let turns: Vec<M3> = frame.orientation.iter().map(|q| math::qmat(*q)).collect();
    let half = 0.5 * EDGE_M;
    let (mut largest_m, mut ground_m) = (0.0_f64, 0.0_f64);
    for (i, x) in frame.position_m.iter().enumerate() {
        let down: f64 = turns[i][2].iter().map(|v| v.abs() * half).sum();
        ground_m = ground_m.max(down - x[2]);
        for (j, y) in frame.position_m.iter().enumerate().skip(i + 1) {
            let d = math::sub(*y, *x);
            if math::dot(d, d) < 3.0 * EDGE_M * EDGE_M {
                largest_m = largest_m.max(overlap(d, &turns[i], &turns[j], half));
            }
        }
    }
    Depths { largest_m, ground_m }
}

fn overlap(d: V3, a: &M3, b: &M3, half: f64) -> f64 {
    let (a, b) = (math::transpose(a), math::transpose(b));
    let along = |axis: V3| {
        let reach: f64 = a.iter().chain(&b).map(|e| math::dot(*e, axis).abs()).sum();
        half * reach - math::dot(d, axis).abs()
    };
    let faces = a.iter().chain(&b).map(|n| along(*n)).fold(f64::INFINITY, f64::min);
    let edges = a.iter().flat_map(|p| b.iter().map(move |q| math::cross(*p, *q)));
    let crossed = edges.filter(|c| math::norm(*c) > 1e-8).map(|c| along(math::scale(1.0 / math::norm(c), c)));
    crossed.fold(faces, f64::min)
}
