//! What a run computes of bodies and latent sections, and what it leaves out.

use super::Run;
use crate::mbs::result::BodyWork;

/// Who is there while nothing vanishes and nothing parts.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Census {
    /// Bodies of the file.
    present: u64,
    /// Bodies that run: those that latent bushings hold together count once.
    running: u64,
}

impl Run<'_> {
    /// Counts who is there.
    pub(super) fn census(&self) -> Census {
        let alive = (0..self.system.count()).filter(|i| self.system.data[*i].alive);
        let pieces = |i: usize| self.latent.pieces[i].len() as u64;
        alive.fold(Census::default(), |sum, i| Census {
            present: sum.present + pieces(i),
            running: sum.running + 1,
        })
    }

    /// Books some steps.
    pub(super) fn book_steps(&mut self, census: Census, steps: u64) {
        let [latent, watched] = self.latent.counted();
        let work = &mut self.result.body_work;
        work.body_steps += steps * census.present;
        work.held_steps += steps * (census.present - census.running);
        work.asleep_steps += steps * self.sleep.asleep() as u64;
        work.latent_steps += steps * latent;
        work.unwatched_steps += steps * (latent - watched);
    }
}

impl BodyWork {
    /// In words, for the end of a run; nothing if nothing was left out.
    pub fn words(&self) -> Option<String> {
        let percent = |part: u64, of: u64| 100.0 * part as f64 / of.max(1) as f64;
        let (bodies, sections) = (self.body_steps, self.latent_steps);
        (self.held_steps + self.asleep_steps + self.unwatched_steps + self.bounded_looks > 0).then(|| {
            format!(
                "bodies: {:.1} % of them moved as a part of another one, {:.1} % of the others slept (mean over the steps); latent hinges: {:.1} % not looked at, {:.1} % of the looks at the others left out by a bound of their loads (--compute-all makes them, with the same result)",
                percent(self.held_steps, bodies),
                percent(self.asleep_steps, bodies - self.held_steps),
                percent(self.unwatched_steps, sections),
                percent(self.bounded_looks, self.looks + self.bounded_looks),
            )
        })
    }
}
