//! Observed orders of convergence, `log2` of the ratio of errors on meshes or steps halved.

use super::body::{Crossings, fix_step, nodes_where};
use super::forms::{FORMS, TestedForm};
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::law::Law;
use crate::fe::preload::equilibrate;
use crate::fe::shapes::{elastic, grid, nearest};
use crate::verify::{Case, Figure};

const THEORY: &str = "linear elements, central differences";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (form, tolerance) in FORMS.iter().filter_map(|f| Some((f, f.order?))) {
        cases.push(Case::short(
            format!("order-bending-{}", form.name),
            "Static deflection of a beam of 20 x 1 x 1 m (ν 0) on end planes held vertically, under a half wave of load, two, four and \
             eight elements deep: order from the differences.",
            move || bending(form, tolerance),
        ));
    }
    cases.push(Case::short(
        "order-frequency",
        "Second axial frequency of a fixed-free bar of 5, 10 and 20 elements at one small time step.",
        frequency,
    ));
    cases.push(Case::short(
        "order-time",
        "Shear oscillation of one element with 80, 160 and 320 steps over 1.3 periods: error of the displacement at the end.",
        time,
    ));
    cases
}

/// Half of a beam of 20 m in a half wave of load: the smooth solution of elasticity, without the singularity of a clamped end.
fn bending(form: &TestedForm, tolerance: f64) -> Result<Vec<Figure>, String> {
    let mut sunk = Vec::new();
    for deep in [2, 4, 8] {
        let law = form.law(Law { poisson_ratio: 0.0, ..elastic() });
        let mesh = grid([10 * deep, deep, deep], [10.0, 1.0, 1.0], law, |_| false);
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        for (n, p) in mesh.nodes.iter().enumerate() {
            let hold = |holds: bool| holds.then_some(0.0);
            body.prescribed_m_s[n] = [hold(p[0] == 0.0), Some(0.0), hold(p[0] == 10.0)];
            body.applied_n[n][2] = -body.mass_kg[n] * libm::cos(std::f64::consts::PI * p[0] / 20.0);
        }
        equilibrate(&mut body)?;
        let middle = nearest(&mesh, [0.0, 0.5, 0.5]);
        sunk.push(mesh.nodes[middle][2] - body.x[middle][2]);
    }
    let order = libm::log2(((sunk[0] - sunk[1]) / (sunk[1] - sunk[2])).abs());
    Ok(vec![Figure::absolute("order of the deflection", "-", [2.0, order], tolerance, THEORY)])
}

fn frequency() -> Result<Vec<Figure>, String> {
    let (length, number) = (10.0, 3.0);
    let exact = number * (30e9_f64 / 2500.0).sqrt() / (4.0 * length);
    let mut errors = Vec::new();
    for along in [5, 10, 20] {
        let law = Law { poisson_ratio: 0.0, ..elastic() };
        let mesh = grid([along, 1, 1], [length, 0.5, 0.5], law, |p| p[0] == 0.0);
        let end = nodes_where(&mesh, |p| p[0] == length)[0];
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        fix_step(&mut body, 5e-6);
        for (v, x) in body.v.iter_mut().zip(&mesh.nodes) {
            v[0] = 1e-3 * libm::sin(number * std::f64::consts::FRAC_PI_2 * x[0] / length);
        }
        let mut zero = Crossings::default();
        while zero.times_s.len() < 5 && body.time_s < 0.1 {
            body.step(false);
            zero.see(body.time_s, body.x[end][0] - length);
        }
        errors.push(zero.frequency_1_s()? / exact - 1.0);
    }
    let orders = [libm::log2(errors[0] / errors[1]), libm::log2(errors[1] / errors[2])];
    Ok(vec![
        Figure::absolute("order, 5 to 10 elements", "-", [2.0, orders[0]], 0.15, THEORY),
        Figure::absolute("order, 10 to 20 elements", "-", [2.0, orders[1]], 0.1, THEORY),
    ])
}

/// The top of a cube slides on its fixed foot: mass `ρ h³ / 2`, stiffness `G h`, so `ω² = 2 G / (ρ h²)`. Its volume does not change,
/// so that bulk viscosity plays no part.
fn time() -> Result<Vec<Figure>, String> {
    let omega = (2.0_f64 * 12.5e9 / 2500.0).sqrt();
    let end_s = 1.3 * std::f64::consts::TAU / omega;
    let mut errors = Vec::new();
    for steps in [80, 160, 320] {
        let mesh = grid([1; 3], [1.0; 3], elastic(), |p| p[2] == 0.0);
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        fix_step(&mut body, end_s / f64::from(steps));
        let top = nodes_where(&mesh, |p| p[2] == 1.0);
        for n in &top {
            body.prescribed_m_s[*n] = [None, Some(0.0), Some(0.0)];
            body.v[*n][0] = 1e-3;
        }
        for _ in 0..steps {
            body.step(false);
        }
        let exact = 1e-3 / omega * libm::sin(omega * body.time_s);
        errors.push((body.x[top[0]][0] - mesh.nodes[top[0]][0] - exact).abs() * omega / 1e-3);
    }
    let orders = [libm::log2(errors[0] / errors[1]), libm::log2(errors[1] / errors[2])];
    Ok(vec![
        Figure::absolute("order, 80 to 160 steps", "-", [2.0, orders[0]], 0.1, THEORY),
        Figure::absolute("order, 160 to 320 steps", "-", [2.0, orders[1]], 0.1, THEORY),
    ])
}
