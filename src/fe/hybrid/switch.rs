//! When parts of a body become rigid, and when they deform again.
//!
//! **Rigid** are elements that have been quiet for long enough, with all their neighbours: over [`WINDOW_S`] their net strain rate (rotations strain nothing, vibration within
//! the window does not count) is below [`HybridSettings::rate_1_s`], time and again for [`HybridSettings::quiet_s`]. The layer of quiet
//! elements around a set stays deformable; it is where the next criterion looks.
//!
//! **Deformable again** is everything where a charge goes off, and parts of a set for one of three reasons, each with the rings of elements around its cause ([`HybridSettings::rings`]):
//! * **contact**, looked at in every step: a node is about to meet a surface or another part of the body. Stress waves in concrete carry some 6 MPa for each m/s
//!   of impact, so that a collapsing building's contacts nearly always break what they meet: there is nothing to weigh up. At [`BLOW_M_S`] and above all of the set is released;
//! * **flow**, looked at every [`FLOW_S`]: an element beside the set flows faster than the critical rate. Plastic zones that grow from outside into a set cross the layer around it;
//! * **overload**, looked at every [`HybridSettings::check_s`]: the loads on the set would make an element in it flow ([`super::demand`]). This finds zones that begin within a set.
//!
//! With [`HybridSettings::softens`] off none of this happens: what such a run differs by from one with it is what switching is for.
//!
//! What is missed: what happens within a set between two checks, or before the first one up to [`FACTOR_S`] after it has changed, and vibrations about its static state, whose stresses a rigid part cannot have.

use super::Refused;
use super::demand::Demand;
use super::parts::{NONE, Neighbours};
use super::record::Reason;
use super::sets::Hybrid;
use crate::base::vector::{V3, dot};
use crate::fe::dynamics::Dynamics;
use crate::fe::strain_rate::net_strain;
use serde::{Deserialize, Serialize};

/// Time over which strain rates are taken \[s\].
pub const WINDOW_S: f64 = 0.01;
/// Time between two looks at the elements around the sets \[s\].
pub const FLOW_S: f64 = 0.001;
/// Time between two rounds in which changed sets get their stiffness factorised \[s\]: one costs as much as some hundred steps.
pub const FACTOR_S: f64 = 0.02;
/// Distance from a rigid surface within which a node keeps its elements deformable \[m\]: beyond that at which a node at rest counts as about to meet it.
const TOUCHING_M: f64 = 2e-3;
/// Speed of a contact from which it is a blow \[m/s\]: its waves reach all of a part before the next check of loads, and bend slender members by a third of their elastic strain.
const BLOW_M_S: f64 = 0.5;
/// New elements, over those there are, from which sets are made anew.
const WORTHWHILE: f64 = 0.01;

/// What decides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HybridSettings {
    /// Whether sets switch by themselves.
    pub automatic: bool,
    /// Whether rigid parts deform again where contact, flow beside them or their loads ask for it. If not, what has become rigid stays so to the end: for comparison only.
    pub softens: bool,
    /// Strain rate below which an element is quiet \[1/s\].
    pub rate_1_s: f64,
    /// Time for which it has to be \[s\].
    pub quiet_s: f64,
    /// Time after a charge, and the time over which its forces fall, for which nothing begins to be quiet \[s\]: what becomes rigid before it has begun to move is held.
    pub settle_s: f64,
    /// Elements that a rigid part has at least.
    pub least_elements: usize,
    /// Time between two checks of the loads on sets \[s\].
    pub check_s: f64,
    /// Plastic strain that the loads on a set may not cause in it.
    pub overload_strain: f64,
    /// Rings of elements around a cause that are released with it.
    pub rings: usize,
    /// Elements that may become rigid, and are from the start; none: all that become quiet.
    pub rigid_from_start: Option<Vec<bool>>,
}

impl Default for HybridSettings {
    fn default() -> Self {
        Self {
            automatic: true,
            softens: true,
            rate_1_s: 0.025,
            quiet_s: 0.02,
            settle_s: 0.15,
            least_elements: 16,
            check_s: 0.008,
            overload_strain: 2e-4,
            rings: 2,
            rigid_from_start: None,
        }
    }
}

impl HybridSettings {
    pub(super) fn check(&self) -> Result<(), Refused> {
        let positive = [
            ("the rate below which parts become rigid", self.rate_1_s),
            ("the time for which parts have to be quiet", self.quiet_s),
            ("the time between two checks of rigid parts", self.check_s),
            ("the plastic strain that overloads a rigid part", self.overload_strain),
        ];
        if !(self.settle_s >= 0.0 && self.settle_s.is_finite()) {
            let name = "the time after a charge for which nothing becomes rigid";
            return Err(Refused::Setting {
                name,
                value: self.settle_s,
                expected: "zero or a positive number",
            });
        }
        match positive.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            Some((name, value)) => Err(Refused::Setting { name, value, expected: "a positive number" }),
            None => Ok(()),
        }
    }
}

/// What is remembered for the criteria.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Watching {
    /// Positions at the start of the window \[m\].
    start_m: Vec<V3>,
    window_ends_s: f64,
    /// How long each element has been quiet \[s\]; negative: has to wait.
    quiet_s: Vec<f64>,
    flow_at_s: f64,
    flow_since_s: f64,
    /// Plastic strain of all elements at the last look at the layer.
    strained: Vec<f64>,
    check_at_s: f64,
    factor_at_s: f64,
    begun: bool,
}

impl Watching {
    pub(super) fn new(body: &Dynamics, settings: &HybridSettings) -> Self {
        Self {
            start_m: body.x.clone(),
            window_ends_s: body.time_s + WINDOW_S,
            quiet_s: vec![0.0; body.blocks.elements()],
            flow_at_s: body.time_s + FLOW_S,
            flow_since_s: body.time_s,
            strained: vec![0.0; body.blocks.elements()],
            check_at_s: body.time_s + settings.check_s,
            factor_at_s: body.time_s,
            begun: false,
        }
    }
}

impl Hybrid {
    /// Decides at the end of a step which elements become rigid in the next one, and releases what has to deform.
    pub(in crate::fe) fn decide(&mut self, body: &mut Dynamics) {
        if !self.settings.automatic {
            return;
        }
        if !self.watching.begun {
            self.watching.begun = true;
            if let Some(allowed) = self.settings.rigid_from_start.clone() {
                self.plan(body, (0..allowed.len()).filter(|e| allowed[*e]), Reason::Quiet);
            }
        }
        let now = body.time_s;
        if self.settings.softens {
            self.soften(body);
        }
        if now >= self.watching.window_ends_s {
            self.end_window(body);
        }
    }

    /// Releases what contact, flow or loads ask for.
    fn soften(&mut self, body: &mut Dynamics) {
        if !self.near.is_empty() {
            let seeds = self.struck(body);
            self.open(body, &seeds, Reason::Contact);
        }
        let now = body.time_s;
        if now >= self.watching.flow_at_s {
            self.watching.flow_at_s = now + FLOW_S;
            self.look_around(body);
        }
        if now >= self.watching.check_at_s {
            self.watching.check_at_s = now + self.settings.check_s;
            self.check_loads(body);
        }
    }

    /// Elements at nodes that are about to meet something, and all of the sets that do so with a blow.
    fn struck(&mut self, body: &Dynamics) -> Vec<usize> {
        let near = std::mem::take(&mut self.near);
        let mut seeds: Vec<usize> = near.iter().flat_map(|n| body.blocks.elements_at(*n as usize)).collect();
        let reference_m_s = body.body_contact.as_ref().map_or([0.0; 3], |c| c.reference_m_s());
        let is_blow = |n: &&u32| {
            let n = **n as usize;
            let flagged = body.body_contact.as_ref().is_some_and(|c| c.flagged[n]);
            let against = if flagged { reference_m_s } else { [0.0; 3] };
            let speed: V3 = std::array::from_fn(|i| body.v[n][i] - against[i]);
            dot(speed, speed) > BLOW_M_S * BLOW_M_S
        };
        let mut sets: Vec<u32> = near.iter().filter(is_blow).map(|n| self.set_of[*n as usize]).collect();
        sets.sort_unstable();
        sets.dedup();
        for set in sets.into_iter().filter(|s| *s != NONE) {
            seeds.extend(self.sets[set as usize].elements.iter().map(|e| *e as usize));
        }
        seeds
    }

    /// Takes in that a charge goes off now whose forces fall over `duration_s`: all deforms until what it sets off shows. A part that was or became rigid before would be held, and what a charge
    /// sets off is neither flow beside a part nor a static load on it.
    pub(in crate::fe) fn fire(&mut self, body: &mut Dynamics, duration_s: f64) {
        if self.settings.softens {
            let rigid: Vec<usize> = (0..self.resting.len()).filter(|e| self.resting[*e]).collect();
            self.release(body, &rigid, Reason::Charge);
        }
        for (quiet_s, resting) in self.watching.quiet_s.iter_mut().zip(&self.resting) {
            if !resting {
                *quiet_s = -(self.settings.settle_s + duration_s);
            }
        }
        self.renew(body);
    }

    /// Releases what is rigid around elements, which have to be quiet anew.
    fn open(&mut self, body: &mut Dynamics, seeds: &[usize], reason: Reason) {
        let around = Neighbours::of(&body.blocks).around(seeds, self.settings.rings);
        around.iter().for_each(|e| self.watching.quiet_s[*e] = -self.settings.quiet_s);
        self.release(body, &around, reason);
    }

    /// Looks for flow in the elements beside the sets.
    fn look_around(&mut self, body: &mut Dynamics) {
        let since = body.time_s - std::mem::replace(&mut self.watching.flow_since_s, body.time_s);
        let mut seeds = Vec::new();
        for set in &self.sets {
            let at = set.boundary.iter().map(|i| set.nodes[*i as usize] as usize);
            seeds.extend(at.flat_map(|n| body.blocks.elements_at(n)).filter(|e| !self.resting[*e]));
        }
        seeds.sort_unstable();
        seeds.dedup();
        let flow = |e: &usize| body.blocks.plastic_strain(*e) - self.watching.strained[*e];
        seeds.retain(|e| body.blocks.share(*e) > 0.0 && flow(e) > self.settings.rate_1_s * since);
        for e in 0..self.watching.strained.len() {
            self.watching.strained[e] = body.blocks.plastic_strain(e);
        }
        if !seeds.is_empty() {
            self.open(body, &seeds, Reason::Flow);
        }
    }

    /// Checks the loads on all sets.
    fn check_loads(&mut self, body: &mut Dynamics) {
        let mut seeds = Vec::new();
        let factorises = body.time_s >= self.watching.factor_at_s;
        if factorises {
            self.watching.factor_at_s = body.time_s + FACTOR_S;
        }
        for set in &mut self.sets {
            if set.demand.is_none() && factorises {
                set.demand = Demand::of(set, body);
                self.books.checks[1] += 1;
            }
            let Some(demand) = &set.demand else { continue };
            self.books.checks[0] += 1;
            seeds.extend(demand.overloaded(set, body, self.settings.overload_strain));
            set.pull_n.fill([0.0; 3]);
            set.pulls = 0;
        }
        if !seeds.is_empty() {
            self.open(body, &seeds, Reason::Overload);
        }
    }

    /// Takes the strain rates of a window, and plans new sets if that is worth it.
    fn end_window(&mut self, body: &mut Dynamics) {
        let length_s = body.time_s - (self.watching.window_ends_s - WINDOW_S);
        self.watching.window_ends_s = body.time_s + WINDOW_S;
        let waiting = &mut self.watching;
        for e in (0..self.resting.len()).filter(|e| !self.resting[*e]) {
            let nodes = body.blocks.nodes_of(e);
            let strain = net_strain(&nodes.map(|n| waiting.start_m[n]), &nodes.map(|n| body.x[n]));
            let quiet = strain <= self.settings.rate_1_s * length_s;
            waiting.quiet_s[e] =
                if quiet { waiting.quiet_s[e] + length_s } else { waiting.quiet_s[e].min(0.0) };
        }
        waiting.start_m.clone_from(&body.x);
        let allowed = self.settings.rigid_from_start.as_ref();
        let touches = |n: usize| {
            body.body_contact.as_ref().is_some_and(|c| c.flagged[n])
                || body.surfaces.is_near(n, &body.x[n], TOUCHING_M)
        };
        let calm = |e: usize| {
            body.blocks.share(e) == 1.0
                && (self.resting[e] || self.watching.quiet_s[e] >= self.settings.quiet_s)
                && !body.blocks.nodes_of(e).into_iter().any(touches)
        };
        let calm: Vec<bool> = (0..self.resting.len()).map(calm).collect();
        let inner = Neighbours::of(&body.blocks).inner(&calm);
        let new: Vec<usize> = (0..inner.len())
            .filter(|e| inner[*e] && !self.resting[*e] && !self.excluded[*e])
            .filter(|e| allowed.is_none_or(|a| a[*e]))
            .collect();
        if new.len() as f64 >= WORTHWHILE * self.resting.len() as f64 {
            self.plan(body, new.into_iter(), Reason::Quiet);
        }
    }
}
