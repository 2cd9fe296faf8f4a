//! The recorded hashes, and what became of them.
//!
//! This file needs nothing of the crate: `cargo xtask verify` contains it as well, so that it and
//! the tests judge by the same rule.

use std::collections::BTreeMap;

/// Hashes by item.
pub type Column = BTreeMap<String, String>;

/// What to do where all agree on new hashes.
pub const BLESS: &str =
    "If results were meant to change, record them: cargo xtask verify --here --bless";

/// Reads lines `item<TAB>hash`.
#[must_use]
pub fn column(lines: &str) -> Column {
    let pairs = lines.lines().filter_map(|line| line.split_once('\t'));
    pairs.map(|(item, hash)| (item.to_owned(), hash.to_owned())).collect()
}

/// One line per item that `found` has and that is recorded with another hash or not at all.
#[must_use]
pub fn drifted(recorded: &Column, found: &Column) -> Vec<String> {
    let mut lines = Vec::new();
    for (item, hash) in found {
        match recorded.get(item) {
            Some(old) if old == hash => {}
            Some(old) => lines.push(format!("{item}: {hash}, recorded is {old}")),
            None => lines.push(format!("{item}: {hash}, not recorded")),
        }
    }
    lines
}

/// One line per item that is recorded and that `found`, which should have all, lacks.
#[must_use]
pub fn lost(recorded: &Column, found: &Column) -> Vec<String> {
    let lost = recorded.keys().filter(|item| !found.contains_key(*item));
    lost.map(|item| format!("{item}: recorded, but no longer made")).collect()
}
