//! A model put together: bodies, the joints between them with their curves, and all else that a model file has.

use super::beam_ends::YieldingEnds;
use super::bodies::Bodies;
use super::crushing::Struck;
use super::decide::Decision;
use super::division::{Division, bending_floors, webs_of};
use super::entries::{self, Entries, Query};
use super::generator::Basis;
use super::joints;
use super::lines::{Lines, obeyed};
use super::webs::{Stays, Webs};
use super::{GenerateError, charges, doubts, edges, event_rules, levers, rates, sections, walls};
use crate::base::hash::ContentHash;
use crate::building::Building;
use crate::building::ends::MemberEnd;
use crate::building::partition::Partition;
use crate::building::tracked::{Tracked, tracked_points};
use crate::curve::ResistanceCurve;
use crate::library::Store;
use crate::library::derive_contact::WantedContact;
use crate::mbs::model::{
    Bending, BodyContact, Bushing, Contact, GroundPlane, MODEL_SCHEMA, Model, ObstacleBox, RESTITUTION,
    RunSettings, SharedMass, TOLERANCE, TrackedPoint,
};
use crate::mbs::run::LARGEST_RELATED_STEP_S;
use crate::rc::around;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// What has been decided about a building, and the bodies that follow from it.
pub(super) struct Draft<'a> {
    basis: &'a Basis<'a>,
    decision: &'a Decision,
    clusters: &'a [Vec<usize>],
    division: Division,
    /// Ends with a hinge, and those of them that touch nothing.
    hinged: Vec<&'a MemberEnd>,
    loose: Vec<&'a MemberEnd>,
}

/// The library entries of a model.
pub(super) struct Curves {
    /// Of the ends, lines and faces.
    pub found: Entries,
    /// The columns whose ends may be crushed.
    struck: Struck,
    /// About entries that are not there, or not of their own.
    pub notes: Vec<String>,
}

/// A model with what is told about it.
pub(super) struct Assembled {
    pub model: Model,
    /// Beams that may break away by the ids of their bodies, and those that cannot.
    pub webs: Webs,
    pub stays: Stays,
    /// Ends without a hinge whose sections bear less than is asked of them, with the ratio.
    pub overloaded: Vec<(String, f64)>,
    /// What an analyst should look at, and what of it is about the model alone.
    pub notes: Vec<String>,
    pub remarks: Vec<String>,
}

/// Bushings and the curves that they follow.
type Bushings = (Vec<Bushing>, BTreeMap<String, ResistanceCurve>);

impl<'a> Draft<'a> {
    /// Of the bodies of a building.
    pub fn of(
        basis: &'a Basis<'a>,
        decision: &'a Decision,
        clusters: &'a [Vec<usize>],
        division: Division,
    ) -> Self {
        let mut this = Self { basis, decision, clusters, division, hinged: Vec::new(), loose: Vec::new() };
        let place = this.place();
        let is_hinged = |e: &&MemberEnd| basis.is_present(e.member) && decision.hinges.contains_key(&e.id);
        let ends = basis.ends.iter().filter(is_hinged);
        let (hinged, loose) = ends.partition(|end| joints::is_joined(&place, end));
        (this.hinged, this.loose) = (hinged, loose);
        this
    }

    fn place(&self) -> joints::Place<'_> {
        let Basis { building, structure, mesh, .. } = self.basis;
        joints::Place { building, partition: &structure.partition, mesh, bodies: &self.division.bodies }
    }

    /// Finds or computes the entries of its ends, of the lines at which floors may fold and of the faces that are crushed.
    pub fn curves(
        &self,
        store: &mut Store,
        library: &entries::Known,
        progress: &(dyn Fn(&str) + Sync),
    ) -> Result<Curves, GenerateError> {
        let Basis { building, rules, structure, ends, mesh, around, .. } = self.basis;
        let (place, mut notes) = (self.place(), Vec::new());
        library.begin();
        let asked: Vec<(&MemberEnd, bool)> =
            self.hinged.iter().map(|end| (*end, library.is_at_hand(&end.id))).collect();
        let signature = |(end, at_hand): &(&MemberEnd, bool)| {
            let near = if *at_hand { None } else { around.near(mesh, end) }?;
            let beyond = end.beyond(&structure.partition).map(|m| building.members[m].kind);
            Some(around::signature(building, mesh, end, beyond, &near))
        };
        let signatures: Vec<Option<ContentHash>> = asked.par_iter().map(signature).collect();
        let of_ends = self.hinged.iter().zip(signatures).map(|(end, signature)| {
            let query = || match around.near(mesh, end) {
                Some(near) => joints::query(&place, &mesh.piece(&near).0, end),
                None => joints::query(&place, mesh, end),
            };
            library.asked(&end.id, signature, query)
        });
        let of_lines = self
            .division
            .lines
            .iter()
            .map(|(_, line)| library.asked(&line.id, None, || Ok(Query::Strip(line.wanted.clone()))));
        let struck = if event_rules::puts_contact_in(building, rules)? {
            Struck::of(building, ends, self.decision, &self.division.bodies).known_to(library, &mut notes)?
        } else {
            Struck::default()
        };
        let face = |wanted: &WantedContact| Ok(Query::Contact(wanted.clone()));
        let of_faces = struck.wanted.iter().map(|(id, wanted)| library.asked(id, None, || face(wanted)));
        let found = entries::entries(of_ends.chain(of_lines).chain(of_faces), store, library, progress)?;
        notes.extend(entries::Scaled::notes(&found.scaled));
        notes.extend(found.withdrawn.iter().cloned());
        Ok(Curves { found, struck, notes })
    }

    /// The model with these entries.
    pub fn assembled(self, entries: &Curves) -> Result<Assembled, GenerateError> {
        let Curves { found, struck, .. } = entries;
        let Basis { building, rules, structure, plates, demands, around, .. } = self.basis;
        let (bodies, floors) = (&self.division.bodies, &self.division.floors);
        let mut notes = self.notes();
        let (mut hinges, mut curves) = self.bushings(found, &mut notes)?;
        let mut remarks = self.division.notes.clone();
        remarks.extend(notes.iter().cloned());
        let sections = sections::hinges(building, structure, bodies, self.decision, (&hinges, &mut curves));
        levers::put_in(&hinges, found, &mut curves);
        let mut webs = webs_of(building, &around.planes, floors, (bodies, self.decision), &mut curves);
        let event_rules = event_rules::of(building, rules, self.decision, (bodies, &sections), &webs)?;
        hinges.extend(sections);
        for stumps in bodies.stumps() {
            let rules = self.decision.rules_of(building, &[stumps.member]);
            hinges.extend(stumps.springs(building, bodies, &rules));
            notes.extend(stumps.notes(building));
        }
        let mut contact = contact(building);
        contact.crushing = struck.faces(building, bodies, found);
        let shared_masses = self.add_floors((&mut hinges, &mut curves), &mut contact);
        notes.extend(obeyed(plates, self.decision, &hinges)?);
        hinges.append(&mut webs.bushings);
        let used: BTreeSet<&String> =
            hinges.iter().flat_map(|h| &h.bending).filter_map(Bending::curve).collect();
        curves.retain(|id, _| used.contains(id));
        rates::put_in(building, &mut hinges, &curves);
        let overloaded = doubts::overloaded(demands, &self.live(&hinges));
        let words = |(end, ratio): &(String, f64)| doubts::overloaded_words(end, *ratio, self.decision);
        notes.extend(overloaded.iter().map(words));
        let (events, taking_nothing) = charges::events(building, self.clusters, (bodies, floors), &hinges)?;
        notes.extend(taking_nothing);
        let model = Model {
            schema: MODEL_SCHEMA.to_string(),
            name: building.name.clone(),
            gravity_m_s2: [0.0, 0.0, -building.settings.gravity_m_s2],
            shared_masses,
            curves,
            joints: Vec::new(),
            bushings: hinges,
            forces: Vec::new(),
            contact,
            events,
            event_rules,
            tracked: tracked(building, &structure.partition, bodies),
            settings: settings(building),
            bodies: self.division.bodies.list,
        };
        Ok(Assembled { model, webs, stays: self.division.stays, overloaded, notes, remarks })
    }

    /// What an analyst should know of the model as a whole.
    fn notes(&self) -> Vec<String> {
        let building = self.basis.building;
        let free =
            |end: &&MemberEnd| format!("{} touches neither a member nor a support: no joint there", end.id);
        let mut notes: Vec<String> = self.loose.iter().map(free).collect();
        if (0..building.members.len()).any(|m| joints::is_ground(building, m)) {
            notes.push(
                "footings that are held are ground in this model, and nothing comes into contact with them"
                    .into(),
            );
        }
        let takes_s = building.settings.removal_duration_s;
        if takes_s > 0.0 && !building.events.is_empty() {
            let end_s = building.settings.end_time_s;
            let outlasts = building.events.iter().any(|e| e.time_s <= end_s && e.time_s + takes_s > end_s);
            let beyond = if outlasts { ", which is beyond the end of the run" } else { "" };
            notes.push(format!(
                "charges take {takes_s} s to remove a member in FE{beyond}; the MBS removes its body at once at the time of ignition"
            ));
        }
        notes.extend(building.ends_soon());
        notes
    }

    /// The joints at the ends of columns and walls, and at the lines at which floors may fold.
    fn bushings(&self, found: &Entries, notes: &mut Vec<String>) -> Result<Bushings, GenerateError> {
        let (Basis { building, structure, around, .. }, place) = (self.basis, self.place());
        let mut hinges = joints::hinges(&place, &self.hinged, found, self.decision)?;
        for (first, line) in &self.division.lines {
            let entry = &found.entries[&found.of_end[&line.id]];
            let curve = entries::curve_id(&entry.key, 0);
            hinges.push(line.bushing(&place.bodies.list, *first, entry, curve, building)?);
        }
        let (walls, wall_curves) = walls::springs(&place, structure, self.decision, &around.planes);
        if !walls.is_empty() {
            notes.push(
                "walls yield at foot and head in this model: axially, out of their plane and in shear".into(),
            );
        }
        hinges.extend(walls);
        hinges.extend(edges::springs(&place, structure));
        let mut curves = found.curves();
        joints::without_joint(&place, &self.hinged, &mut hinges, &mut curves);
        joints::carry_over(&place, &self.hinged, &mut hinges);
        curves.extend(wall_curves);
        Ok((hinges, curves))
    }

    /// Adds the springs of the floors that bend, with their curves.
    fn add_floors(
        &self,
        (hinges, curves): (&mut Vec<Bushing>, &mut BTreeMap<String, ResistanceCurve>),
        contact: &mut Contact,
    ) -> Vec<SharedMass> {
        let Basis { building, ends, plates, frame, around, .. } = self.basis;
        let Division { bodies, floors, .. } = &self.division;
        let mut yielding = YieldingEnds::new(&around.planes, ends);
        let lines = Lines::of(plates, self.decision);
        let shared =
            bending_floors(building, frame, floors, bodies, (hinges, &lines, &mut yielding), contact);
        curves.extend(yielding.into_curves());
        shared
    }

    /// Ends that turn in the model: an end that the analyst wants elastic has no hinge in it either, and is not rigid; nor is that of a wall on springs.
    fn live<'b>(&'b self, hinges: &'b [Bushing]) -> BTreeSet<&'b str> {
        let decided = self.decision.hinges.keys().map(String::as_str);
        let joined = hinges.iter().flat_map(|j| &j.origin.members).map(String::as_str);
        hinges.iter().flat_map(Bushing::hinges).chain(decided).chain(joined).collect()
    }
}

fn contact(building: &Building) -> Contact {
    Contact {
        ground: Some(GroundPlane {
            level_m: building.ground.level_m,
            friction: building.ground.friction,
            restitution: RESTITUTION,
        }),
        obstacles: building
            .obstacles
            .iter()
            .map(|o| ObstacleBox {
                id: o.id.clone(),
                min_m: o.solid.min,
                max_m: o.solid.max,
                friction: o.friction,
                restitution: RESTITUTION,
            })
            .collect(),
        planes: Vec::new(),
        pairs: Vec::new(),
        bodies: Some(BodyContact { friction: building.ground.friction, restitution: RESTITUTION }),
        rolling_m: 0.0,
        crushing: Vec::new(),
    }
}

fn tracked(building: &Building, partition: &Partition, bodies: &Bodies) -> Vec<TrackedPoint> {
    let point = |t: Tracked| {
        let member = building.members.iter().position(|m| m.id == t.member)?;
        let body = bodies.of(member, t.point_m)?;
        Some(TrackedPoint { id: t.id, body: bodies.list[body].id.clone(), point_m: t.point_m })
    };
    tracked_points(building, partition).into_iter().filter_map(point).collect()
}

/// Frequency below which inertia against relative motion keeps all others \[rad/s\]: 0.8 of the limit of steps of [`LARGEST_RELATED_STEP_S`]. Fast vibrations gather below it, and the nearer it is to the limit the more of the energy of
/// those that a charge sets off is lost in steps. What moves at 40 rad/s, as whole floors do, is slower by 1.5e-3.
const RELATIVE_RAD_S: f64 = 0.8 * 2.0 / LARGEST_RELATED_STEP_S;

/// Displacement of nearly all of the mass from which springs may be softer \[m\]: how a building falls is settled then.
const SOFT_AFTER_M: f64 = 0.5;

fn settings(building: &Building) -> RunSettings {
    RunSettings {
        end_time_s: building.settings.end_time_s,
        output_interval_s: building.settings.output_interval_s,
        preload: true,
        time_step_s: None,
        tolerance: TOLERANCE,
        reactions: false,
        sleep_speed_m_s: None,
        relative_inertia_rad_s: Some(RELATIVE_RAD_S),
        soft_after_m: Some(SOFT_AFTER_M),
    }
}
