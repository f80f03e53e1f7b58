//! Rigid bodies from the building's solids: which members form one body, and its mass properties.

use crate::base::geom::Aabb;
use crate::building::partition::Partition;
use crate::building::{Building, MemberKind};
use crate::mbs::model::{Body, Origin, Shape};
use std::collections::BTreeMap;

/// Members of each rigid body. A column is a body of its own; plates and beams that share a face and whose merging
/// the rules allow are one.
///
/// `merges(a, b)` says whether two members may form one rigid body. The result lists member indices, sorted, bodies in the order of
/// their first member; members without own volume or cut away are left out.
pub fn clusters(
    partition: &Partition,
    members: &[bool],
    merges: impl Fn(usize, usize) -> bool,
) -> Vec<Vec<usize>> {
    let mut root: Vec<usize> = (0..members.len()).collect();
    fn find(root: &mut [usize], mut i: usize) -> usize {
        while root[i] != i {
            root[i] = root[root[i]];
            i = root[i];
        }
        i
    }
    for (a, b) in neighbours(partition) {
        if members[a] && members[b] && merges(a, b) {
            let (p, q) = (find(&mut root, a), find(&mut root, b));
            root[p.max(q)] = p.min(q);
        }
    }
    let owned: std::collections::BTreeSet<usize> = partition.cells().map(|(_, owner)| owner).collect();
    let mut bodies: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for member in owned.into_iter().filter(|m| members[*m]) {
        bodies.entry(find(&mut root, member)).or_default().push(member);
    }
    bodies.into_values().collect()
}

/// Pairs of members whose cells share a face, each once.
pub fn neighbours(partition: &Partition) -> std::collections::BTreeSet<(usize, usize)> {
    let count = partition.count();
    let mut pairs = std::collections::BTreeSet::new();
    for (cell, owner) in partition.cells() {
        for axis in 0..3 {
            let mut next = cell;
            next[axis] += 1;
            if next[axis] < count[axis]
                && let Some(other) = partition.owner_at(next)
                && other != owner
            {
                pairs.insert((owner.min(other), owner.max(other)));
            }
        }
    }
    pairs
}

/// The body of some members: mass, centre, inertia from their own volumes with the members' densities, and contact boxes.
pub fn body(building: &Building, partition: &Partition, members: &[usize], rules: Vec<String>) -> Body {
    let pieces: Vec<(Aabb, f64)> = members
        .iter()
        .flat_map(|m| {
            let density = building.law_of(&building.members[*m]).density_kg_m3;
            partition.boxes_of(*m).into_iter().map(move |b| (b, density))
        })
        .collect();
    let mass: f64 = pieces.iter().map(|(b, d)| b.volume() * d).sum();
    let center: [f64; 3] = std::array::from_fn(|i| {
        pieces.iter().map(|(b, d)| b.volume() * d * b.center()[i]).sum::<f64>() / mass
    });
    let mut inertia = [[0.0; 3]; 3];
    for (solid, density) in &pieces {
        let m = solid.volume() * density;
        let (size, at) = (solid.size(), solid.center());
        let r: [f64; 3] = std::array::from_fn(|i| at[i] - center[i]);
        let own: f64 = size.iter().map(|s| s * s).sum();
        let far: f64 = r.iter().map(|c| c * c).sum();
        for i in 0..3 {
            inertia[i][i] += m * ((own - size[i] * size[i]) / 12.0 + far);
            for j in 0..3 {
                inertia[i][j] -= m * r[i] * r[j];
            }
        }
    }
    let shapes = pieces
        .iter()
        .map(|(solid, _)| Shape {
            center_m: std::array::from_fn(|i| solid.center()[i] - center[i]),
            half_extents_m: solid.size().map(|s| 0.5 * s),
        })
        .collect();
    Body {
        id: name(building, members),
        mass_kg: mass,
        inertia_kg_m2: inertia,
        position_m: center,
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
