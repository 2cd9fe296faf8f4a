//! Shading with visibility channels (section 3).

mod image;
mod partly;
mod planes;
mod sixteen;

use glam::{Vec2, Vec3};
use shadowmap_core::{Bias, DepthMap, LightPoint, Plane, View};

pub(crate) use image::Image;
pub use image::visibility;

use crate::lookup::{Sample, between};
use crate::{SampleViews, VisibilityChannels};

/// What receivers are shaded with: the maps of all samples of one frustum, and the visibility
/// channels made of them.
#[derive(Clone, Copy, Debug)]
pub struct SkinShadow<'a> {
    samples: Samples<'a>,
    maps: &'a [DepthMap<'a>],
    channels: &'a VisibilityChannels,
    bias: Bias,
}

#[derive(Clone, Copy, Debug)]
enum Samples<'a> {
    Rectified(&'a SampleViews),
    Unrelated(&'a [View]),
}

impl<'a> SkinShadow<'a> {
    /// Rectified maps and the channels that were made of them. `bias` is the tolerance of the
    /// shadow test.
    ///
    /// # Panics
    ///
    /// If views, maps and channels do not agree in number and size.
    #[must_use]
    pub fn rectified(
        views: &'a SampleViews,
        maps: &'a [DepthMap<'a>],
        channels: &'a VisibilityChannels,
        bias: Bias,
    ) -> SkinShadow<'a> {
        SkinShadow::checked(Samples::Rectified(views), views.views(), maps, channels, bias)
    }

    /// Maps of unrelated perspective views from equal steps along the light, and the channels that
    /// were made of them.
    ///
    /// # Panics
    ///
    /// If views, maps and channels do not agree in number and size.
    #[must_use]
    pub fn unrelated(
        views: &'a [View],
        maps: &'a [DepthMap<'a>],
        channels: &'a VisibilityChannels,
        bias: Bias,
    ) -> SkinShadow<'a> {
        SkinShadow::checked(Samples::Unrelated(views), views, maps, channels, bias)
    }

    fn checked(
        samples: Samples<'a>,
        views: &[View],
        maps: &'a [DepthMap<'a>],
        channels: &'a VisibilityChannels,
        bias: Bias,
    ) -> SkinShadow<'a> {
        assert_eq!(views.len(), maps.len(), "one map per view");
        assert_eq!(maps.len(), channels.samples(), "the channels are those of the maps");
        for (map, view) in maps.iter().zip(views) {
            let size = [map.width(), map.height()];
            assert_eq!(size, [view.width(), view.height()], "maps are of the views' size");
            assert_eq!(size.map(|s| s as usize), [channels.width, channels.height]);
        }
        SkinShadow { samples, maps, channels, bias }
    }

    fn views(&self) -> &'a [View] {
        match self.samples {
            Samples::Rectified(views) => views.views(),
            Samples::Unrelated(views) => views,
        }
    }

    /// See [`SampleViews::rank`].
    fn rank(&self, position: Vec3) -> (f32, bool) {
        match self.samples {
            Samples::Rectified(views) => views.rank(position),
            Samples::Unrelated(views) => {
                (views[0].axes()[2].dot(position - self.position(0)), false)
            }
        }
    }

    /// The fraction of the light that a surface sees at `position`; its geometric unit `normal`
    /// is turned to the side that is looked at. What is below the surface's horizon is not seen. A
    /// point outside the light's frustum counts as lit.
    #[must_use]
    pub fn visibility(&self, position: Vec3, normal: Vec3) -> f32 {
        self.light(position, normal, |_, _| {})
    }

    /// The shading of section 3: calls `add` with the index k of each sample that a surface sees
    /// some of the light with, and V_k. The caller sums V_k times the local illumination by a light
    /// at [`SkinShadow::position`] of k. Arguments and result as in [`SkinShadow::visibility`],
    /// which is the sum of V_k.
    pub fn light(&self, position: Vec3, normal: Vec3, add: impl FnMut(usize, f32)) -> f32 {
        let surface = self.surface(Plane::through(position, normal), 1.0);
        let Some(above) = surface.above else { return 0.0 };
        let point = surface.point(self.views()[0].texel_from_world(position));
        let receiver = Receiver { point, position, plane: &surface.plane, above };
        self.seen_by(&receiver, self.test_all(&receiver), add)
    }

    /// Where on the light sample `k` is.
    ///
    /// # Panics
    ///
    /// If there is no such sample.
    #[must_use]
    pub fn position(&self, k: usize) -> Vec3 {
        let [x, y, z, _] = self.views()[k].eye();
        Vec3::new(x, y, z)
    }

    /// What all receivers on `plane` share, of which the positive side is looked at if `side` is
    /// positive.
    fn surface(&self, plane: Plane, side: f32) -> Surface {
        let views = self.views();
        let first = plane.side_of(views[0].eye()) * side;
        let last = plane.side_of(views[views.len() - 1].eye()) * side;
        let above = match (first < 0.0, last < 0.0) {
            (true, true) => None,
            (true, false) => Some([first / (first - last), 1.0]),
            (false, true) => Some([0.0, first / (first - last)]),
            (false, false) => Some([0.0, 1.0]),
        };
        Surface { plane, slope: plane.slope_in(&views[0]), above }
    }

    /// Which samples see a receiver.
    #[inline(always)]
    fn test_all(&self, receiver: &Receiver<'_>) -> Test {
        let mut found = Test { all: true, any: false, outside: false };
        for k in 0..self.maps.len() {
            let (sample, lit) = self.test(receiver, k);
            found.outside |= sample.is_none();
            found.all &= lit[0] & lit[1];
            found.any |= lit[0] | lit[1];
        }
        found
    }

    /// How much of the light a receiver sees; `add` gets what falls to each sample.
    #[inline(always)]
    fn seen_by(&self, receiver: &Receiver<'_>, test: Test, mut add: impl FnMut(usize, f32)) -> f32 {
        // Most receivers are seen by all samples, or by none.
        if test.all && receiver.above == [0.0, 1.0] {
            let segments = self.maps.len() - 1;
            for k in 0..=segments {
                let share = if k == 0 || k == segments { 0.5 } else { 1.0 };
                add(k, share / segments as f32);
            }
            1.0
        } else if test.any {
            self.sum(receiver, &mut add)
        } else {
            0.0
        }
    }

    /// The receiver in the map of sample `k`, `None` outside it, and whether the sample sees it, by
    /// the texels of either row next to it.
    #[inline(always)]
    fn test(&self, receiver: &Receiver<'_>, k: usize) -> (Option<Sample>, [bool; 2]) {
        let map = &self.maps[k];
        match self.samples {
            Samples::Rectified(views) => {
                let shift = views.disparity() * k as f32;
                let sample = receiver.point.and_then(|p| Sample::new(&p, shift, self.bias, map));
                (sample, sample.map_or([true; 2], |sample| sample.lit(map)))
            }
            Samples::Unrelated(views) => {
                let point = views[k].texel_from_world(receiver.position).map(|seen| {
                    let slope = receiver.plane.slope_in(&views[k]);
                    LightPoint { u: seen.x, v: seen.y, nearness: seen.z, slope }
                });
                let sample = point.and_then(|p| Sample::new(&p, 0.0, self.bias, map));
                // Rows of unrelated maps have nothing in common.
                (sample, sample.map_or([true; 2], |s| [s.lit(map)[s.nearest_row()]; 2]))
            }
        }
    }

    /// The light that a receiver sees, segment by segment; `add` gets what falls to each sample.
    #[inline(never)]
    fn sum(&self, receiver: &Receiver<'_>, add: &mut impl FnMut(usize, f32)) -> f32 {
        let segments = self.maps.len() - 1;
        let per_segment = 1.0 / segments as f32;
        let weights = match (self.samples, receiver.point) {
            (Samples::Rectified(_), Some(point)) => weights_at(point.v),
            _ => [1.0, 0.0],
        };
        let (mut visibility, mut carried) = (0.0, 0.0);
        let (mut near, mut near_lit) = self.test(receiver, 0);
        for segment in 0..segments {
            let (far, far_lit) = self.test(receiver, segment + 1);
            // The part of the segment above the horizon, in its own parameter.
            let above =
                receiver.above.map(|t| (t * segments as f32 - segment as f32).clamp(0.0, 1.0));
            let mut shares = [0.0, 0.0];
            for (row, weight) in weights.into_iter().enumerate() {
                let lit = [near_lit[row], far_lit[row]];
                // From an end that is lit up to the nearest blocker.
                let seen = match (lit, &near, &far) {
                    ([true, false], Some(near), _) => [0.0, self.seen(segment, 0, near, row)],
                    ([false, true], _, Some(far)) => [1.0 - self.seen(segment, 1, far, row), 1.0],
                    ([false, false], _, _) => continue,
                    _ => [0.0, 1.0],
                };
                let length = (seen[1].min(above[1]) - seen[0].max(above[0])).max(0.0) * weight;
                if lit == [true, true] {
                    shares = shares.map(|share| share + 0.5 * length);
                } else {
                    shares[usize::from(lit[1])] += length;
                }
            }
            let v = (carried + shares[0]) * per_segment;
            if v > 0.0 {
                add(segment, v);
            }
            visibility += v;
            carried = shares[1];
            (near, near_lit) = (far, far_lit);
        }
        let v = carried * per_segment;
        if v > 0.0 {
            add(segments, v);
        }
        // Parts of a whole add up to 1 only as far as rounding lets them.
        (visibility + v).min(1.0)
    }

    /// How much of a segment is seen from the sample at its first (`end` 0) or last (1) end.
    fn seen(&self, segment: usize, end: usize, sample: &Sample, row: usize) -> f32 {
        let map = &self.maps[segment + end];
        let channel = |y: usize| self.channels.row(segment, end, y);
        let texel = self.channels.texel_in_nearness;
        match self.samples {
            Samples::Rectified(_) => sample.seen(map, &[(row, 1.0)], texel, channel),
            Samples::Unrelated(_) => {
                let [above, below] = weights_at(sample.v());
                let nearest = sample.nearest_row();
                let rows = [
                    (nearest, [above, below][nearest]),
                    (1 - nearest, [above, below][1 - nearest]),
                ];
                sample.seen(map, &rows, texel, channel)
            }
        }
    }
}

/// What the rows of texels above and below a coordinate count for.
#[inline(always)]
fn weights_at(v: f32) -> [f32; 2] {
    let below = between(v);
    // Outside the map, where rows weigh alike, it may be anything.
    let below = if below < 1.0 { below.max(0.0) } else { 0.0 };
    [1.0 - below, below]
}

/// What the receivers on one plane share.
#[derive(Clone, Copy)]
struct Surface {
    plane: Plane,
    /// Of the plane in the first sample's map.
    slope: Vec2,
    /// The parameters between which the light is above the plane; `None` if nothing of it is.
    above: Option<[f32; 2]>,
}

impl Surface {
    /// The receiver on it at (u, v, nearness) in the first sample's map.
    fn point(&self, seen: Option<Vec3>) -> Option<LightPoint> {
        seen.map(|seen| LightPoint { u: seen.x, v: seen.y, nearness: seen.z, slope: self.slope })
    }
}

/// A receiver, before any sample.
struct Receiver<'a> {
    /// Where the first sample has it; `None` behind the light.
    point: Option<LightPoint>,
    position: Vec3,
    plane: &'a Plane,
    above: [f32; 2],
}

/// Which samples see a receiver, by the texels in the rows next to it.
#[derive(Clone, Copy)]
struct Test {
    /// Whether no texel hides it.
    all: bool,
    /// Whether not all texels hide it.
    any: bool,
    /// Whether some sample has it outside its map, where it counts as lit.
    outside: bool,
}
