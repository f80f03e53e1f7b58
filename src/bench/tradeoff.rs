//! Run time against error of all models of a building: MBS at each level of detail, hybrid, FE at several mesh sizes, each against the finest FE run.
//!
//! The homogenised law belongs to one mesh size, so that FE runs of other sizes differ by more than discretisation. Models generated from a building share the size of its file: their error against the FE run of
//! that size stands beside the one against the finest.

use crate::building::Building;
use crate::fe::hybrid::HybridSettings;
use crate::fe::result::{FeRun, History};
use crate::fe::run::{FeOptions, run};
use crate::generate::{Accuracy, GenerateError, Generated};
use crate::validate::points::PointErrors;
use serde::Serialize;
use std::fmt::Write;

/// What kind of model a row is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Generated multibody model.
    Mbs,
    /// FE with rigid parts.
    Hybrid,
    /// FE.
    Fe,
}

/// One model of one building.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Building.
    pub building: String,
    /// Kind of model.
    pub kind: Kind,
    /// Level of detail or mesh size.
    pub level: String,
    /// Bodies or elements.
    pub parts: usize,
    /// Processor time of the run \[s\].
    pub cpu_s: f64,
    /// Error against the finest FE run up to its first contact.
    pub e_to_contact: f64,
    /// The same over the whole run.
    pub e_total: f64,
    /// The same two against the FE run with the mesh size of the building's file.
    pub e_own: [f64; 2],
}

/// A run whose points are compared.
struct Candidate {
    kind: Kind,
    level: String,
    parts: usize,
    cpu_s: f64,
    tracked: Vec<History>,
}

/// Makes and runs all models of a building. `sizes_m` are those of FE runs, beside that of the building's file; `note` hears of each run before it starts.
///
/// # Errors
/// If a model cannot be generated or a run stops.
pub fn measure(
    building: &Building,
    sizes_m: &[f64],
    generated: &mut dyn FnMut(Accuracy) -> Result<Generated, GenerateError>,
    note: &dyn Fn(&str),
) -> Result<Vec<Row>, String> {
    let own_m = building.settings.mesh_size_m;
    let mut sizes: Vec<f64> = sizes_m.iter().copied().chain([own_m]).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    sizes.dedup();
    let mut candidates = Vec::new();
    for accuracy in Accuracy::ALL {
        note(&format!("MBS, {}", accuracy.name()));
        let model = generated(accuracy).map_err(|e| e.to_string())?.model;
        let result =
            crate::mbs::simulate_carefully(&model).map_err(|e| format!("MBS, {}: {e}", accuracy.name()))?;
        candidates.push(Candidate {
            kind: Kind::Mbs,
            level: accuracy.name().into(),
            parts: model.bodies.len(),
            cpu_s: result.cpu_s,
            tracked: result
                .tracked
                .into_iter()
                .map(|t| History { id: t.id, displacement_m: t.displacement_m, debris_s: None })
                .collect(),
        });
    }
    note("hybrid");
    let hybrid = fe(building, own_m, Some(HybridSettings::default()))?;
    candidates.push(Candidate::of(Kind::Hybrid, own_m, &hybrid));
    let mut runs = Vec::new();
    for size in sizes {
        note(&format!("FE, {size} m"));
        runs.push((size, fe(building, size, None)?));
    }
    candidates.extend(runs.iter().map(|(size, run)| Candidate::of(Kind::Fe, *size, run)));
    let finest = runs.last().map(|(_, run)| run).ok_or("no mesh sizes")?;
    let own = runs.iter().find(|(size, _)| *size == own_m).map_or(finest, |(_, run)| run);
    Ok(candidates.iter().map(|c| c.row(building, finest, own)).collect())
}

fn fe(building: &Building, size_m: f64, hybrid: Option<HybridSettings>) -> Result<FeRun, String> {
    let options = FeOptions { mesh_size_m: Some(size_m), hybrid, ..FeOptions::default() };
    run(building, &options, &mut |_| ()).map_err(|e| format!("mesh size {size_m} m: {e}"))
}

impl Candidate {
    fn of(kind: Kind, size_m: f64, run: &FeRun) -> Self {
        Self {
            kind,
            level: format!("{size_m} m"),
            parts: run.summary.elements,
            cpu_s: run.summary.elapsed.cpu_s,
            tracked: run.tracked.clone(),
        }
    }

    fn row(&self, building: &Building, finest: &FeRun, own: &FeRun) -> Row {
        let against = |fe: &FeRun| {
            let of = |id: &str| self.tracked.iter().find(|t| t.id == id).map(|t| &t.displacement_m[..]);
            let outputs = self.tracked.first().map_or(0, |t| t.displacement_m.len());
            let errors = PointErrors::of(&fe.times_s, &fe.tracked, outputs, of);
            [errors.until(fe.summary.first_ground_contact_s), errors.until(None)]
                .map(|e| e.unwrap_or(f64::NAN))
        };
        let [e_to_contact, e_total] = against(finest);
        Row {
            building: building.name.clone(),
            kind: self.kind,
            level: self.level.clone(),
            parts: self.parts,
            cpu_s: self.cpu_s,
            e_to_contact,
            e_total,
            e_own: against(own),
        }
    }
}

impl Kind {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mbs => "MBS",
            Self::Hybrid => "hybrid",
            Self::Fe => "FE",
        }
    }
}

/// The rows as a Markdown page.
pub fn markdown(rows: &[Row], machine: &str) -> String {
    let mut text = format!(
        "# Run time against error\n\nDisplacements of the tracked points against the finest FE run of each building, and against the FE run with the mesh size of its \
         file, which the homogenised law belongs to;\n{machine}. Levels of the MBS are those of `generate-mbs --accuracy`. The finest FE run has no error and no point in the plots.\n\n![error over processor time](tradeoff.svg)\n\n\
         | building | model | level | bodies or elements | processor time \\[s\\] | e to contact | e total | to contact, own mesh | total, own mesh |\n\
         |---|---|---|---:|---:|---:|---:|---:|---:|\n"
    );
    for r in rows {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} |",
            r.building,
            r.kind.name(),
            r.level,
            r.parts,
            r.cpu_s,
            r.e_to_contact,
            r.e_total,
            r.e_own[0],
            r.e_own[1]
        );
    }
    text
}
