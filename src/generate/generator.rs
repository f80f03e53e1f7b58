//! One building, its rules and the library: what is found once, and the models that come of it, whatever is decided otherwise.

use super::analyst::Answers;
use super::beam_ends::YieldingEnds;
use super::crushing::Struck;
use super::decide::Decision;
use super::doubts::{self, Doubt};
use super::floors::Line;
use super::joints::{self, Query};
use super::known::Known;
use super::levers;
use super::lines::{Lines, obeyed};
use super::{
    Accuracy, Division, EventReason, GenerateError, Generated, Jointless, Parts, StaysWhole, Wishes,
    bending_floors, charges, contact, event_rules, sections, tracked, unasked, walls, webs_of,
};
use crate::base::hash::ContentHash;
use crate::building::ends::{MemberEnd, member_ends};
use crate::building::lines::{Line as PlateLine, lines as plate_lines};
use crate::building::{Building, Override};
use crate::fe::mesh::Mesh;
use crate::graph::demand::Solved;
use crate::graph::frame::Frame;
use crate::graph::{Demands, Structure};
use crate::library::derive_contact::WantedContact;
use crate::library::{Entry, Store};
use crate::mbs::model::{Bending, Bushing, MODEL_SCHEMA, Model, RunSettings, TOLERANCE};
use crate::mbs::run::LARGEST_RELATED_STEP_S;
use crate::rc::around::{self, Surroundings};
use crate::rules::RuleBase;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Instant;

/// What models of a building are generated from.
pub struct Generator<'a> {
    building: &'a Building,
    rules: &'a RuleBase,
    store: &'a mut Store,
    accuracy: Accuracy,
    structure: Structure,
    ends: Vec<MemberEnd>,
    plates: Vec<PlateLine>,
    demands: Demands,
    /// The building without what is cut away in preparation.
    frame: Frame,
    known: Known,
    mesh: Mesh,
    around: Surroundings,
    library: joints::Known,
    stages: Stages,
}

/// Times of stages.
#[derive(Clone)]
struct Stages {
    list: Vec<(&'static str, f64)>,
    began: Instant,
}

impl Stages {
    fn begin() -> Self {
        Self { list: Vec::new(), began: Instant::now() }
    }

    /// What went by since the last stage ended was this one; `aside` of it belongs to another \[s\].
    fn end(&mut self, name: &'static str, aside_s: f64) {
        self.list.push((name, self.began.elapsed().as_secs_f64() - aside_s));
        self.began = Instant::now();
    }
}

impl<'a> Generator<'a> {
    /// Of a building.
    ///
    /// # Errors
    /// If the building has what no model can have, or an entry of the library cannot be read.
    pub fn of(
        building: &'a Building,
        rules: &'a RuleBase,
        store: &'a mut Store,
        wishes: impl Into<Wishes>,
    ) -> Result<Self, GenerateError> {
        let Wishes { derive, accuracy } = wishes.into();
        building.without_skew("no MBS model can be generated").map_err(GenerateError::Skew)?;
        if let Some(charge) = building.events.iter().find(|e| e.stretch_m.is_some()) {
            return Err(GenerateError::Stretch(charge.id.clone(), charge.member.clone()));
        }
        let mut stages = Stages::begin();
        let structure = Structure::of(building);
        stages.end("graph", 0.0);
        let ends = member_ends(building, &structure.partition);
        let plates = plate_lines(building, &structure.partition);
        stages.end("ends", 0.0);
        let solved = || {
            let Solved { demands, frame } = Solved::of(&structure, building);
            (Known::of(building, &structure, (&ends, &plates), &demands), demands, frame)
        };
        let meshed = || {
            let (mesh, _) = Mesh::of(building, building.settings.mesh_size_m);
            (Surroundings::of(&mesh), mesh)
        };
        let ((known, demands, frame), (around, mesh)) = rayon::join(solved, meshed);
        stages.end("demands, mesh", 0.0);
        let library = joints::Known::of(store, derive);
        stages.end("library", 0.0);
        Ok(Self {
            building,
            rules,
            store,
            accuracy,
            structure,
            ends,
            plates,
            demands,
            frame,
            known,
            mesh,
            around,
            library,
            stages,
        })
    }

    /// From now on no curves are computed; those of some entries are at hand, beside what the library has.
    pub fn compute_no_more(&mut self, entries: &BTreeMap<String, Entry>) {
        self.library.compute_no_more(entries);
    }

    /// The model with some decisions of the analyst. `progress` hears what is being derived.
    ///
    /// # Errors
    /// If rules or library do not suffice, or a decision cannot be carried out.
    pub fn model(
        &mut self,
        overrides: &[Override],
        progress: &(dyn Fn(&str) + Sync),
    ) -> Result<Generated, GenerateError> {
        let Self {
            building,
            rules,
            accuracy,
            structure,
            ends,
            plates,
            demands,
            frame,
            mesh,
            around,
            library,
            ..
        } = self;
        let (building, rules, partition) = (*building, *rules, &structure.partition);
        let mut stages = Stages { began: Instant::now(), ..self.stages.clone() };
        let answers = Answers::of(building, overrides, structure, ends);
        let decision = Decision::of(building, ends, &self.known, *accuracy, rules, &answers)?;
        stages.end("decisions", 0.0);
        let present: Vec<bool> = building.members.iter().map(|m| !building.is_cut(&m.id)).collect();
        let clusters: Vec<Vec<usize>> = structure
            .clusters(|c| c.members.iter().all(|m| present[*m]) && decision.joined(c))
            .into_iter()
            .filter(|members| members.iter().all(|m| present[*m] && !structure.boxes(*m).is_empty()))
            .filter(|members| !members.iter().all(|m| joints::is_ground(building, *m)))
            .collect();
        let mut notes = decision.notes.clone();
        let parts = Parts {
            building,
            structure,
            mesh,
            clusters: &clusters,
            ends,
            decision: &decision,
            accuracy: *accuracy,
        };
        let mut division = parts.divided(&BTreeSet::new())?;
        let without = division.without_curves(library)?;
        if !without.is_empty() {
            division = parts.divided(&without)?;
        }
        let Division { bodies, floors, lines, stays, notes: mut remarks } = division;
        notes.extend(remarks.iter().cloned());
        stages.end("bodies", 0.0);
        let place = joints::Place { building, partition, mesh, bodies: &bodies };
        let (hinged, loose): (Vec<&MemberEnd>, Vec<&MemberEnd>) = ends
            .iter()
            .filter(|e| present[e.member] && decision.hinges.contains_key(&e.id))
            .partition(|end| joints::is_joined(&place, end));
        library.begin();
        let asked: Vec<(&MemberEnd, bool)> =
            hinged.iter().map(|end| (*end, library.is_at_hand(&end.id))).collect();
        let signature = |(end, at_hand): &(&MemberEnd, bool)| {
            let near = if *at_hand { None } else { around.near(mesh, end) }?;
            let beyond = end.beyond(partition).map(|m| building.members[m].kind);
            Some(around::signature(building, mesh, end, beyond, &near))
        };
        let signatures: Vec<Option<ContentHash>> = asked.par_iter().map(signature).collect();
        let of_ends = hinged.iter().zip(signatures).map(|(end, signature)| {
            let query = || match around.near(mesh, end) {
                Some(near) => joints::query(&place, &mesh.piece(&near).0, end),
                None => joints::query(&place, mesh, end),
            };
            library.asked(&end.id, signature, query)
        });
        let strip = |line: &Line| Ok(Query::Strip(line.wanted.clone()));
        let of_lines = lines.iter().map(|(_, line)| library.asked(&line.id, None, || strip(line)));
        let struck = if event_rules::puts_contact_in(building, rules)? {
            Struck::of(building, ends, &decision).known_to(library, &mut notes)?
        } else {
            Struck::default()
        };
        let face = |wanted: &WantedContact| Ok(Query::Contact(wanted.clone()));
        let of_faces = struck.wanted.iter().map(|(id, wanted)| library.asked(id, None, || face(wanted)));
        let found = joints::entries(of_ends.chain(of_lines).chain(of_faces), self.store, library, progress)?;
        stages.end("keys", found.curves_s);
        notes.extend(joints::Scaled::notes(&found.scaled));
        let so_far = notes.len();
        let free =
            |end: &&MemberEnd| format!("{} touches neither a member nor a support: no joint there", end.id);
        notes.extend(loose.iter().map(free));
        if (0..building.members.len()).any(|m| joints::is_ground(building, m)) {
            notes.push(
                "footings that are held are ground in this model, and nothing comes into contact with them"
                    .into(),
            );
        }
        if building.settings.removal_duration_s > 0.0 && !building.events.is_empty() {
            notes.push(format!(
                "charges take {} s to remove a member in FE; the MBS removes its body at once at the time of ignition",
                building.settings.removal_duration_s
            ));
        }
        notes.extend(soon_over(building));
        let mut hinges = joints::hinges(&place, &hinged, &found, &decision)?;
        for (first, line) in &lines {
            let entry = &found.entries[&found.of_end[&line.id]];
            hinges.push(line.bushing(
                &bodies.list,
                *first,
                entry,
                joints::curve_id(&entry.key, 0),
                building,
            )?);
        }
        let (walls, wall_curves) = walls::springs(&place, structure, &decision, &around.planes);
        if !walls.is_empty() {
            notes.push("walls yield at foot and head, axially and out of their plane; in shear they stay elastic in this model".into());
        }
        remarks.extend(notes[so_far..].iter().cloned());
        hinges.extend(walls);
        let mut curves = found.curves();
        joints::without_joint(&place, &hinged, &mut hinges, &mut curves);
        joints::carry_over(&place, &hinged, &mut hinges);
        curves.extend(wall_curves);
        let sections = sections::hinges(building, structure, &bodies, &decision, (&hinges, &mut curves));
        levers::put_in(&hinges, &found, &mut curves);
        let webs = webs_of(building, &around.planes, &floors, (&bodies, &decision), &mut curves);
        let event_rules = event_rules::of(building, rules, &decision, (&bodies, &sections), &webs)?;
        hinges.extend(sections);
        let mut contact = contact(building);
        contact.crushing = struck.faces(building, &bodies, &found);
        let mut yielding = YieldingEnds::new(&around.planes, ends);
        let of_slabs = Lines::of(plates, &decision);
        let shared_masses = bending_floors(
            building,
            frame,
            &floors,
            &bodies,
            (&mut hinges, &of_slabs, &mut yielding),
            &mut contact,
        );
        curves.extend(yielding.into_curves());
        notes.extend(obeyed(plates, &decision, &hinges)?);
        hinges.extend(webs.bushings);
        let used: BTreeSet<&String> =
            hinges.iter().flat_map(|h| &h.bending).filter_map(Bending::curve).collect();
        curves.retain(|id, _| used.contains(id));
        // an end that the analyst wants elastic has no hinge in the model either, and is not rigid; nor is that of a wall on springs
        let decided = decision.hinges.keys().map(String::as_str);
        let joined = hinges.iter().flat_map(|j| &j.origin.members).map(String::as_str);
        let live: BTreeSet<&str> =
            hinges.iter().flat_map(Bushing::hinges).chain(decided).chain(joined).collect();
        let overloaded = doubts::overloaded(demands, &live);
        notes.extend(overloaded.iter().map(|(end, ratio)| doubts::overloaded_words(end, *ratio, &decision)));
        let (events, taking_nothing) = charges::events(building, &clusters, (&bodies, &floors))?;
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
            tracked: tracked(building, partition, &bodies),
            settings: settings(building),
            bodies: bodies.list,
        };
        stages.end("joints", 0.0);
        let trace = decision.reasons(rules, &model);
        let jointless = Jointless::all(&decision, ends, &trace, rules);
        let event_rules = EventReason::all(&model, rules);
        let stays = StaysWhole::all(building, rules, (&decision, &stays), &webs.bodies);
        let unasked = unasked::of(building, rules, (&self.known, *accuracy), (&decision, &stays))?;
        let sources = doubts::Sources {
            building,
            structure,
            ends,
            decision: &decision,
            overloaded: &overloaded,
            found: &found,
            known: &self.known,
        };
        let doubts = Doubt::all(&sources, remarks);
        stages.end("reasons", 0.0);
        stages.list.push(("curves", found.curves_s));
        let (derived, entries, stages) = (found.derived, found.entries, stages.list);
        let scaled = found.scaled.into_iter().map(|s| (s.key, s.words)).collect();
        Ok(Generated {
            model,
            trace,
            event_rules,
            unasked,
            stays,
            jointless,
            scaled,
            notes,
            doubts,
            derived,
            entries,
            stages,
        })
    }
}

/// Frequency below which inertia against relative motion keeps all others \[rad/s\]: 0.8 of the limit of steps of [`LARGEST_RELATED_STEP_S`]. Fast vibrations gather below it, and the nearer it is to the limit the more of the energy of
/// those that a charge sets off is lost in steps. What moves at 40 rad/s, as whole floors do, is slower by 1.5e-3.
const RELATIVE_RAD_S: f64 = 0.8 * 2.0 / LARGEST_RELATED_STEP_S;

/// Mean displacement from which springs may be softer \[m\]: how a building falls is settled then.
const SOFT_AFTER_M: f64 = 0.5;

/// Time after the last charge that tells whether a building stands \[s\]: it has fallen freely by 1.2 m then.
const TELLING_S: f64 = 0.5;

/// That a run ends soon after the last charge.
fn soon_over(building: &Building) -> Option<String> {
    let last = building.events.iter().max_by(|a, b| a.time_s.total_cmp(&b.time_s))?;
    let end_s = building.settings.end_time_s;
    let is_soon = last.time_s <= end_s && end_s - last.time_s < TELLING_S;
    is_soon.then(|| {
        format!(
            "charge `{}` is fired at {} s and the run ends at settings.end_time = {end_s} s: too soon to tell whether the building stands",
            last.id, last.time_s
        )
    })
}

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
