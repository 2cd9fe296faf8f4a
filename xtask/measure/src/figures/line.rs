//! Visibility along a line across a receiver.

use glam::Vec3;
use renderer::scene::{Scene, SceneLight};
use shadowmap_core::{Threads, View, Window};

use super::stage::Stage;
use super::way::Way;

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
    pub fn truth(&self) -> Vec<(f64, f64)> {
        self.over_x(&self.stage.truth(self.light))
    }

    /// What `way` finds, over x in metres.
    pub fn visibility(&mut self, way: &Way) -> Vec<(f64, f64)> {
        let shadow = self.stage.shadow(self.light, way, 1);
        self.over_x(&shadow.values)
    }

    fn over_x(&self, values: &[f32]) -> Vec<(f64, f64)> {
        let points = self.stage.positions().iter().zip(values);
        points.map(|(position, &value)| (f64::from(position.x), f64::from(value))).collect()
    }
}
