//! What charges take away: whole bodies, and the webs of beams.
//!
//! A column or a wall is a body of its own. A beam is one with its slab: what goes is its web (`webs`), from joint block to joint block, with its share of the
//! springs of its floor; the slab stays. A floor goes as a whole where all of its members have charges, with the last of them.

use super::bodies::Bodies;
use super::webs::Web;
use super::{Divided, GenerateError};
use crate::building::{Building, Charge, MemberKind};
use crate::mbs::model::{Event, Origin};
use std::collections::BTreeSet;

/// Whether a member is a beam with a charge, of a cluster of several.
pub fn takes_web(building: &Building, cluster: &[usize], member: usize) -> bool {
    let own = &building.members[member];
    cluster.len() > 1 && own.kind == MemberKind::Beam && building.events.iter().any(|e| e.member == own.id)
}

/// The events of the charges, each body once, and notes about those that take nothing.
///
/// # Errors
/// If a charge takes a part of a body away that the model cannot part from the rest.
pub fn events(
    building: &Building,
    clusters: &[Vec<usize>],
    (bodies, floors): (&Bodies, &[Divided]),
) -> Result<(Vec<Event>, Vec<String>), GenerateError> {
    let (mut gone, mut events, mut notes) = (BTreeSet::new(), Vec::new(), Vec::new());
    for (index, charge) in building.events.iter().enumerate() {
        let Some(member) = building.members.iter().position(|m| m.id == charge.member) else { continue };
        let Some(cluster) = clusters.iter().find(|c| c.contains(&member)) else { continue };
        let webs = floors.iter().flat_map(|f| &f.webs).filter(|w| w.member == member);
        let mut own: Vec<String> = webs.map(|w: &Web| w.id.clone()).collect();
        match last_of(building, cluster) {
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
                id: charge.id.clone(),
                time_s: charge.time_s,
                release: Vec::new(),
                weaken: Vec::new(),
                remove_bodies: own,
                origin: Origin { members: vec![charge.member.clone()], ..Origin::default() },
            });
        }
    }
    Ok((events, notes))
}

/// The last of the charges on a cluster, if all of its members have one.
fn last_of(building: &Building, cluster: &[usize]) -> Option<usize> {
    let of = |m: &usize| {
        let own = building.events.iter().enumerate().filter(|(_, e)| e.member == building.members[*m].id);
        own.min_by(|a, b| a.1.time_s.total_cmp(&b.1.time_s))
    };
    let all: Option<Vec<(usize, &Charge)>> = cluster.iter().map(of).collect();
    all?.into_iter()
        .max_by(|a, b| a.1.time_s.total_cmp(&b.1.time_s).then(a.0.cmp(&b.0)))
        .map(|(index, _)| index)
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
