//! Linear static analysis of a three-dimensional frame.
//!
//! Timoshenko beams with exact (interdependent) shape functions, rigid end offsets, horizontal rigid
//! diaphragms, dead loads. Stiffness: Przemieniecki, *Theory of Matrix Structural Analysis*, 1968,
//! eq. 5.116; an infinite shear area gives Euler-Bernoulli. First order: no P-Δ.
//!
//! Signs: global forces and displacements along the global axes. Section forces act on the face
//! whose outward normal points along the element's first axis; the axial force is positive in **compression**.

mod element;
mod solve;

pub use element::{BeamSection, Element, Flange, LineLoad};
pub use solve::{FrameError, FrameSolution, Mechanism};

use serde::Serialize;

/// A node with its loads and fixed directions.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameNode {
    /// Name for messages.
    pub id: String,
    /// Position \[m\].
    pub point_m: [f64; 3],
    /// Held translations along and rotations about x, y, z.
    pub fixed: [bool; 6],
    /// Applied force \[N\] and moment \[N m\].
    pub load: [f64; 6],
}

impl FrameNode {
    /// A free node without load.
    pub fn free(id: impl Into<String>, point_m: [f64; 3]) -> Self {
        Self { id: id.into(), point_m, fixed: [false; 6], load: [0.0; 6] }
    }

    /// A clamped node.
    pub fn clamped(id: impl Into<String>, point_m: [f64; 3]) -> Self {
        Self { fixed: [true; 6], ..Self::free(id, point_m) }
    }
}

/// Nodes whose `u_x`, `u_y` and rotation about `z` follow one rigid horizontal motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Diaphragm {
    /// Indices of the nodes.
    pub nodes: Vec<usize>,
}

/// A frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Frame {
    /// Nodes.
    pub nodes: Vec<FrameNode>,
    /// Elements.
    pub elements: Vec<Element>,
    /// Diaphragms; no node may be in two.
    pub diaphragms: Vec<Diaphragm>,
}

impl Frame {
    /// Some of its elements alone, on all of its nodes; loads on nodes without an element count for nothing.
    pub fn part(&self, elements: &[usize]) -> Self {
        let elements = elements.iter().map(|e| self.elements[*e].clone()).collect();
        Self { nodes: self.nodes.clone(), elements, diaphragms: self.diaphragms.clone() }
    }
}

/// Section forces at one end of an element, on the face whose outward normal points along axis 0
/// of the element's axes (from its first to its second end).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct SectionForces {
    /// Axial force, compression positive \[N\].
    pub axial_n: f64,
    /// Shear along axes 1 and 2 \[N\].
    pub shear_n: [f64; 2],
    /// Torsion about axis 0 \[N m\].
    pub torsion_nm: f64,
    /// Bending moments about axes 1 and 2 \[N m\]. A positive moment about axis 1 stretches the fibres at
    /// positive axis 2, one about axis 2 those at negative axis 1.
    pub moment_nm: [f64; 2],
}
