//! Which samples of a light are blocked: a tree of sixteen-wide rows of samples.

use wide::f32x16;

const LANES: usize = 16;
/// Slack of a decision for a whole box, relative to a half-plane's coefficients: more than single
/// precision loses, so that a box never claims what its samples would not.
const SLACK: f32 = 4e-6;

/// The half-plane `c + x * gx + y * gy >= 0` of the light's coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfPlane {
    pub c: f64,
    pub gx: f64,
    pub gy: f64,
}

impl HalfPlane {
    /// The least and the greatest value over a box, with slack.
    fn range(&self, of: &Bounds) -> [f64; 2] {
        let [x, y] = of.center.map(f64::from);
        let [half_x, half_y] = of.half.map(f64::from);
        let (gx, gy) = (self.gx.abs(), self.gy.abs());
        let value = (self.c + self.gx * x) + self.gy * y;
        let reach = (gx * half_x + gy * half_y) + f64::from(SLACK) * (self.c.abs() + gx + gy);
        [value - reach, value + reach]
    }
}

/// A half-plane in single precision, its largest coefficient 1 so that no scene is too large or too
/// small.
#[derive(Clone, Copy, Debug, Default)]
struct Scaled {
    c: f32,
    gx: f32,
    gy: f32,
}

/// An intersection of at most four half-planes: what one triangle covers of the light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Region {
    planes: [Scaled; 4],
    count: usize,
}

impl Region {
    /// The region within the bounds of a light; `None` if that is surely empty, or not finite.
    pub fn new(planes: &[HalfPlane], bounds: &Bounds) -> Option<Region> {
        let mut region = Region { planes: [Scaled::default(); 4], count: 0 };
        for plane in planes {
            let [low, high] = plane.range(bounds);
            // A half-plane that holds everywhere decides nothing.
            if low >= 0.0 {
                continue;
            }
            let largest = plane.c.abs().max(plane.gx.abs()).max(plane.gy.abs());
            if high < 0.0 || !high.is_finite() || largest == 0.0 {
                return None;
            }
            let scaled = |k: f64| (k / largest) as f32;
            region.planes[region.count] =
                Scaled { c: scaled(plane.c), gx: scaled(plane.gx), gy: scaled(plane.gy) };
            region.count += 1;
        }
        Some(region)
    }

    /// Bit masks of the lanes that may meet the region, and of those that surely lie inside.
    fn cover(&self, row: &Row, boxes: bool) -> [u16; 2] {
        let (mut least, mut most) = (f32x16::splat(0.0), f32x16::splat(0.0));
        let (x, y) = (f32x16::new(row.x), f32x16::new(row.y));
        if !boxes {
            for plane in &self.planes[..self.count] {
                let value = (x * plane.gx + plane.c) + y * plane.gy;
                least = least.fast_min(value);
            }
            let inside = least.simd_ge(f32x16::splat(0.0)).to_bitmask() as u16;
            return [inside, inside];
        }
        let (half_x, half_y) = (f32x16::new(row.half_x), f32x16::new(row.half_y));
        for plane in &self.planes[..self.count] {
            let value = (x * plane.gx + plane.c) + y * plane.gy;
            let reach = half_x * plane.gx.abs() + half_y * plane.gy.abs() + SLACK;
            least = least.fast_min(value - reach);
            most = most.fast_min(value + reach);
        }
        let zero = f32x16::splat(0.0);
        [most, least].map(|v| v.simd_ge(zero).to_bitmask() as u16)
    }
}

/// A box in the light's coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bounds {
    pub center: [f32; 2],
    pub half: [f32; 2],
}

impl Bounds {
    fn around(points: impl Iterator<Item = [f32; 2]>) -> Bounds {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for point in points {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let center = [0, 1].map(|i| (low[i] + high[i]) * 0.5);
        let half = [0, 1].map(|i| (high[i] - center[i]).max(center[i] - low[i]));
        Bounds { center, half }
    }

    /// The four corners, in order around the middle.
    pub fn corners(&self) -> [[f32; 2]; 4] {
        let Bounds { center: [x, y], half: [dx, dy] } = *self;
        [[x - dx, y - dy], [x + dx, y - dy], [x + dx, y + dy], [x - dx, y + dy]]
    }
}

/// Sixteen samples, or sixteen boxes around the rows of the level below.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    x: [f32; LANES],
    y: [f32; LANES],
    half_x: [f32; LANES],
    half_y: [f32; LANES],
}

/// The samples of a light, in rows of sixteen, with boxes around rows, and around rows of boxes,
/// up to a single row.
#[derive(Clone, Debug, Default)]
pub(crate) struct SampleTree {
    points: Vec<[f32; 2]>,
    levels: Vec<Vec<Row>>,
}

impl SampleTree {
    /// A tree over `points`, of which neighbours in the list should be neighbours in the plane.
    pub fn rebuild(&mut self, points: &[[f32; 2]]) {
        self.points.clear();
        self.points.extend_from_slice(points);
        let mut level = 0;
        let mut reach = 1;
        while level == 0 || self.levels[level - 1].len() > 1 {
            if level == self.levels.len() {
                self.levels.push(Vec::new());
            }
            self.levels[level].clear();
            for chunk in points.chunks(reach * LANES) {
                let mut row = Row::default();
                for (lane, below) in chunk.chunks(reach).enumerate() {
                    let Bounds { center, half } = Bounds::around(below.iter().copied());
                    (row.x[lane], row.y[lane]) = (center[0], center[1]);
                    (row.half_x[lane], row.half_y[lane]) = (half[0], half[1]);
                }
                self.levels[level].push(row);
            }
            reach *= LANES;
            level += 1;
        }
        self.levels.truncate(level);
    }

    /// Sorts `points` along a Z-order curve, which makes good trees.
    pub fn sort(points: &mut [[f32; 2]]) {
        let spread = |mut x: u64| {
            for (shift, keep) in
                [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)]
            {
                x = (x | (x << shift)) & keep;
            }
            x
        };
        let quantized = |c: f32| spread(((c + 1.0) * 32767.0) as u64 & 0xffff);
        points.sort_by_key(|&[x, y]| quantized(x) | (quantized(y) << 1));
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.points.len()
    }
}

/// Which samples of a [`SampleTree`] are blocked.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mask {
    /// One bit per lane of the tree's rows. A bit above the samples means "all below blocked".
    blocked: Vec<Vec<u16>>,
}

impl Mask {
    /// All samples of `tree` open; lanes without a sample count as blocked.
    pub fn reset(&mut self, tree: &SampleTree) {
        self.blocked.resize_with(tree.levels.len(), Vec::new);
        let mut used = tree.len();
        for (level, rows) in self.blocked.iter_mut().zip(&tree.levels) {
            level.clear();
            level.resize(rows.len(), 0);
            let in_last = used - (rows.len() - 1) * LANES;
            if let Some(last) = level.last_mut() {
                *last = if in_last == LANES { 0 } else { u16::MAX << in_last };
            }
            used = rows.len();
        }
    }

    /// Whether no sample is open.
    pub fn is_full(&self) -> bool {
        self.blocked.last().is_none_or(|top| top[0] == u16::MAX)
    }

    /// Whether sample number `index` is open.
    pub fn is_open(&self, index: usize) -> bool {
        self.blocked[0][index / LANES] & (1 << (index % LANES)) == 0
    }

    /// How many samples are open.
    pub fn open(&self) -> u32 {
        self.blocked.first().map_or(0, |rows| rows.iter().map(|row| row.count_zeros()).sum())
    }

    /// Blocks the samples inside `region`. If `blocks` is given it is asked for each of them.
    pub fn cover(
        &mut self,
        tree: &SampleTree,
        region: &Region,
        blocks: Option<&dyn Fn([f32; 2]) -> bool>,
    ) {
        self.cover_row(tree, region, blocks, tree.levels.len() - 1, 0);
    }

    fn cover_row(
        &mut self,
        tree: &SampleTree,
        region: &Region,
        blocks: Option<&dyn Fn([f32; 2]) -> bool>,
        level: usize,
        row: usize,
    ) {
        let open = !self.blocked[level][row];
        if open == 0 {
            return;
        }
        let [may, surely] = region.cover(&tree.levels[level][row], level > 0).map(|m| m & open);
        if level == 0 {
            let asked =
                |lane: usize| blocks.is_none_or(|blocks| blocks(tree.points[row * LANES + lane]));
            let hit = lanes(may).filter(|&lane| asked(lane)).fold(0, |hit, lane| hit | 1 << lane);
            self.blocked[0][row] |= if blocks.is_none() { may } else { hit };
            return;
        }
        for lane in lanes(may) {
            let child = row * LANES + lane;
            if surely & (1 << lane) != 0 && blocks.is_none() {
                self.fill(level - 1, child);
            } else {
                self.cover_row(tree, region, blocks, level - 1, child);
            }
            if self.blocked[level - 1][child] == u16::MAX {
                self.blocked[level][row] |= 1 << lane;
            }
        }
    }

    fn fill(&mut self, level: usize, row: usize) {
        if level > 0 {
            for lane in lanes(!self.blocked[level][row]) {
                self.fill(level - 1, row * LANES + lane);
            }
        }
        self.blocked[level][row] = u16::MAX;
    }
}

/// The positions of the set bits.
fn lanes(mut bits: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        (bits != 0).then(|| {
            bits &= bits - 1;
            lane
        })
    })
}
