//! `cargo xtask ci`: everything that the hosted checks run, on any machine.

use std::fs;
use std::process::{Command, ExitCode};

use crate::features::NO_STD;
use crate::run::{Report, cargo_command, only_full, root};
use crate::{cross, features, fuzz, verify};

const HELP: &str = "\
cargo xtask ci [--full]

Format, clippy, documentation, all tests, hostile inputs, every set of features, the microcontroller
(`cross`), and the same bits at all levels of this machine (`verify --here`). With --full also: all
targets (`verify`, `cross --full`), a short `fuzz`, the tests under the address sanitizer, and small
renders under valgrind. With PENUMBRA_NO_SKIPS set, what cannot run for want of a tool is an error.";

/// Random cases per check of hostile inputs.
const CASES: &str = "5000";

/// Seconds of fuzzing per target.
const FUZZ_SECONDS: u32 = 15;

/// Runs all checks, and fails if one of them failed.
pub fn run(arguments: &[String]) -> ExitCode {
    let Some(full) = only_full(arguments) else {
        println!("{HELP}");
        return ExitCode::from(2);
    };
    let mut report = Report::default();
    report.step("format", &mut cargo_command("fmt --all --check"));
    let clippy = "clippy --workspace --all-targets -- -D warnings";
    report.step("clippy", &mut cargo_command(clippy));
    let mut docs = cargo_command("doc --workspace --no-deps --all-features");
    report.step("docs", docs.env("RUSTDOCFLAGS", "-D warnings"));
    report.step("tests", &mut cargo_command("test --workspace"));
    let mut hostile = cargo_command("test --quiet -p hostile");
    report.step("hostile inputs", hostile.env("PENUMBRA_CASES", CASES));
    features::check(&mut report);
    cross::check(full, &mut report);
    verify::check(full, &mut report);
    if full {
        match fuzz::missing() {
            None => report.outcome("fuzz", fuzz::fuzz(FUZZ_SECONDS, &[])),
            Some(missing) => report.skipped("fuzz", missing),
        }
        sanitizer(&mut report);
        valgrind(&mut report);
    }
    report.finish("ci")
}

/// The tests of the crates with `unsafe`, and hostile inputs, under the address sanitizer.
fn sanitizer(report: &mut Report) {
    let name = "address sanitizer";
    let nightly = Command::new("rustc").args(["+nightly", "--version"]).output();
    if !nightly.is_ok_and(|output| output.status.success()) {
        return report.skipped(name, "needs the nightly toolchain");
    }
    let mut command = Command::new("cargo");
    command.args(["+nightly", "test", "--tests", "--target", "x86_64-unknown-linux-gnu"]);
    for package in NO_STD.iter().chain(&["renderer", "hostile"]) {
        command.args(["-p", package]);
    }
    command.env("RUSTFLAGS", "-Zsanitizer=address").env("ASAN_OPTIONS", "detect_leaks=0");
    command.env("CARGO_TARGET_DIR", root().join("target/sanitizer"));
    // The cargo that runs us names its own compiler.
    command.env_remove("RUSTC").env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO");
    report.step(name, &mut command);
}

/// Small renders by both methods under valgrind, which knows instructions up to AVX2.
fn valgrind(report: &mut Report) {
    if Command::new("valgrind").arg("--version").output().is_err() {
        return report.skipped("valgrind", "needs valgrind");
    }
    if !report.step("build for valgrind", &mut cargo_command("build --release -p renderer")) {
        return;
    }
    let folder = root().join("target/valgrind");
    if let Err(error) = fs::create_dir_all(&folder) {
        return report.failed(&format!("{}: {error}", folder.display()));
    }
    for (method, light) in [
        ("search", "sphere:1.5,6,1.5:0.5"),
        ("search-paper", "sphere:1.5,6,1.5:0.5"),
        ("skins", "linear:-1,5,0:1,5,0"),
        ("intervals", "linear:-1,5,0:1,5,0"),
    ] {
        for level in ["scalar", "sse4.1", "avx2"] {
            let mut command = Command::new("valgrind");
            command
                .args(["--quiet", "--error-exitcode=9"])
                .arg(root().join("target/release/penumbra"));
            command.args(["render", "torus", "--light", light, "--method", method]);
            command.args([
                "--size",
                "80x60",
                "--map-size",
                "96",
                "--threads",
                "2",
                "--simd",
                level,
            ]);
            command.arg("-o").arg(folder.join("picture.png"));
            report.step(&format!("valgrind: {method}, {level}"), &mut command);
        }
    }
}
