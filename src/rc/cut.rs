//! Cuts the piece of mesh around a member end.

use super::pushover::torsion_constant;
use crate::building::ends::End;
use crate::building::partition::{COORDINATE_TOLERANCE_M, Partition};
use crate::building::tracked::clear_range;
use crate::building::{Building, Member, MemberKind};
use crate::fe::mesh::Mesh;

/// How far the adjoining members are kept around the end, in member depths. Beyond it they count as rigid in the MBS too.
pub const REACH_DEPTHS: f64 = 2.5;

/// The piece of mesh around a member end, from the clamped cut through the adjoining members to the
/// section where the bending moment of the member is taken to vanish.
#[derive(Debug, Clone)]
pub struct EndModel {
    /// The mesh; its fixed nodes are supports and the cut.
    pub mesh: Mesh,
    /// Axis of the member: 0, 1 or 2.
    pub axis: usize,
    /// +1 if the member extends towards larger coordinates from this end.
    pub outward: f64,
    /// Centre of the end section \[m\].
    pub point_m: [f64; 3],
    /// Distance from the end section to the section without moment \[m\].
    pub length_m: f64,
    /// Section size in the directions `axis + 1` and `axis + 2` \[m\].
    pub section_m: [f64; 2],
    /// Its area (of a strip: as far as its elements are filled) \[m²\] and torsion constant \[m⁴\].
    pub area_m2: f64,
    /// See `area_m2`.
    pub torsion_m4: f64,
    /// Elements beyond the end section.
    pub own_elements: Vec<usize>,
    /// Nodes of the end section.
    pub section_nodes: Vec<usize>,
    /// Elements of the member that touch the end section.
    pub section_elements: Vec<usize>,
    /// Nodes of the far section with the share of its area that each carries.
    pub tip_nodes: Vec<(usize, f64)>,
    /// The same of the face of the joint opposite the end, within its section: there a column that goes on bears what this one does. Empty if nothing lies beyond the end.
    pub opposite_nodes: Vec<(usize, f64)>,
}

impl EndModel {
    /// Cuts the end of a column out of the building's mesh. `None` for a member without own volume.
    ///
    /// The far section is the element face nearest to the middle of the clear length: in a frame that sways, columns bend in
    /// double curvature and their moment vanishes near the middle.
    pub fn cut(building: &Building, mesh: &Mesh, member: &str, end: End) -> Option<Self> {
        let part = building.members.iter().position(|m| m.id == member)?;
        Self::cut_from(building, &Partition::of(building), mesh, part, end)
    }

    /// The same of a member with a number, where the building's partition is at hand.
    pub fn cut_from(
        building: &Building,
        partition: &Partition,
        mesh: &Mesh,
        part: usize,
        end: End,
    ) -> Option<Self> {
        let owner = &building.members[part];
        let axis = owner.axis;
        let [low, high] = clear_range(partition, part, axis)?;
        let (at, outward) = match end {
            End::Lower => (low, 1.0),
            End::Upper => (high, -1.0),
        };
        let mut point_m = owner.solid.center();
        point_m[axis] = at;
        let own = mesh.elements.iter().filter(|e| e.part == part).flat_map(|e| e.nodes);
        let far = far_plane(own.map(|n| mesh.nodes[n][axis]), 0.5 * (low + high));
        let keep = kept_elements(building, mesh, part, owner, point_m, far, outward);
        let (mut piece, old) = mesh.cut_out(|e| keep[e]);
        clamp_cut(mesh, &keep, part, &old, &mut piece);
        // The push is quasi-static: its speed is one of the computation, no rate effect belongs to it.
        piece.laws.iter_mut().for_each(|law| law.rate = None);
        let on = |n: &usize, plane: f64| (piece.nodes[*n][axis] - plane).abs() < COORDINATE_TOLERANCE_M;
        let own: Vec<usize> = (0..piece.elements.len()).filter(|e| piece.elements[*e].part == part).collect();
        let mut section_nodes: Vec<usize> =
            own.iter().flat_map(|e| piece.elements[*e].nodes).filter(|n| on(n, at)).collect();
        section_nodes.sort_unstable();
        section_nodes.dedup();
        let section_elements =
            own.iter().copied().filter(|e| piece.elements[*e].nodes.iter().any(|n| on(n, at))).collect();
        let tip_nodes = tip_shares(&piece, &own, axis, far);
        let opposite_nodes = opposite_shares(&piece, part, owner, point_m, outward);
        let across: [f64; 2] = std::array::from_fn(|i| {
            let other = (axis + 1 + i) % 3;
            owner.solid.size()[other]
        });
        Some(Self {
            axis,
            outward,
            point_m,
            length_m: (far - at).abs(),
            section_m: across,
            area_m2: across[0] * across[1],
            torsion_m4: torsion_constant(across),
            own_elements: own,
            section_nodes,
            section_elements,
            tip_nodes,
            opposite_nodes,
            mesh: piece,
        })
    }

    /// A description of the piece that is the same for ends that are mirror images of each other: sorted element boxes
    /// relative to the end section, in the smallest of the four reflections, with smear and strength factors.
    pub fn canonical_geometry(&self) -> Vec<[i64; 8]> {
        let (p, q) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let boxes = |signs: [f64; 2]| -> Vec<[i64; 8]> {
            let mut all: Vec<[i64; 8]> = (0..self.mesh.elements.len())
                .map(|e| {
                    let element = &self.mesh.elements[e];
                    let turned = element.nodes.map(|n| {
                        let r: [f64; 3] = std::array::from_fn(|i| self.mesh.nodes[n][i] - self.point_m[i]);
                        [self.outward * r[self.axis], signs[0] * r[p], signs[1] * r[q]]
                    });
                    let micrometres = |v: f64| (v * 1e6).round() as i64;
                    let low =
                        |i: usize| micrometres(turned.iter().map(|t| t[i]).fold(f64::INFINITY, f64::min));
                    let high =
                        |i: usize| micrometres(turned.iter().map(|t| t[i]).fold(f64::NEG_INFINITY, f64::max));
                    let factors = (micrometres(element.smear), micrometres(element.strength));
                    [low(0), high(0), low(1), high(1), low(2), high(2), factors.0, factors.1]
                })
                .collect();
            all.sort_unstable();
            all
        };
        [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(boxes).into_iter().min().unwrap_or_default()
    }
}

/// The coordinate nearest to one in the middle of a member.
fn far_plane(coordinates: impl Iterator<Item = f64>, middle: f64) -> f64 {
    coordinates.min_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs())).unwrap_or(middle)
}

/// The member's elements up to the far section, and elements of adjoining plates and beams within reach; where there are none, those of the columns on or under it.
fn kept_elements(
    building: &Building,
    mesh: &Mesh,
    part: usize,
    owner: &Member,
    point: [f64; 3],
    far: f64,
    outward: f64,
) -> Vec<bool> {
    let depth = (0..3).filter(|i| *i != owner.axis).map(|i| owner.solid.size()[i]).fold(0.0, f64::max);
    let is_near = |e: usize| {
        let c = mesh.center(e);
        (0..3).all(|i| (c[i] - point[i]).abs() < REACH_DEPTHS * depth)
    };
    let is_column = |e: usize| building.members[mesh.elements[e].part].kind == MemberKind::Column;
    let mut section = owner.solid;
    (section.min[owner.axis], section.max[owner.axis]) = (point[owner.axis], point[owner.axis]);
    let in_line =
        |e: usize| building.members[mesh.elements[e].part].solid.is_nearer(&section, COORDINATE_TOLERANCE_M);
    let other = |e: usize| mesh.elements[e].part != part && is_near(e) && (!is_column(e) || in_line(e));
    let elements = 0..mesh.elements.len();
    let adjoins =
        |of_columns: bool| elements.clone().any(|e| other(e) && is_column(e) == of_columns && in_line(e));
    let on_columns = adjoins(true) && !adjoins(false);
    let kept = |e: usize| match mesh.elements[e].part == part {
        true => (mesh.center(e)[owner.axis] - far) * outward < 0.0,
        // what does not touch the end hangs on nothing once the columns are between
        false => other(e) && (is_column(e) == on_columns),
    };
    elements.clone().map(kept).collect()
}

/// Fixes the nodes through which the kept adjoining elements hang on elements that were left out.
fn clamp_cut(mesh: &Mesh, keep: &[bool], part: usize, old: &[usize], piece: &mut Mesh) {
    let mut on_rest = vec![false; mesh.nodes.len()];
    let mut cut_through = vec![false; mesh.parts.len()];
    for (element, _) in mesh.elements.iter().zip(keep).filter(|(_, kept)| **kept) {
        cut_through[element.part] = true;
    }
    for (element, _) in mesh.elements.iter().zip(keep).filter(|(_, kept)| !**kept) {
        // the rest of the member itself is the free far section; other columns at the joint do not hold it
        if element.part != part && cut_through[element.part] {
            element.nodes.iter().for_each(|n| on_rest[*n] = true);
        }
    }
    for (new, was) in old.iter().enumerate() {
        if on_rest[*was] && !piece.fixed.contains(&new) {
            piece.fixed.push(new);
        }
    }
}

/// Nodes of the face at which the solid beyond an end ends, within the section of the member, with their share of the area.
fn opposite_shares(
    mesh: &Mesh,
    part: usize,
    owner: &Member,
    point: [f64; 3],
    outward: f64,
) -> Vec<(usize, f64)> {
    let axis = owner.axis;
    let is_within = |p: [f64; 3]| {
        (0..3).all(|i| (p[i] - point[i]).abs() < 0.5 * owner.solid.size()[i] || i == axis)
            && (p[axis] - point[axis]) * outward < 0.0
    };
    let joint: Vec<usize> = (0..mesh.elements.len())
        .filter(|e| mesh.elements[*e].part != part && is_within(mesh.center(*e)))
        .collect();
    let away = |n: &usize| -outward * mesh.nodes[*n][axis];
    let nodes = joint.iter().flat_map(|e| mesh.elements[*e].nodes);
    let Some(last) = nodes.max_by(|a, b| away(a).total_cmp(&away(b))) else { return Vec::new() };
    tip_shares(mesh, &joint, axis, mesh.nodes[last][axis])
}

/// Nodes of the far section with their share of the area.
pub(super) fn tip_shares(mesh: &Mesh, own: &[usize], axis: usize, far: f64) -> Vec<(usize, f64)> {
    let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut shares = std::collections::BTreeMap::new();
    for e in own {
        let nodes: Vec<usize> = mesh.elements[*e]
            .nodes
            .into_iter()
            .filter(|n| (mesh.nodes[*n][axis] - far).abs() < COORDINATE_TOLERANCE_M)
            .collect();
        if nodes.len() != 4 {
            continue;
        }
        let span = |i: usize| {
            let values = nodes.iter().map(|n| mesh.nodes[*n][i]);
            values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
        };
        for n in &nodes {
            *shares.entry(*n).or_insert(0.0) += 0.25 * span(p) * span(q);
        }
    }
    let total: f64 = shares.values().sum();
    shares.into_iter().map(|(n, s)| (n, s / total)).collect()
}
