//! A strip of a floor across a line at which it may fold: the piece of the global mesh from a clamped section on one side to the section without moment on the other.

use super::cut::{EndModel, tip_shares};
use super::pushover::{POLE_LIMIT_DEPTHS, Push, PushoverError, moved, push, torsion_constant};
use crate::base::median::median;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::fe::mesh::Mesh;
use crate::material::j2::HardeningTable;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Axial forces of the curves over the squash load `σ_y A` (compression positive): floors bear little of either.
pub const AXIAL_SHARES: [f64; 3] = [-0.1, 0.0, 0.1];

/// The curves of a line at which a floor may fold.
#[derive(Debug, Clone, PartialEq)]
pub struct StripCurves {
    /// Envelopes about the horizontal direction of the line, far side pushed downwards, by axial force.
    pub pushes: Vec<Push>,
    /// Distance of the hinge from the line, towards the far side \[m\].
    pub hinge_offset_m: f64,
    /// Axial stiffness of the strip \[N/m\].
    pub axial_stiffness_n_m: f64,
    /// Shear stiffness `G A_s / l` across the strip \[N/m\].
    pub shear_stiffness_n_m: f64,
    /// Torsional stiffness `G I_t / l` \[N m/rad\].
    pub torsional_stiffness_nm_rad: f64,
    /// Tension at which the section separates, and its plastic elongation then \[N, m\].
    pub tensile: [f64; 2],
    /// Difference of the peaks for both senses of rotation over their mean.
    pub asymmetry: f64,
}

/// Pushes the far side of a strip down, under some axial forces, and once up; `progress` is told after each push (done, all).
///
/// # Errors
/// If a push cannot be made.
pub fn derive_strip(
    model: &EndModel,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<StripCurves, PushoverError> {
    let sample = &model.mesh.elements[model.section_elements[0]];
    let law = &model.mesh.laws[sample.law];
    let table = HardeningTable::new(&law.hardening);
    // the area of a strip is what is filled of its elements
    let scale = sample.strength;
    let squash = scale * table.at(0.0).0 * model.area_m2;
    // rotation about `axis + 1` moves the far side along `axis + 2`
    let bending = usize::from(model.axis == 1);
    let mut jobs = AXIAL_SHARES.map(|share| (share * squash, -1.0)).to_vec();
    jobs.push((0.0, 1.0));
    let (done, all) = (AtomicUsize::new(0), jobs.len());
    let run = |(force, sense): &(f64, f64)| {
        let result = push(model, bending, *force, *sense, false);
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, all);
        result
    };
    let mut pushes: Vec<(Push, f64)> = jobs.par_iter().map(run).collect::<Result<_, _>>()?;
    let peak = |p: &Push| p.points.iter().map(|q| q[1]).fold(0.0, f64::max);
    let up = pushes.pop().map_or(0.0, |(p, _)| peak(&p));
    let down = peak(&pushes[1].0);
    let depth = model.section_m[1 - bending];
    let poles: Vec<f64> = pushes.iter().filter_map(|p| p.0.pole_m).collect();
    let hinge_offset_m = median(poles).clamp(0.0, POLE_LIMIT_DEPTHS * depth);
    let rupture = law.erosion.plastic_strain.min(law.erosion.principal_strain);
    let shear_modulus = 0.5 * law.youngs_modulus_pa / (1.0 + law.poisson_ratio);
    Ok(StripCurves {
        hinge_offset_m,
        axial_stiffness_n_m: pushes[2].1,
        shear_stiffness_n_m: shear_modulus * 5.0 / 6.0 * model.area_m2 / model.length_m,
        torsional_stiffness_nm_rad: shear_modulus * model.torsion_m4 / model.length_m,
        tensile: [scale * table.at(rupture).0 * model.area_m2, rupture * model.length_m],
        asymmetry: 2.0 * (up - down).abs() / (up + down),
        pushes: pushes
            .into_iter()
            .map(|(p, _)| Push { points: moved(&p.points, model.length_m, hinge_offset_m), ..p })
            .collect(),
    })
}

/// Where a strip lies.
#[derive(Debug, Clone, PartialEq)]
pub struct StripPlace {
    /// Direction along the strip: 0 or 1.
    pub axis: usize,
    /// Coordinate of the line \[m\].
    pub at_m: f64,
    /// +1 if the far side, whose half is bent, lies towards larger coordinates.
    pub outward: f64,
    /// How far the strip is kept on the clamped side, and where the far side's moment vanishes, from the line \[m\].
    pub near_m: f64,
    /// See `near_m`.
    pub far_m: f64,
    /// Range across the strip \[m\].
    pub across_m: [f64; 2],
}

impl EndModel {
    /// Cuts a strip of some members out of the building's mesh. `None` where they have no elements on both sides of the line.
    pub fn strip(mesh: &Mesh, members: &[usize], place: &StripPlace) -> Option<Self> {
        let (axis, other) = (place.axis, 1 - place.axis);
        let along = |c: [f64; 3]| place.outward * (c[axis] - place.at_m);
        let inside = |e: usize| {
            let c = mesh.center(e);
            members.contains(&mesh.elements[e].part)
                && c[other] > place.across_m[0]
                && c[other] < place.across_m[1]
        };
        let sides = (0..mesh.elements.len()).filter(|e| inside(*e));
        let far_side: Vec<usize> = sides.filter(|e| along(mesh.center(*e)) > 0.0).collect();
        let reached = far_side.iter().flat_map(|e| mesh.elements[*e].nodes).map(|n| along(mesh.nodes[n]));
        let length = far_section(reached, place.far_m)?;
        let far = place.at_m + place.outward * length;
        let (mut piece, old) = mesh.cut_out(|e| {
            let x = along(mesh.center(e));
            inside(e) && x > -place.near_m && x < length
        });
        piece.laws.iter_mut().for_each(|law| law.rate = None);
        let is_far = |e: &usize| along(piece.center(*e)) > 0.0;
        let (own, near): (Vec<usize>, Vec<usize>) = (0..piece.elements.len()).partition(is_far);
        if own.is_empty() || near.is_empty() {
            return None;
        }
        let depth = near.iter().flat_map(|e| piece.elements[*e].nodes).map(|n| along(piece.nodes[n]));
        let end = depth.fold(f64::INFINITY, f64::min);
        let on = |n: usize, x: f64| (along(piece.nodes[n]) - x).abs() < COORDINATE_TOLERANCE_M;
        let mut fixed: Vec<usize> = (0..old.len()).filter(|n| on(*n, end)).collect();
        let section_elements: Vec<usize> =
            own.iter().copied().filter(|e| piece.elements[*e].nodes.iter().any(|n| on(*n, 0.0))).collect();
        let mut section_nodes: Vec<usize> =
            section_elements.iter().flat_map(|e| piece.elements[*e].nodes).filter(|n| on(*n, 0.0)).collect();
        section_nodes.sort_unstable();
        section_nodes.dedup();
        let tip_nodes = tip_shares(&piece, &own, axis, far);
        if section_nodes.is_empty() || tip_nodes.is_empty() {
            return None;
        }
        piece.fixed.append(&mut fixed);
        piece.fixed.sort_unstable();
        piece.fixed.dedup();
        let faces = section_faces(&piece, &section_elements, axis);
        let area: f64 = faces.iter().map(Face::area).sum();
        let point = |i: usize| faces.iter().map(|f| f.area() * f.center(i)).sum::<f64>() / area;
        let mut point_m: [f64; 3] = std::array::from_fn(point);
        point_m[axis] = place.at_m;
        let span = |i: usize| {
            let of = |k: usize| faces.iter().map(move |f| f.range[i][k]);
            of(1).fold(f64::NEG_INFINITY, f64::max) - of(0).fold(f64::INFINITY, f64::min)
        };
        Some(Self {
            axis,
            outward: place.outward,
            point_m,
            length_m: length,
            section_m: [span((axis + 1) % 3), span((axis + 2) % 3)],
            area_m2: area,
            torsion_m4: torsion(&faces, axis),
            own_elements: own,
            section_nodes,
            section_elements,
            tip_nodes,
            opposite_nodes: Vec::new(),
            mesh: piece,
        })
    }
}

/// The section nearest to a distance from the line; of two as near the farther one, so that strips that are mirror images of each other are cut alike \[m\].
fn far_section(distances: impl Iterator<Item = f64>, wanted: f64) -> Option<f64> {
    let off = |d: f64| ((d - wanted).abs() / COORDINATE_TOLERANCE_M).round();
    distances
        .filter(|d| *d > COORDINATE_TOLERANCE_M)
        .min_by(|a, b| off(*a).total_cmp(&off(*b)).then(b.total_cmp(a)))
}

/// The face of an element in a section.
struct Face {
    part: usize,
    axis: usize,
    range: [[f64; 2]; 3],
    /// Share of it that is filled: a beam narrower than its elements.
    filled: f64,
}

impl Face {
    fn area(&self) -> f64 {
        let sides = (0..3).filter(|i| *i != self.axis).map(|i| self.range[i][1] - self.range[i][0]);
        self.filled * sides.product::<f64>()
    }

    fn center(&self, i: usize) -> f64 {
        0.5 * (self.range[i][0] + self.range[i][1])
    }
}

fn section_faces(mesh: &Mesh, elements: &[usize], axis: usize) -> Vec<Face> {
    let face = |e: &usize| {
        let nodes = mesh.elements[*e].nodes;
        let range = std::array::from_fn(|i| {
            let values = nodes.iter().map(|n| mesh.nodes[*n][i]);
            [values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max)]
        });
        Face { part: mesh.elements[*e].part, axis, range, filled: mesh.elements[*e].smear }
    };
    elements.iter().map(face).collect()
}

/// Torsion constant of an open section: the sum over the rectangles of its members (de Saint-Venant) \[m⁴\].
fn torsion(faces: &[Face], axis: usize) -> f64 {
    let mut parts: Vec<usize> = faces.iter().map(|f| f.part).collect();
    parts.sort_unstable();
    parts.dedup();
    let of = |part: &usize| {
        let span = |i: usize| {
            let own = |k: usize| faces.iter().filter(move |f| f.part == *part).map(move |f| f.range[i][k]);
            own(1).fold(f64::NEG_INFINITY, f64::max) - own(0).fold(f64::INFINITY, f64::min)
        };
        torsion_constant([span((axis + 1) % 3), span((axis + 2) % 3)])
    };
    parts.iter().map(of).sum()
}
