//! Timing variants in turn, frame after frame.
//!
//! The library harnesses time one function after the other, minutes apart on a machine whose speed
//! drifts. Here all variants of a comparison are visited in turn, round by round, and ratios are
//! taken within a round: they hold to a few per cent where absolute times do not.
//!
//! What a visit measures is a program that does the same thing again and again: it first runs
//! without being timed until caches hold what the variant needs and its threads are awake, then
//! runs for some milliseconds and keeps the median. Rounds are repeated until the ratios are known
//! well enough, so short and steady variants are done soon.

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use shadowmap_core::Threads;

use super::machine::Machine;
use super::progress::Progress;
use super::threads::on;

/// How long a variant runs per visit before it is timed, at least: two drawings of a map of 1024²
/// are slow after another variant has had the cache, the third is not.
const WARM_UP: Duration = Duration::from_millis(2);

/// What takes longer need not be warmed up.
const LONG: Duration = Duration::from_millis(40);

/// How long it is timed per visit, at least.
const VISIT: Duration = Duration::from_millis(10);

/// What the clock resolves to a thousandth.
const CLOCK: f64 = 1e-4;

/// No fewer rounds.
const ROUNDS: usize = 7;

/// Rounds end when the standard error of every ratio is below this share of it.
const PRECISION: f64 = 0.004;

/// One way of doing the work of a comparison.
pub struct Variant<'a> {
    name: String,
    threads: Threads,
    least: Least,
    run: Box<dyn FnMut() + Send + 'a>,
}

impl<'a> Variant<'a> {
    /// A variant that `run` performs once per call, on one thread.
    pub fn new(name: impl Into<String>, run: impl FnMut() + Send + 'a) -> Variant<'a> {
        Variant::on(Threads::One, name, run)
    }

    /// A variant that `run` performs once per call, on one thread or within [`on`] two.
    pub fn on(
        threads: Threads,
        name: impl Into<String>,
        run: impl FnMut() + Send + 'a,
    ) -> Variant<'a> {
        Variant { name: name.into(), threads, least: Least::default(), run: Box::new(run) }
    }

    /// A run cannot but read and write so many bytes.
    pub fn moving(mut self, bytes: impl Into<f64>) -> Variant<'a> {
        self.least.bytes = bytes.into();
        self
    }

    /// A run cannot do with fewer operations on `f32`.
    pub fn computing(mut self, operations: impl Into<f64>) -> Variant<'a> {
        self.least.operations = operations.into();
        self
    }
}

/// What a run must do at least, where that is known: what the machine's limits are held against.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Least {
    /// Bytes read and written.
    pub bytes: f64,
    /// Operations on `f32`.
    pub operations: f64,
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
    /// How often it was visited; older results do not say.
    #[serde(default)]
    pub rounds: usize,
    /// Median over the rounds of this variant's time relative to the first variant of its group.
    pub ratio: f64,
    /// Units of work per run and their name, e.g. 1,048,576 `pixels`.
    pub work: Option<(f64, String)>,
    /// Threads that it ran on.
    pub threads: u32,
    /// What bounds it is judged by this.
    pub least: Least,
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
    /// Remarks that the parts made, e.g. errors beside the truth.
    pub notes: Vec<String>,
    /// What was counted rather than timed.
    #[serde(default)]
    pub tables: Vec<Table>,
}

/// Counts that go with a part, e.g. texels visited per query.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Table {
    /// The part of the benchmark.
    pub part: String,
    /// What is counted.
    pub title: String,
    /// Names of the columns.
    pub head: Vec<String>,
    /// Cells, row by row.
    pub rows: Vec<Vec<String>>,
}

/// Collects records, and shows progress while it does.
pub struct Bench {
    quick: bool,
    part: String,
    progress: Progress,
    results: Results,
}

/// A setup, and the comparisons that it is made for.
pub struct Case {
    comparisons: usize,
    run: Box<dyn FnOnce(&mut Bench)>,
}

impl Case {
    /// A case of so many comparisons, which `run` makes.
    pub fn new(comparisons: usize, run: impl FnOnce(&mut Bench) + 'static) -> Case {
        Case { comparisons, run: Box::new(run) }
    }

    /// How many comparisons it makes.
    pub fn comparisons(&self) -> usize {
        self.comparisons
    }
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
    /// The variants; ratios are relative to the first.
    pub variants: Vec<Variant<'a>>,
}

impl Bench {
    /// An empty benchmark of so many comparisons.
    pub fn new(quick: bool, comparisons: usize) -> Bench {
        let machine = Machine::this();
        let (records, notes, tables) = (Vec::new(), Vec::new(), Vec::new());
        let results = Results { machine, quick, records, notes, tables };
        Bench { quick, part: String::new(), progress: Progress::new(comparisons), results }
    }

    /// Whether to choose fewer sizes.
    pub fn quick(&self) -> bool {
        self.quick
    }

    /// Runs a case of a part.
    ///
    /// # Panics
    ///
    /// If it makes more or fewer comparisons than it was planned with.
    pub fn run(&mut self, part: &str, case: Case) {
        part.clone_into(&mut self.part);
        let before = self.progress.done();
        (case.run)(self);
        assert_eq!(
            self.progress.done() - before,
            case.comparisons,
            "a case of {part} is misplanned"
        );
    }

    /// A remark for the report.
    pub fn note(&mut self, text: impl Into<String>) {
        self.results.notes.push(format!("{}: {}", self.part, text.into()));
    }

    /// Counts for the report.
    pub fn table(&mut self, title: String, head: &[&str], rows: Vec<Vec<String>>) {
        let head = head.iter().map(|name| (*name).to_owned()).collect();
        self.results.tables.push(Table { part: self.part.clone(), title, head, rows });
    }

    /// Times the variants of a group in turn. What they compute must have been checked before.
    /// Returns the median of each one's time relative to the first.
    pub fn compare(&mut self, mut group: Group<'_>) -> Vec<f64> {
        self.progress.begin(&format!("{} {}", self.part, group.name));
        let budget = Duration::from_millis(if self.quick { 1000 } else { 2500 });
        let rounds = rounds(&mut group.variants, budget);
        let ratio = |times: &Vec<f64>| quantile(&ratios(times, &rounds[0]), 0.5);
        let all: Vec<f64> = rounds.iter().map(ratio).collect();
        for ((variant, times), &ratio) in group.variants.iter().zip(&rounds).zip(&all) {
            self.results.records.push(Record {
                part: self.part.clone(),
                group: group.name.clone(),
                variant: variant.name.clone(),
                x: group.x.map(|(quantity, value)| (quantity.to_owned(), value)),
                median_ms: quantile(times, 0.5) * 1e3,
                quartiles_ms: [0.25, 0.75].map(|q| quantile(times, q) * 1e3),
                ratio,
                rounds: times.len(),
                work: group.work.map(|(count, unit)| (count, unit.to_owned())),
                threads: if variant.threads == Threads::One { 1 } else { 2 },
                least: variant.least,
            });
        }
        self.progress.end();
        all
    }

    /// The results.
    pub fn finish(self) -> Results {
        self.progress.finish();
        self.results
    }
}

/// Seconds per run of each variant, one figure per round.
fn rounds(variants: &mut [Variant<'_>], budget: Duration) -> Vec<Vec<f64>> {
    let mut times = vec![Vec::new(); variants.len()];
    let start = Instant::now();
    while times[0].len() < ROUNDS || (start.elapsed() < budget && !known(&times)) {
        for (variant, times) in variants.iter_mut().zip(&mut times) {
            let run = &mut variant.run;
            times.push(on(variant.threads, || visit(run)));
        }
    }
    times
}

/// Seconds per run, frame after frame.
fn visit(run: &mut (dyn FnMut() + Send)) -> f64 {
    let start = Instant::now();
    run();
    let once = start.elapsed();
    if once > LONG {
        return once.as_secs_f64();
    }
    let mut runs = 1;
    while start.elapsed() < WARM_UP {
        run();
        runs += 1;
    }
    let once = start.elapsed().as_secs_f64() / f64::from(runs);
    let repeats = (CLOCK / once).ceil() as u32;
    let start = Instant::now();
    let mut times = Vec::new();
    while times.is_empty() || start.elapsed() < VISIT {
        let start = Instant::now();
        for _ in 0..repeats {
            run();
        }
        times.push(start.elapsed().as_secs_f64() / f64::from(repeats));
    }
    quantile(&times, 0.5)
}

/// Whether all ratios are known to [`PRECISION`].
fn known(times: &[Vec<f64>]) -> bool {
    times.iter().all(|own| {
        let ratios = ratios(own, &times[0]);
        // Of normally distributed values the quartiles are 1.35 standard deviations apart, and the
        // median is 1.25 times as uncertain as the mean.
        let deviation = (quantile(&ratios, 0.75) - quantile(&ratios, 0.25)) / 1.35;
        let error = 1.25 * deviation / (ratios.len() as f64).sqrt();
        error < PRECISION * quantile(&ratios, 0.5)
    })
}

/// A variant's times relative to those of the first one in the same round.
fn ratios(own: &[f64], first: &[f64]) -> Vec<f64> {
    own.iter().zip(first).map(|(own, first)| own / first).collect()
}

/// The value below which a share `q` of the values lies.
fn quantile(values: &[f64], q: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * q).round() as usize]
}
