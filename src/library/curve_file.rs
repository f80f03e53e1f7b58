//! A curve as a table in text: rotation and moment, or displacement and force, with units in the header.
//!
//! ```text
//! axial force [kN], rotation [mrad], moment [kN m]
//! 0, 0, 0
//! 0, 4, 98
//! ```
//!
//! Cells are separated by commas, semicolons or tabs; lines that begin with `#` are remarks. A column `axial force` gives the level
//! of each row, a column `axis` (1 or 2) the bending axis; both may be absent.

use crate::base::diagnostic::{Diagnostic, closest, quoted};
use crate::base::source::{Source, Span};
use crate::base::units::Dimension;

/// Most rows of a file.
pub const MOST_ROWS: usize = 200_000;

/// A curve at one axial force.
#[derive(Debug, Clone, PartialEq)]
pub struct FileLevel {
    /// Bending axis, 1 or 2.
    pub axis: u8,
    /// Axial force \[N\], if the file has a column of it.
    pub axial_force_n: Option<f64>,
    /// `[rad, N m]` or `[m, N]`, abscissae increasing.
    pub points: Vec<[f64; 2]>,
    /// Places of the rows of the points.
    pub rows: Vec<Span>,
    /// Place of its first row.
    pub span: Span,
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveFile {
    /// Moment over rotation; else force over displacement.
    pub is_bending: bool,
    /// Levels by axis and axial force.
    pub levels: Vec<FileLevel>,
}

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    Rotation,
    Moment,
    Displacement,
    Force,
    AxialForce,
    Axis,
}

const NAMES: [(&str, Column); 7] = [
    ("rotation", Column::Rotation),
    ("drift", Column::Rotation),
    ("moment", Column::Moment),
    ("displacement", Column::Displacement),
    ("force", Column::Force),
    ("axial force", Column::AxialForce),
    ("axis", Column::Axis),
];

const MOMENT_UNITS: [(&str, f64); 6] =
    [("N m", 1.0), ("Nm", 1.0), ("kN m", 1e3), ("kNm", 1e3), ("MN m", 1e6), ("MNm", 1e6)];

impl Column {
    fn name(self) -> &'static str {
        NAMES.iter().find(|(_, column)| *column == self).map_or("", |(name, _)| name)
    }

    /// Its units and their value in SI.
    fn units(self) -> Vec<(&'static str, f64)> {
        let of = |dimension: Dimension| dimension.units().map(|u| (u.symbol, u.factor)).collect::<Vec<_>>();
        match self {
            Self::Rotation => of(Dimension::Angle).into_iter().chain([("%", 0.01), ("1", 1.0)]).collect(),
            Self::Moment => MOMENT_UNITS.to_vec(),
            Self::Displacement => of(Dimension::Length),
            Self::Force | Self::AxialForce => of(Dimension::Force),
            Self::Axis => Vec::new(),
        }
    }
}

/// A cell and its place.
#[derive(Clone, Copy)]
struct Cell<'a> {
    text: &'a str,
    span: Span,
}

/// Reads a curve.
///
/// # Errors
/// All errors at once, each with its place.
pub fn read(source: &Source) -> Result<CurveFile, Vec<Diagnostic>> {
    let mut lines = lines(&source.text);
    let Some((header, header_span)) = lines.next() else {
        return Err(vec![Diagnostic::error("empty", "the file has no rows").help(HEADER_HELP)]);
    };
    let separator = [';', '\t', ','].into_iter().find(|s| header.contains(*s)).unwrap_or(',');
    let mut errors = Vec::new();
    let columns = columns(&cells(header, header_span.start, separator), header_span, &mut errors);
    let rows: Vec<_> = lines.take(MOST_ROWS + 1).collect();
    if rows.len() > MOST_ROWS {
        errors.push(Diagnostic::error("too-long", format!("the file has more than {MOST_ROWS} rows")));
    }
    let Some(columns) = columns else { return Err(errors) };
    let mut levels: Vec<FileLevel> = Vec::new();
    for (row, span) in rows {
        let cells = cells(row, span.start, separator);
        if let Some(values) = values(&cells, span, &columns, separator, &mut errors) {
            place(values, span, &columns, &mut levels, &mut errors);
        }
    }
    if levels.is_empty() && errors.is_empty() {
        errors.push(Diagnostic::error("empty", "there is no row below the header").at(header_span, ""));
    }
    for level in levels.iter().filter(|l| l.points.len() < 2) {
        let error =
            Diagnostic::error("too-short", "a curve of a single point").at(level.span, "alone of its level");
        errors.push(error.help("a curve needs two points at least, from the origin to its end"));
    }
    levels.sort_by(|a, b| {
        a.axis.cmp(&b.axis).then(a.axial_force_n.unwrap_or(0.0).total_cmp(&b.axial_force_n.unwrap_or(0.0)))
    });
    let is_bending = columns.iter().any(|(column, _)| *column == Column::Rotation);
    if errors.is_empty() { Ok(CurveFile { is_bending, levels }) } else { Err(errors) }
}

const HEADER_HELP: &str = "begin with a header such as `rotation [mrad], moment [kN m], axial force [kN]`";

/// The lines that are neither empty nor remarks, with their places.
fn lines(text: &str) -> impl Iterator<Item = (&str, Span)> {
    let mut start = 0;
    text.split_inclusive('\n').filter_map(move |line| {
        let own = line.trim_end();
        let span = Span { start, end: start + own.len() };
        start += line.len();
        let told = own.trim_start_matches('\u{feff}').trim_start();
        (!told.is_empty() && !told.starts_with('#')).then_some((own, span))
    })
}

fn cells(line: &str, start: usize, separator: char) -> Vec<Cell<'_>> {
    let mut at = start;
    line.split(separator)
        .map(|piece| {
            let lead = piece.len() - piece.trim_start().len();
            let text = piece.trim();
            let span = Span { start: at + lead, end: at + lead + text.len() };
            at += piece.len() + separator.len_utf8();
            Cell { text: text.trim_start_matches('\u{feff}'), span }
        })
        .collect()
}

/// The columns of the header with the value of their unit in SI.
fn columns(cells: &[Cell], header: Span, errors: &mut Vec<Diagnostic>) -> Option<Vec<(Column, f64)>> {
    let before = errors.len();
    let mut columns: Vec<(Column, f64)> = Vec::new();
    for cell in cells {
        let Some((column, factor)) = column(cell, errors) else { continue };
        if columns.iter().any(|(held, _)| *held == column) {
            let error = Diagnostic::error("duplicate", format!("a second column `{}`", column.name()));
            errors.push(
                error
                    .at(cell.span, "again here")
                    .help("one file holds one curve a level; rows tell levels apart"),
            );
        }
        columns.push((column, factor));
    }
    let has = |column| columns.iter().any(|(held, _)| *held == column);
    let (rotation, displacement) =
        (has(Column::Rotation) && has(Column::Moment), has(Column::Displacement) && has(Column::Force));
    if errors.len() == before && rotation == displacement {
        errors.push(
            Diagnostic::error("missing-column", "the header names no curve")
                .at(header, "`rotation` and `moment`, or `displacement` and `force`")
                .help(HEADER_HELP),
        );
    }
    (errors.len() == before).then_some(columns)
}

fn column(cell: &Cell, errors: &mut Vec<Diagnostic>) -> Option<(Column, f64)> {
    let open = cell.text.find(['[', '(']);
    let (name, unit) = match open {
        Some(at) => (cell.text[..at].trim(), cell.text[at + 1..].trim_end_matches([']', ')']).trim()),
        None => (cell.text, ""),
    };
    let plain = name.to_lowercase().replace('_', " ");
    let Some((_, column)) = NAMES.iter().find(|(known, _)| *known == plain) else {
        let meant = closest(&plain, NAMES.iter().map(|(known, _)| *known));
        let names: Vec<&str> = NAMES.iter().map(|(known, _)| *known).collect();
        let help =
            meant.map_or(format!("the columns are {}", names.join(", ")), |m| format!("did you mean `{m}`?"));
        errors.push(
            Diagnostic::error("unknown-column", format!("unknown column {}", quoted(name)))
                .at(cell.span, "")
                .help(help),
        );
        return None;
    };
    if *column == Column::Axis {
        return Some((*column, 1.0));
    }
    let units = column.units();
    if let Some((_, factor)) = units.iter().find(|(symbol, _)| *symbol == unit) {
        return Some((*column, *factor));
    }
    let symbols: Vec<&str> = units.iter().map(|(symbol, _)| *symbol).collect();
    let error = if unit.is_empty() {
        Diagnostic::error("missing-unit", format!("the column `{}` has no unit", column.name()))
            .at(cell.span, "a unit in brackets is missing")
            .help(format!("write `{} [{}]`; the units are {}", column.name(), symbols[0], symbols.join(", ")))
    } else {
        let meant = closest(unit, symbols.iter().copied()).map(|m| format!("did you mean `{m}`?"));
        Diagnostic::error("wrong-unit", format!("{} is no unit of `{}`", quoted(unit), column.name()))
            .at(cell.span, format!("expected one of {}", symbols.join(", ")))
            .help_if(meant)
    };
    errors.push(error);
    None
}

/// The numbers of a row in SI.
fn values(
    cells: &[Cell],
    row: Span,
    columns: &[(Column, f64)],
    separator: char,
    errors: &mut Vec<Diagnostic>,
) -> Option<Vec<f64>> {
    if cells.len() != columns.len() {
        let message = format!("{} cells in a row of a table with {} columns", cells.len(), columns.len());
        let comma = separator == ',' && cells.len() > columns.len();
        let help = comma.then(|| {
            "is a decimal comma meant? write `0.5`, or separate cells by semicolons and write `0.5` too"
                .to_string()
        });
        errors.push(Diagnostic::error("wrong-row", message).at(row, "").help_if(help));
        return None;
    }
    let mut numbers = Vec::with_capacity(cells.len());
    for (cell, (column, factor)) in cells.iter().zip(columns) {
        match cell.text.parse::<f64>() {
            Ok(number) if number.is_finite() => numbers.push(number * factor),
            _ => {
                let help = match cell.text.replace(',', ".") {
                    point if point.parse::<f64>().is_ok_and(f64::is_finite) => {
                        Some(format!("the decimal separator is a point: `{point}`"))
                    }
                    // written by programs where nothing was measured
                    text if text.parse::<f64>().is_ok() => {
                        Some("leave out rows in which a value is missing".to_string())
                    }
                    _ => None,
                };
                let message = format!("{} is no number for `{}`", quoted(cell.text), column.name());
                errors.push(Diagnostic::error("not-a-number", message).at(cell.span, "").help_if(help));
            }
        }
    }
    (numbers.len() == cells.len()).then_some(numbers)
}

/// Puts a row into the level that it belongs to.
fn place(
    values: Vec<f64>,
    row: Span,
    columns: &[(Column, f64)],
    levels: &mut Vec<FileLevel>,
    errors: &mut Vec<Diagnostic>,
) {
    let get = |wanted: Column| columns.iter().position(|(c, _)| *c == wanted).map(|i| values[i]);
    let axis = get(Column::Axis).unwrap_or(1.0);
    if axis != 1.0 && axis != 2.0 {
        errors.push(Diagnostic::error("wrong-axis", format!("axis {axis}")).at(row, "1 or 2"));
        return;
    }
    let (Some(x), Some(y)) =
        (get(Column::Rotation).or(get(Column::Displacement)), get(Column::Moment).or(get(Column::Force)))
    else {
        return;
    };
    let (axis, force) = (axis as u8, get(Column::AxialForce));
    let bending = get(Column::Rotation).is_some();
    let Some(level) = levels.iter_mut().find(|l| l.axis == axis && l.axial_force_n == force) else {
        if bending && x < 0.0 {
            errors.push(
                Diagnostic::error("negative", "a curve begins at a negative rotation")
                    .at(row, "")
                    .help("give the half with positive rotations; resistance counts the same in both senses"),
            );
        }
        levels.push(FileLevel {
            axis,
            axial_force_n: force,
            points: vec![[x, y]],
            rows: vec![row],
            span: row,
        });
        return;
    };
    let last = level.points.last().map_or(f64::NEG_INFINITY, |p| p[0]);
    if x <= last {
        let name = if bending { "rotation" } else { "displacement" };
        errors.push(
            Diagnostic::error("not-increasing", format!("the {name} goes back, from {last} to {x} (SI)"))
                .at(row, format!("{name}s of one axial force must increase"))
                .help("of a cyclic test give the envelope (backbone); of a second level give its axial force in a column"),
        );
        return;
    }
    level.points.push([x, y]);
    level.rows.push(row);
}
