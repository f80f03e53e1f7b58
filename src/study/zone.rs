//! What an FE run shows in a zone of a member: when it deforms fast, how far it turns, when it breaks, and under which forces.

use super::{share, short};
use crate::building::Building;
use crate::fe::result::FeRun;
use crate::fe::section_force::{BrokenSection, SectionForce};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What the FE run shows at one member end, in elements of the member within [`super::END_DEPTHS`] section depths of the end, or at a line of a slab or a wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EndZone {
    /// Id of the member end or line.
    pub id: String,
    /// Member id.
    pub member: String,
    /// Centre of the end face or of the line, undeformed \[m\].
    pub point_m: [f64; 3],
    /// First time at which an element exceeded the critical strain rate \[s\]; `None`: the end stayed rigid.
    pub first_s: Option<f64>,
    /// Largest strain rate \[1/s\].
    pub peak_rate_1_s: f64,
    /// Largest plastic strain at the end of the run.
    pub plastic_strain: f64,
    /// Eroded share of the elements at the end of the run.
    pub eroded: f64,
    /// Time at which a whole layer of the member had eroded \[s\].
    pub fracture_s: Option<f64>,
    /// What this layer bore at the last output before its first element failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fracture_force: Option<SectionForce>,
    /// Largest angle by which bending takes the member off the joint behind the end, or one side of a line off the other, up to the first contact \[rad\]; `None`: too little is left of it at the end of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation_before_contact_rad: Option<f64>,
    /// The same over the whole run \[rad\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation_rad: Option<f64>,
}

/// Rotation from which an end counts as a hinge \[rad\]; the same order as the rotation capacity of reinforced
/// concrete in EN 1992-1-1, figure 5.6N.
pub const TURNED_RAD: f64 = 0.02;

impl EndZone {
    /// Whether the end has turned before the first contact; `None`: not known.
    ///
    /// A hinge is what turns. Of ends that turn slowly (0.02 rad in half a second are some 0.1 1/s in a zone two depths long) the strain rate knows nothing. Where too little is left of an end for a
    /// rotation, the time at which it exceeded the critical rate stands for it.
    pub fn turns_before(&self, contact_s: Option<f64>) -> Option<bool> {
        match self.rotation_before_contact_rad {
            Some(rotation) => Some(rotation > TURNED_RAD),
            None if self.eroded > 0.0 => {
                Some(self.first_s.is_some_and(|time| contact_s.is_none_or(|contact| time < contact)))
            }
            None => None,
        }
    }

    /// The same over the whole run; an end of which too little is left has broken.
    pub fn turns(&self) -> Option<bool> {
        match self.rotation_rad {
            Some(rotation) => Some(rotation > TURNED_RAD),
            None => (self.eroded > 0.0).then_some(true),
        }
    }
}

/// First time above the critical rate, peak rate and death time of each element.
pub(super) struct ElementHistory<'a> {
    pub first_s: &'a [Option<f64>],
    peak: &'a [f32],
    death_s: Vec<f64>,
    /// Which of the broken sections each is part of.
    broken: BTreeMap<usize, &'a BrokenSection>,
}

impl<'a> ElementHistory<'a> {
    pub(super) fn of(run: &'a FeRun) -> Self {
        let mut death_s = vec![f64::INFINITY; run.mesh.elements.len()];
        run.deaths.iter().for_each(|d| death_s[d.element] = death_s[d.element].min(d.time_s));
        let of_section = |s: &'a BrokenSection| s.elements.iter().map(move |e| (*e, s));
        let broken = run.broken.iter().flat_map(of_section).collect();
        Self { first_s: &run.strain_rates.first_s, peak: &run.strain_rates.peak_1_s, death_s, broken }
    }
}

/// Where a zone is.
pub(super) struct Place<'a> {
    pub id: &'a str,
    pub member: usize,
    pub axis: usize,
    pub point_m: [f64; 3],
}

/// What a run shows in the elements of a zone, but for its rotation.
pub(super) fn zone(
    building: &Building,
    run: &FeRun,
    history: &ElementHistory<'_>,
    place: &Place<'_>,
    elements: &[usize],
) -> EndZone {
    let largest = |f: &dyn Fn(usize) -> f64| elements.iter().map(|e| f(*e)).fold(0.0, f64::max);
    let first = elements.iter().filter_map(|e| history.first_s[*e]).fold(f64::INFINITY, f64::min);
    let mut layers = BTreeMap::<i64, (f64, usize)>::new();
    for e in elements {
        let at = (run.mesh.center(*e)[place.axis] * 1e6).round() as i64;
        let last = layers.entry(at).or_insert((0.0, *e));
        last.0 = last.0.max(history.death_s[*e]);
    }
    let fracture =
        layers.into_values().min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(time, _)| time.is_finite());
    EndZone {
        id: place.id.to_string(),
        member: building.members[place.member].id.clone(),
        point_m: place.point_m,
        first_s: first.is_finite().then_some(first),
        peak_rate_1_s: short(largest(&|e| f64::from(history.peak[e]))),
        plastic_strain: short(largest(&|e| run.plastic_strain[e])),
        eroded: share(elements, |e| history.death_s[e].is_finite()),
        fracture_s: fracture.map(|(time, _)| time),
        fracture_force: fracture
            .and_then(|(_, e)| history.broken.get(&e))
            .map(|section| section.force.rounded()),
        rotation_before_contact_rad: None,
        rotation_rad: None,
    }
}
