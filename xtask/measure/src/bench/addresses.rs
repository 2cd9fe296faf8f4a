//! The same addresses in every run.
//!
//! Where program and memory happen to lie changes what branches and cache lines collide, and with
//! it some ratios by 5 to 10 per cent for a whole run. Kernels choose that at random unless told
//! not to.

use std::fs;
#[cfg(unix)]
use std::{os::unix::process::CommandExt, process::Command};

/// The bit of a Linux process that does not want its addresses randomized.
const FIXED: u32 = 0x0004_0000;

/// Whether this process has the addresses of every other run.
pub fn fixed() -> bool {
    let personality = fs::read_to_string("/proc/self/personality").unwrap_or_default();
    u32::from_str_radix(personality.trim(), 16).is_ok_and(|bits| bits & FIXED != 0)
}

/// Becomes the same program with fixed addresses, if `setarch` can make it that. Returns if not.
#[cfg(unix)]
pub fn fix(arguments: &[String]) {
    let setarch = || {
        let mut command = Command::new("setarch");
        command.arg("-R");
        command
    };
    let can = || setarch().arg("true").output().is_ok_and(|output| output.status.success());
    if let Ok(program) = std::env::current_exe()
        && !fixed()
        && can()
    {
        // It returns if it fails, and then addresses stay as they are: the report says so.
        let _ = setarch().arg(program).arg("bench").args(arguments).exec();
    }
}

/// Does nothing: other systems are not known to fix addresses.
#[cfg(not(unix))]
pub fn fix(_arguments: &[String]) {}
