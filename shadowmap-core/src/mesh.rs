//! Borrowed triangle meshes.

use glam::Vec3;

/// An indexed triangle mesh in world space, borrowed from whoever owns it.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    /// Vertex positions in metres.
    pub positions: &'a [Vec3],
    /// Three indices into `positions` per triangle. A triangle with an index past the end is
    /// not drawn.
    pub triangles: &'a [[u32; 3]],
    /// The object ID of each triangle, as many as there are triangles. 0 is "nothing": give
    /// objects IDs from 1.
    pub ids: &'a [u32],
}
