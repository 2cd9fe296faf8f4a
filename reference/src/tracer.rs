//! Visibility by rays.

use std::fmt;

use glam::{DVec3, Vec3};
use shadowmap_core::{BandSlice, Light, Mesh, Projection, Threads, View, for_each_band};

use crate::bvh::{Bvh, Leaf, Shaft, Stack};
use crate::cone::Cone;
use crate::light_samples::LightSamples;
use crate::mask::{HalfPlane, Region};
use crate::sampling::{LightRays, Samples};

/// How far in front of a surface its shadow rays start along the normal, in metres: in scenes that
/// reach from 1 m to 200 m from the origin. See [`Tracer::ray_offset`].
pub const RAY_OFFSET: f32 = 1e-4;

/// What rounding leaves of the place of a receiver, of the largest coordinate of a scene: a few
/// units in the last place.
const ROUNDING: f32 = 5e-7;

/// With at most this many samples each ray walks the hierarchy alone, once anything at all is in
/// the way; with more, one pyramid around all of them does. Either way the same planes decide.
const SINGLE_RAYS: usize = 12;

/// Receivers per task.
const BAND: usize = 512;

/// Triangles with holes, such as leaves cut out by a texture's alpha.
#[derive(Clone, Copy)]
pub struct Cutouts<'a> {
    /// For each triangle of the mesh, whether it may have holes.
    pub has_holes: &'a [bool],
    /// Whether such a triangle is opaque at the place given by the weights of its corners.
    pub is_opaque: &'a (dyn Fn(u32, [f32; 3]) -> bool + Sync),
}

impl fmt::Debug for Cutouts<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cutouts").field("has_holes", &self.has_holes).finish_non_exhaustive()
    }
}

/// What a camera sees, row-major: one receiver per pixel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Receivers {
    /// World positions in metres; 0 where nothing is seen.
    pub positions: Vec<Vec3>,
    /// Geometric unit normals turned towards the camera; 0 where nothing is seen.
    pub normals: Vec<Vec3>,
    /// Indices of triangles of the mesh; `u32::MAX` where nothing is seen.
    pub triangles: Vec<u32>,
}

/// A scene, ready to be asked what its points see of a light.
#[derive(Debug)]
pub struct Tracer<'a> {
    bvh: Bvh,
    cutouts: Option<Cutouts<'a>>,
}

impl<'a> Tracer<'a> {
    /// Builds the hierarchy. Triangles with missing, not finite or absurdly far vertices (beyond
    /// 1e12 m) are left out.
    #[must_use]
    pub fn new(mesh: &Mesh<'_>) -> Tracer<'a> {
        Tracer { bvh: Bvh::new(mesh), cutouts: None }
    }

    /// The same for a mesh of which some triangles have holes.
    #[must_use]
    pub fn with_cutouts(mesh: &Mesh<'_>, cutouts: Cutouts<'a>) -> Tracer<'a> {
        Tracer { bvh: Bvh::new(mesh), cutouts: Some(cutouts) }
    }

    /// How far in front of a surface its shadow rays start along the normal: [`RAY_OFFSET`], less in
    /// a small scene, which has small gaps, and more in one whose receivers' places are less exact.
    #[must_use]
    pub fn ray_offset(&self) -> f32 {
        let reach = self.bvh.extent() as f32;
        (RAY_OFFSET * reach.min(1.0)).max(ROUNDING * reach)
    }

    /// What `view` sees through its texel centres.
    #[must_use]
    pub fn receivers(&self, view: &View, threads: Threads) -> Receivers {
        let width = view.width() as usize;
        let count = width * view.height() as usize;
        let mut seen = Receivers {
            positions: vec![Vec3::ZERO; count],
            normals: vec![Vec3::ZERO; count],
            triangles: vec![u32::MAX; count],
        };
        let bands = (
            BandSlice { data: &mut seen.positions, len: width.max(1) },
            BandSlice { data: &mut seen.normals, len: width.max(1) },
            BandSlice { data: &mut seen.triangles, len: width.max(1) },
        );
        for_each_band(threads, bands, &|y, (positions, normals, triangles)| {
            let mut stack = Stack::new();
            for x in 0..positions.data.len() {
                let [eye, ray] = camera_ray(view, x as f64 + 0.5, y as f64 + 0.5);
                let start = 1.0 / f64::from(view.max_nearness());
                let start = if view.projection() == Projection::Perspective { start } else { 0.0 };
                if let Some((position, normal, triangle)) =
                    self.nearest(eye, ray, start, &mut stack)
                {
                    positions.data[x] = position;
                    normals.data[x] = normal;
                    triangles.data[x] = triangle;
                }
            }
        });
        seen
    }

    /// The first hit at `start` or later: position, normal towards the viewer, triangle.
    fn nearest(
        &self,
        eye: DVec3,
        ray: DVec3,
        start: f64,
        stack: &mut Stack,
    ) -> Option<(Vec3, Vec3, u32)> {
        let opaque = |leaf: &Leaf, weights| self.is_opaque(leaf, weights);
        let (_, [a, b, c], leaf) = self.bvh.nearest(eye, ray, start, stack, opaque)?;
        let corners = leaf.corners.map(Vec3::as_dvec3);
        let position = corners[0] * a + corners[1] * b + corners[2] * c;
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        let normal = if normal.dot(ray) > 0.0 { -normal } else { normal };
        Some((position.as_vec3(), normal.as_vec3(), leaf.triangle))
    }

    /// Visibility of `light` from the point `position` of a surface with geometric unit `normal`
    /// (turned to the viewer's side): the fraction of the samples L with n . (L - P') > 0 whose
    /// segment from P' = P + [`Tracer::ray_offset`] n to L meets no triangle. 0 for a zero normal,
    /// and where position or normal are not finite.
    #[must_use]
    pub fn visibility_at(
        &self,
        light: &Light,
        position: Vec3,
        normal: Vec3,
        samples: Samples,
    ) -> f32 {
        let mut out = [0.0];
        self.visibility(light, &[position], &[normal], samples, Threads::One, &mut out);
        out[0]
    }

    /// [`Tracer::visibility_at`] for many receivers. The threads do not change the result.
    ///
    /// # Panics
    ///
    /// If `positions`, `normals` and `out` differ in length.
    pub fn visibility(
        &self,
        light: &Light,
        positions: &[Vec3],
        normals: &[Vec3],
        samples: Samples,
        threads: Threads,
        out: &mut [f32],
    ) {
        assert_eq!(positions.len(), normals.len(), "one normal per position");
        assert_eq!(positions.len(), out.len(), "one visibility per position");
        let placed = LightSamples::new(light, samples);
        let offset = f64::from(self.ray_offset());
        for_each_band(threads, BandSlice { data: out, len: BAND }, &|band, out| {
            let (mut placed, mut stack) = (placed.clone(), Stack::new());
            for (i, out) in out.data.iter_mut().enumerate() {
                let i = band * BAND + i;
                let (position, normal) = (positions[i], normals[i]);
                let surface = position.is_finite() && normal.is_finite() && normal != Vec3::ZERO;
                *out = if surface {
                    let normal = normal.as_dvec3();
                    let eye = position.as_dvec3() + normal * offset;
                    placed.turn_to(i as u32);
                    let seen = self.samples_seen(eye, normal, &mut placed, &mut stack);
                    seen as f32 / placed.count() as f32
                } else {
                    0.0
                };
            }
        });
    }

    /// How many samples are seen. All rays start at one point, so a triangle blocks those samples
    /// that lie within three planes through that point and its edges; in the light's coordinates
    /// these are half-planes.
    fn samples_seen(
        &self,
        eye: DVec3,
        normal: DVec3,
        samples: &mut LightSamples<'_>,
        stack: &mut Stack,
    ) -> usize {
        let rays = LightRays::new(samples.light(), eye);
        let half_plane = |n: DVec3, offset: f64| {
            let c = n.dot(rays.origin) - offset;
            HalfPlane { c, gx: n.dot(rays.u), gy: n.dot(rays.v) }
        };
        // Whatever is not above the horizon is blocked.
        if let Some(below) = Region::new(&[half_plane(-normal, 0.0)], samples.bounds())
            && samples.block(&below, None)
        {
            return 0;
        }
        let alone = samples.count() <= SINGLE_RAYS;
        let mut in_the_way = false;
        let shaft = Shaft::new(eye, &rays, samples.bounds(), self.bvh.extent());
        self.bvh.in_shaft(&shaft, stack, |leaf, corners| {
            let Some(cone) = Cone::new(corners) else { return false };
            let [a, b, c] = cone.planes;
            let planes = [
                half_plane(a, 0.0),
                half_plane(b, 0.0),
                half_plane(c, 0.0),
                // The ray must reach the triangle before it ends.
                half_plane(cone.through(), cone.volume * rays.w),
            ];
            let Some(region) = Region::new(&planes, samples.bounds()) else { return false };
            in_the_way = true;
            if alone {
                return true;
            }
            if !self.may_miss(leaf) {
                return samples.block(&region, None);
            }
            let opaque = |point| {
                let hit = cone.hit(rays.to(point), 0.0);
                hit.is_some_and(|[_, weights @ ..]| self.is_opaque(leaf, weights))
            };
            samples.block(&region, Some(&opaque))
        });
        if alone && in_the_way {
            let opaque = |leaf: &Leaf, weights| self.is_opaque(leaf, weights);
            let seen = |point: [f32; 2]| !self.bvh.any(eye, rays.to(point), rays.w, stack, opaque);
            return samples.open_points().map(seen).filter(|&seen| seen).count();
        }
        samples.open()
    }

    fn may_miss(&self, leaf: &Leaf) -> bool {
        self.cutouts.is_some_and(|cutouts| {
            cutouts.has_holes.get(leaf.triangle as usize).copied().unwrap_or(false)
        })
    }

    fn is_opaque(&self, leaf: &Leaf, weights: [f64; 3]) -> bool {
        let opaque_at = |cutouts: Cutouts<'_>| {
            (cutouts.is_opaque)(leaf.triangle, weights.map(|weight| weight as f32))
        };
        !self.may_miss(leaf) || self.cutouts.is_none_or(opaque_at)
    }
}

/// Origin and direction of the ray through texel coordinates (u, v) of a view. The direction has
/// length 1 along the view axis, so that the ray's parameter is depth.
fn camera_ray(view: &View, u: f64, v: f64) -> [DVec3; 2] {
    let rows = view.inverse_rows().map(|row| row.map(f64::from));
    let at = |nearness: f64| {
        let [x, y, z, w] = rows.map(|r| r[0] * u + r[1] * v + r[2] * nearness + r[3]);
        (DVec3::new(x, y, z), w)
    };
    let [x, y, z, _] = view.eye().map(f64::from);
    match view.projection() {
        Projection::Perspective => [DVec3::new(x, y, z), at(0.0).0],
        Projection::Orthographic => {
            let (near, w) = at(f64::from(view.max_nearness()));
            [near / w, -DVec3::new(x, y, z)]
        }
    }
}
