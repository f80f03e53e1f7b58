//! The simulation manager: building + rules + library -> MBS model, with a reason for each part.
//!
//! Rigid bodies come from the members by the rules (a column is one body; a slab and its beams are one), joints stand at the
//! member ends for which a rule asks for a hinge, and each hinge carries the curves of the library entry computed from exactly
//! this member end. Where no rule decides or no entry exists, generation stops and says so: there is no default curve.

mod analyst;
mod axes;
mod beam_ends;
mod beam_joints;
pub mod bodies;
mod cells;
mod charges;
mod crossing;
mod crushing;
mod decide;
mod doubts;
mod event_reasons;
mod event_rules;
mod floor_mass;
mod floors;
mod generator;
mod grillage;
mod jointless;
mod joints;
mod junction;
pub mod known;
mod known_lines;
mod levers;
mod lines;
mod nearest;
mod panels;
mod rigid;
mod sections;
mod stretch;
mod through;
mod twist;
mod unasked;
mod walls;
mod webs;
mod wish;

pub use analyst::ANALYST;
pub use beam_ends::BEAM_CURVES;
pub use decide::{Decision, Reason, Superseded};
pub use doubts::{Alternative, Doubt, Why};
pub use event_reasons::EventReason;
pub use generator::Generator;
pub use jointless::Jointless;
pub use rigid::rigid_elements;
pub use unasked::Unasked;
pub use webs::{StaysWhole, web_of};
pub use wish::{Accuracy, Derive, Wishes};

use crate::building::ends::MemberEnd;
use crate::building::partition::Partition;
use crate::building::tracked::{Tracked, tracked_points};
use crate::building::{Building, MemberKind};
use crate::curve::ResistanceCurve;
use crate::fe::mesh::Mesh;
use crate::graph::frame::Frame;
use crate::graph::{Connection, Structure};
use crate::library::derive::DeriveError;
use crate::library::{Entry, Store, StoreError};
use crate::mbs::model::{
    BodyContact, Bushing, Contact, GroundPlane, Model, ObstacleBox, RESTITUTION, SharedMass, TrackedPoint,
};
use crate::rules::RuleBase;
use beam_ends::YieldingEnds;
use bodies::Bodies;
use cells::Piece;
use floors::{Grid, Line};
use grillage::Grillage;
use lines::Lines;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use webs::{Stays, Web, Webs};

/// A generated model with its reasons.
#[derive(Debug, Clone)]
pub struct Generated {
    /// The model.
    pub model: Model,
    /// Why each part is there, in the order of the model.
    pub trace: Vec<Reason>,
    /// Rules about contacts and fractures that stand in the model.
    pub event_rules: Vec<EventReason>,
    /// Rules about events that are not asked.
    pub unasked: Vec<Unasked>,
    /// Why beams stay one with their slabs.
    pub stays: Vec<StaysWhole>,
    /// Why ends have no joint.
    pub jointless: Vec<Jointless>,
    /// Where curves come from that were made without a run, by the key of the entry.
    pub scaled: BTreeMap<String, String>,
    /// What an analyst should look at.
    pub notes: Vec<String>,
    /// Decisions of which an analyst might doubt.
    pub doubts: Vec<Doubt>,
    /// Keys of entries that were computed on the way.
    pub derived: Vec<String>,
    /// The entries used, by key.
    pub entries: BTreeMap<String, Entry>,
    /// Time of each stage \[s\], in their order; `curves` is what it takes to scale or compute those that the library lacks.
    pub stages: Vec<(&'static str, f64)>,
}

impl Generated {
    /// What the analyst decided in place of the rules, in words; what is the same of many members or ends, once.
    pub fn overrides(&self) -> Vec<String> {
        let mut groups: Vec<(&Reason, BTreeSet<&str>)> = Vec::new();
        for reason in self.trace.iter().filter(|r| r.is_of_analyst()) {
            let same = |g: &Reason| {
                (&g.action, &g.words, &g.instead_of) == (&reason.action, &reason.words, &reason.instead_of)
            };
            match groups.iter_mut().find(|(g, _)| same(g)) {
                Some((_, subjects)) => _ = subjects.insert(&reason.subject),
                None => groups.push((reason, BTreeSet::from([reason.subject.as_str()]))),
            }
        }
        let words = |(reason, subjects): (&Reason, BTreeSet<&str>)| {
            let subjects: Vec<&str> = subjects.into_iter().collect();
            format!(
                "{} -> {}: {} ({})",
                subjects.join(", "),
                reason.action,
                reason.words,
                reason.instead_words()
            )
        };
        groups.into_iter().map(words).collect()
    }
}

/// Most ids that an error lists.
const MOST_LISTED: usize = 8;

/// A model that cannot be generated.
#[derive(Debug, thiserror::Error)]
pub enum GenerateError {
    /// No rule says what a part becomes.
    #[error("no rule decides about {}: add a rule under rules/ that applies to it (`fallwerk rules check` tells for which kinds of subject there is none), or describe the part otherwise", listed(.0))]
    Gap(Vec<String>),
    /// A rule decides something that the generator cannot do.
    #[error("a rule decides `{0}` for {1}, which the generator does not support yet")]
    Unsupported(String, String),
    /// A subject does not fit the catalogue of features.
    #[error(transparent)]
    Subject(#[from] crate::rules::SubjectError),
    /// The library lacks entries.
    #[error("the library has no entry for {}; run with `--derive` to compute what is missing, or for columns with `--derive=similar` to scale the curves of similar ones or take those of their sections", .0.join(", "))]
    Missing(Vec<String>),
    /// A stretch of a member cannot be removed from a rigid body.
    #[error(
        "charge `{0}` removes a stretch of `{1}`: the MBS model takes whole members away only; give the charge without a stretch, or split the member"
    )]
    Stretch(String, String),
    /// A charge on a part of a body.
    #[error(
        "charge `{charge}` is on `{member}`, which is one body with other members in the MBS model ({body}): give charges to all of these members, or to columns, walls and beams with a slab on them only; the FE model can take it away alone"
    )]
    Shared {
        /// The charge.
        charge: String,
        /// Its member.
        member: String,
        /// The body, or the first of those that it is divided into.
        body: String,
    },
    /// A member is turned out of the axes.
    #[error("{0}")]
    Skew(String),
    /// A decision of the analyst cannot be carried out.
    #[error("the override of {0} cannot be carried out: {1}")]
    Override(String, String),
    /// A column ends in the air.
    #[error(
        "member end {0} touches nothing, or nothing of it is in the mesh (`fallwerk check --mesh` names planes that are too close)"
    )]
    Loose(String),
    /// A rule about events compares what is not known before them.
    #[error(transparent)]
    Event(#[from] crate::rules::residual::Unbound),
    /// A submodel failed.
    #[error(transparent)]
    Derive(#[from] DeriveError),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// The first of some ids, and how many more there are.
fn listed(ids: &[String]) -> String {
    let more = ids.len().saturating_sub(MOST_LISTED);
    let first = ids[..ids.len() - more].join(", ");
    if more > 0 { format!("{first} and {more} more") } else { first }
}

/// Generates the model of a building. `progress` hears what is being derived.
pub fn generate(
    building: &Building,
    rules: &RuleBase,
    store: &mut Store,
    wishes: impl Into<Wishes>,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Generated, GenerateError> {
    Generator::of(building, rules, store, wishes)?.model(&building.overrides, progress)
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

/// How a floor is divided.
enum Floor {
    /// At lines at which it may fold.
    Folds(Grid),
    /// About its columns, with springs in between.
    Bends(Grillage),
}

/// A floor in pieces, which are the bodies from some place on.
struct Divided {
    floor: Floor,
    first: usize,
    pieces: Vec<Piece>,
    webs: Vec<Web>,
}

/// What is divided.
struct Parts<'a> {
    building: &'a Building,
    structure: &'a Structure,
    mesh: &'a Mesh,
    clusters: &'a [Vec<usize>],
    ends: &'a [MemberEnd],
    decision: &'a Decision,
    accuracy: Accuracy,
}

/// The bodies of clusters of members, and the lines at which floors may fold with the first body of their floor.
struct Division {
    bodies: Bodies,
    floors: Vec<Divided>,
    lines: Vec<(usize, Line)>,
    /// Beams that cannot break away.
    stays: Stays,
    notes: Vec<String>,
}

impl Parts<'_> {
    /// One body a cluster, or the pieces of a floor that bends or may fold; `without` are floors for whose lines there are no curves: they stay in one piece.
    fn divided(&self, without: &BTreeSet<String>) -> Result<Division, GenerateError> {
        let Self { building, structure, mesh, clusters, decision, .. } = *self;
        let (mut bodies, mut floors, mut notes) =
            (Bodies::new(building.members.len()), Vec::new(), Vec::new());
        let mut stays = Stays::default();
        let charged = charges::first_on(building);
        for cluster in clusters {
            let rules = decision.rules_of(building, cluster);
            let name = bodies::name(building, cluster);
            let division = self.division(cluster, &name, without, &mut notes)?;
            let away: Vec<usize> = cluster.iter().copied().filter(|m| decision.breaks_away(*m)).collect();
            if !matches!(division, Some(Floor::Bends(_))) {
                let why = format!(
                    "the floor {name} does not bend; `merge_elastic` has it bend, and so does `--accuracy balanced`"
                );
                stays.add(building, &away, &why, decision)?;
            }
            let Some(floor) = division else {
                let column = if let [column] = cluster[..] { Some(column) } else { None };
                match column.and_then(|c| Some((c, decision.sections_of(c)?))) {
                    Some((column, sections)) => {
                        let pieces = sections.cut(building, structure, column);
                        let id = |p: &Piece| format!("{name}/{}", p.cell[0] + 1);
                        let own = pieces.iter().map(|p| p.body(building, structure, id(p), rules.clone()));
                        let own = own.collect();
                        bodies.add_pieces(cluster, pieces, own);
                    }
                    None => bodies.add(cluster, bodies::body(building, structure, cluster, rules)),
                }
                continue;
            };
            let cells = match &floor {
                Floor::Folds(grid) => grid.cells(),
                Floor::Bends(grillage) => grillage.cells.clone(),
            };
            let whole = cells.members.len() == cluster.len();
            let pieces = if whole { cells } else { cells.with(cluster) }.pieces(structure);
            let bends = matches!(floor, Floor::Bends(_));
            let (webs, bare) = match bends {
                true => {
                    let is_charged = |m: usize| {
                        let is_beam = building.members[m].kind == MemberKind::Beam;
                        cluster.len() > 1 && is_beam && charged[m].is_some()
                    };
                    let parts = |m: &usize| decision.breaks_away(*m) || is_charged(*m);
                    let beams: Vec<usize> = cluster.iter().copied().filter(parts).collect();
                    webs::of_floor(building, &beams, &pieces)
                }
                false => Default::default(),
            };
            let bare: Vec<usize> = bare.into_iter().filter(|m| decision.breaks_away(*m)).collect();
            stays.add(building, &bare, "no slab lies on it where it is clear of columns", decision)?;
            let own = pieces.iter().enumerate().map(|(i, p)| {
                let named = (p.name(&name), rules.clone());
                webs::rest(building, structure, (i, p), &webs, named)
            });
            let first = bodies.add_pieces(cluster, pieces.clone(), own.collect());
            let of_web = |w: &Web| {
                w.body(building, structure, &pieces, decision.fired(&w.question(building, decision)))
            };
            bodies.add_parts(webs.iter().map(of_web));
            if bends {
                bodies.bends(first, pieces.len());
            }
            floors.push(Divided { floor, first, pieces, webs });
        }
        let place = joints::Place { building, partition: &structure.partition, mesh, bodies: &bodies };
        let mut lines = Vec::new();
        for Divided { floor, first, pieces, .. } in &floors {
            let Floor::Folds(grid) = floor else { continue };
            let names: Vec<String> =
                bodies.list[*first..first + pieces.len()].iter().map(|b| b.id.clone()).collect();
            let own = grid.lines(&place, pieces, &self.ends_of(&grid.members), &names, decision);
            lines.extend(own.into_iter().map(|line| (*first, line)));
        }
        notes.extend(stays.notes());
        Ok(Division { bodies, floors, lines, stays, notes })
    }

    /// How a cluster is divided, if it is. What the rules ask for and cannot be had is noted.
    ///
    /// # Errors
    /// If the analyst asks for a division that cannot be had.
    fn division(
        &self,
        cluster: &[usize],
        name: &str,
        without: &BTreeSet<String>,
        notes: &mut Vec<String>,
    ) -> Result<Option<Floor>, GenerateError> {
        let Self { building, structure, decision, .. } = *self;
        let ends = self.ends_of(cluster);
        let folds = ends.iter().any(|e| decision.latent.contains_key(&e.id));
        let members = cluster.iter().map(|m| &building.members[*m].id);
        let asked = decision.division_asked(members.chain(ends.iter().map(|e| &e.id)));
        // who asks for a line at which a floor may fold gets it, whatever the rules say of bending
        let bends = decision.bends(cluster) && !matches!(asked, Some((_, false)));
        let Some(floor) = self.floor_of(cluster) else {
            let why = format!(
                "{name} stays in one piece: by the analyst's decision it is one body with more than its floor"
            );
            return match asked {
                Some((target, _)) => Err(GenerateError::Override(target, why)),
                None => {
                    notes.extend((bends || folds).then_some(why));
                    Ok(None)
                }
            };
        };
        let grillage = bends.then(|| Grillage::of(building, structure, &floor, self.accuracy)).flatten();
        if let (None, Some((target, true))) = (&grillage, &asked) {
            let why = format!("{name} has columns on less than two axes, between which it could bend");
            return Err(GenerateError::Override(target.clone(), why));
        }
        if let Some(grillage) = grillage {
            return Ok(Some(Floor::Bends(grillage)));
        }
        if !folds {
            return Ok(None);
        }
        let why = if without.contains(name) {
            "the library has no curves for the lines at which it may fold, nor similar ones".to_string()
        } else {
            match Grid::of(building, structure, &floor, &ends, decision) {
                Ok(grid) => return Ok(grid.map(Floor::Folds)),
                Err(pieces) => format!(
                    "the lines at which it may fold would make {pieces} of it, more than a model can watch in one floor"
                ),
            }
        };
        let why = format!("{name} stays in one piece: {why}");
        match asked {
            Some((target, _)) => Err(GenerateError::Override(target, why)),
            None => {
                notes.push(why);
                Ok(None)
            }
        }
    }

    /// Ends of some members; those of all members stand in the order of the members.
    fn ends_of(&self, members: &[usize]) -> Vec<MemberEnd> {
        let own = |m: usize| {
            let [first, after] = [m, m + 1].map(|m| self.ends.partition_point(|e| e.member < m));
            &self.ends[first..after]
        };
        members.iter().flat_map(|m| own(*m)).cloned().collect()
    }

    /// The slabs and beams of a cluster, if they are one floor that may be divided: with no more than columns that do not turn in it.
    fn floor_of(&self, cluster: &[usize]) -> Option<Vec<usize>> {
        let kind = |m: usize| self.building.members[m].kind;
        let in_floor = |m: usize| matches!(kind(m), MemberKind::Slab | MemberKind::Beam);
        let floor: Vec<usize> = cluster.iter().copied().filter(|m| in_floor(*m)).collect();
        let columns = || cluster.iter().all(|m| in_floor(*m) || kind(*m) == MemberKind::Column);
        let together = || {
            let shared = |c: &Connection| c.members.iter().all(|m| floor.contains(m));
            self.structure.clusters(shared).iter().any(|c| c.len() == floor.len() && floor.contains(&c[0]))
        };
        (floor.len() == cluster.len() || (!floor.is_empty() && columns() && together())).then_some(floor)
    }
}

impl Division {
    /// Floors that have a line without curves, where none may be computed.
    fn without_curves(&self, known: &joints::Known) -> Result<BTreeSet<String>, GenerateError> {
        let mut floors = BTreeSet::new();
        for (first, line) in &self.lines {
            if known.lacks(&line.wanted)? {
                let piece = &self.bodies.list[*first].id;
                floors.insert(piece.split('/').next().unwrap_or(piece).to_string());
            }
        }
        Ok(floors)
    }
}

/// Springs of the floors that bend, and their pieces that pass through each other.
fn bending_floors(
    building: &Building,
    frame: &Frame,
    floors: &[Divided],
    bodies: &Bodies,
    (springs, lines, yielding): (&mut Vec<Bushing>, &Lines, &mut YieldingEnds),
    contact: &mut Contact,
) -> Vec<SharedMass> {
    for Divided { floor, first, pieces, webs } in floors {
        if let Floor::Bends(grillage) = floor {
            let own = grillage.springs(building, frame, (pieces, webs), (bodies, *first), (lines, yielding));
            springs.extend(own);
            contact.pairs.extend(grillage::corners(pieces, bodies, *first));
        }
    }
    let shared = |own: &Divided| match &own.floor {
        Floor::Bends(grillage) => {
            Some(floor_mass::shared(building, grillage.axes(), &own.pieces, (bodies, own.first)))
        }
        Floor::Folds(_) => None,
    };
    floors.par_iter().filter_map(shared).collect()
}

/// The webs of the floors that bend, with their latent bushings.
fn webs_of(
    building: &Building,
    planes: &[Vec<f64>; 3],
    floors: &[Divided],
    (bodies, decision): (&Bodies, &Decision),
    curves: &mut BTreeMap<String, ResistanceCurve>,
) -> Webs {
    let mut all = Webs::default();
    for Divided { first, webs, .. } in floors {
        all.add(building, planes, (webs, *first), (bodies, decision), curves);
    }
    all
}

fn tracked(building: &Building, partition: &Partition, bodies: &Bodies) -> Vec<TrackedPoint> {
    let point = |t: Tracked| {
        let member = building.members.iter().position(|m| m.id == t.member)?;
        let body = bodies.of(member, t.point_m)?;
        Some(TrackedPoint { id: t.id, body: bodies.list[body].id.clone(), point_m: t.point_m })
    };
    tracked_points(building, partition).into_iter().filter_map(point).collect()
}

/// Whether a member is a bar that may get hinges of its own.
fn is_column(building: &Building, member: usize) -> bool {
    building.members[member].kind == MemberKind::Column
}
