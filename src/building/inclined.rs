//! Members along any axis: two points and the roll of the section.

use crate::base::vector::{cross, norm, scale};
use serde::{Deserialize, Serialize};

/// An axis whose horizontal part is smaller than this share of its length is vertical.
const VERTICAL: f64 = 1e-9;

/// Axis and section of a member in any direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Inclined {
    /// First end of the axis \[m\].
    pub from_m: [f64; 3],
    /// Second end \[m\].
    pub to_m: [f64; 3],
    /// Angle by which the section is rolled about the axis, anticlockwise for who looks from the second end to the first \[deg\].
    pub roll_deg: f64,
    /// Side of the section that is horizontal without roll; along x for a vertical axis \[m\].
    pub width_m: f64,
    /// The other side \[m\].
    pub depth_m: f64,
}

impl Inclined {
    /// Distance of the two points \[m\].
    pub fn length_m(&self) -> f64 {
        norm(self.vector())
    }

    /// How far beyond its ends the member may be cut off or prolonged where it meets its neighbours: the larger side of the section \[m\].
    /// An end that meets a face under 27 degrees reaches as far over the width of the section.
    pub fn slack_m(&self) -> f64 {
        self.width_m.max(self.depth_m)
    }

    /// Unit vectors along the axis, the width and the depth, right-handed.
    pub fn axes(&self) -> [[f64; 3]; 3] {
        let along = scale(1.0 / self.length_m(), self.vector());
        let level = [-along[1], along[0], 0.0];
        let wide = if norm(level) < VERTICAL { [1.0, 0.0, 0.0] } else { scale(1.0 / norm(level), level) };
        let deep = cross(along, wide);
        let [cosine, sine] = cosine_and_sine(self.roll_deg);
        let mixed = |a: f64, b: f64| std::array::from_fn(|i| a * wide[i] + b * deep[i]);
        [along, mixed(cosine, sine), mixed(-sine, cosine)]
    }

    fn vector(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.to_m[i] - self.from_m[i])
    }
}

/// Exact at multiples of 90 degrees.
pub(super) fn cosine_and_sine(degrees: f64) -> [f64; 2] {
    let whole = degrees.rem_euclid(360.0);
    for (angle, turn) in [(0.0, [1.0, 0.0]), (90.0, [0.0, 1.0]), (180.0, [-1.0, 0.0]), (270.0, [0.0, -1.0])] {
        if whole == angle {
            return turn;
        }
    }
    let (sine, cosine) = libm::sincos(degrees.to_radians());
    [cosine, sine]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::vector::dot;

    fn brace(to_m: [f64; 3], roll_deg: f64) -> Inclined {
        Inclined { from_m: [0.0; 3], to_m, roll_deg, width_m: 0.3, depth_m: 0.4 }
    }

    #[test]
    fn the_width_is_horizontal_without_roll() {
        let [along, wide, deep] = brace([3.0, 0.0, 4.0], 0.0).axes();
        assert!((along[0] - 0.6).abs() < 1e-15 && (along[2] - 0.8).abs() < 1e-15);
        assert_eq!(wide, [0.0, 1.0, 0.0]);
        assert!((deep[0] + 0.8).abs() < 1e-15 && (deep[2] - 0.6).abs() < 1e-15);
        let upright = brace([0.0, 0.0, 2.0], 0.0).axes();
        assert_eq!(upright, [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn the_roll_turns_the_section() {
        for (to, roll) in [([3.0, 1.0, 4.0], 30.0), ([0.0, 0.0, -2.0], 200.0), ([-1.0, 2.0, 0.0], -75.0)] {
            let ([a, b, c], [_, plain, _]) = (brace(to, roll).axes(), brace(to, 0.0).axes());
            assert!((dot(b, plain) - roll.to_radians().cos()).abs() < 1e-14);
            assert!((dot(cross(plain, b), a) - roll.to_radians().sin()).abs() < 1e-14);
            assert!((dot(cross(a, b), c) - 1.0).abs() < 1e-14);
        }
    }
}
