//! Which of many boxes are near one: a balanced tree of bounds, `n log n` to build and `log n` to ask, and as much again as is found.

use super::geom::Aabb;

/// Most boxes of a leaf.
const LEAF: usize = 8;

/// Boxes that can be asked for by their place.
#[derive(Debug, Clone, Default)]
pub struct Boxes {
    /// Boxes with their numbers, so that each half of a range is a subtree.
    list: Vec<(Aabb, usize)>,
    /// Bounds of the subtrees in the order in which they are split, each with the number of the first that is not part of it.
    bounds: Vec<(Aabb, usize)>,
}

impl Boxes {
    /// Of some boxes, numbered in their order.
    pub fn of(boxes: impl Iterator<Item = Aabb>) -> Self {
        Self::numbered(boxes.enumerate())
    }

    /// Of some boxes with numbers of their own.
    pub fn numbered(boxes: impl Iterator<Item = (usize, Aabb)>) -> Self {
        let mut this =
            Self { list: boxes.map(|(number, solid)| (solid, number)).collect(), bounds: Vec::new() };
        let all = 0..this.list.len();
        this.split(all);
        this
    }

    fn split(&mut self, range: std::ops::Range<usize>) {
        let own = &mut self.list[range.clone()];
        let Some(bounds) = own.iter().map(|(solid, _)| *solid).reduce(Aabb::around) else { return };
        let here = self.bounds.len();
        self.bounds.push((bounds, here + 1));
        if own.len() <= LEAF {
            return;
        }
        let size = bounds.size();
        let axis = (0..3).max_by(|a, b| size[*a].total_cmp(&size[*b])).unwrap_or(0);
        let middle = own.len() / 2;
        own.select_nth_unstable_by(middle, |a, b| {
            a.0.center()[axis].total_cmp(&b.0.center()[axis]).then(a.1.cmp(&b.1))
        });
        self.split(range.start..range.start + middle);
        self.split(range.start + middle..range.end);
        self.bounds[here].1 = self.bounds.len();
    }

    /// Numbers of the boxes that are nearer to a box than a distance along all axes, ascending \[m\].
    pub fn near(&self, solid: &Aabb, distance_m: f64) -> Vec<usize> {
        let mut found = Vec::new();
        self.search(0..self.list.len(), &mut 0, solid, distance_m, &mut found);
        found.sort_unstable();
        found
    }

    fn search(
        &self,
        range: std::ops::Range<usize>,
        node: &mut usize,
        solid: &Aabb,
        distance_m: f64,
        found: &mut Vec<usize>,
    ) {
        if range.is_empty() {
            return;
        }
        let near = |own: &Aabb| own.is_nearer(solid, distance_m);
        let (count, (bounds, after)) = (range.len(), &self.bounds[*node]);
        if !near(bounds) {
            *node = *after;
            return;
        }
        *node += 1;
        if count <= LEAF {
            found.extend(self.list[range].iter().filter(|(own, _)| near(own)).map(|(_, number)| *number));
            return;
        }
        let middle = range.start + count / 2;
        self.search(range.start..middle, node, solid, distance_m, found);
        self.search(middle..range.end, node, solid, distance_m, found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;

    #[test]
    fn the_tree_finds_what_a_walk_through_all_boxes_finds() {
        let mut random = Random::of(7);
        let mut next = || random.below(4096) as f64 / 100.0;
        let mut boxes = Vec::new();
        for i in 0..500 {
            let min = [next(), next(), next()];
            let long = if i % 50 == 0 { 20.0 } else { 1.0 };
            boxes.push(Aabb { min, max: [min[0] + long, min[1] + 1.0, min[2] + 0.5 * long] });
        }
        let tree = Boxes::of(boxes.iter().copied());
        for solid in &boxes {
            let near =
                |b: &Aabb| (0..3).all(|i| (b.min[i] - solid.max[i]).max(solid.min[i] - b.max[i]) < 0.7);
            let all: Vec<usize> = (0..boxes.len()).filter(|i| near(&boxes[*i])).collect();
            assert_eq!(tree.near(solid, 0.7), all);
        }
        assert!(Boxes::default().near(&boxes[0], 1.0).is_empty());
    }
}
