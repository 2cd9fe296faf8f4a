//! What was done, as `--stats` writes it.

use std::time::{Duration, Instant};

use serde::ser::{Serialize, SerializeMap, Serializer};

/// Milliseconds of every stage, one entry per repetition.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Milliseconds {
    /// Reading the scene, or building it; all in the first repetition.
    pub load: Vec<f64>,
    /// What the camera sees: nearness and triangle of every pixel.
    pub camera_pass: Vec<f64>,
    /// All depth maps of all samples of all lights.
    pub light_maps: Vec<f64>,
    /// Channels of linear lights: skins.
    pub visibility_channel: Vec<f64>,
    /// Visibility of every pixel.
    pub shadow: Vec<f64>,
    /// Colour of every pixel.
    pub shade: Vec<f64>,
    /// Everything after loading, without writing the file.
    pub total: Vec<f64>,
}

/// How long the stages of one frame took. Those that ran side by side share the time that both
/// took together, so that the stages add up to no more than the total.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageTimes {
    /// See [`Milliseconds::camera_pass`].
    pub camera_pass: Duration,
    /// See [`Milliseconds::light_maps`].
    pub light_maps: Duration,
    /// See [`Milliseconds::visibility_channel`].
    pub visibility_channel: Duration,
    /// See [`Milliseconds::shadow`].
    pub shadow: Duration,
    /// See [`Milliseconds::shade`].
    pub shade: Duration,
    /// See [`Milliseconds::total`].
    pub total: Duration,
}

impl Milliseconds {
    /// Appends one repetition.
    pub fn push(&mut self, load: Duration, frame: &StageTimes) {
        let milliseconds = |duration: Duration| duration.as_secs_f64() * 1e3;
        self.load.push(milliseconds(load));
        self.camera_pass.push(milliseconds(frame.camera_pass));
        self.light_maps.push(milliseconds(frame.light_maps));
        self.visibility_channel.push(milliseconds(frame.visibility_channel));
        self.shadow.push(milliseconds(frame.shadow));
        self.shade.push(milliseconds(frame.shade));
        self.total.push(milliseconds(frame.total));
    }
}

impl StageTimes {
    /// The camera's pass and the lights' maps, drawn side by side, took `together` in all. It is
    /// shared out by what either took, `of_camera` and what the maps have by now.
    pub fn share(&mut self, together: Duration, of_camera: Duration) {
        let sum = (of_camera + self.light_maps).as_secs_f64();
        let part = if sum > 0.0 { of_camera.as_secs_f64() / sum } else { 0.0 };
        self.camera_pass = together.mul_f64(part);
        self.light_maps = together - self.camera_pass;
    }
}

/// Runs `work` and adds the time it took to `total`; nothing where there is no clock.
pub fn timed<T>(total: &mut Duration, work: impl FnOnce() -> T) -> T {
    // Bare WebAssembly has none, and asking would panic.
    let has_clock = !cfg!(all(target_family = "wasm", target_os = "unknown"));
    let start = has_clock.then(Instant::now);
    let result = work();
    if let Some(start) = start {
        *total += start.elapsed();
    }
    result
}

/// How often what happened in one frame, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Counters(Vec<(&'static str, u64)>);

impl Counters {
    /// Forgets all counts and keeps the memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds `count` to the counter of that name, which starts at 0.
    pub fn add(&mut self, name: &'static str, count: u64) {
        match self.0.iter_mut().find(|entry| entry.0 == name) {
            Some(entry) => entry.1 += count,
            None => self.0.push((name, count)),
        }
    }

    /// Adds how many receivers were asked for, and how many of them lie outside the light's maps;
    /// none are missed there if the maps hold all that can block.
    pub fn add_receivers(&mut self, receivers: u64, outside: u64, holds_all: bool) {
        self.add("receivers", receivers);
        self.add("outside the light's maps", if holds_all { 0 } else { outside });
    }

    /// Adds what a single-sample method counted.
    pub fn add_searches(&mut self, found: &single_sample::Counters, holds_all: bool) {
        self.add_receivers(found.receivers.into(), found.outside.into(), holds_all);
        self.add("searches", found.searches.into());
        self.add("interpolated", found.interpolated.into());
        let cut = if holds_all { 0 } else { found.cut_by_border };
        self.add("searches cut by the map's border", cut.into());
        self.add("tiles", found.tiles.into());
        self.add("tiles decided as a whole", found.decided_tiles.into());
    }

    /// The count of that name; `None` if nothing was counted under it.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<u64> {
        self.0.iter().find(|entry| entry.0 == name).map(|entry| entry.1)
    }
}

impl Serialize for Counters {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, count) in &self.0 {
            map.serialize_entry(name, count)?;
        }
        map.end()
    }
}

/// The object that `--stats` writes.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Stats {
    /// Version of the program.
    pub version: &'static str,
    /// Name of the scene, or its path.
    pub scene: String,
    /// Triangles in the scene.
    pub triangles: usize,
    /// Width and height of the picture.
    pub size: [u32; 2],
    /// Side of the light maps.
    pub map_size: u32,
    /// Method, or the methods of several lights with `+` between.
    pub method: String,
    /// The most samples of any light, where a method has any; else 1.
    pub samples: u32,
    /// SIMD level.
    pub simd: &'static str,
    /// Threads.
    pub threads: usize,
    /// Repetitions.
    pub repeat: u32,
    /// Times.
    pub ms: Milliseconds,
    /// Counts of the last repetition.
    pub counters: Counters,
}
