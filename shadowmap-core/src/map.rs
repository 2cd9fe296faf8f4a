//! Borrowed depth + object-ID maps.

use core::fmt;

/// A depth map together with the object ID of each texel, borrowed, row-major.
///
/// Depth is held as *nearness*, as [`crate::View`] defines it: greater is nearer, 0 is "nothing
/// there", and a NaN never blocks anything.
#[derive(Clone, Copy, Debug)]
pub struct DepthMap<'a> {
    width: u32,
    height: u32,
    nearness: &'a [f32],
    ids: &'a [u32],
}

impl<'a> DepthMap<'a> {
    /// A map of `width * height` texels. `ids` may be empty: every texel then has ID 0.
    ///
    /// # Errors
    ///
    /// If a slice has another length than the size says.
    pub fn new(
        width: u32,
        height: u32,
        nearness: &'a [f32],
        ids: &'a [u32],
    ) -> Result<Self, MapError> {
        MapError::check(width, height, "nearness", nearness.len())?;
        if !ids.is_empty() {
            MapError::check(width, height, "ids", ids.len())?;
        }
        Ok(DepthMap { width, height, nearness, ids })
    }

    /// Texels per row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }
    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }
    /// Nearness of each texel, row-major.
    #[must_use]
    pub fn nearness(&self) -> &'a [f32] {
        self.nearness
    }
    /// Object ID of each texel, row-major; empty if the map has none.
    #[must_use]
    pub fn ids(&self) -> &'a [u32] {
        self.ids
    }
    /// The object ID of texel (x, y); 0 if the map has none.
    ///
    /// # Panics
    ///
    /// If the texel lies outside the map.
    #[must_use]
    pub fn id(&self, x: u32, y: u32) -> u32 {
        assert!(x < self.width && y < self.height);
        self.ids.get(y as usize * self.width as usize + x as usize).copied().unwrap_or(0)
    }
}

/// Depth and object ID in 32 bits (Brabec and Seidel 2002, section 4.1): the upper 24 hold
/// nearness as a fixed-point number, the lower 8 the object ID modulo 256. Half the memory
/// traffic of a [`DepthMap`].
#[derive(Clone, Copy, Debug)]
pub struct PackedMap<'a> {
    width: u32,
    height: u32,
    texels: &'a [u32],
}

impl<'a> PackedMap<'a> {
    /// A packed map of `width * height` texels.
    ///
    /// # Errors
    ///
    /// If the slice has another length than the size says.
    pub fn new(width: u32, height: u32, texels: &'a [u32]) -> Result<Self, MapError> {
        MapError::check(width, height, "texels", texels.len())?;
        Ok(PackedMap { width, height, texels })
    }
    /// Packs one texel. `nearness / max_nearness` in \[0, 1\] becomes 24 bits, rounded down, so
    /// that an exactly represented surface never shadows itself; a NaN becomes 0.
    #[must_use]
    pub fn pack(nearness: f32, max_nearness: f32, id: u32) -> u32 {
        let unit = (nearness / max_nearness).clamp(0.0, 1.0);
        (((unit * 16_777_215.0) as u32) << 8) | (id & 0xff)
    }
    /// Texels per row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }
    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }
    /// The packed texels, row-major.
    #[must_use]
    pub fn texels(&self) -> &'a [u32] {
        self.texels
    }
}

/// The size of a map and the length of its slice do not agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapError {
    what: &'static str,
    expected: u64,
    found: usize,
}

impl fmt::Display for MapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MapError { what, expected, found } = self;
        write!(f, "{what} has {found} elements, its size needs {expected}")
    }
}

impl core::error::Error for MapError {}

impl MapError {
    /// Checks that `found` elements are `width * height`; `what` names the slice in the message.
    ///
    /// # Errors
    ///
    /// If they are not.
    pub fn check(
        width: u32,
        height: u32,
        what: &'static str,
        found: usize,
    ) -> Result<(), MapError> {
        let expected = u64::from(width) * u64::from(height);
        if found as u64 == expected { Ok(()) } else { Err(MapError { what, expected, found }) }
    }
}
