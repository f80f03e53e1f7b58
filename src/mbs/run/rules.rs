//! Rules about contacts and fractures, asked while a model runs.

use super::Run;
use super::meetings::Approach;
use crate::mbs::contact::Partner;
use crate::mbs::math::{self, V3};
use crate::mbs::model::{Broken, EventRule, Met, Model, Trigger};
use crate::mbs::result::{EventKind, RunEvent};
use crate::mbs::system::BodyState;
use std::collections::{BTreeMap, BTreeSet};

/// The rules of a model by the places of what they name.
pub(super) struct EventRules {
    /// Of each rule its bodies and the latent bushings that it has watched.
    named: Vec<(Vec<usize>, Vec<usize>)>,
}

/// What happened to a body of the running model.
struct Occurrence {
    what: What,
    time_s: f64,
    point_m: V3,
    /// Id of what it met, or of the bushing that broke.
    with: String,
}

enum What {
    Contact { met: Met, approach_speed_m_s: f64 },
    Fracture { place: Broken, after_contact: bool },
}

impl EventRules {
    /// Those of a checked model.
    pub fn of(model: &Model) -> Self {
        if model.event_rules.is_empty() {
            return Self { named: Vec::new() };
        }
        let places = |ids: &mut dyn Iterator<Item = &String>| -> BTreeMap<String, usize> {
            ids.cloned().enumerate().map(|(i, id)| (id, i)).collect()
        };
        let bodies = places(&mut model.bodies.iter().map(|b| &b.id));
        let bushings = places(&mut model.bushings.iter().map(|b| &b.id));
        let of = |known: &BTreeMap<String, usize>, ids: &[String]| {
            let mut list: Vec<usize> = ids.iter().filter_map(|id| known.get(id).copied()).collect();
            list.sort_unstable();
            list
        };
        let named = model.event_rules.iter().map(|r| (of(&bodies, &r.bodies), of(&bushings, &r.watch)));
        Self { named: named.collect() }
    }

    /// The first rules of each question that are true of what happened to a body made of some bodies of the file.
    fn first(&self, rules: &[EventRule], pieces: &[usize], event: &Occurrence) -> Vec<usize> {
        let about = |k: usize| pieces.iter().any(|p| self.named[k].0.binary_search(p).is_ok());
        let mut answered = BTreeSet::new();
        let mut decides =
            |k: &usize| rules[*k].on.is_true_of(event) && about(*k) && answered.insert(&rules[*k].question);
        (0..rules.len()).filter(|k| decides(k)).collect()
    }
}

impl Trigger {
    fn is_true_of(&self, event: &Occurrence) -> bool {
        let holds = match (self, &event.what) {
            (
                Self::Contact { partners, approach_speed_m_s: range, .. },
                What::Contact { met, approach_speed_m_s },
            ) => partners.contains(met) && range.holds(*approach_speed_m_s),
            (
                Self::Fracture { places, after_contact: asked, .. },
                What::Fracture { place, after_contact },
            ) => places.contains(place) && asked.is_none_or(|asked| asked == *after_contact),
            _ => false,
        };
        holds && self.time_s().holds(event.time_s)
    }
}

impl Run<'_> {
    /// Asks the rules about the contacts of a step of `h` \[s\], which began with the bodies as they are in `untouched`: about those that begin, and harder ones between bodies that touch already.
    #[cold]
    pub(super) fn ask_about_contacts(&mut self, h: f64) {
        let mut struck: BTreeMap<(usize, Partner), (f64, V3)> = BTreeMap::new();
        let (before, latent) = (&self.untouched, &self.latent);
        self.contacts.each_hit(|hit| {
            let [a, b] = hit.bodies;
            let velocity = |body: usize, arm: V3| {
                before.get(body).map_or([0.0; 3], |s| math::add(s.v, math::cross(s.w, arm)))
            };
            let relative = math::sub(velocity(b, hit.arms[1]), velocity(a, hit.arms[0]));
            let speed = -math::dot(relative, hit.normal);
            let point = math::add(before[a].x, hit.arms[0]);
            let other = matches!(hit.partner, Partner::Body(_)).then_some((b, Partner::Body(a)));
            for key in [Some((a, hit.partner)), other].into_iter().flatten().filter(|k| latent.waits(k.0)) {
                let fastest = struck.entry(key).or_insert((speed, point));
                if speed > fastest.0 {
                    *fastest = (speed, point);
                }
            }
        });
        let asleep =
            |pieces: &[usize]| pieces.iter().all(|p| self.system.data[self.latent.places[*p].body].asleep);
        self.meetings.end(self.time, asleep);
        let added_m_s = math::norm(self.system.gravity) * h;
        for ((body, partner), (approach_speed_m_s, point_m)) in struck {
            let approach = Approach { speed_m_s: approach_speed_m_s, time_s: self.time, added_m_s };
            if !self.meetings.is_news(body, partner, &self.latent.pieces, &approach) {
                continue;
            }
            let met = match partner {
                Partner::Ground => Met::Ground,
                Partner::Body(_) => Met::Part,
                Partner::Plane(_) | Partner::Obstacle(_) => Met::Obstacle,
            };
            let what = What::Contact { met, approach_speed_m_s };
            let with = partner.id(&self.model).to_string();
            self.occurs(body, Occurrence { what, time_s: self.time, point_m, with });
        }
    }

    /// Asks the rules about a bushing of the running model that has broken.
    #[cold]
    pub(super) fn ask_about_fracture(&mut self, joint: usize, time_s: f64) {
        if !self.latent.is_waiting() {
            return;
        }
        let [a, b] = [self.system.joints[joint].a, self.system.joints[joint].b];
        let id = self.model.bushings[joint].id.clone();
        let Some(own) = self.file.bushings.iter().position(|b| b.id == id) else { return };
        let place = if self.file.bushings[own].latent.is_some() { Broken::Span } else { Broken::End };
        let after_contact = self.result.events.iter().any(|e| matches!(e.kind, EventKind::Contact { .. }));
        for body in [a, b] {
            let what = What::Fracture { place, after_contact };
            let point_m = self.point_of(own);
            self.occurs(body, Occurrence { what, time_s, point_m, with: id.clone() });
        }
    }

    /// Where a bushing of the file is, on its second body \[m\].
    fn point_of(&self, bushing: usize) -> V3 {
        let given = &self.file.bushings[bushing];
        let Some(body) = self.file.bodies.iter().position(|b| b.id == given.body_b) else {
            return given.point_m;
        };
        let at_start = BodyState::new(&self.file.bodies[body]);
        self.place_of((body, math::mul_t(&at_start.r, math::sub(given.point_m, at_start.x))))
    }

    /// Has the latent bushings watched that the rules about an event of a body name.
    fn occurs(&mut self, body: usize, event: Occurrence) {
        if !self.latent.waits(body) {
            return;
        }
        for k in self.rules.first(&self.file.event_rules, &self.latent.pieces[body], &event) {
            let rule = &self.file.event_rules[k];
            let mut woken = self.latent.waiting_in(body, &self.rules.named[k].1);
            if rule.nearest {
                woken = self.nearest(woken, event.point_m);
            }
            if woken.is_empty() {
                continue;
            }
            self.latent.watch(&woken);
            let approach_speed_m_s = match event.what {
                What::Contact { approach_speed_m_s, .. } => Some(approach_speed_m_s),
                What::Fracture { .. } => None,
            };
            let kind = EventKind::Rule {
                rule: rule.id.clone(),
                body: self.model.bodies[body].id.clone(),
                with: event.with.clone(),
                approach_speed_m_s,
                watched: woken.iter().map(|b| self.file.bushings[*b].id.clone()).collect(),
            };
            let time_s = match event.what {
                What::Contact { .. } => self.time,
                What::Fracture { .. } => event.time_s,
            };
            self.result.events.push(RunEvent { time_s, kind });
        }
    }

    /// Those of some latent bushings that belong to the section nearest to a place.
    fn nearest(&self, mut bushings: Vec<usize>, point_m: V3) -> Vec<usize> {
        let distance = |b: &usize| math::norm(math::sub(self.point_of(*b), point_m));
        let first = bushings.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).copied();
        let section = first.map(|b| &self.file.bushings[b].latent);
        bushings.retain(|b| Some(&self.file.bushings[*b].latent) == section);
        bushings
    }
}
