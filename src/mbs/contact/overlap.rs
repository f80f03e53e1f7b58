//! Which solids are inside others at the start: contacts keep such an overlap, which a user may not have meant.

use super::collide::{self, Finder, Found, Placed, Solid};
use super::collider::Collider;
use super::gaps;
use super::pair::Pair;
use super::{ContactSet, Partner};
use crate::mbs::math::{self, Q, V3};
use std::collections::BTreeMap;

/// A body that is inside another one, or inside something that does not move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// The body.
    pub a: usize,
    /// What it is in.
    pub b: Partner,
    /// How far \[m\].
    pub depth_m: f64,
    /// The same as a share of the thickness of the thinner one.
    pub share: f64,
}

/// A solid in space, and its bounds.
struct Standing<'a> {
    index: usize,
    collider: &'a Collider,
    at: Placed,
    bounds: [V3; 2],
}

impl<'a> Standing<'a> {
    fn of(index: usize, collider: &'a Collider, poses: &[(V3, Q)]) -> Self {
        let body = poses.get(collider.body).map(|(x, q)| Placed { x: *x, q: *q, r: math::qmat(*q) });
        let at = collider.placed(body);
        Self { index, collider, at, bounds: collider.solid.bounds(&at) }
    }

    fn solid(&self) -> (&Solid, &Placed) {
        (&self.collider.solid, &self.at)
    }
}

impl ContactSet {
    /// Bodies in each other by more than a share of the thinner solid, of those that can touch by what [`Self::connect`] was told last; of each two the deepest pair of solids, the deepest by this share first. All bodies are there, in these positions \[m\] and orientations.
    pub fn overlaps(&self, share: f64, poses: &[(V3, Q)]) -> Vec<Overlap> {
        let mut all: Vec<Standing<'_>> =
            self.colliders.iter().enumerate().map(|(i, c)| Standing::of(i, c, poses)).collect();
        let mut deepest: BTreeMap<(usize, Partner), Overlap> = BTreeMap::new();
        let mut enter = |found: Overlap| {
            let known = deepest.entry((found.a, found.b)).or_insert(found);
            if found.share > known.share {
                *known = found;
            }
        };
        for solid in all.iter().filter(|s| s.collider.body != self.ground) {
            (0..self.planes.len()).filter_map(|b| self.in_plane(solid, b, share)).for_each(&mut enter);
        }
        // those whose bounds along x have not ended yet, of all that begin before
        all.sort_by(|a, b| a.bounds[0][0].total_cmp(&b.bounds[0][0]).then(a.index.cmp(&b.index)));
        let mut open: Vec<&Standing<'_>> = Vec::new();
        let mut work = (Finder::default(), Vec::new());
        for solid in &all {
            open.retain(|other| other.bounds[1][0] >= solid.bounds[0][0]);
            for other in &open {
                let [a, b] = if other.index < solid.index { [*other, solid] } else { [solid, *other] };
                self.in_solid([a, b], share, &mut work).into_iter().for_each(&mut enter);
            }
            open.push(solid);
        }
        let mut list: Vec<Overlap> = deepest.into_values().collect();
        list.sort_by(|a, b| b.share.total_cmp(&a.share));
        list
    }

    fn in_plane(&self, solid: &Standing<'_>, plane: usize, share: f64) -> Option<Overlap> {
        let Standing { index, collider, at, .. } = solid;
        let of = &self.planes[plane];
        let down = math::scale(-1.0, of.normal);
        let depth_m = of.level + collider.solid.reach(at, down) - math::dot(at.x, of.normal);
        let depth = (depth_m, collider.thickness);
        self.overlap([*index, plane], true, (collider.body, of.partner), depth, share)
    }

    fn in_solid(
        &self,
        [a, b]: [&Standing<'_>; 2],
        share: f64,
        (finder, found): &mut (Finder, Vec<Found>),
    ) -> Option<Overlap> {
        let (one, other) = (a.collider, b.collider);
        let apart = || gaps::separation(a.solid(), b.solid());
        if one.body == other.body || !collide::overlap(&a.bounds, &b.bounds) || apart() >= 0.0 {
            return None;
        }
        let depth_m = match (&one.solid, &other.solid) {
            (Solid::Box(_), Solid::Box(_)) => -apart().max(gaps::edge_separation(a.solid(), b.solid())),
            _ => {
                finder.find(a.solid(), b.solid(), 0.0, found)?;
                found.iter().map(|point| -point.gap).fold(0.0, f64::max)
            }
        };
        let depth = (depth_m, one.thickness.min(other.thickness));
        self.overlap([a.index, b.index], false, (one.body, other.partner), depth, share)
    }

    /// An overlap, if it is deep for solids of this half thickness \[m\] and the two can touch.
    fn overlap(
        &self,
        places: [usize; 2],
        is_plane: bool,
        (a, b): (usize, Partner),
        (depth_m, half_m): (f64, f64),
        least: f64,
    ) -> Option<Overlap> {
        let share = depth_m / (2.0 * half_m);
        if share <= least {
            return None;
        }
        let surface = self.surfaces.between(a, b)?;
        let is_blocked = self.is_blocked(&Pair::new(places, is_plane, surface, true), |_| true);
        (!is_blocked).then_some(Overlap { a, b, depth_m, share })
    }
}
