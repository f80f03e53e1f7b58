//! Dead load: where each cell's weight goes.

use super::hull::Hull;
use super::joints::Joint;
use super::plates::Plate;
use super::{Builder, LOAD_BIN_M, LOAD_SAMPLE_M, Span};
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::building::MemberKind;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::graph::frame::LineLoad;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Carriers as near as this share a sample point's load \[m\]: the diagonals of a symmetric panel.
const TIE_M: f64 = 1e-9;

/// The loads of a span that fall on a stretch of it.
pub(super) fn on_stretch(loads: &[([f64; 2], [f64; 2])], from: f64, to: f64) -> Vec<LineLoad> {
    let share = |x: f64| (x - from) / (to - from);
    loads
        .iter()
        .map(|(range, force)| ([range[0].max(from), range[1].min(to)], force))
        .filter(|(range, [force, _])| range[1] > range[0] && *force != 0.0)
        .map(|(range, [force, torque])| LineLoad {
            stretch: range.map(share),
            force_n_m: [0.0, 0.0, -force],
            torque_nm_m: *torque,
        })
        .collect()
}

impl Builder<'_> {
    /// Places the weight of all members that are left.
    pub(super) fn place_loads(&mut self, plates: &[Plate]) {
        let mut spans_of = vec![Vec::new(); self.building.members.len()];
        for (index, span) in self.spans.iter().enumerate().filter(|(_, span)| span.ends.is_some()) {
            spans_of[span.member].push(index);
        }
        // where a plate's weight goes depends on where spans are alone, not on what they bear
        let borne: Vec<_> = plates.par_iter().flat_map_iter(|plate| self.on_carriers(plate)).collect();
        let mut of_slabs: BTreeMap<usize, OnCarriers> = borne.into_iter().collect();
        let mut plate_of = BTreeMap::new();
        for plate in plates {
            plate.slabs.iter().for_each(|s| {
                plate_of.insert(*s, plate);
            });
            self.on_plate(plate).for_each(|beam| {
                plate_of.insert(beam, plate);
            });
        }
        for member in 0..self.building.members.len() {
            if !self.left(member) || self.structure.boxes(member).is_empty() {
                continue;
            }
            let placed = match self.member(member).kind {
                _ if self.by_slab.contains(&member) => {
                    self.place_slab(member, plate_of[&member], of_slabs.remove(&member))
                }
                MemberKind::Slab => self.place_slab(member, plate_of[&member], of_slabs.remove(&member)),
                MemberKind::Footing => self.place_footing(member),
                _ => self.place_bar(member, &spans_of[member]),
            };
            if !placed {
                self.unplaced.push(self.member(member).id.clone());
            }
        }
    }

    /// Beams that only a plate holds.
    fn on_plate(&self, plate: &Plate) -> impl Iterator<Item = usize> {
        self.by_slab.iter().copied().filter(move |beam| plate.meets(&self.member(*beam).solid))
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
                self.spans[s].loads.push((range, [force / (range[1] - range[0]), 0.0]));
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

    /// A footing: on the clamped ends that stand on it, equally. One on which nothing stands any more lies on its own support, beside the frame.
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
        let mass = self.structure.mass_of(&[member]);
        let force = self.specific_weight(member) * mass.volume_m3;
        if nodes.is_empty() && self.structure.supports().any(|s| s.member == member) {
            self.aside_n += force;
            (0..2).for_each(|k| self.aside_moment_nm[k] += force * mass.center_m[k]);
            return true;
        }
        nodes.iter().for_each(|n| self.nodes[*n].load[2] -= force / nodes.len() as f64);
        !nodes.is_empty()
    }

    /// Those of some spans, by their places in a list, that may be the nearest to a point of a cell: one that is nearest to a point is no farther from it than the
    /// nearest to the centre, and half a diagonal.
    fn nearest_to(&self, cell: &Aabb, carriers: &[usize], places: &Boxes) -> Vec<usize> {
        let (mut flat, center, size) = (*cell, cell.center(), cell.size());
        (flat.min[2], flat.max[2]) = (0.0, 0.0);
        let half = 0.5 * libm::hypot(size[0], size[1]);
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

    /// What the carriers of a plate bear of each of its slabs: sample points of equal volume in each cell, each to the nearest carriers. Nothing without carriers.
    fn on_carriers(&self, plate: &Plate) -> Vec<(usize, OnCarriers)> {
        let carriers = self.carriers(plate);
        if carriers.is_empty() {
            return Vec::new();
        }
        let places = Boxes::of(carriers.iter().map(|c| in_plan(&self.spans[*c])));
        let spans: Vec<&Span> = carriers.iter().map(|c| &self.spans[*c]).collect();
        let hull = self.hull(plate, &carriers);
        let borne = |slab: &usize| {
            let (mut shares, weight) = (Shares::of(&spans, &hull), self.specific_weight(*slab));
            for cell in self.structure.boxes(*slab) {
                let mut candidates = self.nearest_to(cell, &carriers, &places);
                let samples = Samples::of(cell, weight);
                shares.reaches_beyond = !hull.contains(cell);
                shares.take(&samples, samples.count.map(|n| [0, n]), &mut candidates, 0);
            }
            let Shares { bins, nodes, beyond, .. } = shares;
            let bears = |(_, bins): &(usize, Vec<[f64; 2]>)| bins.iter().any(|[force, _]| *force != 0.0);
            let bins = carriers.iter().copied().zip(bins).filter(bears).collect();
            (*slab, OnCarriers { bins, nodes, beyond })
        };
        let beams: Vec<usize> = self.on_plate(plate).collect();
        plate.slabs.iter().chain(&beams).map(borne).collect()
    }

    /// A slab: on the carriers of its plate.
    fn place_slab(&mut self, slab: usize, plate: &Plate, shares: Option<OnCarriers>) -> bool {
        let Some(OnCarriers { bins, nodes, beyond }) = shares else {
            return self.place_slab_on_joints(slab, plate);
        };
        for (node, force) in nodes {
            self.nodes[node].load[2] -= force;
        }
        for (node, point, force) in beyond {
            self.turn(node, point, force);
        }
        for (carrier, bins) in bins {
            let span = &mut self.spans[carrier];
            let width = (span.range[1] - span.range[0]) / bins.len() as f64;
            let loads = bins.iter().enumerate().map(|(i, borne)| {
                let from = span.range[0] + width * i as f64;
                let to = if i + 1 == bins.len() { span.range[1] } else { from + width };
                ([from, to], borne.map(|sum| sum / (width * span.stretch())))
            });
            let loads: Vec<_> = loads.collect();
            span.loads.extend(loads);
        }
        true
    }

    /// A slab without beams and strips: on the nearest joints.
    fn place_slab_on_joints(&mut self, slab: usize, plate: &Plate) -> bool {
        let (joints, weight) = (self.joints_at(plate), self.specific_weight(slab));
        // the block of a column that is gone bears nothing unless a bar holds it
        let bars: BTreeSet<usize> = self.spans.iter().flat_map(|s| &s.nodes).map(|(_, node)| *node).collect();
        let joints: Vec<&Joint> =
            joints.iter().map(|j| &self.joints[*j]).filter(|joint| bars.contains(&joint.node)).collect();
        let hull = Hull::of(joints.iter().flat_map(|j| &j.uprights).map(|u| self.member(*u).solid));
        let nodes: Vec<usize> = joints.iter().map(|joint| joint.node).collect();
        for cell in self.structure.boxes(slab) {
            for (point, force) in Samples::of(cell, weight).each() {
                let distance = |n: usize| {
                    let at = self.nodes[n].point_m;
                    libm::hypot(at[0] - point[0], at[1] - point[1])
                };
                let least = nodes.iter().map(|n| distance(*n)).fold(f64::INFINITY, f64::min);
                let near: Vec<usize> =
                    nodes.iter().copied().filter(|n| distance(*n) < least + TIE_M).collect();
                let share = force / near.len() as f64;
                near.iter().for_each(|n| self.nodes[*n].load[2] -= share);
                if !hull.holds(point) {
                    near.iter().for_each(|n| self.turn(*n, point, share));
                }
            }
        }
        !nodes.is_empty()
    }
}

/// A horizontal span as a box without height.
fn in_plan(span: &Span) -> Aabb {
    let [from, to] = span.range.map(|coordinate| span.point(coordinate));
    let flat = |pick: fn(f64, f64) -> f64| [pick(from[0], to[0]), pick(from[1], to[1]), 0.0];
    Aabb { min: flat(f64::min), max: flat(f64::max) }
}

/// The node at the end of a span beyond which a place is.
fn end_node(span: &Span, place: f64) -> Option<usize> {
    let node = if place <= 0.0 { span.nodes.first() } else { span.nodes.last() };
    node.map(|(_, n)| *n)
}

fn bin_count(span: &Span) -> usize {
    ((span.range[1] - span.range[0]) / LOAD_BIN_M).ceil().max(1.0) as usize
}

/// What carriers of a slab bear of it.
struct OnCarriers {
    /// Spans with the forces \[N\] and torques \[N m\] on stretches of them.
    bins: Vec<(usize, Vec<[f64; 2]>)>,
    /// Nodes with the forces on them, in the order in which they came \[N\].
    nodes: Vec<(usize, f64)>,
    /// Those of the forces on nodes that come from beyond the carriers, and from where in plan \[m, N\].
    beyond: Vec<(usize, [f64; 2], f64)>,
}

/// The same while it is found.
struct Shares<'a> {
    spans: &'a [&'a Span],
    hull: &'a Hull,
    /// Whether some of the cell at hand lies beyond the carriers.
    reaches_beyond: bool,
    /// Forces \[N\] and torques \[N m\] on stretches of the spans.
    bins: Vec<Vec<[f64; 2]>>,
    /// See [`OnCarriers`].
    nodes: Vec<(usize, f64)>,
    /// See [`OnCarriers`].
    beyond: Vec<(usize, [f64; 2], f64)>,
    /// Distances of the candidates of a rectangle \[m\].
    distances_m: Vec<f64>,
}

impl<'a> Shares<'a> {
    fn of(spans: &'a [&'a Span], hull: &'a Hull) -> Self {
        let bins = spans.iter().map(|s| vec![[0.0; 2]; bin_count(s)]).collect();
        let (nodes, beyond, distances_m) = (Vec::new(), Vec::new(), Vec::new());
        Self { spans, hull, reaches_beyond: false, bins, nodes, beyond, distances_m }
    }

    /// A rectangle of sample points, each to its nearest carriers; these are among those from a place of a list on. It is halved until one carrier is the
    /// nearest to all of its points, or one point is left: the work is that of the lines between the carriers' shares, not of the area.
    fn take(&mut self, samples: &Samples, part: [[usize; 2]; 2], candidates: &mut Vec<usize>, from: usize) {
        let [x, y] = part.map(|[low, high]| high - low);
        let middle = [0, 1].map(|i| samples.at(i, 0.5 * (part[i][0] + part[i][1]) as f64));
        let scratch = self.distances_m.len();
        self.distances_m.extend(candidates[from..].iter().map(|i| project(self.spans[*i], middle).0));
        let least = self.distances_m[scratch..].iter().copied().fold(f64::INFINITY, f64::min);
        // of a point half a diagonal away no span is nearer by more than that, and none farther
        let [a, b] = [0, 1].map(|i| samples.step_m[i] * [x, y][i].saturating_sub(1) as f64);
        let most = least + (a * a + b * b).sqrt() + TIE_M;
        let end = candidates.len();
        for place in from..end {
            if self.distances_m[scratch + place - from] < most {
                candidates.push(candidates[place]);
            }
        }
        self.distances_m.truncate(scratch);
        if x * y == 1 {
            let share = samples.force / (candidates.len() - end) as f64;
            for i in &candidates[end..] {
                self.bear(*i, project(self.spans[*i], middle).1, share);
                self.turn(*i, middle, share);
            }
        } else if let [only] = candidates[end..]
            && self.spans[only].skew == 0.0
        {
            let axis = self.spans[only].axis;
            let force = samples.force * [y, x][axis] as f64;
            (part[axis][0]..part[axis][1])
                .for_each(|k| self.bear(only, samples.at(axis, k as f64 + 0.5), force));
            if self.reaches_beyond {
                let rows = (part[1][0]..part[1][1]).map(|k| samples.at(1, k as f64 + 0.5));
                let points = rows
                    .flat_map(|y| (part[0][0]..part[0][1]).map(move |k| [samples.at(0, k as f64 + 0.5), y]));
                points.for_each(|point| self.turn(only, point, samples.force));
            }
        } else {
            let long = usize::from(y > x);
            let [low, high] = part[long];
            for half in [[low, low.midpoint(high)], [low.midpoint(high), high]] {
                let mut piece = part;
                piece[long] = half;
                self.take(samples, piece, candidates, end);
            }
        }
        candidates.truncate(end);
    }

    /// A force on a span, `along` it \[m, N\].
    fn bear(&mut self, i: usize, along: f64, force: f64) {
        let span = self.spans[i];
        let [low, high] = span.range;
        let place = (along - low) / (high - low);
        if place <= 0.0 || place >= 1.0 {
            self.nodes.extend(end_node(span, place).map(|n| (n, force)));
            return;
        }
        self.stretches(i, place).into_iter().for_each(|bin| self.bins[i][bin][0] += 0.5 * force);
    }

    /// The moment that a force from a point \[m, N\] has about a span, if the point lies beyond all carriers.
    fn turn(&mut self, i: usize, point: [f64; 2], force: f64) {
        if !self.reaches_beyond || self.hull.holds(point) {
            return;
        }
        let span = self.spans[i];
        let (along, [low, high]) = (project(span, point).1, span.range);
        let place = (along - low) / (high - low);
        if place <= 0.0 || place >= 1.0 {
            self.beyond.extend(end_node(span, place).map(|n| (n, point, force)));
            return;
        }
        // from the foot straight across: to the left of x as of y a weight turns against the axis along x, and with that along y
        let foot = span.point(along);
        let across = (point[1 - span.axis] - foot[1 - span.axis]) * span.stretch();
        let torque = if span.axis == 0 { -across * force } else { across * force };
        self.stretches(i, place).into_iter().for_each(|bin| self.bins[i][bin][1] += 0.5 * torque);
    }

    /// The stretches of a span on which a place of it is. A sample on the border of two goes half to each: symmetric panels stay so.
    fn stretches(&self, i: usize, place: f64) -> [usize; 2] {
        let exact = place * self.bins[i].len() as f64;
        let last = self.bins[i].len() - 1;
        [-TIE_M, TIE_M].map(|side| ((exact + side) as usize).min(last))
    }
}

/// Points of equal weight in the middles of the fields of a cell.
struct Samples<'a> {
    cell: &'a Aabb,
    count: [usize; 2],
    step_m: [f64; 2],
    force: f64,
}

impl<'a> Samples<'a> {
    fn of(cell: &'a Aabb, specific_weight: f64) -> Self {
        let size = cell.size();
        let along = |i: usize| (size[i] / LOAD_SAMPLE_M - COORDINATE_TOLERANCE_M).ceil().clamp(1.0, 400.0);
        let count = [0, 1].map(along);
        let force = specific_weight * cell.volume() / (count[0] * count[1]);
        let step_m = [0, 1].map(|i| size[i] / count[i]);
        Self { cell, count: count.map(|n| n as usize), step_m, force }
    }

    /// Points with the force on each \[N\], along x first.
    fn each(&self) -> impl Iterator<Item = ([f64; 2], f64)> {
        let place = |index: usize| [index % self.count[0], index / self.count[0]];
        (0..self.count[0] * self.count[1])
            .map(move |index| ([0, 1].map(|i| self.at(i, place(index)[i] as f64 + 0.5)), self.force))
    }

    fn at(&self, axis: usize, place: f64) -> f64 {
        self.cell.min[axis] + self.step_m[axis] * place
    }
}

/// Distance of a point in plan from a horizontal span, and the coordinate of its foot on the span's line (not clamped) \[m\].
fn project(span: &Span, point: [f64; 2]) -> (f64, f64) {
    let (at, stretch) = (point[span.axis], span.stretch());
    let aside = point[1 - span.axis] - span.point(at)[1 - span.axis];
    let (along, across) = (at + aside * span.skew / (stretch * stretch), aside / stretch);
    let beyond = stretch * (span.range[0] - along).max(along - span.range[1]).max(0.0);
    (if beyond > 0.0 { (beyond * beyond + across * across).sqrt() } else { across.abs() }, along)
}
