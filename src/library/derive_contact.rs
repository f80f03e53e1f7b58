//! Entries for ends of members that strike something, computed by crushing a prism of the member ([`crate::rc::crushing`]).

use super::derive::{DeriveError, micrometres};
use super::entry::{
    Computed, Direction, Entry, EntryKind, Features, Inputs, LawFeatures, Origin, Quality, SpringLevel,
    SpringRecord, Validity,
};
use super::key::key_of;
use crate::base::hash::ContentHash;
use crate::building::Building;
use crate::building::ends::MemberEnd;
use crate::rc::crushing::{Crushing, Prism};
use std::collections::BTreeMap;

/// Version of the procedure; part of every key.
pub const CRUSHING_VERSION: u32 = 1;

/// The end of a member, described so that an entry for it can be looked up or computed. What adjoins it does not matter: the end has come off.
#[derive(Debug, Clone)]
pub struct WantedContact {
    /// Features for the query.
    pub features: Features,
    /// Everything the entry would be computed from.
    pub inputs: Inputs,
    /// The submodel.
    pub prism: Prism,
}

impl WantedContact {
    /// Describes a member end of a building.
    pub fn of(building: &Building, end: &MemberEnd) -> Self {
        let member = &building.members[end.member];
        let section = building.sections[&member.section].clone();
        let law = building.law_of(member).in_slow_motion();
        let size = member.solid.size();
        let mut sides = [1, 2].map(|i| micrometres(size[(end.axis + i) % 3]));
        sides.sort_by(f64::total_cmp);
        let prism = Prism {
            section_m: sides,
            length_m: micrometres(0.5 * end.clear_m),
            mesh_size_m: building.settings.mesh_size_m,
            law: law.clone(),
            strength: building.strength_factor(&member.id),
            friction: building.ground.friction,
        };
        let mut further = BTreeMap::new();
        if prism.strength != 1.0 {
            further.insert("strength_factor".to_string(), prism.strength);
        }
        let geometry = [("width_m", sides[0]), ("depth_m", sides[1]), ("length_m", prism.length_m)];
        let settings = [("mesh_size_m", prism.mesh_size_m), ("friction", prism.friction)];
        let features = Features {
            width_m: sides[0],
            depth_m: sides[1],
            length_to_inflection_m: Some(prism.length_m),
            end: None,
            adjoining: None,
            law: Some(LawFeatures::of(&section.law, &law)),
            mesh_size_m: Some(prism.mesh_size_m),
            rc: None,
            further,
        };
        let inputs = Inputs {
            law: Some(law),
            geometry: geometry.into_iter().map(|(name, value)| (name.to_string(), value)).collect(),
            settings: settings.into_iter().map(|(name, value)| (name.to_string(), value.into())).collect(),
            submodel_version: Some(CRUSHING_VERSION),
            ..Inputs::default()
        };
        Self { features, inputs, prism }
    }

    /// The key that an entry computed from these inputs has.
    ///
    /// # Errors
    /// If the inputs cannot be written as JSON.
    pub fn key(&self) -> Result<String, serde_json::Error> {
        Ok(key_of(EntryKind::ContactCrushing, &self.features, &ContentHash::of_value(&self.inputs)?))
    }

    /// Computes the entry.
    ///
    /// # Errors
    /// If the run does not stay finite.
    pub fn derive(&self) -> Result<Entry, DeriveError> {
        let crushed = self.prism.crush()?;
        let (features, inputs) = (self.features.clone(), self.inputs.clone());
        Ok(Entry::new(EntryKind::ContactCrushing, Origin::Submodel, features, inputs, computed(crushed))?)
    }
}

fn computed(crushed: Crushing) -> Computed {
    let Crushing { points, work_j, kinetic_share, elements } = crushed;
    let peak = points.iter().map(|p| p[1]).fold(0.0, f64::max);
    let half = points.iter().find(|p| p[1] >= 0.5 * peak).copied().unwrap_or([1.0, peak]);
    let reached = points.last().map_or(0.0, |p| p[0]);
    let level =
        SpringLevel { axial_force_n: 0.0, points, fracture_displacement_m: None, dissipated_j: Some(work_j) };
    Computed {
        springs: vec![SpringRecord {
            direction: Direction::Normal,
            stiffness_n_m: half[1] / half[0],
            levels: vec![level],
        }],
        compressive_capacity_n: Some(peak),
        quality: Quality {
            kinetic_energy_ratio: Some(kinetic_share),
            elements: Some(elements[0] as u64),
            ..Quality::default()
        },
        validity: Validity { displacement_m: Some([0.0, reached]), ..Validity::default() },
        ..Computed::default()
    }
}
