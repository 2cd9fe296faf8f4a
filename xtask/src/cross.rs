//! `cargo xtask cross`: builds for every target and, where a runner exists, tests.

use std::process::ExitCode;

use crate::ci::NO_STD;
use crate::run::{in_ci, step};
use crate::targets::{
    AARCH64, BARE_METAL, I686, THUMB, Target, Toolchain, WASMS, WINDOWS, host_cargo,
};

const HELP: &str = "\
cargo xtask cross [--full]

Builds the algorithm crates for bare metal and runs a tiny render in an emulated microcontroller.
With --full also: their tests on AArch64 (qemu) and 32-bit x86, and at each x86-64 level the compiler
knows; builds for WebAssembly and Windows. Missing tools are installed where that is allowed.";

/// Runs the command.
pub fn run(arguments: &[String]) -> ExitCode {
    let full = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => false,
        ["--full"] => true,
        _ => {
            println!("{HELP}");
            return ExitCode::from(2);
        }
    };
    let mut report = Report::default();
    for target in &BARE_METAL {
        let packages = NO_STD.map(|name| format!("-p {name}")).join(" ");
        let features = "--no-default-features --features libm";
        report.cargo(target, "build", &format!("build --release {packages} {features}"));
        let consumer = "build --release --manifest-path tests/consumer/Cargo.toml";
        report.cargo(target, "consumer without alloc", consumer);
    }
    let tiny = "run --release --manifest-path tests/bare-metal/Cargo.toml";
    report.cargo(&THUMB, "tiny render", tiny);
    if full {
        let packages = NO_STD.map(|name| format!("-p {name}")).join(" ");
        for target in [&AARCH64, &I686] {
            report.cargo(target, "tests", &format!("test --release {packages}"));
        }
        for target in WASMS.iter().chain([&WINDOWS]) {
            report.cargo(target, "build", &format!("build --release {packages}"));
        }
        for level in ["v2", "v3", "v4"] {
            let name = format!("x86-64-{level}");
            let mut tests =
                host_cargo(&name, &format!("-Ctarget-cpu={name}"), &format!("test {packages}"));
            report.outcome(&name, step(&format!("{name}: tests"), &mut tests));
        }
    }
    report.finish()
}

/// What went wrong so far.
#[derive(Default)]
struct Report {
    failed: Vec<String>,
    skipped: Vec<String>,
}

impl Report {
    fn cargo(&mut self, target: &Target, what: &str, arguments: &str) {
        let name = format!("{}: {what}", target.name);
        match Toolchain::with_tools(target) {
            Ok(toolchain) => {
                let passed = step(&name, &mut toolchain.cargo(target, arguments));
                self.outcome(&name, passed);
            }
            Err(missing) => {
                println!("==> {name}\n    SKIPPED: {missing}");
                self.skipped.push(name);
            }
        }
    }

    fn outcome(&mut self, name: &str, passed: bool) {
        if !passed {
            self.failed.push(name.to_owned());
        }
    }

    /// A skip is a failure on a hosted machine, where every tool can be had.
    fn finish(self) -> ExitCode {
        if !self.skipped.is_empty() {
            println!("cross: SKIPPED: {}", self.skipped.join(", "));
        }
        if self.failed.is_empty() && (self.skipped.is_empty() || !in_ci()) {
            println!("cross: all that ran passed");
            return ExitCode::SUCCESS;
        }
        println!("cross: FAILED: {}", self.failed.join(", "));
        ExitCode::FAILURE
    }
}
