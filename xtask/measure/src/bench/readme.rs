//! The README's speed table, from results.

use super::harness::{Record, Results};
use super::options::README;

/// The table.
///
/// # Errors
///
/// If no frames were timed.
pub fn table(results: &Results) -> Result<String, String> {
    // Those with an abscissa are points of a plot.
    let in_table = |record: &&Record| record.part == README && record.x.is_none();
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
        "\nMedians, frame after frame, every pass anew; {}, {}, {}.\n",
        machine.cpu,
        machine.levels.last().map_or("", String::as_str),
        machine.compiler
    );
    Ok(text)
}
