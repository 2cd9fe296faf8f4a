//! What some tests need and this repository does not have.

use std::env;
use std::fmt::Display;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The folder of the public models, or `None`, said aloud, where a clone does not have it.
#[must_use]
pub fn public_models() -> Option<PathBuf> {
    let folder = env::var_os("PENUMBRA_SCENES").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes"),
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    skipped(format_args!("no public models in {} (PENUMBRA_SCENES)", folder.display()));
    None
}

/// Says that a test cannot run here, and why.
pub fn skipped(why: impl Display) {
    // Past the test harness, which swallows what passing tests print.
    let _ = writeln!(std::io::stderr(), "SKIPPED: {why}");
}
