//! What is worth saying of a run that came to its end.

use super::SAME;
use super::entry::GROWTH;
use crate::mbs::balance::Balance;
use crate::mbs::contact::{AT_GROUND_M, Work};
use crate::mbs::joint::MOST_TURN_RAD;
use crate::mbs::math;
use crate::mbs::model::{Body, Event, Force, Model, Shape, TOLERANCE};

/// Energy error worth a warning.
const ENERGY_WORTH_TELLING: f64 = 1e-3;
/// Depth of a contact worth a warning \[m\].
const DEPTH_WORTH_TELLING_M: f64 = 5e-3;

/// How the remark begins that the energy balance does not close.
pub const OFF_BALANCE: &str = "the energy balance is off by";

/// A share in per cent, with two digits after the point or, where it is small, two that count.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent >= 0.1 { format!("{percent:.2} %") } else { format!("{percent:.1e} %") }
}

/// Settings of a model of bushings that make its run finer, and where they stand; those of one of ideal joints.
pub(super) const FINER: &str = "step (--step, or settings.time_step_s in the model's file)";
pub(in crate::mbs) const FINER_IDEAL: &str =
    "settings.tolerance or step (--step, or settings.time_step_s in the model's file)";

/// What is worth saying of a run that came to its end, and the settings that make it finer.
pub(in crate::mbs) fn closing_remarks(books: &Balance, contacts: Option<Work>, finer: &str) -> Vec<String> {
    let mut list = Vec::new();
    let energy_error = books.error;
    if energy_error > ENERGY_WORTH_TELLING {
        list.push(format!(
            "{OFF_BALANCE} {} of the energy turned over; a smaller {finer} shows what that changes",
            percent(energy_error)
        ));
    }
    if books.growth > GROWTH {
        list.push(format!(
            "the energy grows by {} of that turned over; a smaller {finer} shows what that changes",
            percent(books.growth)
        ));
    }
    if books.made() > ENERGY_WORTH_TELLING {
        list.push(format!(
            "contacts made energy, {} of that turned over: bodies are jammed between contacts and joints, or spin fast as they rebound; a smaller {finer} shows what that changes",
            percent(books.made())
        ));
    }
    if books.returned() > ENERGY_WORTH_TELLING {
        list.push(format!(
            "what yields gave back {} of the energy turned over, of what it had dissipated: its law does not hold in these steps; a smaller {finer} shows what that changes",
            percent(books.returned())
        ));
    }
    if let Some(work) = contacts.filter(|w| w.jammed > 0) {
        list.push(format!(
            "friction was left out in {} of {} steps with contact, where bodies jammed between it and joints: impulses would have had no bound",
            work.jammed, work.steps
        ));
    }
    if let Some(work) = contacts.filter(|w| w.deepest_m > DEPTH_WORTH_TELLING_M) {
        list.push(format!(
            "contacts were up to {:.1} mm deep (heavy bodies on light ones, or impacts whose impulses did not settle in {} of {} steps); a smaller {finer} holds them better",
            1e3 * work.deepest_m,
            work.unfinished,
            work.steps
        ));
    }
    list
}

/// What a model asks for and does not get, whatever the run does.
pub(in crate::mbs) fn remarks_on_wishes(model: &Model) -> Vec<String> {
    let all = [
        remark_on_late_events(model),
        remark_on_late_forces(model),
        remark_on_reactions(model),
        remark_on_oblique_axes(model),
        remark_on_inertia(model),
        remark_on_joints_at_surfaces(model),
    ];
    all.into_iter().flatten().collect()
}

/// That the tolerance of a model of bushings has no effect, if it is not the one by default.
pub(super) fn remark_on_tolerance(model: &Model) -> Option<String> {
    let given = model.settings.tolerance;
    (given != TOLERANCE).then(|| {
        format!("settings.tolerance = {given:e} has no effect: without ideal joints and forces the step is that of settings.time_step_s (or --step), or follows from the stiffest bushing")
    })
}

/// Radius of gyration over the farthest point of a body's shapes from its centre of mass above which its inertia is a slip; at most 1 where the shapes are all of the body.
const SPREAD: f64 = 20.0;

/// That bodies have inertia that their shapes cannot have, if there are any.
fn remark_on_inertia(model: &Model) -> Option<String> {
    let sizes = |body: &Body| {
        let corners = body.shapes.iter().flat_map(Shape::corners);
        let extent_m = corners.map(math::norm).reduce(f64::max)?;
        let inertia = nalgebra::Matrix3::from_fn(|i, j| body.inertia_kg_m2[i][j]);
        Some([(inertia.symmetric_eigenvalues().max() / body.mass_kg).sqrt(), extent_m])
    };
    let of_body = |body: &Body| sizes(body).filter(|[gyration_m, extent_m]| *gyration_m > SPREAD * extent_m);
    let mut odd = model.bodies.iter().filter_map(|body| of_body(body).map(|sizes| (&body.id, sizes)));
    let (id, [gyration_m, extent_m]) = odd.next()?;
    let others = match odd.count() {
        0 => String::new(),
        more => format!("; so do {more} more"),
    };
    Some(format!(
        "body \"{id}\": inertia_kg_m2 over mass_kg gives a radius of gyration of {gyration_m:.3e} m, and its shapes reach {extent_m:.3e} m from its centre of mass: a slip of the exponent or the unit?{others}"
    ))
}

/// How far from a foot on a plane or obstacle a joint with the ground may be to hold it there, over the size of the shape.
const AT_FOOT: f64 = 0.25;

/// That a body which a joint holds to the ground stands on a plane or obstacle there, which does not let it turn: of `contact.ground` alone joined bodies are free.
fn remark_on_joints_at_surfaces(model: &Model) -> Option<String> {
    let mut found = model.joined_to_ground().filter_map(|(joint, body, point)| {
        stands_on(model, body, point).map(|surface| [joint, body, surface])
    });
    let [joint, body, surface] = found.next()?;
    let others = match found.count() {
        0 => String::new(),
        more => format!("; so do {more} more"),
    };
    Some(format!(
        "body \"{body}\" stands on \"{surface}\" where joint \"{joint}\" holds it to the ground: it cannot turn about the joint into the surface (bodies joined to the ground are free of contact.ground alone); if it is meant to turn, add {{\"a\": \"{body}\", \"b\": \"{surface}\", \"ignore\": true}} to contact.pairs{others}"
    ))
}

/// The plane or obstacle that a body stands on beside a point.
fn stands_on<'a>(model: &'a Model, id: &str, point: math::V3) -> Option<&'a str> {
    let body = model.bodies.iter().find(|body| body.id == *id)?;
    let turn = math::qmat(math::qunit(body.orientation));
    body.shapes.iter().find_map(|shape| {
        let at = |c: &math::V3| math::add(body.position_m, math::mul(&turn, *c));
        let corners: Vec<math::V3> = shape.corners().iter().map(at).collect();
        let size_m = math::norm(math::sub(*corners.last()?, corners[0]));
        let is_foot = |c: &&math::V3| math::norm(math::sub(**c, point)) <= AT_FOOT * size_m;
        corners.iter().filter(is_foot).find_map(|c| surface_under(model, id, *c))
    })
}

/// The plane or obstacle that a point of a body lies on, if they touch.
fn surface_under<'a>(model: &'a Model, body: &str, point: math::V3) -> Option<&'a str> {
    let contact = &model.contact;
    let planes = contact.planes.iter().filter(|p| {
        let above_m = math::dot(p.normal, math::sub(point, p.point_m)) / math::norm(p.normal);
        above_m.abs() <= AT_GROUND_M
    });
    let obstacles = contact.obstacles.iter().filter(|o| {
        let inside = |k: usize| (o.min_m[k]..=o.max_m[k]).contains(&point[k]);
        (point[2] - o.max_m[2]).abs() <= AT_GROUND_M && inside(0) && inside(1)
    });
    let mut all = planes.map(|p| p.id.as_str()).chain(obstacles.map(|o| o.id.as_str()));
    all.find(|id| !contact.pairs.iter().any(|p| p.ignore && p.a == body && p.b == *id))
}

/// That the second axis of universal joints is not quite the one given, if so.
fn remark_on_oblique_axes(model: &Model) -> Option<String> {
    let mut oblique = model.joints.iter().filter(|j| j.squared_axis_b().is_some());
    let first = oblique.next()?;
    let cosine = first.cosine().unwrap_or_default();
    let others = match oblique.count() {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    Some(format!(
        "joint \"{}\": axis_b is not quite at a right angle to axis (cosine {cosine:.1e}), its part across it is taken{others}",
        first.id
    ))
}

/// That there are no reactions without ideal joints.
fn remark_on_reactions(model: &Model) -> Option<String> {
    let asked = model.settings.reactions && model.joints.is_empty();
    asked.then(|| {
        "settings.reactions records forces of ideal joints, and the model has none; those of bushings with curves stand in hinges.csv".into()
    })
}

/// That forces that begin after the end do not act, if there are any.
fn remark_on_late_forces(model: &Model) -> Option<String> {
    let begins = |f: &Force| match f {
        Force::Force { from_to_s: Some([from, _]), .. }
        | Force::Torque { from_to_s: Some([from, _]), .. } => *from,
        _ => 0.0,
    };
    let mut late = model.forces.iter().filter(|f| begins(f) >= model.settings.end_time_s);
    let first = late.next()?;
    let what = format!("force \"{}\" from {} s", first.id(), begins(first));
    Some(not_reached(model, &what, late.count(), "act"))
}

/// That events after the end do not happen, if there are any.
fn remark_on_late_events(model: &Model) -> Option<String> {
    let end_s = model.settings.end_time_s;
    let late: Vec<&Event> = model.events.iter().filter(|e| e.time_s > end_s * (1.0 + SAME)).collect();
    let first = late.iter().min_by(|a, b| a.time_s.total_cmp(&b.time_s))?;
    let what = format!("event \"{}\" at {} s", first.id, first.time_s);
    Some(not_reached(model, &what, late.len() - 1, "happen"))
}

/// That the run ends before something, and so many more of its kind.
fn not_reached(model: &Model, what: &str, more: usize, verb: &str) -> String {
    let others = match more {
        0 => format!("does not {verb}"),
        more => format!("and {more} more do not {verb}"),
    };
    let end_s = model.settings.end_time_s;
    format!("{what} {others}: the run ends before, at settings.end_time_s = {end_s}")
}

/// Joints named in a remark.
const NAMED: usize = 5;

/// One remark on all joints outside the levels of their curves, however many.
pub(super) fn remark_on_levels(joints: &[(String, f64, f64)]) -> Option<String> {
    let (first, time_s, force_n) = joints.first()?;
    let named: Vec<&str> = joints.iter().skip(1).take(NAMED).map(|(id, ..)| id.as_str()).collect();
    let more = joints.len() - 1 - named.len();
    let others = match (named.is_empty(), more) {
        (true, _) => String::new(),
        (false, 0) => format!("; so do later {}", named.join(", ")),
        (false, more) => format!("; so do later {} and {more} more", named.join(", ")),
    };
    Some(format!(
        "joint \"{first}\" flows from t = {time_s:.4} s under an axial force ({:.1} kN) outside the levels of its curve, where the nearest level is used{others}",
        1e-3 * force_n
    ))
}

/// Bushings that have turned farther than they can tell, with the first time of it \[s\].
#[derive(Debug, Clone, Default)]
pub(in crate::mbs) struct Overturned(Vec<(String, f64)>);

impl Overturned {
    /// Enters one, if it is not known yet.
    pub fn note(&mut self, id: &str, time_s: f64) {
        if self.0.iter().all(|(own, _)| own != id) {
            self.0.push((id.into(), time_s));
        }
    }

    /// What is to be said of them.
    pub fn remark(&self) -> Option<String> {
        let (first, time_s) = self.0.first()?;
        let others = match self.0.len() - 1 {
            0 => String::new(),
            more => format!(", later {more} more"),
        };
        Some(format!(
            "bushing \"{first}\" has turned by more than {MOST_TURN_RAD} rad at {time_s:.4} s{others}: past a full revolution its moments and plastic rotation are wrong; a `hinge` or a `torsion` spring of `forces` counts revolutions"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tolerance is of ideal joints: models of bushings do not know it.
    #[test]
    fn remarks_name_settings_that_the_model_obeys() {
        let mut books = Balance::new(1.0, 0.0);
        (books.error, books.growth) = (0.03, 0.03);
        let work = Work { deepest_m: 0.1, ..Work::default() };
        let said = closing_remarks(&books, Some(work), FINER);
        assert_eq!(said.len(), 3, "{said:?}");
        let in_file = |words: &String| words.contains("settings.time_step_s in the model's file");
        assert!(said.iter().all(|words| in_file(words) && !words.contains("tolerance")), "{said:?}");
        let ideal = closing_remarks(&books, None, FINER_IDEAL);
        assert!(
            ideal.iter().all(|words| in_file(words) && words.contains("settings.tolerance")),
            "{ideal:?}"
        );
    }

    /// Axes that are off a right angle by one part in 1e5, as rounded in a drawing.
    #[test]
    fn axes_not_quite_at_a_right_angle_are_squared_and_told() {
        let text = r#"{"schema": "fallwerk-mbs/2", "name": "m", "gravity_m_s2": [0, 0, 0], "bodies": [
                {"id": "b", "mass_kg": 1, "inertia_kg_m2": [[1,0,0],[0,1,0],[0,0,1]], "position_m": [0,0,0]}],
            "joints": [{"id": "j", "kind": "universal", "body_b": "b", "point_m": [0,0,0], "axis": [0, 1, 0], "axis_b": [1, 1e-5, 0]}]}"#;
        let mut model: Model = serde_json::from_str(text).unwrap();
        model.check().unwrap();
        assert_eq!(model.joints[0].squared_axis_b(), Some([1.0, 0.0, 0.0]));
        let said = remarks_on_wishes(&model);
        assert!(said.len() == 1 && said[0].contains("cosine 1.0e-5"), "{said:?}");
        model.joints[0].axis_b = Some([1.0, 1e-7, 0.0]);
        assert_eq!(remarks_on_wishes(&model), Vec::<String>::new());
        model.joints[0].axis_b = Some([1.0, 0.002, 0.0]);
        let said = model.check().unwrap_err().to_string();
        assert!(
            said.contains("joints[0].axis_b: is not at a right angle to axis (cosine 2.0e-3, at most 1e-3)"),
            "{said}"
        );
    }

    #[test]
    fn a_joint_at_the_foot_of_a_body_on_a_plane_is_told() {
        let text = r#"{"schema": "fallwerk-mbs/2", "name": "t", "gravity_m_s2": [0, 0, -9.81],
             "settings": {"end_time_s": 0.1, "output_interval_s": 0.1}, "tracked": [],
             "contact": {"planes": [{"id": "p", "point_m": [0, 0, 0], "normal": [0, 0, 2], "friction": 0.5, "restitution": 0}]},
             "joints": [{"id": "foot", "kind": "revolute", "body_b": "column", "point_m": [0, 0, 0], "axis": [0, 1, 0]}],
             "bodies": [{"id": "column", "mass_kg": 1, "inertia_kg_m2": [[1,0,0],[0,1,0],[0,0,1]], "position_m": [0, 0, 2],
                 "shapes": [{"kind": "box", "center_m": [0,0,0], "half_extents_m": [0.2, 0.2, 2.0]}]}]}"#;
        let mut model: Model = serde_json::from_str(text).unwrap();
        let said = remark_on_joints_at_surfaces(&model).unwrap();
        assert!(said.contains("\"column\" stands on \"p\" where joint \"foot\""), "{said}");
        model.bodies[0].position_m[2] = 2.01;
        assert_eq!(remark_on_joints_at_surfaces(&model), None);
        model.bodies[0].position_m[2] = 2.0;
        model.contact.obstacles.push(crate::mbs::model::ObstacleBox {
            id: "o".into(),
            min_m: [-1.0, -1.0, -1.0],
            max_m: [1.0, 1.0, 0.0],
            friction: 0.5,
            restitution: 0.0,
        });
        model.contact.planes.clear();
        assert!(remark_on_joints_at_surfaces(&model).is_some_and(|said| said.contains("\"o\"")));
        model.contact.obstacles.clear();
        assert_eq!(remark_on_joints_at_surfaces(&model), None);
    }

    /// A cube of 0.2 m has its corners at 0.173 m: at 1 kg, with 16 kg m² it has a radius of gyration of 23 times that, with 9 kg m² of 17 times.
    #[test]
    fn inertia_that_shapes_cannot_have_is_told() {
        let text = r#"{"schema": "fallwerk-mbs/2", "name": "m", "gravity_m_s2": [0, 0, 0], "bodies": [
                {"id": "b", "mass_kg": 1, "inertia_kg_m2": [[16,0,0],[0,16,0],[0,0,16]], "position_m": [0,0,0],
                 "shapes": [{"kind": "box", "center_m": [0,0,0], "half_extents_m": [0.1, 0.1, 0.1]}]}]}"#;
        let mut model: Model = serde_json::from_str(text).unwrap();
        let said = remarks_on_wishes(&model);
        assert!(
            said.len() == 1 && said[0].contains("4.000e0 m") && said[0].contains("1.732e-1 m"),
            "{said:?}"
        );
        (0..3).for_each(|k| model.bodies[0].inertia_kg_m2[k][k] = 9.0);
        assert_eq!(remarks_on_wishes(&model), Vec::<String>::new());
        model.bodies[0].inertia_kg_m2[0][0] = 1e6;
        model.bodies[0].shapes.clear();
        assert_eq!(remarks_on_wishes(&model), Vec::<String>::new());
    }

    #[test]
    fn a_tolerance_without_effect_is_told() {
        let mut model = Model::empty("m", [0.0; 3], 1.0, 0.1);
        assert_eq!(remark_on_tolerance(&model), None);
        model.settings.tolerance = 1e-8;
        let said = remark_on_tolerance(&model).unwrap();
        assert!(said.starts_with("settings.tolerance = 1e-8 has no effect"), "{said}");
    }

    #[test]
    fn reactions_without_joints_are_told() {
        let mut model = Model::empty("m", [0.0; 3], 1.0, 0.1);
        assert_eq!(remarks_on_wishes(&model), Vec::<String>::new());
        model.settings.reactions = true;
        let said = remarks_on_wishes(&model);
        assert!(said.len() == 1 && said[0].starts_with("settings.reactions"), "{said:?}");
    }
}
