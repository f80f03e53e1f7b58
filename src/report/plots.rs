//! Which charts a report has.

use super::ReportError;
use super::chart::{Chart, Mark, Series, Size, seconds};
use super::input::{CurveFamily, ErrorMeasure, FirstContact, History, ReportInput};
use super::number::{axis, fixed, prefixed, significant};

/// Ticks of the axis of errors, as a wide chart has them.
const ERROR_TICKS: usize = 5;

fn time_axis() -> (String, String) {
    ("time".into(), "s".into())
}

pub(super) fn contact_marks(contact: &FirstContact) -> Vec<Mark> {
    let mark = |t: Option<f64>, name: &str, class| {
        t.filter(|t| t.is_finite()).map(|x| Mark {
            x,
            label: format!("{name} contact {}", seconds(x)),
            class,
        })
    };
    [mark(contact.fe_s, "FE", "fe"), mark(contact.mbs_s, "MBS", "mbs")].into_iter().flatten().collect()
}

/// Checks that times are finite and increase, and that a list is as long as they are.
pub(super) fn check(what: &str, time_s: &[f64], lengths: &[usize]) -> Result<(), ReportError> {
    if !time_s.iter().all(|t| t.is_finite()) || time_s.windows(2).any(|w| w[1] <= w[0]) {
        return Err(ReportError::Times { what: what.into() });
    }
    match lengths.iter().find(|&&n| n != time_s.len()) {
        Some(&found) => Err(ReportError::Length { what: what.into(), expected: time_s.len(), found }),
        None => Ok(()),
    }
}

/// The chart of e(T).
pub fn error_chart(input: &ReportInput) -> Result<Option<String>, ReportError> {
    let Some(error) = &input.error else { return Ok(None) };
    let lines = [
        ("MBS against FE", "mbs", &error.e),
        ("MBS without points that become debris", "mbs faint", &error.without_debris),
        ("hybrid against FE", "hybrid", &error.hybrid),
        ("hybrid without points that become debris", "hybrid faint", &error.hybrid_without_debris),
    ];
    let given: Vec<_> = lines.into_iter().enumerate().filter(|(i, l)| *i == 0 || !l.2.is_empty()).collect();
    let lengths: Vec<usize> = given.iter().map(|(_, l)| l.2.len()).collect();
    check("error measure", &error.time_s, &lengths)?;
    let end = error.time_s.last().copied().unwrap_or(0.0);
    let contact = error.contact_s.filter(|t| t.is_finite());
    let mut limits = Vec::new();
    if let Some(limit) = error.limit_until_contact {
        let until = if contact.is_some() { " up to contact" } else { "" };
        let label = format!("limit{until} {}", significant(limit, 2));
        limits.push((0.0, contact.unwrap_or(end), limit, label));
    }
    if let (Some(limit), Some(from)) = (error.limit_until_end, contact) {
        limits.push((from, end, limit, format!("limit up to the end {}", significant(limit, 2))));
    }
    limits.retain(|l| l.2.is_finite());
    // at the first output neither run has moved: there is no error, whatever stands in its place
    let curves: Vec<Vec<[f64; 2]>> =
        given.iter().map(|(_, l)| zip(&error.time_s, l.2, 1.0).into_iter().skip(1).collect()).collect();
    let largest = curves.iter().flatten().map(|p| p[1]).filter(|v| v.is_finite()).fold(0.0, f64::max);
    let frame = axis(0.0, error_top(error, contact.unwrap_or(end), &limits), ERROR_TICKS, false).max;
    // what is a little above the frame is no reason to cut
    let is_cut = largest > 1.1 * frame;
    let cut = if is_cut {
        format!("; larger values at the start, up to {}, are not drawn", significant(largest, 2))
    } else {
        String::new()
    };
    let shown = |points: Vec<[f64; 2]>| if is_cut { below(&points, frame) } else { points };
    let chart = Chart {
        title: format!("Relative displacement error e(T) over all tracked points{cut}"),
        x: ("T".into(), "s".into()),
        y: ("e".into(), "–".into()),
        series: given
            .iter()
            .zip(curves)
            .map(|((_, (label, class, _)), points)| Series {
                label: (*label).into(),
                class: (*class).into(),
                points: shown(points),
            })
            .collect(),
        marks: contact_marks(&input.first_contact),
        limits,
        shade: contact.map(|t| [t, end]),
        y_range: Some([0.0, if is_cut { frame } else { 0.0 }]),
        is_time: true,
        no_legend: given.len() == 1,
        ..Chart::default()
    };
    Ok(Some(chart.to_html()))
}

/// Largest error that is drawn: 1.5 times the largest from half the time to the first contact on, limits included. Before that FE has hardly moved: a
/// relative error says little there, and would flatten all the rest.
fn error_top(error: &ErrorMeasure, contact_s: f64, limits: &[(f64, f64, f64, String)]) -> f64 {
    let late = error.time_s.partition_point(|t| *t < 0.5 * contact_s);
    let curves = [&error.e, &error.without_debris, &error.hybrid, &error.hybrid_without_debris];
    let tops = curves.map(|e| largest_of(e.get(late..).unwrap_or(&[])));
    let limit = limits.iter().map(|l| l.2).fold(0.0, f64::max);
    let top = 1.5 * tops.into_iter().fold(limit, f64::max);
    if top > 0.0 { top } else { f64::INFINITY }
}

/// A line without what lies above a height; it ends where it leaves the frame there.
fn below(points: &[[f64; 2]], height: f64) -> Vec<[f64; 2]> {
    let mut out: Vec<[f64; 2]> = Vec::new();
    for (i, p) in points.iter().enumerate() {
        let before = i.checked_sub(1).map(|i| points[i]);
        let is_above = |p: &[f64; 2]| p[1] > height;
        if let Some(b) = before.filter(|b| is_above(b) != is_above(p) && (b[1] + p[1]).is_finite()) {
            let share = (height - b[1]) / (p[1] - b[1]);
            out.push([b[0] + share * (p[0] - b[0]), height]);
        }
        out.push(if is_above(p) { [p[0], f64::NAN] } else { *p });
    }
    out
}

fn largest_of(values: &[f64]) -> f64 {
    values.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max)
}

fn zip(time_s: &[f64], values: &[f64], factor: f64) -> Vec<[f64; 2]> {
    time_s.iter().zip(values).map(|(&t, &v)| [t, v * factor]).collect()
}

/// The three charts of a tracked point: x, y and z.
pub fn history_charts(history: &History) -> Result<[String; 3], ReportError> {
    let lines = [
        ("FE", "fe", &history.fe_m),
        ("hybrid", "hybrid", &history.hybrid_m),
        ("MBS", "mbs", &history.mbs_m),
    ];
    let given: Vec<_> = lines.into_iter().filter(|l| l.0 == "MBS" || !l.2.is_empty()).collect();
    let lengths: Vec<usize> = given.iter().map(|l| l.2.len()).collect();
    check(&format!("history of {}", history.point), &history.time_s, &lengths)?;
    Ok([0, 1, 2].map(|axis| {
        let line = |label: &str, class: &str, values: &[[f64; 3]]| Series {
            label: label.into(),
            class: class.into(),
            points: history.time_s.iter().zip(values).map(|(&t, u)| [t, u[axis]]).collect(),
        };
        Chart {
            title: ["x", "y", "z (vertical)"][axis].into(),
            x: time_axis(),
            y: (["u x", "u y", "u z"][axis].replace(' ', "\u{2009}"), "m".into()),
            series: given.iter().map(|(label, class, values)| line(label, class, values)).collect(),
            is_time: true,
            size: Size::Third,
            no_legend: true,
            ..Chart::default()
        }
        .to_html()
    }))
}

/// A named list of energies.
type Energies<'a> = [(&'static str, &'a [f64])];

fn energy_chart(
    title: &str,
    time_s: &[f64],
    energies: &Energies,
    (factor, unit): &(f64, String),
    y_range: [f64; 2],
    (mark, size): (Vec<Mark>, Size),
) -> Result<String, ReportError> {
    let lengths: Vec<usize> = energies.iter().map(|e| e.1.len()).filter(|&n| n > 0).collect();
    check(title, time_s, &lengths)?;
    let series = energies
        .iter()
        .enumerate()
        .filter(|(_, e)| !e.1.is_empty())
        .map(|(i, e)| Series { label: e.0.into(), class: format!("s{i}"), points: zip(time_s, e.1, *factor) })
        .collect();
    Ok(Chart {
        title: title.into(),
        x: time_axis(),
        y: ("energy".into(), unit.clone()),
        series,
        marks: mark,
        y_range: Some(y_range.map(|v| v * factor)),
        is_time: true,
        size,
        ..Chart::default()
    }
    .to_html())
}

/// The energy charts of both runs, in one unit and over one range, and what the residual amounts to.
pub struct EnergyCharts {
    /// FE chart.
    pub fe: Option<String>,
    /// MBS chart.
    pub mbs: Option<String>,
    /// Sentences on the residuals.
    pub residuals: Vec<String>,
}

/// The energy charts.
pub fn energy_charts(input: &ReportInput) -> Result<EnergyCharts, ReportError> {
    // The places in these lists are the line styles: kinetic, contact and residual look alike in both.
    let fe = input.fe_energy.as_ref().map(|e| -> [(&str, &[f64]); 7] {
        [
            ("kinetic", &e.kinetic_j),
            ("internal", &e.internal_j),
            ("external work", &e.external_work_j),
            ("contact and friction", &e.contact_j),
            ("hourglass", &e.hourglass_j),
            ("internal, of which eroded", &e.eroded_j),
            ("residual", &e.residual_j),
        ]
    });
    let mbs = input.mbs_energy.as_ref().map(|e| -> [(&str, &[f64]); 7] {
        [
            ("kinetic", &e.kinetic_j),
            ("plastic", &e.plastic_j),
            ("potential", &e.potential_j),
            ("contact and friction", &e.contact_j),
            ("elastic", &e.elastic_j),
            ("", &[]),
            ("residual", &e.residual_j),
        ]
    });
    let all = fe.iter().chain(&mbs).flatten().flat_map(|e| e.1).copied().filter(|v| v.is_finite());
    let (lo, hi) = all.fold((0.0_f64, 0.0_f64), |(lo, hi), v| (lo.min(v), hi.max(v)));
    let scale = prefixed(hi.max(-lo), "J");
    let errors = [
        ("FE", input.fe_energy.as_ref().and_then(|e| e.error)),
        ("MBS", input.mbs_energy.as_ref().and_then(|e| e.error)),
    ];
    let residuals = errors.iter().filter_map(|(name, error)| {
        let percent = significant(100.0 * error.filter(|e| e.is_finite())?, 2);
        let of_checks = if input.mbs_alone { "" } else { ", the energy error of the checks" };
        Some(format!("{name}: the largest residual is {percent} % of the energy turned over{of_checks}."))
    });
    let residuals: Vec<String> = residuals.collect();
    let size = if input.mbs_alone { Size::Wide } else { Size::Half };
    let contact = |t: Option<f64>, class| {
        let x = t.filter(|t| t.is_finite());
        x.map(|x| Mark { x, label: format!("first contact {}", seconds(x)), class }).into_iter().collect()
    };
    let fe = match (&fe, &input.fe_energy) {
        (Some(list), Some(e)) => {
            let mark = contact(input.first_contact.fe_s, "fe");
            Some(energy_chart("FE energies", &e.time_s, list, &scale, [lo, hi], (mark, size))?)
        }
        _ => None,
    };
    let mbs = match (&mbs, &input.mbs_energy) {
        (Some(list), Some(e)) => {
            let mark = contact(input.first_contact.mbs_s, "mbs");
            Some(energy_chart("MBS energies", &e.time_s, list, &scale, [lo, hi], (mark, size))?)
        }
        _ => None,
    };
    Ok(EnergyCharts { fe, mbs, residuals })
}

/// The chart of a curve family: moment over rotation, one line an axial force.
pub fn curve_chart(family: &CurveFamily) -> String {
    let moments = family.levels.iter().flat_map(|l| &l.points).map(|p| p[1].abs());
    let (factor, unit) = prefixed(moments.filter(|m| m.is_finite()).fold(0.0, f64::max), "N m");
    let forces = family.levels.iter().map(|l| l.axial_force_n.abs()).filter(|n| n.is_finite());
    let (force_factor, force_unit) = prefixed(forces.fold(0.0, f64::max), "N");
    let series = family.levels.iter().enumerate().map(|(i, level)| {
        let mut label = format!("N = {} {force_unit}", fixed(level.axial_force_n * force_factor, 1));
        if let Some(fracture) = level.fracture_rotation_rad {
            label.push_str(&format!(", separates at {} rad", significant(fracture, 2)));
        }
        let points = level.points.iter().map(|p| [p[0], p[1] * factor]).collect();
        Series { label, class: level_class(i), points }
    });
    let title = if family.description.is_empty() {
        family.id.clone()
    } else {
        format!("{} – {}", family.id, family.description)
    };
    Chart {
        title,
        x: ("rotation".into(), "rad".into()),
        y: ("moment".into(), unit),
        series: series.collect(),
        size: Size::Half,
        ..Chart::default()
    }
    .to_html()
}

/// Line styles of one colour each.
const STYLES: usize = 7;

/// Style class of the line with a number: after the last style the colours come again, dotted.
fn level_class(i: usize) -> String {
    let again = if i < STYLES { "" } else { " again" };
    format!("s{}{again}", i % STYLES)
}

#[cfg(test)]
mod tests {
    use super::super::input::CurveLevel;
    use super::*;

    #[test]
    fn nine_axial_forces_have_a_style_each() {
        let level = |n: u32| CurveLevel {
            axial_force_n: 1e5 * f64::from(n),
            points: vec![[0.0, 0.0], [0.01, 1e5]],
            fracture_rotation_rad: None,
        };
        let family = CurveFamily { levels: (0..9).map(level).collect(), ..CurveFamily::default() };
        let drawn = curve_chart(&family);
        for class in ["s0", "s6", "s0 again", "s1 again"] {
            assert_eq!(
                drawn.matches(&format!("class=\"line {class}\"")).count(),
                2,
                "{class}: legend and line"
            );
        }
    }

    #[test]
    fn a_line_that_leaves_the_frame_is_cut_at_its_top() {
        let cut = below(&[[0.0, 3.0], [1.0, 1.0], [2.0, 0.5], [3.0, 2.5]], 2.0);
        let kept: Vec<[f64; 2]> = cut.iter().copied().filter(|p| p[1].is_finite()).collect();
        assert_eq!(kept, [[0.5, 2.0], [1.0, 1.0], [2.0, 0.5], [2.75, 2.0]]);
        assert!(cut[0][1].is_nan() && cut.last().unwrap()[1].is_nan());
    }

    fn chart(peak: f64) -> String {
        let e = [0.0, peak, 0.1, 0.1].to_vec();
        let error = ErrorMeasure {
            time_s: vec![0.0, 0.1, 0.2, 0.3],
            e,
            contact_s: Some(0.3),
            limit_until_contact: Some(0.1),
            ..ErrorMeasure::default()
        };
        error_chart(&ReportInput { error: Some(error), ..ReportInput::default() }).unwrap().unwrap()
    }

    /// The first output has no error, and a peak is cut only where it is far above the rest: up to 0.15 the axis has room for it.
    #[test]
    fn the_error_begins_at_the_second_output_and_is_cut_where_it_must() {
        let near = chart(0.15);
        assert!(!near.contains("not drawn") && near.contains("from 0.100 to 0.150"), "{near}");
        assert!(chart(0.16).contains("from 0.100 to 0.160"));
        let far = chart(0.4);
        assert!(far.contains("larger values at the start, up to 0.40, are not drawn"), "{far}");
        let path = far.split("\" d=\"").nth(1).and_then(|d| d.split('"').next()).unwrap();
        assert_eq!(path.matches('M').count(), 1, "no hole: {path}");
    }
}
