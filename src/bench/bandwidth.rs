//! Memory bandwidth by the triad `a = b + s c` (McCalpin's STREAM): 24 bytes an entry, the line fetched before it is overwritten not counted.

use rayon::prelude::*;
use std::time::Instant;

/// Entries of each of the three arrays: 64 MiB, beyond the caches of common machines.
const ENTRIES: usize = 8 << 20;
/// Repetitions; the fastest counts.
const REPETITIONS: usize = 7;

/// Bandwidth of `threads` threads \[bytes/s\] in the current rayon pool.
pub fn triad_bytes_per_s(threads: usize) -> f64 {
    let mut a = vec![0.0_f64; ENTRIES];
    let (b, c) = (vec![1.0_f64; ENTRIES], vec![2.0_f64; ENTRIES]);
    let piece = ENTRIES.div_ceil(threads.max(1));
    let mut best = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let start = Instant::now();
        a.par_chunks_mut(piece).zip(b.par_chunks(piece)).zip(c.par_chunks(piece)).for_each(|((a, b), c)| {
            for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                *a = b + 3.0 * c;
            }
        });
        best = best.min(start.elapsed().as_secs_f64());
        std::hint::black_box(&mut a);
    }
    24.0 * ENTRIES as f64 / best
}
