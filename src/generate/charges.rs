//! What charges take away: whole bodies, the webs of beams, and what stands on a footing.
//!
//! A column or a wall is a body of its own, or a column its pieces where charges take a stretch of it (`stumps`). A beam is one with its slab: what goes is its web (`webs`), from joint block to joint block, with its share of the
//! springs of its floor; the slab stays. A floor goes as a whole where all of its members have charges, with the last of them. A footing that is held is
//! ground: a charge on it parts what stands on it from the ground.

use super::GenerateError;
use super::bodies::Bodies;
use super::division::Divided;
use super::joints::is_ground;
use crate::base::geom::Aabb;
use crate::building::{Building, Charge, MemberKind};
use crate::mbs::model::{Bushing, Event, Origin};
use std::collections::{BTreeMap, BTreeSet};

/// The first charge on each member, by its place in the building file.
pub fn first_on(building: &Building) -> Vec<Option<usize>> {
    let numbers: BTreeMap<&str, usize> =
        building.members.iter().enumerate().map(|(index, m)| (m.id.as_str(), index)).collect();
    let mut first: Vec<Option<usize>> = vec![None; building.members.len()];
    for (index, charge) in building.events.iter().enumerate() {
        let Some(member) = numbers.get(charge.member.as_str()) else { continue };
        if first[*member].is_none_or(|held| charge.time_s < building.events[held].time_s) {
            first[*member] = Some(index);
        }
    }
    first
}

/// The events of the charges, each body once, and notes about those that take nothing.
///
/// # Errors
/// If a charge takes a part of a body away that the model cannot part from the rest.
pub fn events(
    building: &Building,
    clusters: &[Vec<usize>],
    (bodies, floors): (&Bodies, &[Divided]),
    bushings: &[Bushing],
) -> Result<(Vec<Event>, Vec<String>), GenerateError> {
    let mut webs: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    for web in floors.iter().flat_map(|floor| &floor.webs) {
        webs.entry(web.member).or_default().push(web.id.clone());
    }
    let first = first_on(building);
    let mut place: BTreeMap<&str, (usize, Option<usize>)> = BTreeMap::new();
    for cluster in clusters {
        let last = last_of(building, cluster, &first);
        place.extend(cluster.iter().map(|m| (building.members[*m].id.as_str(), (*m, last))));
    }
    let (mut gone, mut events, mut notes) = (BTreeSet::new(), Vec::new(), Vec::new());
    for (index, charge) in building.events.iter().enumerate() {
        let Some((member, last)) = place.get(charge.member.as_str()).copied() else {
            let release = on_footing(building, &charge.member, bodies, bushings);
            if release.is_empty() {
                notes.push(format!(
                    "charge `{}` takes nothing away: `{}` bears nothing",
                    charge.id, charge.member
                ));
            } else {
                let origin = Origin { members: vec![charge.member.clone()], ..Origin::default() };
                events.push(Event { release, origin, ..Event::at(&charge.id, charge.time_s) });
            }
            continue;
        };
        let mut own = webs.get(&member).cloned().unwrap_or_default();
        let stumps = bodies.stumps_of(member);
        if let Some(stumps) = stumps {
            let pieces = bodies.all_of(member);
            own.extend(stumps.taken_by(index).map(|k| bodies.list[pieces[k]].id.clone()));
        }
        match last {
            _ if stumps.is_some() => {
                let none = || format!("charge `{}` takes nothing away: no part of `{}` lies on its stretch between the joints of the column", charge.id, charge.member);
                notes.extend(own.is_empty().then(none));
            }
            Some(last) if last == index => {
                own.extend(bodies.all_of(member).into_iter().map(|i| bodies.list[i].id.clone()));
            }
            Some(last) if own.is_empty() => notes.push(format!(
                "charge `{}` takes nothing away at its time: `{}` goes with its floor, at the last of the charges on it (`{}`)",
                charge.id, charge.member, building.events[last].id
            )),
            Some(_) => {}
            None if !own.is_empty() => {}
            None => notes.push(part_stays(building, charge, (bodies, floors), member)?),
        }
        own.retain(|id| gone.insert(id.clone()));
        if !own.is_empty() {
            events.push(Event {
                remove_bodies: own,
                origin: Origin { members: vec![charge.member.clone()], ..Origin::default() },
                ..Event::at(&charge.id, charge.time_s)
            });
        }
    }
    Ok((events, notes))
}

/// The bushings between the ground and what stands on a footing that is held.
fn on_footing(building: &Building, footing: &str, bodies: &Bodies, bushings: &[Bushing]) -> Vec<String> {
    let place = building.members.iter().position(|m| m.id == footing);
    let Some(place) = place.filter(|m| is_ground(building, *m)) else { return Vec::new() };
    let footing = &building.members[place];
    let mut found = Vec::new();
    for (member, own) in building.members.iter().enumerate() {
        let upright = matches!(own.kind, MemberKind::Column | MemberKind::Wall);
        let is_held = building.supports.iter().any(|s| s.member == own.id);
        if !upright || is_held || !own.stands_on(footing) {
            continue;
        }
        let ids: Vec<&String> = bodies.all_of(member).into_iter().map(|i| &bodies.list[i].id).collect();
        let middle_m = own.solid.center()[2];
        let Aabb { min, max } = footing.solid;
        let over = |p: &[f64; 3]| (0..2).all(|i| (min[i]..=max[i]).contains(&p[i])) && p[2] < middle_m;
        let stands = |b: &&Bushing| b.body_a.is_none() && ids.contains(&&b.body_b) && over(&b.point_m);
        found.extend(bushings.iter().filter(stands).map(|b| b.id.clone()));
    }
    found
}

/// The last of the first charges on the members of a cluster, if all of them have one.
fn last_of(building: &Building, cluster: &[usize], first: &[Option<usize>]) -> Option<usize> {
    let all: Option<Vec<usize>> = cluster.iter().map(|m| first[*m]).collect();
    let time_s = |index: usize| building.events[index].time_s;
    all?.into_iter().max_by(|a, b| time_s(*a).total_cmp(&time_s(*b)).then(a.cmp(b)))
}

/// What to know of a charge on a beam that cannot be taken out of its floor.
///
/// # Errors
/// If it is on another part of a body.
fn part_stays(
    building: &Building,
    charge: &Charge,
    (bodies, floors): (&Bodies, &[Divided]),
    member: usize,
) -> Result<String, GenerateError> {
    let first = bodies.all_of(member).first().copied();
    let body = first.map_or(String::new(), |i| bodies.list[i].id.clone());
    let (id, own) = (&charge.id, &charge.member);
    let is_divided = floors.iter().any(|floor| Some(floor.first) == first);
    // a beam of a floor in pieces would have a web if a slab lay on it
    if building.members[member].kind != MemberKind::Beam || is_divided {
        return Err(GenerateError::Shared { charge: id.clone(), member: own.clone(), body });
    }
    Ok(format!(
        "charge `{id}` takes nothing away: `{own}` stays a part of {body}, a floor that does not bend; from one that does it is taken (`--accuracy balanced`, or an override `merge_elastic`)"
    ))
}
