//! Columns of which charges take a stretch: what is left of them are stumps.
//!
//! Such a column is divided where stretches begin and end. Its pieces stand on springs of what lies between their middles, which do not yield, until a charge takes the piece on its stretch away with the springs at it.
//! What is left hangs from the floor above or stands on the one below by the hinge at its end of the column. A rest that is shorter than half of the section goes with the stretch: in FE it is less than an element.

use super::bodies::Bodies;
use super::joints::{Prism, axes};
use super::sections::slice;
use crate::building::ends::MemberEnd;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::building::tracked::{SHORTEST_REST, clear_range};
use crate::building::{Building, MemberKind};
use crate::graph::Structure;
use crate::mbs::model::{Bending, Bushing, Face, Origin};

/// A column in pieces, from its lower end on.
#[derive(Debug, Clone, PartialEq)]
pub struct Stumps {
    /// Its number.
    pub member: usize,
    /// Where pieces begin and end \[m\].
    pub edges: Vec<f64>,
    /// The charge that takes each piece, the first of several.
    pub taken: Vec<Option<usize>>,
    /// Rests that are taken with a stretch: where they begin and end \[m\].
    pub lost: Vec<[f64; 2]>,
}

impl Stumps {
    /// Of a column, if a stretch is taken out of it.
    pub fn of(building: &Building, structure: &Structure, member: usize) -> Option<Self> {
        let column = &building.members[member];
        let charges = building.events.iter().enumerate().filter(|(_, c)| c.member == column.id);
        let mut charges: Vec<(usize, Option<[f64; 2]>, f64)> =
            charges.map(|(i, c)| (i, c.stretch_m, c.time_s)).collect();
        if column.kind != MemberKind::Column || charges.iter().all(|(_, stretch, _)| stretch.is_none()) {
            return None;
        }
        charges.sort_by(|a, b| a.2.total_cmp(&b.2).then(a.0.cmp(&b.0)));
        let low = column.solid.min[column.axis];
        let stretches: Vec<(usize, [f64; 2])> = charges
            .into_iter()
            .map(|(i, s, _)| (i, s.map_or([f64::NEG_INFINITY, f64::INFINITY], |s| s.map(|z| low + z))))
            .collect();
        let [from, to] = clear_range(&structure.partition, member, column.axis)?;
        let tolerance = COORDINATE_TOLERANCE_M;
        let mut edges: Vec<f64> = stretches
            .iter()
            .flat_map(|(_, s)| *s)
            .filter(|z| *z > from + tolerance && *z < to - tolerance)
            .collect();
        edges.extend([from, to]);
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|later, earlier| *later - *earlier <= tolerance);
        let takes = |at: f64| stretches.iter().find(|(_, s)| s[0] < at && at < s[1]).map(|(i, _)| *i);
        let taken = edges.windows(2).map(|e| takes(0.5 * (e[0] + e[1]))).collect();
        let mut this = Self { member, edges, taken, lost: Vec::new() };
        let [a, b] = [1, 2].map(|i| column.solid.size()[(column.axis + i) % 3]);
        this.lose(SHORTEST_REST * a.min(b));
        Some(this)
    }

    /// Gives rests that are too short to the charge beside them, and joins pieces that go together.
    fn lose(&mut self, shortest_m: f64) {
        for k in 0..self.taken.len() {
            let own = [self.edges[k], self.edges[k + 1]];
            if self.taken[k].is_none() && own[1] - own[0] < shortest_m {
                let below = k.checked_sub(1).and_then(|k| self.taken[k]);
                self.taken[k] = below.or_else(|| self.taken.get(k + 1).copied().flatten());
                self.lost.push(own);
            }
        }
        for k in (1..self.taken.len()).rev() {
            if self.taken[k] == self.taken[k - 1] {
                self.taken.remove(k);
                self.edges.remove(k);
            }
        }
    }

    /// Whether a single charge takes all of it.
    pub fn is_taken_whole(&self) -> bool {
        matches!(self.taken[..], [Some(_)])
    }

    /// Its pieces.
    pub fn cut(&self, structure: &Structure, axis: usize) -> Vec<super::cells::Piece> {
        slice(structure, self.member, axis, &self.edges)
    }

    /// The bodies that a charge takes, by their place among the pieces.
    pub fn taken_by(&self, charge: usize) -> impl Iterator<Item = usize> {
        self.taken.iter().enumerate().filter(move |(_, taken)| **taken == Some(charge)).map(|(k, _)| k)
    }

    /// Length of the stump at an end of the column \[m\], if there is one.
    pub fn left_m(&self, end: &MemberEnd) -> Option<f64> {
        let k = if end.outward > 0.0 { 0 } else { self.taken.len() - 1 };
        self.taken[k].is_none().then(|| self.edges[k + 1] - self.edges[k])
    }

    /// The faces at which its stumps may be crushed, at either end, with the number of the piece; and by how much less they get shorter than the end of a whole column, which does up to the middle of its length.
    pub fn faces(&self, low: Face, high: Face) -> impl Iterator<Item = (usize, Face, f64)> {
        let half_m = 0.5 * (self.edges[self.taken.len()] - self.edges[0]);
        let stumps = (0..self.taken.len()).filter(|k| self.taken[*k].is_none());
        stumps.flat_map(move |k| {
            let share = ((self.edges[k + 1] - self.edges[k]) / half_m).min(1.0);
            [(k, low, share), (k, high, share)]
        })
    }

    /// What rests go with a charge on the column.
    pub fn notes(&self, building: &Building) -> impl Iterator<Item = String> {
        let column = &building.members[self.member];
        let low = column.solid.min[column.axis];
        self.lost.iter().map(move |[from, to]| {
            format!(
                "what charges leave of `{}` between {:.2} and {:.2} m along it is shorter than half of its section and goes with them",
                column.id,
                from - low,
                to - low
            )
        })
    }

    /// The springs between its pieces.
    pub fn springs(&self, building: &Building, bodies: &Bodies, rules: &[String]) -> Vec<Bushing> {
        let member = &building.members[self.member];
        let own = bodies.all_of(self.member);
        let spring = |k: usize| {
            let length_m = 0.5 * (self.edges[k + 1] - self.edges[k - 1]);
            let prism = Prism::along(building, self.member, member.axis, length_m);
            let [below, above] = [own[k - 1], own[k]].map(|i| bodies.list[i].id.clone());
            let mut point_m = member.solid.center();
            point_m[member.axis] = self.edges[k];
            let bending =
                [0, 1].map(|i| Bending::Elastic { stiffness_nm_rad: prism.bending_nm2(i) / length_m });
            prism.springs(Bushing {
                bending,
                origin: Origin {
                    members: vec![member.id.clone()],
                    rules: rules.to_vec(),
                    ..Origin::default()
                },
                ..Bushing::free(
                    format!("{}.cut-{k}", member.id),
                    Some(below),
                    above,
                    point_m,
                    axes(member.axis, 1.0),
                )
            })
        };
        (1..self.taken.len()).map(spring).collect()
    }
}
