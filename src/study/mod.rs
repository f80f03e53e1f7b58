//! FE results in, facts out: which parts stay rigid, where zones of damage form and when, contact, fracture.
//!
//! Criterion of the seed paper, equation 2: a part is rigid while its strain rate stays below a critical value
//! (0.25 1/s there). The rate is that of the net strain over an output interval, so that elastic vibration
//! within it does not count.

pub mod floors;
mod lines;
pub mod plan;
pub mod record;
mod rotation;
mod zone;

pub use record::Study;
pub use zone::{EndZone, TURNED_RAD};

use crate::building::Building;
use crate::building::ends::{MemberEnd, member_ends};
use crate::building::partition::Partition;
use crate::fe::dynamics::Death;
use crate::fe::mesh::Mesh;
use crate::fe::result::{FeRun, Touch};
use lines::Elements;
use serde::{Deserialize, Serialize};
use zone::{ElementHistory, Place, zone};

/// What the FE run shows in a member away from its ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MemberFacts {
    /// Member id.
    pub member: String,
    /// Share of the member's elements (outside end zones) that never exceeded the critical rate before the first contact.
    pub rigid_share_before_contact: f64,
    /// The same over the whole run.
    pub rigid_share: f64,
}

/// Facts of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Facts {
    /// Critical strain rate used \[1/s\].
    pub critical_rate_1_s: f64,
    /// First ground contact \[s\].
    pub first_contact_s: Option<f64>,
    /// Zones at member ends, removed members left out.
    pub ends: Vec<EndZone>,
    /// Lines of slabs between columns, bases and tops of walls, removed members left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<EndZone>,
    /// Members.
    pub members: Vec<MemberFacts>,
    /// First contact of each member with ground and obstacles.
    pub contacts: Vec<Touch>,
    /// Whether the structure collapsed: a tracked point fell by more than [`COLLAPSE_DROP_M`].
    pub collapsed: bool,
}

/// Length of an end zone in section depths: plastic hinges of coarse meshes spread over two layers of elements.
pub const END_DEPTHS: f64 = 2.0;
/// Fall of a tracked point that counts as collapse \[m\].
pub const COLLAPSE_DROP_M: f64 = 1.0;

/// Whether a point with this history of displacements \[m\] falls far enough to count as collapsed.
pub fn fell(displacement_m: &[[f64; 3]]) -> bool {
    displacement_m.iter().any(|u| -u[2] > COLLAPSE_DROP_M)
}

/// Reads the facts out of a run.
pub fn facts(building: &Building, run: &FeRun) -> Facts {
    let removed: Vec<bool> = {
        let mut removed = vec![false; run.mesh.elements.len()];
        run.deaths.iter().filter(|d| d.cause == Death::Removed).for_each(|d| removed[d.element] = true);
        removed
    };
    let history = ElementHistory::of(run);
    let partition = Partition::of(building);
    let ends: Vec<MemberEnd> = member_ends(building, &partition);
    let contact = run.summary.first_ground_contact_s.unwrap_or(f64::INFINITY);
    let mut dead = vec![false; run.mesh.elements.len()];
    run.deaths.iter().for_each(|d| dead[d.element] = true);
    let mut in_end = vec![false; run.mesh.elements.len()];
    let mut zones = Vec::new();
    for end in &ends {
        let elements: Vec<usize> = end_zone(&run.mesh, end).filter(|e| !removed[*e]).collect();
        if elements.is_empty() {
            continue;
        }
        elements.iter().for_each(|e| in_end[*e] = true);
        let turned = rotation::turned(building, run, &dead, end, contact);
        let MemberEnd { member, axis, point_m, .. } = *end;
        let place = Place { id: &end.id, member, axis, point_m };
        zones.push(zone(building, run, &history, &place, &elements).turned(turned));
    }
    let members = (0..building.members.len())
        .filter_map(|part| {
            let own: Vec<usize> = (0..in_end.len())
                .filter(|e| run.mesh.elements[*e].part == part && !in_end[*e] && !removed[*e])
                .collect();
            let share = |until: f64| share(&own, |e| history.first_s[e].is_none_or(|t| t >= until));
            (!own.is_empty()).then(|| MemberFacts {
                member: building.members[part].id.clone(),
                rigid_share_before_contact: share(contact),
                rigid_share: share(f64::INFINITY),
            })
        })
        .collect();
    Facts {
        critical_rate_1_s: run.strain_rates.critical_1_s,
        first_contact_s: run.summary.first_ground_contact_s,
        ends: zones,
        lines: lines::zones(
            building,
            &partition,
            run,
            &history,
            &Elements { removed: &removed, dead: &dead },
            contact,
        ),
        members,
        contacts: run.touches.clone(),
        collapsed: run.tracked.iter().any(|h| fell(&h.displacement_m)),
    }
}

/// Share of elements of which something is true, rounded down: it is 1 if it is true of all.
fn share(elements: &[usize], is: impl Fn(usize) -> bool) -> f64 {
    let share = elements.iter().filter(|e| is(**e)).count() as f64 / elements.len() as f64;
    (1e4 * share).floor() / 1e4
}

/// Rounded, so that records are short.
fn short(value: f64) -> f64 {
    (1e4 * value).round() / 1e4
}

/// Elements of the member within [`END_DEPTHS`] section depths of its end.
pub fn end_zone<'a>(mesh: &'a Mesh, end: &'a MemberEnd) -> impl Iterator<Item = usize> + 'a {
    let near = move |e: &usize| {
        let along = (mesh.center(*e)[end.axis] - end.point_m[end.axis]) * end.outward;
        (0.0..(END_DEPTHS * end.depth_m).min(0.5 * end.clear_m)).contains(&along)
    };
    (0..mesh.elements.len()).filter(|e| mesh.elements[*e].part == end.member).filter(near)
}

/// The partition of the seed paper: elements that count as rigid for a whole run, by the facts of a study. Those are the ends that never
/// exceeded the critical rate, and of members away from their ends those in which no element did.
pub fn rigid_elements(building: &Building, mesh: &Mesh, facts: &Facts) -> Vec<bool> {
    let whole = |id: &str| facts.members.iter().any(|m| m.member == id && m.rigid_share >= 1.0);
    let quiet: Vec<bool> = building.members.iter().map(|member| whole(&member.id)).collect();
    let mut rigid: Vec<bool> = mesh.elements.iter().map(|element| quiet[element.part]).collect();
    for end in member_ends(building, &Partition::of(building)) {
        let zone = facts.ends.iter().find(|zone| zone.id == end.id);
        let still = zone.is_some_and(|zone| zone.first_s.is_none());
        end_zone(mesh, &end).for_each(|e| rigid[e] = still);
    }
    rigid
}
