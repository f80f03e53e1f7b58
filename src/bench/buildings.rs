//! Random small buildings, generated as models and run to rest: each must hold its energy and keep its bodies out of each other.

use super::soundness::{DEPTH_LIMIT_M, Finished, GROWTH_LIMIT};
use crate::base::tree::Format;
use crate::building::parse;
use crate::generate::{Derive, generate};
use crate::library::Store;
use crate::mbs::model::Model;
use crate::mbs::result::RunResult;
use crate::mbs::simulate_carefully;
use crate::rules::RuleBase;
use crate::study::fell;
use crate::study::plan::{Beams, Scene};
use rayon::prelude::*;
use std::fmt::Write;
use std::sync::Mutex;

/// Share of the thickness of the thinner of two solids by which they may be in each other: a tenth is 15 to 25 mm of a slab.
pub const SHARE_LIMIT: f64 = 0.1;
/// Speed below which a building is at rest, the root of twice its kinetic energy over its mass \[m/s\].
const REST_M_S: f64 = 0.01;
/// What is dissipated in the last second, as a share of the kinetic energy at its largest in it, below which a building that moves swings: it would take longer than ten seconds to come to rest.
const SWING_SHARE: f64 = 0.1;
/// Interval of outputs \[s\]: at 20 m/s a body moves by 100 mm in it.
const INTERVAL_S: f64 = 0.005;
/// Share of the time in which the fastest corner moves by the thickness of the thinnest solid that the interval has where that is shorter, and the shortest one \[s\].
const INTERVAL_SHARE: f64 = 0.9;
const SHORTEST_S: f64 = 2e-4;
/// Simulated times after the last charge \[s\], one after the other until the building is at rest.
const SETTLE_S: [f64; 5] = [6.0, 12.0, 24.0, 48.0, 96.0];

/// How a run ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// At rest.
    Rest,
    /// It swings elastically: joints have no damping.
    Swings,
    /// It still moves.
    Moves,
}

/// A run that came to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct Settled {
    /// Energy, depths, run time.
    pub finished: Finished,
    /// Whether any tracked point fell as far as counts as a collapse.
    pub fell: bool,
    /// How it ended.
    pub end: End,
    /// Speed at the end, the root of twice the kinetic energy over the mass \[m/s\].
    pub speed_m_s: f64,
    /// Simulated time \[s\].
    pub end_s: f64,
    /// The hinge that turned most in the last second, and by how much \[rad\]; none: no hinge did.
    pub turns: Option<(String, f64)>,
    /// Bodies at the start.
    pub bodies: usize,
    /// Whether columns or floors of the model may break between their ends.
    pub folds: bool,
    /// What was deepest in the ground, obstacles and other bodies: its name, its mass and that of the building, and when.
    pub deepest: [String; 3],
}

/// A building and what became of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Its number.
    pub number: u32,
    /// What it is, in words.
    pub words: String,
    /// What it shows, or why there is no model, or the diagnosis with which its run stopped.
    pub outcome: Result<Settled, String>,
}

impl Row {
    /// What is wrong with it; nothing: it holds.
    pub fn faults(&self) -> Vec<String> {
        match &self.outcome {
            Ok(settled) => settled.faults(),
            Err(why) => vec![format!("stops: {}", why.split_whitespace().collect::<Vec<_>>().join(" "))],
        }
    }
}

impl Settled {
    fn faults(&self) -> Vec<String> {
        let (f, p) = (&self.finished, &self.finished.passing);
        let beyond = |value: f64, limit: f64| value.is_nan() || value > limit;
        let mut list = Vec::new();
        if beyond(f.conserved_growth, GROWTH_LIMIT) {
            list.push(format!("energy grows by {:.1e} of that turned over", f.conserved_growth));
        }
        if beyond(p.ground.depth_m, DEPTH_LIMIT_M) {
            list.push(format!("{:.1} mm below the ground: {}", 1e3 * p.ground.depth_m, self.deepest[0]));
        }
        if beyond(p.share, SHARE_LIMIT) {
            list.push(format!(
                "solids in each other by {:.0} % of the thinner one: bodies {:.1} mm, {}; obstacles {:.1} mm, {}",
                1e2 * p.share,
                1e3 * p.bodies.depth_m,
                self.deepest[2],
                1e3 * p.obstacle.depth_m,
                self.deepest[1]
            ));
        }
        if !p.is_seen() {
            list.push(format!(
                "a corner moves {:.0} mm between two outputs, the thinnest solid has {:.0} mm",
                1e3 * p.travel_m,
                1e3 * p.thinnest_m
            ));
        }
        if self.end == End::Moves {
            let turns = self.turns.as_ref().map_or_else(
                || "no hinge turns any more: it rubs or strikes something".to_string(),
                |(id, rad)| format!("{id} turned by {:.1} mrad in the last second", 1e3 * rad),
            );
            list.push(format!("still moves at {:.1} s, {:.3} m/s: {turns}", self.end_s, self.speed_m_s));
        }
        list
    }
}

/// Generates and runs the buildings from number 1 on in the current rayon pool; `done` is told of each.
pub fn measure(
    seed: u32,
    count: u32,
    rules: &RuleBase,
    store: &Mutex<&mut Store>,
    done: &(dyn Fn() + Sync),
) -> Vec<Row> {
    let one = |index: u32| {
        let number = index + 1;
        let scene = Scene::small(seed, number);
        let outcome = model_of(&scene, rules, store).and_then(|model| settled(model, &scene));
        done();
        Row { number, words: words(&scene), outcome }
    };
    (0..count).into_par_iter().with_max_len(1).map(one).collect()
}

fn model_of(scene: &Scene, rules: &RuleBase, store: &Mutex<&mut Store>) -> Result<Model, String> {
    let building = parse(&scene.toml(), Format::Toml, &scene.name()).map_err(|e| e.to_string())?;
    let mut store = store.lock().map_err(|e| e.to_string())?;
    let generated = generate(&building, rules, &mut store, Derive::Similar, &|_| {});
    generated.map(|g| g.model).map_err(|e| e.to_string())
}

/// Runs a model until it is at rest, or swings, or there is no more time.
fn settled(mut model: Model, scene: &Scene) -> Result<Settled, String> {
    let last_s = scene.blasts.iter().map(|b| b.time_s).fold(0.0, f64::max);
    model.settings.output_interval_s = INTERVAL_S;
    let run = |model: &Model| {
        let result = simulate_carefully(model).map_err(|e| e.to_string())?;
        Ok::<_, String>(Settled::of(model, &result))
    };
    let mut found = None;
    for settle_s in SETTLE_S {
        model.settings.end_time_s = last_s + settle_s;
        let mut settled = run(&model)?;
        let passing = &settled.finished.passing;
        if !passing.is_seen() {
            let share = INTERVAL_SHARE * passing.thinnest_m / passing.travel_m;
            model.settings.output_interval_s = (share * model.settings.output_interval_s).max(SHORTEST_S);
            settled = run(&model)?;
        }
        let ended = settled.end != End::Moves;
        found = Some(settled);
        if ended {
            break;
        }
    }
    found.ok_or_else(|| "no time to run for".to_string())
}

impl Settled {
    /// Asks a run.
    pub fn of(model: &Model, result: &RunResult) -> Self {
        let finished = Finished::of(model, result);
        let removed = |id: &String| model.events.iter().any(|e| e.remove_bodies.contains(id));
        let present = model.bodies.iter().filter(|b| !removed(&b.id));
        let mass: f64 = present.map(|b| b.mass_kg).sum();
        let e = &result.energies;
        let last = result.times_s.len() - 1;
        let speed_m_s = (2.0 * e.kinetic_j[last] / mass).sqrt();
        let before = last.saturating_sub((1.0 / model.settings.output_interval_s).round() as usize);
        let over = |energy: &[f64]| energy[last] - energy[before];
        // what inertia against relative motion begins with is released with a minus: it must not make up for what hinges take
        let spent_j =
            over(&e.plastic_j) + over(&e.contact_damping_j) + over(&e.friction_j) + over(&e.released_j).abs();
        let kinetic = e.kinetic_j[before..].iter().copied().fold(0.0, f64::max);
        let end = if speed_m_s < REST_M_S {
            End::Rest
        } else if spent_j < SWING_SHARE * kinetic {
            End::Swings
        } else {
            End::Moves
        };
        let p = &finished.passing;
        let deepest = [p.ground, p.obstacle, p.bodies].map(|at| {
            let body = &model.bodies[at.body];
            format!(
                "{} ({:.1} t of {:.0} t) at {:.3} s",
                body.id,
                1e-3 * body.mass_kg,
                1e-3 * mass,
                at.time_s
            )
        });
        Self {
            finished,
            fell: result.tracked.iter().any(|t| fell(&t.displacement_m)),
            end,
            speed_m_s,
            end_s: result.times_s[last],
            turns: turned_most(result, before),
            bodies: model.bodies.len(),
            folds: model.bushings.iter().any(|b| b.latent.is_some()),
            deepest,
        }
    }
}

/// The hinge that turned most from an output to the last one, and by how much \[rad\]; none if none did.
fn turned_most(result: &RunResult, from: usize) -> Option<(String, f64)> {
    let last = result.times_s.len() - 1;
    let turned =
        result.hinges.iter().map(|h| (&h.joint, h.plastic_rotation_rad[last] - h.plastic_rotation_rad[from]));
    let most = turned.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, rad)| *rad > 0.0)?;
    Some((most.0.clone(), most.1))
}

/// A building in words.
fn words(scene: &Scene) -> String {
    let [x, y] = [0, 1].map(|d| scene.axes_m[d].len() - 1);
    let mut text = format!(
        "{} × {} bays, {} storeys, {}, columns {:.0} mm, {} removed",
        x,
        y,
        scene.heights_m.len(),
        match scene.beams {
            Beams::All => "beams",
            Beams::Perimeter => "outer beams",
            Beams::None => "flat slab",
        },
        1e3 * scene.sizes.column_m,
        scene.blasts.len()
    );
    let obstacles = scene.blocks.len() + usize::from(scene.obstacle.is_some());
    for (is, what) in
        [(scene.has_wall, "wall"), (scene.has_opening, "opening"), (scene.weakened.is_some(), "weakened")]
    {
        if is {
            let _ = write!(text, ", {what}");
        }
    }
    if obstacles > 0 {
        let _ = write!(text, ", {obstacles} obstacles");
    }
    text
}

/// The page.
pub fn markdown(seed: u32, rows: &[Row]) -> String {
    let settled: Vec<&Settled> = rows.iter().filter_map(|r| r.outcome.as_ref().ok()).collect();
    let count = |is: &dyn Fn(&Settled) -> bool| settled.iter().filter(|s| is(s)).count();
    let faulty = rows.iter().filter(|r| !r.faults().is_empty()).count();
    let mut text = format!(
        "# Stability of generated models of random buildings\n\n{}\n\n| buildings | |\n|---|---|\n| all | {} |\n| hold | {} |\n| do not hold, or stop | {} |\n| fall | {} |\n| stand | {} |\n\
         | at rest at the end | {} |\n| swing elastically at the end | {} |\n| still move at the end | {} |\n| have columns or floors that may break between their ends | {} |\n| warn of their energy or of deep contacts | {} |\n\
         | whose sum of all energies, that half step included, grows by more than 1e-3 at an output | {} |\n",
        INTRODUCTION.replace("SEED", &seed.to_string()).replace("COUNT", &rows.len().to_string()),
        rows.len(),
        rows.len() - faulty,
        faulty,
        count(&|s| s.fell),
        count(&|s| !s.fell),
        count(&|s| s.end == End::Rest),
        count(&|s| s.end == End::Swings),
        count(&|s| s.end == End::Moves),
        count(&|s| s.folds),
        count(&|s| s.finished.warned),
        count(&|s| s.finished.growth > GROWTH_LIMIT),
    );
    text.push_str("\n| of runs that came to their end | median | 90 % | largest |\n|---|---|---|---|\n");
    let mut line = |name: &str, of: &dyn Fn(&Settled) -> f64, shown: &dyn Fn(f64) -> String| {
        let mut values: Vec<f64> = settled.iter().map(|s| of(s)).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values.get(((values.len() as f64 - 1.0) * share).round() as usize);
        let cell = |share: f64| at(share).map_or_else(|| "-".to_string(), |v| shown(*v));
        let _ = writeln!(text, "| {name} | {} | {} | {} |", cell(0.5), cell(0.9), cell(1.0));
    };
    let (small, fixed) = (|v: f64| format!("{v:.1e}"), |v: f64| format!("{v:.2}"));
    let whole = |v: f64| format!("{v:.0}");
    line("error of the energy balance", &|s| s.finished.energy_error, &small);
    line("growth of the energy", &|s| s.finished.conserved_growth, &small);
    line("growth of the sum of all energies", &|s| s.finished.growth, &small);
    line("depth below the ground (mm)", &|s| 1e3 * s.finished.passing.ground.depth_m, &fixed);
    line("depth in an obstacle (mm)", &|s| 1e3 * s.finished.passing.obstacle.depth_m, &fixed);
    line("depth of bodies in each other (mm)", &|s| 1e3 * s.finished.passing.bodies.depth_m, &fixed);
    line("the same over the thinner solid", &|s| s.finished.passing.share, &small);
    line("speed at the end (m/s)", &|s| s.speed_m_s, &small);
    line("simulated time (s)", &|s| s.end_s, &fixed);
    line("bodies", &|s| s.bodies as f64, &whole);
    line("steps", &|s| s.finished.steps as f64, &whole);
    line("processor time (s)", &|s| s.finished.cpu_s, &fixed);
    text.push_str("\n## Those that do not hold\n\n");
    if faulty == 0 {
        text.push_str("None.\n");
        return text;
    }
    text.push_str("| number | building | what went wrong |\n|---|---|---|\n");
    for row in rows {
        let faults = row.faults();
        if !faults.is_empty() {
            let _ = writeln!(text, "| {} | {} | {} |", row.number, row.words, faults.join("; "));
        }
    }
    text.push_str(REASONS);
    text
}

const REASONS: &str = "
What still moves swings on hinges without damping: each swing makes hinges flow or solids rub a little, more than a tenth of the kinetic energy in a second, and the weight of floors that sag by it gives it back. No energy is made: that would be named. What is in the ground at one output, if anything is, is a light piece on which the rest of the building, tens of times as heavy, comes down within one step; the next steps open it.
";

const INTRODUCTION: &str = "Output of `fallwerk bench buildings --seed SEED --count COUNT -o docs`. Random small buildings (`src/study/plan/small.rs`): one to three bays each way, one to four storeys, beams on all axes, on the outer ones or none, columns of 250 \
to 450 mm, some with walls, openings, weakened columns, walls and blocks in the way. Any columns of one or two storeys are removed, all at once, row by row or each at a time of its own. The shipped rules and library make the model (`--derive=similar`), which runs until it is \
at rest (the root of twice the kinetic energy over the mass below 10 mm/s) or swings (it loses less than a tenth of its kinetic energy in a second: joints and walls have no damping but friction and plastic flow), for 6, 12, 24, 48 or 96 s after the last charge. `--show NUMBER` prints a building file.

A building holds if it comes to that end, its energy never grows by more than 1e-3 of that turned over (`energy_growth` of the run: the sum of all energies but for what forces add in half a step, as a leapfrog conserves it), nothing sinks into the ground by more than 1 mm, and no two solids, or a solid and an obstacle, get into each other by more than a tenth of the thinner one. \
Depths come from the poses at outputs 5 ms apart (less where bodies are faster than the thinnest solid allows), not from the contact solver (`src/bench/passing.rs`): all boxes that can touch are compared by the fifteen axes that tell two boxes apart, and what counts is by how much they overlap beyond what they did when they became able to touch, \
at the start or as the joint between them broke. No corner may move farther between two outputs than the thinnest solid is thick: so nothing can pass through anything unseen.";
