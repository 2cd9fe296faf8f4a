//! What the workspace tests share.

use raster::{DepthBuffer, Payload, Rasterizer, Target};
use reference::{Receivers, Samples, Tracer, truth};
use renderer::scene::Scene;
use renderer::{camera, compare};
use shadowmap_core::{Level, Light, Mesh, Threads, View};

/// Visibility of the pixels that count as penumbra.
pub const PENUMBRA: std::ops::Range<f32> = compare::PENUMBRA[0]..compare::PENUMBRA[1];

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

/// The maps of some views, of their sizes, with object IDs.
pub fn draw(rasterizer: &mut Rasterizer, views: &[View], mesh: &Mesh<'_>) -> Vec<DepthBuffer> {
    let empty = |view: &View| DepthBuffer::new(view.width(), view.height());
    let mut maps: Vec<DepthBuffer> = views.iter().map(empty).collect();
    let mut targets: Vec<Target<'_>> = maps.iter_mut().map(DepthBuffer::target).collect();
    rasterizer.draw_many(views, mesh, Payload::ObjectId, &mut targets);
    maps
}

/// Root of the mean squared difference of pairs of values, of which there must be some hundreds.
pub fn rmse<'a>(pairs: impl Iterator<Item = (&'a f32, &'a f32)>) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (found, truth) in pairs {
        sum += f64::from(found - truth).powi(2);
        count += 1;
    }
    assert!(count > 500, "only {count} pixels to compare");
    (sum / f64::from(count)).sqrt()
}
