//! `cargo xtask cross`: builds for every target and, where a runner exists, tests.

use std::process::ExitCode;

use crate::features::NO_STD;
use crate::run::{Report, only_full};
use crate::targets::{
    AARCH64, BARE_METAL, I686, THUMB, Target, Toolchain, WASMS, WINDOWS, host_cargo,
};

const HELP: &str = "\
cargo xtask cross [--full]

Builds the algorithm crates and a consumer without a heap for a microcontroller, and runs a tiny render
in its emulator. With --full also: the same builds for three other bare-metal targets; the crates' tests
on AArch64 (qemu) and 32-bit x86, and at each x86-64 level that the compiler knows; builds for
WebAssembly, without and with SIMD, and for Windows. Missing tools are installed where that is
allowed.";

/// Runs the command.
pub fn run(arguments: &[String]) -> ExitCode {
    let Some(full) = only_full(arguments) else {
        println!("{HELP}");
        return ExitCode::from(2);
    };
    let mut report = Report::default();
    check(full, &mut report);
    report.finish("cross")
}

/// Does what the command says.
pub fn check(full: bool, report: &mut Report) {
    let packages = NO_STD.map(|name| format!("-p {name}")).join(" ");
    bare(&THUMB, &packages, report);
    let tiny = "run --release --manifest-path tests/bare-metal/Cargo.toml";
    cargo(report, &THUMB, "tiny render", tiny);
    if !full {
        return;
    }
    for target in &BARE_METAL {
        bare(target, &packages, report);
    }
    for target in [&AARCH64, &I686] {
        cargo(report, target, "tests", &format!("test --release {packages}"));
    }
    for target in WASMS.iter().chain([&WINDOWS]) {
        cargo(report, target, "build", &format!("build --release {packages}"));
    }
    for level in ["v2", "v3", "v4"] {
        let name = format!("x86-64-{level}");
        let flags = format!("-Ctarget-cpu={name}");
        let mut tests = host_cargo(&name, &flags, &format!("test --tests {packages}"));
        report.step(&format!("{name}: tests"), &mut tests);
    }
}

/// Builds what runs without an operating system.
fn bare(target: &Target, packages: &str, report: &mut Report) {
    let features = "--no-default-features --features libm";
    cargo(report, target, "build", &format!("build --release {packages} {features}"));
    let consumer = "build --release --manifest-path tests/consumer/Cargo.toml";
    cargo(report, target, "consumer without alloc", consumer);
}

fn cargo(report: &mut Report, target: &Target, what: &str, arguments: &str) {
    let name = format!("{}: {what}", target.name);
    match Toolchain::with_tools(target) {
        Ok(toolchain) => {
            report.step(&name, &mut toolchain.cargo(target, arguments));
        }
        Err(missing) => report.skipped(&name, &missing),
    }
}
