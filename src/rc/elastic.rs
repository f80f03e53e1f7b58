//! Elastic stiffness of a member end: the submodel of a pushover under small forces, solved statically. It costs milliseconds where the curves cost seconds.

use super::cut::EndModel;
use super::pushover::{chord_rotation, moved, section_moment, tip_center};
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::preload;

/// Force over the squash load of the section: small enough for nothing to yield.
const PROBE: f64 = 1e-3;

/// Stiffnesses of an end as a hinge has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticEnd {
    /// About axes 1 and 2, for rotations about the hinge \[N m/rad\].
    pub bending_nm_rad: [f64; 2],
    /// Along the member: half of it and the joint \[N/m\].
    pub axial_n_m: f64,
}

/// Stiffnesses of an end whose hinge stands `hinge_offset_m` from the end section.
///
/// # Errors
/// In words, if the submodel is a mechanism.
pub fn elastic(model: &EndModel, hinge_offset_m: f64) -> Result<ElasticEnd, String> {
    let element = &model.mesh.elements[model.section_elements[0]];
    let law = &model.mesh.laws[element.law];
    let first = law.hardening.first().map_or(0.0, |point| point.stress_pa);
    let force = PROBE * element.smear * element.strength * first * model.area_m2;
    let mut bending_nm_rad = [0.0; 2];
    for (bending, stiffness) in bending_nm_rad.iter_mut().enumerate() {
        // as in a push: rotation about `axis + 1` moves the tip along `axis + 2` and the other way round
        let direction = if bending == 0 { (model.axis + 2) % 3 } else { (model.axis + 1) % 3 };
        let (start, body) = under(model, direction, force)?;
        let point = [chord_rotation(model, &body, start, direction), section_moment(model, &body, direction)];
        let [[rotation, moment]] = moved(&[point], model.length_m, hinge_offset_m)[..] else {
            return Err("no rotation".into());
        };
        *stiffness = moment / rotation;
    }
    let (start, body) = under(model, model.axis, force)?;
    let axial_n_m = force / (tip_center(model, &body)[model.axis] - start[model.axis]).abs();
    Ok(ElasticEnd { bending_nm_rad, axial_n_m })
}

/// The submodel with a force at its far section, and where the centre of that was without.
fn under(model: &EndModel, direction: usize, force_n: f64) -> Result<([f64; 3], Dynamics), String> {
    let mut body = Dynamics::new(&model.mesh, 0.0, RigidSurfaces::default(), false);
    let start = tip_center(model, &body);
    for (n, share) in &model.tip_nodes {
        body.applied_n[*n][direction] = force_n * share;
    }
    preload::equilibrate(&mut body)?;
    Ok((start, body))
}
