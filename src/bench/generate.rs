//! Time of generation over the number of members, stage by stage: frames of `k` by `k` bays.

use crate::base::tree::Format;
use crate::building::{Building, EXAMPLE, column_id, parse};
use crate::generate::{Derive, Generated, generate};
use crate::library::Store;
use crate::rules::RuleBase;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Frames: bays along x and y, and storeys; 27 to 10,256 members.
pub const FRAMES: [[usize; 2]; 7] = [[1, 3], [2, 5], [3, 7], [5, 8], [9, 8], [13, 8], [20, 8]];
/// Generations of frames of up to this many members over which times are medians.
const REPEATED: usize = 1000;
/// How often.
const TIMES: usize = 5;
/// Stages whose times are those of curves that the library lacks.
pub const CURVES: &str = "curves";

/// Times of one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Bays each way, and storeys.
    pub frame: [usize; 2],
    /// Members.
    pub members: usize,
    /// Bodies and joints of the model.
    pub parts: [usize; 2],
    /// Time of each stage \[s\], in their order.
    pub stages: Vec<(&'static str, f64)>,
}

impl Row {
    /// Time of all stages but the curves that the library lacks \[s\].
    pub fn total_s(&self) -> f64 {
        self.stages.iter().filter(|(name, _)| *name != CURVES).map(|(_, s)| s).sum()
    }
}

/// A frame with beams on all axes whose front columns of the lowest storey are removed.
///
/// # Errors
/// If the text of the example has changed, so that it cannot be made of it.
pub fn frame([bays, storeys]: [usize; 2]) -> Result<Building, String> {
    let axes = |span: f64| -> String {
        let all: Vec<String> = (0..=bays).map(|i| format!("{}", span * i as f64)).collect();
        format!("[{}]", all.join(", "))
    };
    let (before, _) = EXAMPLE.split_once("[[events]]").ok_or("the example has no events")?;
    let mut text = before
        .replacen("x = [0, 6]", &format!("x = {}", axes(6.0)), 1)
        .replacen("y = [0, 5]", &format!("y = {}", axes(5.0)), 1)
        .replacen("[\"3.5 m\", \"3.5 m\", \"3.5 m\"]", &format!("[{}]", vec!["3.5"; storeys].join(", ")), 1)
        .replacen("beams = \"perimeter\"", "beams = \"all\"", 1);
    for x in 0..=bays {
        let id = column_id(1, x, 0);
        let _ = write!(text, "[[events]]\nid = \"{id}\"\nmember = \"{id}\"\ntime = 0\n\n");
    }
    parse(&text, Format::Toml, "frame").map_err(|e| e.to_string())
}

/// Generates frames of up to a number of members; `tell` hears of each.
///
/// # Errors
/// If a frame or its model cannot be made.
pub fn measure(
    most_members: usize,
    rules: &RuleBase,
    store: &mut Store,
    tell: &dyn Fn(usize),
) -> Result<Vec<Row>, String> {
    let mut rows = Vec::new();
    for size in FRAMES {
        let building = frame(size)?;
        let members = building.members.len();
        if members > most_members {
            break;
        }
        tell(members);
        let mut generate =
            || generate(&building, rules, store, Derive::Similar, &|_| {}).map_err(|e| e.to_string());
        let first = generate()?;
        let parts = [first.model.bodies.len(), first.model.bushings.len()];
        let mut all = vec![first];
        for _ in 1..if members > REPEATED { 1 } else { TIMES } {
            all.push(generate()?);
        }
        rows.push(Row { frame: size, members, parts, stages: medians(&all) });
    }
    Ok(rows)
}

fn medians(all: &[Generated]) -> Vec<(&'static str, f64)> {
    let names = || all[0].stages.iter().map(|(name, _)| *name);
    let mut times: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    all.iter().flat_map(|g| &g.stages).for_each(|(name, s)| times.entry(name).or_default().push(*s));
    times.values_mut().for_each(|t| t.sort_by(f64::total_cmp));
    names().map(|name| (name, times[name][times[name].len() / 2])).collect()
}

/// Exponent with which a time grows from one number of members to another.
pub fn exponent(members: [usize; 2], times_s: [f64; 2]) -> f64 {
    libm::log(times_s[1] / times_s[0]) / libm::log(members[1] as f64 / members[0] as f64)
}

/// The table as Markdown: a column a frame, and the exponent between the last and the largest with a tenth of its members.
pub fn markdown(rows: &[Row]) -> String {
    let mut text = String::from(
        "# Time of generation\n\nOutput of `fallwerk bench generate -o docs`: frames with beams on all axes, by their number of members; medians of five generations, one from a thousand members on. \
         The exponent is that of the growth from a tenth of the members to all of them.\n\n| stage [s] |",
    );
    rows.iter().for_each(|r| _ = write!(text, " {} |", r.members));
    text += " exponent |\n|---|";
    text += &"---:|".repeat(rows.len() + 1);
    text += "\n";
    let last = rows.last();
    let base = last.and_then(|last| rows.iter().rev().find(|r| 10 * r.members <= last.members));
    let growth = |value: &dyn Fn(&Row) -> f64| match (base, last) {
        (Some(a), Some(b)) => format!("{:.2}", exponent([a.members, b.members], [value(a), value(b)])),
        _ => "-".to_string(),
    };
    let mut line = |name: &str, value: &dyn Fn(&Row) -> f64| {
        let _ = write!(text, "| {name} |");
        rows.iter().for_each(|r| _ = write!(text, " {:.4} |", value(r)));
        let _ = writeln!(text, " {} |", growth(value));
    };
    let names: Vec<&str> =
        rows.first().map_or(Vec::new(), |r| r.stages.iter().map(|(name, _)| *name).collect());
    for (index, name) in names.iter().enumerate().filter(|(_, name)| **name != CURVES) {
        line(name, &|r| r.stages[index].1);
    }
    line("all of these", &Row::total_s);
    if let Some(index) = names.iter().position(|name| *name == CURVES) {
        line("curves that the library lacks (beside)", &|r| r.stages[index].1);
    }
    text
}
