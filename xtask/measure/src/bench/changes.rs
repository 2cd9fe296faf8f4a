//! What changed against earlier results.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use super::harness::{Record, Results};

/// Smaller changes are those of the machine's mood.
const NOTABLE: f64 = 1.05;

/// Reads the `bench.json` of an earlier run.
///
/// # Errors
///
/// If there is none; the message names the file and says where to get one.
pub fn read(path: &Path) -> Result<Results, String> {
    let place = path.display();
    let hint = "--compare takes the bench.json of an earlier `cargo xtask bench --out DIR`";
    let text = fs::read_to_string(path).map_err(|e| format!("{place}: {e}\n{hint}"))?;
    serde_json::from_str(&text).map_err(|e| format!("{place} holds no results: {e}\n{hint}"))
}

/// One figure then and now.
struct Change<'a> {
    then: &'a Record,
    now: &'a Record,
}

impl Change<'_> {
    fn time(&self) -> f64 {
        self.now.median_ms / self.then.median_ms
    }

    fn ratio(&self) -> f64 {
        self.now.ratio / self.then.ratio
    }
}

/// The changes, largest first, after what limits their meaning.
pub fn text(then: &Results, now: &Results) -> String {
    let found: Vec<Change<'_>> = now
        .records
        .iter()
        .filter_map(|now| Some(Change { then: then.records.iter().find(|r| same(r, now))?, now }))
        .collect();
    let mut text = "\nagainst the earlier results\n".to_owned();
    for (what, then, now) in [
        ("processor", &then.machine.cpu, &now.machine.cpu),
        ("compiler", &then.machine.compiler, &now.machine.compiler),
    ] {
        if then != now {
            text += &format!("  another {what} then: {then}\n");
        }
    }
    let new = now.records.len() - found.len();
    let lost = then.records.iter().filter(|then| !now.records.iter().any(|now| same(then, now)));
    text +=
        &format!("  {} figures in both, {new} new, {} not timed now\n", found.len(), lost.count());
    if found.is_empty() {
        return text + "  nothing to compare: the earlier results are of other parts\n";
    }
    let relative =
        found.iter().filter(|change| change.now.ratio != 1.0 || change.then.ratio != 1.0);
    let ratios: Vec<f64> = relative.map(|change| size(change.ratio())).collect();
    let held = ratios.iter().filter(|ratio| **ratio <= NOTABLE).count();
    text += &format!("  {held} of {} ratios within a group are within 5 %\n", ratios.len());
    text + &table(found)
}

fn same(a: &Record, b: &Record) -> bool {
    (&a.part, &a.group, &a.variant) == (&b.part, &b.group, &b.variant)
}

/// How large a change by this factor is, up or down.
fn size(factor: f64) -> f64 {
    factor.max(1.0 / factor)
}

fn table(mut changes: Vec<Change<'_>>) -> String {
    changes.retain(|change| size(change.time()) > NOTABLE || size(change.ratio()) > NOTABLE);
    if changes.is_empty() {
        return "  no time and no ratio changed by more than 5 %\n".to_owned();
    }
    changes.sort_by(|a, b| size(b.time()).total_cmp(&size(a.time())));
    let mut text = "\n  time now / then, the same of the ratio, time then -> now\n".to_owned();
    for change in changes {
        let Change { then, now } = &change;
        writeln!(
            text,
            "  x{:<6.3} x{:<6.3} {:.4} -> {:.4} ms  {} {}: {}",
            change.time(),
            change.ratio(),
            then.median_ms,
            now.median_ms,
            now.part,
            now.group,
            now.variant
        )
        .expect("strings take all that is written");
    }
    text
}
