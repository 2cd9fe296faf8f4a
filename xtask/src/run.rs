//! Running other programs.

use std::path::PathBuf;
use std::process::Command;
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

/// Runs one step in the workspace's root, says how it went and how long it took.
pub fn step(name: &str, command: &mut Command) -> bool {
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
    passed
}

/// A cargo command, split at spaces.
pub fn cargo_command(arguments: &str) -> Command {
    let mut command = Command::new(cargo());
    command.args(arguments.split_whitespace());
    command
}

/// Whether a hosted check runs us: what is skipped elsewhere is an error there.
pub fn in_ci() -> bool {
    std::env::var("CI").is_ok_and(|value| value == "true" || value == "1")
}
