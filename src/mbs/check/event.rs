//! Events: what they take or weaken is there, and has not gone before.

use super::List;
use crate::mbs::model::{Force, Model};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

/// Complaints about all events.
pub(super) fn check_events(model: &Model, known: &BTreeSet<&str>, list: &mut List) {
    let hinges = model.forces.iter().filter(|f| matches!(f, Force::Hinge { .. })).map(Force::id);
    let weak: BTreeSet<&str> = model.bushings.iter().map(|b| b.id.as_str()).chain(hinges).collect();
    let endless: BTreeSet<&str> =
        model.bushings.iter().filter(|b| !b.has_capacity()).map(|b| b.id.as_str()).collect();
    let joints = model.joints.iter().map(|j| j.id.as_str());
    let loose: BTreeSet<&str> =
        weak.iter().copied().chain(joints).chain(model.forces.iter().map(Force::id)).collect();
    for (i, event) in model.events.iter().enumerate() {
        let path = format!("events[{i}]");
        list.not_negative(&format!("{path}.time_s"), event.time_s);
        for (k, id) in event.remove_bodies.iter().enumerate() {
            list.known(known, id, &format!("{path}.remove_bodies[{k}]"));
        }
        for (k, id) in event.release.iter().enumerate() {
            list.among(&loose, id, &format!("{path}.release[{k}]"), "a joint, bushing or force");
        }
        for (k, w) in event.weaken.iter().enumerate() {
            list.among(&weak, &w.id, &format!("{path}.weaken[{k}].id"), "a bushing or a hinge");
            list.require(!endless.contains(w.id.as_str()), &format!("{path}.weaken[{k}].id"), || {
                format!("bushing \"{}\" is elastic without end: it has neither curve nor capacity", w.id)
            });
            list.require(w.factor > 0.0 && w.factor <= 1.0, &format!("{path}.weaken[{k}].factor"), || {
                format!("is {}, expected above 0 and at most 1 (to remove it, use release)", w.factor)
            });
        }
    }
    nothing_twice(model, list);
}

/// What one event has taken away no later one can take or weaken; events of one time in the order of the file. What holds a body is gone with it, a hinge with its joint.
fn nothing_twice(model: &Model, list: &mut List) {
    let mut order: Vec<usize> = (0..model.events.len()).collect();
    order.sort_by(|a, b| model.events[*a].time_s.total_cmp(&model.events[*b].time_s));
    // since which event, and with which body or joint
    let mut bodies: BTreeMap<&str, usize> = BTreeMap::new();
    let mut holds: BTreeMap<&str, (usize, Option<&str>)> = BTreeMap::new();
    for i in order {
        let event = &model.events[i];
        let told = |id: &str, with: Option<&str>, since: usize| {
            let first = &model.events[since];
            let with = with.map_or(String::new(), |other| format!(" with \"{other}\""));
            let (event, time_s) = (&first.id, first.time_s);
            format!("\"{id}\" is gone{with} since event \"{event}\" at {time_s} s: leave one of both out")
        };
        for (k, w) in event.weaken.iter().enumerate() {
            if let Some((since, with)) = holds.get(w.id.as_str()) {
                list.add(format!("events[{i}].weaken[{k}].id"), told(&w.id, *with, *since));
            }
        }
        for (k, id) in event.release.iter().enumerate() {
            match holds.entry(id) {
                Entry::Vacant(place) => _ = place.insert((i, None)),
                Entry::Occupied(gone) => {
                    let (since, with) = *gone.get();
                    list.add(format!("events[{i}].release[{k}]"), told(id, with, since));
                }
            }
        }
        for id in &event.release {
            for own in model.hinges_on(id) {
                holds.entry(own).or_insert((i, Some(id)));
            }
        }
        for (k, id) in event.remove_bodies.iter().enumerate() {
            match bodies.entry(id) {
                Entry::Vacant(place) => {
                    place.insert(i);
                    for own in holds_of(model, id) {
                        holds.entry(own).or_insert((i, Some(id)));
                    }
                }
                Entry::Occupied(since) => {
                    list.add(format!("events[{i}].remove_bodies[{k}]"), told(id, None, *since.get()));
                }
            }
        }
    }
}

/// Bushings, joints and forces of a body.
fn holds_of<'a>(model: &'a Model, body: &'a str) -> impl Iterator<Item = &'a str> {
    let is_own = move |a: Option<&str>, b: &str| a == Some(body) || b == body;
    let bushings = model.bushings.iter().filter(move |b| is_own(b.body_a.as_deref(), &b.body_b));
    let joints = model.joints.iter().filter(move |j| is_own(j.body_a.as_deref(), &j.body_b));
    let forces = model.forces.iter().filter(move |f| f.bodies().contains(&Some(body)));
    let ids = bushings.map(|b| b.id.as_str()).chain(joints.map(|j| j.id.as_str()));
    ids.chain(forces.map(|f| f.id()))
}
