//! What stays the same while a frame's receivers are judged.

use glam::Vec3;
use shadowmap_core::{Bias, Camera, DepthMap, Plane, View, Warp};

use super::bounds::Bounds;
use super::scan::STEEPEST;
use crate::rectified::LAST_TANGENT;
use crate::{MAX_FRUSTA, SampleViews};

/// One depth map of a linear light.
#[derive(Clone, Copy, Debug)]
pub struct SampleMap<'a> {
    /// Which point of the light the map is taken from: 0 at its first end, 1 at its last. The map
    /// is that of [`SampleViews::view_at`].
    pub t: f32,
    /// The map.
    pub map: DepthMap<'a>,
}

/// The maps of one frustum of a linear light.
#[derive(Clone, Copy, Debug)]
pub struct FrustumMaps<'a> {
    /// The frustum.
    pub views: &'a SampleViews,
    /// At least two maps, `t` ascending from 0 to 1.
    pub samples: &'a [SampleMap<'a>],
}

/// How far off rounding may put a receiver, of the largest coordinate at hand.
const ROUNDING: f32 = 1e-6;

/// A frustum of the light as the kernels use it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frustum<'a> {
    pub samples: &'a [SampleMap<'a>],
    pub bounds: &'a [Bounds],
    /// Camera texel space to that of the map from the middle of the light.
    pub warp: [[f32; 4]; 4],
    /// If it is that beyond an end of the light.
    pub beyond: Option<Beyond>,
    /// The directions of the world that are columns and rows, homogeneous.
    pub across: [[f32; 4]; 2],
    /// Whether the window had to end somewhere along the light: what blocks may lie beside it.
    pub is_cut: bool,
    /// Texels of disparity per nearness from end to end of the light.
    pub disparity: f32,
    /// The footprint of a texel along a row and down the map, as a fraction of the nearness.
    pub footprint: [f32; 2],
    pub size: [u32; 2],
}

/// What is special about a frustum beyond an end of the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beyond {
    /// The planes on whose positive sides its receivers lie, in camera texel space.
    pub planes: [[f32; 4]; 2],
    /// The column straight across from where the map is taken.
    pub center: f32,
    /// How far from it a column may be as the far end of the light sees it. There is no limit to a
    /// window that ends where no shadow falls: what lies outside of it is lit.
    pub most: f32,
}

impl<'a> Frustum<'a> {
    pub fn new(camera: &View, maps: &FrustumMaps<'a>, bounds: &'a [Bounds]) -> Frustum<'a> {
        let middle = maps.views.view_at(0.5);
        let rows = middle.inverse_rows();
        let focal = middle.focal();
        let segments = (maps.views.views().len() - 1) as f32;
        let pull = camera.inverse_rows();
        let in_camera =
            |plane: Plane| [0, 1, 2, 3].map(|column| plane.side_of(pull.map(|row| row[column])));
        let window = maps.views.window();
        let center = -window.left * focal.x;
        let is_last = maps.views.widest() >= LAST_TANGENT;
        // Half a texel inside the map.
        let last = center.max(middle.width() as f32 - center) - 0.5;
        let beyond = maps.views.beyond().map(|planes| Beyond {
            planes: planes.map(in_camera),
            center,
            most: if is_last { last } else { f32::INFINITY },
        });
        Frustum {
            samples: maps.samples,
            bounds,
            warp: *Warp::new(camera, &middle).rows(),
            beyond,
            across: [0, 1].map(|column| rows.map(|row| row[column])),
            is_cut: maps.views.is_cut(),
            disparity: maps.views.disparity() * segments,
            footprint: [1.0 / focal.x, 1.0 / focal.y],
            size: [middle.width(), middle.height()],
        }
    }

    pub fn steepest(&self) -> f32 {
        STEEPEST * self.footprint[0]
    }

    /// The part of the light that the map of a sample judges: from its neighbour before to its
    /// neighbour after.
    pub fn span(&self, sample: usize) -> [f32; 2] {
        let last = self.samples.len() - 1;
        [self.samples[sample.saturating_sub(1)].t, self.samples[(sample + 1).min(last)].t]
    }
}

/// Everything that the kernels read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<'a> {
    pub camera: Camera<'a>,
    pub(super) frusta: [Option<Frustum<'a>>; MAX_FRUSTA],
    /// The ends of the light, homogeneous.
    pub ends: [[f32; 4]; 2],
    pub bias: Bias,
    /// How high above a receiver's plane, if its normal has unit length, rounding may put an end
    /// that lies in it.
    pub(super) rounding: f32,
}

impl<'a> Frame<'a> {
    pub(super) fn new(
        camera: &Camera<'a>,
        frusta: [Option<Frustum<'a>>; MAX_FRUSTA],
        ends: [Vec3; 2],
        bias: Bias,
    ) -> Frame<'a> {
        let ends = ends.map(|end| end.extend(1.0).to_array());
        let [a, b] = ends;
        let places = [camera.view().eye(), a, b];
        let farthest = places.as_flattened().iter().fold(0.0, |most: f32, x| most.max(x.abs()));
        Frame { camera: *camera, frusta, ends, bias, rounding: ROUNDING * farthest }
    }
}

/// The plane of receivers whose plane is not known: they count as parallel to the maps' image, and
/// as above every horizon.
pub(super) const UNKNOWN: Plane = Plane([0.0; 4]);

/// The plane of a group of receivers, and what it says about the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    pub plane: Plane,
    /// How far in front of the plane the ends of the light are, times positive factors.
    pub ends: [f32; 2],
    /// The parameters between which the light is above the receivers' horizon.
    pub horizon: [f32; 2],
}

impl Facing {
    /// The plane turned to the side that the camera sees; `None` if that side sees no light at all.
    #[inline(always)]
    pub fn new(frame: &Frame<'_>, plane: Plane) -> Option<Facing> {
        let side = plane.side_of(frame.camera.view().eye());
        let plane = if side < 0.0 { Plane(plane.0.map(|x| -x)) } else { plane };
        let ends = frame.ends.map(|end| plane.side_of(end));
        let [a, b] = ends;
        if plane == UNKNOWN || !(a.is_finite() && b.is_finite()) {
            return Some(Facing { plane: UNKNOWN, ends: [1.0; 2], horizon: [0.0, 1.0] });
        }
        // Rounding would decide which points of a plane see a light that lies in it: none does.
        let [x, y, z, _] = plane.0;
        if a.max(b) <= frame.rounding * (x.abs() + y.abs() + z.abs()) {
            return None;
        }
        let horizon = match (a > 0.0, b > 0.0) {
            (true, true) => [0.0, 1.0],
            (true, false) => [0.0, a / (a - b)],
            (false, true) => [a / (a - b), 1.0],
            (false, false) => return None,
        };
        Some(Facing { plane, ends, horizon })
    }

    /// How much of the light is above the horizon.
    pub fn open(&self) -> f32 {
        self.horizon[1] - self.horizon[0]
    }
}
