//! The nearest depth of a part of the map.

use core::ops::Range;

use crate::pyramid::{FAN, Layout, Pyramid};

/// Nodes per axis that one question may look at, plus one for where the box begins within a node.
const SPAN: u64 = 4;

impl Pyramid<'_> {
    /// An upper bound on the nearness of the texels in `columns` and `rows`, which may reach
    /// outside the map: it bounds how far a penumbra can reach there. Looks at 25 nodes at most.
    /// `f32::NEG_INFINITY` if the box holds no texel, or nothing but NaN.
    #[must_use]
    pub fn greatest(&self, columns: Range<u32>, rows: Range<u32>) -> f32 {
        let columns = columns.start..columns.end.min(self.layout.width);
        let rows = rows.start..rows.end.min(self.layout.height);
        if columns.is_empty() || rows.is_empty() {
            return f32::NEG_INFINITY;
        }
        let mut level = 0;
        while level + 1 < self.layout.count {
            let [width, height] = Layout::node_size(level);
            if u64::from(columns.end - columns.start) <= SPAN * width
                && u64::from(rows.end - rows.start) <= SPAN * height
            {
                break;
            }
            level += 1;
        }
        let [width, height] = Layout::node_size(level);
        let [half_width, half_height] = [(width - 1) as f32 * 0.5, (height - 1) as f32 * 0.5];
        let node = |texel: u32, size: u64| (u64::from(texel) / size) as u32;
        let mut greatest = f32::NEG_INFINITY;
        for y in node(rows.start, height)..=node(rows.end - 1, height) {
            for x in node(columns.start, width)..=node(columns.end - 1, width) {
                let Some(group) = self.layout.group(level, x / FAN, y / FAN) else { continue };
                let (nodes, lane) = (&self.nodes[group], (y % FAN * FAN + x % FAN) as usize);
                let steep = nodes.slope_x[lane].abs() * half_width
                    + nodes.slope_y[lane].abs() * half_height;
                let bound = nodes.high[lane] + steep;
                // Room for the rounding of the sum.
                greatest = greatest.max(bound + bound.abs() * (1.0 / 1048576.0));
            }
        }
        greatest
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::{vec, vec::Vec};

    use proptest::prelude::*;
    use shadowmap_core::{DepthMap, Level};

    use crate::{NodeGroup, Pyramid};

    #[test]
    fn is_tight_around_one_near_texel() {
        let mut texels = vec![0.25; 256 * 256];
        texels[100 * 256 + 100] = 0.5;
        let map = DepthMap::new(256, 256, &texels, &[]).unwrap();
        let mut storage = vec![NodeGroup::default(); Pyramid::storage_len(256, 256)];
        let pyramid = Pyramid::build(Level::SCALAR, map, &mut storage, &mut []).unwrap();
        assert!((pyramid.greatest(90..110, 90..110) - 0.5).abs() < 1e-5);
        assert!((pyramid.greatest(0..60, 90..110) - 0.25).abs() < 1e-5);
        assert_eq!(pyramid.greatest(256..300, 0..9), f32::NEG_INFINITY);
    }

    proptest! {
        #[test]
        fn bounds_every_texel_of_the_box(
            width in 1_u32..200, height in 1_u32..100, seed in any::<u32>(),
            x in 0_u32..220, y in 0_u32..120, columns in 0_u32..200, rows in 0_u32..120,
        ) {
            let texels: Vec<f32> = (0..width * height)
                .map(|i| (i ^ seed).wrapping_mul(0x9e37_79b1) as f32 * 1e-9)
                .collect();
            let map = DepthMap::new(width, height, &texels, &[]).unwrap();
            let mut storage = vec![NodeGroup::default(); Pyramid::storage_len(width, height)];
            let pyramid = Pyramid::build(Level::SCALAR, map, &mut storage, &mut []).unwrap();
            let bound = pyramid.greatest(x..x + columns, y..y + rows);
            let inside = (y..(y + rows).min(height))
                .flat_map(|y| (x..(x + columns).min(width)).map(move |x| (x, y)))
                .map(|(x, y)| texels[(y * width + x) as usize])
                .fold(f32::NEG_INFINITY, f32::max);
            prop_assert!(bound >= inside);
        }
    }
}
