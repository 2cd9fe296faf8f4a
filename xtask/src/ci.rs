//! `cargo xtask ci`: everything that the hosted checks run, on any machine.

use std::process::ExitCode;

use crate::run::{cargo_command, step};

/// The crates that embedders use alone, without the standard library.
pub const NO_STD: [&str; 5] =
    ["shadowmap-core", "raster", "simd-search", "single-sample", "linear-light"];

/// Runs all checks, and fails if one of them failed; stops at none, so that one run shows all.
pub fn run(_arguments: &[String]) -> ExitCode {
    let mut failed = Vec::new();
    let mut check = |name: &str, arguments: &str, docs: bool| {
        let mut command = cargo_command(arguments);
        if docs {
            command.env("RUSTDOCFLAGS", "-D warnings");
        }
        if !step(name, &mut command) {
            failed.push(name.to_owned());
        }
    };
    check("format", "fmt --all --check", false);
    check("clippy", "clippy --workspace --all-targets -- -D warnings", false);
    check("docs", "doc --workspace --no-deps --all-features", true);
    check("tests", "test --workspace", false);
    for package in NO_STD {
        let name = format!("{package} without std");
        check(&name, &format!("check -p {package} --no-default-features --features libm"), false);
    }
    if failed.is_empty() {
        println!("ci: all passed");
        ExitCode::SUCCESS
    } else {
        println!("ci: FAILED: {}", failed.join(", "));
        ExitCode::FAILURE
    }
}
