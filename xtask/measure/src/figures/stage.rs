//! A scene on stage: a camera before it, its truth, and what every method makes of its light.

use std::time::{Duration, Instant};

use glam::Vec3;
use raster::DepthBuffer;
use reference::{Samples, Tracer, truth};
use renderer::camera::{CameraOptions, choose, view};
use renderer::compare::Comparison;
use renderer::frame::{Frame, Goal, Shot};
use renderer::lighting::LightJob;
use renderer::prepared::Prepared;
use renderer::receivers;
use renderer::scene::{Scene, SceneLight};
use renderer::stats::StageTimes;
use shadowmap_core::{Camera, Level, Light, Surfaces, Threads, View};

use super::way::Way;
use crate::compare::compare;
use crate::picture::Picture;

/// What takes longer is not repeated.
const PATIENCE: Duration = Duration::from_millis(300);

/// A scene, its camera, and memory to draw frames in.
pub struct Stage<'a> {
    prepared: Prepared<'a>,
    tracer: Tracer<'a>,
    view: View,
    frame: Frame,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

/// What one way of making shadows says of every pixel.
pub struct Shadow {
    /// Visibility, row-major.
    pub values: Vec<f32>,
    /// Milliseconds for maps, channels and visibility: all that the shadows cost.
    pub milliseconds: f64,
}

impl<'a> Stage<'a> {
    /// The scene before its own camera, `size` pixels wide and high.
    pub fn new(scene: &'a Scene, size: u32) -> Stage<'a> {
        let camera = choose(scene, &CameraOptions::default()).expect("figures have good cameras");
        let camera = view(&camera, [size, size], scene.bounds());
        Stage::with_camera(scene, camera, Threads::Pool)
    }

    /// The scene before any camera.
    pub fn with_camera(scene: &'a Scene, camera: View, threads: Threads) -> Stage<'a> {
        let prepared = Prepared::new(scene);
        let tracer = Tracer::new(&scene.mesh.as_mesh());
        let mut stage = Stage {
            prepared,
            tracer,
            view: camera,
            frame: Frame::new(Level::detect(), threads),
            positions: Vec::new(),
            normals: Vec::new(),
        };
        stage.draw(&[], Goal::Camera);
        let count = camera.width() as usize * camera.height() as usize;
        let (mut positions, mut normals) = (vec![Vec3::ZERO; count], vec![Vec3::ZERO; count]);
        receivers::world(&stage.camera(), threads, &mut positions, &mut normals);
        Stage { positions, normals, ..stage }
    }

    /// What the camera sees.
    pub fn camera(&self) -> Camera<'_> {
        let surfaces = Surfaces::Table(self.prepared.surfaces());
        let map = self.frame.camera().as_depth_map();
        Camera::new(&self.view, map, surfaces).expect("drawn in the camera's size")
    }

    /// The map that `way` takes of a light, and where from. If it takes several, the first.
    pub fn light_map(&mut self, light: &SceneLight, way: &Way) -> (View, DepthBuffer) {
        let jobs = self.jobs(std::slice::from_ref(light), way);
        self.draw(&jobs, Goal::LightMap);
        (jobs[0].plan.first_views()[0], self.frame.maps()[0].clone())
    }

    /// Pixels per row.
    pub fn width(&self) -> usize {
        self.view.width() as usize
    }

    /// World positions of all pixels.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Geometric normals of all pixels.
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// The first light of the scene of the same kind as `like`.
    pub fn light(&self, is: impl Fn(&Light) -> bool) -> &'a SceneLight {
        let found = self.prepared.scene().lights.iter().find(|light| is(&light.light));
        found.expect("the scene has such a light")
    }

    /// What 4096 rays per pixel see of a light.
    pub fn truth(&self, light: &SceneLight) -> Vec<f32> {
        let mesh = self.prepared.scene().mesh.as_mesh();
        truth::cached(&mesh, &self.positions, &self.normals, &light.light, Samples::TRUTH)
    }

    /// The shadows of lights, made one way; of several lights that stand for one, the mean. The
    /// time is the best of `repeats`, fewer if they take long.
    pub fn shadow(&mut self, lights: &[SceneLight], way: &Way, repeats: usize) -> Shadow {
        let milliseconds = self.best(lights, way, repeats, Goal::Visibility, |times| {
            times.light_maps + times.visibility_channel + times.shadow
        });
        let each = self.frame.visibility();
        let mean = |i| each.iter().map(|values| values[i]).sum::<f32>() / each.len() as f32;
        Shadow { values: (0..self.positions.len()).map(mean).collect(), milliseconds }
    }

    /// Milliseconds for a whole frame: camera pass, map, shadows and shading. The best of
    /// `repeats`, fewer if they take long.
    pub fn frame_milliseconds(&mut self, light: &SceneLight, way: &Way, repeats: usize) -> f64 {
        self.best(std::slice::from_ref(light), way, repeats, Goal::Srgb, |times| times.total)
    }

    fn best(
        &mut self,
        lights: &[SceneLight],
        way: &Way,
        repeats: usize,
        goal: Goal,
        time: impl Fn(&StageTimes) -> Duration,
    ) -> f64 {
        let jobs = self.jobs(lights, way);
        let start = Instant::now();
        let mut best = Duration::MAX;
        for _ in 0..repeats.max(1) {
            self.draw(&jobs, goal);
            best = best.min(time(self.frame.times()));
            if start.elapsed() > PATIENCE {
                break;
            }
        }
        best.as_secs_f64() * 1e3
    }

    /// The picture with such shadows.
    pub fn picture(&mut self, lights: &[SceneLight], way: &Way) -> Picture {
        let jobs = self.jobs(lights, way);
        self.draw(&jobs, Goal::Srgb);
        Picture::srgb(self.width(), self.frame.srgb())
    }

    /// How far `found` is from `truth`.
    pub fn compare(&self, found: &[f32], truth: &[f32]) -> Comparison {
        compare(self.view.width(), found, truth)
    }

    fn jobs(&self, lights: &[SceneLight], way: &Way) -> Vec<LightJob> {
        let job = |light| LightJob::new(light, &way.options(), &self.prepared, &self.view);
        let jobs: Result<_, _> = lights.iter().map(job).collect();
        jobs.expect("figures draw each light with methods that fit it")
    }

    fn draw(&mut self, lights: &[LightJob], goal: Goal) {
        let (prepared, camera) = (&self.prepared, &self.view);
        let tracer = Some(&self.tracer);
        self.frame.render(&Shot { prepared, camera, aa: 1, lights, tracer, goal });
    }
}
