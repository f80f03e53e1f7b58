//! Which lines of slabs the cuts between the pieces of a floor are on, and whether these yield; decisions of the analyst about lines.

use super::GenerateError;
use super::crossing::Cut;
use super::decide::Decision;
use crate::building::lines::Line;
use crate::mbs::model::Bushing;
use std::collections::BTreeMap;

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

    /// Enters the lines that a cut through a floor of some members is on; it yields unless all of them stay elastic.
    pub fn of_cut(&self, members: &[usize], cut: &mut Cut) {
        let slabs = members.iter().filter_map(|m| self.of_slab.get(m)).flatten();
        let on: Vec<&str> = slabs.filter(|line| is_on(line, cut)).map(|line| line.id.as_str()).collect();
        cut.yields = on.is_empty() || on.iter().any(|id| !self.decision.elastic_lines.contains(*id));
        cut.lines = on.into_iter().map(str::to_string).collect();
    }
}

/// Refuses what the analyst has decided about a line at which the model has no joint.
///
/// # Errors
/// Names the first such line.
pub fn obeyed(lines: &[Line], decision: &Decision, joints: &[Bushing]) -> Result<(), GenerateError> {
    let has_joint = |id: &str| joints.iter().any(|j| j.origin.members.iter().any(|m| m == id));
    let mut asked = lines.iter().filter(|line| decision.is_of_analyst(&line.id));
    let Some(line) = asked.find(|line| !has_joint(&line.id)) else { return Ok(()) };
    let why = match line.columns {
        Some(_) => {
            "the floor does not bend there in this model: override it with `merge_elastic`, or leave this out"
        }
        None => "the wall is one body with what is beside it there, or charges take it away: leave this out",
    };
    Err(GenerateError::Override(line.id.clone(), why.to_string()))
}

/// Whether a cut is on a line: across the same span, in its strip.
fn is_on(line: &Line, cut: &Cut) -> bool {
    let (axis, across) = (cut.axis, 1 - cut.axis);
    let clear = &line.clear;
    let inside = |i: usize, at: f64| (clear.min[i] - ON_EDGE_M..=clear.max[i] + ON_EDGE_M).contains(&at);
    line.axis == axis && inside(axis, cut.point_m[axis]) && inside(across, cut.point_m[across])
}
