//! One building, its rules and the library: what is found once, and the models that come of it, whatever is decided otherwise.

use super::analyst::Answers;
use super::decide::Decision;
use super::division::{Division, Parts};
use super::doubts::{self, Doubt};
use super::draft::{Assembled, Draft};
use super::known::Known;
use super::{
    Accuracy, EventReason, GenerateError, Generated, Jointless, StaysWhole, Unmet, Wishes, entries, joints,
    unasked, undemanded,
};
use crate::building::between::Between;
use crate::building::ends::{MemberEnd, member_ends};
use crate::building::lines::{Line as PlateLine, lines as plate_lines};
use crate::building::{Building, MemberKind, Override};
use crate::fe::mesh::Mesh;
use crate::fe::weld;
use crate::graph::demand::Solved;
use crate::graph::frame::Frame;
use crate::graph::{Demands, Structure};
use crate::library::{Entry, Store};
use crate::rc::around::Surroundings;
use crate::rules::RuleBase;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Instant;

/// What is found of a building before anything is decided.
pub(super) struct Basis<'a> {
    pub building: &'a Building,
    pub rules: &'a RuleBase,
    pub accuracy: Accuracy,
    pub structure: Structure,
    pub ends: Vec<MemberEnd>,
    pub plates: Vec<PlateLine>,
    pub demands: Demands,
    /// The building without what is cut away in preparation.
    pub frame: Frame,
    pub known: Known,
    pub mesh: Mesh,
    pub around: Surroundings,
}

/// What models of a building are generated from.
pub struct Generator<'a> {
    basis: Basis<'a>,
    store: &'a mut Store,
    library: entries::Known,
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

impl Basis<'_> {
    /// Whether a member is not cut away in preparation.
    pub fn is_present(&self, member: usize) -> bool {
        !self.building.is_cut(&self.building.members[member].id)
    }

    /// Members that are one body by what has been decided, but for those that are ground.
    fn clusters(&self, decision: &Decision) -> Vec<Vec<usize>> {
        let present: Vec<bool> = (0..self.building.members.len()).map(|m| self.is_present(m)).collect();
        self.structure
            .clusters(|c| c.members.iter().all(|m| present[*m]) && decision.joined(c))
            .into_iter()
            .filter(|members| members.iter().all(|m| present[*m] && !self.structure.boxes(*m).is_empty()))
            .filter(|members| !members.iter().all(|m| joints::is_ground(self.building, *m)))
            .collect()
    }

    /// The bodies of some clusters. Floors without curves for their lines stay in one piece.
    fn divided(
        &self,
        clusters: &[Vec<usize>],
        decision: &Decision,
        library: &entries::Known,
    ) -> Result<Division, GenerateError> {
        let Self { building, structure, mesh, ends, accuracy, .. } = self;
        let parts = Parts { building, structure, mesh, clusters, ends, decision, accuracy: *accuracy };
        let division = parts.divided(&BTreeSet::new())?;
        let without = division.without_curves(library)?;
        if without.is_empty() { Ok(division) } else { parts.divided(&without) }
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
        let column =
            |id: &String| building.members.iter().any(|m| m.id == *id && m.kind == MemberKind::Column);
        if let Some(charge) = building.events.iter().find(|e| e.stretch_m.is_some() && !column(&e.member)) {
            return Err(GenerateError::BeamStretch(charge.id.clone(), charge.member.clone()));
        }
        let mut stages = Stages::begin();
        let structure = Structure::of(building);
        let between = Between::all(building, &structure.partition);
        if !between.is_empty() {
            return Err(GenerateError::Between(between));
        }
        stages.end("graph", 0.0);
        let ends = member_ends(building, &structure.partition);
        let plates = plate_lines(building, &structure.partition);
        stages.end("ends", 0.0);
        let solved = || {
            let Solved { demands, frame } = Solved::of(&structure, building);
            (Known::of(building, &structure, (&ends, &plates), &demands), demands, frame)
        };
        let meshed = || {
            // curves are those of whole columns, whatever stretch of one a charge takes
            let mut whole = Cow::Borrowed(building);
            if building.events.iter().any(|charge| charge.stretch_m.is_some()) {
                whole.to_mut().events.iter_mut().for_each(|charge| charge.stretch_m = None);
            }
            let (mesh, _) = Mesh::of(&whole, building.settings.mesh_size_m);
            weld::check(building, &mesh, building.settings.mesh_size_m)?;
            Ok::<_, GenerateError>((Surroundings::of(&mesh), mesh))
        };
        let ((known, demands, frame), meshed) = rayon::join(solved, meshed);
        let (around, mesh) = meshed?;
        stages.end("demands, mesh", 0.0);
        let library = entries::Known::of(store, derive)?;
        stages.end("library", 0.0);
        let basis =
            Basis { building, rules, accuracy, structure, ends, plates, demands, frame, known, mesh, around };
        Ok(Self { basis, store, library, stages })
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
        let Self { basis, store, library, stages } = self;
        let basis = &*basis;
        let Basis { building, rules, accuracy, structure, ends, plates, known, .. } = basis;
        let (building, rules) = (*building, *rules);
        let mut stages = Stages { began: Instant::now(), ..stages.clone() };
        let answers = Answers::of(building, overrides, structure, ends);
        let decision = Decision::of(building, ends, known, *accuracy, rules, &answers)?;
        stages.end("decisions", 0.0);
        let clusters = basis.clusters(&decision);
        let division = basis.divided(&clusters, &decision, library)?;
        stages.end("bodies", 0.0);
        let mut notes = undemanded::notes(basis);
        notes.extend(decision.notes.iter().cloned());
        notes.extend(division.notes.iter().cloned());
        notes.extend(division.unmet.iter().map(Unmet::words));
        let unmet = division.unmet.clone();
        let draft = Draft::of(basis, &decision, &clusters, division);
        let mut curves = draft.curves(store, library, progress)?;
        stages.end("keys", curves.found.curves_s);
        notes.append(&mut curves.notes);
        let Assembled { model, webs, stays, overloaded, notes: about, remarks } = draft.assembled(&curves)?;
        let found = curves.found;
        notes.extend(about);
        stages.end("joints", 0.0);
        let trace = decision.reasons(rules, &model);
        let jointless = Jointless::all(building, (ends, plates), &decision, &trace, rules);
        let event_rules = EventReason::all(&model, rules);
        let stays = StaysWhole::all(building, rules, (&decision, &stays), &webs.bodies);
        let unasked = unasked::of(building, rules, (known, *accuracy), (&decision, &stays))?;
        let (decision, overloaded, found_ref) = (&decision, &overloaded, &found);
        let sources =
            doubts::Sources { building, structure, ends, decision, overloaded, found: found_ref, known };
        let doubts = Doubt::all(&sources, remarks);
        stages.end("reasons", 0.0);
        stages.list.push(("curves", found.curves_s));
        Ok(Generated {
            model,
            trace,
            event_rules,
            unasked,
            stays,
            jointless,
            unmet,
            scaled: found.scaled.into_iter().map(|s| (s.key, s.words)).collect(),
            notes,
            doubts,
            derived: found.derived,
            entries: found.entries,
            stages: stages.list,
        })
    }
}
