//! Hinge laws as one curve of moment over rotation, for programs whose springs remember nothing.

use crate::curve::ResistanceCurve;

/// Moment over growing rotation from zero \[rad, N m\], of a hinge whose capacity depends on the largest rotation.
pub fn of_hinge(stiffness_nm_rad: f64, capacity: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let at = |rotation: f64| crate::base::piecewise::interpolate(capacity, rotation);
    let yields = first_crossing(stiffness_nm_rad, capacity, &at);
    let mut line = vec![[0.0, 0.0], [yields, at(yields)]];
    line.extend(capacity.iter().copied().filter(|p| p[0] > yields * (1.0 + 1e-9)));
    line
}

/// Rotation at which the elastic moment meets the capacity \[rad\].
fn first_crossing(stiffness: f64, capacity: &[[f64; 2]], at: &dyn Fn(f64) -> f64) -> f64 {
    for pair in capacity.windows(2) {
        let ([x0, c0], [x1, c1]) = (pair[0], pair[1]);
        if stiffness * x1 >= c1 {
            // k x = c0 + s (x - x0)
            let slope = (c1 - c0) / (x1 - x0);
            return (c0 - slope * x0) / (stiffness - slope);
        }
    }
    at(f64::MAX) / stiffness
}

/// Moment over growing rotation of a resistance curve at no axial force.
pub fn of_curve(curve: &ResistanceCurve, factor: f64) -> Vec<[f64; 2]> {
    let k = curve.stiffness_nm_rad;
    let mut plastic: Vec<f64> = curve.levels.iter().flat_map(|l| l.capacity.iter().map(|p| p[0])).collect();
    let fracture = curve.fracture_rotation_rad(0.0);
    plastic.push(fracture);
    plastic.retain(|a| *a <= fracture);
    plastic.sort_by(f64::total_cmp);
    plastic.dedup();
    let mut line = vec![[0.0, 0.0]];
    for alpha in plastic {
        let moment = factor * if alpha < fracture { curve.capacity_nm(alpha, 0.0) } else { 0.0 };
        let rotation = alpha + moment / k;
        // a capacity that falls faster than the spring unloads is a drop
        let rotation = rotation.max(line.last().map_or(0.0, |p| p[0]) + 1e-6);
        line.push([rotation, moment]);
    }
    line
}

/// The largest moment \[N m\].
pub fn peak_nm(line: &[[f64; 2]]) -> f64 {
    line.iter().map(|p| p[1]).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_softening_hinge_becomes_a_line_with_its_yield_point() {
        let line = of_hinge(2e7, &[[0.0, 120e3], [0.03, 120e3], [0.15, 0.0]]);
        assert_eq!(line, [[0.0, 0.0], [0.006, 120e3], [0.03, 120e3], [0.15, 0.0]]);
        assert_eq!(of_hinge(1e3, &[[0.0, 10.0]]), [[0.0, 0.0], [0.01, 10.0]]);
        // the elastic line meets a hardening capacity
        let hard = of_hinge(1000.0, &[[0.0, 10.0], [0.1, 60.0]]);
        assert!((hard[1][0] - 0.02).abs() < 1e-15 && (hard[1][1] - 20.0).abs() < 1e-12);
    }
}
