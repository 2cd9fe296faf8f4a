//! Results as a table, as JSON and as a page.

use std::fs;

use super::harness::Results;
use super::options::Options;
use super::{page, readme};

/// Prints the table and writes `bench.json` and `bench.html` into the folder of the options.
///
/// # Errors
///
/// If a file cannot be read or written; the message names it.
pub fn write(results: &Results, parts: &[&'static str], options: &Options) -> Result<(), String> {
    print!("{}", table(results));
    if let Some(path) = &options.compare {
        let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let old = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        print!("{}", changes(&old, results));
    }
    fs::create_dir_all(&options.folder)
        .map_err(|e| format!("{}: {e}", options.folder.display()))?;
    let path = options.folder.join("bench.json");
    let json = serde_json::to_string_pretty(results).expect("results are plain data");
    fs::write(&path, json).map_err(|e| format!("{}: {e}", path.display()))?;
    println!("\nwritten: {}", path.display());
    let path = options.folder.join("bench.html");
    fs::write(&path, page::html(results, parts)).map_err(|e| format!("{}: {e}", path.display()))?;
    println!("written: {}", path.display());
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
    for note in &results.notes {
        text += &format!("\n{note}");
    }
    text + "\n"
}

/// What changed against earlier results, largest change first.
fn changes(old: &Results, new: &Results) -> String {
    let mut rows: Vec<(f64, String)> = Vec::new();
    for record in &new.records {
        let same = old.records.iter().find(|earlier| {
            (&earlier.part, &earlier.group, &earlier.variant)
                == (&record.part, &record.group, &record.variant)
        });
        if let Some(earlier) = same {
            let change = record.median_ms / earlier.median_ms;
            rows.push((
                change,
                format!(
                    "  x{change:<6.3} {} {} {}: {:.4} -> {:.4} ms\n",
                    record.part, record.group, record.variant, earlier.median_ms, record.median_ms
                ),
            ));
        }
    }
    rows.sort_by(|a, b| b.0.ln().abs().total_cmp(&a.0.ln().abs()));
    let mut text = "\nchanged (time now / time then)\n".to_owned();
    text.extend(rows.into_iter().map(|(_, row)| row));
    text
}
