//! Planar bounds over the parts of a map: what lets whole blocks of receivers be decided without
//! looking at texels.

use alloc::vec::Vec;

use shadowmap_core::BandSlice;

use crate::lanes::{INDEX, LANES, Lanes, Ops, lanes, max, texels};

/// Rows of texels in a band, and in a node.
pub(super) const BAND: usize = 8;

/// Texels from a node's centre to the centres of its outermost texels.
const HALF_COLUMNS: f32 = (LANES as f32 - 1.0) * 0.5;
const HALF_ROWS: f32 = (BAND as f32 - 1.0) * 0.5;

/// Sixteen nodes side by side, each over 16 columns of one band.
///
/// Texel n of a node, (x, y) texels from its centre, lies between
/// `center + slope_u * x + slope_v * y + low` and the same with `high`. Texels that hold nothing do
/// not count; a node of nothing has `high` = -inf and `low` = +inf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nodes {
    center: Lanes,
    slope_u: Lanes,
    slope_v: Lanes,
    low: Lanes,
    high: Lanes,
    /// An upper bound of the nearness of all texels.
    most: Lanes,
}

const NOTHING: Nodes = Nodes {
    center: [0.0; LANES],
    slope_u: [0.0; LANES],
    slope_v: [0.0; LANES],
    low: [f32::INFINITY; LANES],
    high: [f32::NEG_INFINITY; LANES],
    most: [0.0; LANES],
};

/// The bounds of one map.
#[derive(Clone, Debug, Default)]
pub(super) struct Bounds {
    nodes: Vec<Nodes>,
    /// Groups of nodes per band.
    columns: usize,
    /// An upper bound of the nearness of all texels of each band.
    most: Vec<f32>,
}

/// Which texels can matter to a group of receivers on one plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct BandSearch {
    /// A texel at column s, row t with nearness w lies in front of the plane if
    /// `a s + b t + c w + d` exceeds `bias`.
    pub plane: [f32; 4],
    pub bias: f32,
    /// Columns that the receivers span, widened by what a texel reaches beyond its centre.
    pub columns: [f32; 2],
    /// The least nearness of the receivers.
    pub nearness: f32,
    /// Texels of disparity per nearness towards either side: light to the left and to the right.
    pub reach: [f32; 2],
}

impl Bounds {
    /// Makes room for a map of that size.
    pub fn resize(&mut self, width: u32, height: u32) {
        self.columns = (width as usize).div_ceil(LANES * LANES).max(1);
        let bands = (height as usize).div_ceil(BAND);
        self.nodes.clear();
        self.nodes.resize(self.columns * bands, NOTHING);
        self.most.resize(bands, 0.0);
    }

    /// What [`build`] fills in, band by band.
    pub fn bands(&mut self) -> (BandSlice<'_, Nodes>, BandSlice<'_, f32>) {
        (
            BandSlice { data: &mut self.nodes, len: self.columns },
            BandSlice { data: &mut self.most, len: 1 },
        )
    }

    /// Appends to `found` every segment (16 columns from 16 times its number) of a band in which
    /// something can block.
    #[inline(always)]
    pub fn search(&self, ops: impl Ops, band: usize, search: &BandSearch, found: &mut Vec<u32>) {
        let [a, b, c, d] = search.plane;
        let row = (band * BAND) as f32 + BAND as f32 * 0.5;
        // The groups of nodes that the nearest texel of the band could reach from.
        let nearest = max(self.most[band] - search.nearness, 0.0);
        let group_of = |column: f32| max(column, 0.0) as usize / (LANES * LANES);
        let first = group_of(search.columns[0] - search.reach[0] * nearest);
        let last = group_of(search.columns[1] + search.reach[1] * nearest).min(self.columns - 1);
        for group in first..=last {
            let nodes = &self.nodes[band * self.columns + group];
            let first = lanes(|i| ((group * LANES) as f32 + INDEX[i]) * LANES as f32);
            let extreme = if c < 0.0 { &nodes.low } else { &nodes.high };
            // The greatest that a texel of the node can lie in front of the plane.
            let front = lanes(|i| {
                let at_center =
                    (a * (first[i] + LANES as f32 * 0.5) + (b * row + d)) + c * nodes.center[i];
                let spread = (c * nodes.slope_u[i] + a).abs() * HALF_COLUMNS
                    + (c * nodes.slope_v[i] + b).abs() * HALF_ROWS;
                (at_center + spread) + c * extreme[i]
            });
            let mut mask = ops.greater(&front, &[search.bias; LANES]);
            if mask == 0 {
                continue;
            }
            let nearer = lanes(|i| nodes.most[i] - search.nearness);
            mask &= ops.greater(&nearer, &[0.0; LANES]);
            let rightmost = lanes(|i| search.columns[1] + search.reach[1] * nearer[i]);
            mask &= ops.greater(&rightmost, &first);
            let leftmost = lanes(|i| search.columns[0] - search.reach[0] * nearer[i]);
            mask &= ops.greater(&lanes(|i| first[i] + LANES as f32), &leftmost);
            while mask != 0 {
                found.push((group * LANES) as u32 + mask.trailing_zeros());
                mask &= mask - 1;
            }
        }
    }
}

/// Bounds the texels of one band of a map: `rows` holds its rows, of `width` texels each. Returns
/// an upper bound of all.
#[inline(always)]
pub(crate) fn build(ops: impl Ops, band: &mut [Nodes], rows: &[f32], width: usize) -> f32 {
    let mut most = [0.0; LANES];
    for (group, nodes) in band.iter_mut().enumerate() {
        *nodes = NOTHING;
        for node in 0..LANES {
            let x0 = (group * LANES + node) * LANES;
            if x0 >= width {
                break;
            }
            if x0 + LANES <= width && rows.len() == BAND * width {
                let line = |y: usize| rows[y * width + x0..].first_chunk();
                let lines = core::array::from_fn(|y| line(y).expect("sixteen texels are left"));
                nodes.bound(ops, node, lines);
            } else {
                let mut lines = [[0.0; LANES]; BAND];
                for (line, row) in lines.iter_mut().zip(rows.chunks_exact(width)) {
                    *line = texels(row, x0);
                }
                nodes.bound(ops, node, lines.each_ref());
            }
        }
        most = ops.max(&nodes.most, &most);
    }
    ops.greatest(&most)
}

impl Nodes {
    #[inline(always)]
    fn bound(&mut self, ops: impl Ops, node: usize, band: [&Lanes; BAND]) {
        // The slope at the centre, where something is there.
        let (cx, cy) = (LANES / 2, BAND / 2);
        let at = band[cy][cx];
        let slope = |before: f32| if at > 0.0 && before > 0.0 { at - before } else { 0.0 };
        let (slope_u, slope_v) = (slope(band[cy][cx - 1]), slope(band[cy - 1][cx]));
        let finite = (at + slope_u + slope_v).is_finite() && at > 0.0;
        let (at, slope_u, slope_v) = if finite { (at, slope_u, slope_v) } else { (0.0, 0.0, 0.0) };
        let center = at - 0.5 * (slope_u + slope_v);
        let along = lanes(|i| center + slope_u * (INDEX[i] - HALF_COLUMNS));
        let (mut low, mut high) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
        let mut most = [0.0; LANES];
        for (y, line) in band.into_iter().enumerate() {
            let across = slope_v * (y as f32 - HALF_ROWS);
            let there = ops.greater(line, &[0.0; LANES]);
            let residual = lanes(|i| line[i] - (along[i] + across));
            let (below, above) = (
                ops.select(there, &residual, &[f32::INFINITY; LANES]),
                ops.select(there, &residual, &[f32::NEG_INFINITY; LANES]),
            );
            low = ops.min(&below, &low);
            high = ops.max(&above, &high);
            most = ops.max(line, &most);
        }
        self.center[node] = center;
        self.slope_u[node] = slope_u;
        self.slope_v[node] = slope_v;
        self.low[node] = ops.least(&low);
        self.high[node] = ops.greatest(&high);
        self.most[node] = ops.greatest(&most);
    }
}
