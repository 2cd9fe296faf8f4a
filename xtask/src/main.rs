//! The workspace's commands. `cargo xtask` lists them.
//!
//! This crate depends on none of the others, so that it builds in a second: it runs them.

use std::process::{Command, ExitCode};

mod ci;
mod cross;
mod elf;
mod features;
mod fuzz;
#[path = "../../tests/verify/src/golden.rs"]
mod golden;
mod run;
mod targets;
mod verify;

const HELP: &str = "\
cargo xtask <command> [options]

  render [SCENE] [options]   draw a picture with soft shadows (the program penumbra)
  compare A B [options]      compare two pictures
  mask VIEWS [options]       a shadow mask from the depth buffers of another program
  bench [options]            time every stage; table, JSON and HTML in target/bench
  figures [options]          redraw the papers' figures as one report in target/figures
  ci [--full]                everything that the hosted checks run
  features                   each crate alone, with every set of features; minimum Rust version
  cross [--full]             build and test for other targets
  fuzz [--seconds N]         any input whatsoever, for N seconds per entry point
  verify [--here]            the same bits at every SIMD level, thread count and target

Every command explains itself with --help.";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let command = arguments.next().unwrap_or_default();
    let rest: Vec<String> = arguments.collect();
    match command.as_str() {
        "render" | "compare" | "mask" => package("renderer", &command, &rest),
        "bench" | "figures" => package("measure", &command, &rest),
        "ci" => ci::run(&rest),
        "cross" => cross::run(&rest),
        "features" => features::run(&rest),
        "fuzz" => fuzz::run(&rest),
        "verify" => verify::run(&rest),
        "" | "help" | "--help" | "-h" => {
            println!("{HELP}");
            ExitCode::SUCCESS
        }
        unknown => {
            eprintln!("xtask: no command `{unknown}`\n\n{HELP}");
            ExitCode::from(2)
        }
    }
}

/// Runs `command` of a package's program, built in release mode, and passes its exit code on.
fn package(package: &str, command: &str, arguments: &[String]) -> ExitCode {
    let status = Command::new(run::cargo())
        .args(["run", "--quiet", "--release", "--package", package, "--", command])
        .args(arguments)
        .status();
    match status {
        Ok(status) => ExitCode::from(status.code().map_or(1, |code| code as u8)),
        Err(error) => {
            eprintln!("xtask: cannot run cargo: {error}");
            ExitCode::FAILURE
        }
    }
}
