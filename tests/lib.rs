//! What the workspace tests share.

use raster::{DepthBuffer, Payload, Rasterizer};
use reference::{Receivers, Samples, Tracer, truth};
use renderer::camera;
use renderer::scene::Scene;
use shadowmap_core::{Level, Light, Threads, View};

/// Visibility of the pixels that count as penumbra.
pub const PENUMBRA: std::ops::Range<f32> = 0.002..0.998;

/// A scene with a linear light, and what its camera sees.
pub struct Stage {
    /// What is drawn.
    pub scene: Scene,
    /// The camera.
    pub view: View,
    /// Nearness, and the index of the triangle + 1.
    pub image: DepthBuffer,
    /// The same by rays.
    pub receivers: Receivers,
}

impl Stage {
    /// The scene before its own camera, `size` pixels wide and high.
    #[must_use]
    pub fn of(scene: Scene, size: u32) -> Stage {
        let view = camera::view(&scene.camera.unwrap(), [size; 2], scene.bounds());
        let mut image = DepthBuffer::new(size, size);
        let mesh = scene.mesh.as_mesh();
        let mut rasterizer = Rasterizer::new(Level::detect(), Threads::Pool);
        rasterizer.draw(&view, &mesh, Payload::TriangleIndex, image.target());
        let receivers = Tracer::new(&mesh).receivers(&view, Threads::Pool);
        Stage { scene, view, image, receivers }
    }

    /// The scene's first linear light.
    #[must_use]
    pub fn linear(&self) -> Light {
        let linear = |light: &&Light| matches!(light, Light::Linear { .. });
        *self.scene.lights.iter().map(|light| &light.light).find(linear).unwrap()
    }

    /// What 4096 rays per pixel see of a light.
    #[must_use]
    pub fn truth(&self, light: &Light) -> Vec<f32> {
        let Receivers { positions, normals, .. } = &self.receivers;
        truth::cached(&self.scene.mesh.as_mesh(), positions, normals, light, Samples::TRUTH)
    }
}
