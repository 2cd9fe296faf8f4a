//! What is drawn into, and what is stored there.

use shadowmap_core::{DepthMap, MapError, View};

use crate::Texels;

/// The 32 bits that accompany nearness in each texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Payload {
    /// The triangle's object ID ([`shadowmap_core::Mesh::ids`]): what light maps hold.
    ObjectId,
    /// The triangle's index + 1: what a camera pass holds, whose shading derives all else from it.
    TriangleIndex,
}

impl Payload {
    /// The payload of a triangle.
    #[inline(always)]
    pub(crate) fn of(self, index: usize, ids: &[u32]) -> u32 {
        match self {
            Payload::ObjectId => ids.get(index).copied().unwrap_or(0),
            Payload::TriangleIndex => (index as u32).wrapping_add(1),
        }
    }
}

/// A map to draw into, borrowed, row-major.
#[derive(Debug)]
pub struct Target<'a> {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) nearness: &'a mut [f32],
    pub(crate) payload: &'a mut [u32],
}

impl<'a> Target<'a> {
    /// A map of `width * height` texels. What the slices hold does not matter: drawing clears them.
    ///
    /// # Errors
    ///
    /// If a slice has another length than the size says.
    pub fn new(
        width: u32,
        height: u32,
        nearness: &'a mut [f32],
        payload: &'a mut [u32],
    ) -> Result<Self, MapError> {
        MapError::check(width, height, "nearness", nearness.len())?;
        MapError::check(width, height, "payload", payload.len())?;
        Ok(Target { width, height, nearness, payload })
    }

    /// # Panics
    ///
    /// If the view's map has another size, or one beyond [`crate::MAX_SIZE`].
    pub(crate) fn check(&self, view: &View) {
        assert!(
            (view.width(), view.height()) == (self.width, self.height),
            "the target is not of the view's size"
        );
        assert!(
            self.width <= crate::MAX_SIZE && self.height <= crate::MAX_SIZE,
            "the map is larger than {} texels",
            crate::MAX_SIZE
        );
    }
}

/// Where in a page of memory the payload starts, as far from nearness as helps.
const PAYLOAD_PLACE: usize = 256;

/// A map that owns its texels.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthBuffer {
    width: u32,
    height: u32,
    /// Nearness of each texel, row-major; 0 where there is nothing.
    pub nearness: Texels<f32>,
    /// Payload of each texel, row-major; 0 where there is nothing.
    pub payload: Texels<u32>,
}

impl DepthBuffer {
    /// An empty map.
    #[must_use]
    pub fn new(width: u32, height: u32) -> DepthBuffer {
        let len = width as usize * height as usize;
        let (nearness, payload) = (Texels::new(len, 0), Texels::new(len, PAYLOAD_PLACE));
        DepthBuffer { width, height, nearness, payload }
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

    /// To draw into.
    ///
    /// # Panics
    ///
    /// If one of the planes was exchanged for one of another length.
    #[must_use]
    pub fn target(&mut self) -> Target<'_> {
        Target::new(self.width, self.height, &mut self.nearness, &mut self.payload)
            .expect("the planes of a DepthBuffer keep their length")
    }

    /// To read, the payload taken as object IDs.
    ///
    /// # Panics
    ///
    /// If one of the planes was exchanged for one of another length.
    #[must_use]
    pub fn as_depth_map(&self) -> DepthMap<'_> {
        DepthMap::new(self.width, self.height, &self.nearness, &self.payload)
            .expect("the planes of a DepthBuffer keep their length")
    }
}

/// What became of the triangles of one map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawStats {
    /// Triangles whose bounds hold at least one texel centre of the map.
    pub drawn: usize,
    /// Triangles that the near plane or the guard band cut, or that lie outside one of them.
    pub clipped: usize,
    /// Triangles with an index out of range or a vertex that is not finite; not drawn.
    pub invalid: usize,
}
