//! What a deck or an option asks for: the rate factor, mass scaling, a model read from a keyword deck.

use crate::fe::contact::RigidSurfaces;
use crate::fe::deck::{self, DeckOptions};
use crate::fe::dynamics::Dynamics;
use crate::fe::kernel::KernelStep;
use crate::fe::law::{CowperSymonds, ElementForm, Hourglass, Law};
use crate::fe::mass_scaling::scale_mass;
use crate::fe::model::Model;
use crate::fe::model_run::{ModelOptions, run_model};
use crate::fe::shapes::{bilinear, elastic, grid};
use crate::verify::{Case, Figure};

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "rate-factor",
            "One element (235 MPa, C 40.4 1/s, P 5) stretched at constant volume to 2 % at constant rates from 0.001 to 10 000 1/s: \
             flow stress.",
            rate_factor,
        ),
        Case::short(
            "rated-beam",
            "A steel beam with a rate factor (235 MPa, C 40.4 1/s, P 5), 1 m x 50 mm x 50 mm in 20 x 2 x 2 elements, clamped at its foot, is let go at 20 m/s: \
             nothing is supplied, so nothing is made, and hourglass control does not give.",
            rated_beam,
        ),
        Case::short(
            "mass-scaling",
            "A bar of nine elements of 0.1 m and one of 0.02 m along it is to be run with twice its step: added mass, and the step of a run.",
            mass_scaling,
        ),
        Case::short(
            "deck-cantilever",
            "`decks/cantilever.k`, the cantilever two elements deep, read and run; then written as a deck, read again and run.",
            deck_cantilever,
        ),
    ]
}

fn rate_factor() -> Result<Vec<Figure>, String> {
    const YIELD_PA: f64 = 235e6;
    const STRAIN: f64 = 5e-5;
    let rate = CowperSymonds { c_1_s: 40.4, p: 5.0 };
    let law = Law { rate: Some(rate), ..bilinear(200e9, 0.3, 7850.0, YIELD_PA, 0.0) };
    let mesh = grid([1; 3], [1.0; 3], law, |_| false);
    let stretched = |rate_1_s: f64| {
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        // the mid-step gradient is STRAIN along x and minus half of it across
        let grow = |i: usize| {
            let e = if i == 0 { STRAIN } else { -0.5 * STRAIN };
            e / (1.0 - 0.5 * e)
        };
        for _ in 0..400 {
            for n in 0..8 {
                body.v[n] = std::array::from_fn(|i| grow(i) * body.x[n][i]);
                body.x[n] = std::array::from_fn(|i| body.x[n][i] + body.v[n][i]);
            }
            body.update_elements(KernelStep { dt_s: STRAIN / rate_1_s, viscous: true }, 1.0);
        }
        let s = body.blocks.blocks[0].state.stress.map(|s| s[0]);
        let (a, b, c) = (s[0] - s[1], s[1] - s[2], s[2] - s[0]);
        (0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])).sqrt()
    };
    let source = "σ_y (1 + (ε̇ / C)^(1/P)), Cowper and Symonds 1957";
    let figure = |rate_1_s: f64| {
        let expected = YIELD_PA * (1.0 + libm::pow(rate_1_s / rate.c_1_s, 1.0 / rate.p));
        let name = format!("flow stress at {rate_1_s} 1/s");
        Figure::relative(name, "Pa", [expected, stretched(rate_1_s)], 1e-4, source)
    };
    Ok([1e-3, 1.0, 40.4, 1e4].map(figure).into())
}

fn rated_beam() -> Result<Vec<Figure>, String> {
    let rate = Some(CowperSymonds { c_1_s: 40.4, p: 5.0 });
    let forms = [
        ("assumed strains", Hourglass::Asqbi),
        ("stiffness form", Hourglass::Stiffness { coefficient: 0.1 }),
    ];
    let mut all = Vec::new();
    for (name, hourglass) in forms {
        let form = ElementForm::OnePoint(hourglass);
        let law = Law { rate, form, ..bilinear(210e9, 0.3, 7850.0, 235e6, 0.0) };
        let mesh = grid([20, 2, 2], [1.0, 0.05, 0.05], law, |p| p[0] == 0.0);
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][0] > 0.0).for_each(|n| body.v[n][2] = 20.0);
        let start_j = body.kinetic_j();
        let (mut most, mut least): (f64, f64) = (0.0, 0.0);
        while body.time_s < 0.03 {
            let kinetic_j = body.step(true);
            let [internal_j, hourglass_j, _] = body.blocks.energies_j();
            most = most.max((kinetic_j + internal_j) / start_j - 1.0);
            least = least.min(hourglass_j / start_j);
        }
        let made = format!("{name}: kinetic and internal energy beyond that at the start");
        let given = format!("{name}: energy that hourglass control gives");
        all.push(Figure::absolute(made, "of that", [0.0, most], 0.01, "conservation"));
        all.push(Figure::absolute(given, "of that", [0.0, -least], 0.01, "conservation"));
    }
    Ok(all)
}

/// A bar whose last element is a fifth as long as the others.
fn mass_scaling() -> Result<Vec<Figure>, String> {
    let mut mesh = grid([10, 1, 1], [1.0, 0.1, 0.1], elastic(), |_| false);
    mesh.nodes.iter_mut().filter(|p| p[0] > 0.95).for_each(|p| p[0] = 0.92);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let first_s = body.dt_s;
    let bounds = body.blocks.element_bounds_1_s2(&body.x);
    let step_s = 2.0 * first_s;
    // m (Δt / Δt_e)² where an element allows less
    let expected: f64 = bounds
        .iter()
        .enumerate()
        .map(|(e, bound)| {
            body.blocks.mass_kg(e) * ((step_s / body.step_under_bound_s(*bound)).powi(2) - 1.0).max(0.0)
        })
        .sum();
    let before: f64 = body.mass_kg.iter().sum();
    let scaled = scale_mass(&mesh, &mut body, step_s, f64::INFINITY).map_err(|e| e.to_string())?;
    let added = body.mass_kg.iter().sum::<f64>() - before;
    for v in &mut body.v {
        v[0] = 1.0;
    }
    let start = body.kinetic_j();
    let end = (0..200).fold(0.0, |_, _| body.step(true));
    Ok(vec![
        Figure::relative("time step", "s", [step_s, body.dt_s], 1e-9, "the wished one"),
        Figure::relative("added mass", "kg", [expected, added], 1e-9, "Σ m ((Δt / Δt_e)² - 1)"),
        Figure::relative("added mass in the report", "kg", [expected, scaled.added_kg], 1e-9, "the same"),
        Figure::relative("kinetic energy of uniform motion", "J", [start, end], 1e-9, "conservation"),
    ])
}

/// First peak of the recorded node \[mm\] and its time \[s\], energy error.
fn peak(model: &Model) -> Result<[f64; 3], String> {
    let options = ModelOptions { end_time_s: Some(0.13), ..ModelOptions::default() };
    let run = run_model(model, &options, None, &mut |_| ()).map_err(|e| e.to_string())?;
    let tip = run.histories.first().ok_or("the deck records no node")?;
    let (time, lowest) = run
        .times_s
        .iter()
        .zip(&tip.displacement_m)
        .map(|(t, u)| (*t, 1e3 * u[2]))
        .fold((0.0, 0.0), |low, now| if now.1 < low.1 { now } else { low });
    Ok([lowest, time, run.summary.energy_error])
}

fn deck_cantilever() -> Result<Vec<Figure>, String> {
    let read = |text: &str| {
        let deck = deck::parse(text, "cantilever.k", DeckOptions::default()).map_err(|e| e.render(false))?;
        Ok::<Model, String>(deck.model)
    };
    let model = read(include_str!("../../../decks/cantilever.k"))?;
    let first = peak(&model)?;
    let second = peak(&read(&deck::write(&model, &[]).text)?)?;
    let source = "OpenRadioss (HEPH), same mesh";
    Ok(vec![
        Figure::relative("first peak", "mm", [-24.918, first[0]], 0.002, source),
        Figure::relative("time of the first peak", "s", [0.08956, first[1]], 0.005, source),
        Figure::relative(
            "first peak after the round trip",
            "mm",
            [first[0], second[0]],
            1e-9,
            "the same run",
        ),
        Figure::absolute("energy error", "-", [0.0, first[2]], 1e-3, "conservation"),
    ])
}
