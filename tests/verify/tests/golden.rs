//! The hashes of this machine against those in the repository, at every level it has.

use std::io::Write as _;

use shadowmap_core::{Level, Threads};
use verify::golden::{BLESS, column, drifted, lost};

#[test]
fn hashes_are_golden_at_every_level_with_any_threads() {
    let recorded = column(include_str!("../golden.tsv"));
    for level in Level::available() {
        // Past the test harness, which swallows what passing tests print.
        let _ = writeln!(std::io::stderr(), "golden hashes: level {}", level.kind().name());
        for threads in [Threads::One, Threads::Pool] {
            let found = column(&verify::table(level, threads));
            let mut changes = drifted(&recorded, &found);
            changes.extend(lost(&recorded, &found));
            let level = level.kind().name();
            assert!(changes.is_empty(), "{level} {threads:?}:\n{}\n{BLESS}", changes.join("\n"));
        }
    }
}

#[test]
fn a_changed_a_new_and_a_lost_item_are_named() {
    let recorded = column("same\t1\nchanged\t2\nlost\t3\n");
    let found = column("same\t1\nchanged\t4\nnew\t5\n");
    assert_eq!(drifted(&recorded, &found), ["changed: 4, recorded is 2", "new: 5, not recorded"]);
    assert_eq!(lost(&recorded, &found), ["lost: recorded, but no longer made"]);
}
