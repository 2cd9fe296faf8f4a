//! Where the picture is taken from.

use glam::Vec3;
use raster::{DepthBuffer, Payload};
use shadowmap_core::{Level, Threads, View, Window};

use crate::Error;
use crate::drawing::{Drawing, Viewer};
use crate::prepared::Prepared;
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
        None => fitted(scene, options.vertical_fov),
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

/// A camera that has the whole scene in sight from above: from its front, or from another side if
/// clearly more objects are seen from there, as in a room that is open to one side.
fn fitted(scene: &Scene, vertical_fov: Option<f32>) -> SceneCamera {
    let vertical_fov = vertical_fov.unwrap_or_else(|| 40f64.to_radians() as f32);
    let bounds = scene.bounds().unwrap_or(Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE });
    let radius = (bounds.extent().length() * 0.5).max(1e-3);
    let distance = radius / libm::sin(f64::from(vertical_fov) * 0.5) as f32;
    let sides = [(0.30, 0.86), (-0.86, 0.30), (0.86, -0.30), (-0.30, -0.86)];
    let looks = sides.map(|(x, z)| SceneCamera {
        eye: bounds.center() + Vec3::new(x, 0.42, z) * distance,
        target: bounds.center(),
        up: Vec3::Y,
        projection: CameraProjection::Perspective { vertical_fov },
    });
    let prepared = Prepared::new(scene);
    let seen = looks.map(|look| objects_in_sight(&prepared, &look));
    let best = (1..looks.len()).max_by_key(|&side| seen[side]).unwrap_or(0);
    looks[if 2 * seen[best] > 3 * seen[0] { best } else { 0 }]
}

/// How many objects a camera sees in a small picture.
fn objects_in_sight(prepared: &Prepared<'_>, camera: &SceneCamera) -> usize {
    let view = view(camera, [128, 128], prepared.bounds());
    let mut map = [DepthBuffer::new(0, 0)];
    let mut drawing = Drawing::new(Level::detect(), Threads::One);
    drawing.draw(prepared, Viewer::Camera, &[view], Payload::ObjectId, &mut map);
    let mut ids = map[0].payload.to_vec();
    ids.sort_unstable();
    ids.dedup();
    ids.len()
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
