//! What is known of lines of slabs and of feet and heads of walls before any run.

use super::known::{Joints, Site};
use crate::building::ends::End;
use crate::building::lines::Line;
use crate::building::{Building, MemberKind};
use crate::rules::{Subject, SubjectKind, features};
use std::collections::BTreeMap;

/// Most spans that a strip of slab is followed along its row.
const MOST_SPANS: usize = 64;

/// The lines of a building with what they are looked up by.
pub(super) struct Lines<'a> {
    site: &'a Site<'a>,
    lines: &'a [Line],
    /// Lines by slab, axis and the column that they begin at, or end at.
    from: BTreeMap<(usize, usize, usize), usize>,
    to: BTreeMap<(usize, usize, usize), usize>,
    /// Largest demand ratio of the ends of the beam between two columns; `None` if it is not known.
    beams: BTreeMap<[usize; 2], Option<f64>>,
    /// Whether a column or one below it is taken away, by column.
    gone: BTreeMap<usize, bool>,
}

impl<'a> Lines<'a> {
    pub fn of(site: &'a Site<'a>, lines: &'a [Line], joints: &Joints) -> Self {
        let by = |which: usize| {
            let key = |l: &Line| Some((l.member, l.axis, l.columns?[which]));
            lines.iter().enumerate().filter_map(|(i, l)| Some((key(l)?, i))).collect()
        };
        let at_slab = |line: &Line, column: usize| {
            let centre = site.building.members[column].solid.center();
            site.over_charge([centre[0], centre[1], line.clear.max[2]])
        };
        let columns = lines.iter().flat_map(|l| l.columns.into_iter().flatten().map(move |c| (l, c)));
        let gone = columns.map(|(line, column)| (column, at_slab(line, column))).collect();
        Self { site, lines, from: by(0), to: by(1), beams: beams(site, joints), gone }
    }

    /// What is known of a line, of whose slab or wall this is known.
    pub fn subject(&self, line: &Line, member: &Subject) -> Subject {
        let kind = if line.columns.is_some() { SubjectKind::SlabLine } else { SubjectKind::WallEnd };
        let is_of_kind = |name: &str| features::find(name).is_some_and(|f| f.subjects.contains(&kind));
        let mut subject = Subject { id: line.id.clone(), kind, ..member.clone() };
        subject.features.retain(|name, _| is_of_kind(name));
        let middle = line.clear.center();
        let length_m = if line.columns.is_some() { line.clear_m() } else { 2.0 * line.clear_m() };
        let subject = subject
            .with("line.length", length_m)
            .with("line.slenderness", length_m / line.depth_m)
            .with_known("line.charge_distance", self.site.charge_distance([middle[0], middle[1]]));
        let Some(columns) = line.columns else {
            return subject
                .with("line.position", if line.is_foot() { "bottom" } else { "top" })
                .with("line.clamped", line.is_foot() && self.site.is_held(line.member));
        };
        let beam = self.beams.get(&columns);
        subject
            .with("line.has_beam", beam.is_some())
            .with("line.over_charge", columns.iter().any(|c| self.is_gone(*c)))
            .with_known("line.beam_demand_ratio", beam.copied().flatten())
            .with_known("line.demand_ratio", self.demand_ratio(line, columns))
    }

    fn is_gone(&self, column: usize) -> bool {
        self.gone.get(&column) == Some(&true)
    }

    /// Moment of the slab's weight on its stretch between columns that stand over its plastic moment `σ_y t² / 4`, both of a unit of width; `None` if no column of its row stands.
    fn demand_ratio(&self, line: &Line, columns: [usize; 2]) -> Option<f64> {
        let building = self.site.building;
        let member = &building.members[line.member];
        let law = building.law_of(member);
        let yields_pa = building.strength_factor(&member.id) * law.hardening.first()?.stress_pa;
        let per_area = law.density_kg_m3 * building.settings.gravity_m_s2 * line.depth_m;
        let [low, high] = [0, 1].map(|side| self.beyond(line, columns[side], side));
        let (beyond_m, hangs) = match (low, high) {
            (Some(a), Some(b)) => (a + b, false),
            (Some(a), None) => (a + self.edge_m(line, 1), true),
            (None, Some(b)) => (b + self.edge_m(line, 0), true),
            (None, None) => return None,
        };
        // a cantilever bears w l² / 2, as a span of twice its length does
        let span_m = (line.clear_m() + beyond_m) * if hangs { 2.0 } else { 1.0 };
        Some(per_area * span_m.powi(2) / 8.0 / (0.25 * yields_pa * line.depth_m.powi(2)))
    }

    /// Length of the row beyond a side of a line up to the next column that stands \[m\]; `None` if none does.
    fn beyond(&self, line: &Line, mut column: usize, side: usize) -> Option<f64> {
        let mut beyond_m = 0.0;
        for _ in 0..MOST_SPANS {
            if !self.is_gone(column) {
                return Some(beyond_m);
            }
            let next = [&self.to, &self.from][side].get(&(line.member, line.axis, column))?;
            let next = &self.lines[*next];
            beyond_m += next.clear_m() + self.site.building.members[column].solid.size()[line.axis];
            column = next.columns?[side];
        }
        None
    }

    /// Length from a side of a line to the edge of its slab \[m\].
    fn edge_m(&self, line: &Line, side: usize) -> f64 {
        let slab = &self.site.building.members[line.member].solid;
        if side == 0 {
            line.clear.min[line.axis] - slab.min[line.axis]
        } else {
            slab.max[line.axis] - line.clear.max[line.axis]
        }
    }
}

/// The beams between two columns, by these, the lower one first, with the largest demand ratio of their ends.
fn beams(site: &Site<'_>, joints: &Joints) -> BTreeMap<[usize; 2], Option<f64>> {
    let building: &Building = site.building;
    let mut starts = BTreeMap::<usize, usize>::new();
    let mut beams = BTreeMap::new();
    for (index, end) in site.ends.iter().enumerate() {
        if building.members[end.member].kind != MemberKind::Beam {
            continue;
        }
        if end.end == End::Lower {
            starts.insert(end.member, index);
            continue;
        }
        let Some(start) = starts.get(&end.member) else { continue };
        let at = |e: usize| joints.columns_at(e).map(|c| site.ends[c].member);
        let ratio = [*start, index].into_iter().filter_map(|e| site.law_ratio(e)).reduce(f64::max);
        for from in at(*start) {
            for to in at(index) {
                beams.insert([from, to], ratio);
            }
        }
    }
    beams
}
