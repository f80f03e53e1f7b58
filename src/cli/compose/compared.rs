//! All runs beside each other: the same figures on the page and on the terminal.

use crate::cli::fe_hybrid::STAYS_RIGID;
use crate::report::ComparedRun;
use crate::validate::{DebrisPoint, Validation};

/// FE, hybrid if there was such a run, MBS.
pub fn runs(v: &Validation) -> Vec<ComparedRun> {
    // what stands has no debris
    let debris = |overlap: f64| (!v.stands()).then_some(overlap);
    let fe = ComparedRun {
        name: "FE".into(),
        first_contact_s: v.first_contact_s.fe,
        cpu_s: Some(v.cpu_s.fe),
        energy_error: Some(v.energy_error.fe),
        ..ComparedRun::default()
    };
    let hybrid = v.hybrid.as_ref().map(|h| ComparedRun {
        name: "hybrid".into(),
        until_contact: h.e_to_contact,
        after_contact: h.e_after_contact,
        until_end: h.e_total,
        without_debris: h.e_total_without_debris,
        first_contact_s: h.first_contact_s,
        cpu_s: Some(h.cpu_s),
        cpu_share: Some(h.cpu_share),
        energy_error: Some(h.energy_error),
        footprint_overlap: debris(h.footprint_overlap),
    });
    let mbs = ComparedRun {
        name: "MBS".into(),
        until_contact: v.e_to_contact,
        after_contact: v.e_after_contact,
        until_end: v.e_total,
        without_debris: v.e_total_without_debris,
        first_contact_s: v.first_contact_s.mbs,
        cpu_s: Some(v.cpu_s.mbs),
        cpu_share: Some(1.0 / v.speed_ratio.max(1e-9)),
        energy_error: Some(v.energy_error.mbs),
        footprint_overlap: debris(v.footprint_overlap),
    };
    [fe].into_iter().chain(hybrid).chain([mbs]).collect()
}

/// Which points are debris, how far rounding decides, and what rigid parts did.
pub fn notes(v: &Validation) -> Vec<String> {
    let mut notes = Vec::new();
    match v.debris.as_slice() {
        [] => notes.push("No tracked point becomes debris in the FE run.".into()),
        points => notes.push(format!(
            "Tracked points that become debris in the FE run, because the elements that carry them fail: {}. From then on they are point masses \
             that fly freely. They count in e; the error without them stands beside it.",
            named(points)
        )),
    }
    notes.extend(v.spread.iter().map(|s| format!("MBS: {}.", s.words())));
    let Some(h) = &v.hybrid else { return notes };
    notes.push(format!(
        "Hybrid run: {:.0} % of the acting elements were rigid in the mean, {:.0} % of the element work was left out; {} switches changed the energy by \
         {:.2} kJ.",
        100.0 * h.mean_rigid_share,
        100.0 * h.skipped_share,
        h.switches,
        1e-3 * h.switched_j
    ));
    if !h.switching {
        notes.push(format!("Hybrid run: {STAYS_RIGID}."));
    }
    if !h.debris.is_empty() {
        notes.push(format!("Tracked points that become debris in the hybrid run: {}.", named(&h.debris)));
    }
    notes
}

/// "S2.corner-01 from 1.480 s, ...".
fn named(points: &[DebrisPoint]) -> String {
    let words: Vec<String> = points.iter().map(|d| format!("{} from {:.3} s", d.point, d.from_s)).collect();
    words.join(", ")
}

/// The table of all runs in lines, indented.
pub fn table(v: &Validation) -> String {
    let head = [
        "run",
        "e to contact",
        "after it",
        "e total",
        "without debris",
        "contact [s]",
        "processor [s]",
        "of FE",
        "energy error",
        "footprint",
    ];
    let figure = |x: Option<f64>, digits: usize| x.map_or("-".to_string(), |x| format!("{x:.digits$}"));
    let percent =
        |x: Option<f64>, digits: usize| x.map_or("-".to_string(), |x| format!("{:.digits$} %", 100.0 * x));
    let line = |cells: [String; 10]| {
        let mut text = format!("    {:<7}", cells[0]);
        for (cell, name) in cells.iter().zip(head).skip(1) {
            text += &format!("  {cell:>width$}", width = name.len());
        }
        text + "\n"
    };
    let row = |r: ComparedRun| {
        line([
            r.name,
            figure(r.until_contact, 4),
            figure(r.after_contact, 4),
            figure(r.until_end, 4),
            figure(r.without_debris, 4),
            figure(r.first_contact_s, 3),
            figure(r.cpu_s, 3),
            percent(r.cpu_share, 2),
            percent(r.energy_error, 3),
            percent(r.footprint_overlap, 0),
        ])
    };
    line(head.map(String::from)) + &runs(v).into_iter().map(row).collect::<String>()
}
