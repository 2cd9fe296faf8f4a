//! The visibility channels of a light's samples (section 3).

use alloc::vec::Vec;
use core::ops::Range;

use shadowmap_core::{BandSlice, DepthMap, Level, for_each_band};

use crate::discontinuity::{Rows, Side};
use crate::skin_polygons::PolygonScratch;
use crate::skin_spans::SpanRow;
use crate::{SampleViews, SkinOptions};

/// Rows per band of work.
const BAND: usize = 4;

/// The visibility channels of a light's N samples, kept from frame to frame.
///
/// The paper's channel V_k says how much of the light a point sees that only sample k sees of the
/// two ends of a segment, and one half if both do, *as of the texel*. Receivers are finer than
/// texels: along the end of a penumbra a pixel may be seen by both samples while its texel is not,
/// and the sum comes to 1.5, or to 0.5 the other way round. So what is kept here are the skins
/// alone, for either end of each segment, and whether both samples see a point is decided where it
/// is shaded ([`crate::SkinShadow`]). [`VisibilityChannels::channel`] gives the paper's V_k.
#[derive(Clone, Debug)]
pub struct VisibilityChannels {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) segments: usize,
    /// For each row, for each segment, for its first and its last sample: one row of the fraction
    /// of the segment that is seen, from that sample on, up to the nearest skin. 1 where none is.
    pub(crate) seen: Vec<f32>,
    /// The columns of each row of that which may not be 1. To clear those alone saves half the time
    /// of drawing: memory is what it waits for.
    touched: Vec<Range<usize>>,
    /// The nearness that moves a skin's edge by one texel.
    pub(crate) texel_in_nearness: f32,
    /// The instructions to shade with: those that the channels were drawn with.
    pub(crate) level: Level,
    pub(crate) polygons: PolygonScratch,
}

impl Default for VisibilityChannels {
    fn default() -> VisibilityChannels {
        VisibilityChannels::new()
    }
}

impl VisibilityChannels {
    /// Without maps yet.
    #[must_use]
    pub fn new() -> VisibilityChannels {
        VisibilityChannels {
            width: 0,
            height: 0,
            segments: 0,
            seen: Vec::new(),
            touched: Vec::new(),
            texel_in_nearness: 0.0,
            level: Level::SCALAR,
            polygons: PolygonScratch::default(),
        }
    }

    /// Makes the channels of rectified maps, one map per view.
    ///
    /// # Panics
    ///
    /// If there are not as many maps as views, or one is of another size than the views.
    pub fn draw_rectified(
        &mut self,
        views: &SampleViews,
        maps: &[DepthMap<'_>],
        options: &SkinOptions,
    ) {
        let view = &views.views()[0];
        self.reset(views.views().len(), [view.width(), view.height()], maps);
        self.texel_in_nearness = 1.0 / views.disparity();
        self.level = options.level;
        let (width, height) = (self.width, self.height);
        let channels = 2 * self.segments;
        if width == 0 {
            return;
        }
        let bands = (
            BandSlice { data: &mut self.seen, len: BAND * channels * width },
            BandSlice { data: &mut self.touched, len: BAND * channels },
        );
        for_each_band(options.threads, bands, &|band, (seen, touched)| {
            let rows = seen.data.chunks_exact_mut(width).zip(touched.data).enumerate();
            for (row, (out, touched)) in rows {
                let (y, channel) = (band * BAND + row / channels, row % channels);
                let segment = channel / 2;
                // Skins hang in the map of the segment's other end.
                let (from, to, side) = match channel % 2 {
                    0 => (segment + 1, segment, Side::Right),
                    _ => (segment, segment + 1, Side::Left),
                };
                let row = SpanRow {
                    from: Rows::of(maps[from].nearness(), width, height, y),
                    to: &maps[to].nearness()[y * width..][..width],
                    disparity: views.disparity(),
                    side,
                    discontinuity: options.discontinuity,
                    transition: options.transition,
                };
                out[touched.clone()].fill(1.0);
                *touched = 0..0;
                row.draw(options.level, out, touched);
            }
        });
    }

    /// Makes room for the channels of `samples` maps.
    pub(crate) fn reset(&mut self, samples: usize, size: [u32; 2], maps: &[DepthMap<'_>]) {
        assert!(samples >= 2, "a linear light needs a sample at either end");
        assert_eq!(maps.len(), samples, "one map per view");
        for map in maps {
            assert_eq!([map.width(), map.height()], size, "the maps are of the views' size");
        }
        let shape = [samples - 1, size[0] as usize, size[1] as usize];
        if shape != [self.segments, self.width, self.height] {
            [self.segments, self.width, self.height] = shape;
            let rows = 2 * self.segments * self.height;
            self.seen.clear();
            self.seen.resize(rows * self.width, 1.0);
            self.touched.clear();
            self.touched.resize(rows, 0..0);
        }
    }

    /// Samples that there are channels for; 0 before the first drawing.
    #[must_use]
    pub fn samples(&self) -> usize {
        if self.segments == 0 { 0 } else { self.segments + 1 }
    }

    /// One row of the fraction of `segment` that is seen, up to the nearest skin, from its first
    /// sample (`end` 0) or its last (`end` 1).
    #[inline]
    pub(crate) fn row(&self, segment: usize, end: usize, y: usize) -> &[f32] {
        &self.seen[((y * self.segments + segment) * 2 + end) * self.width..][..self.width]
    }

    /// All that follows the first row of [`VisibilityChannels::row`], and how far apart rows are.
    #[inline]
    pub(crate) fn rows(&self, segment: usize, end: usize) -> (&[f32], usize) {
        (&self.seen[(segment * 2 + end) * self.width..], 2 * self.segments * self.width)
    }

    /// The same, to be written.
    pub(crate) fn row_mut(&mut self, segment: usize, end: usize, y: usize) -> &mut [f32] {
        let (row, width) = ((y * self.segments + segment) * 2 + end, self.width);
        self.touched[row] = 0..width;
        &mut self.seen[row * width..][..width]
    }

    /// Writes the visibility channel V_k of section 3.2, row-major: under a skin the fraction of a
    /// segment that is seen, elsewhere one half, and for a sample between two segments the sum of
    /// both. Each segment counts 1 / (N - 1), so that the channels of a point that every sample
    /// sees add up to 1.
    ///
    /// # Panics
    ///
    /// If there is no sample `k`, or `out` has another length than a map.
    pub fn channel(&self, k: usize, out: &mut [f32]) {
        assert!(k < self.samples(), "no such sample");
        assert_eq!(out.len(), self.width * self.height, "one visibility per texel");
        if self.width == 0 {
            return;
        }
        let weight = 1.0 / self.segments as f32;
        let before = k.checked_sub(1).map(|segment| (segment, 1));
        let after = (k < self.segments).then_some((k, 0));
        for (y, out) in out.chunks_exact_mut(self.width).enumerate() {
            out.fill(0.0);
            for (segment, end) in before.into_iter().chain(after) {
                for (out, &seen) in out.iter_mut().zip(self.row(segment, end, y)) {
                    *out += if seen < 1.0 { seen * weight } else { 0.5 * weight };
                }
            }
        }
    }
}
