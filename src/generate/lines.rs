//! Which lines of slabs the cuts between the pieces of a floor are on, and whether these yield; decisions of the analyst about lines.

use super::GenerateError;
use super::crossing::Cut;
use super::decide::Decision;
use crate::building::lines::Line;
use crate::mbs::model::Bushing;
use std::collections::{BTreeMap, BTreeSet};

/// How far a cut may be off the strip of a line: in a strip between two of them it is on the edge of both \[m\].
const ON_EDGE_M: f64 = 1e-6;

/// The lines of slabs, by slab, with what was decided about them.
pub struct Lines<'a> {
    of_slab: BTreeMap<usize, Vec<&'a Line>>,
    decision: &'a Decision,
}

impl<'a> Lines<'a> {
    pub fn of(lines: &'a [Line], decision: &'a Decision) -> Self {
        let mut of_slab = BTreeMap::<usize, Vec<&Line>>::new();
        for line in lines.iter().filter(|l| l.columns.is_some()) {
            of_slab.entry(line.member).or_default().push(line);
        }
        Self { of_slab, decision }
    }

    /// Enters the lines that a cut through a floor of some members is on, or that are next to it on either side; it yields unless all of them stay elastic.
    pub fn of_cut(&self, members: &[usize], cut: &mut Cut) {
        let slabs = members.iter().filter_map(|m| self.of_slab.get(m)).flatten();
        let beside: Vec<(f64, &Line)> =
            slabs.filter(|line| spans(line, cut)).map(|line| (off_m(line, cut), *line)).collect();
        let mut on: Vec<&str> = beside
            .iter()
            .filter(|(off, _)| off.abs() <= ON_EDGE_M)
            .map(|(_, line)| line.id.as_str())
            .collect();
        if on.is_empty() {
            let nearest = |sign: f64| {
                let own = beside.iter().filter(|(off, _)| sign * off > 0.0);
                own.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).map(|(_, line)| line.id.as_str())
            };
            on.extend([-1.0, 1.0].into_iter().filter_map(nearest));
        }
        cut.yields = on.is_empty() || on.iter().any(|id| !self.decision.elastic_lines.contains(*id));
        cut.lines = on.into_iter().map(str::to_string).collect();
    }
}

/// Looks at what the analyst has decided about lines at which the model has no joint: notes about walls, whose heads a pattern may name as well.
///
/// # Errors
/// Names the first strip of a floor that does not bend.
pub fn obeyed(lines: &[Line], decision: &Decision, joints: &[Bushing]) -> Result<Vec<String>, GenerateError> {
    let with_joint: BTreeSet<&String> = joints.iter().flat_map(|j| &j.origin.members).collect();
    let asked = lines.iter().filter(|line| decision.is_of_analyst(&line.id));
    let (strips, walls): (Vec<&Line>, Vec<&Line>) =
        asked.filter(|line| !with_joint.contains(&line.id)).partition(|line| line.columns.is_some());
    if let Some(strip) = strips.first() {
        let why =
            "the floor does not bend there in this model: it has to (`merge_elastic`), or leave this out";
        return Err(GenerateError::Override(strip.id.clone(), why.to_string()));
    }
    let without = |line: &&Line| {
        format!(
            "the override of {} changes nothing: the wall is one body with what it meets there, or meets nothing",
            line.id
        )
    };
    Ok(walls.iter().map(without).collect())
}

/// Whether a line is passed on as a cut is, and in the span that it is in.
fn spans(line: &Line, cut: &Cut) -> bool {
    let (axis, at_m) = (cut.axis, cut.point_m[cut.axis]);
    line.axis == axis && (line.clear.min[axis]..=line.clear.max[axis]).contains(&at_m)
}

/// How far a cut is beyond the strip of a line, negative below it \[m\].
fn off_m(line: &Line, cut: &Cut) -> f64 {
    let across = 1 - cut.axis;
    let at_m = cut.point_m[across];
    (at_m - line.clear.max[across]).max(0.0) + (at_m - line.clear.min[across]).min(0.0)
}
