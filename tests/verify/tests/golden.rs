//! The hashes of this machine against those in the repository, at every level it has.

use shadowmap_core::{Level, Threads};

/// `cargo xtask verify --bless` writes them anew.
const GOLDEN: &str = include_str!("../golden.tsv");

#[test]
fn hashes_are_golden_at_every_level_with_any_threads() {
    for level in Level::available() {
        println!("covered: {}", level.kind().name());
        for threads in [Threads::One, Threads::Pool] {
            let table = verify::table(level, threads);
            let mut table: Vec<&str> = table.lines().collect();
            table.sort_unstable();
            for (found, golden) in table.iter().copied().zip(GOLDEN.lines()) {
                assert_eq!(found, golden, "{} {threads:?}", level.kind().name());
            }
            assert_eq!(table.len(), GOLDEN.lines().count());
        }
    }
}
