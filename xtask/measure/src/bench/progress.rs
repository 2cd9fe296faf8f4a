//! How far the benchmark is.

use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};

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
        let style = "{bar:30} {pos} of {len}, {elapsed} of about {duration}: {wide_msg}";
        bar.set_style(ProgressStyle::with_template(style).expect("the template is well-formed"));
        Progress { bar, printed: Instant::now() }
    }

    /// A comparison of this name begins.
    pub fn begin(&mut self, name: &str) {
        self.bar.set_message(name.to_owned());
        if self.bar.is_hidden() && self.printed.elapsed() > LINE {
            self.printed = Instant::now();
            eprintln!(
                "{} of {} comparisons after {}, about {} left: {name}",
                self.bar.position(),
                self.bar.length().unwrap_or_default(),
                HumanDuration(self.bar.elapsed()),
                HumanDuration(self.bar.eta()),
            );
        }
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
