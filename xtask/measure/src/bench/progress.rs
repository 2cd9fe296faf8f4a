//! How far the benchmark is.

use std::time::{Duration, Instant};

use indicatif::{FormattedDuration, ProgressBar, ProgressStyle};

/// Where there is no terminal to draw a bar on, a line is printed that often.
const LINE: Duration = Duration::from_secs(20);

/// A bar over all comparisons, or now and then a line.
pub struct Progress {
    bar: ProgressBar,
    printed: Instant,
}

impl Progress {
    /// None of so many comparisons is done.
    pub fn new(comparisons: usize) -> Progress {
        let bar = ProgressBar::new(comparisons as u64);
        let style = ProgressStyle::with_template("{bar:20} {wide_msg}");
        bar.set_style(style.expect("the template is well-formed"));
        Progress { bar, printed: Instant::now() }
    }

    /// A comparison of this name begins.
    pub fn begin(&mut self, name: &str) {
        let (done, all) = (self.bar.position(), self.bar.length().unwrap_or_default());
        let elapsed = self.bar.elapsed();
        // All comparisons may take the same time, and those with much to prepare are spread.
        let left = elapsed.as_secs_f64() / done.max(1) as f64 * (all - done) as f64;
        let [elapsed, left] = [elapsed, Duration::from_secs_f64(left)].map(FormattedDuration);
        let message = match done {
            0 => format!("0 of {all}: {name}"),
            _ => format!("{done} of {all}, {elapsed}, about {left} left: {name}"),
        };
        if self.bar.is_hidden() && self.printed.elapsed() > LINE {
            self.printed = Instant::now();
            eprintln!("{message}");
        }
        self.bar.set_message(message);
    }

    /// It is done.
    pub fn end(&self) {
        self.bar.inc(1);
    }

    /// How many are.
    pub fn done(&self) -> usize {
        self.bar.position() as usize
    }

    /// All are.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
