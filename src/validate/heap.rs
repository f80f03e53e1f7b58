//! What is left of a building at the end of a run: its plan projection and how high it reaches.

use super::measure::Footprint;
use crate::fe::dynamics::Death;
use crate::fe::result::FeRun;
use crate::mbs::Model;
use crate::mbs::result::RunResult;

/// What is left at the end.
#[derive(Debug, Clone, PartialEq)]
pub struct Heap {
    /// Its plan projection.
    pub footprint: Footprint,
    /// Its highest point \[m\]; negative infinity: nothing is left.
    pub top_m: f64,
}

impl Heap {
    fn nothing() -> Self {
        Self { footprint: Footprint::default(), top_m: f64::NEG_INFINITY }
    }

    /// Adds a convex body by its corners \[m\].
    fn add(&mut self, corners_m: &[[f64; 3]]) {
        let plan: Vec<[f64; 2]> = corners_m.iter().map(|p| [p[0], p[1]]).collect();
        self.footprint.add(&plan);
        self.top_m = corners_m.iter().map(|p| p[2]).fold(self.top_m, f64::max);
    }

    /// The elements that are left.
    pub fn of_fe(run: &FeRun) -> Self {
        let mut heap = Self::nothing();
        let frame = &run.last_m;
        let mut gone = vec![false; run.mesh.elements.len()];
        run.deaths.iter().filter(|d| d.cause != Death::Split).for_each(|d| gone[d.element] = true);
        for (element, _) in run.mesh.elements.iter().zip(&gone).filter(|(_, gone)| !**gone) {
            heap.add(&element.nodes.map(|n| frame[n].map(f64::from)));
        }
        heap
    }

    /// The bodies that are left.
    pub fn of_mbs(model: &Model, run: &RunResult) -> Self {
        let mut heap = Self::nothing();
        let Some(frame) = run.frames.last() else { return heap };
        let removed = |id: &str| model.events.iter().any(|e| e.remove_bodies.iter().any(|b| b == id));
        for (index, body) in model.bodies.iter().enumerate().filter(|(_, b)| !removed(&b.id)) {
            let [w, x, y, z] = frame.orientation[index];
            let turn = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
            for shape in &body.shapes {
                let at = |local: [f64; 3]| {
                    let at = turn * nalgebra::Vector3::from(local);
                    std::array::from_fn(|i| frame.position_m[index][i] + at[i])
                };
                heap.add(&shape.corners().into_iter().map(at).collect::<Vec<[f64; 3]>>());
            }
        }
        heap
    }
}
