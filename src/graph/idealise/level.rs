//! The axes of a floor in one plane.
//!
//! A diaphragm ties the horizontal motions of its nodes. Between nodes at different heights the ties would keep the floor from tilting: the forces with which they do so leave the one node at its height and enter the
//! other one at another, and the couple of both is lost. So nodes and axes of a floor whose beams differ in depth are taken at their mean height, beams as far above or below it as they were from their nodes. Columns end where they are.

use super::Builder;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::graph::frame::Diaphragm;

impl Builder<'_> {
    /// Puts the nodes of each diaphragm, and the beams and strips between them, into one plane.
    pub(super) fn level(&mut self, diaphragms: &[Diaphragm]) {
        let mut floor_of = vec![None; self.nodes.len()];
        for (floor, diaphragm) in diaphragms.iter().enumerate() {
            diaphragm.nodes.iter().for_each(|n| floor_of[*n] = Some(floor));
        }
        let planes: Vec<Option<f64>> = diaphragms.iter().map(|d| self.plane_m(d)).collect();
        for span in self.spans.iter_mut().filter(|s| s.axis < 2) {
            let Some(&(_, first)) = span.nodes.first() else { continue };
            let Some(floor) = floor_of[first] else { continue };
            let (Some(plane_m), true) =
                (planes[floor], span.nodes.iter().all(|(_, n)| floor_of[*n] == Some(floor)))
            else {
                continue;
            };
            let count = span.nodes.len() as f64;
            let nodes_m = span.nodes.iter().map(|(_, n)| self.nodes[*n].point_m[2]).sum::<f64>() / count;
            span.line[2] += plane_m - nodes_m;
        }
        for (diaphragm, plane_m) in diaphragms.iter().zip(planes) {
            let Some(plane_m) = plane_m else { continue };
            diaphragm.nodes.iter().for_each(|n| self.nodes[*n].point_m[2] = plane_m);
        }
    }

    /// The mean height of its nodes; none if they are at one height \[m\].
    fn plane_m(&self, diaphragm: &Diaphragm) -> Option<f64> {
        let heights = diaphragm.nodes.iter().map(|n| self.nodes[*n].point_m[2]);
        let (low, high) = (
            heights.clone().fold(f64::INFINITY, f64::min),
            heights.clone().fold(f64::NEG_INFINITY, f64::max),
        );
        (high - low > COORDINATE_TOLERANCE_M).then(|| heights.sum::<f64>() / diaphragm.nodes.len() as f64)
    }
}
