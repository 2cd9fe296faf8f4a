//! Depth as other renderers hold it, turned into nearness.

use glam::Mat4;

use crate::{Projection, View};

/// What the numbers of a foreign depth buffer mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum DepthConvention {
    /// Metres along the view axis: from the eye (perspective) or from the near plane
    /// (orthographic). 0, negative, infinite and NaN are "nothing".
    Linear,
    /// Metres from the eye along the pixel's ray, as ray casters give it (perspective only; the
    /// same as [`DepthConvention::Linear`] for orthographic views).
    Distance,
    /// The depth buffer of OpenGL with its default depth range: 0 at the near plane, 1 at the far
    /// plane, from clip coordinates with z from -w to w. 1 is "nothing".
    OpenGl,
    /// Direct3D, Vulkan, Metal, wgpu: 0 at the near plane, 1 at the far plane, from clip
    /// coordinates with z from 0 to w. 1 is "nothing".
    ZeroToOne,
    /// The same, reversed: 1 at the near plane, 0 at the far plane or at infinity. 0 is
    /// "nothing".
    ReversedZ,
}

impl DepthConvention {
    /// Normalized depth of the near and of the far plane, as [`View::from_clip`] wants it.
    #[must_use]
    pub fn clip_range(self) -> [f32; 2] {
        match self {
            DepthConvention::OpenGl => [-1.0, 1.0],
            DepthConvention::ReversedZ => [1.0, 0.0],
            _ => [0.0, 1.0],
        }
    }
}

/// Turns the depth values of one foreign buffer into nearness.
///
/// ```
/// use glam::{Vec3, camera::rh::{proj::opengl, view::look_at_mat4}};
/// use shadowmap_core::{DepthConvention, ForeignDepth};
/// let clip = opengl::perspective(1.0, 1.0, 0.1, 100.0)
///     * look_at_mat4(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y);
/// let depth = ForeignDepth::new(clip, DepthConvention::OpenGl, 64, 64).unwrap();
/// // What OpenGL writes for a point at a depth of 4 metres:
/// let ndc = clip.project_point3(Vec3::ZERO).z;
/// let nearness = depth.nearness(32.5, 32.5, ndc * 0.5 + 0.5);
/// assert!((nearness - 0.25).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForeignDepth {
    view: View,
    convention: DepthConvention,
    scale: f64,
    offset: f64,
}

impl ForeignDepth {
    /// The view that `clip_from_world` describes, for a buffer of `width * height` texels whose
    /// first row is at the top of the image.
    ///
    /// `None` if the matrix is not that of a camera ([`View::from_clip`]).
    #[must_use]
    pub fn new(
        clip_from_world: Mat4,
        convention: DepthConvention,
        width: u32,
        height: u32,
    ) -> Option<ForeignDepth> {
        let view = View::from_clip(clip_from_world, convention.clip_range(), width, height)?;
        // Normalized depth is affine in nearness; two points of the view axis say how.
        let [near, far] = convention.clip_range().map(f64::from);
        let clip = clip_from_world.as_dmat4();
        let (row_z, row_w) = (clip.row(2), clip.row(3));
        let (scale, offset) = match view.projection() {
            Projection::Perspective => {
                let length = row_w.truncate().length();
                let a = row_z.truncate().dot(row_w.truncate()) / (length * length);
                let b = (row_z.w - a * row_w.w) / length;
                (1.0 / b, -a / b)
            }
            Projection::Orthographic => {
                let scale = f64::from(view.max_nearness()) / (near - far);
                (scale, -far * scale)
            }
        };
        (scale.is_finite() && offset.is_finite()).then_some(ForeignDepth {
            view,
            convention,
            scale,
            offset,
        })
    }

    /// The view of the buffer.
    #[must_use]
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Nearness of the depth value at texel coordinates (u, v); 0 where it means "nothing".
    #[must_use]
    pub fn nearness(&self, u: f32, v: f32, value: f32) -> f32 {
        self.convert(self.convention, u, v, value)
    }

    /// Writes the nearness of each value of row `y` of the buffer.
    ///
    /// # Panics
    ///
    /// If the two rows differ in length.
    pub fn nearness_of_row(&self, y: u32, values: &[f32], out: &mut [f32]) {
        assert_eq!(values.len(), out.len(), "one nearness per value");
        use DepthConvention::{Distance, Linear, OpenGl, ReversedZ, ZeroToOne};
        // One loop per convention, which the compiler makes vector code of.
        match self.convention {
            Linear => self.convert_row(Linear, y, values, out),
            Distance => self.convert_row(Distance, y, values, out),
            OpenGl => self.convert_row(OpenGl, y, values, out),
            ZeroToOne => self.convert_row(ZeroToOne, y, values, out),
            ReversedZ => self.convert_row(ReversedZ, y, values, out),
        }
    }

    #[inline(always)]
    fn convert_row(&self, convention: DepthConvention, y: u32, values: &[f32], out: &mut [f32]) {
        for (x, (out, &value)) in out.iter_mut().zip(values).enumerate() {
            *out = self.convert(convention, x as f32 + 0.5, y as f32 + 0.5, value);
        }
    }

    #[inline(always)]
    fn convert(&self, convention: DepthConvention, u: f32, v: f32, value: f32) -> f32 {
        let (normalized, is_there) = match convention {
            DepthConvention::Linear => return self.nearness_at(f64::from(value)),
            DepthConvention::Distance => {
                return self.nearness_at(f64::from(value) * self.cosine(u, v));
            }
            DepthConvention::OpenGl => (f64::from(value) * 2.0 - 1.0, value < 1.0),
            DepthConvention::ZeroToOne => (f64::from(value), value < 1.0),
            DepthConvention::ReversedZ => (f64::from(value), value > 0.0),
        };
        let nearness = (normalized * self.scale + self.offset) as f32;
        if is_there & (nearness > 0.0) & (nearness < f32::INFINITY) { nearness } else { 0.0 }
    }

    /// Nearness at a depth along the view axis.
    #[inline(always)]
    fn nearness_at(&self, depth: f64) -> f32 {
        let nearness = match self.view.projection() {
            Projection::Perspective => 1.0 / depth,
            Projection::Orthographic => (f64::from(self.view.max_nearness()) - depth).max(0.0),
        };
        // What is nearer than nearness can say is there all the same.
        let nearness = nearness.min(f64::from(f32::MAX)) as f32;
        if (depth > 0.0) & (depth < f64::INFINITY) { nearness } else { 0.0 }
    }

    /// Cosine between the view axis and the ray through texel coordinates (u, v).
    #[inline(always)]
    fn cosine(&self, u: f32, v: f32) -> f64 {
        match self.view.projection() {
            Projection::Orthographic => 1.0,
            Projection::Perspective => {
                let [x, y, z, _] = self.view.eye();
                let ray = self.view.world_from_texel(u, v, 1.0) - glam::Vec3::new(x, y, z);
                1.0 / ray.as_dvec3().length()
            }
        }
    }
}
