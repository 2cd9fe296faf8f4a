//! One tile of the image: decided as a whole where possible, else pixel by pixel.

use shadowmap_core::{Camera, Level, Surface};
use simd_search::Pyramid;

use super::adaptive::{Grid, Samples, TILE};
use super::field::{Field, Texel};
use super::geometry::Geometry;
use super::groups::Groups;
use super::kernels;
use super::leaves::{FindBlockers, LeafTest};
use super::outline::Places;
use super::outlines::{FindOutlines, Outlines};
use super::output::WriteTile;
use super::pixels::{Pixels, ReadPixels};
use super::planar::{FindPlanar, Planar, Shown};
use super::planes::Planes;
use super::reach::Reach;
use super::soa::{OnePlane, Receivers, SetReceivers};
use super::tile_search::SearchTile;
use crate::{Counters, Found, Visibility};

/// What all tiles of a call share.
pub(crate) struct Scene<'a, T> {
    pub level: Level,
    pub camera: Camera<'a>,
    pub field: Field<'a, T>,
    pub pyramid: Pyramid<'a>,
    pub geometry: Geometry,
    /// The nearest depth of the whole map.
    pub greatest: f32,
    /// Pixels from one searched row to the next.
    pub group: usize,
    /// Greatest difference between the ends of an interpolated group.
    pub tolerance: f32,
}

/// Memory for one tile at a time.
pub(crate) struct Scratch {
    pixels: Pixels,
    receivers: Receivers,
    groups: Groups,
    samples: Samples,
    outlines: Outlines,
}

/// As the crate's README says.
const _: () = assert!(size_of::<Scratch>() <= 380 * 1024);

impl Scratch {
    pub const fn new() -> Scratch {
        Scratch {
            pixels: Pixels::new(),
            receivers: Receivers::new(),
            groups: Groups::new(),
            samples: Samples::new(),
            outlines: Outlines::new(),
        }
    }
}

/// Writes the visibility of the tile whose first pixel is (left, top) to `out`, rows of the
/// camera's whole width that begin with row `top`.
pub(crate) fn tile<T: Texel, V: Visibility>(
    scene: &Scene<'_, T>,
    scratch: &mut Scratch,
    [left, top]: [u32; 2],
    out: &mut [V],
    counters: &mut Counters,
) {
    let image = scene.camera.map().width() as usize;
    let grid = Grid {
        width: (image - left as usize).min(TILE),
        height: (out.len() / image).min(TILE),
        group: scene.group,
        tolerance: scene.tolerance,
    };
    counters.tiles += 1;
    let whole = whole(scene, [left, top], &grid);
    if let Whole::Decided { visible, receivers, outside } = whole {
        counters.decided_tiles += 1;
        counters.receivers += receivers;
        counters.outside += outside;
        for row in 0..grid.height {
            out[row * image + left as usize..][..grid.width]
                .fill(V::from_pixel(visible, Found::Decided));
        }
        return;
    }
    let Scratch { pixels, receivers, groups, samples, outlines } = scratch;
    let surface = match whole {
        Whole::OnePlane(surface) => Some(surface),
        _ => None,
    };
    let work = ReadPixels {
        camera: &scene.camera,
        pixel: [left, top],
        grid: &grid,
        id: surface.map(|surface| surface.id),
        pixels,
        seen: &mut counters.receivers,
    };
    kernels::run(scene.level, work);
    let one_plane = surface.map(|Surface { normal, .. }| OnePlane {
        pixels: grid.height * TILE,
        normal: normal.to_array(),
    });
    let first = [left as f32 + 0.5, top as f32 + 0.5];
    let geometry = &scene.geometry;
    let work = SetReceivers { geometry, first, pixels, receivers, groups, one_plane };
    kernels::run(scene.level, work);
    let work = FindOutlines {
        geometry,
        field: &scene.field,
        pyramid: &scene.pyramid,
        greatest: scene.greatest,
        receivers,
        groups,
        outlines,
    };
    kernels::run(scene.level, work);
    let is_decided = outlines.groups.iter().all(Option::is_none);
    if is_decided {
        counters.decided_tiles += 1;
    } else {
        let work = SearchTile {
            geometry,
            field: &scene.field,
            pyramid: &scene.pyramid,
            greatest: scene.greatest,
            receivers,
            groups,
            ids: pixels.ids(),
            grid: &grid,
            samples,
            outlines,
            counters,
        };
        kernels::run(scene.level, work);
    }
    let work = WriteTile {
        field: &scene.field,
        grid: &grid,
        receivers,
        samples: (!is_decided).then_some(samples),
        out: &mut out[left as usize..],
        image,
        counters,
    };
    kernels::run(scene.level, work);
}

/// What is known of a tile at once.
enum Whole {
    /// All of its pixels have this visibility.
    Decided {
        visible: f32,
        receivers: u32,
        outside: u32,
    },
    /// It shows one plane, above whose horizon all of the light is.
    OnePlane(Surface),
    Mixed,
}

/// Looks whether a tile shows nothing, or one plane that is all lit or turned away from the light.
fn whole<T: Texel>(scene: &Scene<'_, T>, pixel: [u32; 2], grid: &Grid) -> Whole {
    let geometry = &scene.geometry;
    let mut shown = Shown::Other;
    let camera = &scene.camera;
    kernels::run(scene.level, FindPlanar { camera, geometry, pixel, grid, found: &mut shown });
    let Planar { surface, first, extent } = match shown {
        Shown::Nothing => return Whole::Decided { visible: 0.0, receivers: 0, outside: 0 },
        Shown::Plane(planar) => planar,
        Shown::Other => return Whole::Mixed,
    };
    let receivers = (grid.width * grid.height) as u32;
    // Of the disc in units of its radius; beyond 1 by more than rounding errors.
    let horizon = first.hn * geometry.unit / geometry.radius;
    if horizon < -1.0001 {
        return Whole::Decided { visible: 0.0, receivers, outside: 0 };
    }
    let size = [scene.field.width, scene.field.height];
    let is_within = |[low, high]: [f32; 2], size: i32| low >= 0.0 && high < size as f32;
    let is_beyond = |[low, high]: [f32; 2], size: i32| high < 0.0 || low >= size as f32;
    let is_inside = is_within(extent.u, size[0]) && is_within(extent.v, size[1]);
    let is_outside = is_beyond(extent.u, size[0]) || is_beyond(extent.v, size[1]);
    // Pixels on both sides of the border are counted one by one.
    let is_split = !is_inside && !is_outside;
    if is_split || horizon.is_nan() || horizon <= 1.0001 {
        return Whole::Mixed;
    }
    let outside = if is_outside { receivers } else { 0 };
    let lit = Whole::Decided { visible: 1.0, receivers, outside };
    let Some(reach) = Reach::new(geometry, &scene.pyramid, scene.greatest, size, &extent) else {
        return lit;
    };
    let test = LeafTest::new(geometry, &extent, &Planes::of(&first), size);
    match may_block(scene, test, reach.places) {
        false => lit,
        true => Whole::OnePlane(surface),
    }
}

/// Whether some leaf of the pyramid may hold blockers.
fn may_block<T: Texel>(scene: &Scene<'_, T>, test: LeafTest, places: Places) -> bool {
    let mut found = false;
    let pyramid = &scene.pyramid;
    kernels::run(scene.level, FindBlockers { pyramid, test, places, found: &mut found });
    found
}
