//! Dead load: where each cell's weight goes.

use super::{Builder, LOAD_BIN_M, LOAD_SAMPLE_M, Span};
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::building::MemberKind;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::graph::frame::LineLoad;

/// Carriers as near as this share a sample point's load \[m\]: the diagonals of a symmetric panel.
const TIE_M: f64 = 1e-9;
/// Sample points along each side of a block of them.
const BLOCK: usize = 8;

/// The loads of a span that fall on a stretch of it.
pub(super) fn on_stretch(loads: &[([f64; 2], f64)], from: f64, to: f64) -> Vec<LineLoad> {
    let share = |x: f64| (x - from) / (to - from);
    loads
        .iter()
        .map(|(range, force)| ([range[0].max(from), range[1].min(to)], force))
        .filter(|(range, force)| range[1] > range[0] && **force != 0.0)
        .map(|(range, force)| LineLoad { stretch: range.map(share), force_n_m: [0.0, 0.0, -force] })
        .collect()
}

impl Builder<'_> {
    /// Places the weight of all members that are left.
    pub(super) fn place_loads(&mut self) {
        let mut spans_of = vec![Vec::new(); self.building.members.len()];
        for (index, span) in self.spans.iter().enumerate().filter(|(_, span)| span.ends.is_some()) {
            spans_of[span.member].push(index);
        }
        for member in 0..self.building.members.len() {
            if !self.left(member) || self.structure.boxes(member).is_empty() {
                continue;
            }
            let placed = match self.member(member).kind {
                MemberKind::Slab => self.place_slab(member),
                MemberKind::Footing => self.place_footing(member),
                _ => self.place_bar(member, &spans_of[member]),
            };
            if !placed {
                self.unplaced.push(self.member(member).id.clone());
            }
        }
    }

    /// Weight per volume of a member \[N/m³\].
    fn specific_weight(&self, member: usize) -> f64 {
        self.structure.density_kg_m3(member) * self.building.settings.gravity_m_s2
    }

    /// A bar: cells along its spans as line loads, the rest at the nearest end node.
    fn place_bar(&mut self, member: usize, spans: &[usize]) -> bool {
        let Some(&first) = spans.first() else { return false };
        let (axis, weight) = (self.spans[first].axis, self.specific_weight(member));
        for cell in self.structure.boxes(member) {
            let (middle, force) = (cell.center()[axis], weight * cell.volume());
            let inside = |s: &Span| s.range[0] < middle && middle < s.range[1];
            if let Some(&s) = spans.iter().find(|s| inside(&self.spans[**s])) {
                let range = [cell.min[axis], cell.max[axis]];
                self.spans[s].loads.push((range, force / (range[1] - range[0])));
                continue;
            }
            let distance = |(at, _): &(f64, usize)| (at - middle).abs();
            let ends = spans.iter().flat_map(|s| [self.spans[*s].nodes.first(), self.spans[*s].nodes.last()]);
            if let Some(&(_, node)) = ends.flatten().min_by(|a, b| distance(a).total_cmp(&distance(b))) {
                self.nodes[node].load[2] -= force;
            }
        }
        true
    }

    /// A footing: on the clamped ends that stand on it, equally.
    fn place_footing(&mut self, member: usize) -> bool {
        let id = &self.member(member).id;
        let on_it: Vec<String> = self
            .structure
            .ends
            .iter()
            .filter(|e| e.supported && self.left(e.member) && e.connected.contains(id))
            .map(|e| e.id.clone())
            .collect();
        let nodes: Vec<usize> =
            (0..self.nodes.len()).filter(|n| on_it.contains(&self.nodes[*n].id)).collect();
        let force = self.specific_weight(member) * self.structure.mass_of(&[member]).volume_m3;
        nodes.iter().for_each(|n| self.nodes[*n].load[2] -= force / nodes.len() as f64);
        !nodes.is_empty()
    }

    /// Those of some spans, by their places in a list, that may be the nearest to a point of a cell: one that is nearest to a point is no farther from it than the
    /// nearest to the centre, and half a diagonal.
    fn nearest_to(&self, cell: &Aabb, carriers: &[usize], places: &Boxes) -> Vec<usize> {
        let (mut flat, center, size) = (*cell, cell.center(), cell.size());
        (flat.min[2], flat.max[2]) = (0.0, 0.0);
        let half = 0.5 * size[0].hypot(size[1]);
        let mut reach = half + LOAD_BIN_M;
        loop {
            let found = places.near(&flat, reach);
            let distance = |i: &usize| project(&self.spans[carriers[*i]], [center[0], center[1]]).0;
            let least = found.iter().map(distance).fold(f64::INFINITY, f64::min);
            let needed = least + half + 2.0 * TIE_M;
            if reach >= needed {
                return found;
            }
            reach = if needed.is_finite() { needed } else { 2.0 * reach };
        }
    }

    /// Those of some spans that may be the nearest to a point of a small box.
    fn nearest_among(&self, candidates: &[usize], carriers: &[usize], block: &Aabb) -> Vec<usize> {
        let (center, size) = (block.center(), block.size());
        let distance = |i: usize| project(&self.spans[carriers[i]], [center[0], center[1]]).0;
        let least = candidates.iter().map(|i| distance(*i)).fold(f64::INFINITY, f64::min);
        // of a point half a diagonal away no span is nearer by more than that, and none farther
        let most = least + size[0].hypot(size[1]) + 2.0 * TIE_M;
        candidates.iter().copied().filter(|i| distance(*i) <= most).collect()
    }

    /// A slab: sample points of equal volume in each cell, each to the nearest carriers.
    fn place_slab(&mut self, slab: usize) -> bool {
        let (carriers, weight) = (self.carriers(slab), self.specific_weight(slab));
        if carriers.is_empty() {
            return self.place_slab_on_joints(slab, weight);
        }
        let mut bins: Vec<Vec<f64>> =
            carriers.iter().map(|c| vec![0.0; bin_count(&self.spans[*c])]).collect();
        let places = Boxes::of(carriers.iter().map(|c| in_plan(&self.spans[*c])));
        for cell in self.structure.boxes(slab) {
            let candidates = self.nearest_to(cell, &carriers, &places);
            let samples = Samples::of(cell, weight);
            let of_block: Vec<Vec<usize>> = (0..samples.blocks())
                .map(|block| self.nearest_among(&candidates, &carriers, &samples.block(block)))
                .collect();
            let mut near: Vec<(usize, f64, f64)> = Vec::with_capacity(candidates.len());
            for (point, force, block) in samples.each() {
                near.clear();
                near.extend(of_block[block].iter().map(|i| {
                    let (distance, along) = project(&self.spans[carriers[*i]], point);
                    (*i, distance, along)
                }));
                let least = near.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
                near.retain(|p| p.1 < least + TIE_M);
                for &(i, _, along) in &near {
                    let share = force / near.len() as f64;
                    let span = &self.spans[carriers[i]];
                    let [low, high] = span.range;
                    let place = (along - low) / (high - low);
                    if place <= 0.0 || place >= 1.0 {
                        let node = if place <= 0.0 { span.nodes.first() } else { span.nodes.last() };
                        node.into_iter().for_each(|(_, n)| self.nodes[*n].load[2] -= share);
                    } else {
                        // A sample on the border of two bins goes half to each: symmetric panels stay so.
                        let exact = place * bins[i].len() as f64;
                        let last = bins[i].len() - 1;
                        for side in [-TIE_M, TIE_M] {
                            bins[i][((exact + side) as usize).min(last)] += 0.5 * share;
                        }
                    }
                }
            }
        }
        for (carrier, bins) in carriers.iter().zip(bins) {
            let span = &mut self.spans[*carrier];
            let width = (span.range[1] - span.range[0]) / bins.len() as f64;
            let loads = bins.iter().enumerate().map(|(i, force)| {
                let from = span.range[0] + width * i as f64;
                ([from, if i + 1 == bins.len() { span.range[1] } else { from + width }], force / width)
            });
            let loads: Vec<_> = loads.collect();
            span.loads.extend(loads);
        }
        true
    }

    /// A slab without beams and strips: on the nearest joints.
    fn place_slab_on_joints(&mut self, slab: usize, weight: f64) -> bool {
        let joints = self.joints_in_slab(slab);
        let nodes: Vec<usize> = joints.iter().map(|j| self.joints[*j].node).collect();
        for cell in self.structure.boxes(slab) {
            for (point, force, _) in Samples::of(cell, weight).each() {
                let distance = |n: usize| {
                    let at = self.nodes[n].point_m;
                    (at[0] - point[0]).hypot(at[1] - point[1])
                };
                let least = nodes.iter().map(|n| distance(*n)).fold(f64::INFINITY, f64::min);
                let near: Vec<usize> =
                    nodes.iter().copied().filter(|n| distance(*n) < least + TIE_M).collect();
                near.iter().for_each(|n| self.nodes[*n].load[2] -= force / near.len() as f64);
            }
        }
        !nodes.is_empty()
    }
}

/// A horizontal span as a box without height.
fn in_plan(span: &Span) -> Aabb {
    let (mut low, mut high) = (span.line, span.line);
    (low[span.axis], high[span.axis]) = (span.range[0], span.range[1]);
    (low[2], high[2]) = (0.0, 0.0);
    Aabb { min: low, max: high }
}

fn bin_count(span: &Span) -> usize {
    ((span.range[1] - span.range[0]) / LOAD_BIN_M).ceil().max(1.0) as usize
}

/// Points of equal weight in a cell, along x first, in square blocks of [`BLOCK`] points a side.
struct Samples<'a> {
    cell: &'a Aabb,
    count: [usize; 2],
    force: f64,
}

impl<'a> Samples<'a> {
    fn of(cell: &'a Aabb, specific_weight: f64) -> Self {
        let along = |size: f64| (size / LOAD_SAMPLE_M - COORDINATE_TOLERANCE_M).ceil().clamp(1.0, 400.0);
        let [x, y, _] = cell.size().map(along);
        let force = specific_weight * cell.volume() / (x * y);
        Self { cell, count: [x as usize, y as usize], force }
    }

    /// Points with the force on each \[N\] and the number of its block.
    fn each(&self) -> impl Iterator<Item = ([f64; 2], f64, usize)> {
        let wide = self.count[0].div_ceil(BLOCK);
        (0..self.count[0] * self.count[1]).map(move |index| {
            let place = [index % self.count[0], index / self.count[0]];
            let point = [0, 1].map(|i| self.at(i, place[i] as f64 + 0.5));
            (point, self.force, place[0] / BLOCK + wide * (place[1] / BLOCK))
        })
    }

    /// Number of blocks.
    fn blocks(&self) -> usize {
        self.count[0].div_ceil(BLOCK) * self.count[1].div_ceil(BLOCK)
    }

    /// The box of a block.
    fn block(&self, number: usize) -> Aabb {
        let wide = self.count[0].div_ceil(BLOCK);
        let first = [number % wide * BLOCK, number / wide * BLOCK];
        let mut solid = *self.cell;
        for i in 0..2 {
            solid.min[i] = self.at(i, first[i] as f64);
            solid.max[i] = self.at(i, (first[i] + BLOCK).min(self.count[i]) as f64);
        }
        solid
    }

    fn at(&self, axis: usize, place: f64) -> f64 {
        self.cell.min[axis] + self.cell.size()[axis] * place / self.count[axis] as f64
    }
}

/// Distance of a point in plan from a horizontal span, and its coordinate along it (not clamped) \[m\].
fn project(span: &Span, point: [f64; 2]) -> (f64, f64) {
    let (along, across) = (point[span.axis], point[1 - span.axis] - span.line[1 - span.axis]);
    let beyond = (span.range[0] - along).max(along - span.range[1]).max(0.0);
    (if beyond > 0.0 { beyond.hypot(across) } else { across.abs() }, along)
}
