//! Soft shadows for an embedder without a heap: nothing here links `alloc`.
#![no_std]
#![forbid(unsafe_code)]

use shadowmap_core::{DepthMap, Threads, View};
use single_sample::{Camera, LightMap, Surfaces, Texels, paper};

/// The shadow mask of a camera, from two depth + object-ID maps.
///
/// # Errors
///
/// If the maps are not of their views' sizes.
pub fn mask(
    [camera_view, light_view]: [&View; 2],
    [camera_map, light_map]: [DepthMap<'_>; 2],
    mask: &mut [u8],
) -> Result<(), single_sample::SizeError> {
    let camera = Camera::new(camera_view, camera_map, Surfaces::FromDepth)?;
    let light = LightMap::new(light_view, Texels::Plain(light_map))?;
    paper::visibility(&camera, &light, &paper::Parameters::default(), Threads::One, mask);
    Ok(())
}
