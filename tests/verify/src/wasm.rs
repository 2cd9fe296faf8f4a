//! The table for JavaScript: a pointer to its text and the text's length.

use std::sync::OnceLock;

use shadowmap_core::{Level, Threads};

static TEXT: OnceLock<String> = OnceLock::new();

fn text() -> &'static str {
    TEXT.get_or_init(|| {
        let level = Level::detect();
        let name = level.kind().name();
        let table = crate::table(level, Threads::One);
        table.lines().map(|line| format!("{name} 1\t{line}\n")).collect()
    })
}

/// Where the text starts.
// SAFETY: no other symbol of the module has this name.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn table_start() -> *const u8 {
    text().as_ptr()
}

/// How many bytes it has.
// SAFETY: no other symbol of the module has this name.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn table_length() -> usize {
    text().len()
}
