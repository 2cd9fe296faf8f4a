//! `cargo xtask bench`: times every stage, checked first, variants in turn.

mod area;
mod frame;
mod harness;
mod instructions;
mod linear;
mod machine;
mod options;
mod page;
mod raster;
mod readme;
mod report;
mod search;
mod single;

pub use harness::{Bench, Group, Variant};

use std::process::ExitCode;

use options::Options;

/// A part of the benchmark: its name on the command line, and what runs it.
type Part = (&'static str, fn(&mut Bench));

/// One part per stage, in the order of the data.
const PARTS: &[Part] = &[
    ("raster", raster::run),
    ("search", search::run),
    ("single", single::run),
    ("linear", linear::run),
    ("frame", frame::run),
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
    let mut bench = Bench::new(options.quick);
    for (name, part) in PARTS {
        if options.parts.is_empty() || options.parts.iter().any(|chosen| chosen == name) {
            bench.begin_part(name);
            part(&mut bench);
        }
    }
    let results = bench.finish();
    exit(report::write(&results, &names, &options))
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
