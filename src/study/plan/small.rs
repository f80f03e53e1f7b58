//! Small buildings with random removals, weakening and obstacles, for runs that ask whether a solver holds whatever happens.
//!
//! Unlike the scenes of a plan these do not cover ranges evenly and need not be sensible demolitions: any columns go at any time.

use super::design::Sizes;
use super::{Beams, Blast, Block, HEIGHT_M, Obstacle, Scene, axes, milli};
use crate::base::random::Random;

/// Edges of bays, and their module \[m\].
const SPAN_M: [f64; 3] = [3.0, 6.5, 0.5];
/// Sides of columns \[m\], the first in buildings of one storey, the second in others: the shipped library has curves of columns of 250 to 450 mm, on floors of such of 400 mm only.
const COLUMN_M: [f64; 2] = [0.25, 0.3];
/// Their largest side \[m\].
const MOST_COLUMN_M: f64 = 0.45;
/// Strengths of weakened columns over the full one.
const WEAKENED: [f64; 2] = [0.6, 0.95];
/// Last ignition \[s\].
const LAST_S: f64 = 1.2;
/// Sides and heights of obstacles \[m\].
const BLOCK_M: [f64; 2] = [0.4, 2.0];
/// Distance of obstacles from columns, walls and slabs \[m\].
const CLEAR_M: f64 = 0.3;
/// How far from the building obstacles may lie \[m\].
const FAR_M: f64 = 4.0;

impl Scene {
    /// The small building with a number, from 1, of a seed.
    pub fn small(seed: u32, number: u32) -> Self {
        let mut random = Random::of(u64::from(seed) << 32 | u64::from(number));
        loop {
            let scene = Self::frame(seed, number, &mut random);
            let least_m = COLUMN_M[usize::from(scene.heights_m.len() > 1)];
            if (least_m..=MOST_COLUMN_M).contains(&scene.sizes.column_m) {
                return scene.with_happenings(&mut random);
            }
        }
    }

    /// Frame and sizes.
    fn frame(seed: u32, number: u32, r: &mut Random) -> Self {
        let pick = |r: &mut Random, shares: &[f64]| {
            let at = r.share();
            let mut sum = 0.0;
            shares
                .iter()
                .position(|s| {
                    sum += s;
                    at < sum
                })
                .unwrap_or(shares.len() - 1)
        };
        let bays = [0, 1].map(|_| 1 + pick(r, &[0.5, 0.35, 0.15]));
        let storeys = 1 + pick(r, &[0.25, 0.35, 0.25, 0.15]);
        let steps = ((SPAN_M[1] - SPAN_M[0]) / SPAN_M[2]).round() as usize + 1;
        let spans = [0, 1].map(|_| SPAN_M[0] + SPAN_M[2] * r.below(steps) as f64);
        let uneven = r.is(0.3);
        let axes_m = [0, 1].map(|d| axes(bays[d], spans[d], uneven));
        let height_m = milli(HEIGHT_M[0] + HEIGHT_M[2] * r.below(13) as f64);
        let mut heights_m = vec![height_m; storeys];
        if r.is(1.0 / 3.0) {
            heights_m[0] = milli(height_m + 0.1 * r.below(10) as f64);
        }
        let beams = [Beams::All, Beams::Perimeter, Beams::None][pick(r, &[0.4, 0.35, 0.25])];
        let (ratio, bars) = (r.between(0.12, 0.3), [0.010, 0.016, 0.024][r.below(3)]);
        let sizes = Sizes::of(&axes_m, storeys, beams, ratio, bars);
        Self {
            seed,
            number,
            small: true,
            axes_m,
            heights_m,
            beams,
            sizes,
            fall: [(0, true), (0, false), (1, true), (1, false)][r.below(4)],
            blasts: Vec::new(),
            weakened: None,
            obstacle: None,
            blocks: Vec::new(),
            has_wall: r.is(0.2),
            has_opening: r.is(0.25),
            without: Vec::new(),
        }
    }

    /// With what is taken away, weakened and in the way.
    fn with_happenings(mut self, r: &mut Random) -> Self {
        self.weakened = r.is(0.3).then(|| milli(r.between(WEAKENED[0], WEAKENED[1])));
        self.obstacle = r.is(0.3).then(|| Obstacle {
            distance_m: milli(r.between(0.5, FAR_M)),
            height_m: milli(r.between(0.5, 3.0)),
        });
        let count = if r.is(0.5) { 1 + r.below(3) } else { 0 };
        self.blocks = (0..count).map(|_| self.block(r)).collect();
        self.blasts = self.removals(r);
        self
    }

    /// Any columns of some storeys, at least one: all at once, one row after the other, or each at a time of its own.
    fn removals(&self, r: &mut Random) -> Vec<Blast> {
        let count = self.heights_m.len();
        let mut storeys = match r.below(4) {
            0 | 1 => vec![1],
            2 => vec![1 + r.below(count)],
            _ => vec![1, 1 + r.below(count)],
        };
        storeys.dedup();
        let columns = || {
            let places = |x: usize| (0..self.axes_m[1].len()).map(move |y| [x, y]);
            (0..self.axes_m[0].len()).flat_map(places)
        };
        let all: Vec<(usize, [usize; 2])> =
            storeys.iter().flat_map(|s| columns().map(|axes| (*s, axes))).collect();
        let (share, mode, delay_s) = (r.between(0.1, 0.9), r.below(3), r.between(0.05, 0.4));
        let rows = self.rows();
        let time_s = |r: &mut Random, axes: [usize; 2]| {
            let row = rows.iter().position(|p| *p == axes[self.fall.0]).unwrap_or_default();
            let exact = [0.0, delay_s * row as f64, r.between(0.0, LAST_S)][mode];
            // on the output interval of a plan
            (100.0 * exact).round() / 100.0
        };
        let blast = |(storey, axes): (usize, [usize; 2]), time_s: f64| Blast { storey, axes, time_s };
        let chosen: Vec<_> = all.iter().copied().filter(|_| r.is(share)).collect();
        let chosen = if chosen.is_empty() { vec![all[r.below(all.len())]] } else { chosen };
        chosen.into_iter().map(|column| blast(column, time_s(r, column.1))).collect()
    }

    /// A block on the ground: half of them inside a bay, the others beside the building.
    fn block(&self, r: &mut Random) -> Block {
        let half = 0.5 * self.sizes.column_m;
        let inside = r.is(0.5);
        let size = |r: &mut Random, most: f64| r.between(BLOCK_M[0], BLOCK_M[1].min(most));
        let (mut low, mut high) = ([0.0; 2], [0.0; 2]);
        let beside = r.below(2);
        for d in 0..2 {
            let own = &self.axes_m[d];
            let (first, last) = (own[0], own[own.len() - 1]);
            let range = if inside {
                let bay = r.below(own.len() - 1);
                [own[bay] + half + CLEAR_M, own[bay + 1] - half - CLEAR_M]
            } else if d != beside {
                [first - half, last + half]
            } else if r.is(0.5) {
                [first - half - FAR_M, first - half - CLEAR_M]
            } else {
                [last + half + CLEAR_M, last + half + FAR_M]
            };
            let side = size(r, range[1] - range[0]);
            low[d] = r.between(range[0], range[1] - side);
            high[d] = low[d] + side;
        }
        let below_floor = self.heights_m[0] - self.sizes.beam_m.max(self.sizes.slab_m) - CLEAR_M;
        let height = size(r, if inside { below_floor } else { BLOCK_M[1] });
        Block { from_m: low.map(milli), to_m: high.map(milli), height_m: milli(height) }
    }
}
