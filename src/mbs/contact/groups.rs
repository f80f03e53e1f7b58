//! Bodies that contacts and ideal joints connect in a step: what impulses do to one group is none of another's.

use super::ContactSet;
use super::rows::Block;
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
