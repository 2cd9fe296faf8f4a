//! Built-in scenes, set up as the program does.

use renderer::builtin;
use renderer::camera::{CameraOptions, choose, view};
use renderer::frame::{Goal, Shot};
use renderer::lighting::{LightJob, LightOptions};
use renderer::method::Method;
use renderer::prepared::Prepared;
use renderer::scene::{Scene, SceneLight};
use shadowmap_core::{Light, View};

/// The scene of that name.
pub fn scene(name: &str) -> Scene {
    builtin::scene(name).expect("a built-in scene")
}

/// The scene's own camera, with a square picture.
pub fn camera(scene: &Scene, side: u32) -> View {
    let camera = choose(scene, &CameraOptions::default()).expect("built-in scenes have cameras");
    view(&camera, [side; 2], scene.bounds())
}

/// The scene's light that is linear, or that is not.
pub fn light(scene: &Scene, linear: bool) -> &SceneLight {
    let suits = |light: &Light| matches!(light, Light::Linear { .. }) == linear;
    let light = scene.lights.iter().find(|light| suits(&light.light));
    light.expect("built-in scenes have both kinds of light")
}

/// A frame of a built-in scene under one of its lights.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// The scene's name.
    pub scene: &'static str,
    /// How its shadow is drawn; chooses the light.
    pub method: Method,
    /// Pixels of the picture along either axis.
    pub camera: u32,
    /// Texels of the light's maps along either axis.
    pub map: u32,
    /// Samples of a linear light.
    pub samples: Option<u32>,
}

impl Setup {
    /// Gives `draw` what a frame needs.
    pub fn with_shot<R>(&self, draw: impl FnOnce(&Shot<'_>) -> R) -> R {
        let scene = scene(self.scene);
        let prepared = Prepared::new(&scene);
        let camera = camera(&scene, self.camera);
        let linear = matches!(self.method, Method::Skins | Method::Intervals);
        let options = LightOptions {
            method: Some(self.method),
            samples: self.samples,
            map_size: self.map,
            ..LightOptions::default()
        };
        let job = LightJob::new(light(&scene, linear), &options, &prepared, &camera);
        let lights = [job.expect("the method knows the light")];
        draw(&Shot {
            prepared: &prepared,
            camera: &camera,
            aa: 1,
            lights: &lights,
            tracer: None,
            goal: Goal::Srgb,
        })
    }
}
