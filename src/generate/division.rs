//! Members that are one body, floors in pieces, and columns in pieces: the bodies of a model.

use super::beam_ends::YieldingEnds;
use super::bodies::{self, Bodies};
use super::cells::Piece;
use super::decide::Decision;
use super::floors::{Grid, Line};
use super::grillage::{self, Grillage};
use super::lines::Lines;
use super::stumps::Stumps;
use super::webs::{self, Stays, Web, Webs};
use super::{Accuracy, GenerateError, Unmet, charges, entries, floor_mass, joints};
use crate::building::ends::MemberEnd;
use crate::building::{Building, MemberKind};
use crate::curve::ResistanceCurve;
use crate::fe::mesh::Mesh;
use crate::graph::frame::Frame;
use crate::graph::{Connection, Structure};
use crate::mbs::model::{Bushing, Contact, SharedMass};
use crate::rules::Action;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// How a floor is divided.
enum Floor {
    /// At lines at which it may fold.
    Folds(Grid),
    /// About its columns, with springs in between.
    Bends(Grillage),
}

/// A floor in pieces, which are the bodies from some place on.
pub struct Divided {
    floor: Floor,
    pub first: usize,
    pieces: Vec<Piece>,
    pub webs: Vec<Web>,
}

/// What is divided.
pub struct Parts<'a> {
    pub building: &'a Building,
    pub structure: &'a Structure,
    pub mesh: &'a Mesh,
    pub clusters: &'a [Vec<usize>],
    pub ends: &'a [MemberEnd],
    pub decision: &'a Decision,
    pub accuracy: Accuracy,
}

/// The bodies of clusters of members, and the lines at which floors may fold with the first body of their floor.
pub struct Division {
    pub bodies: Bodies,
    pub floors: Vec<Divided>,
    pub lines: Vec<(usize, Line)>,
    /// Beams that cannot break away.
    pub stays: Stays,
    /// What rules decide about parts of floors and the floors are not.
    pub unmet: Vec<Unmet>,
    pub notes: Vec<String>,
}

impl Parts<'_> {
    /// One body a cluster, or the pieces of a floor that bends or may fold; `without` are floors for whose lines there are no curves: they stay in one piece.
    pub fn divided(&self, without: &BTreeSet<String>) -> Result<Division, GenerateError> {
        let Self { building, structure, mesh, clusters, decision, .. } = *self;
        let (mut bodies, mut floors, mut notes) =
            (Bodies::new(building.members.len()), Vec::new(), Vec::new());
        let (mut stays, mut unmet) = (Stays::default(), Vec::new());
        let charged = charges::first_on(building);
        for cluster in clusters {
            let name = bodies::name(building, cluster);
            let division = self.division(cluster, &name, without, (&mut notes, &mut unmet))?;
            if !matches!(division, Some(Floor::Bends(_))) {
                let away: Vec<usize> = cluster.iter().copied().filter(|m| decision.breaks_away(*m)).collect();
                let why = format!(
                    "the floor {name} does not bend; `merge_elastic` has it bend, and so does `--accuracy balanced`"
                );
                stays.add(building, &away, &why, decision)?;
            }
            match division {
                None => self.add_whole(cluster, &name, &mut bodies)?,
                Some(floor) => {
                    let named = (cluster.as_slice(), name.as_str());
                    floors.push(self.add_floor(named, floor, &charged, (&mut bodies, &mut stays))?);
                }
            }
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
        Ok(Division { bodies, floors, lines, stays, unmet, notes })
    }

    /// Adds a cluster that is one body, or in its pieces a column that may break between its ends, or of which charges take a stretch.
    ///
    /// # Errors
    /// If they take one out of a column that is one with other members.
    fn add_whole(&self, cluster: &[usize], name: &str, bodies: &mut Bodies) -> Result<(), GenerateError> {
        let Self { building, structure, decision, .. } = *self;
        let rules = decision.rules_of(building, cluster);
        let column = if let [column] = *cluster { Some(column) } else { None };
        let stumps = || cluster.iter().find_map(|m| Stumps::of(building, structure, *m));
        if let Some(stumps) = stumps().filter(|stumps| !stumps.is_taken_whole()) {
            if column.is_none() {
                return Err(GenerateError::Stretch(building.members[stumps.member].id.clone()));
            }
            let pieces = stumps.cut(structure, building.members[stumps.member].axis);
            let id = |p: &Piece| format!("{name}/{}", p.cell[0] + 1);
            let own = pieces.iter().map(|p| p.body(building, structure, id(p), rules.clone())).collect();
            bodies.add_stumps(stumps, pieces, own);
            return Ok(());
        }
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
        Ok(())
    }

    /// Adds the pieces of a floor, and the beams that may break away from them; `charged` are the charges on members.
    fn add_floor(
        &self,
        (cluster, name): (&[usize], &str),
        floor: Floor,
        charged: &[Option<usize>],
        (bodies, stays): (&mut Bodies, &mut Stays),
    ) -> Result<Divided, GenerateError> {
        let Self { building, structure, decision, .. } = *self;
        let rules = decision.rules_of(building, cluster);
        let cells = match &floor {
            Floor::Folds(grid) => grid.cells(),
            Floor::Bends(grillage) => grillage.cells.clone(),
        };
        let whole = cells.members.len() == cluster.len();
        let pieces = if whole { cells } else { cells.with(cluster) }.pieces(structure);
        let (webs, bare) = match floor {
            Floor::Bends(_) => {
                let is_charged = |m: usize| {
                    let is_beam = building.members[m].kind == MemberKind::Beam;
                    cluster.len() > 1 && is_beam && charged[m].is_some()
                };
                let parts = |m: &usize| decision.breaks_away(*m) || is_charged(*m);
                let beams: Vec<usize> = cluster.iter().copied().filter(parts).collect();
                webs::of_floor(building, &beams, &pieces)
            }
            Floor::Folds(_) => Default::default(),
        };
        let bare: Vec<usize> = bare.into_iter().filter(|m| decision.breaks_away(*m)).collect();
        stays.add(building, &bare, "no slab lies on it where it is clear of columns", decision)?;
        let own = pieces.iter().enumerate().map(|(i, p)| {
            let named = (p.name(name), rules.clone());
            webs::rest(building, structure, (i, p), &webs, named)
        });
        let first = bodies.add_pieces(cluster, pieces.clone(), own.collect());
        let of_web =
            |w: &Web| w.body(building, structure, &pieces, decision.fired(&w.question(building, decision)));
        bodies.add_parts(webs.iter().map(of_web));
        if matches!(floor, Floor::Bends(_)) {
            bodies.bends(first, pieces.len());
        }
        Ok(Divided { floor, first, pieces, webs })
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
        (notes, unmet): (&mut Vec<String>, &mut Vec<Unmet>),
    ) -> Result<Option<Floor>, GenerateError> {
        let Self { building, structure, decision, .. } = *self;
        let ends = self.ends_of(cluster);
        let folds = ends.iter().any(|e| decision.latent.contains_key(&e.id));
        let members = cluster.iter().map(|m| &building.members[*m].id);
        let asked = decision.division_asked(members.chain(ends.iter().map(|e| &e.id)));
        // who asks for a line at which a floor may fold gets it, whatever the rules say of bending
        let bends = decision.bends(cluster) && !matches!(asked, Some((_, false)));
        let Some(floor) = self.floor_of(cluster) else {
            let why = format!("{name} stays in one piece: it is one body with more than its floor");
            return match asked {
                Some((target, _)) => Err(GenerateError::Override(target, why)),
                None => {
                    notes.extend((bends || folds).then_some(why));
                    Ok(None)
                }
            };
        };
        let grillage = bends.then(|| Grillage::of(building, structure, &floor, self.accuracy)).flatten();
        let too_few = format!("{name} has columns on less than two axes, between which it could bend");
        if let (None, Some((target, true))) = (&grillage, &asked) {
            return Err(GenerateError::Override(target.clone(), too_few));
        }
        if let Some(grillage) = grillage {
            let why = format!(
                "{name} bends, as is decided about others of its members, and a floor does so as a whole"
            );
            unmet.extend(Unmet::of(building, decision, (cluster, Action::MergeRigid, &why)));
            return Ok(Some(Floor::Bends(grillage)));
        }
        if bends {
            unmet.extend(Unmet::of(building, decision, (cluster, Action::MergeElastic, &too_few)));
        }
        if !folds {
            return Ok(None);
        }
        let why = if without.contains(name) {
            "the library has no curves for the lines at which it may fold, nor similar ones; `--derive` computes them"
                .to_string()
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
    pub fn without_curves(&self, known: &entries::Known) -> Result<BTreeSet<String>, GenerateError> {
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
pub fn bending_floors(
    building: &Building,
    frame: &Frame,
    floors: &[Divided],
    bodies: &Bodies,
    (springs, lines, yielding): (&mut Vec<Bushing>, &Lines, &mut YieldingEnds),
    contact: &mut Contact,
) -> Vec<SharedMass> {
    let laid_out = floors.par_iter().filter_map(|own| match &own.floor {
        Floor::Bends(grillage) => Some((own, grillage.layout(building, frame, &own.pieces, lines))),
        Floor::Folds(_) => None,
    });
    for (Divided { first, pieces, webs, .. }, layout) in laid_out.collect::<Vec<_>>() {
        let own = (bodies, *first);
        springs.extend(grillage::springs(building, layout, (pieces, webs), own, yielding));
        contact.pairs.extend(grillage::corners(pieces, bodies, *first));
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
pub fn webs_of(
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
