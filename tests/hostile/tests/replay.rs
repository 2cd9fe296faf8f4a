//! All checks on their seeds, on broken seeds and on random bytes: the same in every run.

use std::fs;
use std::io::Write as _;
use std::panic::{catch_unwind, resume_unwind};
use std::path::Path;

use hostile::{Check, Random};

/// Broken seeds per check; the environment variable `PENUMBRA_CASES` asks for more.
const CASES: usize = 1000;

/// Runs one case; what breaks a promise is kept, to become a regression.
fn run(check: &Check, case: &[u8]) {
    let Err(cause) = catch_unwind(|| (check.run)(case)) else { return };
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(check.name);
    fs::write(&path, case).unwrap();
    let _ = writeln!(std::io::stderr(), "the case is in {}", path.display());
    resume_unwind(cause);
}

fn replay(name: &str) {
    let check = hostile::named(name);
    let seeds = (check.seeds)();
    for case in seeds.iter().chain(&regressions(name)) {
        run(&check, case);
    }
    let cases = std::env::var("PENUMBRA_CASES").ok();
    let mut random = Random(0);
    for _ in 0..cases.map_or(CASES, |text| text.parse().expect("a number of cases")) {
        run(&check, &broken(&check, &seeds, &mut random));
    }
}

/// What fuzzing found: see fuzz/README.md.
fn regressions(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("regressions").join(name);
    let Ok(files) = fs::read_dir(folder) else { return Vec::new() };
    files.map(|file| fs::read(file.unwrap().path()).unwrap()).collect()
}

/// A seed with a few bytes changed, cut, or new bytes altogether.
fn broken(check: &Check, seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let is_structured = check.name != "gltf" && check.name != "obj" && check.name != "buffers";
    if is_structured && random.below(4) > 0 {
        let count = random.below(600);
        return random.bytes(count);
    }
    let mut bytes = seeds[random.below(seeds.len())].clone();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        match random.below(6) {
            0 => bytes.truncate(at + 1),
            1 => bytes[at] ^= 1 << random.below(8),
            _ => bytes[at] = random.below(256) as u8,
        }
    }
    bytes
}

macro_rules! replayed {
    ($($name:ident)*) => {
        $(#[test] fn $name() { replay(stringify!($name)); })*

        #[test]
        fn every_check_is_replayed() {
            let replayed = [$(stringify!($name)),*];
            for check in hostile::CHECKS {
                assert!(replayed.contains(&check.name), "{}", check.name);
            }
            let _ = writeln!(std::io::stderr(), "covered: {} checks of {CASES} cases or more", replayed.len());
        }
    };
}

replayed! {
    gltf gltf_edits obj buffers raster search single_sample skins intervals frame foreign
}
