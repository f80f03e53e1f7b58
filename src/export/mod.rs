//! Model files as text of other programs: MJCF (MuJoCo), Adams datasets, and the model's own JSON.
//!
//! No other format holds all that a model file says. What an export leaves out or changes is listed by id ([`Note`]), in the result and at
//! the head of the text.
//!
//! | file | owns |
//! |---|---|
//! | this one | targets, notes, events at time zero |
//! | [`json`] | the model's own form, normalised |
//! | [`mjcf`] | MuJoCo |
//! | [`adams`] | MSC Adams |
//! | `number` | decimals without exponents, names |
//! | `backbone` | hinge laws as moment over rotation |

pub mod adams;
mod backbone;
pub mod json;
pub mod mjcf;
mod number;

use crate::mbs::Model;
use crate::mbs::ideal::start::fitting_velocities;
use crate::mbs::model::{Bending, Bushing, Event, Force};
use std::collections::BTreeSet;

/// What both exports say of a member that bends between two bushings.
const NOTHING_CARRIED_OVER: &str =
    "what the ends of its member carry over to each other is left out: it is stiffer in pure bending";
/// What both exports say of a bushing in the middle of a beam.
const BEAM_STAYS_ELASTIC: &str = "the hinges at the ends of its beam are left out: it stays elastic";

/// What to write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// MuJoCo's XML.
    Mjcf {
        /// Whether joints that may open are equality constraints, which a program can switch off, instead of parts of the tree.
        loose: bool,
    },
    /// A dataset of Adams Solver.
    Adams,
    /// The model's own JSON.
    Json,
}

/// Something that an export leaves out or changes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// Id of the part, or the name of the section.
    pub id: String,
    /// What does not come across.
    pub text: String,
}

/// The text, and what is not in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// The file's content.
    pub text: String,
    /// What it leaves out or changes.
    pub notes: Vec<Note>,
}

/// Notes gathered on the way.
#[derive(Debug, Default)]
struct Notes(Vec<Note>);

impl Notes {
    fn add(&mut self, id: &str, text: impl Into<String>) {
        self.0.push(Note { id: id.into(), text: text.into() });
    }

    /// What of a bushing neither program has.
    fn add_of_bushing(&mut self, bushing: &Bushing) {
        let left_out = [
            (bushing.tensile_capacity_n.is_some(), "the tensile capacity is left out: it does not separate"),
            (
                bushing.shear_capacity_n.is_some(),
                "the shear capacity is left out: it neither slips nor separates",
            ),
            (
                bushing.compressive_capacity_n.is_some(),
                "the compressive capacity is left out: it does not crush",
            ),
            (
                bushing.rate_factor.is_some(),
                "the rate factor is left out: it bears as much as in slow motion",
            ),
            (
                bushing.associated_flow && bushing.bending.iter().any(|b| b.curve().is_some()),
                "normality is left out: its hinge neither lengthens nor shortens as it flows",
            ),
            (bushing.carry_over.is_some(), NOTHING_CARRIED_OVER),
            (
                bushing.latent.is_some(),
                "it is latent here, rigid until it is overloaded, and live from the start there",
            ),
        ];
        for (_, text) in left_out.into_iter().filter(|(is_there, _)| *is_there) {
            self.add(&bushing.id, text);
        }
    }
}

/// Writes a model that has been checked.
///
/// # Errors
/// In words, if a number cannot be written.
pub fn export(model: &Model, target: Target) -> Result<Exported, String> {
    let mut notes = Notes::default();
    let text = match target {
        Target::Json => json::write(model)?,
        Target::Mjcf { loose } => mjcf::write(&at_start(model, &mut notes), loose, &mut notes),
        Target::Adams => adams::write(&at_start(model, &mut notes), &mut notes),
    };
    Ok(Exported { text, notes: notes.0 })
}

/// The model just after time zero: what events then remove, release or weaken is done; later ones stay and are noted.
fn at_start(model: &Model, notes: &mut Notes) -> Model {
    let mut m = model.clone();
    for event in &model.events {
        if event.time_s > 0.0 {
            notes.add(&event.id, format!("the event at {} s is left out", number::plain(event.time_s)));
        } else {
            happen(&mut m, event);
        }
    }
    m.events.retain(|e| e.time_s > 0.0);
    if let Ok(Some(fitting)) = fitting_velocities(&m) {
        for (body, [v, w]) in m.bodies.iter_mut().zip(fitting) {
            (body.velocity_m_s, body.angular_velocity_rad_s) = (v, w);
        }
        notes.add(
            "bodies",
            "initial velocities do not fit the joints: written are the nearest ones that do, with which `simulate` runs",
        );
    }
    for joint in &mut m.joints {
        if let Some(across) = joint.squared_axis_b() {
            joint.axis_b = Some(across);
            notes.add(
                &joint.id,
                "axis_b is not quite at a right angle to axis: its part across it is written",
            );
        }
    }
    for shared in &m.shared_masses {
        let first = shared.bodies.first().map_or("shared_masses", String::as_str);
        notes.add(first, "inertia that it has together with others (shared_masses) is left out: spans are as heavy as rigid halves");
    }
    for rule in std::mem::take(&mut m.event_rules) {
        notes.add(&rule.id, "the rule about contacts or fractures is left out");
    }
    for face in &m.contact.crushing {
        notes.add(&face.body, "crushing of its faces is left out: contacts are rigid there");
    }
    if m.contact.resists_rolling() {
        notes.add(
            "contact.rolling_m",
            "resistance against rolling is left out: it would need a moment between solids",
        );
    }
    if m.settings.preload {
        notes.add(
            "settings.preload",
            "the static state before the start is left out: the run begins unloaded",
        );
    }
    m
}

fn happen(m: &mut Model, event: &Event) {
    let gone: BTreeSet<&str> = event.remove_bodies.iter().map(String::as_str).collect();
    let released: BTreeSet<&str> = event.release.iter().map(String::as_str).collect();
    let stays = |a: Option<&str>, b: &str| !gone.contains(b) && a.is_none_or(|a| !gone.contains(a));
    m.bodies.retain(|b| !gone.contains(b.id.as_str()));
    m.joints.retain(|j| stays(j.body_a.as_deref(), &j.body_b) && !released.contains(j.id.as_str()));
    m.bushings.retain(|j| stays(j.body_a.as_deref(), &j.body_b) && !released.contains(j.id.as_str()));
    m.forces.retain(|f| {
        !released.contains(f.id()) && f.bodies().iter().all(|b| b.is_none_or(|b| !gone.contains(b)))
    });
    m.tracked.retain(|t| !gone.contains(t.body.as_str()));
    m.contact.pairs.retain(|p| !gone.contains(p.a.as_str()) && !gone.contains(p.b.as_str()));
    for weak in &event.weaken {
        for bushing in m.bushings.iter_mut().filter(|b| b.id == weak.id) {
            for bending in &mut bushing.bending {
                if let Bending::Curve { strength_factor, .. } = bending {
                    *strength_factor *= weak.factor;
                }
            }
        }
        for force in &mut m.forces {
            if let Force::Hinge { id, capacity, .. } = force
                && *id == weak.id
            {
                capacity.iter_mut().for_each(|point| point[1] *= weak.factor);
            }
        }
    }
    // a hinge opens no joint that is gone
    let left: BTreeSet<String> = m.joints.iter().map(|j| j.id.clone()).collect();
    for force in &mut m.forces {
        if let Force::Hinge { joint, .. } = force {
            *joint = joint.take().filter(|j| left.contains(j));
        }
    }
}

/// Joints that an event releases or that a fracture opens.
fn opening(model: &Model) -> BTreeSet<&str> {
    let released = model.events.iter().flat_map(|e| e.release.iter().map(String::as_str));
    let broken = model.forces.iter().filter_map(|f| match f {
        Force::Hinge { joint: Some(joint), fracture_rad: Some(_), .. } => Some(joint.as_str()),
        _ => None,
    });
    released.chain(broken).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_at_the_start_are_done_and_later_ones_named() {
        let text = r#"{"schema": "fallwerk-mbs/2", "name": "two", "gravity_m_s2": [0, 0, -9.81],
            "bodies": [
                {"id": "a", "mass_kg": 1, "inertia_kg_m2": [[1,0,0],[0,1,0],[0,0,1]], "position_m": [0,0,0]},
                {"id": "b", "mass_kg": 1, "inertia_kg_m2": [[1,0,0],[0,1,0],[0,0,1]], "position_m": [1,0,0]}],
            "joints": [{"id": "j", "kind": "revolute", "body_b": "b", "point_m": [0,0,0], "axis": [1,0,0]},
                       {"id": "k", "kind": "spherical", "body_b": "b", "point_m": [0,0,0]}],
            "forces": [{"kind": "hinge", "id": "h", "body_b": "b", "stiffness_nm_rad": 1, "capacity": [[0, 8]], "joint": "j"}],
            "events": [{"id": "now", "time_s": 0, "remove_bodies": ["a"], "release": ["j"], "weaken": [{"id": "h", "factor": 0.5}]},
                       {"id": "then", "time_s": 0.5, "release": ["k"]}]}"#;
        let model: Model = serde_json::from_str(text).unwrap();
        model.check().unwrap();
        let mut notes = Notes::default();
        let m = at_start(&model, &mut notes);
        assert_eq!((m.bodies.len(), m.joints.len(), m.events.len()), (1, 1, 1));
        assert!(matches!(&m.forces[0], Force::Hinge { capacity, joint: None, .. } if capacity[0][1] == 4.0));
        assert_eq!(notes.0.len(), 1);
        assert_eq!(notes.0[0].id, "then");
    }

    #[test]
    fn axes_not_quite_at_a_right_angle_are_squared() {
        let text = r#"{"schema": "fallwerk-mbs/2", "name": "u", "gravity_m_s2": [0, 0, 0], "bodies": [
                {"id": "b", "mass_kg": 1, "inertia_kg_m2": [[1,0,0],[0,1,0],[0,0,1]], "position_m": [0,0,0]}],
            "joints": [{"id": "j", "kind": "universal", "body_b": "b", "point_m": [0,0,0], "axis": [0, 1, 0], "axis_b": [1, 1e-5, 0]}]}"#;
        let model: Model = serde_json::from_str(text).unwrap();
        let mut notes = Notes::default();
        assert_eq!(at_start(&model, &mut notes).joints[0].axis_b, Some([1.0, 0.0, 0.0]));
        assert!(notes.0.len() == 1 && notes.0[0].id == "j", "{:?}", notes.0);
    }
}
