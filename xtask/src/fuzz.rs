//! `cargo xtask fuzz`: all fuzz targets for a given time, and what each of them executed.

use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};

use crate::run::{Report, root};

const HELP: &str = "\
cargo xtask fuzz [--seconds N] [TARGET...]

Fuzzes every target, or the named ones, for N seconds each (by default 15), one after another.
Needs the nightly toolchain and cargo-fuzz. Findings are written to fuzz/artifacts, logs to
fuzz/target/logs.";

/// Seconds per target.
const SECONDS: u32 = 15;

/// Runs the command.
pub fn run(arguments: &[String]) -> ExitCode {
    let mut seconds = SECONDS;
    let mut chosen = Vec::new();
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        let value = |next: Option<&String>| next.and_then(|text| text.parse().ok());
        match argument.as_str() {
            "--seconds" => match value(rest.next()) {
                Some(number) => seconds = number,
                None => return usage(),
            },
            name if !name.starts_with('-') => chosen.push(name.to_owned()),
            _ => return usage(),
        }
    }
    let targets = targets(&root().join("fuzz"));
    if let Some(unknown) = chosen.iter().find(|name| !targets.contains(name)) {
        println!("fuzz: no target `{unknown}`; there are {}", targets.join(", "));
        return ExitCode::from(2);
    }
    match missing() {
        Some(missing) => {
            println!("fuzz: {missing}");
            ExitCode::FAILURE
        }
        None if fuzz(seconds, &chosen) => ExitCode::SUCCESS,
        None => ExitCode::FAILURE,
    }
}

fn usage() -> ExitCode {
    println!("{HELP}");
    ExitCode::from(2)
}

/// What is needed and not there.
pub fn missing() -> Option<&'static str> {
    let runs = |program: &str, arguments: &[&str]| {
        Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success())
    };
    if !runs("rustc", &["+nightly", "--version"]) {
        return Some("needs the nightly toolchain");
    }
    if !runs("cargo", &["fuzz", "--version"]) {
        return Some("needs cargo-fuzz (cargo install cargo-fuzz --locked)");
    }
    None
}

/// Fuzzes the chosen targets, all if none is chosen. False if one found something.
pub fn fuzz(seconds: u32, chosen: &[String]) -> bool {
    let folder = root().join("fuzz");
    let seed = ["run", "--quiet", "--release", "--bin", "seed"];
    let mut report = Report::default();
    let build = ["+nightly", "fuzz", "build", "--fuzz-dir"];
    if !report.step("fuzz: corpora", Command::new("cargo").args(seed).args(in_folder(&folder)))
        || !report.step("fuzz: build", Command::new("cargo").args(build).arg(&folder))
    {
        return false;
    }
    let mut sound = true;
    for target in targets(&folder) {
        if chosen.is_empty() || chosen.contains(&target) {
            sound &= one(&folder, &target, seconds);
        }
    }
    sound
}

fn in_folder(folder: &Path) -> [String; 2] {
    ["--manifest-path".to_owned(), folder.join("Cargo.toml").display().to_string()]
}

fn targets(folder: &Path) -> Vec<String> {
    let files = fs::read_dir(folder.join("fuzz_targets")).into_iter().flatten().flatten();
    let mut names: Vec<String> = files
        .filter_map(|file| Some(file.path().file_stem()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    names
}

/// Fuzzes one target and says how many executions it had.
fn one(folder: &Path, target: &str, seconds: u32) -> bool {
    let [corpus, artifacts] = ["corpus", "artifacts"].map(|name| folder.join(name).join(target));
    let logs = folder.join("target/logs");
    for folder in [&corpus, &artifacts, &logs] {
        let _ = fs::create_dir_all(folder);
    }
    let program = folder.join("target/x86_64-unknown-linux-gnu/release").join(target);
    let mut command = Command::new(program);
    command.arg(&corpus).arg(format!("-max_total_time={seconds}"));
    command.arg(format!("-artifact_prefix={}/", artifacts.display()));
    // A hang is a minute: machines that pause are not taken for one.
    command.args(["-timeout=60", "-rss_limit_mb=4096", "-print_final_stats=1", "-verbosity=1"]);
    let dictionary = folder.join("dictionaries").join(format!("{target}.dict"));
    if dictionary.exists() {
        command.arg(format!("-dict={}", dictionary.display()));
    }
    let output = match command.env("ASAN_OPTIONS", "detect_odr_violation=0").output() {
        Ok(output) => output,
        Err(error) => {
            println!("    {target}: cannot run it: {error}");
            return false;
        }
    };
    let log = String::from_utf8_lossy(&output.stderr);
    let path = logs.join(format!("{target}.log"));
    if let Err(error) = fs::write(&path, log.as_bytes()) {
        println!("    {}: {error}", path.display());
    }
    let figure = |name: &str| {
        let line = log.lines().rev().find_map(|line| line.strip_prefix(name));
        line.map_or("?", str::trim).to_owned()
    };
    let executions = figure("stat::number_of_executed_units:");
    let verdict = if output.status.success() { "no finding" } else { "FOUND SOMETHING" };
    println!("    {target}: {executions} executions in {seconds} s, {verdict}");
    if !output.status.success() {
        println!("    see {} and {}", path.display(), artifacts.display());
    }
    output.status.success()
}
