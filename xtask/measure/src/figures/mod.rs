//! `cargo xtask figures`: the papers' figures, redrawn beside the truth, as one HTML page.

mod adaptive;
mod errors;
mod gallery;
mod limits;
mod line;
mod paper2000;
mod paper2000_skins;
mod paper2002;
mod readme;
mod samples;
mod scenes;
mod stage;
mod time;
mod way;

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use maud::{Markup, html};

use crate::page::Section;

/// How large and how many.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Side of the pictures in pixels.
    pub size: u32,
    /// How often what is timed is repeated.
    pub repeats: usize,
    /// Fewer points in plots, fewer scenes in tables.
    pub quick: bool,
}

/// A part of the report, by name, and what draws it.
type Part = (&'static str, fn(&Effort) -> Section);

/// The parts in reading order.
const PARTS: &[Part] = &[
    ("2000-1", paper2000::figure_1),
    ("2000-2", paper2000_skins::figure_2),
    ("2000-4", paper2000_skins::figure_4),
    ("2000-5", paper2000_skins::figure_5),
    ("2000-7", paper2000_skins::figure_7),
    ("2000-8", paper2000::figure_8),
    ("2000-9", paper2000::figure_9),
    ("2000-10", paper2000::figure_10),
    ("2002-5", adaptive::figure_5),
    ("2002-6", paper2002::figure_6),
    ("2002-7", paper2002::figure_7),
    ("2002-8", paper2002::figure_8),
    ("2002-9", paper2002::figure_9),
    ("errors", errors::tables),
    ("time", time::plots),
    ("limits", limits::failures),
];

/// Runs the command.
pub fn run(arguments: &[String]) -> ExitCode {
    let options = match Options::parse(arguments) {
        Ok(options) => options,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    if options.readme {
        return match crate::readme::replace("error", &readme::table(&options.effort)) {
            Ok(()) => ExitCode::SUCCESS,
            Err(message) => {
                eprintln!("figures: {message}");
                ExitCode::FAILURE
            }
        };
    }
    match draw(&options) {
        Ok(place) => {
            println!("{}", place.display());
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("figures: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Draws the parts that are asked for; where the page is.
fn draw(options: &Options) -> Result<PathBuf, String> {
    let start = Instant::now();
    let failed = |what: PathBuf, error: std::io::Error| format!("{}: {error}", what.display());
    let folder = &options.folder;
    fs::create_dir_all(folder).map_err(|error| failed(folder.clone(), error))?;
    let chosen = |name: &str| options.parts.is_empty() || options.parts.iter().any(|p| p == name);
    let parts: Vec<&Part> = PARTS.iter().filter(|(name, _)| chosen(name)).collect();
    let bar = ProgressBar::new(parts.len() as u64);
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {msg}");
    bar.set_style(style.expect("the template is well formed"));
    bar.enable_steady_tick(Duration::from_millis(200));
    let mut sections = Vec::new();
    for (name, part) in parts {
        bar.set_message(*name);
        sections.push(part(&options.effort));
        bar.inc(1);
    }
    bar.finish_and_clear();
    for (name, picture) in sections.iter().flat_map(|section| &section.pictures) {
        let file = folder.join(format!("{name}.png"));
        picture.write(&file).map_err(|error| failed(file, error))?;
    }
    let text = crate::page::page(
        "Soft shadow maps beside the truth",
        &introduction(&options.effort, start.elapsed()),
        &sections,
    );
    let file = folder.join("figures.html");
    fs::write(&file, text).map_err(|error| failed(file.clone(), error))?;
    Ok(file)
}

fn introduction(effort: &Effort, took: Duration) -> Markup {
    html! {
        p {
            "The figures of “Soft Shadow Maps for Linear Lights” (Heidrich, Brabec and Seidel, 2000) "
            "and of “Single Sample Soft Shadows using Depth Maps” (Brabec and Seidel, 2002), "
            "redrawn by this workspace on a CPU, each beside a ray-traced truth and a number. The "
            "scenes are of the same kind as the papers’, not the same."
        }
        p {
            "Truth is the fraction of 4096 rays per pixel that reach the light, the receiver’s own "
            "horizon included. RMSE is that of visibility, between 0 and 1; “in the penumbra” "
            "means over the pixels whose true visibility lies between 0.002 and 0.998. FLIP is "
            "the mean of NVIDIA’s perceptual difference of the two grey pictures, 0 for none. "
            "Pictures are " (effort.size) " pixels wide. Grey pictures show visibility: black 0, "
            "white 1. In pictures of errors, white is right, blue is too dark, orange is too "
            "light; full colour from an error of " (crate::picture::FULL_ERROR) " on."
        }
        p {
            "Times are those of this run, on " (rayon::current_num_threads()) " threads where not "
            "said otherwise, the best of " (effort.repeats) "; anything else that ran on the "
            "machine is in them. All " (took.as_secs()) " s of it: "
            code { "cargo xtask figures" @if effort.quick { " --quick" } } "."
        }
    }
}

/// What the command line asks for.
struct Options {
    parts: Vec<String>,
    effort: Effort,
    folder: PathBuf,
    /// Whether to write the README's table of errors instead of the page.
    readme: bool,
}

impl Options {
    fn parse(arguments: &[String]) -> Result<Options, String> {
        let mut options = Options {
            parts: Vec::new(),
            effort: Effort { size: 512, repeats: 3, quick: false },
            folder: PathBuf::from("target/figures"),
            readme: false,
        };
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            match argument.as_str() {
                "--quick" => options.effort = Effort { size: 256, repeats: 1, quick: true },
                "--readme" => options.readme = true,
                "--out" => {
                    let folder = rest.next().ok_or("figures: --out needs a folder")?;
                    options.folder = PathBuf::from(folder);
                }
                part if PARTS.iter().any(|(name, _)| *name == part) => {
                    options.parts.push(part.to_owned());
                }
                "--help" | "-h" => return Err(help()),
                other => return Err(format!("figures: unknown `{other}`\n\n{}", help())),
            }
        }
        Ok(options)
    }
}

fn help() -> String {
    let names: Vec<&str> = PARTS.iter().map(|(name, _)| *name).collect();
    format!(
        "cargo xtask figures [PART ...] [options]

Redraws the figures of both papers beside ray-traced truth: one self-contained page, figures.html,
and every picture as a PNG file.

Parts: {}

  --quick      smaller pictures and fewer points, under 40 s
  --out DIR    where they go (target/figures)
  --readme     no page, but the README's table of errors",
        names.join(", ")
    )
}
