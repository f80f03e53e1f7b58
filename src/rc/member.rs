//! The mesh of a member end in concrete and steel: hexahedra, bars and ties as trusses on common nodes, and the joint block that the
//! member stands on.
//!
//! Mesh planes run through the lines of bars ([`super::bar_lines`]), which displace concrete: elements beside them have that much less of it. Along the member the critical length has layers that divide the tie spacing; beyond it they
//! are twice as long. Perimeter ties run through the outer bars, cross ties through the inner ones. The joint block is elastic, wider than
//! the member, and clamped at its base: what tests call a footing or stub.
//!
//! Bent along an axis, a section that is its own mirror image across that axis needs only half a mesh: nodes on the plane of symmetry stay in it, bars and
//! tie legs on it have half their area. Forces are those of the half ([`RcMember::share`]).

use super::anchorage::BarSlip;
use super::bar_lines::{aligned, leg_weights};
use crate::fe::concrete::ConcretePoints;
use crate::fe::hexahedron::volume_m3;
use crate::fe::law::Law;
use crate::fe::mesh::{Element, Mesh, Truss};
use crate::material::concrete::{ConcreteLaw, LawError};
use crate::material::fibre::SectionInput;
use crate::material::rebar::{Hardening, LoopShape, RebarLaw};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Length with the fine mesh, in section depths.
const CRITICAL_DEPTHS: f64 = 1.5;
/// Depth of the joint block, in section depths.
const BLOCK_DEPTHS: f64 = 0.5;
/// Width by which the joint block is larger on each side, in section depths.
const BLOCK_MARGIN: f64 = 0.25;
/// Planes closer than this are one \[m\].
const SAME_M: f64 = 1e-6;
/// Hardening of ties over Young's modulus.
const TIE_HARDENING: f64 = 0.01;
/// Least share of concrete in an element beside a bar: one much smaller than the bar would have none.
const LEAST_CONCRETE: f64 = 0.1;

/// What the member stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Joint {
    /// A block of uncracked concrete, wider than the member: a footing, a stub, a joint with beams. It keeps the end section from
    /// spreading, so that the member fails some way above it.
    Block,
    /// A plane of symmetry: the end section stays plane, free to spread. What section analysis describes.
    Symmetry,
}

/// A member end as a mesh: it stands on z = 0 and reaches to the point of zero moment.
#[derive(Debug, Clone)]
pub struct RcMember {
    /// The mesh.
    pub mesh: Mesh,
    /// Length from the end section to the point of zero moment \[m\].
    pub length_m: f64,
    /// Nodes of the free end with their share of its area.
    pub tip: Vec<(usize, f64)>,
    /// Nodes of the free end on which a tension acts, with their share of it: those of the bars (of all nodes, if there are none).
    pub pulled: Vec<(usize, f64)>,
    /// Nodes that hold it: those of the base of the block, or of the end section, with their share of its area (none for nodes of slipping bars).
    pub base: Vec<(usize, f64)>,
    /// What it stands on.
    pub joint: Joint,
    /// Height of these nodes below the end section \[m\].
    pub block_m: f64,
    /// Index of each truss that is a longitudinal bar.
    pub bars: Vec<usize>,
    /// Bars that slip out of the joint; empty with full bond ([`RcMember::anchored`]).
    pub slips: Vec<BarSlip>,
    /// Share of the section that is meshed: 1, or 0.5.
    pub share: f64,
    /// Axis across the plane of symmetry of half a section: 0 for x, 1 for y.
    pub mirror: Option<usize>,
    /// Nodes on that plane.
    pub mirrored: Vec<usize>,
}

/// Planes of the mesh along one axis.
struct Planes(Vec<f64>);

impl Planes {
    /// Between the faces, or with `mirrored` from the middle to one face, and through `through`, not further apart than `size`.
    fn new(half: f64, mirrored: bool, through: impl Iterator<Item = f64>, size: f64) -> Self {
        let first = if mirrored { 0.0 } else { -half };
        let mut fixed: Vec<f64> = through.filter(|at| *at > first).chain([first, half]).collect();
        fixed.sort_by(f64::total_cmp);
        fixed.dedup_by(|a, b| (*a - *b).abs() < SAME_M);
        let mut planes = vec![fixed[0]];
        for pair in fixed.windows(2) {
            let count = ((pair[1] - pair[0]) / size).round().max(1.0);
            planes.extend((1..=count as usize).map(|i| pair[0] + (pair[1] - pair[0]) * i as f64 / count));
        }
        Self(planes)
    }

    /// Index of the plane nearest to a coordinate.
    fn nearest(&self, at: f64) -> usize {
        let distance = |i: &usize| (self.0[*i] - at).abs();
        (0..self.0.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    }
}

impl RcMember {
    /// Meshes a section over a length \[m\] with elements of about `size_m`.
    ///
    /// # Errors
    /// If the concrete law is out of its range, or does not suit the size of the elements.
    pub fn new(
        section: &SectionInput,
        concrete: &ConcreteLaw,
        joint: Joint,
        length_m: f64,
        size_m: f64,
    ) -> Result<Self, LawError> {
        Self::meshed(section, concrete, joint, [length_m, size_m], None)
    }

    /// As [`Self::new`], but half the section where it is symmetric about the plane in which it is bent: along x or y
    /// (`direction_deg` a multiple of 90).
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn half(
        section: &SectionInput,
        concrete: &ConcreteLaw,
        joint: Joint,
        [length_m, size_m]: [f64; 2],
        direction_deg: f64,
    ) -> Result<Self, LawError> {
        let mirror = mirror_of(section, direction_deg);
        Self::meshed(section, concrete, joint, [length_m, size_m], mirror)
    }

    fn meshed(
        section: &SectionInput,
        concrete: &ConcreteLaw,
        joint: Joint,
        sizes_m: [f64; 2],
        mirror: Option<usize>,
    ) -> Result<Self, LawError> {
        let section = aligned(section, sizes_m[1]);
        let member = Builder::new(&section, concrete, joint, sizes_m, CRITICAL_DEPTHS, mirror).build();
        ConcretePoints::of(&member.mesh)?;
        Ok(member)
    }

    /// A piece between two plane sections, with the fine mesh throughout; otherwise as [`RcMember::new`].
    ///
    /// # Errors
    /// As [`RcMember::new`].
    pub fn piece(
        section: &SectionInput,
        concrete: &ConcreteLaw,
        length_m: f64,
        size_m: f64,
    ) -> Result<Self, LawError> {
        let section = aligned(section, size_m);
        let member =
            Builder::new(&section, concrete, Joint::Symmetry, [length_m, size_m], f64::INFINITY, None)
                .build();
        ConcretePoints::of(&member.mesh)?;
        Ok(member)
    }

    /// Number of hexahedra that [`Self::new`] makes, without making them.
    pub fn hexahedra(
        section: &SectionInput,
        concrete: &ConcreteLaw,
        joint: Joint,
        length_m: f64,
        size_m: f64,
    ) -> usize {
        let section = aligned(section, size_m);
        let builder = Builder::new(&section, concrete, joint, [length_m, size_m], CRITICAL_DEPTHS, None);
        let (nx, ny) = (builder.x.0.len() - 1, builder.y.0.len() - 1);
        nx * ny * (builder.z.len() - 1 - builder.block) + (nx + 2) * (ny + 2) * builder.block
    }
}

/// The axis along which a section bent in a direction is its own mirror image, if it is bent along the other one.
fn mirror_of(section: &SectionInput, direction_deg: f64) -> Option<usize> {
    let quarter = direction_deg / 90.0;
    if quarter != quarter.round() {
        return None;
    }
    let mirror = if quarter % 2.0 == 0.0 { 1 } else { 0 };
    let at = |b: &crate::building::Bar| [b.x_m, b.y_m];
    let has_image = |bar: &crate::building::Bar| {
        let mut image = at(bar);
        image[mirror] = -image[mirror];
        section.bars.iter().any(|other| {
            let near = (0..2).all(|i| (at(other)[i] - image[i]).abs() < SAME_M);
            near && (other.diameter_m - bar.diameter_m).abs() < SAME_M
        })
    };
    section.bars.iter().all(has_image).then_some(mirror)
}

struct Builder<'a> {
    section: &'a SectionInput,
    joint: Joint,
    mirror: Option<usize>,
    x: Planes,
    y: Planes,
    /// Layers from the base of the block; `z[block]` is the end section.
    z: Vec<f64>,
    block: usize,
    nodes: BTreeMap<[i32; 3], usize>,
    mesh: Mesh,
}

/// Laws of the mesh by index.
const CONCRETE: usize = 0;
const BLOCK: usize = 1;
pub(super) const BARS: usize = 2;
const TIES: usize = 3;

impl<'a> Builder<'a> {
    fn new(
        section: &'a SectionInput,
        concrete: &ConcreteLaw,
        joint: Joint,
        [length_m, size_m]: [f64; 2],
        critical_depths: f64,
        mirror: Option<usize>,
    ) -> Self {
        let planes = |axis: usize| {
            let bars = section.bars.iter().map(|b| [b.x_m, b.y_m][axis]);
            Planes::new(0.5 * section.size_m[axis], mirror == Some(axis), bars, size_m)
        };
        let (x, y) = (planes(0), planes(1));
        let depth = section.size_m[0].max(section.size_m[1]);
        let spacing = section.ties.map_or(size_m, |t| t.spacing_m);
        let fine = spacing / (spacing / size_m).round().max(1.0);
        let layers = match joint {
            Joint::Block => (BLOCK_DEPTHS * depth / (2.0 * fine)).round().max(2.0) as usize,
            Joint::Symmetry => 0,
        };
        let mut z: Vec<f64> = (0..=layers)
            .map(|i| {
                BLOCK_DEPTHS * depth * (i as f64 / layers.max(1) as f64 - if layers > 0 { 1.0 } else { 0.0 })
            })
            .collect();
        let critical = (critical_depths * depth).min(length_m);
        let fine_layers = (critical / fine).ceil() as usize;
        z.extend((1..=fine_layers).map(|i| fine * i as f64).filter(|h| *h < length_m - 0.5 * fine));
        let last = z[z.len() - 1];
        let coarse = ((length_m - last) / (2.0 * fine)).round().max(1.0);
        z.extend((1..=coarse as usize).map(|i| last + (length_m - last) * i as f64 / coarse));
        let mesh = Mesh {
            laws: laws(section, concrete),
            parts: vec!["member".into(), "block".into()],
            ..Mesh::default()
        };
        Self { section, joint, mirror, x, y, z, block: layers, nodes: BTreeMap::new(), mesh }
    }

    fn build(mut self) -> RcMember {
        let (nx, ny) = (self.x.0.len() as i32 - 1, self.y.0.len() as i32 - 1);
        for k in 0..self.z.len() - 1 {
            let (law, margin) = if k < self.block { (BLOCK, 1) } else { (CONCRETE, 0) };
            let first = [0, 1].map(|axis| if self.mirror == Some(axis) { 0 } else { -margin });
            for j in first[1]..ny + margin {
                for i in first[0]..nx + margin {
                    self.element([i, j, k as i32], law);
                }
            }
        }
        self.mesh.elements.sort_by_key(|e| e.law);
        let bars = self.bars();
        self.displace(&bars);
        self.ties();
        let top = self.z.len() as i32 - 1;
        let tip = self.section_nodes(top);
        let pulled = self.pulled(&bars, &tip);
        let base = match self.joint {
            Joint::Block => self.nodes.iter().filter(|(at, _)| at[2] == 0).map(|(_, n)| (*n, 0.0)).collect(),
            Joint::Symmetry => self.section_nodes(0),
        };
        if self.joint == Joint::Block {
            self.mesh.fixed = base.iter().map(|(n, _)| *n).collect();
        }
        let on_plane = |at: &[i32; 3]| self.mirror.is_some_and(|axis| at[axis] == 0);
        let mirrored = self.nodes.iter().filter(|(at, _)| on_plane(at)).map(|(_, n)| *n).collect();
        RcMember {
            share: if self.mirror.is_some() { 0.5 } else { 1.0 },
            mirror: self.mirror,
            mirrored,
            length_m: self.z[top as usize],
            block_m: -self.z[0],
            mesh: self.mesh,
            tip,
            pulled,
            base,
            joint: self.joint,
            bars,
            slips: Vec::new(),
        }
    }

    fn depth_m(&self) -> f64 {
        self.section.size_m[0].max(self.section.size_m[1])
    }

    /// Position of a plane; one beyond the ends is that of the block.
    fn plane(&self, planes: &Planes, i: i32) -> f64 {
        let last = planes.0.len() as i32 - 1;
        let margin = BLOCK_MARGIN * self.depth_m();
        if i < 0 {
            planes.0[0] - margin
        } else if i > last {
            planes.0[last as usize] + margin
        } else {
            planes.0[i as usize]
        }
    }

    fn node(&mut self, at: [i32; 3]) -> usize {
        let position = [self.plane(&self.x, at[0]), self.plane(&self.y, at[1]), self.z[at[2] as usize]];
        let nodes = &mut self.mesh.nodes;
        *self.nodes.entry(at).or_insert_with(|| {
            nodes.push(position);
            nodes.len() - 1
        })
    }

    fn element(&mut self, [i, j, k]: [i32; 3], law: usize) {
        const CORNERS: [[i32; 3]; 8] =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let nodes = CORNERS.map(|c| self.node([i + c[0], j + c[1], k + c[2]]));
        self.mesh.elements.push(Element {
            nodes,
            part: usize::from(law == BLOCK),
            law,
            smear: 1.0,
            strength: 1.0,
        });
    }

    fn truss(&mut self, ends: [[i32; 3]; 2], area_m2: f64, law: usize) {
        let nodes = ends.map(|at| self.node(at));
        self.mesh.trusses.push(Truss { nodes, area_m2, part: 0, law });
    }

    /// Longitudinal bars, anchored at the base of the block.
    fn bars(&mut self) -> Vec<usize> {
        for bar in &self.section.bars {
            let share = self.mirror.map_or(1.0, |axis| share_of([bar.x_m, bar.y_m][axis]));
            if share == 0.0 {
                continue;
            }
            let (i, j) = (self.x.nearest(bar.x_m) as i32, self.y.nearest(bar.y_m) as i32);
            let area = share * 0.25 * std::f64::consts::PI * bar.diameter_m * bar.diameter_m;
            for k in 0..self.z.len() as i32 - 1 {
                self.truss([[i, j, k], [i, j, k + 1]], area, BARS);
            }
        }
        (0..self.mesh.trusses.len()).collect()
    }

    /// Takes the volume of the bars from the concrete around them: each bar's from the elements that have it on an edge, in equal parts.
    fn displace(&mut self, bars: &[usize]) {
        let mesh = &mut self.mesh;
        let mut around: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
        for (e, element) in mesh.elements.iter().enumerate().filter(|(_, e)| e.law == CONCRETE) {
            for edge in 0..4 {
                around.entry([element.nodes[edge], element.nodes[edge + 4]]).or_default().push(e);
            }
        }
        let volumes: Vec<f64> =
            mesh.elements.iter().map(|e| volume_m3(&e.nodes.map(|n| mesh.nodes[n]))).collect();
        for bar in bars {
            let Truss { nodes, area_m2, .. } = mesh.trusses[*bar];
            let length_m = (mesh.nodes[nodes[1]][2] - mesh.nodes[nodes[0]][2]).abs();
            let elements = around.get(&nodes).map_or(&[][..], Vec::as_slice);
            for e in elements {
                let left = &mut mesh.elements[*e].smear;
                *left =
                    (*left - area_m2 * length_m / (elements.len() as f64 * volumes[*e])).max(LEAST_CONCRETE);
            }
        }
    }

    /// The ends of the bars at the free end with their share of a tension: by their area, and so that it acts in the middle of the section. Concrete that was pulled
    /// itself would tear there.
    fn pulled(&self, bars: &[usize], tip: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let areas: BTreeMap<usize, f64> =
            bars.iter().map(|b| (self.mesh.trusses[*b].nodes[1], self.mesh.trusses[*b].area_m2)).collect();
        let ends: Vec<(usize, f64)> = tip.iter().filter_map(|(n, _)| Some((*n, *areas.get(n)?))).collect();
        let arm = |n: usize| {
            // across the plane of symmetry the other half balances it
            let at = |axis: usize| if self.mirror == Some(axis) { 0.0 } else { self.mesh.nodes[n][axis] };
            Vector3::new(1.0, at(0), at(1))
        };
        let mut sum: Matrix3<f64> = ends.iter().map(|(n, area)| arm(*n) * arm(*n).transpose() * *area).sum();
        for k in (0..3).filter(|k| ends.iter().all(|(n, _)| arm(*n)[*k].abs() < SAME_M)) {
            sum[(k, k)] = 1.0;
        }
        let Some(inverse) = sum.try_inverse() else { return tip.to_vec() };
        let even = inverse * Vector3::new(1.0, 0.0, 0.0);
        ends.iter().map(|(n, area)| (*n, area * even.dot(&arm(*n)))).collect()
    }

    /// Ties at their spacing; where layers are longer than that, at every layer with the steel that belongs to it.
    fn ties(&mut self) {
        let Some(ties) = self.section.ties else { return };
        let leg = 0.25 * std::f64::consts::PI * ties.diameter_m * ties.diameter_m;
        // lines of bars with the legs on them: all of them count, those of the other half are left out
        let lines = |axis: usize, legs: f64| -> Vec<(i32, f64)> {
            let planes = [&self.x, &self.y][axis];
            let mut at: Vec<f64> = self.section.bars.iter().map(|b| [b.x_m, b.y_m][axis]).collect();
            at.sort_by(f64::total_cmp);
            at.dedup_by(|a, b| (*a - *b).abs() < SAME_M);
            let share = |x: f64| if self.mirror == Some(axis) { share_of(x) } else { 1.0 };
            let weights = leg_weights(at.len(), legs);
            at.iter().zip(weights).map(|(x, w)| (planes.nearest(*x) as i32, w * share(*x))).collect()
        };
        let (xs, ys) = (lines(0, ties.legs[1]), lines(1, ties.legs[0]));
        let span = |axis: usize, lines: &[(i32, f64)]| {
            let first = if self.mirror == Some(axis) { 0 } else { lines[0].0 };
            first..lines[lines.len() - 1].0
        };
        let (along_x, along_y) = (span(0, &xs), span(1, &ys));
        let levels = tie_levels(&self.z, self.block, ties.spacing_m);
        for (k, share) in levels {
            // legs along x lie on lines of constant y, and the other way round
            for (line, weight) in ys.iter().copied().filter(|(_, w)| *w > 0.0) {
                for i in along_x.clone() {
                    self.truss([[i, line, k], [i + 1, line, k]], share * weight * leg, TIES);
                }
            }
            for (line, weight) in xs.iter().copied().filter(|(_, w)| *w > 0.0) {
                for j in along_y.clone() {
                    self.truss([[line, j, k], [line, j + 1, k]], share * weight * leg, TIES);
                }
            }
        }
    }

    /// Nodes of a section with their tributary shares.
    fn section_nodes(&mut self, layer: i32) -> Vec<(usize, f64)> {
        let span = |planes: &Planes, i: usize| {
            let low = planes.0[i.saturating_sub(1)];
            0.5 * (planes.0[(i + 1).min(planes.0.len() - 1)] - low)
        };
        let area = self.section.area_m2() * if self.mirror.is_some() { 0.5 } else { 1.0 };
        let mut nodes = Vec::new();
        for j in 0..self.y.0.len() {
            for i in 0..self.x.0.len() {
                let share = span(&self.x, i) * span(&self.y, j) / area;
                nodes.push((self.node([i as i32, j as i32, layer]), share));
            }
        }
        nodes
    }
}

/// Layers with ties above the end section, and the share of a tie in each: the first half a spacing above it.
fn tie_levels(z: &[f64], block: usize, spacing_m: f64) -> Vec<(i32, f64)> {
    let mut steel = vec![0.0; z.len()];
    let length = z[z.len() - 1];
    let mut at = 0.5 * spacing_m - SAME_M; // of two layers equally near the lower one
    while at < length {
        let k = (block..z.len()).min_by(|a, b| (z[*a] - at).abs().total_cmp(&(z[*b] - at).abs()));
        steel[k.unwrap_or(block)] += 1.0;
        at += spacing_m;
    }
    steel.iter().enumerate().filter(|(_, s)| **s > 0.0).map(|(k, s)| (k as i32, *s)).collect()
}

/// Share of what stands at a coordinate that belongs to the positive half.
fn share_of(at: f64) -> f64 {
    if at.abs() < SAME_M {
        0.5
    } else if at > 0.0 {
        1.0
    } else {
        0.0
    }
}

/// Laws of the mesh: concrete, block, bars, ties.
fn laws(section: &SectionInput, concrete: &ConcreteLaw) -> Vec<Law> {
    let member = Law::from(concrete.clone());
    let block = Law { concrete: None, ..member.clone() };
    let ties = section.ties.map_or(section.steel, |t| RebarLaw {
        youngs_modulus_pa: section.steel.youngs_modulus_pa,
        yield_strength_pa: t.yield_strength_pa,
        hardening: Hardening::Bilinear { ratio: TIE_HARDENING },
        ultimate_strain: t.ultimate_strain,
        loops: LoopShape::default(),
        buckling: None,
    });
    vec![member, block, section.steel.into(), ties.into()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::source::Source;
    use crate::rc::section_file::{EXAMPLE, read};

    /// Bars and what is left of the concrete fill the section, also in half of it.
    #[test]
    fn bars_displace_concrete() {
        let section = read(&Source::new("section.toml", EXAMPLE)).unwrap();
        let (input, concrete) = (&section.input, &section.concrete);
        let sizes_m = [section.length_m, 0.05];
        let whole = RcMember::new(input, concrete, Joint::Symmetry, sizes_m[0], sizes_m[1]).unwrap();
        let half = RcMember::half(input, concrete, Joint::Symmetry, sizes_m, 90.0).unwrap();
        for member in [whole, half] {
            let mesh = &member.mesh;
            let volume = |e: &Element| e.smear * volume_m3(&e.nodes.map(|n| mesh.nodes[n]));
            let found: f64 = mesh.elements.iter().map(volume).sum();
            let wanted = member.share * member.length_m * (input.area_m2() - section.steel_m2());
            assert!((found / wanted - 1.0).abs() < 1e-12, "{found} {wanted}");
            assert!(mesh.elements.iter().all(|e| e.smear > 0.5));
        }
    }
}
