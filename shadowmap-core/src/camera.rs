//! The receivers: what a camera sees, as plain slices.

use core::fmt;

use crate::{DepthMap, Plane, View};
use glam::Vec3;

/// Where the planes and the object IDs of the camera's pixels come from.
#[derive(Clone, Copy, Debug)]
pub enum Surfaces<'a> {
    /// The IDs of the camera's map are object IDs. A receiver's plane is derived from the nearness
    /// of its neighbours; [`Camera::normals_from_depth`] does that once for all.
    FromDepth,
    /// The IDs of the camera's map are object IDs, and there is one geometric normal per pixel.
    Normals(&'a [Vec3]),
    /// The IDs of the camera's map are indices into this table: one entry per triangle, face or
    /// whatever the camera drew. An index past its end counts as [`Surface::UNKNOWN`].
    Table(&'a [Surface]),
}

/// One entry of [`Surfaces::Table`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Geometric normal in world space, of unit length, to either side. Zero means unknown:
    /// the receiver then counts as parallel to the light's image, the constant layer of
    /// Brabec and Seidel 2002, section 3.2.
    pub normal: Vec3,
    /// Object ID as the light's map has it.
    pub id: u32,
}

impl Surface {
    /// No normal, and ID 0.
    pub const UNKNOWN: Surface = Surface { normal: Vec3::ZERO, id: 0 };
}

/// A camera's view, its depth map, and the surfaces it sees.
#[derive(Clone, Copy, Debug)]
pub struct Camera<'a> {
    view: &'a View,
    map: DepthMap<'a>,
    surfaces: Surfaces<'a>,
}

impl<'a> Camera<'a> {
    /// The receivers that `view` sees, given by `map`, whose nearness is 0 where there is nothing.
    ///
    /// # Errors
    ///
    /// If the map or the normals have another size than the view.
    pub fn new(
        view: &'a View,
        map: DepthMap<'a>,
        surfaces: Surfaces<'a>,
    ) -> Result<Self, SizeError> {
        let size = [view.width(), view.height()];
        SizeError::check("camera map", size, [map.width(), map.height()])?;
        if let Surfaces::Normals(normals) = surfaces
            && normals.len() != map.nearness().len()
        {
            let found = [normals.len() as u32, 1];
            return Err(SizeError { what: "normals", view: size, found });
        }
        Ok(Camera { view, map, surfaces })
    }
    /// The camera's view.
    #[must_use]
    pub fn view(&self) -> &'a View {
        self.view
    }
    /// Nearness and IDs of the camera's pixels.
    #[must_use]
    pub fn map(&self) -> &DepthMap<'a> {
        &self.map
    }
    /// Where planes and object IDs come from.
    #[must_use]
    pub fn surfaces(&self) -> Surfaces<'a> {
        self.surfaces
    }
}

impl Camera<'_> {
    /// The object ID and the tangent plane of pixel (x, y), whose `nearness` is positive.
    ///
    /// # Panics
    ///
    /// If the pixel lies outside the camera's map.
    #[must_use]
    pub fn plane(&self, x: u32, y: u32, nearness: f32) -> (u32, Plane) {
        let surface = match self.surfaces() {
            Surfaces::FromDepth => {
                return (self.map().id(x, y), self.plane_from_depth(x, y, nearness));
            }
            Surfaces::Normals(normals) => {
                let index = y as usize * self.map().width() as usize + x as usize;
                Surface { normal: normals[index], id: self.map().id(x, y) }
            }
            Surfaces::Table(table) => {
                let index = self.map().id(x, y) as usize;
                table.get(index).copied().unwrap_or(Surface::UNKNOWN)
            }
        };
        let position = self.view().world_from_texel(x as f32 + 0.5, y as f32 + 0.5, nearness);
        (surface.id, Plane::through(position, surface.normal))
    }
}

/// A map and its view have different sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeError {
    what: &'static str,
    view: [u32; 2],
    found: [u32; 2],
}

impl SizeError {
    /// Whether `found` is the size (width, height) of the `view`; if not, the error that says of
    /// `what`.
    ///
    /// # Errors
    ///
    /// If the sizes differ.
    pub fn check(what: &'static str, view: [u32; 2], found: [u32; 2]) -> Result<(), SizeError> {
        if view == found { Ok(()) } else { Err(SizeError { what, view, found }) }
    }
}

impl fmt::Display for SizeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SizeError { what, view: [vw, vh], found: [w, h] } = self;
        write!(f, "{what} of {w} x {h} for a view of {vw} x {vh}")
    }
}

impl core::error::Error for SizeError {}
