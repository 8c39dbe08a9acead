//! Loops over all cores with feature `parallel`, on one core without. Results are in order: bytes are equal either way.

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Calls `work` for every number in `0..count`. A core takes at least `least` numbers.
pub(crate) fn map<T: Send>(count: usize, least: usize, work: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "parallel")]
    {
        (0..count).into_par_iter().with_min_len(least).map(work).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        let _ = least;
        (0..count).map(work).collect()
    }
}

/// Calls `work` for every number in `0..count` with scratch that calls share. A core takes at least `least` numbers.
pub(crate) fn map_with<S: Default, T: Send>(
    count: usize,
    least: usize,
    work: impl Fn(&mut S, usize) -> T + Sync + Send,
) -> Vec<T> {
    #[cfg(feature = "parallel")]
    {
        (0..count).into_par_iter().with_min_len(least).map_init(S::default, work).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        let _ = least;
        let mut scratch = S::default();
        (0..count).map(|at| work(&mut scratch, at)).collect()
    }
}

/// Calls `work` for every item.
pub(crate) fn map_items<I: Sync, T: Send>(items: &[I], work: impl Fn(&I) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "parallel")]
    {
        items.par_iter().map(work).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        items.iter().map(work).collect()
    }
}

/// Calls `work` for every item, which may change. A core takes at least `least` items.
pub(crate) fn map_mut<I: Send, T: Send>(
    items: &mut [I],
    least: usize,
    work: impl Fn(&mut I) -> T + Sync + Send,
) -> Vec<T> {
    #[cfg(feature = "parallel")]
    {
        items.par_iter_mut().with_min_len(least).map(work).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        let _ = least;
        items.iter_mut().map(work).collect()
    }
}

/// Calls `work` for every item, which may change, and adds up the results, in any order. A core takes at least `least` items.
pub(crate) fn sum_mut<I: Send, T: Send + Sync + Copy>(
    items: &mut [I],
    least: usize,
    zero: T,
    work: impl Fn(&mut I) -> T + Sync + Send,
    add: impl Fn(T, T) -> T + Sync + Send,
) -> T {
    #[cfg(feature = "parallel")]
    if items.len() > least {
        return items.par_iter_mut().with_min_len(least).map(work).reduce(|| zero, add);
    }
    let _ = least;
    items.iter_mut().map(work).fold(zero, add)
}

/// Calls `work` for every chunk of `size` of `0..count`; results in order of the chunks.
#[cfg(feature = "quality")]
pub(crate) fn map_chunks<T: Send>(
    count: usize,
    size: usize,
    work: impl Fn(std::ops::Range<usize>) -> T + Sync,
) -> Vec<T> {
    map(count.div_ceil(size), 1, |index| work(index * size..((index + 1) * size).min(count)))
}

/// Calls `work` for every item and its number, to fill it in.
pub(crate) fn fill<T: Send>(items: &mut [T], work: impl Fn((usize, &mut T)) + Sync + Send) {
    #[cfg(feature = "parallel")]
    items.par_iter_mut().enumerate().for_each(work);
    #[cfg(not(feature = "parallel"))]
    items.iter_mut().enumerate().for_each(work);
}

/// Calls `work` for every chunk of `size` items and its number, to fill it in.
pub(crate) fn fill_chunks<T: Send>(
    items: &mut [T],
    size: usize,
    work: impl Fn((usize, &mut [T])) + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    items.par_chunks_mut(size).enumerate().for_each(work);
    #[cfg(not(feature = "parallel"))]
    items.chunks_mut(size).enumerate().for_each(work);
}

/// Calls both functions, at the same time if there are cores.
pub(crate) fn join<A: Send, B: Send>(
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "parallel")]
    {
        rayon::join(first, second)
    }
    #[cfg(not(feature = "parallel"))]
    {
        (first(), second())
    }
}

/// Returns the first number in `0..count` for which `holds` is true.
pub(crate) fn first(count: u32, holds: impl Fn(u32) -> bool + Sync + Send) -> Option<u32> {
    #[cfg(feature = "parallel")]
    {
        (0..count).into_par_iter().find_first(|&at| holds(at))
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..count).find(|&at| holds(at))
    }
}
