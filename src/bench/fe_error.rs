//! Error of a building's FE run over mesh size and processor time, against the finest mesh.
//!
//! The measure is that of [`crate::validate::measure`], with the finest run as the reference. The homogenised law belongs to one mesh size,
//! so that the runs need not converge to the building: the figures say how far results depend on the mesh.

use crate::building::Building;
use crate::fe::result::FeRun;
use crate::fe::run::{FeOptions, run};
use crate::validate::measure::{Displacement, at, error_curve};
use std::fmt::Write;

/// One mesh size.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Target element size \[m\].
    pub size_m: f64,
    /// Elements.
    pub elements: usize,
    /// Processor time \[s\].
    pub cpu_s: f64,
    /// First ground contact \[s\].
    pub contact_s: Option<f64>,
    /// Error up to the first contact of the finest run; zero for that run.
    pub e_to_contact: f64,
    /// Error over the whole run.
    pub e_total: f64,
}

/// Runs the building with each size \[m\]; rows from the coarsest to the finest. `note` hears of each run before it starts.
///
/// # Errors
/// If a run stops.
pub fn measure(building: &Building, sizes_m: &[f64], note: &dyn Fn(f64)) -> Result<Vec<Row>, String> {
    let mut sizes = sizes_m.to_vec();
    sizes.sort_by(|a, b| b.total_cmp(a));
    let mut runs: Vec<(f64, FeRun)> = Vec::new();
    for size in sizes {
        note(size);
        let options = FeOptions { mesh_size_m: Some(size), ..FeOptions::default() };
        let fe = run(building, &options, &mut |_| ()).map_err(|e| format!("mesh size {size} m: {e}"))?;
        runs.push((size, fe));
    }
    let Some((_, finest)) = runs.last() else { return Err("no mesh sizes".into()) };
    let contact_s = finest.summary.first_ground_contact_s.unwrap_or(f64::INFINITY);
    let row = |(size_m, fe): &(f64, FeRun)| {
        let pairs: Vec<(&Displacement, &Displacement)> = finest
            .tracked
            .iter()
            .filter_map(|f| {
                let own = fe.tracked.iter().find(|h| h.id == f.id)?;
                Some((&own.displacement_m[..], &f.displacement_m[..]))
            })
            .collect();
        let curve = error_curve(&finest.times_s, &pairs);
        Row {
            size_m: *size_m,
            elements: fe.summary.elements,
            cpu_s: fe.summary.elapsed.cpu_s,
            contact_s: fe.summary.first_ground_contact_s,
            e_to_contact: at(&finest.times_s, &curve, contact_s).unwrap_or(0.0),
            e_total: curve.last().copied().unwrap_or(0.0),
        }
    };
    Ok(runs.iter().map(row).collect())
}

/// The rows as a Markdown page.
pub fn markdown(building: &str, rows: &[Row], machine: &str) -> String {
    let mut text = format!(
        "# Error of the FE run over its cost\n\n`{building}` over mesh sizes, displacements of the tracked points against the finest mesh; \
         {machine}.\nThe homogenised law belongs to one mesh size: the figures say how far results depend on the mesh, not how near they\n\
         are to the building.\n\n![error over processor time](fe-error.svg)\n\n\
         | size \\[m\\] | elements | processor time \\[s\\] | first contact \\[s\\] | e to contact | e total |\n\
         |---:|---:|---:|---:|---:|---:|\n"
    );
    for r in rows {
        let contact = r.contact_s.map_or("none".into(), |t| format!("{t:.3}"));
        let _ = writeln!(
            text,
            "| {} | {} | {:.2} | {contact} | {:.4} | {:.4} |",
            r.size_m, r.elements, r.cpu_s, r.e_to_contact, r.e_total
        );
    }
    text
}
