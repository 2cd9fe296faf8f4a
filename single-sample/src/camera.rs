//! The light's map, plain or packed.

use shadowmap_core::{DepthMap, PackedMap, SizeError, View};

/// The texels of a light's map, plain or packed (Brabec and Seidel 2002, section 4.1).
#[derive(Clone, Copy, Debug)]
pub enum Texels<'a> {
    /// Nearness and ID in a slice each.
    Plain(DepthMap<'a>),
    /// 24 bits of nearness, 8 bits of ID.
    Packed(PackedMap<'a>),
}

/// A light's view and the depth + ID map taken from it.
#[derive(Clone, Copy, Debug)]
pub struct LightMap<'a> {
    view: &'a View,
    texels: Texels<'a>,
}

impl<'a> LightMap<'a> {
    /// The map that `view` sees.
    ///
    /// # Errors
    ///
    /// If the map has another size than the view.
    pub fn new(view: &'a View, texels: Texels<'a>) -> Result<Self, SizeError> {
        let found = match texels {
            Texels::Plain(map) => [map.width(), map.height()],
            Texels::Packed(map) => [map.width(), map.height()],
        };
        SizeError::check("light map", [view.width(), view.height()], found)?;
        Ok(LightMap { view, texels })
    }
    /// The light's view.
    #[must_use]
    pub fn view(&self) -> &'a View {
        self.view
    }
    /// The light's texels.
    #[must_use]
    pub fn texels(&self) -> Texels<'a> {
        self.texels
    }
}
