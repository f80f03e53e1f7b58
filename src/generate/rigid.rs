//! Elements of an FE mesh that move as rigid bodies by what the rules say, for FE runs with rigid parts.

use crate::building::Building;
use crate::building::ends::member_ends;
use crate::building::partition::Partition;
use crate::fe::mesh::Mesh;
use crate::mbs::model::{Bending, Model};
use crate::study::end_zone;
use std::collections::BTreeSet;

/// The partition that a generated model is: elements of members that are rigid bodies of it, or parts of such, but not those at member ends with a hinge, as far as a study counts them to the end.
///
/// `true` for each element of the mesh that may be rigid. Floors that bend in the model are pieces on springs, whose elements deform: models of `--accuracy fast` have none.
pub fn rigid_elements(building: &Building, mesh: &Mesh, model: &Model) -> Vec<bool> {
    let bends: BTreeSet<&String> = model.shared_masses.iter().flat_map(|s| &s.bodies).collect();
    let bodies = model.bodies.iter().filter(|b| !bends.contains(&b.id));
    let rigid: BTreeSet<&String> = bodies.flat_map(|b| &b.origin.members).collect();
    // of a beam that may break away the webs are bodies of their own
    let bodies = model.bodies.iter().filter(|b| bends.contains(&b.id));
    let deforming: BTreeSet<&String> = bodies.flat_map(|b| &b.origin.members).collect();
    let hinged = |b: &&crate::mbs::model::Bushing| {
        b.latent.is_none() && b.bending.iter().any(|k| matches!(k, Bending::Curve { .. }))
    };
    let hinges: BTreeSet<&String> = model.bushings.iter().filter(hinged).map(|b| &b.id).collect();
    let is_rigid: Vec<bool> =
        building.members.iter().map(|m| rigid.contains(&m.id) && !deforming.contains(&m.id)).collect();
    let mut elements: Vec<bool> = mesh.elements.iter().map(|e| is_rigid[e.part]).collect();
    for end in member_ends(building, &Partition::of(building)) {
        if hinges.contains(&end.id) {
            end_zone(mesh, &end).for_each(|e| elements[e] = false);
        }
    }
    elements
}
