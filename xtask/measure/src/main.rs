//! Measurements of the workspace: `cargo xtask bench` and `cargo xtask figures` run this program.

mod bench;
mod compare;
mod figures;
mod page;
mod picture;
mod plot;
mod readme;

use std::process::ExitCode;

const HELP: &str = "measure bench [options] | measure figures [options]";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let command = arguments.next().unwrap_or_default();
    let rest: Vec<String> = arguments.collect();
    match command.as_str() {
        "bench" => bench::run(&rest),
        "figures" => figures::run(&rest),
        _ => {
            eprintln!("{HELP}");
            ExitCode::from(2)
        }
    }
}
