//! Rolling resistance: a moment against the relative rotation of two bodies about axes across the contact normal.
//!
//! A pair whose points press with `Σ p_n` bears a moment impulse `|m| <= ρ Σ p_n` with the greatest dissipation, as Coulomb's law does for sliding; `ρ` is a length, the lever
//! of the pressure (Johnson, Contact Mechanics, 1985, section 9.4): a wheel of radius `r` stands on slopes up to `ρ / r`. Corrected once after each visit of the points of the pair.

use super::links::ALONE;
use super::rows::{Block, Motion, Rows};
use super::{ContactSet, Moving};
use crate::mbs::math::{self, V3};

/// The moment of a pair.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Roll {
    /// Impulse of it on the second body \[N m s\].
    pub moment: V3,
    /// Its sum over the rounds of an impact before this one.
    pub total: V3,
    /// One over the largest inverse inertia about tangential axes.
    inertia: f64,
    /// From the centre of mass of the first body to the contact: what a rotation is compared with in sweeps \[m\].
    arm_m: f64,
}

impl Rows {
    /// Prepares the moments of the blocks from `first` on. Those of single points begin with what their pairs bore before (by their slots) over a step of `h` \[s\], the others at zero: a face bears by its
    /// points what these can bear. With the moment of the last step the share of both is undetermined, points press unevenly, and a box that slides turns by their friction.
    pub fn prepare_rolls(&mut self, first: usize, before: impl Fn(u32) -> V3, h: f64) {
        self.rolls.truncate(first);
        for k in first..self.blocks.len() {
            let block = self.blocks[k];
            let mut roll = Roll::default();
            if block.rolling > 0.0 {
                let bore = if block.count == 1 { before(block.slot) } else { [0.0; 3] };
                roll = self.roll_of(&block, math::scale(h, bore));
                self.apply_moment(&block, roll.moment);
            }
            self.rolls.push(roll);
        }
    }

    fn roll_of(&self, block: &Block, before: V3) -> Roll {
        let n = block.normal;
        let [a, b] = block.bodies.map(|i| &self.inverse[i as usize]);
        let both = |p: V3, q: V3| math::dot(math::add(a.turn(p), b.turn(p)), q);
        let [_, s, t] = super::links::axes_about(n);
        let (ss, tt, st) = (both(s, s), both(t, t), both(s, t));
        let largest = 0.5 * (ss + tt) + (0.25 * (ss - tt) * (ss - tt) + st * st).sqrt();
        Roll {
            moment: math::axpy(before, -math::dot(before, n), n),
            inertia: 1.0 / largest,
            arm_m: math::norm(self.rows[block.first as usize].arms[0]),
            ..Roll::default()
        }
    }

    fn apply_moment(&mut self, block: &Block, moment: V3) {
        let [a, b] = block.bodies.map(|i| i as usize);
        let turn = self.inverse[a].turn(moment);
        self.motion[a].w = math::sub(self.motion[a].w, turn);
        let turn = self.inverse[b].turn(moment);
        self.motion[b].w = math::add(self.motion[b].w, turn);
    }

    /// Corrects the moment of a block; the square of the change of velocity that goes with it.
    pub fn roll(&mut self, k: usize) -> f64 {
        let block = self.blocks[k];
        debug_assert!(block.linked == ALONE, "refused in models with ideal joints");
        let rows = &self.rows[block.range()];
        let limit = block.rolling * rows.iter().map(|row| row.normal).sum::<f64>();
        let spin = self.spin(&block, &self.motion);
        let roll = &mut self.rolls[k];
        let mut moment = math::axpy(roll.moment, -roll.inertia, spin);
        let size = math::norm(moment);
        if size > limit {
            moment = math::scale(limit / size, moment);
        }
        let change = math::sub(moment, roll.moment);
        roll.moment = moment;
        let speed = roll.arm_m / roll.inertia;
        self.apply_moment(&block, change);
        speed * speed * math::dot(change, change)
    }

    /// Angular velocity of the second body against the first one, across the normal \[rad/s\].
    pub fn spin(&self, block: &Block, motion: &[Motion]) -> V3 {
        let [a, b] = block.bodies.map(|i| motion[i as usize].w);
        let w = math::sub(b, a);
        math::axpy(w, -math::dot(w, block.normal), block.normal)
    }
}

impl ContactSet {
    /// Prepares the moments of the blocks from `first` on; those of the last step act at once if `warm`.
    pub(super) fn start_rolls(&mut self, first: usize, h: f64, warm: bool) {
        if self.is_rolling {
            let pairs = &self.pairs;
            let before = |slot: u32| if warm { pairs[slot as usize].moment } else { [0.0; 3] };
            self.rows.prepare_rolls(first, before, h);
        }
    }

    /// What the moment of a block does on velocities before and after the contacts of a step, `m · ω` in both \[J\].
    pub(super) fn roll_work(&self, k: usize, before: impl Fn(u32) -> Motion) -> [f64; 2] {
        let block = &self.rows.blocks[k];
        let Some(roll) = self.rows.rolls.get(k).filter(|_| block.rolling > 0.0) else { return [0.0; 2] };
        let [a, b] = block.bodies.map(&before);
        let after = self.rows.spin(block, &self.rows.motion);
        [math::dot(roll.moment, math::sub(b.w, a.w)), math::dot(roll.moment, after)]
    }
}

/// The motion of a body before contacts.
pub(super) fn before(bodies: &[Moving], i: u32) -> Motion {
    bodies.get(i as usize).map_or(Motion::default(), |b| Motion { v: b.v, w: b.w })
}
