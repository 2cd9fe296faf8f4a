//! What a frame is written out as.

use glam::Vec3;
use shadowmap_core::{Camera, Surfaces, Threads};

use crate::Error;
use crate::frame::{Frame, Goal, Shot};
use crate::picture::{Display, Picture, Values, floats};
use crate::receivers;

/// What to write, as `--pass` names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pass {
    /// The shaded picture.
    Beauty,
    /// The mean visibility of all lights.
    Visibility,
    /// Planar depth in metres; 0 where nothing is hit.
    Depth,
    /// Object IDs; 0 where nothing is hit.
    Ids,
    /// Geometric normals towards the viewer, in world space.
    Normals,
    /// Depth in metres in the first map of the first light; 0 where there is nothing.
    LightDepth,
    /// Object IDs in the first map of the first light.
    LightIds,
    /// The visibility channels of the first light, drawn with skins.
    VisibilityChannel,
}

impl Pass {
    /// All passes, in the order in which `--help` lists them.
    pub const ALL: [Pass; 8] = [
        Pass::Beauty,
        Pass::Visibility,
        Pass::Depth,
        Pass::Ids,
        Pass::Normals,
        Pass::LightDepth,
        Pass::LightIds,
        Pass::VisibilityChannel,
    ];

    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Pass::Beauty => "beauty",
            Pass::Visibility => "visibility",
            Pass::Depth => "depth",
            Pass::Ids => "ids",
            Pass::Normals => "normals",
            Pass::LightDepth => "light-depth",
            Pass::LightIds => "light-ids",
            Pass::VisibilityChannel => "visibility-channel",
        }
    }

    /// The pass of that name.
    ///
    /// # Errors
    ///
    /// If there is none; the text lists those that there are.
    pub fn parse(name: &str) -> Result<Pass, Error> {
        Pass::ALL.into_iter().find(|pass| pass.name() == name).ok_or_else(|| {
            let names = Pass::ALL.map(Pass::name).join(", ");
            Error::new(format_args!("--pass {name}: no such pass; there are {names}"))
        })
    }

    /// Whether several samples per pixel can be averaged. The others are data at pixel centres.
    #[must_use]
    pub fn is_antialiased(self) -> bool {
        matches!(self, Pass::Beauty | Pass::Visibility)
    }

    /// How far a frame must go for it, for a file of bytes or of floats.
    #[must_use]
    pub fn goal(self, float_file: bool) -> Goal {
        match self {
            Pass::Beauty if float_file => Goal::Linear,
            Pass::Beauty => Goal::Srgb,
            Pass::Visibility | Pass::VisibilityChannel => Goal::Visibility,
            Pass::Depth | Pass::Ids | Pass::Normals => Goal::Camera,
            Pass::LightDepth | Pass::LightIds => Goal::LightMap,
        }
    }

    /// The picture of a frame that went as far as [`Pass::goal`] says. Several maps of one light
    /// stand below each other.
    #[must_use]
    pub fn picture(self, frame: &Frame, shot: &Shot<'_>, threads: Threads) -> Picture {
        let (aa, camera) = (shot.aa, frame.camera());
        let size = [camera.width() / aa, camera.height() / aa];
        match self {
            Pass::Beauty if shot.goal == Goal::Linear => {
                floats(size, 3, frame.linear().to_vec(), Display::Light)
            }
            Pass::Beauty => {
                let ([width, height], values) = (size, Values::Bytes(frame.srgb().to_vec()));
                Picture { width, height, channels: 3, values }
            }
            Pass::Visibility => floats(size, 1, mean_visibility(frame, aa), Display::Unit),
            Pass::Depth => {
                let depth =
                    |&n: &f32| if n > 0.0 { shot.camera.depth_from_nearness(n) } else { 0.0 };
                floats(size, 1, camera.nearness.iter().map(depth).collect(), Display::Depth)
            }
            Pass::Ids => {
                let surfaces = shot.prepared.surfaces();
                let id = |&index: &u32| surfaces.get(index as usize).map_or(0, |s| s.id) as f32;
                floats(size, 1, camera.payload.iter().map(id).collect(), Display::Labels)
            }
            Pass::Normals => {
                let surfaces = Surfaces::Table(shot.prepared.surfaces());
                let camera = Camera::new(shot.camera, camera.as_depth_map(), surfaces)
                    .expect("the camera's pass is drawn in the size of its view");
                let count = camera.map().nearness().len();
                let mut positions = vec![Vec3::ZERO; count];
                let mut normals = vec![Vec3::ZERO; count];
                receivers::world(&camera, threads, &mut positions, &mut normals);
                floats(size, 3, bytemuck::cast_slice(&normals).to_vec(), Display::Signed)
            }
            Pass::LightDepth | Pass::LightIds => light_map(self, frame, shot),
            Pass::VisibilityChannel => channels(frame),
        }
    }
}

fn light_map(pass: Pass, frame: &Frame, shot: &Shot<'_>) -> Picture {
    let views = shot.lights.first().map_or(&[][..], |light| light.plan.first_views());
    let maps = frame.maps().iter().zip(views);
    let width = frame.maps().first().map_or(0, |map| map.width());
    let height = frame.maps().iter().map(|map| map.height()).sum();
    let (values, display) = if pass == Pass::LightIds {
        let ids = maps.flat_map(|(map, _)| map.payload.iter().map(|&id| id as f32));
        (ids.collect(), Display::Labels)
    } else {
        let depths = maps.flat_map(|(map, view)| {
            map.nearness.iter().map(|&n| if n > 0.0 { view.depth_from_nearness(n) } else { 0.0 })
        });
        (depths.collect(), Display::Depth)
    };
    floats([width, height], 1, values, display)
}

/// The channels of the first frustum's samples, below each other.
fn channels(frame: &Frame) -> Picture {
    let (Some(map), Some(channels)) = (frame.maps().first(), frame.channels().first()) else {
        return floats([0, 0], 1, Vec::new(), Display::Unit);
    };
    let mut values = vec![0.0; channels.samples() * map.nearness.len()];
    for (k, values) in values.chunks_mut(map.nearness.len().max(1)).enumerate() {
        channels.channel(k, values);
    }
    let height = map.height() * channels.samples() as u32;
    floats([map.width(), height], 1, values, Display::Unit)
}

/// The mean over all lights and over the samples of each pixel.
fn mean_visibility(frame: &Frame, aa: u32) -> Vec<f32> {
    let width = frame.camera().width() as usize;
    let aa = aa as usize;
    let (columns, rows) = (width / aa, frame.camera().height() as usize / aa);
    let samples = (aa * aa * frame.visibility().len()) as f32;
    let mut mean = Vec::with_capacity(columns * rows);
    for y in 0..rows {
        for x in 0..columns {
            let mut sum = 0.0;
            for light in frame.visibility() {
                for row in y * aa..(y + 1) * aa {
                    let start = row * width + x * aa;
                    sum += light[start..start + aa].iter().sum::<f32>();
                }
            }
            mean.push(sum / samples);
        }
    }
    mean
}
