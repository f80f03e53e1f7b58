//! Bars along an axis, ν = 0: `c = sqrt(E / ρ)`.

use super::body::{Crossings, nodes_where};
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::law::Law;
use crate::fe::mesh::Mesh;
use crate::fe::shapes::{elastic, grid, ground};
use crate::verify::{Case, Figure};

const YOUNG_PA: f64 = 30e9;
const DENSITY_KG_M3: f64 = 2500.0;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "wave-speed",
            "A bar of 200 elements whose end is moved at once at 1 m/s: speed of the front between the quarter points.",
            wave_speed,
        ),
        Case::short(
            "bar-impact",
            "A bar of 2 m, 80 elements, strikes a rigid wall lengthwise at 1 m/s: stress, duration, rebound. \
             Bulk viscosity and the plastic impact of the foot nodes take some of the rebound.",
            bar_impact,
        ),
        Case::short(
            "axial-frequencies",
            "A fixed-free bar of 10 m, 40 elements, set moving in its first and third mode.",
            axial_frequencies,
        ),
    ]
}

fn law() -> Law {
    Law { poisson_ratio: 0.0, ..elastic() }
}

/// `sqrt(E / ρ)` \[m/s\].
fn speed_m_s() -> f64 {
    (YOUNG_PA / DENSITY_KG_M3).sqrt()
}

fn wave_speed() -> Result<Vec<Figure>, String> {
    let mesh = grid([200, 1, 1], [10.0, 0.05, 0.05], law(), |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    for n in nodes_where(&mesh, |p| p[0] == 0.0) {
        body.prescribed_m_s[n][0] = Some(1.0);
    }
    let at = |x: f64| nodes_where(&mesh, |p| (p[0] - x).abs() < 1e-9)[0];
    let stations = [at(2.5), at(7.5)];
    let mut seen = [Crossings::default(), Crossings::default()];
    while body.time_s < 0.9 * 10.0 / speed_m_s() {
        body.step(false);
        for (crossing, n) in seen.iter_mut().zip(stations) {
            crossing.see(body.time_s, body.v[n][0] - 0.5);
        }
    }
    let [Some(first), Some(second)] = seen.map(|c| c.times_s.first().copied()) else {
        return Err("the front did not pass".into());
    };
    Ok(vec![Figure::relative(
        "speed of the front",
        "m/s",
        [speed_m_s(), 5.0 / (second - first)],
        0.005,
        "sqrt(E / ρ)",
    )])
}

/// Compressive force in the foot \[N\].
fn foot_force_n(mesh: &Mesh, body: &Dynamics) -> f64 {
    (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][2] == 0.0).map(|n| body.internal_n(n)[2]).sum()
}

fn bar_impact() -> Result<Vec<Figure>, String> {
    let (length, width) = (2.0, 0.025);
    let mesh = grid([1, 1, 80], [width, width, length], law(), |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, ground(0.0, 0.0), false);
    body.v.iter_mut().for_each(|v| v[2] = -1.0);
    let transit = length / speed_m_s();
    let plateau = DENSITY_KG_M3 * speed_m_s() * width * width;
    let (mut sum, mut count, mut release) = (0.0, 0, Crossings::default());
    while body.time_s < 2.6 * transit {
        body.step(false);
        let force = foot_force_n(&mesh, &body);
        let share = body.time_s / transit;
        if (0.3..1.7).contains(&share) {
            sum += force;
            count += 1;
        }
        if share > 1.0 {
            release.see(body.time_s, force - 0.5 * plateau);
        }
    }
    let stress = sum / f64::from(count) / (width * width);
    let end = release.times_s.first().ok_or("the bar did not leave the wall")?;
    let mass: f64 = body.mass_kg.iter().sum();
    let rebound = body.v.iter().zip(&body.mass_kg).map(|(v, m)| m * v[2]).sum::<f64>() / mass;
    Ok(vec![
        Figure::relative("stress at the wall", "Pa", [plateau / (width * width), stress], 0.01, "ρ c v"),
        Figure::relative("contact time", "s", [2.0 * transit, *end], 0.02, "2 L / c"),
        Figure::relative("rebound velocity", "m/s", [1.0, rebound], 0.05, "elastic bar: as it came"),
    ])
}

fn axial_frequencies() -> Result<Vec<Figure>, String> {
    let length = 10.0;
    let mesh = grid([40, 1, 1], [length, 0.25, 0.25], law(), |p| p[0] == 0.0);
    let end = nodes_where(&mesh, |p| p[0] == length)[0];
    let mut figures = Vec::new();
    for mode in [1, 3] {
        let number = f64::from(2 * mode - 1);
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        for (v, x) in body.v.iter_mut().zip(&mesh.nodes) {
            v[0] = 1e-3 * libm::sin(number * std::f64::consts::FRAC_PI_2 * x[0] / length);
        }
        let mut zero = Crossings::default();
        while zero.times_s.len() < 5 && body.time_s < 0.1 {
            body.step(false);
            zero.see(body.time_s, body.x[end][0] - length);
        }
        let exact = number * speed_m_s() / (4.0 * length);
        let name = format!("frequency of mode {mode}");
        figures.push(Figure::relative(
            name,
            "1/s",
            [exact, zero.frequency_1_s()?],
            0.003,
            "(2n-1) c / (4 L)",
        ));
    }
    Ok(figures)
}
