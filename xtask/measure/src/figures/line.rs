//! Visibility along a line across a receiver.

use glam::Vec3;
use renderer::scene::{Scene, SceneLight};
use shadowmap_core::{Threads, View, Window};

use super::samples::Samples;
use super::stage::Stage;
use super::way::Way;

/// Values over x in metres.
pub type Points = Vec<(f64, f64)>;

/// A row of pixels that looks straight down on the receivers below one line along x.
pub struct Line<'a> {
    stage: Stage<'a>,
    light: &'a SceneLight,
}

impl<'a> Line<'a> {
    /// `count` points between the two values of x, at depth `z`, looked at from `height`: above the
    /// receivers and below the blockers.
    pub fn new(scene: &'a Scene, [left, right]: [f32; 2], z: f32, height: f32, count: u32) -> Self {
        let half = (right - left) / count as f32 * 0.5;
        let camera = View::orthographic_window(
            Vec3::new(0.0, height, z),
            View::axes_towards(Vec3::NEG_Y, Vec3::NEG_Z),
            Window { left, right, top: -half, bottom: half },
            count,
            1,
            [0.0, height + 10.0],
        );
        Line { stage: Stage::with_camera(scene, camera, Threads::One), light: &scene.lights[0] }
    }

    /// The truth, over x in metres.
    pub fn truth(&self) -> Points {
        self.over_x(&self.stage.truth(self.light))
    }

    /// What `way` finds, over x in metres.
    pub fn visibility(&mut self, way: &Way) -> Points {
        let shadow = self.stage.shadow(std::slice::from_ref(self.light), way, 1);
        self.over_x(&shadow.values)
    }

    /// What each of the light's samples contributes, and the sum of all, over x in metres.
    pub fn contributions(&self, samples: &Samples) -> (Vec<Points>, Points) {
        let parts = samples.contributions(self.stage.positions(), self.stage.normals());
        let sum = |i: usize| parts.iter().map(|part| part[i]).sum();
        let all: Vec<f32> = (0..self.stage.positions().len()).map(sum).collect();
        (parts.iter().map(|part| self.over_x(part)).collect(), self.over_x(&all))
    }

    fn over_x(&self, values: &[f32]) -> Points {
        let points = self.stage.positions().iter().zip(values);
        points.map(|(position, &value)| (f64::from(position.x), f64::from(value))).collect()
    }
}
