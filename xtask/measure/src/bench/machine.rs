//! What machine and compiler the figures are from.

use std::hint::black_box;
use std::time::Instant;

use multiversion::multiversion;
use serde::{Deserialize, Serialize};
use shadowmap_core::Level;

use super::addresses;

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
    /// Whether program and memory lie where they lie in every run.
    #[serde(default)]
    pub fixed_addresses: bool,
    /// Bytes per second that one thread copies within 8 MiB, what a map of 1024² takes, counting
    /// those read and those written.
    pub bandwidth: f64,
    /// Multiplications and additions of `f32` per second, as many of each, that one thread makes at
    /// the widest level; not fused, as nowhere in this workspace.
    pub peak: f64,
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
            fixed_addresses: addresses::fixed(),
            bandwidth: best(copy),
            peak: best(multiply_and_add),
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

/// The most that several attempts reach of what `rate` measures.
fn best(rate: fn() -> f64) -> f64 {
    (0..50).map(|_| rate()).fold(0.0, f64::max)
}

/// Bytes per second of a copy.
fn copy() -> f64 {
    let from = vec![1_u64; 1 << 19];
    let mut to = vec![0_u64; from.len()];
    to.copy_from_slice(&from);
    let start = Instant::now();
    to.copy_from_slice(black_box(&from));
    black_box(&to);
    (2 * size_of_val(&from[..])) as f64 / start.elapsed().as_secs_f64()
}

/// Operations per second on as many independent values as hide what each operation takes.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+sse4.1", "aarch64+neon"))]
fn multiply_and_add() -> f64 {
    const ROUNDS: usize = 20_000;
    let mut values = [1.0_f32; 128];
    let [factor, term] = black_box([0.5_f32, 0.5]);
    let start = Instant::now();
    for _ in 0..ROUNDS {
        for value in &mut values {
            *value = *value * factor + term;
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    black_box(values);
    (2 * ROUNDS * values.len()) as f64 / seconds
}
