//! Lights for scenes that have none.

use glam::Vec3;
use shadowmap_core::{Level, Light, Threads};

use crate::camera::view;
use crate::frame::{Frame, Goal, Shot};
use crate::lighting::{LightJob, LightOptions};
use crate::method::Method;
use crate::prepared::Prepared;
use crate::scene::{Bounds, Scene, SceneCamera, SceneLight};

/// Where the light stands if most of what is seen from elsewhere would be dark: as fractions of the
/// scene's bounds, under the ceiling of what may be a room.
const UNDER_THE_CEILING: Vec3 = Vec3::new(0.5, 0.85, 0.5);

/// Two lights at one place to choose from, a sphere and a linear light. They stand outside, above
/// what `camera` sees and to its right; or inside, where clearly more of it is lit from there.
#[must_use]
pub fn default_lights(scene: &Scene, camera: &SceneCamera) -> Vec<SceneLight> {
    let bounds = scene.bounds().unwrap_or(Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE });
    let unit = (bounds.extent().max_element() * 0.25).max(1e-3);
    let foot = bounds.center().with_y(bounds.min.y);
    let toward_viewer = (camera.eye - camera.target).with_y(0.0).normalize_or(Vec3::Z);
    let right = Vec3::Y.cross(toward_viewer);
    let outside = foot + (right * 2.0 + Vec3::Y * 8.0 + toward_viewer * 3.0) * unit;
    let inside = bounds.min + bounds.extent() * UNDER_THE_CEILING;
    let prepared = Prepared::new(scene);
    let [lit_from_outside, lit_from_inside] =
        [outside, inside].map(|position| lit(&prepared, camera, position));
    if lit_from_inside > 1.2 * lit_from_outside {
        lights(inside, right, 0.4 * unit)
    } else {
        lights(outside, right, unit)
    }
}

/// A sphere light of radius `unit / 2` and a linear light of length `2 unit` along `along`.
fn lights(center: Vec3, along: Vec3, unit: f32) -> Vec<SceneLight> {
    let light = |name: &str, light| SceneLight {
        name: name.to_owned(),
        light,
        color: Vec3::ONE,
        intensity: 1.0,
        spot: None,
    };
    let (a, b) = (center - along * unit, center + along * unit);
    vec![
        light("sphere", Light::Sphere { center, radius: 0.5 * unit }),
        light("tube", Light::Linear { a, b }),
    ]
}

/// Of what a camera sees in a small picture, the part that a point at `position` lights.
fn lit(prepared: &Prepared<'_>, camera: &SceneCamera, position: Vec3) -> f32 {
    let light = SceneLight {
        name: String::new(),
        light: Light::Point { position },
        color: Vec3::ONE,
        intensity: 1.0,
        spot: None,
    };
    let options =
        LightOptions { method: Some(Method::Hard), map_size: 256, ..LightOptions::default() };
    let camera = view(camera, [128, 128], prepared.bounds());
    let Ok(job) = LightJob::new(&light, &options, prepared, &camera) else { return 0.0 };
    let mut frame = Frame::new(Level::detect(), Threads::One);
    frame.render(&Shot {
        prepared,
        camera: &camera,
        aa: 1,
        lights: &[job],
        tracer: None,
        goal: Goal::Visibility,
    });
    let seen = frame.camera().nearness.iter().filter(|&&n| n > 0.0).count().max(1);
    frame.visibility()[0].iter().sum::<f32>() / seen as f32
}
