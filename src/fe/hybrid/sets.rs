//! Rigid sets within the step of the nodes.

use super::Refused;
use super::demand::Demand;
use super::motion::{Motion, Twist, carry};
use super::parts::{NONE, Neighbours};
use super::record::{Books, Reason, Switch};
use super::switch::{HybridSettings, Watching};
use crate::base::vector::{V3, add, cross, dot, scale};
use crate::fe::contact::body::Moving;
use crate::fe::dynamics::{Dynamics, Pushed};
use crate::fe::law::ElementForm;
use crate::fe::mesh::Mesh;
use serde::{Deserialize, Serialize};

/// Distance at which a node counts as about to meet a rigid surface \[m\], and steps of its motion that are added.
const NEAR: (f64, f64) = (1e-3, 4.0);

/// Nodes that move as one body.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RigidSet {
    /// Its elements, in order.
    pub elements: Vec<u32>,
    /// Its nodes, in order.
    pub nodes: Vec<u32>,
    /// Their places in the body \[m\].
    pub(super) places: Vec<V3>,
    /// Indices in `nodes` of those that elements outside act on.
    pub(super) boundary: Vec<u32>,
    /// Sums over steps of what these elements do to the nodes of `boundary` \[N\], and the steps.
    pub(super) pull_n: Vec<V3>,
    pub(super) pulls: u32,
    /// Its motion.
    pub motion: Motion,
    /// Largest speed of its nodes in the last step \[m/s\].
    top_speed_m_s: f64,
    /// Distance of its nodes to rigid surfaces when it was looked at, and how far they may have moved since \[m\].
    clear_m: [f64; 2],
    /// What its elements bear.
    #[serde(skip)]
    pub(super) demand: Option<Demand>,
}

/// An impulse on a rigid node.
#[derive(Debug, Clone, Copy)]
struct Hit {
    set: usize,
    index: usize,
    impulse_ns: V3,
    /// Velocity that the contact wanted \[m/s\].
    wanted: V3,
}

/// The rigid sets of a body and what switches them.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Hybrid {
    /// The sets.
    pub sets: Vec<RigidSet>,
    /// Set of each node, [`NONE`] if it has none.
    pub(in crate::fe) set_of: Vec<u32>,
    /// Whether each element is rigid.
    pub(super) resting: Vec<bool>,
    /// Elements that cannot become rigid.
    pub(super) excluded: Vec<bool>,
    /// Parts to become rigid in the next step, those that are already among them.
    planned: Option<(Vec<Vec<u32>>, Reason)>,
    pub(super) settings: HybridSettings,
    pub(super) watching: Watching,
    /// The books.
    pub books: Books,
    /// Nodes that are about to meet something, or did in the last step.
    #[serde(skip)]
    pub(super) near: Vec<u32>,
    /// State of the step under way: twist, momentum before, impulses.
    #[serde(skip)]
    trials: Vec<(Twist, V3)>,
    #[serde(skip)]
    hits: Vec<Hit>,
}

impl Hybrid {
    /// A body without rigid sets yet. `removed`: elements that charges take out.
    ///
    /// # Errors
    /// If its elements cannot become rigid, or a setting makes no sense.
    pub fn new(
        mesh: &Mesh,
        body: &Dynamics,
        removed: &[bool],
        settings: HybridSettings,
    ) -> Result<Self, Refused> {
        settings.check()?;
        for element in &mesh.elements {
            let law = &mesh.laws[element.law];
            let what = match law.form {
                _ if law.concrete.is_some() => "with a law of concrete",
                ElementForm::FullyIntegrated => "of the fully integrated form",
                ElementForm::OnePoint(_) => continue,
            };
            return Err(Refused::Law { part: mesh.parts[element.part].clone(), what });
        }
        let mut busy = vec![false; mesh.nodes.len()];
        for n in 0..mesh.nodes.len() {
            busy[n] = body.prescribed_m_s.is_set(n) || body.applied_n.is_set(n) || body.ties.is_tied(n);
        }
        let masters = body.ties.tied().flat_map(|(_, masters)| masters).map(|(n, _)| *n);
        masters.chain(mesh.trusses.iter().flat_map(|t| t.nodes)).for_each(|n| busy[n] = true);
        let excluded = mesh.elements.iter().enumerate();
        let excluded = excluded.map(|(e, el)| removed[e] || el.nodes.iter().any(|n| busy[*n])).collect();
        Ok(Self {
            sets: Vec::new(),
            set_of: vec![NONE; mesh.nodes.len()],
            resting: vec![false; mesh.elements.len()],
            excluded,
            planned: None,
            watching: Watching::new(body, &settings),
            settings,
            books: Books::default(),
            near: Vec::new(),
            trials: Vec::new(),
            hits: Vec::new(),
        })
    }

    /// Whether rigid parts deform again where something asks for it ([`HybridSettings::softens`]).
    pub fn softens(&self) -> bool {
        self.settings.softens
    }

    /// Whether an element is rigid.
    pub fn is_rigid(&self, element: usize) -> bool {
        self.resting[element]
    }

    /// Number of rigid elements.
    pub fn rigid(&self) -> usize {
        self.sets.iter().map(|s| s.elements.len()).sum()
    }

    /// Makes elements rigid within the next step, together with those that are, as far as they hang together in parts of the least size.
    pub fn plan(&mut self, body: &mut Dynamics, elements: impl Iterator<Item = usize>, reason: Reason) {
        let mut wanted = self.resting.clone();
        for e in elements.filter(|e| !self.excluded[*e] && body.blocks.share(*e) == 1.0) {
            wanted[e] = true;
        }
        let parts = Neighbours::of(&body.blocks).parts(&mut wanted, self.settings.least_elements);
        let lost: Vec<usize> = (0..wanted.len()).filter(|e| self.resting[*e] && !wanted[*e]).collect();
        if !lost.is_empty() {
            self.release(body, &lost, Reason::Remnant);
        }
        self.planned = (!parts.is_empty()).then_some((parts, reason));
    }

    /// Takes elements out of their sets; between steps. What is left of a set goes on as one or several.
    pub fn release(&mut self, body: &mut Dynamics, elements: &[usize], reason: Reason) {
        let rigid = self.rigid();
        let mut hit = vec![false; self.sets.len()];
        for e in elements.iter().filter(|e| self.resting[**e]) {
            let set = self.set_of[body.blocks.nodes_of(*e)[0]];
            hit[set as usize] = true;
        }
        if !hit.contains(&true) {
            return;
        }
        self.planned = None;
        let mut left = vec![false; self.resting.len()];
        let mut kept = Vec::new();
        for (set, hit) in std::mem::take(&mut self.sets).into_iter().zip(hit) {
            if hit {
                set.elements.iter().for_each(|e| left[*e as usize] = true);
            } else {
                kept.push(set);
            }
        }
        elements.iter().for_each(|e| left[*e] = false);
        let parts = Neighbours::of(&body.blocks).parts(&mut left, self.settings.least_elements);
        kept.extend(parts.into_iter().map(|part| RigidSet::of(body, part)));
        self.sets = kept;
        self.connect(body);
        body.blocks.rest(&self.resting, &body.x);
        self.note(body.time_s, reason, rigid - self.rigid(), 0.0);
    }

    /// Takes in that nodal masses have changed.
    pub(super) fn renew(&mut self, body: &Dynamics) {
        self.sets.iter_mut().for_each(|set| *set = RigidSet::of(body, std::mem::take(&mut set.elements)));
        self.connect(body);
    }

    fn note(&mut self, time_s: f64, reason: Reason, elements: usize, energy_j: f64) {
        let (rigid, sets) = (self.rigid(), self.sets.len());
        self.books.switches.push(Switch { time_s, reason, elements, rigid, sets, energy_j });
    }

    /// Finds the set of each node and element, and the boundaries.
    fn connect(&mut self, body: &Dynamics) {
        self.set_of.fill(NONE);
        self.resting.fill(false);
        for (index, set) in self.sets.iter().enumerate() {
            set.nodes.iter().for_each(|n| self.set_of[*n as usize] = index as u32);
            set.elements.iter().for_each(|e| self.resting[*e as usize] = true);
        }
        for set in &mut self.sets {
            let acts = |e: usize| !self.resting[e] && body.blocks.share(e) > 0.0;
            let pulled = |i: &u32| body.blocks.elements_at(set.nodes[*i as usize] as usize).any(acts);
            let boundary: Vec<u32> = (0..set.nodes.len() as u32).filter(pulled).collect();
            if boundary != set.boundary {
                set.pull_n = vec![[0.0; 3]; boundary.len()];
                (set.pulls, set.boundary) = (0, boundary);
            }
        }
    }

    /// Carries out what is planned: after the forces of the step are known, before they act. Returns whether anything changed.
    pub(in crate::fe) fn freeze(&mut self, body: &mut Dynamics) -> bool {
        let Some((parts, reason)) = self.planned.take() else { return false };
        if parts.iter().flatten().any(|e| body.blocks.share(*e as usize) < 1.0) {
            return false; // one has failed in this step
        }
        let before = self.rigid();
        let mut old = std::mem::take(&mut self.sets);
        let (mut energy_j, mut begun) = (0.0, Vec::new());
        for part in parts {
            if let Some(same) = old.iter().position(|s| s.elements == part) {
                self.sets.push(old.swap_remove(same));
                continue;
            }
            let set = RigidSet::of(body, part);
            energy_j += set.take_over(body);
            begun.extend(set.elements.iter().filter(|e| !self.resting[**e as usize]).copied());
            self.sets.push(set);
        }
        for element in begun {
            let force_n = body.blocks.element_force(element as usize, &body.x);
            body.blocks.take_out(element as usize, &force_n);
        }
        self.connect(body);
        self.books.switched_j += energy_j;
        self.note(body.time_s, reason, self.rigid() - before, energy_j);
        true
    }

    /// Leaves the elements of the sets out of the passes from the next one on.
    pub(in crate::fe) fn rest(&self, body: &mut Dynamics) {
        body.blocks.rest(&self.resting, &body.x);
    }

    /// Forces on the sets for the time `kick`, and the velocities for the step `dt` without contact; returns the nodes that meet
    /// something in it.
    pub(in crate::fe) fn push(&mut self, body: &Dynamics, kick: f64, dt: f64) -> Vec<(usize, Pushed)> {
        let mut meeting = Vec::new();
        self.trials.clear();
        self.near.clear();
        let weight = body.acceleration_m_s2;
        let contact = body.body_contact.iter();
        let flagged: Vec<u32> =
            contact.flat_map(|c| c.flagged_nodes()).map(|n| self.set_of[*n as usize]).collect();
        for (s, set) in self.sets.iter_mut().enumerate() {
            self.books.skipped += set.elements.len() as u64;
            let (mut force, mut moment) = (scale(set.motion.mass_kg, weight), [0.0; 3]);
            for (i, sum) in set.boundary.iter().zip(&mut set.pull_n) {
                let n = set.nodes[*i as usize] as usize;
                let pull = scale(-1.0, body.blocks.force_on(n));
                let arm = std::array::from_fn(|k| body.x[n][k] - set.motion.centre_m[k]);
                force = add(force, pull);
                moment = add(moment, cross(arm, pull));
                *sum = add(*sum, pull);
            }
            set.pulls += 1;
            let before = set.motion.momentum;
            set.motion.kick(scale(kick, force), scale(kick, moment));
            let twist = set.motion.twist(dt);
            let reach_m = NEAR.0 + NEAR.1 * dt * set.top_speed_m_s;
            let is_clear = set.is_clear(body, reach_m);
            if is_clear && !flagged.contains(&(s as u32)) {
                self.trials.push((twist, before));
                continue;
            }
            for (i, n) in set.nodes.iter().enumerate() {
                let (n, x) = (*n as usize, &body.x[*n as usize]);
                let flagged = body.body_contact.as_ref().is_some_and(|c| c.flagged[n]);
                if !flagged && !body.surfaces.is_near(n, x, reach_m) {
                    continue;
                }
                self.near.push(n as u32);
                let trial = twist.at(&set.places[i]);
                if flagged || body.surfaces.reached(n, dt, x, &trial) {
                    meeting.push((n, Pushed { trial, driven: [0.0; 3] }));
                }
            }
            self.trials.push((twist, before));
        }
        self.hits.clear();
        meeting
    }

    /// Gives a set the impulse by which contact has changed the velocity of one of its nodes; `false` if the node is in none.
    pub(in crate::fe) fn hit(&mut self, node: &Moving, trial: &V3) -> bool {
        let n = node.at.node;
        let set = self.set_of[n] as usize;
        if self.set_of[n] == NONE {
            return false;
        }
        let change: V3 = std::array::from_fn(|i| node.new[i] - trial[i]);
        if change != [0.0; 3]
            && let Ok(index) = self.sets[set].nodes.binary_search(&(n as u32))
        {
            let impulse_ns = scale(node.at.mass_kg, change);
            let motion = &mut self.sets[set].motion;
            let arm = std::array::from_fn(|i| node.at.x[i] - motion.centre_m[i]);
            motion.kick(impulse_ns, cross(arm, impulse_ns));
            self.hits.push(Hit { set, index, impulse_ns, wanted: node.new });
        }
        true
    }

    /// Moves the sets by the step `dt` and books the work of gravity over the time `kick` and of impulses; returns the kinetic energy at the
    /// full step \[J\] if `measure`.
    pub(in crate::fe) fn finish(&mut self, body: &mut Dynamics, [kick, dt]: [f64; 2], measure: bool) -> f64 {
        let weight = body.acceleration_m_s2;
        let mut kinetic = 0.0;
        let (mut top, ratio) = (0.0_f64, dt / kick);
        for (s, set) in self.sets.iter_mut().enumerate() {
            let (trial, before) = self.trials[s];
            let struck = self.hits.iter().any(|h| h.set == s);
            let twist = if struck { set.motion.twist(dt) } else { trial };
            for hit in self.hits.iter().filter(|h| h.set == s) {
                // the books have the work on the velocity that contact wanted; the set gave the node another
                let now = twist.at(&set.places[hit.index]);
                let off = std::array::from_fn(|i| 0.5 * (now[i] - hit.wanted[i]));
                body.contact_j[0] += dot(hit.impulse_ns, off);
            }
            let after = set.motion.momentum;
            let all = 0.5 * kick * dot(weight, add(before, after));
            let ahead = 0.5 * dt * dot(weight, after);
            body.add_gravity(all - ahead, ahead);
            set.motion.drift(&twist, dt);
            if measure {
                for (n, place) in set.nodes.iter().zip(&set.places) {
                    let (n, new) = (*n as usize, twist.at(place));
                    let (old, pushed) = (body.v[n], trial.at(place));
                    let product: f64 = (0..3).map(|i| new[i] * (new[i] - ratio * (pushed[i] - old[i]))).sum();
                    kinetic += 0.5 * body.mass_kg[n] * product;
                }
            }
            let reference_m_s = body.body_contact.as_ref().map_or([0.0; 3], |c| c.reference_m_s());
            let maps = [twist.map(), set.motion.map()];
            let nodes = (set.nodes.as_slice(), set.places.as_slice());
            let fastest = carry(body.isa, nodes, &maps, &reference_m_s, (&mut body.v, &mut body.x));
            top = top.max(fastest[1]);
            set.top_speed_m_s = fastest[0].sqrt();
            set.clear_m[1] += dt * set.top_speed_m_s;
        }
        if let Some(contact) = &mut body.body_contact {
            contact.top_speed_m_s = contact.top_speed_m_s.max(top.sqrt());
        }
        kinetic
    }
}

impl RigidSet {
    /// Whether none of its nodes can be near a rigid surface.
    fn is_clear(&mut self, body: &Dynamics, reach_m: f64) -> bool {
        let [clear, moved] = self.clear_m;
        if clear - moved > reach_m {
            return true;
        }
        let gap = |n: &u32| body.surfaces.gap_m(*n as usize, &body.x[*n as usize]);
        let least_m = self.nodes.iter().map(gap).fold(f64::INFINITY, f64::min);
        // round-off
        self.clear_m = [(1.0 - 1e-9) * least_m, 0.0];
        self.clear_m[0] > reach_m
    }

    /// The set of these elements with the momenta that its nodes have.
    pub(super) fn of(body: &Dynamics, elements: Vec<u32>) -> Self {
        let mut nodes: Vec<u32> =
            elements.iter().flat_map(|e| body.blocks.nodes_of(*e as usize)).map(|n| n as u32).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut places = Vec::with_capacity(nodes.len());
        let state = nodes.iter().map(|n| *n as usize).map(|n| (body.mass_kg[n], body.x[n], body.v[n]));
        let motion = Motion::of(state, &mut places);
        let fastest = nodes.iter().map(|n| dot(body.v[*n as usize], body.v[*n as usize])).fold(0.0, f64::max);
        Self {
            elements,
            nodes,
            places,
            boundary: Vec::new(),
            pull_n: Vec::new(),
            pulls: 0,
            motion,
            top_speed_m_s: fastest.sqrt(),
            clear_m: [0.0; 2],
            demand: None,
        }
    }

    /// Gives the nodes the set's velocities of the step that led here. Returns the change of energy \[J\]: that of the kinetic energy, and
    /// the half of the last increment's work that is in the books and whose forces will not act.
    fn take_over(&self, body: &mut Dynamics) -> f64 {
        let twist = self.motion.twist(-body.taken_s);
        let mut energy_j = 0.0;
        for (n, place) in self.nodes.iter().zip(&self.places) {
            let n = *n as usize;
            let (old, new, force) = (body.v[n], twist.at(place), body.internal_n(n));
            let change: V3 = std::array::from_fn(|i| new[i] - old[i]);
            energy_j += 0.5 * body.mass_kg[n] * (dot(new, new) - dot(old, old));
            energy_j -= 0.5 * body.taken_s * dot(force, change);
            body.v[n] = new;
        }
        energy_j
    }
}
