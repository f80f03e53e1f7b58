//! Processor time of a run.

/// Processor time of this thread where the system tells it, else wall time.
#[derive(Debug)]
pub struct Clock {
    wall: std::time::Instant,
    processor: Option<f64>,
}

impl Clock {
    /// Starts now.
    pub fn start() -> Self {
        Self { wall: std::time::Instant::now(), processor: thread_cpu_s() }
    }

    /// Seconds since.
    pub fn elapsed_s(&self) -> f64 {
        match (self.processor, thread_cpu_s()) {
            (Some(a), Some(b)) if b > a => b - a,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// First field of Linux's schedstat: nanoseconds on a processor.
fn thread_cpu_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse::<f64>().ok().map(|ns| 1e-9 * ns)
}
