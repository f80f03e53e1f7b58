//! Walls between floors: rigid plates on elastic springs at foot and head.
//!
//! A wall storey of height `h` is as stiff as half of its height at either end: `E A / (h/2)`, `G A_s / (h/2)` and, about its own plane, `E I / (h/2)`. Each end has two springs, in the middles of its halves, which bear the
//! moment in its plane as a couple. Walls neither crack nor crush here; the note says so.

use super::bodies::Bodies;
use super::joints::{axes, on_support};
use crate::base::geom::Aabb;
use crate::building::{Building, MemberKind};
use crate::graph::Structure;
use crate::mbs::model::{Bending, Bushing, Origin};

/// How far beyond an end its neighbour is looked for \[m\].
const BEYOND_M: f64 = 1e-4;

/// The springs of all walls that are bodies of their own.
pub fn springs(building: &Building, structure: &Structure, bodies: &Bodies) -> Vec<Bushing> {
    let walls = building.members.iter().enumerate().filter(|(_, m)| m.kind == MemberKind::Wall);
    walls.flat_map(|(wall, _)| of_wall(building, structure, bodies, wall)).collect()
}

fn of_wall(building: &Building, structure: &Structure, bodies: &Bodies, wall: usize) -> Vec<Bushing> {
    let mut list = Vec::new();
    let own = structure.boxes(wall);
    let Some(solid) = own.iter().copied().reduce(around) else { return list };
    let size = solid.size();
    let along = usize::from(size[1] > size[0]);
    for (end, name) in [(0, "bottom"), (1, "top")] {
        for half in 0..2 {
            let mut point_m = solid.center();
            point_m[along] = solid.min[along] + (0.25 + 0.5 * half as f64) * size[along];
            point_m[2] = if end == 0 { solid.min[2] } else { solid.max[2] };
            let mut outside = point_m;
            outside[2] += if end == 0 { -BEYOND_M } else { BEYOND_M };
            let next = structure.partition.member_at(outside);
            let other = next.and_then(|member| bodies.of(member, outside));
            let Some(body) = bodies.of(wall, point_m) else { continue };
            if other.is_none() && !on_support(building, wall, point_m[2]) || other == Some(body) {
                continue;
            }
            let id = format!("{}.{name}-{}", building.members[wall].id, half + 1);
            list.push(spring(building, bodies, wall, [other, Some(body)], (id, point_m, &solid, along)));
        }
    }
    list
}

fn spring(
    building: &Building,
    bodies: &Bodies,
    wall: usize,
    [other, own]: [Option<usize>; 2],
    (id, point_m, solid, along): (String, [f64; 3], &Aabb, usize),
) -> Bushing {
    let law = building.law_of(&building.members[wall]);
    let size = solid.size();
    // one half of the length, half of the height
    let (length, thickness, height) = (0.5 * size[along], size[1 - along], 0.5 * size[2]);
    let area = length * thickness;
    let shear = 5.0 / 6.0 * area * law.shear_modulus_pa() / height;
    let about =
        |inertia: f64| Bending::Elastic { stiffness_nm_rad: law.youngs_modulus_pa * inertia / height };
    let out_of_plane = about(length * thickness.powi(3) / 12.0);
    let in_plane = about(thickness * length.powi(3) / 12.0);
    let torsion = law.shear_modulus_pa() * length * thickness.powi(3) / 3.0 / height;
    let name = |i: usize| bodies.list[i].id.clone();
    let own = own.map(name).unwrap_or_default();
    Bushing {
        id,
        body_a: other.map(name),
        body_b: own.clone(),
        point_m,
        // axes 1 and 2 are x and y: bending about x is out of the plane of a wall along x
        axes: axes(2, 1.0),
        axial_stiffness_n_m: law.youngs_modulus_pa * area / height,
        shear_stiffness_n_m: [shear; 2],
        torsional_stiffness_nm_rad: torsion,
        bending: if along == 0 { [out_of_plane, in_plane] } else { [in_plane, out_of_plane] },
        joint: None,
        latent: None,
        tensile_capacity_n: None,
        tensile_elongation_m: None,
        compressive_capacity_n: None,
        origin: Origin {
            members: vec![building.members[wall].id.clone()],
            rules: bodies.list.iter().find(|b| b.id == own).map_or(Vec::new(), |b| b.origin.rules.clone()),
            entries: Vec::new(),
        },
    }
}

/// The box around two.
fn around(a: Aabb, b: Aabb) -> Aabb {
    Aabb {
        min: std::array::from_fn(|i| a.min[i].min(b.min[i])),
        max: std::array::from_fn(|i| a.max[i].max(b.max[i])),
    }
}
