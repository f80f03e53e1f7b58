//! How far a long command is: a bar with the time left on a terminal, a line now and then in a pipe.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Time between two lines in a pipe.
const QUIET: Duration = Duration::from_secs(10);
/// Steps of the bar.
const STEPS: u64 = 1000;

/// Progress on standard error.
pub struct Progress {
    bar: Option<ProgressBar>,
    state: Mutex<State>,
}

struct State {
    stage: String,
    began: Instant,
    said: Instant,
}

impl Progress {
    /// Progress on standard error, a bar if that is a terminal.
    pub fn on_stderr() -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        let now = Instant::now();
        Self { bar, state: Mutex::new(State { stage: String::new(), began: now, said: now }) }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A stage of unknown length begins.
    pub fn stage(&self, name: &str) {
        let mut state = self.state();
        state.stage = name.to_string();
        state.began = Instant::now();
        if let Some(bar) = &self.bar {
            bar.set_style(style("{spinner} {msg} ({elapsed})"));
            bar.set_message(name.to_string());
            bar.reset();
        }
    }

    /// What the stage is doing.
    pub fn note(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.set_message(text.to_string()),
            None => self.line(|_| text.to_string()),
        }
    }

    /// The stage is done to this share (0 to 1).
    pub fn advance(&self, share: f64, detail: &str) {
        let share = share.clamp(0.0, 1.0);
        if let Some(bar) = &self.bar {
            bar.set_style(style("{msg} [{wide_bar}] {percent:>3} %, {eta} left"));
            bar.set_message(format!("{} {detail}", self.state().stage));
            bar.set_position((share * STEPS as f64).round() as u64);
            return;
        }
        self.line(|state| {
            let left = state.began.elapsed().as_secs_f64() * (1.0 - share) / share.max(1e-9);
            format!("{} {detail}: {:.0} %, about {left:.0} s left", state.stage, 100.0 * share)
        });
    }

    /// A line that is always shown.
    pub fn say(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.println(text),
            None => eprintln!("{text}"),
        }
    }

    /// A line, unless the last one is too near.
    fn line(&self, text: impl Fn(&State) -> String) {
        let mut state = self.state();
        if state.said.elapsed() >= QUIET {
            state.said = Instant::now();
            eprintln!("{}", text(&state));
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ")
}
