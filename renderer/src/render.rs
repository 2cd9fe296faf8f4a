//! The command `render`: from a scene's name or file to a picture's file.

use std::io::IsTerminal;
use std::path::Path;
use std::time::{Duration, Instant};

use glam::Vec3;
use indicatif::{ProgressBar, ProgressStyle};
use reference::{Cutouts, Tracer};
use shadowmap_core::Threads;

use crate::camera::{choose, view};
use crate::default_light::default_lights;
use crate::frame::{Frame, Shot};
use crate::lighting::LightJob;
use crate::load::load;
use crate::memory::FrameSize;
use crate::method::Method;
use crate::picture::{check_places, write_file};
use crate::prepared::Prepared;
use crate::scene::{Scene, SceneLight};
use crate::settings::Settings;
use crate::stats::{Milliseconds, Stats};
use crate::{Error, builtin};

/// Renders and writes what `settings` ask for.
///
/// # Errors
///
/// If an input cannot be used, or a file not be written. Nothing is written then.
pub fn render(settings: &Settings) -> Result<(), Error> {
    check_places(&settings.output.0, settings.stats.as_deref())?;
    if settings.threads == 1 {
        return render_on(settings, Threads::One);
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build();
    let pool =
        pool.map_err(|error| Error::new(format_args!("--threads {}: {error}", settings.threads)))?;
    pool.install(|| render_on(settings, Threads::Pool))
}

fn render_on(settings: &Settings, threads: Threads) -> Result<(), Error> {
    let progress = Progress::new(settings.repeat);
    progress.say("loading");
    let start = Instant::now();
    let (mut scene, mut alternatives) = open(settings)?;
    let camera = choose(&scene, &settings.camera)?;
    if scene.lights.is_empty() && settings.lights.is_empty() {
        scene.lights = default_lights(&scene, &camera);
        alternatives = true;
    }
    for warning in &scene.warnings {
        progress.warn(&format!("{}: {warning}", settings.scene));
    }
    let prepared = Prepared::new(&scene);
    let lights = chosen_lights(settings, &scene, alternatives);
    let size = settings.size.map(|side| side * settings.aa);
    let view = view(&camera, size, prepared.bounds());
    let jobs =
        lights.iter().map(|light| LightJob::new(light, &settings.light_options, &prepared, &view));
    let jobs = jobs.collect::<Result<Vec<_>, _>>()?;
    check_memory(settings, &scene, &jobs)?;
    let is_solid =
        |triangle: u32, [_, b1, b2]: [f32; 3]| prepared.is_solid(triangle as usize, b1, b2);
    let traced = jobs.iter().any(|job| job.method == Method::RayTraced);
    let tracer = traced.then(|| {
        let cutouts = Cutouts { has_holes: prepared.masked(), is_opaque: &is_solid };
        Tracer::with_cutouts(&scene.mesh.as_mesh(), cutouts)
    });
    let shot = Shot {
        prepared: &prepared,
        camera: &view,
        aa: settings.aa,
        lights: &jobs,
        tracer: tracer.as_ref(),
        goal: settings.pass.goal(settings.output.1.is_float()),
    };
    let mut load_time = start.elapsed();
    let mut frame = Frame::new(settings.level, threads);
    let mut ms = Milliseconds::default();
    for repetition in 1..=settings.repeat {
        progress.say(if repetition == 1 { "rendering" } else { "rendering again" });
        frame.render(&shot);
        ms.push(std::mem::take(&mut load_time), frame.times());
        progress.step();
    }
    progress.say("writing");
    let (path, format) = &settings.output;
    let picture = settings.pass.picture(&frame, &shot, threads);
    let contents = picture.encode(*format);
    let contents = contents.map_err(|why| Error::new(format_args!("{}: {why}", path.display())))?;
    write_file(path, &contents)?;
    if let Some(path) = &settings.stats {
        write_stats(path, settings, &scene, &jobs, ms, &frame)?;
    }
    progress.finish();
    Ok(())
}

/// The scene, and whether its lights are alternatives.
fn open(settings: &Settings) -> Result<(Scene, bool), Error> {
    let name = settings.scene.as_str();
    let mut scene = match builtin::scene(name) {
        Some(scene) => scene,
        None => load_file(settings)?,
    };
    let mut alternatives = builtin::NAMES.contains(&name) && builtin::lights_are_alternatives(name);
    if settings.fit {
        scene.fit();
    }
    if settings.fit || settings.ground {
        scene.add_ground();
        if let Some(ground) = scene.materials.last_mut() {
            ground.base_color = builtin::GROUND;
        }
    }
    if settings.fit {
        builtin::set_up_fitted(&mut scene);
        alternatives = true;
    }
    Ok((scene, alternatives))
}

fn load_file(settings: &Settings) -> Result<Scene, Error> {
    let path = Path::new(&settings.scene);
    let has_ending = path.extension().is_some();
    if !has_ending && !path.exists() {
        let names = builtin::NAMES.join(", ");
        return Err(Error::new(format_args!(
            "{}: no built-in scene ({names}) and no file of that name",
            settings.scene
        )));
    }
    load(path, &settings.limits).map_err(Error::new)
}

/// The lights that were asked for, else the scene's own; of alternatives the first one that suits
/// the method.
fn chosen_lights(settings: &Settings, scene: &Scene, alternatives: bool) -> Vec<SceneLight> {
    let asked = settings.lights.iter().map(|&light| SceneLight {
        name: "light".to_owned(),
        light,
        color: Vec3::ONE,
        intensity: 1.0,
        spot: None,
    });
    if !settings.lights.is_empty() {
        return asked.collect();
    }
    if !alternatives {
        return scene.lights.clone();
    }
    let method = settings.light_options.method;
    let suits = |light: &&SceneLight| method.is_none_or(|method| method.fits(&light.light));
    let chosen = scene.lights.iter().find(suits).or(scene.lights.first());
    chosen.cloned().into_iter().collect()
}

/// Refuses what could not be held, before anything is allocated.
fn check_memory(settings: &Settings, scene: &Scene, lights: &[LightJob]) -> Result<(), Error> {
    let (aa, map_size) = (settings.aa, settings.light_options.map_size);
    let frame = FrameSize {
        size: settings.size,
        aa,
        is_float: settings.output.1.is_float(),
        triangles: scene.mesh.triangles.len(),
        lights,
    };
    let (needed, limit) = (frame.bytes(), settings.limits.max_memory);
    if needed <= limit {
        return Ok(());
    }
    let ([width, height], needed, limit) = (settings.size, needed >> 20, limit >> 20);
    let samples = lights.iter().map(|light| light.samples).max().unwrap_or(1);
    Err(Error::new(format_args!(
        "--size {width}x{height} --aa {aa} --map-size {map_size} --samples {samples}: needs about \
         {needed} MB, the limit is --max-memory {limit}"
    )))
}

fn write_stats(
    path: &Path,
    settings: &Settings,
    scene: &Scene,
    jobs: &[LightJob],
    ms: Milliseconds,
    frame: &Frame,
) -> Result<(), Error> {
    let mut methods: Vec<_> = jobs.iter().map(|job| job.method.name()).collect();
    methods.dedup();
    let stats = Stats {
        version: env!("CARGO_PKG_VERSION"),
        scene: settings.scene.clone(),
        triangles: scene.mesh.triangles.len(),
        size: settings.size,
        map_size: settings.light_options.map_size,
        method: methods.join("+"),
        samples: jobs.iter().map(|job| job.samples).max().unwrap_or(1),
        simd: settings.level.kind().name(),
        threads: settings.threads,
        repeat: settings.repeat,
        ms,
        counters: frame.counters().clone(),
    };
    let json = serde_json::to_string_pretty(&stats).map_err(Error::new)?;
    write_file(path, format!("{json}\n").as_bytes())
}

/// What happens, on stderr, if that is a terminal.
struct Progress(ProgressBar);

impl Progress {
    fn new(repeat: u32) -> Progress {
        if !std::io::stderr().is_terminal() {
            return Progress(ProgressBar::hidden());
        }
        let bar = ProgressBar::new(u64::from(repeat));
        let style = "{spinner} {msg} {wide_bar} {pos}/{len} {elapsed}";
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Progress(bar)
    }
    fn say(&self, what: &'static str) {
        self.0.set_message(what);
    }
    fn step(&self) {
        self.0.inc(1);
    }
    /// A line on stderr, terminal or not.
    fn warn(&self, text: &str) {
        self.0.suspend(|| eprintln!("penumbra: warning: {text}"));
    }
    fn finish(&self) {
        self.0.finish_and_clear();
    }
}
