//! The command line of the benchmark.

use std::path::PathBuf;

/// The part that the README's table is of.
pub const README: &str = "frame";

/// What instructions are counted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To be seen.
    Show,
    /// To fail where there are more than recorded.
    Check,
    /// To be recorded.
    Record,
}

/// What the command line asks for.
pub struct Options {
    /// Parts to run; empty: all.
    pub parts: Vec<String>,
    /// Fewer sizes and rounds.
    pub quick: bool,
    /// Where results go.
    pub folder: PathBuf,
    /// Earlier results to compare with.
    pub compare: Option<PathBuf>,
    /// Whether to write the README's speed table.
    pub readme: bool,
    /// To count instructions rather than to time, and what for.
    pub instructions: Option<Purpose>,
}

impl Options {
    /// Reads the command line.
    ///
    /// # Errors
    ///
    /// The help, or what is wrong.
    pub fn parse(arguments: &[String], parts: &[&str]) -> Result<Options, String> {
        let mut options = Options {
            parts: Vec::new(),
            quick: false,
            folder: PathBuf::from("target/bench"),
            compare: None,
            readme: false,
            instructions: None,
        };
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            let mut value = || {
                rest.next().map(PathBuf::from).ok_or(format!("bench: {argument} needs a file name"))
            };
            match argument.as_str() {
                "--quick" => options.quick = true,
                "--readme" => options.readme = true,
                "--instructions" | "--check" | "--bless" if arguments.len() > 1 => {
                    return Err(format!("bench: {argument} stands alone: it counts every stage"));
                }
                "--instructions" => options.instructions = Some(Purpose::Show),
                "--check" => options.instructions = Some(Purpose::Check),
                "--bless" => options.instructions = Some(Purpose::Record),
                "--out" => options.folder = value()?,
                "--compare" => options.compare = Some(value()?),
                part if parts.contains(&part) => options.parts.push(part.to_owned()),
                "--help" | "-h" => return Err(help(parts)),
                other => return Err(format!("bench: unknown `{other}`\n\n{}", help(parts))),
            }
        }
        if options.readme && !options.parts.is_empty() && !options.parts.iter().any(|p| p == README)
        {
            return Err(format!("bench: --readme needs the part `{README}`"));
        }
        Ok(options)
    }
}

fn help(parts: &[&str]) -> String {
    format!(
        "cargo xtask bench [PART ...] [options]

Times the stages of the workspace, frame after frame. Each is checked against its oracle first;
variants that are compared run in turn within one process, so that ratios hold on a noisy machine.

Parts: {}

  --quick            fewer sizes and rounds, under 90 s
  --out DIR          where bench.json and bench.html go (target/bench)
  --compare FILE     an earlier bench.json: shows what changed
  --readme           writes the README's speed table from the part `frame`

Machines are noisy, instruction counts are not; valgrind takes them. Without other options:

  --instructions     shows those of every stage beside the recorded ones
  --check            and fails where there are more
  --bless            records them",
        parts.join(", ")
    )
}
