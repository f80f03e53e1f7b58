//! Time measurement: wall clock and processor time of the whole process.

use std::time::Instant;

/// A running measurement.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch {
    wall: Instant,
    cpu_s: f64,
}

/// Processor and wall time of a piece of work.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Elapsed {
    /// Processor time over all threads \[s\].
    pub cpu_s: f64,
    /// Wall time \[s\].
    pub wall_s: f64,
}

impl std::ops::Add for Elapsed {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { cpu_s: self.cpu_s + other.cpu_s, wall_s: self.wall_s + other.wall_s }
    }
}

impl Stopwatch {
    /// Starts measuring.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu_s: process_cpu_s() }
    }

    /// Time since the start.
    pub fn elapsed(&self) -> Elapsed {
        Elapsed { cpu_s: process_cpu_s() - self.cpu_s, wall_s: self.wall.elapsed().as_secs_f64() }
    }
}

/// Processor time used by this process so far \[s\].
fn process_cpu_s() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
}

/// Processor time of one thread.
#[derive(Debug)]
pub struct ThreadClock(f64);

impl ThreadClock {
    /// Starts now.
    pub fn start() -> Self {
        Self(thread_cpu_s())
    }

    /// Processor time of this thread since \[s\].
    pub fn elapsed_s(&self) -> f64 {
        thread_cpu_s() - self.0
    }
}

/// Processor time used by this thread so far \[s\].
fn thread_cpu_s() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
}
