//! Joints: where columns and walls meet each other and the beams, and the nodes that stand for them.

use super::{Builder, meet};
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::base::sets::groups;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::building::{Building, Member, MemberKind};
use crate::graph::ends::{End, is_upright};
use crate::graph::frame::FrameNode;
use crate::graph::paths::plan_overlap;
use crate::graph::structure::Structure;
use petgraph::unionfind::UnionFind;
use std::collections::{BTreeMap, BTreeSet};

/// A joint block over and under columns and walls.
pub(super) struct Joint {
    /// Indices into `Structure::ends` of the ends of columns and walls in it.
    pub ends: Vec<usize>,
    /// The columns and walls, removed ones too: the block stays when its column goes.
    pub uprights: Vec<usize>,
    /// Lowest and highest level \[m\].
    pub range_m: [f64; 2],
    /// Its node.
    pub node: usize,
}

/// Joints of a building: unsupported ends of columns and walls, joined where only solid lies between a top and the
/// next bottom above it.
pub(super) fn find(structure: &Structure, building: &Building) -> Vec<Joint> {
    let upright: Vec<usize> = (0..structure.ends.len())
        .filter(|e| is_upright(&building.members[structure.ends[*e].member]) && !structure.ends[*e].supported)
        .collect();
    let level = |e: usize| structure.ends[e].point_m[2];
    let solid = |e: usize| &building.members[structure.ends[e].member].solid;
    let bottoms = upright.iter().copied().filter(|e| structure.ends[*e].end == End::Low);
    let bottoms = Boxes::numbered(bottoms.map(|e| (e, *solid(e))));
    let mut sets = UnionFind::new(structure.ends.len());
    for &top in upright.iter().filter(|e| structure.ends[**e].end == End::High) {
        let mut stack = *solid(top);
        stack.max[2] = f64::INFINITY;
        let above: Vec<usize> = bottoms
            .near(&stack, COORDINATE_TOLERANCE_M)
            .into_iter()
            .filter(|&e| level(e) > level(top) - COORDINATE_TOLERANCE_M)
            .filter(|&e| {
                plan_overlap(solid(e), solid(top))
                    .is_some_and(|p| structure.is_solid_between(p, level(top), level(e)))
            })
            .collect();
        let nearest = above.iter().map(|e| level(*e)).fold(f64::INFINITY, f64::min);
        for &bottom in above.iter().filter(|e| level(**e) < nearest + COORDINATE_TOLERANCE_M) {
            sets.union(top, bottom);
        }
    }
    groups(&sets, upright)
        .into_iter()
        .map(|ends| {
            let tops = ends.iter().filter(|e| structure.ends[**e].end == End::High);
            let bottoms = ends.iter().filter(|e| structure.ends[**e].end == End::Low);
            let low = tops.clone().map(|e| level(*e)).fold(f64::INFINITY, f64::min);
            let high = bottoms.map(|e| level(*e)).fold(f64::NEG_INFINITY, f64::max);
            let roof = tops.map(|e| solid(*e).max[2]).fold(f64::NEG_INFINITY, f64::max);
            let range_m = match (low.is_finite(), high.is_finite()) {
                (true, true) => [low, high],
                (true, false) => [low, roof],
                _ => [high, high],
            };
            let mut uprights: Vec<usize> = ends.iter().map(|e| structure.ends[*e].member).collect();
            uprights.dedup();
            Joint { ends, uprights, range_m, node: usize::MAX }
        })
        .collect()
}

impl Builder<'_> {
    /// One node for each joint: on the mean axis of its columns and walls, at the mean level of its beams.
    pub(super) fn place_joints(&mut self) {
        let structure = self.structure;
        let ends_of = |member: usize| {
            let [first, after] =
                [member, member + 1].map(|m| structure.ends.partition_point(|e| e.member < m));
            &structure.ends[first..after]
        };
        for index in 0..self.joints.len() {
            let joint = &self.joints[index];
            let count = joint.ends.len() as f64;
            let mean =
                |i: usize| joint.ends.iter().map(|e| self.structure.ends[*e].point_m[i]).sum::<f64>() / count;
            let near = self.beams.near(&self.block(joint), COORDINATE_TOLERANCE_M);
            let beams: Vec<f64> = near
                .into_iter()
                .flat_map(ends_of)
                .filter(|e| {
                    !self.upright(e.member) && self.frames_into(joint, e.member, e.axis, e.point_m[e.axis])
                })
                .map(|e| e.point_m[2])
                .collect();
            let middle = 0.5 * (joint.range_m[0] + joint.range_m[1]);
            let level =
                if beams.is_empty() { middle } else { beams.iter().sum::<f64>() / beams.len() as f64 };
            let id = format!("joint at {}", self.structure.ends[joint.ends[0]].id);
            let node = FrameNode::free(id, [mean(0), mean(1), level]);
            self.joints[index].node = self.nodes.len();
            self.nodes.push(node);
        }
    }

    /// The box around a joint, as far as its columns and walls reach in plan.
    fn block(&self, joint: &Joint) -> Aabb {
        let solids = joint.uprights.iter().map(|u| &self.member(*u).solid);
        let mut block = Aabb { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };
        for solid in solids {
            for i in 0..2 {
                block.min[i] = block.min[i].min(solid.min[i]);
                block.max[i] = block.max[i].max(solid.max[i]);
            }
        }
        (block.min[2], block.max[2]) = (joint.range_m[0], joint.range_m[1]);
        block
    }

    /// Whether a beam's end section at `coordinate` lies in a joint: within its columns and walls, or within a wider beam that passes over them.
    fn frames_into(&self, joint: &Joint, beam: usize, axis: usize, coordinate: f64) -> bool {
        let own = &self.member(beam).solid;
        let across = 1 - axis;
        let gap = |low: f64, high: f64, i: usize| (own.min[i] - high).max(low - own.max[i]);
        let lies_in = |solid: &Aabb| {
            coordinate > solid.min[axis] - COORDINATE_TOLERANCE_M
                && coordinate < solid.max[axis] + COORDINATE_TOLERANCE_M
        };
        gap(joint.range_m[0], joint.range_m[1], 2) < COORDINATE_TOLERANCE_M
            && joint.uprights.iter().any(|u| {
                let solid = &self.member(*u).solid;
                gap(solid.min[across], solid.max[across], across) < -COORDINATE_TOLERANCE_M
                    && (lies_in(solid) || self.beams_over(joint, solid, beam).any(|o| lies_in(&o.solid)))
            })
    }

    /// Beams across a beam that pass over a column or wall of a joint.
    fn beams_over<'b>(
        &'b self,
        joint: &Joint,
        upright: &Aabb,
        beam: usize,
    ) -> impl Iterator<Item = &'b Member> {
        let mut block = *upright;
        (block.min[2], block.max[2]) = (joint.range_m[0], joint.range_m[1]);
        let axis = self.member(beam).axis;
        let near = self.beams.near(&block, COORDINATE_TOLERANCE_M).into_iter().map(|b| self.member(b));
        near.filter(move |o| o.axis != axis && meet(&o.solid, &block))
    }

    /// Ties the ends of all bars to nodes: a clamp, a joint, another beam, or nothing.
    pub(super) fn tie_bars(&mut self) {
        let blocks = Boxes::of(self.joints.iter().map(|joint| self.block(joint)));
        let ends =
            self.joints.iter().enumerate().flat_map(|(j, joint)| joint.ends.iter().map(move |e| (*e, j)));
        let joint_of: BTreeMap<usize, usize> = ends.collect();
        for span in 0..self.spans.len() {
            let Some(ends) = self.spans[span].ends else { continue };
            for end in ends {
                let node = self.node_of_end(end, span, &blocks, &joint_of);
                let coordinate = self.structure.ends[end].point_m[self.spans[span].axis];
                self.seat(span, coordinate, node);
            }
        }
        self.seat_lone_joints();
        for span in &mut self.spans {
            span.nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
    }

    fn node_of_end(
        &mut self,
        index: usize,
        span: usize,
        blocks: &Boxes,
        joint_of: &BTreeMap<usize, usize>,
    ) -> usize {
        let end = &self.structure.ends[index];
        if end.supported {
            if !end.footings.is_empty() && end.footings.iter().all(|f| self.removed.contains(f)) {
                self.nodes.push(FrameNode::free(end.id.clone(), end.point_m));
                return self.nodes.len() - 1;
            }
            self.nodes.push(FrameNode::clamped(end.id.clone(), end.point_m));
            return self.nodes.len() - 1;
        }
        let joint = if self.upright(end.member) {
            joint_of.get(&index).copied()
        } else {
            let near = blocks.near(&self.member(end.member).solid, COORDINATE_TOLERANCE_M).into_iter();
            let into =
                |j: &usize| self.frames_into(&self.joints[*j], end.member, end.axis, end.point_m[end.axis]);
            near.into_iter().find(into)
        };
        if let Some(joint) = joint {
            return self.joints[joint].node;
        }
        if let Some((other, coordinate)) = self.beam_at(end.point_m, span) {
            return self.node_on(other, coordinate);
        }
        self.nodes.push(FrameNode::free(end.id.clone(), end.point_m));
        self.nodes.len() - 1
    }

    /// Another beam that contains a point, and the coordinate along it.
    fn beam_at(&self, point: [f64; 3], except: usize) -> Option<(usize, f64)> {
        self.spans.iter().enumerate().find_map(|(index, span)| {
            let coordinate = point[span.axis];
            let on = index != except
                && self.member(span.member).kind == MemberKind::Beam
                && self.member(span.member).solid.contains(point, COORDINATE_TOLERANCE_M)
                && coordinate > span.range[0] - COORDINATE_TOLERANCE_M
                && coordinate < span.range[1] + COORDINATE_TOLERANCE_M;
            on.then_some((index, coordinate))
        })
    }

    /// The node of a span at a coordinate inside it, a new one if there is none.
    pub(super) fn node_on(&mut self, span: usize, coordinate: f64) -> usize {
        if let Some(node) = self.seated_at(span, coordinate) {
            return node;
        }
        let point = self.spans[span].point(coordinate);
        self.nodes.push(FrameNode::free(format!("on {}", self.spans[span].name), point));
        let node = self.nodes.len() - 1;
        self.spans[span].nodes.push((coordinate, node));
        node
    }

    /// The node of a span at a coordinate.
    fn seated_at(&self, span: usize, coordinate: f64) -> Option<usize> {
        let here = |(at, _): &&(f64, usize)| (at - coordinate).abs() < COORDINATE_TOLERANCE_M;
        self.spans[span].nodes.iter().find(here).map(|(_, node)| *node)
    }

    /// Puts a node on a span. Where there is one already, as at the end of a beam on which the end of another one has been hung, both are one node: an
    /// element between them would have no length.
    pub(super) fn seat(&mut self, span: usize, coordinate: f64, node: usize) {
        match self.seated_at(span, coordinate) {
            Some(seated) => self.unite(seated, node),
            None => self.spans[span].nodes.push((coordinate, node)),
        }
    }

    /// Makes one node of two: the clamped one if one is, or else that of a joint.
    fn unite(&mut self, a: usize, b: usize) {
        let rank = |n: usize| (self.nodes[n].fixed[0], self.joints.iter().any(|joint| joint.node == n));
        let [kept, gone] = if rank(b) > rank(a) { [b, a] } else { [a, b] };
        let seats = self.spans.iter_mut().flat_map(|span| span.nodes.iter_mut().map(|(_, node)| node));
        let joints = self.joints.iter_mut().map(|joint| &mut joint.node);
        seats.chain(joints).filter(|node| **node == gone).for_each(|node| *node = kept);
    }

    /// A joint into which no beam ends but through which one passes (a column under or on a beam's span).
    fn seat_lone_joints(&mut self) {
        let bars = self.spans.iter().filter(|span| !self.upright(span.member));
        let seated: BTreeSet<usize> =
            bars.flat_map(|span| span.nodes.iter().map(|(_, node)| *node)).collect();
        for index in 0..self.joints.len() {
            let (node, range) = (self.joints[index].node, self.joints[index].range_m);
            if seated.contains(&node) {
                continue;
            }
            let [x, y, _] = self.nodes[node].point_m;
            for level in range {
                let Some((span, coordinate)) = self.beam_at([x, y, level], usize::MAX) else { continue };
                self.seat(span, coordinate, node);
                break;
            }
        }
    }
}
