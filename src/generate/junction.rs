//! Where a beam meets its slab: torsion constants of T and L sections have more than their rectangles.
//!
//! With `D` the diameter of the largest circle inside the junction it is `α D⁴` (Young and Budynas, Roark's Formulas for Stress and Strain, 7th ed. 2002, table 10.1, sections with sharp corners): a slab `b` thick on both sides of a web `d` thick has
//! `α = 0.15 t / t₁` and `D = b + d² / (4 b)`, `t` the smaller and `t₁` the larger one of both; on one side only `α = 0.07 t / t₁` and `D = 2 (b + d - √(2 b d))`. In panels that lost a corner, with slabs as thick as beams are wide, that is a twentieth of all stiffness against twist.

use crate::rc::pushover::torsion_constant;

/// What a junction adds to the torsion constants of a web as deep as its beam and of the slab beside it \[m⁴\].
pub fn torsion_m4([web_m, depth_m]: [f64; 2], slab_m: f64, sides: usize) -> f64 {
    // circles are as large as the slab allows
    let web_m = web_m.min(2.0 * slab_m);
    let ratio = web_m.min(slab_m) / web_m.max(slab_m);
    let below_m = depth_m - slab_m;
    match sides {
        1 => {
            let circle_m = 2.0 * (web_m + slab_m - (2.0 * web_m * slab_m).sqrt());
            0.07 * ratio * circle_m.powi(4)
        }
        2 if below_m > 0.0 => {
            let circle_m = slab_m + web_m * web_m / (4.0 * slab_m);
            // there the slab goes through and the web ends at it
            let ends = 0.105 * (1.0 - (web_m / below_m).powi(4) / 192.0);
            let through = web_m * slab_m.powi(3) / 3.0 + below_m * web_m.powi(3) / 3.0 - ends * web_m.powi(4);
            let more = 0.15 * ratio * circle_m.powi(4) + through - torsion_constant([web_m, depth_m]);
            more.max(0.0)
        }
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Prandtl's membrane over an L or a T by finite differences, with slabs so wide that what is far from the junction is a strip: `J = 4 ∫ φ` with `Δφ = -1`.
    fn membrane_m4([web, depth]: [f64; 2], slab: f64, sides: usize, reach: f64, cell: f64) -> f64 {
        let n = |x: f64| (x / cell).round() as usize;
        let left = if sides == 2 { n(reach) } else { 0 };
        let (columns, rows) = (left + n(web) + n(reach) + 1, n(depth) + 1);
        let inside = |i: usize, j: usize| {
            let in_web = i > left && i < left + n(web) && j > 0 && j < n(depth);
            let in_slab = i > 0 && i < columns - 1 && j > n(depth - slab) && j < n(depth);
            in_web || in_slab
        };
        let mut phi = vec![vec![0.0; rows]; columns];
        for _ in 0..800 {
            for i in 0..columns {
                for j in 0..rows {
                    if inside(i, j) {
                        let around = phi[i - 1][j] + phi[i + 1][j] + phi[i][j - 1] + phi[i][j + 1];
                        let next: f64 = 0.25 * (around + cell * cell);
                        phi[i][j] += 1.9 * (next - phi[i][j]);
                    }
                }
            }
        }
        4.0 * cell * cell * phi.iter().flatten().sum::<f64>()
    }

    #[test]
    fn junctions_are_those_of_a_membrane() {
        let reach = 0.8;
        for (web, depth, slab, sides) in [(0.25, 0.6, 0.25, 1), (0.3, 0.55, 0.15, 2), (0.25, 0.5, 0.175, 1)] {
            let all = membrane_m4([web, depth], slab, sides, reach, 0.0125);
            // each strip loses 0.105 t⁴ at its free end
            let strip = reach * slab.powi(3) / 3.0 - 0.105 * slab.powi(4);
            let apart = torsion_constant([web, depth]) + sides as f64 * strip;
            let found = apart + torsion_m4([web, depth], slab, sides);
            assert!((found / all - 1.0).abs() < 0.05, "{web} {depth} {slab} {sides}: {found} {all}");
        }
    }

    #[test]
    fn a_beam_without_a_slab_beside_it_is_a_rectangle() {
        assert_eq!(torsion_m4([0.3, 0.6], 0.2, 0), 0.0);
        assert!(torsion_m4([0.65, 0.7], 0.24, 2) > 0.0);
    }
}
