//! Timing variants in turn.
//!
//! The library harnesses time one function after the other, minutes apart on a machine whose speed
//! drifts. Here all variants of a comparison run in turn, round by round, and ratios are taken
//! within a round: they hold to a few per cent where absolute times do not.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};

use super::machine::Machine;

/// One way of doing the work of a comparison.
pub struct Variant<'a> {
    name: String,
    run: Box<dyn FnMut() + 'a>,
}

impl<'a> Variant<'a> {
    /// A variant that `run` performs once per call.
    pub fn new(name: impl Into<String>, run: impl FnMut() + 'a) -> Variant<'a> {
        Variant { name: name.into(), run: Box::new(run) }
    }
}

/// What one variant of a comparison took.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Record {
    /// The part of the benchmark: `raster`, `search`, ...
    pub part: String,
    /// What is compared, e.g. `torus 1024`.
    pub group: String,
    /// The variant, e.g. `avx512`.
    pub variant: String,
    /// What groups of one name, but for the number at its end, are plotted over, and its value.
    pub x: Option<(String, f64)>,
    /// Median time of one run in milliseconds.
    pub median_ms: f64,
    /// First and third quartile in milliseconds.
    pub quartiles_ms: [f64; 2],
    /// Median over the rounds of this variant's time relative to the first variant of its group.
    pub ratio: f64,
    /// Units of work per run and their name, e.g. 1,048,576 `pixels`.
    pub work: Option<(f64, String)>,
    /// Bytes that a run must at least read and write, for the note on what bounds it.
    pub bytes: Option<f64>,
}

/// All results of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Results {
    /// Where they are from.
    pub machine: Machine,
    /// Whether fewer rounds were made.
    pub quick: bool,
    /// One record per variant.
    pub records: Vec<Record>,
    /// Remarks that the parts made, e.g. texels visited per query.
    pub notes: Vec<String>,
}

/// Collects records, and shows progress while it does.
pub struct Bench {
    quick: bool,
    part: String,
    progress: ProgressBar,
    results: Results,
}

/// A comparison to be timed.
pub struct Group<'a> {
    /// What is compared, e.g. `torus 1024`.
    pub name: String,
    /// What groups of one name, but for the number at its end, are plotted over (a quantity and
    /// its unit), and its value.
    pub x: Option<(&'static str, f64)>,
    /// Units of work per run, with their name.
    pub work: Option<(f64, &'static str)>,
    /// Least traffic per run in bytes.
    pub bytes: Option<f64>,
    /// The variants; ratios are relative to the first.
    pub variants: Vec<Variant<'a>>,
}

impl Bench {
    /// An empty benchmark.
    pub fn new(quick: bool) -> Bench {
        let progress = ProgressBar::new_spinner();
        let style = ProgressStyle::with_template("{spinner} {elapsed} {msg}");
        progress.set_style(style.expect("the template is well-formed"));
        let machine = Machine::this();
        let results = Results { machine, quick, records: Vec::new(), notes: Vec::new() };
        Bench { quick, part: String::new(), progress, results }
    }

    /// Whether to choose fewer sizes.
    pub fn quick(&self) -> bool {
        self.quick
    }

    /// What follows belongs to this part.
    pub fn begin_part(&mut self, name: &str) {
        self.part = name.to_owned();
    }

    /// A remark for the report.
    pub fn note(&mut self, text: impl Into<String>) {
        self.results.notes.push(format!("{}: {}", self.part, text.into()));
    }

    /// Times the variants of a group in turn. What they compute must have been checked before.
    pub fn compare(&mut self, mut group: Group<'_>) {
        self.progress.set_message(format!("{} {}", self.part, group.name));
        self.progress.tick();
        let budget = Duration::from_millis(if self.quick { 150 } else { 800 });
        let rounds = rounds(&mut group.variants, budget);
        let medians = rounds.iter().map(|times| quantile(times, 0.5));
        for (index, median) in medians.enumerate() {
            let ratios: Vec<f64> =
                rounds[index].iter().zip(&rounds[0]).map(|(own, first)| own / first).collect();
            self.results.records.push(Record {
                part: self.part.clone(),
                group: group.name.clone(),
                variant: group.variants[index].name.clone(),
                x: group.x.map(|(quantity, value)| (quantity.to_owned(), value)),
                median_ms: median * 1e3,
                quartiles_ms: [0.25, 0.75].map(|q| quantile(&rounds[index], q) * 1e3),
                ratio: quantile(&ratios, 0.5),
                work: group.work.map(|(count, unit)| (count, unit.to_owned())),
                bytes: group.bytes,
            });
        }
    }

    /// The results.
    pub fn finish(self) -> Results {
        self.progress.finish_and_clear();
        self.results
    }
}

/// Seconds per run of each variant, one figure per round; at least five rounds.
fn rounds(variants: &mut [Variant<'_>], budget: Duration) -> Vec<Vec<f64>> {
    // A round runs each variant often enough to be seen by the clock.
    let repeats: Vec<u32> = variants
        .iter_mut()
        .map(|variant| {
            (variant.run)();
            let once = time(&mut variant.run, 1).max(1e-9);
            (2e-3 / once).ceil().clamp(1.0, 1e5) as u32
        })
        .collect();
    let mut times = vec![Vec::new(); variants.len()];
    let start = Instant::now();
    while times[0].len() < 5 || (start.elapsed() < budget && times[0].len() < 101) {
        for ((variant, &repeats), times) in variants.iter_mut().zip(&repeats).zip(&mut times) {
            // What the variant before left behind, cold caches and sleeping threads, is not timed.
            (variant.run)();
            times.push(time(&mut variant.run, repeats) / f64::from(repeats));
        }
    }
    times
}

fn time(run: &mut dyn FnMut(), repeats: u32) -> f64 {
    let start = Instant::now();
    for _ in 0..repeats {
        run();
    }
    start.elapsed().as_secs_f64()
}

/// The value below which a share `q` of the values lies.
fn quantile(values: &[f64], q: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * q).round() as usize]
}
