//! Numbers of a model by name, for runs that differ in some of them.
//!
//! A name follows the model file: `bodies.slab1.velocity_m_s.2`, `bushings.*.strength_factor`, `contact.ground.friction`. Members of lists go by their id, parts
//! of vectors by their place from 0; `*` is every member. Names that end in `_factor` multiply, all others set.

use super::model::{Bending, Body, Bushing, Event, Force, Model};
use std::collections::BTreeMap;

/// Why a name does not lead to a number.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{name}: {what}")]
pub struct ParameterError {
    /// The name.
    pub name: String,
    /// What is wrong, and what would be right.
    pub what: String,
}

const LISTS: &str = "bodies, bushings, forces, events, contact, gravity_m_s2 or settings";
const BODY: &str = "mass_factor (mass and inertia, spans and what bodies have together included), mass_kg, position_m.K, velocity_m_s.K or angular_velocity_rad_s.K";
const BUSHING: &str = "strength_factor, stiffness_factor, tensile_capacity_n, tensile_elongation_m, compressive_capacity_n, shear_capacity_n.K or shear_slip_m";
const FORCE: &str =
    "strength_factor, stiffness_factor, damping_factor, length_m, fracture_rad, force_n.K or torque_nm.K";
const CONTACT: &str = "ground.friction, ground.restitution, bodies.friction or bodies.restitution";

/// Sets or multiplies the numbers of a name; how many there were.
///
/// # Errors
/// If the name leads nowhere.
pub fn apply(model: &mut Model, name: &str, value: f64) -> Result<usize, ParameterError> {
    let fail = |what: String| ParameterError { name: name.into(), what };
    let parts: Vec<&str> = name.split('.').collect();
    let (list, rest) = (parts[0], &parts[1..]);
    let unknown = |what: &str| fail(format!("expected {what} here"));
    match (list, rest) {
        ("gravity_m_s2", [place]) => {
            set(part(&mut model.gravity_m_s2, place), value).ok_or(unknown("0, 1 or 2"))
        }
        ("settings", ["end_time_s"]) => set(Some(&mut model.settings.end_time_s), value).ok_or(unknown("")),
        ("settings", ["tolerance"]) => set(Some(&mut model.settings.tolerance), value).ok_or(unknown("")),
        ("settings", ["time_step_s"]) => {
            model.settings.time_step_s = Some(value);
            Ok(1)
        }
        ("settings", _) => Err(unknown("end_time_s, time_step_s or tolerance")),
        ("contact", [surface @ ("ground" | "bodies"), field]) => {
            let pair = if *surface == "ground" {
                model.contact.ground.as_mut().map(|g| (&mut g.friction, &mut g.restitution))
            } else {
                model.contact.bodies.as_mut().map(|b| (&mut b.friction, &mut b.restitution))
            };
            let (friction, restitution) = pair.ok_or_else(|| fail("the model has no such contact".into()))?;
            match *field {
                "friction" => set(Some(friction), value).ok_or(unknown("")),
                "restitution" => set(Some(restitution), value).ok_or(unknown("")),
                _ => Err(unknown("friction or restitution")),
            }
        }
        ("contact", _) => Err(fail(format!(
            "expected {CONTACT} after contact: surfaces of planes, obstacles and single pairs cannot be varied"
        ))),
        ("bodies", [_, ..]) => {
            each(&mut model.bodies, |b| &b.id, |b, field| body(b, field, value), name, "body", BODY)
        }
        ("bushings", [_, ..]) => each(
            &mut model.bushings,
            |b| &b.id,
            |b, field| bushing(b, field, value),
            name,
            "bushing",
            BUSHING,
        ),
        ("forces", [_, ..]) => {
            each(&mut model.forces, |f| f.id(), |f, field| force(f, field, value), name, "force", FORCE)
        }
        ("events", [_, ..]) => {
            each(&mut model.events, |e| &e.id, |e, field| event(e, field, value), name, "event", "time_s")
        }
        _ => Err(fail(format!("expected a name that begins with {LISTS}, as in \"bodies.ID.mass_factor\""))),
    }
}

/// Two names of which the later one undoes what the earlier one has set in the same number, so that their order matters, if there are any; names that lead nowhere are passed over.
pub fn clash<'a>(model: &Model, names: &'a [String]) -> Option<[&'a str; 2]> {
    let lists = ids(model);
    let target = |name: &'a String| {
        let list = name.split('.').next().unwrap_or_default();
        let id = lists.get(list).map_or("", |ids| member(name, ids).0);
        (list, id)
    };
    let targets: Vec<(&str, &str)> = names.iter().map(target).collect();
    let ends_alike = |first: usize, second: usize| {
        // powers of two: products are exact in either order
        let in_order = |order: [(usize, f64); 2]| {
            let mut own = model.clone();
            let done = order.iter().all(|(i, value)| apply(&mut own, &names[*i], *value).is_ok());
            done.then_some(own)
        };
        in_order([(first, 2.0), (second, 4.0)]) == in_order([(second, 4.0), (first, 2.0)])
    };
    let may_meet = |a: (&str, &str), b: (&str, &str)| a.0 == b.0 && (a.1 == b.1 || a.1 == "*" || b.1 == "*");
    (0..names.len())
        .flat_map(|second| (0..second).map(move |first| (first, second)))
        .find(|(first, second)| may_meet(targets[*first], targets[*second]) && !ends_alike(*first, *second))
        .map(|(first, second)| [names[first].as_str(), names[second].as_str()])
}

/// Ids of the members of the lists of a model, by the names of the lists.
fn ids(model: &Model) -> BTreeMap<&'static str, Vec<String>> {
    let of = |all: &mut dyn Iterator<Item = &str>| all.map(String::from).collect();
    BTreeMap::from([
        ("bodies", of(&mut model.bodies.iter().map(|b| b.id.as_str()))),
        ("bushings", of(&mut model.bushings.iter().map(|b| b.id.as_str()))),
        ("forces", of(&mut model.forces.iter().map(|f| f.id()))),
        ("events", of(&mut model.events.iter().map(|e| e.id.as_str()))),
    ])
}

/// The id in a name, which may have dots of its own, and what follows it: the longest of the ids that the name goes on with, or else all up to the last word.
fn member<'a>(name: &'a str, ids: &[String]) -> (&'a str, Vec<&'a str>) {
    let rest = name.split_once('.').map_or("", |(_, rest)| rest);
    let is_own =
        |id: &&String| rest.strip_prefix(id.as_str()).is_some_and(|r| r.is_empty() || r.starts_with('.'));
    let own = ids.iter().filter(is_own).map(String::len).max();
    let at = own.unwrap_or_else(|| {
        let words = rest.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('.');
        words.rfind('.').unwrap_or(words.len())
    });
    (&rest[..at], rest[at..].split('.').skip(1).collect())
}

/// Applies something to the members of a list with an id, or to all; `*` passes over those that have no such number.
fn each<T>(
    list: &mut [T],
    id_of: impl Fn(&T) -> &str,
    apply: impl Fn(&mut T, &[&str]) -> Option<usize>,
    name: &str,
    kind: &str,
    fields: &str,
) -> Result<usize, ParameterError> {
    let fail = |what: String| ParameterError { name: name.into(), what };
    let ids: Vec<String> = list.iter().map(|m| id_of(m).to_string()).collect();
    let (id, field) = member(name, &ids);
    let chosen: Vec<&mut T> =
        list.iter_mut().zip(&ids).filter(|(_, own)| id == "*" || *own == id).map(|(m, _)| m).collect();
    if chosen.is_empty() {
        let near = ids.iter().min_by_key(|own| strsim::damerau_levenshtein(own, id));
        let hint = near.map(|n| format!(" (did you mean \"{n}\"?)")).unwrap_or_default();
        return Err(fail(format!("\"{id}\" is not the id of a {kind}{hint}")));
    }
    let count = chosen.into_iter().filter_map(|m| apply(m, &field)).sum();
    if count == 0 { Err(fail(format!("no such number: expected {fields} after the id"))) } else { Ok(count) }
}

fn set(number: Option<&mut f64>, value: f64) -> Option<usize> {
    *number? = value;
    Some(1)
}

fn part<'a>(vector: &'a mut [f64], place: &str) -> Option<&'a mut f64> {
    vector.get_mut(place.parse::<usize>().ok()?)
}

fn body(body: &mut Body, field: &[&str], value: f64) -> Option<usize> {
    match field {
        ["mass_factor"] => {
            body.mass_kg *= value;
            body.inertia_kg_m2.iter_mut().flatten().for_each(|i| *i *= value);
            Some(1)
        }
        ["mass_kg"] => set(Some(&mut body.mass_kg), value),
        ["position_m", k] => set(part(&mut body.position_m, k), value),
        ["velocity_m_s", k] => set(part(&mut body.velocity_m_s, k), value),
        ["angular_velocity_rad_s", k] => set(part(&mut body.angular_velocity_rad_s, k), value),
        _ => None,
    }
}

fn bushing(bushing: &mut Bushing, field: &[&str], value: f64) -> Option<usize> {
    match field {
        ["strength_factor"] => {
            let curves = bushing.bending.iter_mut().filter_map(|b| match b {
                Bending::Curve { strength_factor, .. } => Some(strength_factor),
                Bending::Elastic { .. } => None,
            });
            let count = curves.map(|f| *f *= value).count();
            (count > 0).then_some(count)
        }
        ["stiffness_factor"] => {
            bushing.axial_stiffness_n_m *= value;
            bushing.shear_stiffness_n_m.iter_mut().for_each(|k| *k *= value);
            bushing.torsional_stiffness_nm_rad *= value;
            for (k, bending) in bushing.bending.iter_mut().enumerate() {
                if let Bending::Elastic { stiffness_nm_rad } = bending {
                    *stiffness_nm_rad *= value;
                    // a stiffer member carries over by smaller rotations
                    if let Some(carry) = bushing.carry_over.as_mut().filter(|_| value > 0.0) {
                        carry.flexibility_rad_nm[k] /= value;
                    }
                }
            }
            Some(1)
        }
        ["tensile_capacity_n"] => set(bushing.tensile_capacity_n.as_mut(), value),
        ["tensile_elongation_m"] => set(bushing.tensile_elongation_m.as_mut(), value),
        ["shear_capacity_n", place] => {
            bushing.shear_capacity_n.as_mut().and_then(|c| set(part(c, place), value))
        }
        ["shear_slip_m"] => set(bushing.shear_slip_m.as_mut(), value),
        ["compressive_capacity_n"] => set(bushing.compressive_capacity_n.as_mut(), value),
        _ => None,
    }
}

fn force(force: &mut Force, field: &[&str], value: f64) -> Option<usize> {
    match (force, field) {
        (Force::Hinge { capacity, .. }, ["strength_factor"]) => {
            capacity.iter_mut().for_each(|p| p[1] *= value);
            Some(1)
        }
        (Force::Hinge { fracture_rad: Some(f), .. }, ["fracture_rad"]) => set(Some(f), value),
        (Force::Spring { stiffness_n_m: k, .. }, ["stiffness_factor"])
        | (
            Force::Torsion { stiffness_nm_rad: k, .. } | Force::Hinge { stiffness_nm_rad: k, .. },
            ["stiffness_factor"],
        )
        | (Force::Spring { damping_n_s_m: k, .. }, ["damping_factor"])
        | (Force::Torsion { damping_nm_s_rad: k, .. }, ["damping_factor"]) => {
            *k *= value;
            Some(1)
        }
        (Force::Spring { length_m, .. }, ["length_m"]) => {
            *length_m = Some(value);
            Some(1)
        }
        (Force::Force { force_n, .. }, ["force_n", k]) => set(part(force_n, k), value),
        (Force::Torque { torque_nm, .. }, ["torque_nm", k]) => set(part(torque_nm, k), value),
        _ => None,
    }
}

fn event(event: &mut Event, field: &[&str], value: f64) -> Option<usize> {
    if field == ["time_s"] { set(Some(&mut event.time_s), value) } else { None }
}
