//! Conjugate directions over the sweeps, for impulses on which these alone settle slowly: a heavy body on a light one, an impact that goes through many bodies.
//!
//! A sweep forwards and one backwards move the impulses `x` by `d`; with `β = |d|² / |d_last|²` of the group of bodies that contacts connect (Fletcher and Reeves) the next point is `x + d + β p` and the next direction `p = d + β p`; a `β` above
//! one starts anew (Silcowitz, Niebe, Erleben, A nonsmooth nonlinear conjugate gradient method for interactive contact force problems, The Visual Computer 26 (2010) 893). Sweeps afterwards bring the impulses
//! back to where Coulomb's law allows them. Velocities follow linearly.

use super::groups::Groups;
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
    /// Squares of the last move and of the one before, by group; zero: none.
    squares: Vec<f64>,
    last: Vec<f64>,
    /// Its share of the direction that is gone, by group; none: the direction starts anew.
    shares: Vec<Option<f64>>,
}

/// Whether velocities are those of its points' impulses on free bodies: where ideal joints link them to others, what counts are masses that sweeps do not know, and there are moments where they resist rolling.
fn is_plain(block: &Block) -> bool {
    block.linked == ALONE && block.rolling == 0.0
}

impl Rows {
    /// Whether there are points that may be searched for.
    pub fn may_search(&self) -> bool {
        self.blocks.iter().any(is_plain)
    }

    /// Whether bodies of very different masses press on each other.
    pub fn are_uneven(&self) -> bool {
        let uneven = |block: &Block| {
            let [a, b] = block.bodies.map(|i| self.inverse[i as usize].mass);
            !block.idle && is_plain(block) && a.min(b) > 0.0 && a.max(b) > UNEVEN * a.min(b)
        };
        self.blocks.iter().any(uneven)
    }

    /// Forgets the directions of so many groups.
    pub fn search_anew(&mut self, groups: usize) {
        self.search.squares.clear();
        self.search.squares.resize(groups, 0.0);
    }

    /// Two sweeps, and in each group that may be searched a step along its direction; the largest change of a velocity in the second of them \[m/s\].
    pub fn search(&mut self, groups: &Groups) -> f64 {
        let search = &mut self.search;
        search.before.clear();
        search.before.extend(self.rows.iter().map(|row| (row.normal, row.tangent)));
        search.before_motion.clone_from(&self.motion);
        self.sweep(false, true);
        let change = self.sweep(true, true);
        self.take_moves();
        self.share(groups);
        self.go_on(groups);
        change
    }

    /// The moves take the place of where they began.
    fn take_moves(&mut self) {
        let search = &mut self.search;
        for (row, (normal, tangent)) in self.rows.iter().zip(&mut search.before) {
            *normal = row.normal - *normal;
            *tangent = math::sub(row.tangent, *tangent);
        }
        for i in self.acting.iter().map(|i| *i as usize) {
            let (now, before) = (&self.motion[i], &mut search.before_motion[i]);
            *before = Motion { v: math::sub(now.v, before.v), w: math::sub(now.w, before.w) };
        }
    }

    /// Finds what share of its direction each group goes on with.
    fn share(&mut self, groups: &Groups) {
        let Search { before, squares, last, shares, .. } = &mut self.search;
        std::mem::swap(squares, last);
        squares.clear();
        squares.resize(last.len(), 0.0);
        for block in &self.blocks {
            let square = &mut squares[groups.of_block(block)];
            for i in block.range() {
                let ([along, across], (normal, tangent)) = (self.rows[i].mass, before[i]);
                *square += normal * normal / along + math::dot(tangent, tangent) / across;
            }
        }
        for block in self.blocks.iter().filter(|block| !is_plain(block)) {
            squares[groups.of_block(block)] = f64::NAN;
        }
        shares.clear();
        shares.extend(squares.iter().zip(&*last).map(|(square, last)| {
            let share = square / last;
            (share <= 1.0).then_some(share)
        }));
    }

    /// Goes on along the directions, and turns them.
    fn go_on(&mut self, groups: &Groups) {
        let Search { before, before_motion, impulses, motion, shares, .. } = &mut self.search;
        impulses.resize(before.len(), (0.0, [0.0; 3]));
        motion.resize(before_motion.len(), Motion::default());
        for block in &self.blocks {
            let share = shares[groups.of_block(block)];
            for i in block.range() {
                let (moved, along) = (before[i], &mut impulses[i]);
                let Some(share) = share else {
                    *along = moved;
                    continue;
                };
                let row = &mut self.rows[i];
                row.normal += share * along.0;
                row.tangent = math::axpy(row.tangent, share, along.1);
                *along = (share * along.0 + moved.0, math::axpy(moved.1, share, along.1));
            }
        }
        for i in self.acting.iter().map(|i| *i as usize) {
            let (moved, along) = (before_motion[i], &mut motion[i]);
            let Some(share) = shares[groups.of(i)] else {
                *along = moved;
                continue;
            };
            let now = &mut self.motion[i];
            now.v = math::axpy(now.v, share, along.v);
            now.w = math::axpy(now.w, share, along.w);
            *along =
                Motion { v: math::axpy(moved.v, share, along.v), w: math::axpy(moved.w, share, along.w) };
        }
    }
}
