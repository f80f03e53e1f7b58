//! Hinges at member ends with the curves of their library entries.

use super::GenerateError;
use super::bodies::Bodies;
use super::decide::Decision;
use super::entries::{Entries, Query, curve_id, hardening, left_under_compression};
use super::sections::slip;
use super::through::half_joint_m;
use crate::building::ends::MemberEnd;
use crate::building::partition::{COORDINATE_TOLERANCE_M, Partition};
use crate::building::{Building, Face, MemberKind};
use crate::curve::ResistanceCurve;
use crate::fe::mesh::Mesh;
use crate::library::StoreError;
use crate::library::derive::Wanted;
use crate::mbs::model::{Bending, Bushing, CarryOver, Origin};
use crate::rc::crushing::CRUSHED_SHARE;
use crate::rc::pushover::torsion_constant;
use std::collections::BTreeMap;

/// Share of a stump's length at which its hinge stands at most.
const IN_STUMP: f64 = 0.5;

/// What the joints are placed in.
pub struct Place<'a> {
    pub building: &'a Building,
    pub partition: &'a Partition,
    pub mesh: &'a Mesh,
    pub bodies: &'a Bodies,
}

/// What the entry of a column end is asked for, from a mesh around it.
///
/// # Errors
/// If it touches nothing, or lies elsewhere in the mesh.
pub fn query(place: &Place, mesh: &Mesh, end: &MemberEnd) -> Result<Query, GenerateError> {
    let wanted = Wanted::of(place.building, place.partition, mesh, end);
    wanted.map(Query::End).ok_or_else(|| without_section(mesh, end))
}

/// Why there is no section at a member end in the mesh.
fn without_section(mesh: &Mesh, end: &MemberEnd) -> GenerateError {
    let (id, at_m) = (end.id.clone(), end.point_m[end.axis]);
    let own = mesh.elements.iter().filter(|e| e.part == end.member).flat_map(|e| e.nodes);
    let off = |z: &f64| (z - at_m).abs();
    match own.map(|n| mesh.nodes[n][end.axis]).min_by(|a, b| off(a).total_cmp(&off(b))) {
        Some(mesh_m) if off(&mesh_m) > COORDINATE_TOLERANCE_M => {
            GenerateError::Moved { end: id, axis: ['x', 'y', 'z'][end.axis], at_m, mesh_m }
        }
        _ => GenerateError::Loose(id),
    }
}

/// Whether there is something that an end may be joined to: a body, or the ground.
pub fn is_joined(place: &Place, end: &MemberEnd) -> bool {
    let beyond = end.beyond(place.partition);
    let stands = || stands(place.building, end.member, (end.axis, end.point_m), beyond);
    beyond.and_then(|m| place.bodies.of(m, end.point_m)).is_some() || stands()
}

/// One joint for each hinged end.
pub fn hinges(
    place: &Place,
    ends: &[&MemberEnd],
    found: &Entries,
    decision: &Decision,
) -> Result<Vec<Bushing>, GenerateError> {
    let mut joints = Vec::new();
    for end in ends {
        let Some(own) = place.bodies.of(end.member, end.point_m) else { continue };
        let other = end.beyond(place.partition).and_then(|m| place.bodies.of(m, end.point_m));
        let key = &found.of_end[&end.id];
        let entry = found
            .entries
            .get(key)
            .ok_or_else(|| StoreError::NotFound { key: key.clone(), hint: String::new() })?;
        let hinge = entry.hinge()?;
        let is_elastic = decision.elastic.contains(&end.id);
        let bending = [0, 1].map(|axis| match entry.axes[axis].curve.stiffness_nm_rad {
            stiffness_nm_rad if is_elastic => Bending::Elastic { stiffness_nm_rad },
            _ => Bending::Curve { curve: curve_id(key, axis), strength_factor: 1.0 },
        });
        let half = Prism::of(place.building, end);
        // of a column in stumps what is left at this end, where it is less than half of it
        let left_m = place.bodies.stumps_of(end.member).and_then(|s| s.left_m(end));
        let left_m = left_m.map_or(half.length_m, |stump| stump.min(half.length_m));
        let at_most_m = if left_m < half.length_m { IN_STUMP * left_m } else { f64::INFINITY };
        let with_joint = Prism { length_m: half.length_m + half_joint_m(place, end), ..half };
        let law = place.building.law_of(&place.building.members[end.member]);
        // what does not yield neither breaks nor crushes
        let capacity = |capacity: Option<f64>| capacity.filter(|_| !is_elastic);
        let bearing_n = entry.bearing_capacity_n.filter(|_| !end.goes_on(place.building, place.partition));
        let crushes_n =
            entry.compressive_capacity_n.map(|most_n| bearing_n.map_or(most_n, |n| n.min(most_n)));
        let slips = slip(capacity(entry.tensile_capacity_n), capacity(entry.tensile_elongation_m));
        joints.push(Bushing {
            axial_stiffness_n_m: with_joint.axial_n_m(),
            shear_stiffness_n_m: hinge.stiffness.shear_n_m,
            torsional_stiffness_nm_rad: hinge.stiffness.torsion_nm_rad,
            bending,
            tensile_capacity_n: capacity(entry.tensile_capacity_n),
            tensile_elongation_m: capacity(entry.tensile_elongation_m),
            shear_capacity_n: slips.map(|u| u.0),
            shear_slip_m: slips.map(|u| u.1),
            compressive_capacity_n: capacity(crushes_n),
            compressive_hardening: capacity(entry.tensile_elongation_m)
                .map_or_else(Vec::new, |_| hardening(law, half.length_m)),
            compressive_fading: capacity(crushes_n)
                .map_or_else(Vec::new, |most_n| left_under_compression(entry, most_n)),
            crushing_shortening_m: capacity(entry.tensile_elongation_m)
                .map(|_| CRUSHED_SHARE * law.rupture_strain() * left_m),
            associated_flow: true,
            origin: Origin {
                members: vec![end.id.clone()],
                rules: decision.hinges[&end.id].clone(),
                entries: vec![key.clone()],
            },
            ..Bushing::free(
                end.id.clone(),
                other.map(|o| place.bodies.list[o].id.clone()),
                place.bodies.list[own].id.clone(),
                hinge_point(end, hinge.offset_m.min(at_most_m)),
                axes(end.axis, end.outward),
            )
        });
    }
    Ok(joints)
}

/// A stretch of a member, that from an end up to the middle of its clear length for instance.
pub struct Prism {
    pub length_m: f64,
    /// Across axes 1 and 2 of its joints \[m\].
    section_m: [f64; 2],
    /// Young's and shear modulus \[Pa\].
    moduli_pa: [f64; 2],
}

impl Prism {
    /// That at an end.
    fn of(building: &Building, end: &MemberEnd) -> Self {
        Self::along(building, end.member, end.axis, 0.5 * end.clear_m)
    }

    /// A length of a member along an axis \[m\].
    pub fn along(building: &Building, member: usize, axis: usize, length_m: f64) -> Self {
        let member = &building.members[member];
        let law = building.law_of(member);
        Self {
            length_m,
            section_m: [1, 2].map(|i| member.solid.size()[(axis + i) % 3]),
            moduli_pa: [law.youngs_modulus_pa, law.shear_modulus_pa()],
        }
    }

    /// Axial stiffness `E A / l` \[N/m\]. The submodel of an end has less, since its force goes into the floor around it: in a building it goes on to the next column, and what bends is the floor.
    pub fn axial_n_m(&self) -> f64 {
        self.moduli_pa[0] * self.section_m[0] * self.section_m[1] / self.length_m
    }

    /// Stiffness against rotation \[N m/rad\] about joint axis `k` under a force across in the middle, at a hinge so far from there \[m\]: `k = a² / (l³ / (3 E I) + l / (G A_s))`.
    fn turn_nm_rad(&self, k: usize, arm_m: f64) -> f64 {
        let bent = self.length_m.powi(3) / (3.0 * self.bending_nm2(k));
        arm_m * arm_m / (bent + self.length_m / self.shear_n())
    }

    /// Shear stiffness `G A_s` \[N\].
    pub fn shear_n(&self) -> f64 {
        5.0 / 6.0 * self.moduli_pa[1] * self.section_m[0] * self.section_m[1]
    }

    /// Torsional stiffness `G J` \[N m²\].
    pub fn torsion_nm2(&self) -> f64 {
        self.moduli_pa[1] * torsion_constant(self.section_m)
    }

    /// Bending stiffness about joint axis `k` \[N m²\].
    pub fn bending_nm2(&self, k: usize) -> f64 {
        self.moduli_pa[0] * self.section_m[k] * self.section_m[1 - k].powi(3) / 12.0
    }

    /// A bushing with the stiffnesses of its length along, across and in torsion.
    pub fn springs(&self, bushing: Bushing) -> Bushing {
        Bushing {
            axial_stiffness_n_m: self.axial_n_m(),
            shear_stiffness_n_m: [self.shear_n() / self.length_m; 2],
            torsional_stiffness_nm_rad: self.torsion_nm2() / self.length_m,
            ..bushing
        }
    }

    /// From a hinge to the middle \[m\].
    fn arm_m(&self, hinge: &Bushing, end: &MemberEnd) -> f64 {
        self.length_m - (hinge.point_m[end.axis] - end.point_m[end.axis]).abs()
    }
}

/// Takes the flexibility of a floor that bends out of the hinges of the columns at it: its own springs have that already. What is left is the column up to the middle of its clear length.
pub fn without_joint(
    place: &Place,
    ends: &[&MemberEnd],
    hinges: &mut [Bushing],
    curves: &mut BTreeMap<String, ResistanceCurve>,
) {
    let ends: BTreeMap<&str, &MemberEnd> = ends.iter().map(|e| (e.id.as_str(), *e)).collect();
    for hinge in hinges {
        let Some(end) = ends.get(hinge.id.as_str()) else { continue };
        let other = end.beyond(place.partition).and_then(|m| place.bodies.of(m, end.point_m));
        if !other.is_some_and(|o| place.bodies.is_bending(o)) {
            continue;
        }
        let half = Prism::of(place.building, end);
        let arm_m = half.arm_m(hinge, end);
        for k in 0..2 {
            let alone = half.turn_nm_rad(k, arm_m);
            match &mut hinge.bending[k] {
                Bending::Elastic { stiffness_nm_rad } => *stiffness_nm_rad = alone,
                Bending::Curve { curve, .. } => {
                    let id = format!("{curve}/{alone:.6e}");
                    if let Some(own) = curves.get(curve) {
                        let own = ResistanceCurve { stiffness_nm_rad: alone, ..own.clone() };
                        curves.insert(id.clone(), own);
                        *curve = id;
                    }
                }
            }
        }
    }
}

/// Lets columns bend between hinges at both of their ends: `d = (L / (2 E I) - 1 / k) / 2`, with which both ends turn by `M L / (2 E I)` in pure bending, and by `M / k` in sway as they did.
pub fn carry_over(place: &Place, ends: &[&MemberEnd], hinges: &mut [Bushing]) {
    let mut first: BTreeMap<usize, usize> = BTreeMap::new();
    let ends: BTreeMap<&str, &MemberEnd> = ends.iter().map(|e| (e.id.as_str(), *e)).collect();
    for i in 0..hinges.len() {
        let Some(end) = ends.get(hinges[i].id.as_str()) else { continue };
        let Some(other) = first.insert(end.member, i) else { continue };
        if place.bodies.stumps_of(end.member).is_some() {
            continue;
        }
        let own = place.bodies.all_of(end.member);
        let is_own = |h: &Bushing| own.iter().any(|b| place.bodies.list[*b].id == h.body_b);
        if ![other, i].iter().all(|k| is_own(&hinges[*k])) {
            continue;
        }
        let half = Prism::of(place.building, end);
        let arms_m = [(&hinges[i], *end), (&hinges[other], ends[hinges[other].id.as_str()])]
            .map(|(hinge, end)| half.arm_m(hinge, end));
        let flexibility_rad_nm = [0, 1].map(|k| {
            let turns = |arm_m: f64| 1.0 / half.turn_nm_rad(k, arm_m);
            let bent = half.length_m / half.bending_nm2(k) - 0.5 * (turns(arms_m[0]) + turns(arms_m[1]));
            // a member so short that it shears more than it bends carries nothing over
            (0.5 * bent).max(0.0)
        });
        let bushing = hinges[other].id.clone();
        hinges[i].carry_over = Some(CarryOver { bushing, flexibility_rad_nm });
    }
}

/// The hinge stands inside the member, where the library found its pole \[m\].
fn hinge_point(end: &MemberEnd, offset_m: f64) -> [f64; 3] {
    let mut point = end.point_m;
    point[end.axis] += end.outward * offset_m;
    point
}

/// Joint axes of a member along `axis` that extends to larger coordinates (`outward` +1) or smaller ones: axis 0 points from the other body into the member, so that a positive axial
/// displacement is tension; axes 1 and 2 follow the section's directions, turned to stay right-handed.
pub fn axes(axis: usize, outward: f64) -> [[f64; 3]; 3] {
    let unit = |i: usize, sign: f64| {
        let mut e = [0.0; 3];
        e[i] = sign;
        e
    };
    [unit(axis, outward), unit((axis + 1) % 3, 1.0), unit((axis + 2) % 3, outward)]
}

/// Whether a member is a footing that is held: it does not move, and what stands on it stands on the ground until a charge takes it.
pub fn is_ground(building: &Building, member: usize) -> bool {
    let member = &building.members[member];
    member.kind == MemberKind::Footing
        && !building.is_cut(&member.id)
        && building.supports.iter().any(|s| s.member == member.id)
}

/// Whether a member stands at its end, along an axis at a place, on the ground: on a support of its own, or on a footing that is held.
pub fn stands(
    building: &Building,
    member: usize,
    (axis, point_m): (usize, [f64; 3]),
    beyond: Option<usize>,
) -> bool {
    axis == 2 && on_support(building, member, point_m[2]) || beyond.is_some_and(|m| is_ground(building, m))
}

/// Whether a member stands on, or hangs from, a supported face at a level.
fn on_support(building: &Building, member: usize, level_m: f64) -> bool {
    let member = &building.members[member];
    building.supports.iter().filter(|s| s.member == member.id).any(|s| {
        let z = match s.face {
            Face::Bottom => member.solid.min[2],
            Face::Top => member.solid.max[2],
        };
        (level_m - z).abs() < 1e-6
    })
}
