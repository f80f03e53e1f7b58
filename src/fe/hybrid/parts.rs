//! Which elements hang together.

use crate::fe::blocks::Blocks;

/// No set.
pub const NONE: u32 = u32::MAX;

/// Elements with the nodes they share.
pub struct Neighbours<'a> {
    blocks: &'a Blocks,
}

impl<'a> Neighbours<'a> {
    /// Those of a mesh.
    pub fn of(blocks: &'a Blocks) -> Self {
        Self { blocks }
    }

    /// The acting elements that share a node with one, some of them twice.
    fn touching(&self, element: usize) -> impl Iterator<Item = usize> + '_ {
        let nodes = self.blocks.nodes_of(element);
        let at = nodes.into_iter().flat_map(|n| self.blocks.elements_at(n));
        at.filter(move |e| *e != element && self.blocks.share(*e) > 0.0)
    }

    /// The elements of `among` that share a face with one.
    fn across(&self, element: usize, among: &[bool]) -> Vec<usize> {
        let mut found: Vec<usize> = self.touching(element).filter(|e| among[*e]).collect();
        found.sort_unstable();
        found.chunk_by(|a, b| a == b).filter(|same| same.len() >= 4).map(|same| same[0]).collect()
    }

    /// The elements and those within so many rings of shared nodes around them, in order.
    pub fn around(&self, seeds: &[usize], rings: usize) -> Vec<usize> {
        let mut reached = vec![false; self.blocks.elements()];
        let mut front = seeds.to_vec();
        front.iter().for_each(|e| reached[*e] = true);
        for _ in 0..rings {
            let mut next = Vec::new();
            for element in front {
                for other in self.touching(element) {
                    if !std::mem::replace(&mut reached[other], true) {
                        next.push(other);
                    }
                }
            }
            front = next;
        }
        (0..reached.len()).filter(|e| reached[*e]).collect()
    }

    /// Elements of `among` all of whose neighbours are in it too.
    pub fn inner(&self, among: &[bool]) -> Vec<bool> {
        let inner = |e: usize| among[e] && self.touching(e).all(|other| among[other]);
        (0..among.len()).map(inner).collect()
    }

    /// Parts of at least `least` elements that hang together by faces, in the order of their first elements. No two share a node: where they would, at an
    /// edge that could turn like a hinge, the elements of the smaller one are left out. `among` is lowered to what is in a part.
    pub fn parts(&self, among: &mut [bool], least: usize) -> Vec<Vec<u32>> {
        loop {
            let (label, mut parts) = self.by_faces(among);
            let mut apart = false;
            for element in (0..among.len()).filter(|e| label[*e] != NONE) {
                let size = |e: usize| (parts[label[e] as usize].len(), NONE - label[e]);
                let foreign = |other: &usize| label[*other] != NONE && label[*other] != label[element];
                if self.touching(element).filter(foreign).any(|other| size(other) > size(element)) {
                    among[element] = false;
                    apart = true;
                }
            }
            for part in parts.iter().filter(|p| p.len() < least) {
                part.iter().for_each(|e| among[*e as usize] = false);
            }
            if !apart {
                parts.retain(|p| p.len() >= least);
                return parts;
            }
        }
    }

    fn by_faces(&self, among: &[bool]) -> (Vec<u32>, Vec<Vec<u32>>) {
        let mut label = vec![NONE; among.len()];
        let mut parts = Vec::new();
        for first in 0..among.len() {
            if !among[first] || label[first] != NONE {
                continue;
            }
            let mut part = vec![first as u32];
            label[first] = parts.len() as u32;
            let mut at = 0;
            while at < part.len() {
                for other in self.across(part[at] as usize, among) {
                    if label[other] == NONE {
                        label[other] = parts.len() as u32;
                        part.push(other as u32);
                    }
                }
                at += 1;
            }
            part.sort_unstable();
            parts.push(part);
        }
        (label, parts)
    }
}
