//! The cyclic side of `fallwerk rc`: which path is driven, and the files and the table of what came of it.

use super::Failure;
use super::library_find::quantity;
use crate::base::units::Dimension;
use crate::rc::drive;
use crate::rc::hysteresis::{Cycle, lateral_n};
use crate::rc::series::{Case, Series};
use crate::report::figure::{Line, Panel};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Axial share of cyclic bends if the command line gives none.
pub const AXIAL_SHARES: [f64; 1] = [0.1];
/// Smallest and largest drift \[rad\].
const DRIFT_RAD: [f64; 2] = [2e-4, 0.2];
/// Most turning points of a path.
const MOST_TURNS: usize = 2000;

/// The path of the rotation.
#[derive(Debug, Clone, clap::Args)]
pub struct Loading {
    /// Bend to and fro: drift amplitudes such as "0.5% 1% 1.5% 2%" (mrad and rad too)
    #[arg(long, value_name = "DRIFTS", num_args = 1.., conflicts_with = "until")]
    cycles: Vec<String>,
    /// Cycles of each amplitude
    #[arg(long, value_name = "N", default_value_t = 2, requires = "cycles", value_parser = clap::value_parser!(u16).range(1..=100))]
    repeat: u16,
    /// Bend along a record of drifts: a file with one number a line, in rad, or in the unit of a header such as `drift [%]`
    #[arg(long, value_name = "FILE", conflicts_with_all = ["cycles", "until"])]
    history: Option<PathBuf>,
    /// Bend monotonically too, and fit the rule of degradation of a resistance curve to both
    #[arg(long)]
    pub fit_rule: bool,
}

impl Loading {
    /// Whether the command line says anything of cycles.
    pub fn is_given(&self) -> bool {
        self.fit_rule || !self.cycles.is_empty() || self.history.is_some()
    }

    /// Whether a rule is to be fitted; that needs cycles.
    pub fn wants_rule(&self) -> Result<bool, Failure> {
        if self.fit_rule && self.cycles.is_empty() && self.history.is_none() {
            return Err(Failure::input("--fit-rule needs cycles; add --cycles or --history".into()));
        }
        Ok(self.fit_rule)
    }

    /// Turning points of the path \[rad\]; none: a monotonic push.
    pub fn turns_rad(&self) -> Result<Vec<f64>, Failure> {
        let turns = match &self.history {
            Some(file) => record(file)?,
            None if self.cycles.is_empty() => return Ok(Vec::new()),
            None => drive::cycles(&amplitudes(&self.cycles)?, usize::from(self.repeat)),
        };
        if turns.len() > MOST_TURNS {
            return Err(Failure::input(format!(
                "the path has {} turning points, more than {MOST_TURNS}; leave some cycles out",
                turns.len()
            )));
        }
        Ok(turns)
    }
}

fn amplitudes(texts: &[String]) -> Result<Vec<f64>, Failure> {
    let words = texts.iter().flat_map(|t| t.split([' ', ',', ';'])).filter(|w| !w.is_empty());
    let one = |word: &str| {
        let value = quantity(word, Dimension::Number).or_else(|_| quantity(word, Dimension::Angle));
        let wrong = || {
            let [least, most] = DRIFT_RAD.map(|d| 100.0 * d);
            Failure::input(format!(
                "--cycles: `{word}` is no drift of {least} % to {most} %; write such as `1.5%` or `15mrad`"
            ))
        };
        value.ok().filter(|v| (DRIFT_RAD[0]..=DRIFT_RAD[1]).contains(v)).ok_or_else(wrong)
    };
    let drifts: Vec<f64> = words.map(one).collect::<Result<_, _>>()?;
    if drifts.is_empty() {
        return Err(Failure::input("--cycles: no drift is given; write such as `1.5%` or `15mrad`".into()));
    }
    Ok(drifts)
}

/// Reads a record of drifts.
fn record(file: &Path) -> Result<Vec<f64>, Failure> {
    let place = file.display();
    let text =
        std::fs::read_to_string(file).map_err(|e| Failure::input(format!("{place} cannot be read: {e}")))?;
    let lines = text.lines().enumerate().map(|(i, l)| (i + 1, l.trim()));
    let mut lines = lines.filter(|(_, l)| !l.is_empty() && !l.starts_with('#')).peekable();
    let mut factor = 1.0;
    if let Some((line, header)) = lines.next_if(|(_, l)| l.parse::<f64>().is_err()) {
        let unit =
            header.split_once('[').and_then(|(_, rest)| rest.split_once(']')).map(|(unit, _)| unit.trim());
        factor = match unit {
            Some("%") => 0.01,
            Some("mrad") => 1e-3,
            Some("rad" | "1") => 1.0,
            _ => {
                return Err(Failure::input(format!(
                    "{place}:{line}: `{header}` is neither a number nor a header with a unit; write such as `drift [%]`, with %, mrad or rad"
                )));
            }
        };
    }
    let mut drifts = Vec::new();
    for (line, text) in lines {
        let value = text.parse::<f64>().ok().map(|v| factor * v);
        let value = value.filter(|v| v.abs() <= DRIFT_RAD[1]).ok_or_else(|| {
            Failure::input(format!(
                "{place}:{line}: `{text}` is no drift within {} %; write one number a line",
                100.0 * DRIFT_RAD[1]
            ))
        })?;
        drifts.push(value);
    }
    let turns = drive::turning_points(&drifts, DRIFT_RAD[0]);
    if turns.is_empty() {
        return Err(Failure::input(format!("{place} has no drift beyond {} %", 100.0 * DRIFT_RAD[0])));
    }
    Ok(turns)
}

/// All points of all cases.
pub fn history_csv(series: &Series) -> String {
    let mut text = String::from(
        "axial force [kN],direction [deg],rotation [rad],moment [kN m],lateral force [kN],shortening [mm]\n",
    );
    for case in &series.cases {
        for [rotation, moment, shortening] in case.bent.iter().flat_map(|b| &b.points) {
            let lateral = lateral_n(*rotation, *moment, case.axial_n, series.length_m);
            let _ = writeln!(
                text,
                "{:.3},{},{rotation:.6e},{:.6e},{:.6e},{:.6e}",
                case.axial_n / 1e3,
                case.direction_deg,
                moment / 1e3,
                lateral / 1e3,
                shortening * 1e3
            );
        }
    }
    text
}

fn cells(values: &[Option<f64>]) -> String {
    let cell = |v: &Option<f64>| v.map_or(String::new(), |v| format!("{v:.6e}"));
    values.iter().map(cell).collect::<Vec<_>>().join(",")
}

/// One row a cycle.
pub fn cycles_csv(series: &Series) -> String {
    let mut text = String::from(
        "axial force [kN],direction [deg],cycle,drift + [rad],drift - [rad],peak moment + [kN m],peak moment - [kN m],energy [J],\
         work of axial force [J],secant stiffness [kN m/rad],unloading stiffness + [kN m/rad],unloading stiffness - [kN m/rad],damping ratio\n",
    );
    for case in &series.cases {
        for (i, c) in case.hysteresis.iter().flat_map(|h| &h.cycles).enumerate() {
            let values = [
                Some(c.amplitude_rad[0]),
                Some(c.amplitude_rad[1]),
                Some(c.peak_nm[0] / 1e3),
                Some(c.peak_nm[1] / 1e3),
                Some(c.energy_j),
                Some(c.axial_work_j),
                Some(c.secant_nm_rad / 1e3),
                c.unloading_nm_rad[0].map(|k| k / 1e3),
                c.unloading_nm_rad[1].map(|k| k / 1e3),
                Some(c.damping_ratio),
            ];
            let _ = writeln!(
                text,
                "{:.3},{},{},{}",
                case.axial_n / 1e3,
                case.direction_deg,
                i + 1,
                cells(&values)
            );
        }
    }
    text
}

/// Envelopes of both senses.
pub fn envelope_csv(series: &Series) -> String {
    let mut text =
        String::from("axial force [kN],direction [deg],sense,rotation [rad],moment [kN m],shortening [mm]\n");
    for case in &series.cases {
        let Some(h) = &case.hysteresis else { continue };
        for (sense, points) in ["+", "-"].iter().zip(&h.envelopes) {
            for p in points {
                let values = [Some(p[0]), Some(p[1] / 1e3), Some(p[2] * 1e3)];
                let _ = writeln!(
                    text,
                    "{:.3},{},{sense},{}",
                    case.axial_n / 1e3,
                    case.direction_deg,
                    cells(&values)
                );
            }
        }
    }
    text
}

/// Loops of moment and of lateral force, energy of the cycles and shortening, for each case.
pub fn panels(series: &Series) -> Vec<Panel> {
    let line = |label: &str, points: Vec<[f64; 2]>, is_reference: bool| Line {
        label: label.into(),
        points,
        is_reference,
    };
    let owned = |name: &str, unit: &str| (name.to_string(), unit.to_string());
    let mut panels = Vec::new();
    for case in &series.cases {
        let (Ok(bent), Some(h)) = (&case.bent, &case.hysteresis) else { continue };
        let of = format!("n = {}, direction {}°: ", case.axial_share, case.direction_deg);
        let moments = bent.points.iter().map(|p| [100.0 * p[0], p[1] / 1e3]).collect();
        let mut envelope: Vec<[f64; 2]> =
            h.envelopes[1].iter().rev().map(|p| [100.0 * p[0], p[1] / 1e3]).collect();
        envelope.extend(h.envelopes[0].iter().map(|p| [100.0 * p[0], p[1] / 1e3]));
        panels.push(Panel {
            title: format!("{of}moment over drift"),
            x: owned("drift", "%"),
            y: owned("moment", "kN m"),
            lines: vec![line("history", moments, false), line("envelope", envelope, true)],
            ..Panel::default()
        });
        let lateral =
            |p: &[f64; 3]| [100.0 * p[0], lateral_n(p[0], p[1], case.axial_n, series.length_m) / 1e3];
        panels.push(Panel {
            title: format!("{of}lateral force over drift"),
            x: owned("drift", "%"),
            y: owned("lateral force", "kN"),
            lines: vec![line("history", bent.points.iter().map(lateral).collect(), false)],
            ..Panel::default()
        });
        let numbered = |of: &dyn Fn(&Cycle) -> f64| {
            h.cycles.iter().enumerate().map(|(i, c)| [(i + 1) as f64, of(c)]).collect::<Vec<_>>()
        };
        panels.push(Panel {
            title: format!("{of}energy of each cycle"),
            x: owned("cycle", ""),
            y: owned("energy", "kJ"),
            counts: true,
            lines: vec![
                line("moment over rotation", numbered(&|c| c.energy_j / 1e3), false),
                line("axial force over shortening", numbered(&|c| c.axial_work_j / 1e3), false),
            ],
        });
        panels.push(Panel {
            title: format!("{of}shortening over drift"),
            x: owned("drift", "%"),
            y: owned("shortening", "mm"),
            lines: vec![line(
                "history",
                bent.points.iter().map(|p| [100.0 * p[0], 1e3 * p[2]]).collect(),
                false,
            )],
            ..Panel::default()
        });
    }
    panels
}

/// The cycles of a case in words, one a line.
pub fn table(case: &Case) -> String {
    let (Ok(bent), Some(h)) = (&case.bent, &case.hysteresis) else { return String::new() };
    let mut text =
        format!("\nn = {}, direction {:.0}: {}\n", case.axial_share, case.direction_deg, bent.ending);
    text += "  cycle  drift +  drift -  peak +  peak -    energy    axial    secant  unload +  unload -  damping\n";
    text += "               %        %    kN m    kN m         J        J  MN m/rad  MN m/rad  MN m/rad         \n";
    let optional = |k: Option<f64>| k.map_or("-".to_string(), |k| format!("{:.2}", k / 1e6));
    for (i, c) in h.cycles.iter().enumerate() {
        let _ = writeln!(
            text,
            "  {:5} {:8.2} {:8.2} {:7.1} {:7.1} {:9.0} {:8.0} {:9.2} {:>9} {:>9} {:8.3}",
            i + 1,
            100.0 * c.amplitude_rad[0],
            100.0 * c.amplitude_rad[1],
            c.peak_nm[0] / 1e3,
            c.peak_nm[1] / 1e3,
            c.energy_j,
            c.axial_work_j,
            c.secant_nm_rad / 1e6,
            optional(c.unloading_nm_rad[0]),
            optional(c.unloading_nm_rad[1]),
            c.damping_ratio
        );
    }
    text += &rule(case);
    text
}

/// The rule of degradation in words.
fn rule(case: &Case) -> String {
    match &case.curve {
        None => String::new(),
        Some(Err(reason)) => format!("  no rule of degradation: {reason}\n"),
        Some(Ok(curve)) => curve.cyclic.map_or(String::new(), |rule| {
            let fit = rule.fit.map_or(String::new(), |f| {
                format!(
                    "; residuals: strength {:.3} (lowest {:.2}), unloading {:.2}",
                    f.strength_residual, f.lowest_strength, f.unloading_residual
                )
            });
            format!(
                "  degradation: reference energy {:.2} rad M_peak, unloading stiffness falls with (drift / {:.2} %)^-{:.2}{fit}\n",
                rule.strength_reference_rad,
                100.0 * rule.yield_rotation_rad,
                rule.unloading_exponent
            )
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amplitudes_are_drifts_or_angles_in_range() {
        let found = amplitudes(&["0.5% 1%".into(), "15mrad,0.02".into()]).unwrap();
        assert_eq!(found, [0.005, 0.01, 0.015, 0.02]);
        for wrong in ["0.001%", "50%", "1 mm", "x", "", " , "] {
            let error = amplitudes(&[wrong.into()]).unwrap_err();
            assert!(error.message.contains("write such as"), "{}", error.message);
        }
    }

    #[test]
    fn records_have_a_unit_and_errors_a_place() {
        let room = tempfile::tempdir().unwrap();
        let file = room.path().join("drifts.csv");
        let turns = |text: &str| {
            std::fs::write(&file, text).unwrap();
            record(&file)
        };
        assert_eq!(turns("# test\ndrift [%]\n0\n0.5\n1\n-1\n0\n").unwrap(), [0.01, -0.01, 0.0]);
        assert_eq!(turns("0.01\n-0.01\n").unwrap(), [0.01, -0.01]);
        let says = |text: &str| turns(text).unwrap_err().message;
        assert!(says("drift\n1\n").contains(":1:"));
        assert!(says("drift [%]\n1\nx\n").contains(":3:"));
        assert!(says("drift [%]\n1\n60\n").contains("20 %"));
        assert!(says("drift [%]\n0\n").contains("no drift"));
    }
}
