//! Conjugate directions over the sweeps, for impulses on which these alone settle slowly: a heavy body on a light one, an impact that goes through many bodies.
//!
//! A sweep forwards and one backwards move the impulses `x` by `d`; with `β = |d|² / |d_last|²` (Fletcher and Reeves) the next point is `x + d + β p` and the next direction `p = d + β p`; a `β` above
//! one starts anew (Silcowitz, Niebe, Erleben, A nonsmooth nonlinear conjugate gradient method for interactive contact force problems, The Visual Computer 26 (2010) 893). Sweeps afterwards bring the impulses
//! back to where Coulomb's law allows them. Velocities follow linearly.

use super::links::ALONE;
use super::rows::{Block, Motion, Rows};
use crate::mbs::math::{self, V3};

/// Ratio of the masses of two bodies that press on each other from which sweeps settle too slowly: by about its inverse each. At 30 halves of columns under floors are searched for in every step, which doubles the run time of s2-026 and changes no error against FE;
/// at 60 one of 110 random buildings has a half of a column 1.3 mm in the ground for an instant.
const UNEVEN: f64 = 60.0;

/// What is kept between the moves.
#[derive(Debug, Clone, Default)]
pub(super) struct Search {
    /// Impulses and velocities before a move.
    before: Vec<(f64, V3)>,
    before_motion: Vec<Motion>,
    /// The direction.
    impulses: Vec<(f64, V3)>,
    motion: Vec<Motion>,
    /// Square of the last move; zero: none.
    square: f64,
}

impl Rows {
    /// Whether ideal joints link points: what counts there are masses that sweeps do not know.
    pub fn are_linked(&self) -> bool {
        self.blocks.iter().any(|block| block.linked != ALONE)
    }

    /// Whether bodies of very different masses press on each other.
    pub fn are_uneven(&self) -> bool {
        let uneven = |block: &Block| {
            let [a, b] = block.bodies.map(|i| self.inverse[i as usize].mass);
            !block.idle && a.min(b) > 0.0 && a.max(b) > UNEVEN * a.min(b)
        };
        self.blocks.iter().any(uneven)
    }

    /// Forgets the direction.
    pub fn search_anew(&mut self) {
        self.search.square = 0.0;
    }

    /// Two sweeps and a step along the direction; the largest change of a velocity in the second of them \[m/s\].
    pub fn search(&mut self) -> f64 {
        let search = &mut self.search;
        search.before.clear();
        search.before.extend(self.rows.iter().map(|row| (row.normal, row.tangent)));
        search.before_motion.clone_from(&self.motion);
        self.sweep(false, true);
        let change = self.sweep(true, true);
        let search = &mut self.search;
        let mut square = 0.0;
        // the move takes the place of where it began
        for (row, (normal, tangent)) in self.rows.iter().zip(&mut search.before) {
            *normal = row.normal - *normal;
            *tangent = math::sub(row.tangent, *tangent);
            square += *normal * *normal / row.mass[0] + math::dot(*tangent, *tangent) / row.mass[1];
        }
        for i in self.acting.iter().map(|i| *i as usize) {
            let (now, before) = (&self.motion[i], &mut search.before_motion[i]);
            *before = Motion { v: math::sub(now.v, before.v), w: math::sub(now.w, before.w) };
        }
        let share = square / search.square;
        search.square = square;
        if share.is_nan() || share > 1.0 {
            std::mem::swap(&mut search.impulses, &mut search.before);
            std::mem::swap(&mut search.motion, &mut search.before_motion);
            return change;
        }
        for ((row, along), moved) in self.rows.iter_mut().zip(&mut search.impulses).zip(&search.before) {
            row.normal += share * along.0;
            row.tangent = math::axpy(row.tangent, share, along.1);
            *along = (share * along.0 + moved.0, math::axpy(moved.1, share, along.1));
        }
        for i in self.acting.iter().map(|i| *i as usize) {
            let (now, along) = (&mut self.motion[i], &mut search.motion[i]);
            let moved = &search.before_motion[i];
            now.v = math::axpy(now.v, share, along.v);
            now.w = math::axpy(now.w, share, along.w);
            *along =
                Motion { v: math::axpy(moved.v, share, along.v), w: math::axpy(moved.w, share, along.w) };
        }
        change
    }
}
