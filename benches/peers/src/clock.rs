//! CPU time: unlike wall time it does not count what other processes take.

use std::time::Duration;

/// CPU time spent so far by the calling thread, and by all threads of this process together. A simplifier whose two
/// times differ works on several threads, and the first says nothing about it.
#[cfg(unix)]
pub(crate) fn cpu_times() -> [Duration; 2] {
    use rustix::time::{ClockId, clock_gettime};
    [ClockId::ThreadCPUTime, ClockId::ProcessCPUTime].map(|id| {
        let time = clock_gettime(id);
        Duration::new(u64::try_from(time.tv_sec).unwrap_or(0), u32::try_from(time.tv_nsec).unwrap_or(0))
    })
}

/// Wall time where the system has no such clocks: run on an idle machine.
#[cfg(not(unix))]
pub(crate) fn cpu_times() -> [Duration; 2] {
    use std::sync::OnceLock;
    use std::time::Instant;
    static START: OnceLock<Instant> = OnceLock::new();
    [START.get_or_init(Instant::now).elapsed(); 2]
}

/// Runs `work` and returns its result with its times in ms: this thread's, and the whole process's.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, [f64; 2]) {
    let before = cpu_times();
    let result = work();
    let after = cpu_times();
    (result, [0, 1].map(|i| after[i].saturating_sub(before[i]).as_secs_f64() * 1e3))
}
