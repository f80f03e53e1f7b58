//! A complete explicit finite element model: the mesh with loads, constraints and what is to be recorded. Keyword decks are read
//! into it and written from it; the runs of buildings and of decks start from it.

use super::mesh::Mesh;
use crate::base::piecewise::interpolate;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Everything a run starts from.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// Title.
    pub title: String,
    /// Nodes, elements, laws, parts.
    pub mesh: Mesh,
    /// Components of nodes that are held.
    pub constraints: Vec<Constraint>,
    /// Initial velocity of nodes that do not start at rest \[m/s\], by node.
    pub initial_velocity_m_s: Vec<(usize, [f64; 3])>,
    /// Accelerations that act on all mass.
    pub body_loads: Vec<BodyLoad>,
    /// Forces on nodes.
    pub nodal_loads: Vec<NodalLoad>,
    /// Velocities given to nodes.
    pub driven: Vec<DrivenNode>,
    /// Rigid planes.
    pub walls: Vec<RigidPlane>,
    /// Contact between all outer faces of the body (`None`: no such contact).
    pub body_contact: Option<ContactSettings>,
    /// Time, step, output.
    pub control: Control,
}

/// Held components of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Constraint {
    /// Node index.
    pub node: usize,
    /// Held directions.
    pub held: [bool; 3],
}

/// A history as `(time [s], value)`, linear between points, constant outside. Clones share its points: a set of nodes that follow one has it once.
#[derive(Debug, Clone, Default)]
pub struct Curve(pub(crate) Arc<Vec<[f64; 2]>>);

impl PartialEq for Curve {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0 == other.0
    }
}

impl Curve {
    /// Through points in rising order of time.
    pub fn new(points: Vec<[f64; 2]>) -> Self {
        Self(Arc::new(points))
    }

    /// A value that does not change.
    pub fn constant(value: f64) -> Self {
        Self::new(vec![[0.0, value]])
    }

    /// Value at a time \[s\]; 0 for a curve without points.
    pub fn at(&self, time_s: f64) -> f64 {
        interpolate(&self.0, time_s)
    }
}

/// An acceleration field.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyLoad {
    /// Direction, 0 to 2.
    pub axis: usize,
    /// Acceleration of the mass along the axis over time \[m/s²\]: gravity along -z is -9.81 on axis 2.
    pub acceleration_m_s2: Curve,
}

/// A force on a node.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalLoad {
    /// Node index.
    pub node: usize,
    /// Direction, 0 to 2.
    pub axis: usize,
    /// Force over time \[N\].
    pub force_n: Curve,
}

/// A component of a node that moves as given.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivenNode {
    /// Node index.
    pub node: usize,
    /// Direction, 0 to 2.
    pub axis: usize,
    /// Velocity over time \[m/s\].
    pub velocity_m_s: Curve,
}

/// A rigid immovable plane; matter stays on the side its normal points to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RigidPlane {
    /// A point on the plane \[m\].
    pub point_m: [f64; 3],
    /// Unit normal.
    pub normal: [f64; 3],
    /// Coulomb friction coefficient; infinite: no slip.
    pub friction: f64,
    /// Nodes that it stops; `None`: all.
    pub nodes: Option<Vec<usize>>,
}

/// Contact of the body with itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSettings {
    /// Coulomb friction coefficient.
    pub friction: f64,
}

impl Default for ContactSettings {
    fn default() -> Self {
        Self { friction: 0.5 }
    }
}

/// How long, with which step, and what is recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Control {
    /// End time \[s\].
    pub end_time_s: f64,
    /// Share of the critical time step that is used.
    pub step_safety: f64,
    /// Least time step \[s\] kept by adding mass where elements allow less (`None`: no mass scaling).
    pub mass_scaling_step_s: Option<f64>,
    /// Interval of the mesh states \[s\].
    pub state_interval_s: f64,
    /// Interval of the histories \[s\].
    pub history_interval_s: f64,
    /// Nodes whose motion is recorded.
    pub history_nodes: Vec<usize>,
}

impl Default for Control {
    fn default() -> Self {
        Self {
            end_time_s: 1.0,
            step_safety: super::dynamics::STEP_SAFETY,
            mass_scaling_step_s: None,
            state_interval_s: 0.05,
            history_interval_s: 0.01,
            history_nodes: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Curve;

    #[test]
    fn curve_is_linear_between_points_and_constant_outside() {
        let curve = Curve::new(vec![[1.0, 2.0], [3.0, 6.0]]);
        assert_eq!([0.0, 1.0, 2.0, 3.0, 9.0].map(|t| curve.at(t)), [2.0, 2.0, 4.0, 6.0, 6.0]);
        assert_eq!(Curve::constant(-9.81).at(7.0), -9.81);
    }
}
