//! What is known of lines of slabs and of bases and tops of walls before any run.

use super::known::{Joints, Site};
use crate::base::geom::Aabb;
use crate::building::ends::End;
use crate::building::lines::Line;
use crate::building::rows::MEETS_M;
use crate::building::{Building, MemberKind};
use crate::rules::{Subject, SubjectKind, features};
use std::collections::{BTreeMap, BTreeSet};

/// Most spans that a strip of slab is followed along its row.
const MOST_SPANS: usize = 64;

/// The lines of a building with what they are looked up by.
pub(super) struct Lines<'a> {
    site: &'a Site<'a>,
    lines: &'a [Line],
    /// Lines by the place that they begin at, and that they end at.
    at: [BTreeMap<Key, usize>; 2],
    beams: BTreeMap<[usize; 2], Vec<BeamBetween>>,
}

/// Level of a floor \[mm\], direction, and the column that gives a place its name.
type Key = (i64, usize, usize);

/// A beam between two columns with the largest demand ratio of its ends, if it is known.
type BeamBetween = (usize, Option<f64>);

impl<'a> Lines<'a> {
    pub fn of(site: &'a Site<'a>, lines: &'a [Line], joints: &Joints) -> Self {
        let at = [0, 1].map(|side| {
            let places = lines.iter().enumerate().filter_map(|(i, l)| Some((key(l, side)?, i)));
            places.collect()
        });
        Self { site, lines, at, beams: beams(site, joints) }
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
        let Some(places) = &line.columns else {
            return subject
                .with("line.position", if line.is_foot() { "bottom" } else { "top" })
                .with("line.clamped", line.is_foot() && self.site.is_held(line.member))
                .with_known("line.demand_ratio", self.site.law_ratio_of(&line.id));
        };
        let beams: Vec<Option<f64>> = self.beams_in(line, places).collect();
        subject
            .with("line.has_beam", !beams.is_empty())
            .with("line.over_charge", places.iter().any(|place| self.is_gone(line, place)))
            .with_known("line.beam_demand_ratio", beams.into_iter().flatten().reduce(f64::max))
            .with_known("line.demand_ratio", self.demand_ratio(line))
    }

    /// Demand ratios of the beams that run along a line, from any of the columns in one place to any in the other.
    fn beams_in<'b>(
        &'b self,
        line: &'b Line,
        places: &'b [Vec<usize>; 2],
    ) -> impl Iterator<Item = Option<f64>> + 'b {
        let pairs = places[0].iter().flat_map(|from| places[1].iter().map(move |to| [*from, *to]));
        let seen = pairs.filter_map(|pair| self.beams.get(&pair)).flatten();
        let carries = |beam: usize| {
            let solid = &self.site.building.members[beam].solid;
            solid.max[2] > line.clear.min[2] - MEETS_M && solid.min[2] < line.clear.max[2] + MEETS_M
        };
        seen.filter(move |(beam, _)| carries(*beam)).map(|(_, ratio)| *ratio)
    }

    /// Whether all columns that carried a floor in a place, or some below them, are taken away.
    fn is_gone(&self, line: &Line, place: &[usize]) -> bool {
        let members = &self.site.building.members;
        let level_m = line.clear.max[2];
        let mut below =
            place.iter().map(|c| members[*c].solid).filter(|c| c.min[2] < line.clear.min[2]).peekable();
        let taken = |c: Aabb| self.site.over_charge([c.center()[0], c.center()[1], level_m]);
        below.peek().is_some() && below.all(taken)
    }

    /// Moment of the slab's weight on its stretch between columns that stand over its plastic moment `σ_y t² / 4`, both of a unit of width; `None` if no column of its row stands.
    fn demand_ratio(&self, line: &Line) -> Option<f64> {
        let building = self.site.building;
        let member = &building.members[line.member];
        let law = building.law_of(member);
        let yields_pa = building.strength_factor(&member.id) * law.hardening.first()?.stress_pa;
        let per_area = law.density_kg_m3 * building.settings.gravity_m_s2 * line.depth_m;
        let (beyond_m, hangs) = match [0, 1].map(|side| self.beyond(line, side)) {
            [(a, true), (b, true)] => (a + b, false),
            [(a, low), (b, high)] if low || high => (a + b, true),
            _ => return None,
        };
        // a cantilever bears w l² / 2, as a span of twice its length does
        let span_m = (line.clear_m() + beyond_m) * if hangs { 2.0 } else { 1.0 };
        Some(per_area * span_m.powi(2) / 8.0 / (0.25 * yields_pa * line.depth_m.powi(2)))
    }

    /// Length of the row beyond a side of a line up to the next columns that stand, or else to the edge of the floor \[m\], and whether any stand.
    fn beyond(&self, line: &Line, side: usize) -> (f64, bool) {
        let (mut line, mut beyond_m) = (line, 0.0);
        for _ in 0..MOST_SPANS {
            let Some(place) = line.columns.as_ref().map(|places| &places[side]) else { break };
            if !self.is_gone(line, place) {
                return (beyond_m, true);
            }
            let next = key(line, side).and_then(|key| self.at[1 - side].get(&key));
            let Some(next) = next.map(|i| &self.lines[*i]) else { break };
            let between_m = (next.clear.min[line.axis] - line.clear.max[line.axis])
                .max(line.clear.min[line.axis] - next.clear.max[line.axis]);
            beyond_m += next.clear_m() + between_m;
            line = next;
        }
        (beyond_m + self.edge_m(line, side), false)
    }

    /// Length from a side of a line to the edge of its slab \[m\].
    fn edge_m(&self, line: &Line, side: usize) -> f64 {
        let slab = &self.site.building.members[line.member].solid;
        let edge_m = if side == 0 {
            line.clear.min[line.axis] - slab.min[line.axis]
        } else {
            slab.max[line.axis] - line.clear.max[line.axis]
        };
        edge_m.max(0.0)
    }
}

/// What the place on a side of a line of a slab is looked up by.
fn key(line: &Line, side: usize) -> Option<Key> {
    let place = &line.columns.as_ref()?[side];
    Some(((1e3 * line.clear.max[2]).round() as i64, line.axis, place[0]))
}

/// The beams between two columns, the one with the smaller coordinate first.
fn beams(site: &Site<'_>, joints: &Joints) -> BTreeMap<[usize; 2], Vec<BeamBetween>> {
    let building: &Building = site.building;
    let mut starts = BTreeMap::<usize, usize>::new();
    let mut beams = BTreeMap::<[usize; 2], Vec<BeamBetween>>::new();
    for (index, end) in site.ends.iter().enumerate() {
        if building.members[end.member].kind != MemberKind::Beam {
            continue;
        }
        if end.end == End::Lower {
            starts.insert(end.member, index);
            continue;
        }
        let Some(start) = starts.get(&end.member) else { continue };
        let columns =
            |e: usize| -> BTreeSet<usize> { joints.columns_at(e).map(|c| site.ends[c].member).collect() };
        let ratio = [*start, index].into_iter().filter_map(|e| site.law_ratio(e)).reduce(f64::max);
        for from in columns(*start) {
            for to in columns(index) {
                beams.entry([from, to]).or_default().push((end.member, ratio));
            }
        }
    }
    beams
}
