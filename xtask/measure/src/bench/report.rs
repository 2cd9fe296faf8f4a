//! Results as a table, as JSON and as a page.

use std::fs;

use super::harness::{Results, Table};
use super::options::Options;
use super::{changes, page, readme};

/// Prints the table and what changed, and writes what the options ask for.
///
/// # Errors
///
/// If a file cannot be written; the message names it.
pub fn write(
    results: &Results,
    earlier: Option<&Results>,
    parts: &[&'static str],
    options: &Options,
) -> Result<(), String> {
    print!("{}", table(results));
    if let Some(earlier) = earlier {
        print!("{}", changes::text(earlier, results));
    }
    let json = serde_json::to_string_pretty(results).expect("results are plain data");
    for (name, text) in [("bench.json", json), ("bench.html", page::html(results, parts))] {
        let path = options.folder.join(name);
        fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        println!("written: {}", path.display());
    }
    if options.readme {
        crate::readme::replace("speed", &readme::table(results)?)?;
        println!("written: the speed table of README.md");
    }
    Ok(())
}

fn table(results: &Results) -> String {
    let machine = &results.machine;
    let mut text = format!(
        "{}, {} threads, {}\nlevels: {}\n",
        machine.cpu,
        machine.threads,
        machine.compiler,
        machine.levels.join(" ")
    );
    let mut group = String::new();
    for record in &results.records {
        let name = format!("{} {}", record.part, record.group);
        if name != group {
            text += &format!("\n{name}\n");
            group = name;
        }
        let [low, high] = record.quartiles_ms;
        text += &format!(
            "  {:<28} {:>10.4} ms  [{low:.4}, {high:.4}]  x{:<7.3} {}\n",
            record.variant,
            record.median_ms,
            record.ratio,
            page::rate(record)
        );
    }
    for Table { part, title, head, rows } in &results.tables {
        text += &format!("\n{part}: {title}\n");
        for cells in std::iter::once(head).chain(rows) {
            text.extend(cells.iter().map(|cell| format!("{cell:>22}")));
            text += "\n";
        }
    }
    for note in &results.notes {
        text += &format!("\n{note}");
    }
    text + "\n\n"
}
