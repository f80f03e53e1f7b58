//! The joints of MuJoCo that one connection is made of.

use super::tree::{Edge, Via, parallel};
use crate::export::backbone::{of_curve, of_hinge, peak_nm};
use crate::export::{BEAM_STAYS_ELASTIC, Notes, number::plain};
use crate::mbs::math::{self, V3};
use crate::mbs::model::{Bending, Bushing, Force, Joint, JointKind, Model};

/// Kind of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Slide,
    Hinge,
    Ball,
}

/// A joint with its spring.
#[derive(Debug, Clone)]
pub(super) struct Dof {
    pub name: String,
    pub kind: Kind,
    /// Point and axis in the global frame at the start \[m\].
    pub point: V3,
    pub axis: V3,
    /// Stiffness \[N/m or N m/rad\], damping, and the displacement at which it yields.
    pub stiffness: f64,
    pub damping: f64,
    pub yields: Option<f64>,
}

impl Dof {
    fn new(name: String, kind: Kind, point: V3, axis: V3) -> Self {
        Self { name, kind, point, axis, stiffness: 0.0, damping: 0.0, yields: None }
    }
}

/// The joints of a connection in the order from its first body to its second.
pub(super) fn dofs(model: &Model, edge: &Edge, notes: &mut Notes) -> Vec<Dof> {
    match edge.via {
        Via::Joint(i) => {
            let mut list = of_joint(&model.joints[i]);
            for &force in &edge.springs {
                attach(model, &model.forces[force], &mut list, notes);
            }
            list
        }
        Via::Bushing(i) => of_bushing(model, &model.bushings[i], notes),
    }
}

/// Two directions at right angles to one and to each other.
fn across(axis: V3) -> [V3; 2] {
    let frame = crate::mbs::ideal::joint::frame_about(axis);
    [frame[1], frame[2]]
}

fn of_joint(joint: &Joint) -> Vec<Dof> {
    let axis = joint.axis.unwrap_or([0.0, 0.0, 1.0]);
    let list: Vec<(Kind, V3)> = match joint.kind {
        JointKind::Spherical => vec![(Kind::Ball, axis)],
        JointKind::Revolute => vec![(Kind::Hinge, axis)],
        JointKind::Universal => vec![(Kind::Hinge, axis), (Kind::Hinge, joint.axis_b.unwrap_or(axis))],
        JointKind::Cylindrical => vec![(Kind::Slide, axis), (Kind::Hinge, axis)],
        JointKind::Prismatic => vec![(Kind::Slide, axis)],
        JointKind::Planar => {
            let [u, v] = across(axis);
            vec![(Kind::Slide, u), (Kind::Slide, v), (Kind::Hinge, axis)]
        }
        JointKind::PointOnLine => vec![(Kind::Slide, axis), (Kind::Ball, axis)],
        JointKind::Fixed | JointKind::Rod => Vec::new(),
    };
    let one = list.len() == 1;
    let name = |i: usize| if one { joint.id.clone() } else { format!("{}:{}", joint.id, i + 1) };
    list.into_iter()
        .enumerate()
        .map(|(i, (kind, axis))| Dof::new(name(i), kind, joint.point_m, axis))
        .collect()
}

/// How much more than one axis bears the three axes of a body bear together about another one: a rotation about it flows about all of them.
fn shares_of(model: &Model, body: Option<&str>, axis: V3) -> f64 {
    let turn =
        body.and_then(|id| model.bodies.iter().find(|b| b.id == id)).map(|b| math::qmat(b.orientation));
    let along = turn.map_or(axis, |r| math::mul_t(&r, axis));
    along.iter().map(|v| v.abs()).sum::<f64>() / math::norm(axis)
}

/// Puts a spring or hinge on the joints that turn about its axes.
fn attach(model: &Model, force: &Force, list: &mut [Dof], notes: &mut Notes) {
    match force {
        Force::Torsion { axis, stiffness_nm_rad, damping_nm_s_rad, .. } => {
            let turning = list.iter_mut().find(|d| d.kind == Kind::Hinge && parallel(d.axis, *axis));
            if let Some(dof) = turning {
                dof.stiffness += stiffness_nm_rad;
                dof.damping += damping_nm_s_rad;
            }
        }
        Force::Hinge { id, body_a, stiffness_nm_rad, capacity, fracture_rad, joint, .. } => {
            let shares = |axis: V3| shares_of(model, body_a.as_deref(), axis);
            let peak = peak_nm(&of_hinge(*stiffness_nm_rad, capacity));
            let ball = list.iter().any(|d| d.kind == Kind::Ball);
            for dof in list.iter_mut().filter(|d| d.kind != Kind::Slide) {
                dof.stiffness += stiffness_nm_rad;
                let about = if dof.kind == Kind::Hinge { shares(dof.axis) } else { 1.0 };
                dof.yields = Some(about * peak / stiffness_nm_rad);
            }
            if capacity.iter().any(|p| p[1] != capacity[0][1]) {
                let text =
                    format!("softening is left out: it keeps its largest capacity, {} N m", plain(peak));
                notes.add(id, text);
            }
            if ball {
                notes.add(id, "it yields by the length of the rotation vector, not about each axis");
            }
            if let Some(limit) = fracture_rad {
                let opens = joint.as_ref().map_or(String::new(), |j| format!(", joint {j} does not open"));
                notes.add(id, format!("fracture at {} rad is left out{opens}", plain(*limit)));
            }
        }
        _ => {}
    }
}

/// Hinges about the point of the first body: bending, torsion, bending; then three slides along axes that turn with the second one. The middle hinge must not come near a right angle.
fn of_bushing(model: &Model, bushing: &Bushing, notes: &mut Notes) -> Vec<Dof> {
    let dof = |part: &str, kind, axis, stiffness| {
        let name = format!("{}:{part}", bushing.id);
        Dof { stiffness, ..Dof::new(name, kind, bushing.point_m, bushing.axes[axis]) }
    };
    let [shear_1, shear_2] = bushing.shear_stiffness_n_m;
    let mut bend = |k: usize, part: &str| {
        let mut own = dof(part, Kind::Hinge, k + 1, 0.0);
        match &bushing.bending[k] {
            Bending::Elastic { stiffness_nm_rad } => own.stiffness = *stiffness_nm_rad,
            Bending::Curve { curve, .. } if bushing.beam.is_some() => {
                own.stiffness = model.curves.get(curve).map_or(0.0, |c| c.stiffness_nm_rad);
                notes.add(&bushing.id, BEAM_STAYS_ELASTIC);
            }
            Bending::Curve { curve, strength_factor } => {
                if let Some(curve) = model.curves.get(curve) {
                    let peak = peak_nm(&of_curve(curve, *strength_factor));
                    own.stiffness = curve.stiffness_nm_rad;
                    own.yields = Some(peak / curve.stiffness_nm_rad);
                    let text = format!(
                        "bending {}: softening, fracture and the effect of axial force are left out: it keeps its largest capacity without axial force, {} N m",
                        k + 1,
                        plain(peak)
                    );
                    notes.add(&bushing.id, text);
                }
            }
        }
        own
    };
    let list = vec![
        bend(0, "bending-1"),
        dof("torsion", Kind::Hinge, 0, bushing.torsional_stiffness_nm_rad),
        bend(1, "bending-2"),
        dof("axial", Kind::Slide, 0, bushing.axial_stiffness_n_m),
        dof("shear-1", Kind::Slide, 1, shear_1),
        dof("shear-2", Kind::Slide, 2, shear_2),
    ];
    if bushing.bending.iter().all(|b| b.curve().is_some()) {
        notes.add(
            &bushing.id,
            "the ellipse that bounds the moments about both bending axes together is left out",
        );
    }
    notes.add_of_bushing(bushing);
    list
}
