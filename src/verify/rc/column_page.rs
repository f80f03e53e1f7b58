//! The page of the tested columns: each of them, with what was measured and what was computed.

use super::column_envelope::Computed;
use super::column_runs::{ColumnRun, Options, Spread};
use super::column_shear::AMPLITUDES_RAD;
use super::columns::figures;
use crate::rc::member::Joint;
use crate::rc::shear::CRITICAL_SHARE;
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
        text.push_str(match options.joint {
            Joint::Symmetry => " --joint symmetry",
            Joint::Block => " --joint block",
        });
    }
    if options.slip != usual.slip {
        text.push_str(" --full-bond");
    }
    if options.cycled != usual.cycled {
        text.push_str(" --monotonic");
    }
    if options.until_rad != usual.until_rad {
        let _ = write!(text, " --until {}", options.until_rad);
    }
    text
}

/// The page as Markdown.
pub fn markdown(options: &Options, runs: &[ColumnRun]) -> String {
    let mut text = format!(
        "# Tested columns\n\n\
         {} reinforced concrete columns of {}, bent by the [RC submodel](rc.md) and set beside what was measured. The page is the output of\n\n    \
         fallwerk verify columns{} -o docs\n\n\
         which bends every column anew; none is left out. Properties and measurements are in `src/verify/columns.rs`, the comparison in\n\
         `src/verify/rc/column_runs.rs`, `column_envelope.rs` and `column_shear.rs`.\n\n",
        runs.len(),
        sources(runs),
        words(options),
    );
    text.push_str(&method(options));
    text.push_str(&statistics(runs));
    text.push_str(
        "\n![measured and computed](rc-columns.svg)\n\n\
         | column | N/(f_c A) | test ended by | V_p/V_o | M measured \\[kN m\\] | M computed | ratio | d measured \\[%\\] | d monotonic | d cycled | ratio | elements |\n\
         |---|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    runs.iter().for_each(|run| row(&mut text, run));
    text.push_str(&cycled(runs));
    text
}

/// What was computed and what is compared.
fn method(options: &Options) -> String {
    let slip = if options.slip { "bars slip out of it" } else { "full bond of its bars" };
    let joint = match options.joint {
        Joint::Symmetry => format!("a plane of symmetry, {slip}"),
        Joint::Block => format!("a block of uncracked concrete, {slip}"),
    };
    let mut text = format!(
        "- Computed: half the column (its other half is the mirror image) on {joint}; elements of about 1/{} of its depth, bars that buckle between the ties. The axial force acts first; then\n  \
         the column is pushed once to a drift of {:.0} % or until a fifth of its largest moment is left. The tests went back and forth.\n",
        options.elements,
        100.0 * options.until_rad,
    );
    if options.cycled {
        let amplitudes: Vec<String> =
            AMPLITUDES_RAD.iter().map(|a| format!("{}", 1e-3 * (1e5 * a).round())).collect();
        let _ = write!(
            text,
            "- Shear: `V_p` is the largest lateral force of that push, `V_o` the shear strength of the undamaged column by ASCE 41-17, eq. 10-3 (k = 1, measured strengths). Beyond\n  \
             `V_p / V_o` = {CRITICAL_SHARE} (in bold) a column is bent again, in cycles of {} % drift, once each in both senses, and the cycles are what is compared: cycles\n  \
             take shear strength that one push leaves. The rule and its limit were set beforehand and are the same for all columns.\n",
            amplitudes.join(", "),
        );
    } else {
        text.push_str("- Shear: `V_p` is the largest lateral force, `V_o` the shear strength of the undamaged column by ASCE 41-17, eq. 10-3 (k = 1, measured strengths). No column is cycled.\n");
    }
    text.push_str(
        "- `M`: largest moment at the base with that of the axial force over the drift; the mean of both directions, of tests and of cycles. Computed moments count up to the last\n  \
         drift of the test: beyond it bars harden on, and no test saw that.\n\
         - `d`: drift at which the lateral force had fallen to 80 % of its largest. Cycles have an envelope in each sense, the points on ways in this sense at which the column was bent\n  \
         further than before. The first point behind the largest force of the envelope that lies below 80 % of it counts, interpolated from the one before, in the sense that\n  \
         falls first. An axial failure counts as a fall at its drift. What is lost between the peak of a cycle and the next way beyond it shows as a fall at that peak.\n\
         - `≥`: it had not fallen when the test or the bend ended; the last drift counts. Where the test had not fallen, a bend that bears more counts with the drift of the test\n  \
         (ratio 1).\n\
         - Ratios are measured over computed.\n\n",
    );
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
        // no minus before a zero
        let digits = |v: f64| format!("{}", (1e3 * v).round() / 1e3 + 0.0);
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

/// A drift \[%\].
fn percent(drift: f64, fell: bool) -> String {
    format!("{}{:.2}", if fell { "" } else { "≥ " }, 100.0 * drift)
}

fn row(text: &mut String, run: &ColumnRun) {
    let s = run.specimen;
    let ratio = |value: Option<f64>| value.map_or("-".to_string(), |v| format!("{v:.3}"));
    let drift = |of: &Computed| percent(of.drift_at_80, of.fell);
    let share = run.shear_share().map_or("-".to_string(), |v| format!("{v:.2}"));
    let cells = [
        s.name.to_string(),
        format!("{:.3}", s.axial_share),
        ended(s.failure).to_string(),
        if run.cycled.is_some() { format!("**{share}**") } else { share },
        format!("{:.0}", run.measured_nm() / 1e3),
        run.computed().map_or_else(|error| manual::in_cell(error), |c| format!("{:.0}", c.peak_nm / 1e3)),
        ratio(run.moment_ratio()),
        percent(s.drift_at_80, s.fell),
        run.monotonic.as_ref().map_or("-".to_string(), drift),
        run.cycled.as_ref().and_then(|c| c.as_ref().ok()).map_or("-".to_string(), drift),
        ratio(run.drift_ratio()),
        run.elements.to_string(),
    ];
    let _ = writeln!(text, "| {} |", cells.join(" | "));
}

/// What cycles changed; nothing if no column was cycled.
fn cycled(runs: &[ColumnRun]) -> String {
    let mut text = String::new();
    let pairs =
        runs.iter().filter_map(|r| Some((r, r.monotonic.as_ref().ok()?, r.cycled.as_ref()?.as_ref().ok()?)));
    for (run, push, cycles) in pairs {
        if text.is_empty() {
            text.push_str(
                "\nCycled columns: the push and the cycles\n\n\
                 | column | M measured \\[kN m\\] | M monotonic | M cycled | V monotonic \\[kN\\] | V cycled | d measured \\[%\\] | d monotonic | d cycled | cycles ended by |\n\
                 |---|---:|---:|---:|---:|---:|---:|---:|---:|---|\n",
            );
        }
        let kilo = |values: [f64; 2]| values.map(|v| format!("{:.0}", v / 1e3)).join(" | ");
        let _ = writeln!(
            text,
            "| {} | {:.0} | {} | {} | {} | {} | {} | {} |",
            run.specimen.name,
            run.measured_nm() / 1e3,
            kilo([push.peak_nm, cycles.peak_nm]),
            kilo([push.lateral_n, cycles.lateral_n]),
            percent(run.specimen.drift_at_80, run.specimen.fell),
            percent(push.drift_at_80, push.fell),
            percent(cycles.drift_at_80, cycles.fell),
            cycles.ending,
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rc::bend::Ending;
    use crate::verify::columns::SPECIMENS;

    #[test]
    fn every_column_has_a_row_also_one_that_cannot_be_bent() {
        let computed = Computed {
            peak_nm: 500e3,
            peak_drift: 0.01,
            lateral_n: 200e3,
            drift_at_80: 0.08,
            fell: false,
            ending: Ending::Path,
            kinetic_share: 0.01,
            energy_error: 0.001,
        };
        let lost = Ending::Axial { rotation_rad: 0.02, shortening_m: 0.02 };
        let cycles = Computed { peak_nm: 400e3, drift_at_80: 0.0123, fell: true, ending: lost, ..computed };
        let run = |(i, specimen)| ColumnRun {
            specimen,
            elements: 900,
            monotonic: if i == 3 { Err("crushed | gone".into()) } else { Ok(computed) },
            cycled: match i {
                20 => Some(Ok(cycles)),
                21 => Some(Err("not finite".into())),
                _ => None,
            },
        };
        let runs: Vec<ColumnRun> = SPECIMENS.iter().enumerate().map(run).collect();
        let page = markdown(&Options { elements: 4.0, ..Options::default() }, &runs);
        let rows = |name: &str| {
            let own = format!("| {name} |");
            page.lines().filter(|l| l.starts_with(&own)).map(str::to_string).collect::<Vec<_>>()
        };
        for (i, specimen) in SPECIMENS.iter().enumerate() {
            assert_eq!(rows(specimen.name).len(), if i == 20 { 2 } else { 1 });
        }
        assert!(page.contains("fallwerk verify columns --elements 4 -o docs"), "{page}");
        assert!(
            page.contains("crushed \\| gone") && page.contains("| ≥ 8.00 |") && page.contains("**missed**")
        );
        assert!(page.contains("| columns bent | 21 | 23 | **missed** |"), "{page}");
        assert!(page.contains("| 0 to 0.1 | **missed** |") && !page.contains("-0"), "{page}");
        // V_o of Sezen No. 1: 243.9 kN; both drifts, and the cycles' moment is compared
        let [one, two] = [0, 1].map(|i| rows("Sezen No. 1")[i].clone());
        assert!(
            one.contains("| **0.82** | 473 | 400 | 1.182 | 2.55 | ≥ 8.00 | 1.23 | 2.076 | 900 |"),
            "{one}"
        );
        assert!(two.contains("| 500 | 400 |") && two.contains("axial failure at drift 2.00 %"), "{two}");
        // cycles that cannot be used leave the push in the table and nothing to compare
        assert!(rows("Sezen No. 2")[0].contains("| not finite | - | 1.52 | ≥ 8.00 | - | - |"), "{page}");
        // a table has as many cells in each row as in its head
        let mut cells = 0;
        for line in page.lines() {
            let own = line.replace("\\|", "").matches('|').count();
            assert!(own == 0 || cells == 0 || own == cells, "{line}");
            cells = own;
        }
    }

    #[test]
    fn the_command_line_names_what_is_not_usual() {
        let usual = Options::default();
        assert_eq!(words(&usual), "");
        let other = Options { joint: Joint::Symmetry, slip: false, until_rad: 0.05, cycled: false, ..usual };
        assert_eq!(words(&other), " --joint symmetry --full-bond --monotonic --until 0.05");
        assert!(
            method(&other).contains("plane of symmetry, full bond") && !method(&other).contains("bent again")
        );
        assert!(method(&usual).contains("cycles of 0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 6 %"), "{}", method(&usual));
    }
}
