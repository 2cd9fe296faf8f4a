//! Instruction counts of the stages, by valgrind's callgrind: the same for the same program,
//! whatever else the machine does, and so what regressions are checked by.
//!
//! The program runs itself under callgrind, which ends one part of its output at each call of
//! [`mark`]. Callgrind knows no AVX-512: the widest level there is AVX2.

use std::collections::BTreeMap;
use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;

use renderer::frame::{Frame, Goal, Shot};
use renderer::method::Method;
use serde::{Deserialize, Serialize};
use shadowmap_core::{Level, Threads};

use super::machine::compiler;
use super::options::Purpose;
use super::setup::Setup;

/// The argument with which the program runs itself.
pub const CHILD: &str = "--count-instructions";

/// How much more than the recorded count is a regression.
const TOLERANCE: f64 = 1.03;

/// What to do where the record does not hold.
const BLESS: &str = "To record the counts of now: cargo xtask bench --bless";

/// Side of the camera's picture and of the light maps.
const SIDE: u32 = 256;

/// What is counted: scene and method.
const FRAMES: [(&str, Method); 6] = [
    ("torus", Method::Search),
    ("crowded", Method::Search),
    ("torus", Method::Skins),
    ("crowded", Method::Skins),
    ("torus", Method::Intervals),
    ("crowded", Method::Intervals),
];

/// A frame up to this stage.
const GOALS: [(&str, Goal); 4] = [
    ("to the camera's pass", Goal::Camera),
    ("to the first light map", Goal::LightMap),
    ("to visibility", Goal::Visibility),
    ("to the picture", Goal::Srgb),
];

/// Counts by name, and the compiler that they hold for.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
struct Counts {
    compiler: String,
    instructions: BTreeMap<String, u64>,
}

/// Prints the counts beside the recorded ones.
///
/// # Errors
///
/// If callgrind cannot be run, or, to be checked, for a regression or without a record.
pub fn run(purpose: Purpose) -> Result<(), String> {
    let record = Path::new(env!("CARGO_MANIFEST_DIR")).join("instructions.json");
    let recorded = match (read(&record), purpose) {
        (Err(why), Purpose::Check) => return Err(format!("{why}\n{BLESS}")),
        (recorded, _) => recorded.unwrap_or_default(),
    };
    let counts = count()?;
    let mut regressions = Vec::new();
    for (name, &now) in &counts.instructions {
        let millions = now as f64 * 1e-6;
        let Some(&then) = recorded.instructions.get(name) else {
            println!("{millions:>12.3} M instructions  new     {name}");
            continue;
        };
        let ratio = now as f64 / then as f64;
        println!("{millions:>12.3} M instructions  x{ratio:.3}  {name}");
        if ratio > TOLERANCE {
            regressions.push(format!("{name}: x{ratio:.3}"));
        }
    }
    if purpose == Purpose::Record {
        let json = serde_json::to_string_pretty(&counts).expect("counts are plain data");
        fs::write(&record, json + "\n").map_err(|e| format!("{}: {e}", record.display()))?;
        println!("written: {}", record.display());
    } else if recorded.compiler != counts.compiler {
        println!(
            "NOT CHECKED: the record is of {}, this is {}. {BLESS}",
            recorded.compiler, counts.compiler
        );
    } else if purpose == Purpose::Check && !regressions.is_empty() {
        return Err(format!(
            "more instructions than recorded:\n{}\n{BLESS}",
            regressions.join("\n")
        ));
    }
    Ok(())
}

fn read(record: &Path) -> Result<Counts, String> {
    let text = fs::read_to_string(record).map_err(|e| format!("{}: {e}", record.display()))?;
    serde_json::from_str(&text).map_err(|e| format!("{}: {e}", record.display()))
}

/// Runs this program under callgrind and reads what it wrote.
fn count() -> Result<Counts, String> {
    let folder = std::env::temp_dir().join(format!("penumbra-callgrind-{}", std::process::id()));
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let counts = count_in(&folder);
    fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    counts
}

fn count_in(folder: &Path) -> Result<Counts, String> {
    let program = std::env::current_exe().map_err(|e| format!("this program's file: {e}"))?;
    let output = Command::new("valgrind")
        .arg("--tool=callgrind")
        .arg("--dump-after=measure::bench::instructions::mark*")
        .arg(format!("--callgrind-out-file={}", folder.join("out").display()))
        .arg(program)
        .args(["bench", CHILD])
        .output()
        .map_err(|e| format!("valgrind: {e} (Debian's package `valgrind` has it)"))?;
    if !output.status.success() {
        return Err(format!("valgrind:\n{}", String::from_utf8_lossy(&output.stderr)));
    }
    let names = String::from_utf8_lossy(&output.stdout);
    let mut instructions = BTreeMap::new();
    for (index, name) in names.lines().enumerate() {
        // The parts of the output between two marks alternate with those before a first one.
        let path = PathBuf::from(format!("{}.{}", folder.join("out").display(), 2 * index + 2));
        let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let total = text.lines().find_map(|line| line.strip_prefix("totals: "));
        let total = total.or_else(|| text.lines().find_map(|line| line.strip_prefix("summary: ")));
        let total = total.and_then(|total| total.trim().parse().ok());
        instructions.insert(name.to_owned(), total.ok_or(format!("{name}: no count"))?);
    }
    Ok(Counts { compiler: compiler(), instructions })
}

/// What runs under callgrind: every frame twice, the second time counted, and its name printed.
pub fn child() {
    for level in [Level::SCALAR, Level::detect()] {
        for (scene, method) in FRAMES {
            let samples = (method != Method::Search).then_some(2);
            let setup = Setup { scene, method, camera: SIDE, map: SIDE, samples };
            setup.with_shot(|shot| {
                let mut frame = Frame::new(level, Threads::One);
                frame.render(shot);
                for (stage, goal) in GOALS {
                    mark();
                    frame.render(&Shot { goal, ..*shot });
                    mark();
                    println!("{scene}, {method}, {}: {stage}", level.kind().name());
                }
            });
        }
    }
}

/// Where callgrind ends a part of its output.
#[inline(never)]
fn mark() {
    black_box(());
}
