//! Tables of the README that commands write, each between two marks.

use std::path::Path;

/// Replaces what stands between the marks of the table of that `name` in the README.
///
/// # Errors
///
/// If the file or its marks are missing.
pub fn replace(name: &str, table: &str) -> Result<(), String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../README.md");
    let place = path.display();
    let [begin, end] = ["begin", "end"].map(|edge| format!("<!-- {edge} of the {name} table -->"));
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{place}: {error}"))?;
    let (head, rest) = text.split_once(&begin).ok_or(format!("{place}: no `{begin}`"))?;
    let (_, tail) = rest.split_once(&end).ok_or(format!("{place}: no `{end}`"))?;
    let text = format!("{head}{begin}\n{table}{end}{tail}");
    std::fs::write(&path, text).map_err(|error| format!("{place}: {error}"))
}
