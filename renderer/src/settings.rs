//! The options of `render`, checked.

use std::path::PathBuf;

use shadowmap_core::{Level, LevelKind, Light};
use single_sample::paper;

use crate::Error;
use crate::camera::CameraOptions;
use crate::cli::RenderArgs;
use crate::light_views::ByHand;
use crate::lighting::LightOptions;
use crate::load::Limits;
use crate::method::Method;
use crate::pass::Pass;
use crate::picture::Format;
use crate::shade::MAX_AA;
use crate::values::{MAX_SIZE, count, field_of_view, light, number, point, size};

/// What `--samples` says to have the number of samples found.
const ADAPTIVE: &str = "adaptive";

/// Everything that `render` was asked for.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Built-in name or path.
    pub scene: String,
    /// Where the picture goes, and in which format.
    pub output: (PathBuf, Format),
    /// What to write.
    pub pass: Pass,
    /// Width and height of the picture.
    pub size: [u32; 2],
    /// Pixels of the camera per pixel of the picture along each axis.
    pub aa: u32,
    /// Changes to the camera.
    pub camera: CameraOptions,
    /// Seat a loaded model.
    pub fit: bool,
    /// Add a ground.
    pub ground: bool,
    /// Lights in place of the scene's own; empty for those.
    pub lights: Vec<Light>,
    /// How lights are drawn.
    pub light_options: LightOptions,
    /// SIMD level.
    pub level: Level,
    /// Threads.
    pub threads: usize,
    /// Where statistics go.
    pub stats: Option<PathBuf>,
    /// Repetitions.
    pub repeat: u32,
    /// What a scene file may ask for; pictures and maps may take as much memory.
    pub limits: Limits,
}

impl Settings {
    /// Checks the values of all options.
    ///
    /// # Errors
    ///
    /// Names the first one that is wrong.
    pub fn new(args: &RenderArgs) -> Result<Settings, Error> {
        let format = Format::of(&args.output)
            .map_err(|error| Error::new(format_args!("--output {error}")))?;
        let pass = Pass::parse(&args.pass)?;
        let mut method = args.method.as_deref().map(Method::parse).transpose()?;
        if pass == Pass::VisibilityChannel && *method.get_or_insert(Method::Skins) != Method::Skins
        {
            let text = "--pass visibility-channel: only --method skins draws such channels";
            return Err(Error::new(text));
        }
        let size = size("--size", &args.size)?;
        let aa = count("--aa", &args.aa, 1..=MAX_AA)?;
        let aa = if pass.is_antialiased() { aa } else { 1 };
        if size.iter().any(|side| side * aa > MAX_SIZE) {
            return Err(Error::new(format_args!(
                "--size {} --aa {aa}: a side times {aa} must be at most {MAX_SIZE}",
                args.size
            )));
        }
        let vector = |option: &str, text: &Option<String>| {
            text.as_deref().map(|text| point(option, text)).transpose()
        };
        let angle = |option: &str, text: &Option<String>| {
            text.as_deref().map(|text| field_of_view(option, text)).transpose()
        };
        let by_hand = match (
            vector("--light-target", &args.light_target)?,
            angle("--light-fov", &args.light_fov)?,
        ) {
            (Some(target), Some(fov)) => Some(ByHand { target, fov }),
            _ => None,
        };
        let samples = args.samples.as_deref();
        let available = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = args.threads.as_deref();
        let threads = threads.map(|text| count("--threads", text, 1..=1024)).transpose()?;
        let megabytes = count("--max-memory", &args.max_memory, 1..=u32::MAX)?;
        Ok(Settings {
            scene: args.scene.clone().unwrap_or_else(|| "show".to_owned()),
            output: (args.output.clone(), format),
            pass,
            size,
            aa,
            camera: CameraOptions {
                eye: vector("--eye", &args.eye)?,
                target: vector("--target", &args.target)?,
                vertical_fov: angle("--fov", &args.fov)?,
            },
            fit: args.fit,
            ground: args.ground,
            lights: args.light.iter().map(|text| light(text)).collect::<Result<_, _>>()?,
            light_options: LightOptions {
                method,
                samples: samples
                    .filter(|text| *text != ADAPTIVE)
                    .map(|text| count("--samples", text, 1..=65536))
                    .transpose()?,
                adaptive: samples == Some(ADAPTIVE),
                map_size: count("--map-size", &args.map_size, 1..=MAX_SIZE)?,
                by_hand,
                paper: paper_parameters(args)?,
            },
            level: level(&args.simd)?,
            threads: threads.map_or(available, |threads| threads as usize),
            stats: args.stats.clone(),
            repeat: count("--repeat", &args.repeat, 1..=1_000_000)?,
            limits: Limits {
                max_memory: u64::from(megabytes) << 20,
                max_triangles: count("--max-triangles", &args.max_triangles, 1..=u32::MAX)?.into(),
            },
        })
    }
}

fn paper_parameters(args: &RenderArgs) -> Result<paper::Parameters, Error> {
    let default = paper::Parameters::default();
    let value = |option: &str, text: &Option<String>, default: f32| match text {
        Some(text) => {
            number(option, text, "a number from 0 to 1e6", |value| (0.0..=1e6).contains(&value))
        }
        None => Ok(default),
    };
    Ok(paper::Parameters {
        r_scale: value("--r-scale", &args.r_scale, default.r_scale)?,
        r_bias: value("--r-bias", &args.r_bias, default.r_bias)?,
        r_shrink: value("--r-shrink", &args.r_shrink, default.r_shrink)?,
        ..default
    })
}

fn level(name: &str) -> Result<Level, Error> {
    if name == "auto" {
        return Ok(Level::detect());
    }
    let kind = LevelKind::ALL.into_iter().find(|kind| kind.name() == name);
    kind.and_then(Level::new).ok_or_else(|| {
        let names: Vec<_> = Level::available().map(|level| level.kind().name()).collect();
        let why = if kind.is_some() { "this machine lacks it" } else { "no such level" };
        Error::new(format_args!("--simd {name}: {why}; there are auto, {}", names.join(", ")))
    })
}
