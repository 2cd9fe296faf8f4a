//! `cargo xtask verify`: the recorded hashes at every SIMD level, thread count and target, as one
//! table.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use crate::elf::Sizes;
use crate::golden::{BLESS, Column, column, drifted, lost};
use crate::run::{Report, cargo_command, root, skips_are_errors};
use crate::targets::{AARCH64, I686, THUMB, Target, Toolchain, WASMS};

const HELP: &str = "\
cargo xtask verify [--here | --only TARGET] [--bless]

Draws the built-in scenes by every method and compares hashes of maps, visibility and pictures with
those recorded in tests/verify/golden.tsv: at every SIMD level of this machine with one thread and
with all, on AArch64 (NEON), 32-bit x86 and WebAssembly (without and with SIMD), and of a tiny render
on an emulated microcontroller.

  --here           this machine only
  --only TARGET    this machine and one of aarch64, i686, wasm32, thumbv7em
  --bless          record this machine's hashes, if all its columns agree";

/// So much of an error is shown.
const LINES: usize = 12;

/// The targets beside this machine, as the command line calls them, and how the table of each is
/// made.
const TARGETS: [(&str, &Target, Table); 5] = [
    ("aarch64", &AARCH64, program),
    ("i686", &I686, program),
    ("wasm32", &WASMS[0], module),
    ("wasm32", &WASMS[1], module),
    ("thumbv7em", &THUMB, microcontroller),
];

/// A column of the table and its name.
type Named = (String, Column);

/// Runs the command.
pub fn run(arguments: &[String]) -> ExitCode {
    let (mut only, mut bless) = (None, false);
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match (argument.as_str(), rest.as_slice().first()) {
            ("--here", _) => only = Some(""),
            ("--bless", _) => bless = true,
            ("--only", Some(name)) if TARGETS.iter().any(|(known, ..)| known == name) => {
                only = Some(name.as_str());
                rest.next();
            }
            _ => {
                println!("{HELP}");
                return ExitCode::from(2);
            }
        }
    }
    match verify(only, bless) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            println!("verify: FAILED: {why}");
            ExitCode::FAILURE
        }
    }
}

/// All targets, or all levels and threads of this machine, as a step.
pub fn check(all_targets: bool, report: &mut Report) {
    let start = Instant::now();
    let result = verify((!all_targets).then_some(""), false);
    if let Err(why) = &result {
        println!("    {why}");
    }
    println!("    verify took {:.1} s", start.elapsed().as_secs_f32());
    report.outcome("verify", result.is_ok());
}

/// Compares all targets, or this machine and the one named `only`, with what is recorded.
fn verify(only: Option<&str>, bless: bool) -> Result<(), String> {
    println!("==> verify");
    let native = output(cargo_command("run --quiet --release -p verify"))?;
    let mut columns = columns_of("", &native);
    if columns.is_empty() {
        return Err("this machine printed no hashes".to_owned());
    }
    let recorded = if bless { record(&columns)? } else { recorded()? };
    let mut skipped = Vec::new();
    let mut broken = Vec::new();
    for (name, target, table) in TARGETS {
        if only.is_some_and(|only| only != name) {
            continue;
        }
        println!("==> {}", target.name);
        let start = Instant::now();
        match Toolchain::with_tools(target) {
            Err(missing) => {
                println!("    SKIPPED: {missing}");
                skipped.push(target.name);
            }
            Ok(toolchain) => match table(&toolchain, target) {
                Ok(text) => columns.extend(columns_of(name, &text)),
                Err(why) => {
                    println!("    FAILED: {why}");
                    broken.push(target.name);
                }
            },
        }
        println!("    {:.1} s", start.elapsed().as_secs_f32());
    }
    print(&recorded, &columns);
    if !skipped.is_empty() {
        println!("verify: SKIPPED: {}", skipped.join(", "));
    }
    changes(&recorded, &columns)?;
    if !broken.is_empty() || (!skipped.is_empty() && skips_are_errors()) {
        let [broken, skipped] = [broken, skipped].map(|names| names.join(", "));
        return Err(format!("not to be run: {broken}; skipped: {skipped}"));
    }
    println!("verify: every cell of {} columns is as recorded", columns.len());
    Ok(())
}

fn golden() -> PathBuf {
    root().join("tests/verify/golden.tsv")
}

/// The recorded hashes.
fn recorded() -> Result<Column, String> {
    let path = golden();
    let text =
        fs::read_to_string(&path).map_err(|e| format!("{}: {e}\n{BLESS}", path.display()))?;
    Ok(column(&text))
}

/// Records the hashes of this machine's columns, which must agree.
fn record(columns: &[Named]) -> Result<Column, String> {
    let (first, hashes) = &columns[0];
    if let Some((odd, _)) = columns.iter().find(|(_, other)| other != hashes) {
        return Err(format!("nothing is recorded: {odd} disagrees with {first}"));
    }
    let path = golden();
    let lines = hashes.iter().map(|(item, hash)| format!("{item}\t{hash}\n"));
    let written = fs::write(&path, lines.collect::<String>());
    written.map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(hashes.clone())
}

/// Fails where a cell is not as recorded: says which, and what that means.
fn changes(recorded: &Column, columns: &[Named]) -> Result<(), String> {
    let (first, here) = &columns[0];
    let agrees = |other: &Column| other.iter().all(|(item, hash)| here.get(item) == Some(hash));
    let odd = columns.iter().find(|(_, other)| !agrees(other));
    let mut changes = lost(recorded, here);
    let end = match odd {
        None => {
            changes.extend(drifted(recorded, here));
            format!("All columns agree on that. {BLESS}")
        }
        Some((odd, _)) => {
            for (name, column) in columns {
                let drifted = drifted(recorded, column).into_iter();
                changes.extend(drifted.map(|change| format!("{name}: {change}")));
            }
            format!("{odd} disagrees with {first}: a level, a thread count or a target is at fault")
        }
    };
    if changes.is_empty() {
        return Ok(());
    }
    let mut text = format!("{} hashes are not as recorded", changes.len());
    for change in changes.iter().take(LINES) {
        text += &format!("\n    {change}");
    }
    if changes.len() > LINES {
        text += "\n    ...";
    }
    Err(format!("{text}\n{end}"))
}

/// How the table of a target is made.
type Table = fn(&Toolchain, &Target) -> Result<String, String>;

fn output(mut command: Command) -> Result<String, String> {
    let output = command.current_dir(root()).output().map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let text = String::from_utf8_lossy(&output.stderr);
    Err(format!("{}\n{}", output.status, what_failed(&text)))
}

/// The errors among what a command said, without its warnings; its last lines if it names none.
fn what_failed(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let first = lines.iter().position(|line| {
        line.starts_with("error") || line.contains("panicked at") || line.contains("cannot open")
    });
    let start = first.unwrap_or(lines.len().saturating_sub(LINES));
    lines[start..].iter().take(LINES).copied().collect::<Vec<_>>().join("\n")
}

/// The table of a target that runs programs.
fn program(toolchain: &Toolchain, target: &Target) -> Result<String, String> {
    output(toolchain.cargo(target, "run --quiet --release -p verify"))
}

/// The table of a WebAssembly module.
fn module(toolchain: &Toolchain, target: &Target) -> Result<String, String> {
    output(toolchain.cargo(target, "build --quiet --release -p verify --lib"))?;
    let folder = toolchain.target_folder(target).join(target.triple).join("release");
    let module = folder.join("verify.wasm");
    // One function with SIMD makes a whole module need it.
    let has_simd = mentions_simd(&module)?;
    if has_simd != target.flags.contains("+simd128") {
        return Err(format!("the module {} SIMD", if has_simd { "needs" } else { "is without" }));
    }
    let mut node = Command::new("node");
    node.arg("tests/verify/run.mjs").arg(module);
    output(node)
}

/// Whether SIMD is among the features that a WebAssembly module says it uses.
fn mentions_simd(module: &Path) -> Result<bool, String> {
    let bytes = fs::read(module).map_err(|error| format!("{}: {error}", module.display()))?;
    // A sign, the length of the name, and the name.
    let feature = b"+\x07simd128";
    Ok(bytes.windows(feature.len()).any(|part| part == feature))
}

/// The one hash of the microcontroller, and what it took.
fn microcontroller(toolchain: &Toolchain, target: &Target) -> Result<String, String> {
    let manifest = "--manifest-path tests/bare-metal/Cargo.toml";
    let text = output(toolchain.cargo(target, &format!("run --quiet --release {manifest}")))?;
    let hash = text.lines().find_map(|line| line.strip_prefix("mask ")).ok_or("no hash")?;
    for line in text.lines().filter(|line| !line.starts_with("mask ")) {
        println!("    {line}");
    }
    let folder = toolchain.target_folder(target).join(target.triple).join("release");
    if let Some(Sizes { flash, ram }) = Sizes::of(&folder.join("bare-metal")) {
        println!(
            "    flash {flash} bytes; RAM {ram} bytes, of which 1048576 are set aside as heap"
        );
    }
    Ok(format!("scalar 1\ttiny mask\t{}\n", hash.trim()))
}

/// Columns by name from lines `column<TAB>item<TAB>hash`.
fn columns_of(target: &str, text: &str) -> Vec<Named> {
    let mut columns: Vec<Named> = Vec::new();
    for line in text.lines() {
        let mut cells = line.split('\t');
        if let (Some(column), Some(item), Some(hash)) = (cells.next(), cells.next(), cells.next()) {
            let name = format!("{target} {column}").trim().to_owned();
            if columns.last().is_none_or(|(last, _)| *last != name) {
                columns.push((name, Column::new()));
            }
            let (_, last) = columns.last_mut().expect("just pushed");
            last.insert(item.to_owned(), hash.to_owned());
        }
    }
    columns
}

/// Prints the table: `=` where a column is as recorded, `X` where not, `.` where it lacks the item.
fn print(recorded: &Column, columns: &[Named]) {
    for (index, (name, column)) in columns.iter().enumerate() {
        println!("column {:>2}: {name} ({} items)", index + 1, column.len());
    }
    let numbers = (1..=columns.len()).map(|number| format!("{number:>3}")).collect::<String>();
    println!("\n{:<44} {:<16}{numbers}", "", "recorded");
    for (item, hash) in recorded {
        let cell = |(_, column): &Named| match column.get(item) {
            Some(other) if other == hash => "  =",
            Some(_) => "  X",
            None => "  .",
        };
        println!("{item:<44} {hash}{}", columns.iter().map(cell).collect::<String>());
    }
    println!();
}
