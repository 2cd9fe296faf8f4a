//! Results as one page with tables and plots that needs nothing else.

use maud::{Markup, html};

use super::harness::{Record, Results};
use super::machine::Machine;
use crate::page::{Section, page, table};
use crate::plot::{Axes, Curve, Scale, Stroke, plot};

/// Above this share of what the machine can move or compute, that is what bounds a stage. Below it,
/// what is left is neither: waiting for results, branches, and work beyond the least.
const BOUND: f64 = 0.5;

/// The work of a search.
const QUERIES: &str = "queries";

/// The page.
pub fn html(results: &Results, parts: &[&'static str]) -> String {
    let machine = &results.machine;
    let introduction = html! {
        p {
            (machine.cpu) ", " (machine.threads) " threads, levels " (machine.levels.join(", ")) ", "
            (machine.compiler) ". One thread copies " (format!("{:.0}", machine.bandwidth * 1e-9))
            " GB/s within 8 MiB, read and written bytes together, and makes "
            (format!("{:.0}", machine.peak * 1e-9))
            " Gop/s, multiplications and additions of 32-bit floats at the widest level. Where the "
            "least that a run must move or compute is known, the tables say what share of that it "
            "reaches per thread; where it is less than half of either, neither bounds it but what "
            "comes on top: waiting for results, branches, other instructions."
        }
        p {
            "What is timed is frame after frame: every result was checked first; then the variants "
            "of a group ran in turn, round by round, each until caches and threads were warm and "
            "then for 10 ms or more, of which the median was kept. Times are medians over the "
            "rounds with their quartiles, and a ratio is the median over the rounds of the time "
            "relative to the group's first variant. Two threads keep to two cores."
            @if machine.fixed_addresses {
                " Program and memory lie at the same addresses in every run."
            } @else {
                " Program and memory lie at other addresses in every run, which alone can change "
                "a ratio by 5 %."
            }
            @if results.quick { " This was a quick run: fewer sizes, fewer rounds." }
        }
    };
    let measured = |part: &&&str| results.records.iter().any(|record| record.part == **part);
    let sections: Vec<Section> = parts
        .iter()
        .filter(measured)
        .map(|part| Section {
            id: part,
            title: (*part).to_owned(),
            body: section(results, part),
            pictures: Vec::new(),
        })
        .collect();
    page("Benchmarks", &introduction, &sections)
}

fn section(results: &Results, part: &str) -> Markup {
    let records: Vec<&Record> = results.records.iter().filter(|r| r.part == part).collect();
    let head = [
        "group",
        "variant",
        "median, ms",
        "quartiles, ms",
        "ratio",
        "rate",
        "least work per thread",
    ];
    let rows: Vec<Vec<String>> = records
        .iter()
        .map(|record| {
            let [low, high] = record.quartiles_ms;
            vec![
                record.group.clone(),
                record.variant.clone(),
                format!("{:.4}", record.median_ms),
                format!("{low:.4} to {high:.4}"),
                format!("{:.3}", record.ratio),
                rate(record),
                bound(record, &results.machine),
            ]
        })
        .collect();
    let notes = results.notes.iter().filter_map(|note| note.strip_prefix(&format!("{part}: ")));
    html! {
        div.plots { @for plot in plots(results, &records) { (plot) } }
        @for note in notes { p { (note) } }
        @for counted in results.tables.iter().filter(|counted| counted.part == part) {
            h3 { (counted.title) }
            (table(&counted.head, &counted.rows))
        }
        details { summary { "All " (rows.len()) " figures" } (table(&head, &rows)) }
    }
}

/// Units of work per second.
pub fn rate(record: &Record) -> String {
    record.work.as_ref().map_or(String::new(), |(count, unit)| {
        let rate = count / record.median_ms * 1e3;
        if rate >= 1e6 {
            format!("{:.1} M{unit}/s", rate * 1e-6)
        } else {
            format!("{rate:.1} {unit}/s")
        }
    })
}

/// What a run must at least move and compute per second and thread, and which of both bounds it.
fn bound(record: &Record, machine: &Machine) -> String {
    let per_second = |amount: f64| amount / record.median_ms * 1e3 / f64::from(record.threads);
    let [bytes, operations] = [record.least.bytes, record.least.operations].map(per_second);
    let shares = [bytes / machine.bandwidth, operations / machine.peak];
    if shares == [0.0; 2] {
        return String::new();
    }
    let (what, amount, share) = if shares[0] > shares[1] {
        ("memory", format!("{:.1} GB/s", bytes * 1e-9), shares[0])
    } else {
        ("arithmetic", format!("{:.1} Gop/s", operations * 1e-9), shares[1])
    };
    let by = if share > BOUND { what } else { "neither" };
    format!("{amount}, {:.0} % of what {what} allows: bound by {by}", share * 1e2)
}

/// A group's name without the number at its end, which is its place in the plot.
fn series(record: &Record) -> &str {
    let name = record.group.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.');
    name.trim_end_matches([' ', ':', '=', ','])
}

/// One plot per name and abscissa that has at least two points.
fn plots(results: &Results, records: &[&Record]) -> Vec<Markup> {
    let mut seen: Vec<(&str, &str)> = Vec::new();
    for record in records {
        if let Some((quantity, _)) = &record.x
            && !seen.contains(&(series(record), quantity))
        {
            seen.push((series(record), quantity));
        }
    }
    let plots = seen.into_iter().filter_map(|(name, quantity)| {
        let of_plot = |record: &&&Record| {
            series(record) == name && record.x.as_ref().is_some_and(|(own, _)| own == quantity)
        };
        let records: Vec<&Record> = records.iter().filter(of_plot).copied().collect();
        one_plot(&results.machine.levels, &records, name, quantity)
    });
    plots.collect()
}

fn one_plot(levels: &[String], records: &[&Record], name: &str, quantity: &str) -> Option<Markup> {
    let mut curves: Vec<Curve> = Vec::new();
    let mut ordinate = "time, ms";
    for record in records {
        let Some((_, x)) = record.x else { continue };
        let point = match &record.work {
            // As many as fit the time: what counts is the time of one.
            Some((count, unit)) if unit == QUERIES => {
                ordinate = "time per query, ns";
                (x, record.median_ms * 1e6 / count)
            }
            _ => (x, record.median_ms),
        };
        match curves.iter_mut().find(|curve| curve.name == record.variant) {
            Some(curve) => curve.points.push(point),
            None => {
                let curve = Curve::new(&*record.variant, Stroke::Marked, vec![point]);
                curves.push(Curve { family: family(levels, &record.variant), ..curve });
            }
        }
    }
    let mut xs = curves.iter().flat_map(|curve| &curve.points).map(|(x, _)| *x);
    let scale = if xs.all(|x| x > 0.0 && x.log2().fract() == 0.0) {
        Scale::Doubling
    } else {
        Scale::LogarithmicY
    };
    let drawable = curves.iter().any(|curve| curve.points.len() > 1);
    let axes = Axes { x: quantity, y: ordinate, scale };
    drawable.then(|| html! { div { h3 { (name) } (plot(axes, &curves)) } })
}

/// Variants of one level are of one family, and those that differ in a number.
fn family(levels: &[String], variant: &str) -> String {
    let words = || variant.split([' ', ',']);
    match words().find(|word| levels.iter().any(|level| level == word)) {
        Some(level) => level.to_owned(),
        None => words().filter(|word| word.parse::<f64>().is_err()).collect(),
    }
}
