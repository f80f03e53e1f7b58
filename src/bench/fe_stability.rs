//! Runs at and beyond the limits of the method: each must end within the energy limit or with a diagnosis.
//!
//! The frame is the reference building up to a little after its first ground contact; one parameter at a time is varied.

use crate::base::tree::Format;
use crate::building::{Building, EXAMPLE, HardeningPoint, Homogenised, Material, parse};
use crate::fe::run::{ENERGY_LIMIT, FeOptions, run};
use std::fmt::Write;

/// Simulated time \[s\]: first ground contact at 1.3 s.
const END_S: f64 = 1.6;

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What was varied.
    pub parameter: &'static str,
    /// Its value with unit.
    pub value: String,
    /// `finished`, or the diagnosis with which the run stopped.
    pub outcome: String,
    /// Energy error of a finished run.
    pub energy_error: Option<f64>,
    /// Whether every displacement of a finished run is a number.
    pub finite: bool,
}

impl Row {
    /// Whether the run ended within the energy limit, or said why it stopped.
    pub fn holds(&self) -> bool {
        self.energy_error.is_none_or(|e| e <= ENERGY_LIMIT && self.finite)
    }
}

/// A variation: parameter, value with unit, what it does.
type Variation = (&'static str, String, Box<dyn Fn(&mut Building, &mut FeOptions)>);

fn variations() -> Vec<Variation> {
    let mut all: Vec<Variation> = Vec::new();
    for factor in [0.5, 0.7, 0.9, 1.0, 1.1, 1.2] {
        let safety = factor * crate::fe::dynamics::STEP_SAFETY;
        let change = move |_: &mut Building, o: &mut FeOptions| o.step_safety = Some(safety);
        all.push(("time step over the safe one", format!("{factor}"), Box::new(change)));
    }
    for size in [0.5, 0.4, 0.3, 0.25] {
        let change = move |_: &mut Building, o: &mut FeOptions| o.mesh_size_m = Some(size);
        all.push(("mesh size", format!("{size} m"), Box::new(change)));
    }
    for aspect in [1.0, 2.0, 5.0, 10.0, 17.0] {
        // two elements of 0.2 m across a column, and one size along it
        let change = move |_: &mut Building, o: &mut FeOptions| o.mesh_size_m = Some(0.2 * aspect);
        all.push(("aspect ratio in columns", format!("{aspect}"), Box::new(change)));
    }
    for slope in [1e9, 100e6, 0.0, -20e6, -100e6] {
        let change = move |b: &mut Building, _: &mut FeOptions| law(b, |l| l.hardening = sloped(l, slope));
        all.push(("hardening modulus", format!("{} MPa", slope / 1e6), Box::new(change)));
    }
    for strain in [0.001, 0.01, 0.05, 0.1, 0.5] {
        let change =
            move |b: &mut Building, _: &mut FeOptions| law(b, |l| l.critical_plastic_strain = strain);
        all.push(("erosion strain", format!("{strain}"), Box::new(change)));
    }
    for friction in [0.0, 0.25, 0.5, 1.0] {
        let change = move |b: &mut Building, _: &mut FeOptions| b.ground.friction = friction;
        all.push(("friction", format!("{friction}"), Box::new(change)));
    }
    for duration in [0.0, 0.001, 0.01, 0.1] {
        let change = move |b: &mut Building, _: &mut FeOptions| b.settings.removal_duration_s = duration;
        all.push(("removal time", format!("{duration} s"), Box::new(change)));
    }
    all
}

fn law(building: &mut Building, change: impl Fn(&mut Homogenised)) {
    for material in building.materials.values_mut() {
        if let Material::Homogenised(law) = material {
            change(law);
        }
    }
}

/// Two points: the first yield stress, and a slope until a tenth of it is left or the critical strain is passed.
fn sloped(law: &Homogenised, slope_pa: f64) -> Vec<HardeningPoint> {
    let first = law.hardening[0];
    let reach = if slope_pa < 0.0 { (0.9 * first.stress_pa / -slope_pa).min(1.0) } else { 1.0 };
    vec![first, HardeningPoint { plastic_strain: reach, stress_pa: first.stress_pa + reach * slope_pa }]
}

/// The frame: the reference building.
fn frame() -> Result<Building, String> {
    let mut building = parse(EXAMPLE, Format::Toml, "frame").map_err(|e| e.to_string())?;
    building.settings.end_time_s = END_S;
    Ok(building)
}

/// Runs all variations; `note` hears of each before it starts.
///
/// # Errors
/// If the frame itself cannot be built.
pub fn measure(note: &dyn Fn(&str)) -> Result<Vec<Row>, String> {
    let base = frame()?;
    let mut rows = Vec::new();
    for (parameter, value, change) in variations() {
        note(&format!("{parameter} {value}"));
        let (mut building, mut options) = (base.clone(), FeOptions::default());
        change(&mut building, &mut options);
        let row = match run(&building, &options, &mut |_| ()) {
            Err(error) => {
                Row { parameter, value, outcome: error.to_string(), energy_error: None, finite: true }
            }
            Ok(fe) => Row {
                parameter,
                value,
                outcome: "finished".into(),
                energy_error: Some(fe.summary.energy_error),
                finite: fe.tracked.iter().flat_map(|h| &h.displacement_m).flatten().all(|u| u.is_finite()),
            },
        };
        rows.push(row);
    }
    Ok(rows)
}

/// The rows as a Markdown page.
pub fn markdown(rows: &[Row]) -> String {
    let mut text = format!(
        "# Numerical stability of the FE solver\n\nThe reference building, {END_S} s, one \
         parameter varied at a time.\nEvery run must end with an energy error of at most {} % or stop with a diagnosis; none may go wrong \
         silently.\nThe contact of nodes with rigid surfaces has no stiffness, so there is none to vary.\n\n\
         | parameter | value | outcome | energy error \\[%\\] | |\n|---|---|---|---:|---|\n",
        100.0 * ENERGY_LIMIT
    );
    for r in rows {
        let error = r.energy_error.map_or("–".into(), |e| format!("{:.3}", 100.0 * e));
        let mark = if r.holds() { "holds" } else { "**fails**" };
        let _ = writeln!(text, "| {} | {} | {} | {error} | {mark} |", r.parameter, r.value, r.outcome);
    }
    text
}
