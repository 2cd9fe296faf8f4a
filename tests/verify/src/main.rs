//! Prints the table of hashes, one column per SIMD level and thread count:
//! `level threads<TAB>item<TAB>hash` lines.

use shadowmap_core::{Level, Threads};

fn main() {
    for level in Level::available() {
        for (threads, name) in [(Threads::One, "1"), (Threads::Pool, "all")] {
            for line in verify::table(level, threads).lines() {
                println!("{} {name}\t{line}", level.kind().name());
            }
        }
    }
}
