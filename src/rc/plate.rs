//! A plane end section of a piece: it moves and turns as one, stays plane, and may spread by smooth patterns.
//!
//! Across the member it spreads by `a_1 x + a_2 x² + a_3 x y` along x and `b_1 y + b_2 y² + b_3 x y` along y, as a section on a plane of symmetry. Single nodes must
//! not yield to shear forces, which the cracked part of the section could not take up. Each step takes the motion of the section to the nearest one it can have in
//! the norm of kinetic energy, so that momentum of free directions is kept.

use super::member::RcMember;
use crate::fe::dynamics::Dynamics;
use nalgebra::{Matrix3, Vector3};

/// How a plate moves.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Motion {
    /// Velocity across the member \[m/s\].
    pub across_m_s: [f64; 2],
    /// Velocity along it \[m/s\]; `None`: free.
    pub along_m_s: Option<f64>,
    /// Rotation about the axis \[rad/s\].
    pub spin_rad_s: f64,
}

/// A plane end section.
#[derive(Debug, Clone)]
pub(super) struct Plate {
    nodes: Vec<usize>,
    masses_kg: Vec<f64>,
    /// Patterns of each node by axis; none where it cannot spread.
    patterns: Option<[Vec<Vector3<f64>>; 2]>,
    /// Inverse of `Σ m p pᵀ` by axis.
    inverse: [Matrix3<f64>; 2],
    /// Where its centre went \[m\], and its rotation about the axis \[rad\].
    moved_m: [f64; 2],
    turned_rad: f64,
}

/// Resultants of what a plate does to the piece.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Resultants {
    /// Forces \[N\].
    pub force_n: [f64; 3],
    /// Torque about the plate's centre \[N m\].
    pub torque_nm: f64,
}

impl Plate {
    /// The plate of these nodes; `spreads`: by smooth patterns, else not at all.
    pub fn of(member: &RcMember, body: &Dynamics, nodes: &[(usize, f64)], spreads: bool) -> Self {
        let nodes: Vec<usize> = nodes.iter().map(|n| n.0).collect();
        let masses_kg: Vec<f64> = nodes.iter().map(|n| body.mass_kg[*n]).collect();
        let at = |n: &usize| member.mesh.nodes[*n];
        let half = [0, 1].map(|i: usize| nodes.iter().map(|n| at(n)[i].abs()).fold(0.0, f64::max));
        let patterns = [0, 1].map(|axis: usize| {
            let of = |n: &usize| {
                let x = at(n);
                let (a, b) = (x[axis] / half[axis], x[1 - axis] / half[1 - axis]);
                Vector3::new(a, a * a, a * b)
            };
            nodes.iter().map(of).collect::<Vec<_>>()
        });
        let inverse = [0, 1].map(|axis: usize| {
            let parts = patterns[axis].iter().zip(&masses_kg);
            let sum: Matrix3<f64> = parts.map(|(p, m)| p * p.transpose() * *m).sum();
            sum.try_inverse().unwrap_or_else(Matrix3::zeros)
        });
        let patterns = spreads.then_some(patterns);
        Self { nodes, masses_kg, patterns, inverse, moved_m: [0.0; 2], turned_rad: 0.0 }
    }

    /// Takes the last step's motion of the section to the nearest one that it can have.
    pub fn hold(&mut self, body: &mut Dynamics, motion: &Motion) {
        let dt = body.taken_s;
        let (sin, cos) = libm::sincos(self.turned_rad);
        let along = motion.along_m_s.unwrap_or_else(|| self.mean_along_m_s(body));
        let rigid = |x: &[f64; 3]| {
            let arm = [x[0] - self.moved_m[0], x[1] - self.moved_m[1]];
            [
                motion.across_m_s[0] - motion.spin_rad_s * arm[1],
                motion.across_m_s[1] + motion.spin_rad_s * arm[0],
            ]
        };
        // what the section spreads by, in axes that turn with it
        let spread = |v: &[f64; 3], r: [f64; 2]| {
            let d = [v[0] - r[0], v[1] - r[1]];
            [cos * d[0] + sin * d[1], cos * d[1] - sin * d[0]]
        };
        let amplitudes = self.patterns.as_ref().map(|patterns| {
            let mut sums = [Vector3::zeros(); 2];
            for (i, n) in self.nodes.iter().enumerate() {
                let d = spread(&body.v[*n], rigid(&body.x[*n]));
                for axis in 0..2 {
                    sums[axis] += patterns[axis][i] * (self.masses_kg[i] * d[axis]);
                }
            }
            [self.inverse[0] * sums[0], self.inverse[1] * sums[1]]
        });
        for (i, n) in self.nodes.iter().enumerate() {
            let mut held = rigid(&body.x[*n]);
            if let (Some(patterns), Some(a)) = (&self.patterns, &amplitudes) {
                let d = [a[0].dot(&patterns[0][i]), a[1].dot(&patterns[1][i])];
                held = [held[0] + cos * d[0] - sin * d[1], held[1] + sin * d[0] + cos * d[1]];
            }
            for (axis, v) in [held[0], held[1], along].into_iter().enumerate() {
                body.x[*n][axis] += dt * (v - body.v[*n][axis]);
                body.v[*n][axis] = v;
            }
        }
        (0..2).for_each(|i| self.moved_m[i] += dt * motion.across_m_s[i]);
        self.turned_rad += dt * motion.spin_rad_s;
    }

    /// Mean velocity along the member \[m/s\].
    fn mean_along_m_s(&self, body: &Dynamics) -> f64 {
        let parts = || self.nodes.iter().zip(&self.masses_kg);
        parts().map(|(n, m)| m * body.v[*n][2]).sum::<f64>() / parts().map(|(_, m)| m).sum::<f64>()
    }

    /// Place along the member \[m\].
    pub fn height_m(&self, body: &Dynamics) -> f64 {
        self.nodes.first().map_or(0.0, |n| body.x[*n][2])
    }

    /// What the plate does to the piece, at rest.
    pub fn resultants(&self, body: &Dynamics) -> Resultants {
        let mut all = Resultants::default();
        for n in &self.nodes {
            let mut force = body.internal_n(*n);
            if let Some(other) = body.other_n.get(*n) {
                (0..3).for_each(|i| force[i] -= other[i]); // elements: what they bear; bars: what they do to the node
            }
            (0..3).for_each(|i| all.force_n[i] += force[i]);
            let arm = [body.x[*n][0] - self.moved_m[0], body.x[*n][1] - self.moved_m[1]];
            all.torque_nm += arm[0] * force[1] - arm[1] * force[0];
        }
        all
    }
}
