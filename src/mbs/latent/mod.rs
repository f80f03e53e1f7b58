//! Latent bushings: bodies that are one until a section between them reaches its resistance.
//!
//! A model may say of a bushing that it is *latent*: the bodies on its sides then move as one, and cost what one body costs. In every step the forces that it would have to
//! bear follow from what acts on the pieces of that body ([`demand`]), unless a bound tells that they cannot have changed by what is left of it ([`bound`]). When they reach the resistance of the bushing, the body parts there ([`Parting`]): its pieces go on
//! with exactly its momenta, and the bushing goes live with the forces that it had to bear, so that nothing jumps.
//!
//! | file | owns |
//! |---|---|
//! | this one | who is latent, when a body parts |
//! | `look` | which bodies part under their loads |
//! | `merge` | a model in which latent bushings are rigid |
//! | `demand` | what latent bushings bear |
//! | `bound` | by how much that can have changed |
//! | `history` | which bodies moved as one in a run that is over |

mod bound;
mod demand;
mod history;
mod look;
mod merge;

pub use history::{compounds, is_gone, live_s};
pub use merge::{Merged, Place, held_together, merge, together};

use super::contact::ContactSet;
use super::joint::JointData;
use super::math::{self, V3};
use super::model::{Bushing, Model};
use super::system::System;
use super::tables::Tables;
use crate::curve::{CurveError, ResistanceCurve};
use bound::Attached;
use demand::Demand;
use look::Compound;
use std::collections::{BTreeMap, BTreeSet};

/// A body that parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Parting {
    /// The bushing that reached its resistance.
    pub cause: usize,
    /// Bushings that go live, each with its force and moment along its axes \[N, N m\].
    pub live: Vec<(usize, [V3; 2])>,
}

/// The latent bushings of a run.
#[derive(Debug, Clone)]
pub struct Latent {
    /// Where the bodies and bushings of the file are in the running model.
    pub places: Vec<Place>,
    /// The bushing of the running model that each one of the file is.
    pub bushings: Vec<Option<usize>>,
    /// Bodies of the file in each body of the running model.
    pub pieces: Vec<Vec<usize>>,
    held: Vec<bool>,
    /// Whether none gives way, whatever it bears.
    holds: bool,
    /// Those that may give way; others wait for a rule about an event.
    watched: Vec<bool>,
    /// Bodies of the running model in which any waits.
    waiting: Vec<bool>,
    /// Section of each bushing of the file.
    sections: Vec<Option<String>>,
    parted: bool,
    /// The body of the model that runs first which each body of the file is in.
    family: Vec<usize>,
    compounds: Vec<Compound>,
    /// How many are latent, and how many of them are looked at.
    counted: [u64; 2],
    /// Whether those that are watched are looked at whatever their loads, and looks made and left out.
    looks_always: bool,
    looks: [u64; 2],
    /// The model with nothing latent, in its initial poses.
    whole: Option<System>,
    /// Largest share of its resistance that each bushing has borne while it was latent.
    peak: Vec<f64>,
    /// Compound and piece in it of each solid of the running model.
    solids: Vec<Option<(usize, usize)>>,
    /// Curves that are compiled already.
    known: Tables,
}

impl Latent {
    /// The latent bushings of a checked model, and the model that runs first.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn new(file: &Model) -> Result<(Self, Option<Model>), CurveError> {
        Self::with_tables(file, &Tables::default())
    }

    /// The same with what is compiled already.
    pub fn with_tables(file: &Model, known: &Tables) -> Result<(Self, Option<Model>), CurveError> {
        let held: Vec<bool> = file.bushings.iter().map(|b| b.latent.is_some()).collect();
        let is_any = held.contains(&true);
        let (bodies, alone) = (0..file.bodies.len(), |body| Place { body, pose: None });
        let mut latent = Self {
            places: bodies.clone().map(alone).collect(),
            bushings: (0..held.len()).map(Some).collect(),
            pieces: bodies.clone().map(|i| vec![i]).collect(),
            peak: vec![0.0; held.len()],
            holds: false,
            watched: watched_from_begin(file),
            waiting: Vec::new(),
            held,
            sections: file.bushings.iter().map(|b| b.latent.clone()).collect(),
            parted: false,
            family: bodies.collect(),
            compounds: Vec::new(),
            counted: [0; 2],
            looks_always: false,
            looks: [0; 2],
            whole: is_any.then(|| System::with_tables(file, known.clone())).transpose()?,
            solids: Vec::new(),
            known: known.clone(),
        };
        if !is_any {
            return Ok((latent, None));
        }
        let first = latent.rebuild(file);
        latent.family = latent.places.iter().map(|p| p.body).collect();
        Ok((latent, Some(first)))
    }

    /// Compiles a model of some of the pieces of the file.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn compile(&self, model: &Model) -> Result<System, CurveError> {
        let tables = self.whole.as_ref().map_or(&self.known, |w| &w.tables);
        System::with_tables(model, tables.clone())
    }

    /// Whether none gives way from now on, whatever it bears; events of the file still part bodies.
    pub fn hold(&mut self, holds: bool) {
        self.holds = holds;
        self.count_watched();
    }

    /// Whether bushings that are watched are looked at in every step, whatever the bound of their loads says.
    pub fn look_always(&mut self, always: bool) {
        self.looks_always = always;
    }

    /// The model with the bushings that are latent now.
    fn rebuild(&mut self, file: &Model) -> Model {
        let mut before = std::mem::take(&mut self.compounds);
        let felt = |before: &[Compound], piece: usize| {
            let old = before
                .iter()
                .find_map(|c| self.pieces[c.body].iter().position(|p| *p == piece).map(|k| c.contact[k]));
            old.unwrap_or_default()
        };
        let merged = merge(file, &self.held);
        let whole = self.whole.as_ref();
        let mut compounds = Vec::new();
        let mut solids = Vec::new();
        for (body, own) in merged.pieces.iter().enumerate() {
            let compound = (own.len() > 1).then_some(compounds.len());
            for (k, piece) in own.iter().enumerate() {
                let count = file.bodies[*piece].shapes.len();
                solids.extend(std::iter::repeat_n(compound.map(|c| (c, k)), count));
            }
            let Some(whole) = whole.filter(|_| own.len() > 1) else { continue };
            let inside = |b: usize| self.held[b] && own.contains(&whole.joints[b].b);
            let bushings: Vec<usize> = (0..self.held.len()).filter(|b| inside(*b)).collect();
            let joints: Vec<&JointData> = bushings.iter().map(|b| &whole.joints[*b]).collect();
            let center = merged.model.bodies[body].position_m;
            // what has not changed need not be found again
            let same = |c: &Compound| c.bushings == bushings && self.pieces[c.body] == *own;
            let contact: Vec<[V3; 2]> = own.iter().map(|p| felt(&before, *p)).collect();
            let demand = match before.iter().position(same) {
                Some(old) => before.swap_remove(old).demand,
                None => Demand::new(&whole.bodies, &whole.data, own, &joints, center),
            };
            let piece_of = |body: usize| own.iter().position(|p| *p == body);
            let mut attached = Vec::new();
            for (b, running) in merged.bushings.iter().enumerate() {
                let Some(running) = running else { continue };
                let joint = &whole.joints[b];
                let at = |is_second: bool| move |piece| Attached { joint: *running, is_second, piece };
                attached.extend(piece_of(joint.a).map(at(false)));
                attached.extend(piece_of(joint.b).map(at(true)));
            }
            let now = contact.clone();
            compounds.push(Compound {
                body,
                bushings,
                is_watched: false,
                waits: false,
                demand,
                attached,
                contact,
                now,
                bound: None,
            });
        }
        (self.places, self.pieces, self.bushings) = (merged.places, merged.pieces, merged.bushings);
        (self.compounds, self.solids) = (compounds, solids);
        self.count_watched();
        merged.model
    }

    fn count_watched(&mut self) {
        for compound in &mut self.compounds {
            let of = compound.bushings.iter().filter(|_| !self.holds);
            let mut watched = of.map(|b| self.watched[*b]);
            (compound.is_watched, compound.waits) = (watched.clone().any(|w| w), watched.any(|w| !w));
        }
        let looked_at =
            |c: &Compound| c.bushings.iter().filter(|b| !self.holds && self.watched[**b]).count() as u64;
        let latent = self.compounds.iter().map(|c| c.bushings.len() as u64).sum();
        self.counted = [latent, self.compounds.iter().map(looked_at).sum()];
        self.waiting.clear();
        self.waiting.resize(self.pieces.len(), false);
        self.compounds.iter().for_each(|c| self.waiting[c.body] = c.waits);
    }

    /// Whether any latent bushing may give way.
    pub fn is_watching(&self) -> bool {
        self.compounds.iter().any(|c| c.is_watched)
    }

    /// How many bushings are latent now, and how many of them are looked at.
    pub fn counted(&self) -> [u64; 2] {
        self.counted
    }

    /// Looks at single bushings so far that were made, and that were left out by the bound of their loads.
    pub fn looks(&self) -> [u64; 2] {
        self.looks
    }

    /// Whether any latent bushing waits for a rule about an event.
    pub fn is_waiting(&self) -> bool {
        self.compounds.iter().any(|c| c.waits)
    }

    /// Whether any in a body of the running model does.
    pub fn waits(&self, body: usize) -> bool {
        self.waiting.get(body) == Some(&true)
    }

    /// Those of some bushings, in order, that are latent in a body of the running model and wait.
    pub fn waiting_in(&self, body: usize, of: &[usize]) -> Vec<usize> {
        let own = self.compounds.iter().filter(|c| c.body == body).flat_map(|c| &c.bushings);
        own.copied().filter(|b| !self.watched[*b] && of.binary_search(b).is_ok()).collect()
    }

    /// Has some latent bushings watched.
    pub fn watch(&mut self, bushings: &[usize]) {
        bushings.iter().for_each(|b| self.watched[*b] = true);
        self.count_watched();
    }

    /// Whether bodies of the running model were one at the start; the ground, which comes last, was never part of one.
    pub fn were_one(&self, a: usize, b: usize) -> bool {
        let first = |body: usize| self.pieces.get(body).map(|own| self.family[own[0]]);
        a == b || first(a).is_some() && first(a) == first(b)
    }

    /// Whether a bushing has gone live.
    pub fn has_parted(&self) -> bool {
        self.parted
    }

    /// Axial force of a latent bushing of the file, compression positive \[N\].
    pub fn axial_n(&self, bushing: usize) -> f64 {
        let force = self.borne(bushing).map_or(0.0, |[force, _]| force[0]);
        self.whole.as_ref().map_or(0.0, |whole| -whole.joints[bushing].outward * force)
    }

    /// Sets the strength of the curves of a latent bushing to a share of that in the file.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn weaken(
        &mut self,
        given: &Bushing,
        bushing: usize,
        share: f64,
        curves: &BTreeMap<String, ResistanceCurve>,
    ) -> Result<(), CurveError> {
        if let Some(whole) = &mut self.whole {
            whole.set_strength(bushing, given, share, curves)?;
        }
        self.compounds.iter_mut().for_each(|c| c.bound = None);
        Ok(())
    }

    /// Whether a bushing of the file is latent.
    pub fn is_held(&self, bushing: usize) -> bool {
        self.held[bushing]
    }

    /// Largest share of its resistance that a bushing of the file has borne while it was latent.
    pub fn peak(&self, bushing: usize) -> f64 {
        self.peak[bushing]
    }

    /// The body of a latent bushing parts there.
    pub fn parting(&mut self, system: &System, cause: usize) -> Parting {
        let Some(compound) = self.compounds.iter_mut().find(|c| c.bushings.contains(&cause)) else {
            return Parting { cause, live: Vec::new() };
        };
        compound.load(system, false);
        let Some(whole) = &self.whole else { return Parting { cause, live: Vec::new() } };
        let ends = |b: usize| {
            let joint = &whole.joints[b];
            (joint.a.min(joint.b), joint.a.max(joint.b))
        };
        let together = |b: &usize| self.sections[*b] == self.sections[cause] || ends(*b) == ends(cause);
        let section: Vec<usize> = compound.bushings.iter().copied().filter(together).collect();
        let rest: Vec<(usize, usize)> =
            compound.bushings.iter().filter(|b| !section.contains(b)).map(|b| ends(*b)).collect();
        // in a loop of pieces the others would hold these rigid
        let parts = if are_linked(&rest, ends(cause)) { compound.bushings.clone() } else { section };
        let forces = |b: usize| {
            let l = compound.bushings.iter().position(|o| *o == b).unwrap_or(0);
            compound.demand.of(l)
        };
        Parting { cause, live: parts.into_iter().map(|b| (b, forces(b))).collect() }
    }

    /// Takes in the contacts of a step of `h` \[s\]; none: there were none.
    pub fn feel(&mut self, system: &System, contacts: Option<&ContactSet>, h: f64) {
        for compound in self.compounds.iter_mut().filter(|c| c.is_watched) {
            let fade = libm::exp(-h * compound.demand.frequency_rad_s());
            for (now, felt) in compound.now.iter_mut().zip(&compound.contact) {
                *now = felt.map(|v| math::scale(fade, v));
            }
        }
        let (Some(contacts), compounds, solids) = (contacts, &mut self.compounds, &self.solids) else {
            return;
        };
        contacts.each_impulse(|solid, arm, impulse| {
            let Some((c, piece)) = solids.get(solid).copied().flatten() else { return };
            let compound = &mut compounds[c];
            if !compound.is_watched {
                return;
            }
            let share = (1.0 - libm::exp(-h * compound.demand.frequency_rad_s())) / h;
            let r = &system.bodies[compound.body].r;
            let force = math::mul_t(r, math::scale(share, impulse));
            let [f, m] = &mut compound.now[piece];
            *f = math::add(*f, force);
            *m = math::add(*m, math::cross(math::mul_t(r, arm), force));
        });
    }

    /// The contacts of the step count as borne.
    pub fn keep(&mut self) {
        for compound in self.compounds.iter_mut().filter(|c| c.is_watched) {
            compound.contact.clone_from(&compound.now);
        }
    }

    /// The contacts of the step did not happen.
    pub fn drop_step(&mut self) {
        for compound in self.compounds.iter_mut().filter(|c| c.is_watched) {
            compound.now.clone_from(&compound.contact);
        }
    }

    /// Finds what all latent bushings bear in the present poses.
    pub fn weigh(&mut self, system: &System) {
        for compound in self.compounds.iter_mut().filter(|c| system.data[c.body].alive) {
            compound.load(system, false);
        }
    }

    /// Force and moment along the axes of a latent bushing of the file \[N, N m\], as they were found last.
    pub fn borne(&self, bushing: usize) -> Option<[V3; 2]> {
        self.compounds.iter().find_map(|c| {
            let l = c.bushings.iter().position(|b| *b == bushing)?;
            Some(c.demand.of(l))
        })
    }

    /// Parts a body: the system and the model that go on, in the present poses and with the momenta of the full step. Energy that the bushings bring into the balance is in their books.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn part(
        &mut self,
        file: &Model,
        system: &System,
        parting: &Parting,
    ) -> Result<(System, Model), CurveError> {
        let (places, pieces, bushings) = (self.places.clone(), self.pieces.clone(), self.bushings.clone());
        parting.live.iter().for_each(|(b, _)| self.held[*b] = false);
        self.parted |= !parting.live.is_empty();
        let model = self.rebuild(file);
        let mut next = System::with_tables(&model, system.tables.clone())?;
        for (body, own) in self.pieces.iter().enumerate() {
            let was = places[own[0]];
            if pieces[was.body] == *own {
                next.bodies[body] = system.bodies[was.body];
                next.data[body].alive = system.data[was.body].alive;
            } else {
                hand_over(system, &mut next, was, self.places[own[0]]);
            }
        }
        for (b, running) in self.bushings.iter().enumerate() {
            let Some(running) = *running else { continue };
            let joint = &mut next.joints[running];
            match bushings[b] {
                Some(old) => joint.adopt(&system.joints[old]),
                None => {
                    if let Some((_, [force, moment])) = parting.live.iter().find(|(live, _)| *live == b) {
                        let gap = std::array::from_fn(|i| force[i] / joint.translation[i]);
                        joint.strain(gap, std::array::from_fn(|i| moment[i] / joint.rotation[i]));
                    }
                }
            }
        }
        self.orient(&mut next);
        next.resume_carries();
        next.pack();
        Ok((next, model))
    }

    /// Sets which sense of a bushing is tension: its own bodies decide, not those they are part of.
    pub fn orient(&self, system: &mut System) {
        let Some(whole) = &self.whole else { return };
        for (own, running) in whole.joints.iter().zip(&self.bushings) {
            if let Some(running) = running {
                system.joints[*running].outward = own.outward;
            }
        }
    }
}

/// Which bushings of a model are watched from the start: those that no rule about events names.
fn watched_from_begin(file: &Model) -> Vec<bool> {
    let named: BTreeSet<&String> = file.event_rules.iter().flat_map(|r| &r.watch).collect();
    file.bushings.iter().map(|b| !named.contains(&b.id)).collect()
}

/// Whether links connect two pieces.
fn are_linked(links: &[(usize, usize)], ends: (usize, usize)) -> bool {
    let mut reached = vec![ends.0];
    let mut next = 0;
    while next < reached.len() {
        let at = reached[next];
        for (a, b) in links {
            let other = if *a == at {
                *b
            } else if *b == at {
                *a
            } else {
                continue;
            };
            if !reached.contains(&other) {
                reached.push(other);
            }
        }
        next += 1;
    }
    reached.contains(&ends.1)
}

/// Gives a body of the next system the motion that one of its pieces has in the body that parts.
fn hand_over(old: &System, next: &mut System, was: Place, is: Place) {
    let (from, data) = (&old.bodies[was.body], &old.data[was.body]);
    let (body, own) = (&mut next.bodies[is.body], &mut next.data[is.body]);
    let (x, q) = was.of(from.x, from.q, &from.r);
    // a body of several pieces has the axes of the one that it was part of
    (body.x, body.q) = match is.pose {
        None => (x, q),
        Some((offset, _)) => (math::sub(x, math::mul(&from.r, offset)), from.q),
    };
    body.r = math::qmat(body.q);
    let spin = math::mul(&from.r, math::mul(&data.inverse_inertia, math::mul_t(&from.r, from.l)));
    let speed = math::scale(data.inverse_mass, from.p);
    own.alive = data.alive;
    body.v = math::add(speed, math::cross(spin, math::sub(body.x, from.x)));
    body.p = math::scale(own.mass, body.v);
    body.w = spin;
    body.w_body = math::mul_t(&body.r, spin);
    body.l = math::mul(&body.r, math::mul(&own.inertia, body.w_body));
}
