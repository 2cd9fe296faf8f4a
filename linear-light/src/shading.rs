//! Shading with visibility channels (section 3).

use glam::Vec3;
use shadowmap_core::{
    BandSlice, Bias, Camera, DepthMap, LightPoint, Plane, Threads, View, for_each_band,
};

use crate::counters::Tally;
use crate::{Counters, SampleViews, VisibilityChannels};

/// An edge that keeps to its row for this many texels either way lies along the light.
const STRAIGHT: usize = 16;

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
    /// Rectified maps and the channels that were made of them. `bias` is the tolerance of the shadow
    /// test.
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
        let plane = Plane([normal.x, normal.y, normal.z, -normal.dot(position)]);
        self.look_up(position, &plane, 1.0, add).visibility
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

    /// A receiver on `plane`, of which the positive side is looked at if `side` is positive.
    #[inline]
    fn look_up(
        &self,
        position: Vec3,
        plane: &Plane,
        side: f32,
        mut add: impl FnMut(usize, f32),
    ) -> LookUp {
        let segments = self.maps.len() - 1;
        let Some(above) = self.above_horizon(plane, side) else {
            return LookUp { visibility: 0.0, outside: false };
        };
        let receiver = self.receiver(position, plane);
        let per_segment = 1.0 / segments as f32;
        let mut near = self.test(&receiver, 0);
        let mut outside = near.is_none();
        let (mut visibility, mut carried) = (0.0, 0.0);
        for segment in 0..segments {
            let far = self.test(&receiver, segment + 1);
            outside |= far.is_none();
            // The part of the segment above the horizon, in its own parameter.
            let part = above.map(|t| (t * segments as f32 - segment as f32).clamp(0.0, 1.0));
            let mut shares = [0.0, 0.0];
            for (row, weight) in receiver.weights.into_iter().enumerate() {
                let lit = [&near, &far].map(|s| s.as_ref().is_none_or(|s| s.lit[row]));
                // Up to the nearest blocker from the end that is lit.
                let seen = match (lit, &near, &far) {
                    ([true, false], Some(near), _) => [0.0, self.seen(segment, 0, near, row)],
                    ([false, true], _, Some(far)) => [1.0 - self.seen(segment, 1, far, row), 1.0],
                    ([false, false], _, _) => [0.0, 0.0],
                    _ => [0.0, 1.0],
                };
                let length = (seen[1].min(part[1]) - seen[0].max(part[0])).max(0.0) * weight;
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
            near = far;
        }
        let v = carried * per_segment;
        if v > 0.0 {
            add(segments, v);
        }
        LookUp { visibility: visibility + v, outside }
    }

    /// The parameters between which the light is above the receiver's horizon; `None` if nothing
    /// of it is.
    fn above_horizon(&self, plane: &Plane, side: f32) -> Option<[f32; 2]> {
        let views = self.views();
        let first = plane.side_of(views[0].eye()) * side;
        let last = plane.side_of(views[views.len() - 1].eye()) * side;
        match (first < 0.0, last < 0.0) {
            (true, true) => None,
            (true, false) => Some([first / (first - last), 1.0]),
            (false, true) => Some([0.0, first / (first - last)]),
            (false, false) => Some([0.0, 1.0]),
        }
    }

    fn receiver<'r>(&self, position: Vec3, plane: &'r Plane) -> Receiver<'r> {
        let Samples::Rectified(views) = self.samples else {
            return Receiver { position, plane, first: None, weights: [1.0, 0.0] };
        };
        let first = point_in(&views.views()[0], position, plane);
        // How far down the receiver lies from the centre of one row to that of the next.
        let below = first.map_or(0.0, |p| (p.v + 0.5) - (p.v + 0.5) as u32 as f32);
        Receiver { position, plane, first, weights: [1.0 - below, below] }
    }

    /// Whether sample `k` sees the receiver; `None` outside its map.
    #[inline(always)]
    fn test(&self, receiver: &Receiver<'_>, k: usize) -> Option<Sample> {
        let point = match self.samples {
            Samples::Rectified(views) => views.in_sample(&receiver.first?, k),
            Samples::Unrelated(views) => point_in(&views[k], receiver.position, receiver.plane)?,
        };
        let map = &self.maps[k];
        let (width, height) = (map.width() as usize, map.height() as usize);
        // Written so that NaN falls outside.
        let inside =
            point.u >= 0.0 && point.v >= 0.0 && point.u < width as f32 && point.v < height as f32;
        if !inside {
            return None;
        }
        let x = point.u as usize;
        let rows = match self.samples {
            Samples::Rectified(_) => rows_around(point.v, height),
            Samples::Unrelated(_) => [point.v as usize; 2],
        };
        let offset = self.bias.offset(&point);
        let lit_at = |x: usize| {
            rows.map(|y| {
                let limit = point.plane_at(x as f32 + 0.5, y as f32 + 0.5) + offset;
                let blocked = map.nearness()[y * width + x] > limit;
                !blocked
            })
        };
        let mut lit = lit_at(x);
        if lit[0] != lit[1] {
            // An edge along the light: hard, wherever between the rows it is.
            let goes_on = |x: Option<usize>| x.is_some_and(|x| x < width && lit_at(x) == lit);
            if goes_on(x.checked_sub(STRAIGHT)) && goes_on(x.checked_add(STRAIGHT)) {
                lit = [lit[usize::from(receiver.weights[1] > 0.5)]; 2];
            }
        }
        Some(Sample { point, offset, rows, lit })
    }

    /// How much of a segment is seen from the sample at its first (`end` 0) or last (1) end:
    /// between the texels around the receiver, as far as they show its surface.
    fn seen(&self, segment: usize, end: usize, sample: &Sample, row: usize) -> f32 {
        let Sample { point, offset, rows, .. } = sample;
        let map = &self.maps[segment + end];
        let (width, height) = (map.width() as usize, map.height() as usize);
        // Where the map is off by this much, the skin is so by a texel.
        let tolerance = offset.max(self.channels.texel_in_nearness);
        let columns = rows_around(point.u, width);
        let right = (point.u + 0.5) - (point.u + 0.5) as u32 as f32;
        let (mut sum, mut weights) = (0.0, 0.0);
        let mut tap = |x: usize, y: usize, weight: f32| {
            let distance =
                map.nearness()[y * width + x] - point.plane_at(x as f32 + 0.5, y as f32 + 0.5);
            if distance.abs() <= tolerance {
                sum += weight * self.channels.row(segment, end, y)[x];
                weights += weight;
            }
        };
        let mut taps = |y: usize, weight: f32| {
            tap(columns[0], y, (1.0 - right) * weight);
            tap(columns[1], y, right * weight);
        };
        match self.samples {
            Samples::Rectified(_) => taps(rows[row], 1.0),
            Samples::Unrelated(_) => {
                let below = (point.v + 0.5) - (point.v + 0.5) as u32 as f32;
                let rows = rows_around(point.v, height);
                taps(rows[0], 1.0 - below);
                taps(rows[1], below);
            }
        }
        if weights > 0.0 {
            sum / weights
        } else {
            self.channels.row(segment, end, rows[row])[point.u as usize]
        }
    }
}

/// Writes the visibility of a light from every pixel of the camera, row-major. `frusta` are those
/// of one light (one, or all of a [`crate::RectifiedLight`]). Pixels that see nothing get 0, and so
/// do surfaces that turn away from the whole light.
///
/// Every number of threads gives the same bits.
///
/// # Panics
///
/// If there is no frustum, or `out` has another length than the camera has pixels.
pub fn visibility(
    camera: &Camera<'_>,
    frusta: &[SkinShadow<'_>],
    threads: Threads,
    out: &mut [f32],
) -> Counters {
    assert!(!frusta.is_empty(), "a light has a frustum");
    assert_eq!(out.len(), camera.map().nearness().len(), "one visibility per pixel");
    let width = camera.map().width() as usize;
    let tally = Tally::default();
    for_each_band(threads, BandSlice { data: out, len: width.max(1) }, &|y, row| {
        let mut counters = Counters::default();
        let nearness = &camera.map().nearness()[y * width..];
        for (x, (out, &n)) in row.data.iter_mut().zip(nearness).enumerate() {
            *out = 0.0;
            // Not where the camera sees nothing, nor at a NaN.
            if n > 0.0 {
                let position = camera.view().world_from_texel(x as f32 + 0.5, y as f32 + 0.5, n);
                let (_, plane) = camera.plane(x as u32, y as u32, n);
                let side = plane.side_of(camera.view().eye());
                let shadow = &frusta[frustum_of(frusta, position)];
                let found = shadow.look_up(position, &plane, side, |_, _| {});
                counters.receivers += 1;
                counters.outside += u32::from(found.outside);
                *out = found.visibility;
            }
        }
        tally.add(&counters);
    });
    tally.total()
}

/// The frustum that a receiver belongs to: see [`crate::RectifiedLight::frustum_of`].
fn frustum_of(frusta: &[SkinShadow<'_>], position: Vec3) -> usize {
    let depth =
        |shadow: &SkinShadow<'_>| shadow.views()[0].axes()[2].dot(position - shadow.position(0));
    let mut best = (0, f32::NEG_INFINITY);
    if frusta.len() > 1 {
        for (index, shadow) in frusta.iter().enumerate() {
            let depth = depth(shadow);
            if depth > best.1 {
                best = (index, depth);
            }
        }
    }
    best.0
}

/// What one frustum says of a receiver.
struct LookUp {
    visibility: f32,
    /// Whether a sample has the receiver outside its map.
    outside: bool,
}

/// A receiver, before any sample.
struct Receiver<'a> {
    position: Vec3,
    plane: &'a Plane,
    /// Where the first of rectified samples has it; `None` behind the light.
    first: Option<LightPoint>,
    /// What the two rows of texels next to the receiver count for.
    weights: [f32; 2],
}

/// A receiver in one sample's map.
struct Sample {
    point: LightPoint,
    offset: f32,
    rows: [usize; 2],
    /// By the texel that the receiver falls on in either row.
    lit: [bool; 2],
}

/// The two texels next to a coordinate, by their centres, within `len` texels.
#[inline(always)]
fn rows_around(at: f32, len: usize) -> [usize; 2] {
    let after = (at + 0.5) as usize;
    [after.saturating_sub(1), after.min(len - 1)]
}

/// The receiver at `position` on `plane` in a view's texel space; `None` behind the viewer.
#[inline]
fn point_in(view: &View, position: Vec3, plane: &Plane) -> Option<LightPoint> {
    let seen = view.texel_from_world(position)?;
    let slope = plane.slope_in(view);
    Some(LightPoint { u: seen.x, v: seen.y, nearness: seen.z, slope })
}
