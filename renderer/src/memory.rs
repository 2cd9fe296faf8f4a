//! How much memory a frame takes, told before any is taken.

use linear_light::{AdaptiveOptions, RectifiedLight, SampleViews};
use shadowmap_core::View;

use crate::lighting::{LightJob, Plan};
use crate::method::Method;

/// What a frame is made of.
#[derive(Clone, Copy, Debug)]
pub struct FrameSize<'a> {
    /// Width and height of the picture.
    pub size: [u32; 2],
    /// Pixels of the camera per pixel of the picture along each axis.
    pub aa: u32,
    /// Whether the picture's file holds floats.
    pub is_float: bool,
    /// Triangles of the scene.
    pub triangles: usize,
    /// The lights.
    pub lights: &'a [LightJob],
}

impl FrameSize<'_> {
    /// Bytes that the frame takes at most, about: maps, visibility, the picture and its file.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let [width, height] = self.size.map(u64::from);
        let samples = (width * height).saturating_mul(u64::from(self.aa * self.aa));
        let worst = |bytes: &dyn Fn(&LightJob) -> u64| self.lights.iter().map(bytes).max();
        let extra = worst(&|light| bytes_per_sample(light)).unwrap_or(0);
        // Nearness and triangle that the camera sees, and the visibility of each light.
        let per_sample = 8 + 4 * self.lights.len() as u64 + extra;
        // The picture, a copy of it to be written, and its file in the making: floats or bytes.
        let per_pixel = if self.is_float { 36 } else { 12 };
        let picture = samples
            .saturating_mul(per_sample)
            .saturating_add((width * height).saturating_mul(per_pixel));
        // Lights are drawn one after another.
        picture.saturating_add(worst(&|light| self.map_bytes(light)).unwrap_or(0))
    }

    fn map_bytes(&self, light: &LightJob) -> u64 {
        // Nearness and object ID, and what is built over them.
        let per_texel = if light.method == Method::Skins { 16 } else { 9 };
        // Vertices and bins of each view, or the nodes of a tree of boxes.
        let triangles = (self.triangles as u64).saturating_mul(64);
        let bytes = |view: &View| {
            let texels = u64::from(view.width()) * u64::from(view.height());
            texels.saturating_mul(per_texel).saturating_add(triangles)
        };
        let all = |views: &[View]| views.iter().map(bytes).fold(0, u64::saturating_add);
        // All maps of a frustum are of one size.
        let of_frustum = |frustum: &SampleViews| match light.adapts.in_frustum(frustum) {
            true => {
                let most = AdaptiveOptions::default().most_samples.max(frustum.views().len());
                bytes(&frustum.views()[0]).saturating_mul(most as u64)
            }
            false => all(frustum.views()),
        };
        // As many as are held at the same time.
        let maps = match &light.plan {
            Plan::Middle(views) => Some(all(views)),
            Plan::Points(points) => points.iter().map(|views| all(views)).max(),
            Plan::Lines(lines) => {
                let of_line = |line: &RectifiedLight| {
                    line.frusta().iter().map(of_frustum).fold(0, u64::saturating_add)
                };
                lines.iter().map(|(_, line)| of_line(line)).max()
            }
            Plan::Rays => None,
        };
        maps.unwrap_or(0).max(triangles)
    }
}

/// What drawing a light takes per sample of the picture beside its visibility.
fn bytes_per_sample(light: &LightJob) -> u64 {
    match &light.plan {
        // Receivers of one face, and their visibility.
        Plan::Middle(views) if views.len() > 1 => 8,
        Plan::Middle(_) => 0,
        Plan::Points(points) if points.iter().any(|views| views.len() > 1) => 12,
        Plan::Points(_) | Plan::Lines(_) => 4,
        // Positions and normals.
        Plan::Rays => 24,
    }
}
