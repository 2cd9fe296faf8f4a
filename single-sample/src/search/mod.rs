//! The method with one physical parameter: the size of the light.
//!
//! Brabec and Seidel search the neighbourhood of a receiver for the nearest texel where the hard
//! shadow test has another result, and make its distance the visibility. That is exact for one
//! straight edge and off wherever the shadow's edge is curved, has a corner, or where there is
//! more than one edge. This search finds *all* of the edge within reach, and adds up what each
//! piece of it hides of the light.
//!
//! 1. A receiver sees a spherical light as a disc. A blocker with nearness n hides of it what lies
//!    beyond: an offset of d texels in the map is the distance `d / (k (n - n_receiver))` from the
//!    disc's centre, in radii, with k the light's radius times the focal length. This is the
//!    paper's `r / r_max` (section 3.3) with a width that follows from the size of the light
//!    (section 6), for every blocker on its own.
//! 2. A texel blocks if it is above the receiver's tangent plane and nearer to the light. No
//!    object IDs: an object shadows itself where its geometry does, and a convex surface, whose
//!    neighbourhood lies below its tangent planes, never. A texel about as far from the light as
//!    the receiver blocks only if the receiver is behind the texel's own plane, too: a wall hides
//!    nothing of the ground on its lit side, nor the ground the wall's foot.
//! 3. Cell by cell of 8 x 8 texels, the outline of the blocking texels becomes one or two straight
//!    segments where it is simple, and the pieces of marching squares where it is not. Each
//!    contributes the integral of `1 - rho²` over the angle that its part within the disc spans.
//!    Straight edges give the disc's circular segment, the "sinusoid" of section 6; layers,
//!    corners, thin bars and both sides of the hard edge need no cases of their own.
//! 4. What the receiver's own horizon cuts off the disc is a circular segment too. All blockers are
//!    above the horizon, so it is simply subtracted.
//! 5. The pyramid over the map bounds how far a search needs to go by the nearest depth in reach,
//!    and tells where texels may block. Receivers of a tile that share a plane, or an object of
//!    many planes, share an outline, but for places that look different to some. Tiles that show
//!    the same plane share what they find in a cell.
//! 6. Where neighbouring pixels agree, searches are replaced by interpolation
//!    ([`Parameters::group`], section 4.3). The horizon never is.
//!
//! Contributions are summed as integers, so that neither the order nor the number of lanes nor the
//! part of the map that is looked at changes a bit.

// Kernels index several arrays in step.
#![allow(clippy::needless_range_loop)]

mod above;
mod adaptive;
mod cell;
mod curve;
mod disputed;
mod facing;
mod field;
mod geometry;
mod groups;
mod integral;
mod kernels;
mod lanes;
mod leaves;
mod list;
mod naive;
mod outline;
mod outlines;
mod output;
mod pieces;
mod pixels;
mod planar;
mod planes;
mod reach;
mod receiver;
mod recent;
mod rule;
mod segments;
mod soa;
mod squares;
mod strip;
mod surfaces;
#[cfg(test)]
mod tests;
mod texel_test;
mod tile;
mod tile_search;
mod trace;

use shadowmap_core::{BandSlice, Bias, Camera, Level, Light, Threads, for_each_band_with};
use simd_search::Pyramid;

use crate::counters::Tally;
use crate::{Counters, LightMap, Texels, Visibility};
use adaptive::TILE;
use field::{Field, Texel};
use geometry::Geometry;
use tile::{Scene, Scratch, tile};

/// What the light is, and how finely to sample its shadow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// The radius of the light's disc. For a perspective view in metres, around the view's eye; for
    /// an orthographic view the tangent of half the light's angular diameter. 0 gives hard shadows,
    /// smoothed over a texel; the sign does not matter, and NaN counts as 0.
    pub radius: f32,
    /// Groups of `group + 1` pixels along every `group`-th row, and then along the columns between
    /// these rows, are interpolated where the pixels see one object and have one hard shadow test
    /// result, or are all amid a penumbra far wider than the group is long. The paper's is 4,
    /// begins with columns, and knows no such penumbrae; 1 searches every pixel; at most 15.
    pub group: u32,
    /// The greatest difference of visibility between the ends of an interpolated group; and twice
    /// what its middle, once searched, may be off a straight line for all of it to be interpolated
    /// nevertheless, on a parabola. The paper has no such limit: 1. Where blockers are so close
    /// that the light's disc is not far wider than a group, or the next known pixel tells that it
    /// is bent, its middle is searched whatever the ends are.
    pub tolerance: f32,
    /// Tolerance of the depth comparisons.
    pub bias: Bias,
}

impl Default for Parameters {
    /// A point light, groups of 9 pixels whose ends differ by 1 / 50 at most.
    fn default() -> Self {
        Parameters { radius: 0.0, group: 8, tolerance: 1.0 / 50.0, bias: Bias::default() }
    }
}

impl Parameters {
    /// The defaults with the size of `light`, for the view that its kind asks for. `None` if it
    /// is none of point, sphere and sun.
    #[must_use]
    pub fn of(light: &Light) -> Option<Parameters> {
        let radius = match *light {
            Light::Point { .. } => 0.0,
            Light::Sphere { radius, .. } => radius,
            Light::Sun { angle, .. } => libm::tan(f64::from(angle) * 0.5) as f32,
            _ => return None,
        };
        Some(Parameters { radius, ..Parameters::default() })
    }
}

/// Writes the visibility of the light from every pixel of the camera, row-major: the fraction of
/// its disc that the pixel's surface sees. 0 where the camera sees nothing.
///
/// `pyramid` is that of the light's texels. The result is the same at every `level` and for any
/// number of `threads`.
///
/// # Panics
///
/// If `out` has another length than the camera has pixels, or the pyramid is of a map of another
/// size than the light's.
pub fn visibility<V: Visibility>(
    level: Level,
    threads: Threads,
    camera: &Camera<'_>,
    light: &LightMap<'_>,
    pyramid: &Pyramid<'_>,
    parameters: &Parameters,
    out: &mut [V],
) -> Counters {
    assert_eq!(out.len(), camera.map().nearness().len(), "one visibility per pixel");
    let size = [light.view().width(), light.view().height()];
    assert_eq!(pyramid.size(), size, "the pyramid is of a map of another size");
    match light.texels() {
        Texels::Plain(map) => {
            run(level, threads, camera, light, map.nearness(), pyramid, parameters, out)
        }
        Texels::Packed(map) => {
            run(level, threads, camera, light, map.texels(), pyramid, parameters, out)
        }
    }
}

/// The visibility at pixel (x, y) without anything that makes it fast: no pyramid, no tiles, all
/// of the map. What [`visibility`] gives for a `group` of 1, bit for bit, for maps of finite
/// nearness.
///
/// # Panics
///
/// If the pixel lies outside the camera's map.
#[must_use]
pub fn naive(
    camera: &Camera<'_>,
    light: &LightMap<'_>,
    parameters: &Parameters,
    x: u32,
    y: u32,
) -> f32 {
    match light.texels() {
        Texels::Plain(map) => {
            let geometry = geometry::<f32>(camera, light, parameters);
            naive::visibility(
                camera,
                &Field::new(light, map.nearness(), &geometry),
                &geometry,
                x,
                y,
            )
        }
        Texels::Packed(map) => {
            let geometry = geometry::<u32>(camera, light, parameters);
            naive::visibility(camera, &Field::new(light, map.texels(), &geometry), &geometry, x, y)
        }
    }
}

fn geometry<T: Texel>(
    camera: &Camera<'_>,
    light: &LightMap<'_>,
    parameters: &Parameters,
) -> Geometry {
    let unit = T::unit(light.view());
    let radius = if parameters.radius.is_nan() { 0.0 } else { parameters.radius.abs() };
    Geometry::new(camera.view(), light.view(), radius, unit, parameters.bias)
}

fn run<T: Texel, V: Visibility>(
    level: Level,
    threads: Threads,
    camera: &Camera<'_>,
    light: &LightMap<'_>,
    texels: &[T],
    pyramid: &Pyramid<'_>,
    parameters: &Parameters,
    out: &mut [V],
) -> Counters {
    let [width, height] = [light.view().width(), light.view().height()];
    let image = camera.map().width() as usize;
    if out.is_empty() {
        return Counters::default();
    }
    let geometry = geometry::<T>(camera, light, parameters);
    let scene = Scene {
        level,
        camera: *camera,
        field: Field::new(light, texels, &geometry),
        pyramid: *pyramid,
        geometry,
        greatest: pyramid.greatest(0..width, 0..height),
        group: parameters.group.clamp(1, TILE as u32 - 1) as usize,
        tolerance: parameters.tolerance,
    };
    let tally = Tally::default();
    let bands = BandSlice { data: out, len: image * TILE };
    for_each_band_with(threads, bands, Scratch::new, &|scratch, row, out| {
        let mut counters = Counters::default();
        for left in (0..image as u32).step_by(TILE) {
            tile(&scene, scratch, [left, (row * TILE) as u32], out.data, &mut counters);
        }
        tally.add(&counters);
    });
    tally.total()
}
