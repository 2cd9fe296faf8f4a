//! `cargo xtask features`: each crate alone, with every set of its features, and the minimum Rust
//! version.

use std::fs;
use std::process::{Command, ExitCode};

use crate::run::{Report, cargo, cargo_command, root};

/// The crates that embedders use alone, without the standard library.
pub const NO_STD: [&str; 5] =
    ["shadowmap-core", "raster", "simd-search", "single-sample", "linear-light"];

/// The sets of features. `rayon` brings `std`.
const SETS: [&str; 5] = ["libm", "std", "std,libm", "rayon", "rayon,libm"];

const HELP: &str = "\
cargo xtask features

Checks each crate alone with every set of its features, and that nothing needs a newer Rust than
Cargo.toml says: the declared versions of all dependencies, and a check by that very version where it is
installed (`rustup toolchain install`). Newer functions of the standard library are told by clippy in
`cargo xtask ci`.";

/// Runs the command.
pub fn run(arguments: &[String]) -> ExitCode {
    if !arguments.is_empty() {
        println!("{HELP}");
        return ExitCode::from(2);
    }
    let mut report = Report::default();
    check(&mut report);
    report.finish("features")
}

/// Does what the command says.
pub fn check(report: &mut Report) {
    for package in NO_STD {
        for features in SETS {
            if package == "simd-search" && features.contains("rayon") {
                continue;
            }
            let arguments =
                format!("check --quiet -p {package} --no-default-features --features {features}");
            report.step(&format!("{package} with {features}"), &mut cargo_command(&arguments));
        }
    }
    for arguments in ["-p reference", "-p renderer --no-default-features", "-p renderer"] {
        let mut command = cargo_command(&format!("check --quiet {arguments}"));
        report.step(arguments, &mut command);
    }
    minimum_version(report);
}

fn minimum_version(report: &mut Report) {
    let Some(minimum) = declared() else {
        return report.failed("minimum Rust version: Cargo.toml declares none");
    };
    let newer = dependencies_newer_than(&minimum);
    match newer {
        Ok(newer) if newer.is_empty() => {
            println!(
                "==> minimum Rust version {minimum}: every dependency declares it or an older one"
            );
        }
        Ok(newer) => report.failed(&format!("newer than Rust {minimum}: {}", newer.join(", "))),
        Err(error) => report.failed(&format!("minimum Rust version: {error}")),
    }
    let name = format!("check with Rust {minimum}");
    let list = Command::new("rustup").args(["toolchain", "list"]).output();
    let list = list.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let toolchain = list.unwrap_or_default();
    let Some(toolchain) = toolchain.lines().find(|line| line.starts_with(&minimum)) else {
        let hint = "the lint clippy::incompatible_msrv and the declared versions stand in for it";
        return report.not_run(&name, &format!("no such toolchain installed; {hint}"));
    };
    let toolchain = toolchain.split_whitespace().next().unwrap_or_default();
    let mut command = Command::new("rustup");
    command.args(["run", toolchain, "cargo", "check", "--workspace", "--target-dir"]);
    command.arg(root().join("target/minimum"));
    report.step(&name, &mut command);
}

/// The `rust-version` of the workspace.
fn declared() -> Option<String> {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).ok()?;
    let line = manifest.lines().find(|line| line.starts_with("rust-version"))?;
    Some(line.split('"').nth(1)?.to_owned())
}

/// Packages whose declared Rust version is newer.
fn dependencies_newer_than(minimum: &str) -> Result<Vec<String>, String> {
    let mut metadata = Command::new(cargo());
    metadata.args(["metadata", "--format-version", "1", "--locked"]).current_dir(root());
    let output = metadata.output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).trim().to_owned());
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let mut newer = Vec::new();
    // One package after another, each with its ID first.
    for package in text.split("\"id\":\"").skip(1) {
        let quoted = |text: &str| text.split('"').next().unwrap_or_default().to_owned();
        let version = package.split("\"rust_version\":\"").nth(1).map(quoted);
        if let Some(version) = version.filter(|version| number(version) > number(minimum)) {
            newer.push(format!("{} ({version})", quoted(package)));
        }
    }
    newer.sort();
    newer.dedup();
    Ok(newer)
}

/// 1.89.0 as numbers that compare.
fn number(version: &str) -> [u32; 3] {
    let mut parts = version.split('.').map(|part| part.parse().unwrap_or(0));
    [0; 3].map(|_| parts.next().unwrap_or(0))
}
