//! Pairs of solids, their points, and who has met whom.

use super::{ContactSet, Partner, Surface};
use crate::mbs::math::V3;

/// Most points of a pair.
pub(super) const MOST_POINTS: usize = 8;

/// A point of a pair.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Point {
    /// On either solid, in its frame.
    pub on: [V3; 2],
    /// Its features.
    pub id: u64,
    /// Inverse of the inverse effective masses along and across the normal.
    pub mass: [f64; 2],
    /// Impulses of the last step, over its length \[N\].
    pub normal: f64,
    pub tangent: V3,
}

/// What is asked of every pair in every step, in the order of the pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    /// Paths of both bodies together up to which the pair need not be looked at \[m\]; infinite if it is blocked.
    pub limit: f64,
    /// What its points may close in this step beyond their own approach \[m\]; zero if it was not looked at.
    pub allowed: f64,
    /// Bodies.
    pub bodies: [u32; 2],
    /// Solids, or a solid and a plane.
    pub key: (u32, u32),
    /// The pair.
    pub slot: u32,
}

/// A pair of solids, or a solid and a plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pair {
    pub a: u32,
    pub b: u32,
    pub plane: bool,
    pub blocked: bool,
    /// Able to touch for the first time, or again.
    pub fresh: bool,
    /// Whether it has touched.
    pub seen: bool,
    /// Whether a solid has changed since its points were found.
    pub outdated: bool,
    /// Whether it has more points than count.
    pub is_thinned: bool,
    /// Whether its points bore something in the last step; and the share of its resistance to crushing in this step and in the next one.
    pub bore: bool,
    pub resistance: [f64; 2],
    /// Moment against rolling of the last step \[N m\].
    pub moment: V3,
    /// How deep the solids were in each other when they became able to touch, less what they have parted since \[m\].
    pub offset: f64,
    pub surface: Surface,
    pub normal: [V3; 2],
    /// A plane's normal in the solid's frame when the effective masses were found.
    pub weighed: V3,
    pub count: u8,
    pub points: [Point; MOST_POINTS],
}

impl Pair {
    pub fn new([a, b]: [usize; 2], plane: bool, surface: Surface, fresh: bool) -> Self {
        Self {
            a: a as u32,
            b: b as u32,
            plane,
            blocked: false,
            fresh,
            seen: false,
            outdated: false,
            is_thinned: false,
            bore: false,
            resistance: [1.0; 2],
            moment: [0.0; 3],
            offset: 0.0,
            surface,
            normal: [[0.0; 3]; 2],
            weighed: [0.0; 3],
            count: 0,
            points: [Point::default(); MOST_POINTS],
        }
    }

    /// How many points it has.
    pub fn count(&self) -> usize {
        usize::from(self.count)
    }

    pub fn forget(&mut self) {
        self.count = 0;
        self.bore = false;
        self.moment = [0.0; 3];
        self.offset = 0.0;
    }

    /// Enters a point with the impulse that the one with the same features had; returns its effective masses then, zero if there was none.
    pub fn enter(&mut self, old: &[Point], mut point: Point) -> [f64; 2] {
        let mut mass = [0.0; 2];
        if self.count() < MOST_POINTS {
            if let Some(same) = old.iter().find(|p| p.id == point.id) {
                (point.normal, point.tangent) = (same.normal, same.tangent);
                mass = same.mass;
            }
            self.points[self.count()] = point;
            self.count += 1;
        }
        mass
    }
}

impl ContactSet {
    /// Notes the first contact of a pair.
    #[cold]
    pub(super) fn note(&mut self, slot: usize, after_s: f64) {
        let pair = &mut self.pairs[slot];
        pair.seen = true;
        let pair = &self.pairs[slot];
        let a = self.bodies_of(pair)[0];
        let b: Partner = self.partner_of(pair);
        if self.seen.insert((a, b)) {
            self.touches.push(super::Touch { a, b, after_s });
        }
    }

    /// Whether a contact at a point of a pair is one: what stood on the ground, joined to it, has met it already.
    #[cold]
    pub(super) fn is_news(&self, pair: &Pair, point: u32) -> bool {
        let feet = &self.colliders[pair.a as usize].footing.feet;
        feet.is_empty()
            || self.partner_of(pair) != Partner::Ground
            || !feet.contains(&pair.points[point as usize].id)
    }

    /// Takes back the first contacts of the last step.
    pub(super) fn forget_touches(&mut self) {
        for touch in std::mem::take(&mut self.touches) {
            self.seen.remove(&(touch.a, touch.b));
            for slot in 0..self.pairs.len() {
                let pair = &self.pairs[slot];
                if self.bodies_of(pair)[0] == touch.a && self.partner_of(pair) == touch.b {
                    self.pairs[slot].seen = false;
                }
            }
        }
    }
}
