//! The README's speed table, written from results.

use std::path::Path;

use super::harness::{Record, Results};

const BEGIN: &str = "<!-- speed table: cargo xtask bench frame --readme -->";
const END: &str = "<!-- end of the speed table -->";

/// Replaces the table between the two marks of the README at `path`.
///
/// # Errors
///
/// If the file or its marks are missing, or no frames were timed.
pub fn write(results: &Results, path: &Path) -> Result<(), String> {
    let name = path.display();
    let text = std::fs::read_to_string(path).map_err(|error| format!("{name}: {error}"))?;
    let (head, rest) = text.split_once(BEGIN).ok_or(format!("{name}: no `{BEGIN}`"))?;
    let (_, tail) = rest.split_once(END).ok_or(format!("{name}: no `{END}`"))?;
    let text = format!("{head}{BEGIN}\n{}{END}{tail}", table(results)?);
    std::fs::write(path, text).map_err(|error| format!("{name}: {error}"))
}

fn table(results: &Results) -> Result<String, String> {
    // Those with an abscissa are points of a plot.
    let in_table = |record: &&Record| record.part == "frame" && record.x.is_none();
    let frames: Vec<&Record> = results.records.iter().filter(in_table).collect();
    let [_, ..] = frames[..] else {
        return Err("no frames were timed: run the part `frame`".into());
    };
    let mut text = "\n| whole frame | one thread | two threads |\n|---|--:|--:|\n".to_owned();
    for pair in frames.chunks(2) {
        let cells: String = pair
            .iter()
            .map(|r| format!(" {:.2} ms ({:.0} fps) |", r.median_ms, 1e3 / r.median_ms))
            .collect();
        text += &format!("| {} |{cells}\n", pair[0].group);
    }
    let machine = &results.machine;
    text += &format!(
        "\nMedians; {}, {}, {}.\n",
        machine.cpu,
        machine.levels.last().map_or("", String::as_str),
        machine.compiler
    );
    Ok(text)
}
