//! One thread, or two that the kernel leaves on two cores.

use std::fs;
use std::sync::LazyLock;

use core_affinity::CoreId;
use rayon::{ThreadPool, ThreadPoolBuilder};
use shadowmap_core::Threads;

/// Calls `run` on this thread, or on one of a pool of two.
///
/// Each of the two keeps to a core. Left alone, a kernel wakes a worker on the core of the thread
/// that wakes it, and takes a tenth of a second to part them: in frames drawn for longer than that
/// the two run side by side, in visits shorter than that they would share one core, now and then.
pub fn on<R: Send>(threads: Threads, run: impl FnOnce() -> R + Send) -> R {
    static POOL: LazyLock<ThreadPool> = LazyLock::new(|| {
        let cores = two_cores();
        let pin = move |worker: usize| {
            if let Some(cores) = cores {
                core_affinity::set_for_current(cores[worker]);
            }
        };
        let pool = ThreadPoolBuilder::new().num_threads(2).start_handler(pin).build();
        pool.expect("two threads can be started")
    });
    if threads == Threads::One { run() } else { POOL.install(run) }
}

/// How variants call a number of threads.
pub fn count(threads: Threads) -> &'static str {
    if threads == Threads::One { "1 thread" } else { "2 threads" }
}

/// Two hardware threads that are not of one core, if this machine has them.
fn two_cores() -> Option<[CoreId; 2]> {
    let all = core_affinity::get_core_ids()?;
    let first = *all.first()?;
    let second = all.into_iter().find(|other| core_of(*other) != core_of(first))?;
    Some([first, second])
}

/// What tells a hardware thread's core from others; on systems that do not say, each is one.
fn core_of(thread: CoreId) -> String {
    let path = format!("/sys/devices/system/cpu/cpu{}/topology/core_cpus_list", thread.id);
    fs::read_to_string(path).unwrap_or_else(|_| thread.id.to_string())
}
