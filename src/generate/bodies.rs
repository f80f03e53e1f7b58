//! Rigid bodies from sets of members.

use crate::building::partition::merged;
use crate::building::{Building, MemberKind};
use crate::graph::Structure;
use crate::mbs::model::{Body, Origin, Shape};

/// The body of some members: mass, centre, inertia from their own volumes, and contact boxes.
pub fn body(building: &Building, structure: &Structure, members: &[usize], rules: Vec<String>) -> Body {
    let mass = structure.mass_of(members);
    let shapes = members
        .iter()
        .flat_map(|m| merged(structure.boxes(*m)))
        .map(|solid| {
            let center_m = std::array::from_fn(|i| solid.center()[i] - mass.center_m[i]);
            Shape::cuboid(center_m, solid.size().map(|s| 0.5 * s))
        })
        .collect();
    Body {
        id: name(building, members),
        mass_kg: mass.mass_kg,
        inertia_kg_m2: mass.inertia_kg_m2,
        position_m: mass.center_m,
        orientation: [1.0, 0.0, 0.0, 0.0],
        velocity_m_s: [0.0; 3],
        angular_velocity_rad_s: [0.0; 3],
        shapes,
        origin: Origin {
            members: members.iter().map(|m| building.members[*m].id.clone()).collect(),
            rules,
            entries: Vec::new(),
        },
    }
}

/// A body is called after its plate, or after its first member.
fn name(building: &Building, members: &[usize]) -> String {
    let plate = |m: &&usize| !matches!(building.members[**m].kind, MemberKind::Beam | MemberKind::Column);
    let index = members.iter().find(plate).unwrap_or(&members[0]);
    building.members[*index].id.clone()
}
