//! Slab strips between aligned columns that no beam joins: the flat slab as a grillage.

use super::{Builder, Span};
use crate::base::geom::Aabb;
use crate::building::MemberKind;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::graph::frame::BeamSection;
use std::collections::BTreeMap;

impl Builder<'_> {
    /// Adds the strips of all slabs.
    pub(super) fn add_strips(&mut self) {
        for slab in 0..self.building.members.len() {
            if self.member(slab).kind != MemberKind::Slab || !self.left(slab) {
                continue;
            }
            let joints = self.joints_in_slab(slab);
            let mut bars_at: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
            for (index, span) in self.spans.iter().enumerate() {
                if !self.upright(span.member) && span.member != slab {
                    span.nodes.iter().for_each(|(_, node)| bars_at.entry(*node).or_default().push(index));
                }
            }
            for axis in [0, 1] {
                for &from in &joints {
                    if let Some(to) = self.next_aligned(&joints, from, axis) {
                        let strip = self.strip(slab, &joints, [from, to], (axis, &bars_at));
                        self.spans.extend(strip);
                    }
                }
            }
        }
    }

    /// Bounding box of a joint's uprights.
    fn footprint(&self, joint: usize) -> Aabb {
        let solids = self.joints[joint].uprights.iter().map(|u| self.member(*u).solid);
        solids.reduce(Aabb::around).unwrap_or(Aabb { min: [0.0; 3], max: [0.0; 3] })
    }

    /// The nearest joint further along an axis whose footprint overlaps across it.
    fn next_aligned(&self, joints: &[usize], from: usize, axis: usize) -> Option<usize> {
        let (across, here) = (1 - axis, self.footprint(from));
        joints
            .iter()
            .copied()
            .filter(|&j| {
                let there = self.footprint(j);
                there.min[axis] > here.max[axis] + COORDINATE_TOLERANCE_M
                    && there.min[across] < here.max[across] - COORDINATE_TOLERANCE_M
                    && there.max[across] > here.min[across] + COORDINATE_TOLERANCE_M
            })
            .min_by(|a, b| self.footprint(*a).min[axis].total_cmp(&self.footprint(*b).min[axis]))
    }

    /// A strip between two joints unless a beam joins them.
    fn strip(
        &self,
        slab: usize,
        joints: &[usize],
        [from, to]: [usize; 2],
        (axis, bars_at): (usize, &BTreeMap<usize, Vec<usize>>),
    ) -> Option<Span> {
        let nodes = [from, to].map(|j| self.joints[j].node);
        let [at_from, at_to] = nodes.map(|n| bars_at.get(&n));
        let joined = at_from.zip(at_to).is_some_and(|(a, b)| a.iter().any(|span| b.contains(span)));
        if joined {
            return None;
        }
        let member = self.member(slab);
        let across = 1 - axis;
        let place = |j: usize| self.nodes[self.joints[j].node].point_m[across];
        let at = 0.5 * (place(from) + place(to));
        let (mut low, mut high) = (member.solid.min[across], member.solid.max[across]);
        for other in joints.iter().map(|j| place(*j)) {
            let half = 0.5 * (at + other);
            if other < at - COORDINATE_TOLERANCE_M {
                low = low.max(half);
            } else if other > at + COORDINATE_TOLERANCE_M {
                high = high.min(half);
            }
        }
        let mut line = member.solid.center();
        line[across] = at;
        let law = self.building.law_of(member);
        let size = [high - low, member.solid.size()[2]];
        let range = [self.footprint(from).max[axis], self.footprint(to).min[axis]];
        Some(Span {
            member: slab,
            name: member.id.clone(),
            axis,
            line,
            range,
            axis1: if axis == 0 { [0.0, 1.0, 0.0] } else { [-1.0, 0.0, 0.0] },
            section: BeamSection::rectangle(law.youngs_modulus_pa, law.poisson_ratio, size),
            ends: None,
            nodes: vec![(range[0], nodes[0]), (range[1], nodes[1])],
            loads: Vec::new(),
        })
    }
}
