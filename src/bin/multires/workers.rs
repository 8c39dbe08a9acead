//! Work on all cores; results are in the order of the pieces.

/// Calls `work` for every number below `count`, on as many threads as there are cores.
///
/// With the feature `parallel` these are the threads on which the library divides its own work: pieces at the end, when others are
/// done, still get all cores, and no thread waits for another.
#[cfg(feature = "parallel")]
pub fn each<R: Send>(count: usize, work: impl Fn(usize) -> R + Send + Sync) -> Vec<R> {
    use rayon::prelude::*;

    (0..count).into_par_iter().with_max_len(1).map(work).collect()
}

/// Calls `work` for every number below `count`, on as many threads as there are cores: each takes the next piece.
#[cfg(not(feature = "parallel"))]
pub fn each<R: Send>(count: usize, work: impl Fn(usize) -> R + Send + Sync) -> Vec<R> {
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicUsize, Ordering};

    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(count);
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, R)>> = Mutex::new(Vec::with_capacity(count));
    let take = || {
        loop {
            let piece = next.fetch_add(1, Ordering::Relaxed);
            if piece >= count {
                break;
            }
            let result = work(piece);
            if let Ok(mut done) = done.lock() {
                done.push((piece, result));
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(take);
        }
        take();
    });
    let mut done = done.into_inner().unwrap_or_default();
    done.sort_by_key(|(piece, _)| *piece);
    done.into_iter().map(|(_, result)| result).collect()
}
