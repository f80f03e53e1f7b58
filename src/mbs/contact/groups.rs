//! Bodies that contacts and ideal joints connect in a step: what impulses do to one group is none of another's.

use super::ContactSet;
use super::rows::{Block, Motion, Rows};
use crate::mbs::math;
use petgraph::unionfind::UnionFind;

/// Of each body the one that stands for its group; the ground is in none.
#[derive(Debug, Clone)]
pub(super) struct Groups {
    label: Vec<u32>,
    ground: usize,
}

impl Groups {
    /// Number of labels.
    pub fn count(&self) -> usize {
        self.label.len()
    }

    /// The group of a body.
    pub fn of(&self, body: usize) -> usize {
        self.label[body] as usize
    }

    /// The group of a block.
    pub fn of_block(&self, block: &Block) -> usize {
        let [a, b] = block.bodies.map(|i| i as usize);
        self.of(if a == self.ground { b } else { a })
    }
}

impl ContactSet {
    /// The groups of the points of this step.
    pub(super) fn groups(&self) -> Groups {
        let ground = self.ground;
        let mut union = UnionFind::<u32>::new(ground + 1);
        for block in &self.rows.blocks {
            let [a, b] = block.bodies;
            if a as usize != ground && b as usize != ground {
                union.union(a, b);
            }
        }
        for [a, b] in &self.rows.links.joined {
            union.union(*a, *b);
        }
        Groups { label: union.into_labeling(), ground }
    }
}

impl Rows {
    /// Scales the impulses of the groups in which they make energy, and the changes by them of the velocities before. A share `s` of those of a group makes `w[0] s + w[1] s²/2`, with the works `w` \[J\] given
    /// for each: it is taken to `of_least` times that which makes least, one for the least and two for none.
    pub(super) fn scale_down(
        &mut self,
        groups: &Groups,
        works: &[[f64; 2]],
        of_least: f64,
        before: impl Fn(usize) -> Motion,
    ) {
        let share = |[linear, square]: &[f64; 2]| {
            let makes = linear + 0.5 * square > 0.0;
            makes.then(|| if *square > 0.0 { (-of_least * linear / square).clamp(0.0, 1.0) } else { 0.0 })
        };
        let shares: Vec<Option<f64>> = works.iter().map(share).collect();
        if shares.iter().all(Option::is_none) {
            return;
        }
        let Self { blocks, rows, rolls, motion, acting, .. } = self;
        for (k, block) in blocks.iter().enumerate() {
            let Some(share) = shares[groups.of_block(block)] else { continue };
            for row in &mut rows[block.range()] {
                (row.normal, row.tangent) = (share * row.normal, math::scale(share, row.tangent));
            }
            if let Some(roll) = rolls.get_mut(k) {
                roll.moment = math::scale(share, roll.moment);
            }
        }
        for i in acting.iter().map(|i| *i as usize) {
            let Some(share) = shares[groups.of(i)] else { continue };
            let (now, first) = (&mut motion[i], before(i));
            let [v, w] = [math::sub(now.v, first.v), math::sub(now.w, first.w)];
            *now = Motion { v: math::axpy(first.v, share, v), w: math::axpy(first.w, share, w) };
        }
    }
}
