//! What methods are measured beside: rays from what a camera sees to a light, and the truth by
//! many.

use reference::{Receivers, Samples, Tracer};
use shadowmap_core::{Light, Mesh, Threads, View};

use crate::compare::compare;

/// Rays per pixel of what errors are measured against.
const TRUTH: u32 = 1024;

/// A light, and what a camera sees.
pub struct Rays<'a> {
    /// Finds what rays hit.
    pub tracer: Tracer<'a>,
    receivers: Receivers,
    light: Light,
    width: u32,
    truth: Vec<f32>,
}

impl<'a> Rays<'a> {
    /// Traces the truth.
    pub fn new(mesh: &Mesh<'a>, light: Light, camera: &View) -> Rays<'a> {
        let tracer = Tracer::new(mesh);
        let receivers = tracer.receivers(camera, Threads::Pool);
        let mut rays = Rays { tracer, receivers, light, width: camera.width(), truth: Vec::new() };
        let mut truth = vec![0.0; rays.receivers.positions.len()];
        rays.trace(TRUTH, Threads::Pool, &mut truth);
        rays.truth = truth;
        rays
    }

    /// Visibility by `count` rays per pixel.
    pub fn trace(&self, count: u32, threads: Threads, out: &mut [f32]) {
        let Receivers { positions, normals, .. } = &self.receivers;
        let samples = Samples::Fixed(count);
        self.tracer.visibility(&self.light, positions, normals, samples, threads, out);
    }

    /// Pixels of the camera.
    pub fn pixels(&self) -> usize {
        self.truth.len()
    }

    /// How far visibility is from the truth within the penumbra.
    pub fn penumbra_rmse(&self, found: &[f32]) -> f64 {
        compare(self.width, found, &self.truth).penumbra_rmse
    }
}
