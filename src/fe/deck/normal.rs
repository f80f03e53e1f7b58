//! The form of a model that a deck can say: what [`super::write`] writes and [`super::read`] gives back.

use crate::fe::law::{ElementForm, Erosion, Hourglass, Law};
use crate::fe::mesh::Mesh;
use crate::fe::model::{Constraint, Curve, Model, RigidPlane};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The same model with each part of one law, no factors on elements (densities, moduli and yield stresses of new laws
/// contain them), curves over the whole run, nodes held in all directions in one list. Also what could not be kept.
/// A normal model is left as it is.
pub fn normalised(model: &Model) -> (Model, Vec<String>) {
    let mut notes = Vec::new();
    let mut normal = model.clone();
    normal.title = line(&model.title);
    normal.mesh = mesh(&model.mesh, &mut notes);
    holds(&mut normal);
    let starts: BTreeMap<usize, [f64; 3]> = model.initial_velocity_m_s.iter().copied().collect();
    normal.initial_velocity_m_s = starts.into_iter().filter(|(_, v)| *v != [0.0; 3]).collect();
    span_all(&mut normal);
    for wall in &mut normal.walls {
        // what the two points of a deck give back; a few rounds reach the normal that stays
        for _ in 0..4 {
            let head = head_of(wall);
            let along: [f64; 3] = std::array::from_fn(|i| head[i] - wall.point_m[i]);
            let length = along.iter().map(|c| c * c).sum::<f64>().sqrt();
            wall.normal = along.map(|c| c / length);
        }
        if wall.friction >= 1.0 && wall.friction.is_finite() {
            notes.push(format!("a wall with friction {} is written as one without slip", wall.friction));
            wall.friction = f64::INFINITY;
        }
    }
    if let Some(step) = model.control.mass_scaling_step_s {
        normal.control.mass_scaling_step_s =
            Some(least_step_of_element(step, model.control.step_safety) * model.control.step_safety);
    }
    (normal, notes)
}

/// `DT2MS` without its sign: the step that times the safety gives the least step.
pub(super) fn least_step_of_element(step_s: f64, safety: f64) -> f64 {
    let near = step_s / safety;
    [near, near.next_up(), near.next_down()].into_iter().find(|d| d * safety == step_s).unwrap_or(near)
}

/// Head of the normal vector of a wall, as far from its tail as the tail is from the origin: the difference of
/// the two then keeps its digits.
pub(super) fn head_of(wall: &RigidPlane) -> [f64; 3] {
    let far = wall.point_m.iter().fold(1.0_f64, |a, c| a.max(c.abs()));
    let scale = libm::exp2(libm::log2(far).ceil());
    std::array::from_fn(|i| wall.point_m[i] + scale * wall.normal[i])
}

/// Text that fits a title line.
fn line(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let plain = plain.trim();
    if plain.starts_with(['$', '*']) { format!("_{plain}") } else { plain.to_string() }
}

/// Curves that span the run. Loads that share one go on sharing it.
fn span_all(model: &mut Model) {
    let end_s = model.control.end_time_s;
    // by the place of the points in memory; the old curve is kept, so that no other one comes to lie there
    let mut known: HashMap<*const Vec<[f64; 2]>, [Curve; 2]> = HashMap::new();
    let accelerations = model.body_loads.iter_mut().map(|l| &mut l.acceleration_m_s2);
    let forces = model.nodal_loads.iter_mut().map(|l| &mut l.force_n);
    let velocities = model.driven.iter_mut().map(|d| &mut d.velocity_m_s);
    for curve in accelerations.chain(forces).chain(velocities) {
        let [_, whole] =
            known.entry(Arc::as_ptr(&curve.0)).or_insert_with(|| [curve.clone(), span(curve, end_s)]);
        *curve = whole.clone();
    }
}

/// A curve with a value at the beginning and at the end of the run.
fn span(curve: &Curve, end_s: f64) -> Curve {
    let starts = curve.0.first().is_some_and(|p| p[0] <= 0.0);
    if starts && curve.0.last().is_some_and(|p| p[0] >= end_s) {
        return curve.clone();
    }
    let mut points = curve.0.to_vec();
    if !starts {
        points.insert(0, [0.0, curve.at(0.0)]);
    }
    if let Some(&[last, value]) = points.last()
        && last < end_s
    {
        points.push([end_s, value]);
    }
    Curve::new(points)
}

fn holds(model: &mut Model) {
    let mut held: BTreeMap<usize, [bool; 3]> = model.mesh.fixed.iter().map(|n| (*n, [true; 3])).collect();
    for constraint in &model.constraints {
        let held = held.entry(constraint.node).or_default();
        *held = std::array::from_fn(|i| held[i] || constraint.held[i]);
    }
    let all = |h: &[bool; 3]| *h == [true; 3];
    model.mesh.fixed = held.iter().filter(|(_, h)| all(h)).map(|(n, _)| *n).collect();
    let partly = held.into_iter().filter(|(_, h)| !all(h) && *h != [false; 3]);
    model.constraints = partly.map(|(node, held)| Constraint { node, held }).collect();
}

/// Which part an element belongs to in a deck: the model's part, its law, and factors or area by their bits.
type Key = (usize, bool, usize, u64, u64);

fn mesh(mesh: &Mesh, notes: &mut Vec<String>) -> Mesh {
    let solid = |e: &crate::fe::mesh::Element| -> Key {
        (e.part, false, e.law, e.smear.to_bits(), e.strength.to_bits())
    };
    let truss = |t: &crate::fe::mesh::Truss| -> Key { (t.part, true, t.law, t.area_m2.to_bits(), 0) };
    // parts in the order of the model; within one, in the order of first appearance
    let mut order: Vec<Key> = Vec::new();
    let mut known = BTreeMap::new();
    for key in mesh.elements.iter().map(solid).chain(mesh.trusses.iter().map(truss)) {
        known.entry(key).or_insert_with(|| {
            order.push(key);
        });
    }
    order.sort_by_key(|k| k.0);
    let mut normal = Mesh { nodes: mesh.nodes.clone(), fixed: mesh.fixed.clone(), ..Mesh::default() };
    let mut place: BTreeMap<Key, (usize, usize)> = BTreeMap::new();
    for (index, key) in order.iter().enumerate() {
        let mut law = plain(&mesh.laws[key.2], notes);
        if key.1 {
            law.form = ElementForm::default();
        } else {
            scale(&mut law, f64::from_bits(key.3), f64::from_bits(key.4));
        }
        let law = normal.laws.iter().position(|l| *l == law).unwrap_or_else(|| {
            normal.laws.push(law);
            normal.laws.len() - 1
        });
        let earlier = order[..index].iter().filter(|k| k.0 == key.0).count();
        let name = mesh.parts.get(key.0).map(|n| line(n)).unwrap_or_default();
        let name = if name.is_empty() { format!("part {}", index + 1) } else { name };
        normal.parts.push(if earlier == 0 { name } else { format!("{name} ({})", earlier + 1) });
        place.insert(*key, (index, law));
    }
    normal.elements = mesh.elements.clone();
    for element in &mut normal.elements {
        (element.part, element.law) = place[&solid(element)];
        (element.smear, element.strength) = (1.0, 1.0);
    }
    normal.elements.sort_by_key(|e| e.law);
    normal.trusses = mesh.trusses.clone();
    for bar in &mut normal.trusses {
        (bar.part, bar.law) = place[&truss(bar)];
    }
    if !mesh.ties.is_empty() {
        notes.push(format!("{} tied nodes are written without their ties", mesh.ties.len()));
    }
    normal
}

/// A law without what a deck cannot say.
fn plain(law: &Law, notes: &mut Vec<String>) -> Law {
    let mut law = law.clone();
    if law.hardening.is_empty() {
        law.rate = None;
        law.erosion.plastic_strain = f64::INFINITY;
    }
    let never = |strain: f64| if strain >= 1e20 { f64::INFINITY } else { strain };
    law.erosion = Erosion {
        plastic_strain: never(law.erosion.plastic_strain),
        principal_strain: never(law.erosion.principal_strain),
    };
    if let ElementForm::OnePoint(Hourglass::Ads | Hourglass::Asmd) = law.form {
        law.form = ElementForm::OnePoint(Hourglass::Asqbi);
        let text = "hourglass control ADS or ASMD is written as type 6 (ASQBI): decks have no number for it";
        if !notes.iter().any(|n| n == text) {
            notes.push(text.into());
        }
    }
    law
}

/// Factors of an element in its law, in the products of the solver: density and stiffness times `smear`, strength
/// times `smear * strength`.
fn scale(law: &mut Law, smear: f64, strength: f64) {
    law.density_kg_m3 *= smear;
    law.youngs_modulus_pa *= smear;
    for point in &mut law.hardening {
        point.stress_pa *= smear * strength;
    }
}

#[cfg(test)]
mod tests {
    use super::normalised;
    use crate::fe::deck::{DeckOptions, parse};
    use crate::fe::model::{Curve, Model};
    use std::sync::Arc;

    /// A cube whose upper face is loaded and whose lower one is moved, over a part of the run.
    const SETS: &str = "*KEYWORD\n*CONTROL_TERMINATION\n1.0\n*PART\ncube\n1,1,1,0,1\n*SECTION_SOLID\n1,1\n\
        *HOURGLASS\n1,6,1.0\n*MAT_ELASTIC\n1,2500.,3e10,0.2\n*SET_NODE_LIST\n1\n1,2,3,4\n*SET_NODE_LIST\n2\n5,6,7,8\n\
        *BOUNDARY_PRESCRIBED_MOTION_SET\n1,3,0,7,2.0\n*LOAD_NODE_SET\n2,3,7,5.0\n*DEFINE_CURVE\n7\n0.1,1.0\n0.5,3.0\n\
        *NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
        *ELEMENT_SOLID\n1,1,1,2,3,4,5,6,7,8\n*END\n";

    #[test]
    fn nodes_of_a_set_share_their_curve() {
        let shared = |model: &Model| {
            let [forces, velocities]: [Vec<&Curve>; 2] = [
                model.nodal_loads.iter().map(|l| &l.force_n).collect(),
                model.driven.iter().map(|d| &d.velocity_m_s).collect(),
            ];
            assert_eq!([forces.len(), velocities.len()], [4, 4]);
            for curves in [&forces, &velocities] {
                assert!(curves.iter().all(|c| Arc::ptr_eq(&c.0, &curves[0].0)));
            }
            [forces[0].0.to_vec(), velocities[0].0.to_vec()]
        };
        let model = parse(SETS, "sets.k", DeckOptions::default()).unwrap().model;
        assert_eq!(shared(&model), [[[0.1, 5.0], [0.5, 15.0]], [[0.1, 2.0], [0.5, 6.0]]]);
        let (normal, _) = normalised(&model);
        let over = |v: f64| [[0.0, v], [0.1, v], [0.5, 3.0 * v], [1.0, 3.0 * v]];
        assert_eq!(shared(&normal), [over(5.0), over(2.0)]);
    }
}
