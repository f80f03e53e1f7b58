//! The page of the tested columns: each of them, with what was measured and what was computed.

use super::column_runs::{ColumnRun, Options, Spread};
use super::columns::figures;
use crate::rc::member::Joint;
use crate::verify::columns::Failure;
use crate::verify::manual;
use std::fmt::Write;

/// How a test ended, in words.
fn ended(failure: Failure) -> &'static str {
    match failure {
        Failure::Flexure => "bending",
        Failure::FlexureShear => "shear after yield",
        Failure::Shear => "shear",
    }
}

/// The options as words of the command line; nothing if they are the usual ones.
fn words(options: &Options) -> String {
    let usual = Options::default();
    let mut text = String::new();
    if options.elements != usual.elements {
        let _ = write!(text, " --elements {}", options.elements);
    }
    if options.joint != usual.joint {
        text.push_str(" --joint block");
    }
    if options.until_rad != usual.until_rad {
        let _ = write!(text, " --until {}", options.until_rad);
    }
    text
}

/// The page as Markdown.
pub fn markdown(options: &Options, runs: &[ColumnRun]) -> String {
    let joint = match options.joint {
        Joint::Symmetry => "a plane of symmetry",
        Joint::Block => "a block of uncracked concrete",
    };
    let mut text = format!(
        "# Tested columns\n\n\
         {} reinforced concrete columns of {}, bent by the [RC submodel](rc.md) and set beside what was measured. The page is the output of\n\n    \
         fallwerk verify columns{} -o docs\n\n\
         which bends every column anew; none is left out. Properties and measurements are in `src/verify/columns.rs`, the comparison in\n\
         `src/verify/rc/column_runs.rs`.\n\n",
        runs.len(),
        sources(runs),
        words(options),
    );
    let _ = write!(
        text,
        "- Computed: the column on {joint}, elements of about 1/{} of its depth, bars that buckle between the ties, axial force first, then pushed once to a drift of {:.0} %\n  \
         or until a fifth of its largest moment is left. The tests went back and forth.\n\
         - `M`: largest moment at the base with that of the axial force over the drift; measured: the mean of both directions. Computed moments may lie at drifts that\n  \
         the test did not reach.\n\
         - `d`: drift at which the lateral force had fallen to 80 % of its largest. `≥`: it had not fallen when the test or the bend ended; the last drift counts. Where the\n  \
         test had not fallen, a bend that bears more counts with the drift of the test (ratio 1).\n\
         - Ratios are measured over computed.\n\n",
        options.elements,
        100.0 * options.until_rad,
    );
    text.push_str(&statistics(runs));
    text.push_str(
        "\n![measured and computed](rc-columns.svg)\n\n\
         | column | N/(f_c A) | test ended by | M measured \\[kN m\\] | M computed | ratio | d measured \\[%\\] | d computed | ratio | elements |\n\
         |---|---:|---|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    runs.iter().for_each(|run| row(&mut text, run));
    text
}

/// Sources of the runs, each once.
fn sources(runs: &[ColumnRun]) -> String {
    let mut all: Vec<&str> = Vec::new();
    for run in runs {
        if !all.contains(&run.specimen.source) {
            all.push(run.specimen.source);
        }
    }
    all.join("; ")
}

/// Targets and what is reached.
fn statistics(runs: &[ColumnRun]) -> String {
    let mut text = String::from("| figure | computed | wanted | |\n|---|---:|---|---|\n");
    for f in figures(runs) {
        let half = match f.tolerance {
            crate::verify::Tolerance::Absolute(half) => half,
            crate::verify::Tolerance::Relative(share) => share * f.reference,
        };
        let digits = |v: f64| format!("{v:.3}").trim_end_matches('0').trim_end_matches('.').to_string();
        let wanted = if half == 0.0 {
            digits(f.reference)
        } else {
            format!("{} to {}", digits(f.reference - half), digits(f.reference + half))
        };
        let verdict = if f.passes() { "reached" } else { "**missed**" };
        let _ = writeln!(text, "| {} | {} | {wanted} | {verdict} |", f.quantity, digits(f.ours));
    }
    let ratios = |flexure: bool, of: fn(&ColumnRun) -> Option<f64>| {
        let own: Vec<f64> = runs.iter().filter(|r| r.is_shear_critical() != flexure).filter_map(of).collect();
        Spread::of(&own)
    };
    text.push_str("\nMeasured over computed by how the test ended:\n\n| tests that ended by | columns | M: mean, variation | d: median, deviation of ln |\n|---|---:|---|---|\n");
    for (name, flexure) in [("bending", true), ("shear", false)] {
        let pair = (ratios(flexure, ColumnRun::moment_ratio), ratios(flexure, ColumnRun::drift_ratio));
        if let (Some(m), Some(d)) = pair {
            let _ = writeln!(
                text,
                "| {name} | {} | {:.3}, {:.3} | {:.3}, {:.3} |",
                m.count, m.mean, m.variation, d.median, d.sigma_ln
            );
        }
    }
    text
}

fn row(text: &mut String, run: &ColumnRun) {
    let s = run.specimen;
    let at_least = |fell: bool| if fell { "" } else { "≥ " };
    let _ = write!(
        text,
        "| {} | {:.3} | {} | {:.0} | ",
        s.name,
        s.axial_share,
        ended(s.failure),
        run.measured_nm() / 1e3
    );
    let measured = format!("{}{:.2}", at_least(s.fell), 100.0 * s.drift_at_80);
    let _ = match (&run.computed, run.moment_ratio(), run.drift_ratio()) {
        (Ok(c), Some(moment), Some(drift)) => writeln!(
            text,
            "{:.0} | {moment:.3} | {measured} | {}{:.2} | {drift:.3} | {} |",
            c.peak_nm / 1e3,
            at_least(c.fell),
            100.0 * c.drift_at_80,
            run.elements
        ),
        (Err(error), ..) => {
            writeln!(text, "{} | - | {measured} | - | - | {} |", manual::in_cell(error), run.elements)
        }
        _ => writeln!(text, "- | - | {measured} | - | - | {} |", run.elements),
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::columns::SPECIMENS;
    use crate::verify::rc::column_runs::Computed;

    #[test]
    fn every_column_has_a_row_also_one_that_cannot_be_bent() {
        let computed = Computed {
            peak_nm: 500e3,
            peak_drift: 0.01,
            lateral_n: 200e3,
            drift_at_80: 0.08,
            fell: false,
            failed: false,
            kinetic_share: 0.01,
        };
        let run = |(i, specimen)| ColumnRun {
            specimen,
            elements: 900,
            computed: if i == 3 { Err("crushed | gone".into()) } else { Ok(computed) },
        };
        let runs: Vec<ColumnRun> = SPECIMENS.iter().enumerate().map(run).collect();
        let page = markdown(&Options { elements: 4.0, ..Options::default() }, &runs);
        for specimen in &SPECIMENS {
            assert_eq!(page.lines().filter(|l| l.starts_with(&format!("| {} |", specimen.name))).count(), 1);
        }
        assert!(page.contains("fallwerk verify columns --elements 4 -o docs"), "{page}");
        assert!(
            page.contains("crushed \\| gone") && page.contains("| ≥ 8.00 |") && page.contains("**missed**")
        );
        assert!(page.contains("| columns bent | 22 | 23 | **missed** |"), "{page}");
    }
}
