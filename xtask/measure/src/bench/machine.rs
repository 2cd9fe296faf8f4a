//! What machine and compiler the figures are from.

use std::hint::black_box;
use std::time::Instant;

use serde::{Deserialize, Serialize};
use shadowmap_core::Level;

/// What a figure depends on besides the code.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor.
    pub cpu: String,
    /// Hardware threads.
    pub threads: usize,
    /// SIMD levels, the widest last.
    pub levels: Vec<String>,
    /// The compiler's version.
    pub compiler: String,
    /// Bytes per second that one thread copies within 8 MiB, what a map of 1024² takes, counting
    /// those read and those written.
    pub bandwidth: f64,
}

impl Machine {
    /// This machine.
    pub fn this() -> Machine {
        let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let cpu = cpuinfo.lines().find_map(|line| line.strip_prefix("model name"));
        let cpu =
            cpu.map_or(std::env::consts::ARCH, |line| line.trim_start_matches([' ', '\t', ':']));
        Machine {
            cpu: cpu.to_owned(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            levels: Level::available().map(|level| level.kind().name().to_owned()).collect(),
            compiler: compiler(),
            bandwidth: bandwidth(),
        }
    }
}

/// The version of the compiler in the path, which is the one that `cargo` has just used.
pub fn compiler() -> String {
    match std::process::Command::new("rustc").arg("--version").output() {
        Ok(output) => String::from_utf8_lossy(&output.stdout).trim().to_owned(),
        Err(_) => "unknown".to_owned(),
    }
}

/// The best of several copies.
fn bandwidth() -> f64 {
    let from = vec![1_u64; 1 << 19];
    let mut to = vec![0_u64; from.len()];
    let seconds = (0..50).map(|_| {
        let start = Instant::now();
        to.copy_from_slice(black_box(&from));
        black_box(&to);
        start.elapsed().as_secs_f64()
    });
    (2 * size_of_val(&from[..])) as f64 / seconds.fold(f64::INFINITY, f64::min)
}
