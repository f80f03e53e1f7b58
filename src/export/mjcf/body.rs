//! Bodies with their joints, sites and shapes, and the state at the start.

use super::dof::{Dof, Kind, dofs};
use super::tree::{Node, Tree};
use super::{Sheet, attribute, contact, vector};
use crate::export::Notes;
use crate::export::number::plain;
use crate::mbs::math::{M3, Q, V3, add, cross, dot, mul_t, norm, qconj, qmat, qmul, qunit, scale, sub};
use crate::mbs::model::{Body, Model};
use std::fmt::Write as _;

/// A point fixed to a body, or to the ground.
#[derive(Debug, Clone)]
pub(super) struct Site {
    pub name: String,
    pub body: Option<usize>,
    /// In the global frame at the start \[m\].
    pub point: V3,
}

/// Pose and velocity of a body or of the ground.
struct Pose {
    x: V3,
    q: Q,
    r: M3,
    v: V3,
    w: V3,
}

impl Pose {
    fn of(model: &Model, body: Option<usize>) -> Self {
        let Some(b) = body.map(|i| &model.bodies[i]) else {
            let q = [1.0, 0.0, 0.0, 0.0];
            return Self { x: [0.0; 3], q, r: qmat(q), v: [0.0; 3], w: [0.0; 3] };
        };
        let q = qunit(b.orientation);
        Self { x: b.position_m, q, r: qmat(q), v: b.velocity_m_s, w: b.angular_velocity_rad_s }
    }
}

/// Name of a body or of a copy of it.
pub(super) fn name(body: &Body, copy: usize) -> String {
    match (copy, body.id.as_str()) {
        (0, "world") => "world:body".into(),
        (0, id) => id.into(),
        (_, id) => format!("{id}#{copy}"),
    }
}

/// Writes bodies.
pub(super) struct Writer<'a> {
    pub model: &'a Model,
    pub tree: &'a Tree,
    pub sites: &'a [Site],
    pub sheet: Sheet,
    pub notes: &'a mut Notes,
    /// Positions and velocities of all joints at the start.
    pub state: [Vec<f64>; 2],
    /// Whether a spring yields.
    pub yields: bool,
}

impl Writer<'_> {
    /// Sites on the ground.
    pub fn ground_sites(&mut self) {
        self.sites_of(None);
    }

    fn sites_of(&mut self, body: Option<usize>) {
        let pose = Pose::of(self.model, body);
        for site in self.sites.iter().filter(|s| s.body == body) {
            let local = mul_t(&pose.r, sub(site.point, pose.x));
            self.sheet.line(&format!("<site name={} pos={}/>", attribute(&site.name), vector(&local)));
        }
    }

    /// A node with all that hangs on it.
    pub fn node(&mut self, index: usize, parent: Option<usize>) {
        let node: &Node = &self.tree.nodes[index];
        let above = parent.map(|p| self.tree.nodes[p].body);
        let (base, own) = (Pose::of(self.model, above), Pose::of(self.model, Some(node.body)));
        let body = &self.model.bodies[node.body];
        let place = mul_t(&base.r, sub(own.x, base.x));
        let turn = qmul(qconj(base.q), own.q);
        self.sheet.open(&format!(
            "<body name={} pos={} quat={}>",
            attribute(&name(body, node.copy)),
            vector(&place),
            vector(&turn)
        ));
        match node.by {
            None => self.floating(body, &own),
            Some((edge, reversed)) => {
                let mut list = dofs(self.model, &self.tree.edges[edge], self.notes);
                if reversed {
                    list.reverse();
                }
                list.iter().for_each(|dof| self.joint(dof, &base, &own));
            }
        }
        self.inertial(body, 1.0 / (1 + self.tree.copies[node.body]) as f64);
        if node.copy == 0 {
            self.sites_of(Some(node.body));
            contact::shapes(&mut self.sheet, self.model, body);
        }
        for &child in &node.children {
            self.node(child, Some(index));
        }
        self.sheet.close("</body>");
    }

    fn floating(&mut self, body: &Body, own: &Pose) {
        self.sheet.line(&format!("<freejoint name={}/>", attribute(&format!("{}:free", body.id))));
        self.state[0].extend(own.x.iter().chain(&own.q));
        // MuJoCo takes the angular velocity of a free joint in the body's frame
        self.state[1].extend(own.v.iter().chain(&mul_t(&own.r, own.w)));
    }

    fn joint(&mut self, dof: &Dof, base: &Pose, own: &Pose) {
        let (kind, turning) = match dof.kind {
            Kind::Slide => ("slide", false),
            Kind::Hinge => ("hinge", true),
            Kind::Ball => ("ball", true),
        };
        let mut text = format!("<joint name={} type=\"{kind}\"", attribute(&dof.name));
        if turning {
            let _ = write!(text, " pos={}", vector(&mul_t(&own.r, sub(dof.point, own.x))));
        }
        let axis = scale(1.0 / norm(dof.axis), dof.axis);
        if dof.kind != Kind::Ball {
            let _ = write!(text, " axis={}", vector(&mul_t(&own.r, axis)));
        }
        for (key, value) in [("stiffness", dof.stiffness), ("damping", dof.damping)] {
            if value != 0.0 {
                let _ = write!(text, " {key}=\"{}\"", plain(value));
            }
        }
        if let Some(limit) = dof.yields {
            self.yields = true;
            let _ = write!(text, " springyield=\"{}\"", plain(limit));
        }
        self.sheet.line(&(text + "/>"));
        let turning = sub(own.w, base.w);
        let at = |pose: &Pose| add(pose.v, cross(pose.w, sub(dof.point, pose.x)));
        let [positions, velocities] = &mut self.state;
        match dof.kind {
            Kind::Ball => {
                positions.extend([1.0, 0.0, 0.0, 0.0]);
                velocities.extend(mul_t(&own.r, turning));
            }
            Kind::Hinge => {
                positions.push(0.0);
                velocities.push(dot(turning, axis));
            }
            Kind::Slide => {
                positions.push(0.0);
                velocities.push(dot(sub(at(own), at(base)), axis));
            }
        }
    }

    fn inertial(&mut self, body: &Body, share: f64) {
        let m = &body.inertia_kg_m2;
        let mean = |i: usize, j: usize| 0.5 * share * (m[i][j] + m[j][i]);
        let (diagonal, rest) = ([mean(0, 0), mean(1, 1), mean(2, 2)], [mean(0, 1), mean(0, 2), mean(1, 2)]);
        let tensor = if rest == [0.0; 3] {
            format!("diaginertia={}", vector(&diagonal))
        } else {
            format!("fullinertia={}", vector(&[diagonal, rest].concat()))
        };
        let mass = plain(share * body.mass_kg);
        self.sheet.line(&format!("<inertial pos=\"0 0 0\" mass=\"{mass}\" {tensor}/>"));
    }
}

/// A point in the frame of a body or of the ground.
pub(super) fn local(model: &Model, body: Option<usize>, point: V3) -> V3 {
    let pose = Pose::of(model, body);
    mul_t(&pose.r, sub(point, pose.x))
}
