//! Tables and charts of the page of an MBS run that is compared with nothing.

use super::ReportError;
use super::chart::seconds;
use super::figures::NOISE_M;
use super::input::{HingeSite, History, ReportInput, RunCost};
use super::number::{MISSING, count, duration, fixed, significant};
use super::page::{optional, optional_time};
use super::plots;
use serde::Serialize;

/// What the template shows in place of a comparison.
#[derive(Serialize)]
pub(super) struct Section {
    points: Vec<Point>,
    displacements: Table,
    hinges: Table,
    hinge_words: String,
    cost: Vec<[String; 2]>,
}

/// A table without the columns in which no row has anything.
#[derive(Default, Serialize)]
struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
    /// Which columns are numbers.
    numeric: Vec<usize>,
}

/// A tracked point with its charts.
#[derive(Serialize)]
struct Point {
    name: String,
    charts: [String; 3],
    /// Whether no other moves as far.
    is_farthest: bool,
}

/// All of it.
pub(super) fn section(input: &ReportInput) -> Result<Section, ReportError> {
    Ok(Section {
        points: points(&input.histories)?,
        displacements: displacements(&input.histories),
        hinges: hinges(&input.hinge_sites),
        hinge_words: hinge_words(input),
        cost: input.mbs_run.as_ref().map_or(Vec::new(), cost),
    })
}

impl Table {
    /// Of columns: head, whether they are numbers, and a cell for each row.
    fn of(columns: Vec<(&str, bool, Vec<String>)>) -> Self {
        let told = |(i, column): &(usize, (&str, bool, Vec<String>))| {
            *i == 0 || column.2.iter().any(|cell| cell != MISSING && !cell.is_empty())
        };
        let kept: Vec<_> = columns.into_iter().enumerate().filter(told).map(|(_, column)| column).collect();
        let rows = kept.first().map_or(0, |column| column.2.len());
        Self {
            columns: kept.iter().map(|column| column.0.into()).collect(),
            numeric: (0..kept.len()).filter(|i| kept[*i].1).collect(),
            rows: (0..rows).map(|row| kept.iter().map(|column| column.2[row].clone()).collect()).collect(),
        }
    }
}

fn points(histories: &[History]) -> Result<Vec<Point>, ReportError> {
    let size = |h: &History| h.largest_of_mbs().map_or(0.0, |(u, _)| u);
    let farthest = histories.iter().map(size).fold(0.0, f64::max);
    let mut found = false;
    let mut point = |history: &History| {
        let is_farthest = !found && size(history) >= farthest;
        found |= is_farthest;
        Ok(Point { name: history.point.clone(), charts: plots::history_charts(history)?, is_farthest })
    };
    histories.iter().map(&mut point).collect()
}

/// A displacement \[m\].
fn metres(u: f64) -> String {
    if u.abs() < NOISE_M { fixed(u, 6) } else { significant(u, 3) }
}

fn displacements(histories: &[History]) -> Table {
    let all = |of: &dyn Fn(&History) -> String| histories.iter().map(of).collect::<Vec<String>>();
    let end =
        |axis: usize| all(&move |h: &History| h.mbs_m.last().map_or(MISSING.into(), |u| metres(u[axis])));
    Table::of(vec![
        ("Point", false, all(&|h| h.point.clone())),
        ("max |u| [m]", true, all(&|h| h.largest_of_mbs().map_or(MISSING.into(), |x| metres(x.0)))),
        ("at [s]", true, all(&|h| h.largest_of_mbs().map_or(MISSING.into(), |x| fixed(x.1, 2)))),
        ("u x at the end [m]", true, end(0)),
        ("u y [m]", true, end(1)),
        ("u z [m]", true, end(2)),
    ])
}

fn hinges(sites: &[HingeSite]) -> Table {
    let all = |of: &dyn Fn(&HingeSite) -> String| sites.iter().map(of).collect::<Vec<String>>();
    let yields = |s: &HingeSite| match s.mbs_slight_s {
        Some(t) => format!("{} (slightly)", fixed(t, 3)),
        None => optional_time(s.mbs_yielded_s),
    };
    let remark = |s: &HingeSite| match (s.removed_s, s.mbs_latent, s.mbs_live_s) {
        (Some(t), ..) => format!("taken away by a charge at {}", seconds(t)),
        (None, true, Some(t)) => format!("latent until {}", seconds(t)),
        (None, true, None) => "latent".into(),
        (None, false, _) => String::new(),
    };
    Table::of(vec![
        ("Hinge", false, all(&|s| s.member_end.clone())),
        ("yields [s]", true, all(&yields)),
        ("max plastic rotation [rad]", true, all(&|s| optional(s.mbs_max_plastic_rotation_rad, 3))),
        ("separates [s]", true, all(&|s| optional_time(s.mbs_fractured_s))),
        ("Remark", false, all(&remark)),
    ])
}

/// "27 of 46 hinges yield by more than 0.020 rad, 3 by less; 6 separate."
fn hinge_words(input: &ReportInput) -> String {
    let number = |is: fn(&HingeSite) -> bool| input.hinge_sites.iter().filter(|s| is(s)).count();
    let all = input.hinge_sites.len();
    let yielded = number(|s| s.mbs_yielded_s.is_some());
    let (slight, separated) = (number(|s| s.mbs_slight_s.is_some()), number(|s| s.mbs_fractured_s.is_some()));
    let counted = input.counted_rotation_rad.filter(|_| slight > 0);
    let by = counted
        .map_or(String::new(), |r| format!(" by more than {} rad, {slight} by less", significant(r, 2)));
    let word = if all == 1 { "hinge yields" } else { "hinges yield" };
    format!("{yielded} of {all} {word}{by}; {separated} separate{}.", if separated == 1 { "s" } else { "" })
}

fn cost(run: &RunCost) -> Vec<[String; 2]> {
    let rows = [
        ("CPU time", run.cpu_s.map(duration)),
        ("Wall time", run.wall_s.map(duration)),
        ("Threads", run.threads.map(count)),
        ("Steps", run.steps.map(count)),
        ("Mean step", run.step_s.map(duration)),
        ("Bodies", run.parts.map(count)),
        ("Degrees of freedom", run.dofs.map(count)),
    ];
    rows.into_iter().filter_map(|(label, text)| Some([label.to_string(), text?])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_without_anything_is_left_out() {
        let cells = |texts: [&str; 2]| texts.map(String::from).to_vec();
        let table = Table::of(vec![
            ("Hinge", false, cells(["A", "B"])),
            ("separates [s]", true, cells([MISSING, ""])),
            ("yields [s]", true, cells([MISSING, "1.250"])),
        ]);
        assert_eq!((table.columns.len(), table.numeric), (2, vec![1]));
        assert_eq!(table.rows, [cells(["A", MISSING]), cells(["B", "1.250"])]);
        assert!(Table::of(vec![("Hinge", false, Vec::new())]).rows.is_empty());
    }
}
