//! One frame: from a scene to what is seen of every light, and to a picture.
//!
//! The stages run in one direction: the camera's pass and, beside it, the depth maps of the first
//! light; the visibility of every pixel, light after light; the picture. All memory is kept between
//! frames.

use std::time::Duration;

use linear_light::VisibilityChannels;
use raster::{DepthBuffer, Payload};
use reference::Tracer;
use shadowmap_core::{Camera, Level, Surfaces, Threads, View, both};

use crate::drawing::{Drawing, Viewer};
use crate::emitters::{Emitter, exposure, push_emitters};
use crate::lighting::LightJob;
use crate::method::Method;
use crate::prepared::Prepared;
use crate::shade::{Pixels, Shading, shade};
use crate::shadow::{FirstMaps, Log, Scene, ShadowStage};
use crate::stats::{Counters, StageTimes, timed};

/// How far a frame goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Goal {
    /// What the camera sees.
    Camera,
    /// The maps of the first sample of the first light.
    LightMap,
    /// The visibility of every light from every pixel.
    Visibility,
    /// A picture in sRGB bytes.
    Srgb,
    /// A picture in linear light.
    Linear,
}

/// What a frame is made from.
#[derive(Clone, Copy, Debug)]
pub struct Shot<'a> {
    /// The scene.
    pub prepared: &'a Prepared<'a>,
    /// The camera, `aa` times as large as the picture along each axis, at most
    /// [`raster::MAX_SIZE`].
    pub camera: &'a View,
    /// Pixels of the camera per pixel of the picture along each axis, from 1 to 16.
    pub aa: u32,
    /// The lights.
    pub lights: &'a [LightJob],
    /// For ray-traced lights: the scene's triangles, ready for rays. Without it nothing is seen of
    /// such lights.
    pub tracer: Option<&'a Tracer<'a>>,
    /// How far to go.
    pub goal: Goal,
}

/// The results of a frame, and the memory to make the next one in.
#[derive(Debug)]
pub struct Frame {
    level: Level,
    threads: Threads,
    /// What the camera and the lights draw with, at the same time.
    camera_drawing: Drawing,
    light_drawing: Drawing,
    /// One map.
    camera: [DepthBuffer; 1],
    visibility: Vec<Vec<f32>>,
    shadow: ShadowStage,
    emitters: Vec<Vec<Emitter>>,
    srgb: Vec<u8>,
    linear: Vec<f32>,
    times: StageTimes,
    counters: Counters,
}

impl Frame {
    /// Memory for frames, still empty. `level` and `threads` never change a result.
    #[must_use]
    pub fn new(level: Level, threads: Threads) -> Frame {
        Frame {
            level,
            threads,
            camera_drawing: Drawing::new(level, threads),
            light_drawing: Drawing::new(level, threads),
            camera: [DepthBuffer::new(0, 0)],
            visibility: Vec::new(),
            shadow: ShadowStage::new(level, threads),
            emitters: Vec::new(),
            srgb: Vec::new(),
            linear: Vec::new(),
            times: StageTimes::default(),
            counters: Counters::default(),
        }
    }

    /// What the camera sees: nearness, and the index of the triangle + 1.
    #[must_use]
    pub fn camera(&self) -> &DepthBuffer {
        &self.camera[0]
    }
    /// The maps that were drawn last for a light, with object IDs.
    #[must_use]
    pub fn maps(&self) -> &[DepthBuffer] {
        self.shadow.maps()
    }
    /// The visibility channels that were drawn last, one set per frustum of a linear light.
    #[must_use]
    pub fn channels(&self) -> &[VisibilityChannels] {
        self.shadow.channels()
    }
    /// Visibility of each light from every pixel of the camera.
    #[must_use]
    pub fn visibility(&self) -> &[Vec<f32>] {
        &self.visibility
    }
    /// The picture of [`Goal::Srgb`].
    #[must_use]
    pub fn srgb(&self) -> &[u8] {
        &self.srgb
    }
    /// The picture of [`Goal::Linear`].
    #[must_use]
    pub fn linear(&self) -> &[f32] {
        &self.linear
    }
    /// How long the stages took.
    #[must_use]
    pub fn times(&self) -> &StageTimes {
        &self.times
    }
    /// What happened.
    #[must_use]
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Makes a frame.
    ///
    /// # Panics
    ///
    /// If the camera or a light's map is larger than [`raster::MAX_SIZE`], or `aa` is out of its
    /// range.
    pub fn render(&mut self, shot: &Shot<'_>) {
        let mut times = StageTimes::default();
        self.counters.clear();
        let mut total = Duration::ZERO;
        timed(&mut total, || self.stages(shot, &mut times));
        times.total = total;
        self.times = times;
    }

    fn stages(&mut self, shot: &Shot<'_>, times: &mut StageTimes) {
        self.draw(shot, times);
        if shot.goal >= Goal::Visibility {
            self.look_from_camera(shot, times);
        }
        if shot.goal >= Goal::Srgb {
            timed(&mut times.shade, || self.shade(shot));
        }
    }

    /// Draws what the camera sees and, beside it, the maps that the first light needs first.
    fn draw(&mut self, shot: &Shot<'_>, times: &mut StageTimes) {
        let first = shot.lights.first().filter(|_| shot.goal > Goal::Camera);
        let prepared = shot.prepared;
        let Frame { camera_drawing, light_drawing, camera, shadow, counters, .. } = self;
        let camera = || {
            let views = std::slice::from_ref(shot.camera);
            camera_drawing.draw(prepared, Viewer::Camera, views, Payload::TriangleIndex, camera)
        };
        let light = || {
            let Some(light) = first else { return };
            let mut log = Log { times, counters, holds_all: false };
            // Whoever only wants to see maps is shown those of one frustum.
            let groups = match shot.goal {
                Goal::LightMap => vec![light.plan.first_views()],
                _ => light.plan.first_maps(),
            };
            let searched = light.method == Method::Search && shot.goal > Goal::LightMap;
            shadow.draw_maps(light_drawing, prepared, &groups, searched, &mut log);
        };
        let (mut together, mut of_camera) = (Duration::ZERO, Duration::ZERO);
        let (drawn, ()) =
            timed(&mut together, || both(self.threads, || timed(&mut of_camera, camera), light));
        counters.add("triangles drawn for the camera", drawn);
        times.share(together, of_camera);
    }

    /// Finds what every pixel of the camera sees of each light. The maps that the first light needs
    /// first are there.
    fn look_from_camera(&mut self, shot: &Shot<'_>, times: &mut StageTimes) {
        let surfaces = Surfaces::Table(shot.prepared.surfaces());
        let camera = Camera::new(shot.camera, self.camera[0].as_depth_map(), surfaces)
            .expect("the camera's pass is drawn in the size of its view");
        let scene = Scene { prepared: shot.prepared, camera, tracer: shot.tracer };
        let mut log = Log { times, counters: &mut self.counters, holds_all: false };
        self.visibility.resize_with(shot.lights.len(), Vec::new);
        for (index, (light, out)) in shot.lights.iter().zip(&mut self.visibility).enumerate() {
            out.resize(camera.map().nearness().len(), 0.0);
            let first = if index == 0 { FirstMaps::Drawn } else { FirstMaps::Missing };
            self.shadow.visibility(&mut self.light_drawing, &scene, light, first, &mut log, out);
        }
    }

    fn shade(&mut self, shot: &Shot<'_>) {
        let bounds = shot.prepared.bounds();
        let exposure = exposure(shot.lights.iter().map(|job| &job.light), bounds);
        self.emitters.resize_with(shot.lights.len(), Vec::new);
        for (job, emitters) in shot.lights.iter().zip(&mut self.emitters) {
            emitters.clear();
            push_emitters(&job.light, exposure, emitters);
        }
        let shading = Shading {
            prepared: shot.prepared,
            camera: shot.camera,
            map: self.camera[0].as_depth_map(),
            emitters: &self.emitters,
            visibility: &self.visibility,
            aa: shot.aa,
        };
        let (width, height) = (shot.camera.width() / shot.aa, shot.camera.height() / shot.aa);
        let values = 3 * width as usize * height as usize;
        let pixels = if shot.goal == Goal::Linear {
            self.linear.resize(values, 0.0);
            Pixels::Linear(&mut self.linear)
        } else {
            self.srgb.resize(values, 0);
            Pixels::Srgb(&mut self.srgb)
        };
        shade(&shading, self.level, self.threads, pixels);
    }
}
