//! Where the picture is taken from.

use glam::Vec3;
use shadowmap_core::{View, Window};

use crate::Error;
use crate::scene::{Bounds, CameraProjection, Scene, SceneCamera};

/// What replaces parts of a scene's own camera.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraOptions {
    /// Where it stands.
    pub eye: Option<Vec3>,
    /// What it looks at.
    pub target: Option<Vec3>,
    /// Vertical field of view in radians.
    pub vertical_fov: Option<f32>,
}

/// The scene's camera, or one that has the whole scene in sight, changed by `options`.
///
/// # Errors
///
/// If the camera stands where it looks at.
pub fn choose(scene: &Scene, options: &CameraOptions) -> Result<SceneCamera, Error> {
    let mut camera = match scene.camera {
        Some(camera) => camera,
        None => fitted(scene.bounds(), options.vertical_fov),
    };
    if let Some(target) = options.target {
        camera.target = target;
    }
    if let Some(eye) = options.eye {
        camera.eye = eye;
        if options.target.is_none() && scene.camera.is_none() {
            camera.target = scene.bounds().map_or(Vec3::ZERO, |bounds| bounds.center());
        }
    }
    if let Some(vertical_fov) = options.vertical_fov {
        camera.projection = CameraProjection::Perspective { vertical_fov };
    }
    let distance = camera.eye.distance(camera.target);
    if !(distance.is_finite() && distance > 1e-6 * (1.0 + camera.eye.length())) {
        let [x, y, z] = camera.eye.to_array();
        return Err(Error::new(format_args!("--eye {x},{y},{z}: the camera stands at its target")));
    }
    Ok(camera)
}

/// A camera in front of and above the scene, as far away as it takes to see all of it.
fn fitted(bounds: Option<Bounds>, vertical_fov: Option<f32>) -> SceneCamera {
    let vertical_fov = vertical_fov.unwrap_or_else(|| 40f64.to_radians() as f32);
    let bounds = bounds.unwrap_or(Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE });
    let radius = (bounds.extent().length() * 0.5).max(1e-3);
    let distance = radius / libm::sin(f64::from(vertical_fov) * 0.5) as f32;
    let from = Vec3::new(0.30, 0.42, 0.86);
    SceneCamera {
        eye: bounds.center() + from * distance,
        target: bounds.center(),
        up: Vec3::Y,
        projection: CameraProjection::Perspective { vertical_fov },
    }
}

/// The view of a camera onto `width * height` pixels. `bounds` are the scene's: they say how near
/// and how far away something can be.
#[must_use]
pub fn view(camera: &SceneCamera, [width, height]: [u32; 2], bounds: Option<Bounds>) -> View {
    let forward = camera.target - camera.eye;
    let reach = reach(camera.eye, bounds).max(forward.length());
    match camera.projection {
        CameraProjection::Perspective { vertical_fov } => {
            let near = reach * 1e-4;
            View::perspective(
                camera.eye,
                camera.target,
                camera.up,
                vertical_fov,
                width,
                height,
                near,
            )
        }
        CameraProjection::Orthographic { height: metres } => {
            let half_height = metres * 0.5;
            let half_width = half_height * width as f32 / height as f32;
            View::orthographic_window(
                camera.eye,
                View::axes_towards(forward, camera.up),
                Window::centered(half_width, half_height),
                width,
                height,
                [0.0, reach * 1.01],
            )
        }
    }
}

/// How far the farthest corner of the bounds is from `eye`; 1 without bounds.
#[must_use]
pub fn reach(eye: Vec3, bounds: Option<Bounds>) -> f32 {
    let Some(Bounds { min, max }) = bounds else { return 1.0 };
    (min - eye).abs().max((max - eye).abs()).length().max(1e-6)
}
