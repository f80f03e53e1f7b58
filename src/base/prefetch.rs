//! Asking for memory before it is needed.

/// Bytes of a cache line.
const LINE: usize = 64;

/// Asks the processor to fetch a value into its caches while other work goes on; without effect on results, and nothing at all on
/// processors other than x86-64. The processors' own prefetching follows plain streams; it loses time at each block of a mesh, whose arrays
/// are read in the order of the computation.
#[inline(always)]
pub fn prefetch<T>(value: &T) {
    for line in 0..size_of::<T>().div_ceil(LINE) {
        fetch_line(std::ptr::from_ref(value).cast::<i8>().wrapping_add(LINE * line));
    }
}

#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "a prefetch reads nothing and cannot fault, whatever the address")]
#[inline(always)]
fn fetch_line(address: *const i8) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    // SAFETY: the instruction is part of every x86-64 processor and has no effect but on caches.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(address) }
}

#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
fn fetch_line(_: *const i8) {}
