//! Running other programs, and telling what came of them.

use std::path::PathBuf;
use std::process::{Command, ExitCode};
use std::time::Instant;

/// The cargo that runs us.
pub fn cargo() -> String {
    std::env::var("CARGO").unwrap_or_else(|_| "cargo".into())
}

/// The root of the workspace.
pub fn root() -> PathBuf {
    let manifest = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().expect("xtask lies in the workspace").to_owned()
}

/// A cargo command, split at spaces.
pub fn cargo_command(arguments: &str) -> Command {
    let mut command = Command::new(cargo());
    command.args(arguments.split_whitespace());
    command
}

/// Whether `--full` is asked for; `None` for any other argument.
pub fn only_full(arguments: &[String]) -> Option<bool> {
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => Some(false),
        ["--full"] => Some(true),
        _ => None,
    }
}

/// Whether every tool must be there, as on the hosted machines: what is skipped elsewhere is then
/// an error.
pub fn skips_are_errors() -> bool {
    std::env::var_os("PENUMBRA_NO_SKIPS").is_some()
}

/// What came of the steps so far. No step stops the others, so that one run shows all.
#[derive(Debug, Default)]
pub struct Report {
    passed: usize,
    failed: Vec<String>,
    skipped: Vec<String>,
}

impl Report {
    /// Runs one step in the workspace's root, says how it went and how long it took.
    pub fn step(&mut self, name: &str, command: &mut Command) -> bool {
        println!("==> {name}");
        let start = Instant::now();
        let passed = match command.current_dir(root()).status() {
            Ok(status) => status.success(),
            Err(error) => {
                println!("    cannot run {:?}: {error}", command.get_program());
                false
            }
        };
        let seconds = start.elapsed().as_secs_f32();
        println!("    {name}: {} ({seconds:.1} s)", if passed { "passed" } else { "FAILED" });
        self.outcome(name, passed);
        passed
    }

    /// Notes how a step went that was run elsewhere.
    pub fn outcome(&mut self, name: &str, passed: bool) {
        if passed {
            self.passed += 1;
        } else {
            self.failed.push(name.to_owned());
        }
    }

    /// Notes what is wrong.
    pub fn failed(&mut self, what: &str) {
        println!("==> {what}: FAILED");
        self.failed.push(what.to_owned());
    }

    /// Notes a step for which something is missing that can be had.
    pub fn skipped(&mut self, name: &str, missing: &str) {
        println!("==> {name}\n    SKIPPED: {missing}");
        if skips_are_errors() {
            self.failed.push(format!("{name} (skipped)"));
        } else {
            self.skipped.push(name.to_owned());
        }
    }

    /// Notes a step that cannot run here, and what stands in for it.
    pub fn not_run(&mut self, name: &str, why: &str) {
        println!("==> {name}\n    SKIPPED: {why}");
        self.skipped.push(name.to_owned());
    }

    /// The last words of a command.
    pub fn finish(self, command: &str) -> ExitCode {
        if !self.skipped.is_empty() {
            println!("{command}: SKIPPED: {}", self.skipped.join(", "));
        }
        if self.failed.is_empty() {
            println!("{command}: all {} steps that ran passed", self.passed);
            return ExitCode::SUCCESS;
        }
        println!("{command}: FAILED: {}", self.failed.join(", "));
        ExitCode::FAILURE
    }
}
