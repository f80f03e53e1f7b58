//! Joints. Adams puts marker I of a joint and marker J on it; z is the axis, but for Hooke's joint, which turns about x of I and y of J.

use super::Writer;
use crate::export::number::plain;
use crate::export::opening;
use crate::mbs::ideal::joint::frame_about;
use crate::mbs::math::{M3, V3, cross, norm, scale, sub};
use crate::mbs::model::{Joint, JointKind};

/// A right-handed frame (rows) with its last axis along a direction.
pub(super) fn frame_with_z(axis: V3) -> M3 {
    let [z, x, y] = frame_about(axis);
    [x, y, z]
}

/// Rows x along `a`, y along `b`, which stand at a right angle.
fn frame_with_xy(a: V3, b: V3) -> M3 {
    let (x, y) = (scale(1.0 / norm(a), a), scale(1.0 / norm(b), b));
    [x, y, cross(x, y)]
}

impl Writer<'_> {
    pub(super) fn joints(&mut self) {
        if self.model.joints.is_empty() {
            return;
        }
        self.data.section("JOINTS");
        let opens = opening(self.model);
        let (mut primitives, mut rods) = (0, 0);
        for (i, joint) in self.model.joints.iter().enumerate() {
            let [a, b] = [self.part(joint.body_a.as_deref()), self.part(Some(&joint.body_b))];
            if opens.contains(joint.id.as_str()) {
                let text = "it does not open by itself; deactivate it in the commands of the run";
                self.notes.add(&joint.id, text);
            }
            match joint.kind {
                JointKind::Rod => {
                    rods += 1;
                    self.rod(joint, rods, [a, b]);
                }
                JointKind::PointOnLine => {
                    primitives += 1;
                    let [j, i] = self.pair(joint, [a, b]);
                    // the point of the second body stays on the z axis of the first one's marker
                    let arguments = ["INLINE".to_string(), format!("I = {i}"), format!("J = {j}")];
                    self.data.named("JPRIM", primitives, &joint.id, &arguments);
                }
                _ => {
                    let [first, second] = self.pair(joint, [a, b]);
                    let arguments =
                        [word(joint.kind).into(), format!("I = {first}"), format!("J = {second}")];
                    self.data.named("JOINT", i + 1, &joint.id, &arguments);
                }
            }
        }
    }

    /// Markers of a joint on its first and second body, with the same axes at the start.
    fn pair(&mut self, joint: &Joint, parts: [usize; 2]) -> [usize; 2] {
        let z = joint.axis.unwrap_or([0.0, 0.0, 1.0]);
        let axes = match joint.axis_b {
            Some(b) => frame_with_xy(z, b),
            None => frame_with_z(z),
        };
        parts.map(|part| self.marker_at(part, joint.point_m, Some(&axes)))
    }

    fn rod(&mut self, joint: &Joint, number: usize, [a, b]: [usize; 2]) {
        let end = joint.point_b_m.unwrap_or(joint.point_m);
        let i = self.marker_at(a, joint.point_m, None);
        let j = self.marker_at(b, end, None);
        let length = plain(norm(sub(end, joint.point_m)));
        self.data.named("GCON", number, &joint.id, &[format!("FUNCTION = DM({i},{j}) - {length}")]);
    }
}

fn word(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Spherical => "SPHERICAL",
        JointKind::Revolute => "REVOLUTE",
        JointKind::Universal => "HOOKE",
        JointKind::Cylindrical => "CYLINDRICAL",
        JointKind::Prismatic => "TRANSLATIONAL",
        JointKind::Fixed => "FIXED",
        JointKind::Planar => "PLANAR",
        JointKind::PointOnLine | JointKind::Rod => "",
    }
}
