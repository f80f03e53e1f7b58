//! Contacts of bodies that turn, and of rods that lean into their motion.

use super::contact::{energy, ground, last, run};
use super::models::{body, joint, solid};
use crate::mbs::math::{self, V3};
use crate::mbs::model::{BodyContact, JointKind, Model, Shape};
use crate::verify::{Case, Figure};

const G: f64 = 9.81;
/// Length of the rods \[m\], and radius of the balls at their ends.
const ROD_M: f64 = 1.0;
const TIP_M: f64 = 0.01;
const RIGID: &str = "a body that sticks moves as one with what it stands on";
const STEADY: &str = "steady precession of a symmetric body (Goldstein, Classical Mechanics, 3rd ed., section 5.7): without friction nothing changes its rate";
const MOREAU: &str = "Coulomb's law on the velocity after the impact, plane and with one solution (Moreau, CISM 302, 1988); masses of the mechanism by Lagrange's equations";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "turning-table",
            "A box on a table that turns at 2 rad/s, 0.8 m from its axis, with friction of 1: it stays where it is for 20 s.",
            table,
        ),
        Case::short(
            "turning-axle",
            "A wheel of 0.1 m on an axle of 1 m, that goes round with 3.5 rad/s and spins with 35 rad/s on ground without friction: angle after 4 s.",
            axle,
        ),
        Case::short(
            "turning-rod",
            "A rod hangs from a universal joint and goes round with 4 rad/s, its end on ground without friction: angle after 1.5 s.",
            cone,
        ),
        Case::short(
            "impact-leaning",
            "A rod on a sliding cart strikes rough ground without rebound: it sticks 0.9 rad above the ground; at 1.3 rad, where friction presses it down, it slips on.",
            leaning,
        ),
    ]
}

fn angle(position_m: V3) -> f64 {
    libm::atan2(position_m[1], position_m[0])
}

/// How far an angle is from that of a turn \[rad\].
fn off(angle: f64, turned: f64) -> f64 {
    (angle - turned + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}

fn table() -> Result<Vec<Figure>, String> {
    let (rate, radius_m) = (2.0, 0.8);
    let mut m = Model::empty("table", [0.0, 0.0, -G], 20.0, 0.1);
    let mut plate = solid("table", 2500.0, [4.0, 4.0, 0.2], [0.0, 0.0, -0.1]);
    plate.mass_kg = 1e5;
    plate.inertia_kg_m2 = [[1e7, 0.0, 0.0], [0.0, 1e7, 0.0], [0.0, 0.0, 1e7]];
    plate.angular_velocity_rad_s = [0.0, 0.0, rate];
    plate.shapes = vec![Shape::cuboid([0.0; 3], [2.0, 2.0, 0.1])];
    let mut block = solid("box", 1000.0, [0.1, 0.1, 0.1], [radius_m, 0.0, 0.05]);
    block.velocity_m_s = [0.0, rate * radius_m, 0.0];
    block.angular_velocity_rad_s = [0.0, 0.0, rate];
    block.shapes = vec![Shape::cuboid([0.0; 3], [0.05; 3])];
    m.bodies = vec![plate, block];
    let axis = Some([0.0, 0.0, 1.0]);
    m.joints.push(joint("pivot".into(), JointKind::Revolute, [None, Some("table")], [0.0, 0.0, -0.1], axis));
    m.contact.bodies = Some(BodyContact { friction: 1.0, restitution: 0.0 });
    let result = run(&m)?;
    let at = last(&result).position_m[1];
    Ok(vec![
        Figure::absolute("radius", "m", [radius_m, libm::hypot(at[0], at[1])], 1e-4, RIGID),
        energy(&result, 1e-9),
    ])
}

fn axle() -> Result<Vec<Figure>, String> {
    let (rate, spin, radius_m, end_s) = (3.5, -35.0, 0.1, 4.0);
    let mut m = Model::empty("axle", [0.0, 0.0, -G], end_s, 0.1);
    m.settings.time_step_s = Some(2.5e-4);
    let across = 2.0 * ROD_M * ROD_M / 12.0;
    let mut wheel = body("axle", 2.0, [0.01, across, across], [0.5 * ROD_M, 0.0, radius_m]);
    wheel.velocity_m_s = [0.0, 0.5 * ROD_M * rate, 0.0];
    wheel.angular_velocity_rad_s = [spin, 0.0, rate];
    wheel.shapes = vec![Shape::Sphere { center_m: [0.5 * ROD_M, 0.0, 0.0], radius_m }];
    m.bodies = vec![wheel];
    m.joints.push(joint(
        "pivot".into(),
        JointKind::Spherical,
        [None, Some("axle")],
        [0.0, 0.0, radius_m],
        None,
    ));
    m.contact.ground = ground(0.0, 0.0);
    let result = run(&m)?;
    let energies = &result.energies.kinetic_j;
    let growth = energies[energies.len() - 1] / energies[0] - 1.0;
    Ok(vec![
        Figure::absolute(
            "angle off",
            "rad",
            [0.0, off(angle(last(&result).position_m[0]), rate * end_s)],
            1e-3,
            STEADY,
        ),
        Figure::absolute("kinetic energy gained, share", "-", [0.0, growth], 1e-5, STEADY),
        energy(&result, 1e-6),
    ])
}

fn cone() -> Result<Vec<Figure>, String> {
    let (rate, end_s, height_m) = (4.0, 1.5, 0.6);
    // the rod reaches down to the ball on the ground
    let down = (height_m - 2.0 * TIP_M) / ROD_M;
    let aside = (1.0 - down * down).sqrt();
    let mut m = Model::empty("cone", [0.0, 0.0, -G], end_s, 0.1);
    m.settings.time_step_s = Some(2.5e-4);
    let across = 2.0 * ROD_M * ROD_M / 12.0;
    let at = [0.5 * ROD_M * aside, 0.0, height_m - 0.5 * ROD_M * down];
    let mut rod = body("rod", 2.0, [1e-9, across, across], at);
    rod.orientation = about_y(libm::asin(down));
    rod.velocity_m_s = [0.0, rate * at[0], 0.0];
    rod.angular_velocity_rad_s = [0.0, 0.0, rate];
    rod.shapes = vec![Shape::Sphere { center_m: [0.5 * ROD_M, 0.0, 0.0], radius_m: 2.0 * TIP_M }];
    m.bodies = vec![rod];
    let mut pivot = joint(
        "pivot".into(),
        JointKind::Universal,
        [None, Some("rod")],
        [0.0, 0.0, height_m],
        Some([0.0, 0.0, 1.0]),
    );
    pivot.axis_b = Some([0.0, 1.0, 0.0]);
    m.joints.push(pivot);
    m.contact.ground = ground(0.0, 0.0);
    let result = run(&m)?;
    Ok(vec![
        Figure::absolute(
            "angle off",
            "rad",
            [0.0, off(angle(last(&result).position_m[0]), rate * end_s)],
            1e-5,
            STEADY,
        ),
        energy(&result, 1e-7),
    ])
}

/// Orientation of a body that is turned about y by an angle \[rad\].
fn about_y(angle: f64) -> [f64; 4] {
    [libm::cos(0.5 * angle), 0.0, libm::sin(0.5 * angle), 0.0]
}

/// A cart of 3 kg on a line along x with a rod of 2 kg that hangs from it at an angle from the vertical \[rad\], its end on the ground; velocities of the cart \[m/s\] and of that angle \[rad/s\].
fn cart(lean: f64, [slide, swing]: [f64; 2], friction: f64) -> Model {
    let mut m = Model::empty("cart", [0.0; 3], 1e-3, 1e-3);
    let (sin, cos) = libm::sincos(lean);
    let height_m = ROD_M * cos + TIP_M;
    let mut cart = body("cart", 3.0, [1.0; 3], [0.0, 0.0, height_m]);
    cart.velocity_m_s = [slide, 0.0, 0.0];
    let across = 2.0 * ROD_M * ROD_M / 12.0;
    let at = math::scale(0.5 * ROD_M, [sin, 0.0, -cos]);
    let mut rod = body("rod", 2.0, [1e-3, across, across], math::add(at, [0.0, 0.0, height_m]));
    rod.orientation = about_y(0.5 * std::f64::consts::PI - lean);
    rod.angular_velocity_rad_s = [0.0, -swing, 0.0];
    rod.velocity_m_s = math::add(cart.velocity_m_s, math::cross(rod.angular_velocity_rad_s, at));
    rod.shapes = vec![Shape::Sphere { center_m: [0.5 * ROD_M, 0.0, 0.0], radius_m: TIP_M }];
    m.bodies = vec![cart, rod];
    let point = [0.0, 0.0, height_m];
    m.joints = vec![
        joint("rail".into(), JointKind::Prismatic, [None, Some("cart")], point, Some([1.0, 0.0, 0.0])),
        joint("pin".into(), JointKind::Revolute, [Some("cart"), Some("rod")], point, Some([0.0, 1.0, 0.0])),
    ];
    m.contact.ground = ground(friction, 0.0);
    m
}

fn leaning() -> Result<Vec<Figure>, String> {
    let energy_left = |m: &Model| run(m).map(|r| r.energies.kinetic_j[r.energies.kinetic_j.len() - 1]);
    let upright = 0.5 * std::f64::consts::PI;
    let sticks = energy_left(&cart(upright - 0.9, [1.0, -3.0], 0.6))?;
    // slips towards -x: J_t = μ J_n, and the rod no longer turns
    let (lean, slide, swing, friction) = (upright - 1.3, -0.5, -3.0, 0.6);
    let (sin, cos) = libm::sincos(lean);
    let (whole_kg, coupled, turned) = (5.0, 0.5 * 2.0 * ROD_M * cos, 2.0 * ROD_M * ROD_M / 3.0);
    // (M + m) Δẋ - c φ̇ = μ J, c Δẋ - I φ̇ = J (L sin φ + μ (L cos φ + r)), with φ̇ before
    let lever = ROD_M * sin + friction * (ROD_M * cos + TIP_M);
    let impulse = swing * (coupled * coupled - whole_kg * turned) / (whole_kg * lever - coupled * friction);
    let after = slide + (friction * impulse + coupled * swing) / whole_kg;
    let slips = energy_left(&cart(lean, [slide, swing], friction))?;
    Ok(vec![
        Figure::absolute("kinetic energy left where it sticks", "J", [0.0, sticks], 1e-6, MOREAU),
        Figure::absolute(
            "kinetic energy left where it slips",
            "J",
            [0.5 * whole_kg * after * after, slips],
            1e-3,
            MOREAU,
        ),
    ])
}
