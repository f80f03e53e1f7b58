//! Beams that only a slab holds: they reach no column, no wall and no beam that does.
//!
//! Where a strip of the slab runs along such a beam, the beam's ends are tied to it: both bend together. Elsewhere the plate bears the
//! beam, whose weight goes with that of the plate; its stiffness is left out, and it has no forces of its own.

use super::plates::Plate;
use super::{Builder, Span};
use crate::building::MemberKind;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use petgraph::unionfind::UnionFind;
use std::collections::BTreeSet;

impl Builder<'_> {
    /// Ties beams that only a slab holds to strips that run along them, and takes those without one away.
    pub(super) fn hold_floating_beams(&mut self, plates: &[Plate]) {
        for span in self.floating(plates) {
            self.tie_to_strip(span, plates);
        }
        let floating: BTreeSet<usize> = self.floating(plates).into_iter().collect();
        let others = (0..self.spans.len()).filter(|s| !floating.contains(s)).map(|s| self.spans[s].member);
        let held: BTreeSet<usize> = others.collect();
        let members = floating.iter().map(|s| self.spans[*s].member);
        self.by_slab = members.filter(|m| !held.contains(m)).collect();
        let by_slab = &self.by_slab;
        self.spans.retain(|s| s.ends.is_none() || !by_slab.contains(&s.member));
    }

    /// Nodes that spans connect.
    pub(super) fn connected(&self) -> UnionFind<usize> {
        let mut parts = UnionFind::new(self.nodes.len());
        for span in &self.spans {
            span.nodes.windows(2).for_each(|pair| {
                parts.union(pair[0].1, pair[1].1);
            });
        }
        parts
    }

    /// Beams at plates that hang together with no joint, no column or wall and no support. A joint whose column is gone is one.
    fn floating(&self, plates: &[Plate]) -> Vec<usize> {
        let parts = self.connected();
        let uprights = self.spans.iter().filter(|s| self.upright(s.member)).flat_map(|s| &s.nodes);
        let fixed = (0..self.nodes.len()).filter(|n| self.nodes[*n].fixed.contains(&true));
        let nodes = uprights.map(|(_, n)| *n).chain(fixed).chain(self.joints.iter().map(|j| j.node));
        let held: BTreeSet<usize> = nodes.map(|n| parts.find(n)).collect();
        let floats = |s: &Span| {
            self.member(s.member).kind == MemberKind::Beam
                && s.nodes.iter().all(|(_, n)| !held.contains(&parts.find(*n)))
                && plates.iter().any(|p| p.meets(&self.member(s.member).solid))
        };
        (0..self.spans.len()).filter(|s| floats(&self.spans[*s])).collect()
    }

    /// Ties the ends of a beam to a strip that runs along it, if there is one.
    fn tie_to_strip(&mut self, beam: usize, plates: &[Plate]) {
        let (own, solid) = (&self.spans[beam], self.member(self.spans[beam].member).solid);
        let across = 1 - own.axis;
        let on = |s: &Span, at: f64| {
            s.range[0] - COORDINATE_TOLERANCE_M < at && at < s.range[1] + COORDINATE_TOLERANCE_M
        };
        let along = |s: &Span| {
            s.ends.is_none()
                && s.axis == own.axis
                && s.skew == 0.0
                && (solid.min[across]..solid.max[across]).contains(&s.line[across])
                && own.range.iter().any(|at| on(s, *at))
                && plates.iter().any(|p| p.slabs.contains(&s.member) && p.meets(&solid))
        };
        let Some(strip) = self.spans.iter().position(along) else { return };
        let ends = [own.nodes.first(), own.nodes.last()].into_iter().flatten().copied();
        let ends: Vec<(f64, usize)> = ends.filter(|(at, _)| on(&self.spans[strip], *at)).collect();
        for (at, node) in ends {
            self.seat(strip, at, node);
        }
        self.spans[strip].nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
}
