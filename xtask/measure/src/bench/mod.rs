//! `cargo xtask bench`: times every stage, checked first, variants in turn.

mod addresses;
mod area;
mod changes;
mod frame;
mod harness;
mod instructions;
mod linear;
mod machine;
mod options;
mod page;
mod progress;
mod raster;
mod rays;
mod readme;
mod report;
mod search;
mod setup;
mod single;
mod threads;

pub use harness::{Bench, Case, Group, Variant};
pub use threads::{count, on};

use std::fs;
use std::process::ExitCode;

use options::Options;

/// A part of the benchmark: its name on the command line, and its cases, fewer for a quick run.
type Part = (&'static str, fn(bool) -> Vec<Case>);

/// One part per stage, in the order of the data.
const PARTS: &[Part] = &[
    ("raster", raster::cases),
    ("search", search::cases),
    ("single", single::cases),
    ("linear", linear::cases),
    (options::README, frame::cases),
];

/// Runs the command.
pub fn run(arguments: &[String]) -> ExitCode {
    if arguments == [instructions::CHILD] {
        instructions::child();
        return ExitCode::SUCCESS;
    }
    let names: Vec<&'static str> = PARTS.iter().map(|(name, _)| *name).collect();
    let options = match Options::parse(arguments, &names) {
        Ok(options) => options,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    if let Some(purpose) = options.instructions {
        return exit(instructions::run(purpose));
    }
    addresses::fix(arguments);
    exit(time(&options, &names))
}

/// Times the parts that the options ask for. What can be wrong with the options is found out first.
fn time(options: &Options, names: &[&'static str]) -> Result<(), String> {
    let earlier = options.compare.as_deref().map(changes::read).transpose()?;
    fs::create_dir_all(&options.folder)
        .map_err(|e| format!("{}: {e}", options.folder.display()))?;
    let chosen = |name: &str| options.parts.is_empty() || options.parts.iter().any(|p| p == name);
    let parts = PARTS.iter().filter(|(name, _)| chosen(name));
    let plan: Vec<(&str, Vec<Case>)> =
        parts.map(|(name, cases)| (*name, cases(options.quick))).collect();
    let comparisons = plan.iter().flat_map(|(_, cases)| cases).map(Case::comparisons).sum();
    let mut bench = Bench::new(options.quick, comparisons);
    for (name, cases) in plan {
        for case in cases {
            bench.run(name, case);
        }
    }
    report::write(&bench.finish(), earlier.as_ref(), names, options)
}

fn exit(result: Result<(), String>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("bench: {message}");
            ExitCode::FAILURE
        }
    }
}
