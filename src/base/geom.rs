//! Axis-aligned boxes: the solids of the members and of the obstacles.

use serde::{Deserialize, Serialize};

/// An axis-aligned box, `min[i] <= max[i]`, in m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Aabb {
    /// Lower corner \[m\].
    pub min: [f64; 3],
    /// Upper corner \[m\].
    pub max: [f64; 3],
}

impl Aabb {
    /// The box between two corners given in any order.
    pub fn from_corners(a: [f64; 3], b: [f64; 3]) -> Self {
        Self { min: std::array::from_fn(|i| a[i].min(b[i])), max: std::array::from_fn(|i| a[i].max(b[i])) }
    }

    /// Edge lengths \[m\].
    pub fn size(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.max[i] - self.min[i])
    }

    /// Centre \[m\].
    pub fn center(&self) -> [f64; 3] {
        std::array::from_fn(|i| 0.5 * (self.min[i] + self.max[i]))
    }

    /// Volume \[m³\], zero for a box that is flat in some direction.
    pub fn volume(&self) -> f64 {
        self.size().iter().product()
    }

    /// The common part of two boxes if it has a volume above `tolerance` in each direction \[m\].
    pub fn intersection(&self, other: &Self, tolerance: f64) -> Option<Self> {
        let cut = Self {
            min: std::array::from_fn(|i| self.min[i].max(other.min[i])),
            max: std::array::from_fn(|i| self.max[i].min(other.max[i])),
        };
        (0..3).all(|i| cut.max[i] - cut.min[i] > tolerance).then_some(cut)
    }

    /// The box around it and another.
    #[must_use]
    pub fn around(self, other: Self) -> Self {
        Self {
            min: std::array::from_fn(|i| self.min[i].min(other.min[i])),
            max: std::array::from_fn(|i| self.max[i].max(other.max[i])),
        }
    }

    /// Whether another box is nearer than a distance along all axes \[m\].
    pub fn is_nearer(&self, other: &Self, distance_m: f64) -> bool {
        (0..3).all(|i| (self.min[i] - other.max[i]).max(other.min[i] - self.max[i]) < distance_m)
    }

    /// Whether a point lies inside or within `tolerance` of the box \[m\].
    pub fn contains(&self, point: [f64; 3], tolerance: f64) -> bool {
        (0..3).all(|i| point[i] >= self.min[i] - tolerance && point[i] <= self.max[i] + tolerance)
    }
}
