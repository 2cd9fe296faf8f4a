//! One frame: from a scene to what is seen of every light, and to a picture.
//!
//! The stages run in one direction: the camera's pass, the depth maps of the lights, the visibility
//! of every pixel, the picture. All memory is kept between frames.

use std::time::Duration;

use raster::{DepthBuffer, Payload, Rasterizer};
use reference::Tracer;
use shadowmap_core::{Camera, Level, Mesh, Surfaces, Threads, View};

use crate::emitters::{Emitter, exposure, push_emitters};
use crate::lighting::LightJob;
use crate::method::Method;
use crate::prepared::Prepared;
use crate::shade::{Pixels, Shading, shade};
use crate::shadow::ShadowStage;
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
    /// The camera, `aa` times as large as the picture along each axis.
    pub camera: &'a View,
    /// Pixels of the camera per pixel of the picture along each axis.
    pub aa: u32,
    /// The lights.
    pub lights: &'a [LightJob],
    /// For ray-traced lights: the scene's triangles, ready for rays.
    pub tracer: Option<&'a Tracer<'a>>,
    /// How far to go.
    pub goal: Goal,
}

/// The results of a frame, and the memory to make the next one in.
#[derive(Debug)]
pub struct Frame {
    level: Level,
    threads: Threads,
    rasterizer: Rasterizer,
    camera: DepthBuffer,
    front_faces: Vec<[u32; 3]>,
    maps: Vec<DepthBuffer>,
    visibility: Vec<Vec<f32>>,
    /// Visibility of one of several samples.
    sample: Vec<f32>,
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
            rasterizer: Rasterizer::new(level, threads),
            camera: DepthBuffer::new(0, 0),
            front_faces: Vec::new(),
            maps: Vec::new(),
            visibility: Vec::new(),
            sample: Vec::new(),
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
        &self.camera
    }
    /// The maps of the light that was drawn last, one per face, with object IDs.
    #[must_use]
    pub fn maps(&self) -> &[DepthBuffer] {
        &self.maps
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
    pub fn render(&mut self, shot: &Shot<'_>) {
        let mut times = StageTimes::default();
        self.counters.clear();
        let mut total = Duration::ZERO;
        timed(&mut total, || self.stages(shot, &mut times));
        times.total = total;
        self.times = times;
    }

    fn stages(&mut self, shot: &Shot<'_>, times: &mut StageTimes) {
        timed(&mut times.camera_pass, || self.draw_camera(shot));
        match shot.goal {
            Goal::Camera => {}
            Goal::LightMap => {
                if let Some(views) = shot.lights.first().and_then(|light| light.views.first()) {
                    timed(&mut times.light_maps, || self.draw_maps(shot, views));
                }
            }
            Goal::Visibility => self.draw_lights(shot, times),
            Goal::Srgb | Goal::Linear => {
                self.draw_lights(shot, times);
                timed(&mut times.shade, || self.shade(shot));
            }
        }
    }

    fn draw_camera(&mut self, shot: &Shot<'_>) {
        let mut mesh = shot.prepared.scene().mesh.as_mesh();
        if let Some(triangles) = shot.prepared.front_faces(shot.camera, &mut self.front_faces) {
            mesh = Mesh { triangles, ..mesh };
        }
        let (rasterizer, camera) = (&mut self.rasterizer, &mut self.camera);
        let drawn =
            draw(rasterizer, shot.prepared, &mesh, shot.camera, Payload::TriangleIndex, camera);
        self.counters.add("triangles drawn for the camera", drawn);
    }

    fn draw_maps(&mut self, shot: &Shot<'_>, views: &[View]) {
        let mesh = shot.prepared.scene().mesh.as_mesh();
        self.maps.resize_with(views.len(), || DepthBuffer::new(0, 0));
        for (view, map) in views.iter().zip(&mut self.maps) {
            let rasterizer = &mut self.rasterizer;
            let drawn = draw(rasterizer, shot.prepared, &mesh, view, Payload::ObjectId, map);
            self.counters.add("light maps", 1);
            self.counters.add("triangles drawn for lights", drawn);
        }
    }

    fn draw_lights(&mut self, shot: &Shot<'_>, times: &mut StageTimes) {
        let pixels = self.camera.nearness.len();
        self.visibility.resize_with(shot.lights.len(), Vec::new);
        for (index, light) in shot.lights.iter().enumerate() {
            // Taken out, so that the rest of the frame can be borrowed beside it.
            let mut out = std::mem::take(&mut self.visibility[index]);
            out.resize(pixels, 0.0);
            self.draw_light(shot, light, times, &mut out);
            self.visibility[index] = out;
        }
    }

    fn draw_light(
        &mut self,
        shot: &Shot<'_>,
        light: &LightJob,
        times: &mut StageTimes,
        out: &mut [f32],
    ) {
        match (light.method, shot.tracer) {
            (Method::RayTraced, Some(tracer)) => {
                let camera = receivers(&self.camera, shot);
                timed(&mut times.shadow, || {
                    self.shadow.by_rays(&camera, light, tracer, &mut self.counters, out);
                });
            }
            (Method::RayTraced, None) => out.fill(0.0),
            _ if light.views.len() == 1 => {
                let views = &light.views[0];
                timed(&mut times.light_maps, || self.draw_maps(shot, views));
                let (camera, counters) = (receivers(&self.camera, shot), &mut self.counters);
                timed(&mut times.shadow, || {
                    self.shadow.by_maps(&camera, light, views, &self.maps, counters, out);
                });
            }
            _ => {
                out.fill(0.0);
                let weight = 1.0 / light.views.len() as f32;
                let mut sample = std::mem::take(&mut self.sample);
                sample.resize(out.len(), 0.0);
                for views in &light.views {
                    timed(&mut times.light_maps, || self.draw_maps(shot, views));
                    let (camera, counters) = (receivers(&self.camera, shot), &mut self.counters);
                    let (shadow, maps) = (&mut self.shadow, &self.maps);
                    timed(&mut times.shadow, || {
                        shadow.by_maps(&camera, light, views, maps, counters, &mut sample);
                        for (out, sample) in out.iter_mut().zip(&sample) {
                            *out += weight * *sample;
                        }
                    });
                }
                self.sample = sample;
            }
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
            map: self.camera.as_depth_map(),
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

/// The camera's pass as the methods take it.
fn receivers<'a>(camera: &'a DepthBuffer, shot: &'a Shot<'a>) -> Camera<'a> {
    let surfaces = Surfaces::Table(shot.prepared.surfaces());
    Camera::new(shot.camera, camera.as_depth_map(), surfaces)
        .expect("the camera's pass is drawn in the size of its view")
}

/// Draws one map in the size of its view. Returns how many triangles were drawn.
fn draw(
    rasterizer: &mut Rasterizer,
    prepared: &Prepared<'_>,
    mesh: &Mesh<'_>,
    view: &View,
    payload: Payload,
    map: &mut DepthBuffer,
) -> u64 {
    if (map.width(), map.height()) != (view.width(), view.height()) {
        *map = DepthBuffer::new(view.width(), view.height());
    }
    let (views, targets) = (std::slice::from_ref(view), &mut [map.target()]);
    let stats = prepared.with_alpha_mask(|mask| match mask {
        Some(mask) => rasterizer.draw_masked(views, mesh, mask, payload, targets),
        None => rasterizer.draw_many(views, mesh, payload, targets),
    });
    stats.drawn as u64
}
