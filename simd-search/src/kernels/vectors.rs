//! The kernels, written once for all instruction sets that have vectors.
//!
//! Small functions rather than closures: a closure is a function of its own, without the
//! instructions, and need not be inlined.

use core::mem::size_of;

use bytemuck::{AnyBitPattern, NoUninit, bytes_of, cast_slice, pod_read_unaligned};

use crate::map::{COLUMNS, ROWS, Row};
use crate::pyramid::{LANES, NodeGroup};
use crate::reach::{Boxes, GroupTest, Verdicts};
use crate::search::{RATIO_ROOM, TileTest};

/// The number of each lane.
pub(super) const LANE: [f32; LANES] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// What an instruction set does with a vector of single-precision numbers. A value is the proof
/// that the machine has the instructions.
pub(crate) trait Vectors: Copy {
    /// A vector, and a yes or no for each of its lanes.
    type F: AnyBitPattern + NoUninit;
    type M: Copy;

    fn all(self, a: f32) -> Self::F;
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    fn abs(self, a: Self::F) -> Self::F;
    /// `a < b ? a : b`.
    fn smaller(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a > b ? a : b`.
    fn larger(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a > b`.
    fn greater(self, a: Self::F, b: Self::F) -> Self::M;
    /// `a <= b`.
    fn at_most(self, a: Self::F, b: Self::F) -> Self::M;
    /// `m`, and neither of `a` and `b` is a NaN.
    fn ordered(self, m: Self::M, a: Self::F, b: Self::F) -> Self::M;
    /// Whether the bits are those of an integer.
    fn same_bits(self, a: Self::F, b: u32) -> Self::M;
    fn both(self, a: Self::M, b: Self::M) -> Self::M;
    fn either(self, a: Self::M, b: Self::M) -> Self::M;
    /// `a` and not `b`.
    fn without(self, a: Self::M, b: Self::M) -> Self::M;
    /// `m ? a : b`.
    fn choose(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// Bit `i` is lane `i`.
    fn bits(self, m: Self::M) -> u32;

    /// The least lane of each of four vectors without NaN.
    #[inline(always)]
    fn least_of_each(self, a: [Self::F; 4]) -> [f32; 4] {
        across::<Self>(a, |a, b| if a < b { a } else { b })
    }
    /// The greatest lane of each of four vectors without NaN.
    #[inline(always)]
    fn greatest_of_each(self, a: [Self::F; 4]) -> [f32; 4] {
        across::<Self>(a, |a, b| if a > b { a } else { b })
    }
}

/// All lanes of each vector combined by a commutative and associative operation.
#[inline(always)]
fn across<V: Vectors>(vectors: [V::F; 4], combine: impl Fn(f32, f32) -> f32) -> [f32; 4] {
    let mut all = [0.0; 4];
    for i in 0..4 {
        let lanes: &[f32] = cast_slice(bytes_of(&vectors[i]));
        all[i] = lanes[0];
        for &lane in &lanes[1..] {
            all[i] = combine(all[i], lane);
        }
    }
    all
}

/// Writes the operations of an instruction set down as a table.
///
/// Each becomes an `#[inline(always)]` method: the intrinsics get inlined where the kernel is,
/// inside a function with their instructions enabled.
macro_rules! operations {
    (unsafe: $($name:ident($($argument:ident: $type:ty),*) -> $result:ty = $body:expr;)*) => {
        $(
            #[inline(always)]
            #[allow(unsafe_code)]
            fn $name(self, $($argument: $type),*) -> $result {
                // SAFETY: a value of Self is the proof that the machine has the instructions.
                unsafe { $body }
            }
        )*
    };
    (safe: $($name:ident($($argument:ident: $type:ty),*) -> $result:ty = $body:expr;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($argument: $type),*) -> $result {
                $body
            }
        )*
    };
}
pub(crate) use operations;

/// The kernels made of a table of operations.
///
/// A macro, so that the closures are made in the function that it stands in, whose target features
/// they then have.
macro_rules! kernels {
    ($v:ident) => {{
        use crate::build::Family;
        use crate::kernels::{bounds, receivers, vectors};
        use crate::leaf::{Candidate, Leaf, Node, SiftTest, Tile};
        use crate::leaves::{Slopes, Tiles};
        use crate::map::{ROWS, Row};
        use crate::pyramid::{LANES, NodeGroup};
        use crate::reach::{Boxes, GroupTest};
        use crate::receivers::Seekers;
        use crate::search::TileTest;

        crate::kernels::Kernels {
            tile: |test: &TileTest, rows: [&Row; ROWS]| vectors::tile($v, test, rows),
            sift: |test: &SiftTest, rows: [&Row; ROWS]| receivers::sift($v, test, rows),
            equal: |numbers: &[u32; LANES], number: u32| vectors::equal($v, numbers, number),
            group: |test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup| {
                vectors::group($v, test, boxes, nodes)
            },
            leaves: |tiles: &Tiles<'_>, slopes: &Slopes| bounds::leaves($v, tiles, slopes),
            parent: |children: &NodeGroup, family: &Family| bounds::parent($v, children, family),
            concerned: |node: &Node, seekers: &Seekers, among: u64, lit: bool| {
                receivers::concerned($v, node, seekers, among, lit)
            },
            matters: |leaf: &Leaf, rows: [&Row; ROWS], seekers: &Seekers, lanes: u64, lit: bool| {
                receivers::matters($v, leaf, rows, seekers, lanes, lit)
            },
            ask_tile: |tile: &Tile<'_>, seekers: &mut Seekers, lanes: u64, lit: bool| {
                receivers::ask_tile($v, tile, seekers, lanes, lit)
            },
            ask: |texels: &[Candidate], seekers: &mut Seekers, lanes: u64, lit: bool| {
                receivers::ask($v, texels, seekers, lanes, lit)
            },
        }
    }};
}
pub(crate) use kernels;

/// Lanes in a vector.
#[inline(always)]
pub(super) const fn width<V: Vectors>() -> usize {
    size_of::<V::F>() / size_of::<f32>()
}

/// Vectors in a tile's row or a group of nodes.
#[inline(always)]
pub(super) const fn parts<V: Vectors>() -> usize {
    LANES / width::<V>()
}

/// One of the vectors in a row.
#[inline(always)]
pub(super) fn load<V: Vectors, T: NoUninit>(row: &[T; LANES], part: usize) -> V::F {
    vector::<V, T>(&row[part * width::<V>()..])
}

/// The first of the numbers, as many as a vector has lanes.
#[inline(always)]
fn vector<V: Vectors, T: NoUninit>(numbers: &[T]) -> V::F {
    pod_read_unaligned(cast_slice(&numbers[..width::<V>()]))
}

/// The bits of a mask, those of vector `part` in their place.
#[inline(always)]
pub(super) fn bits<V: Vectors>(v: V, mask: V::M, part: usize) -> u32 {
    v.bits(mask) << (width::<V>() * part)
}

/// The bits of all rows, the first in the lowest.
#[inline(always)]
pub(super) fn word(rows: [u32; ROWS]) -> u128 {
    let half = |i: usize| {
        let low = u64::from(rows[i]) | u64::from(rows[i + 1]) << COLUMNS;
        let high = u64::from(rows[i + 2]) | u64::from(rows[i + 3]) << COLUMNS;
        low | high << (2 * COLUMNS)
    };
    u128::from(half(0)) | u128::from(half(4)) << 64
}

/// The columns of a tile as seen from the receiver.
#[inline(always)]
fn columns<V: Vectors>(v: V, test: &TileTest, part: usize) -> V::F {
    v.sub(v.add(v.all(test.first), load::<V, _>(&LANE, part)), v.all(test.u))
}

/// [`super::Ops::tile`].
#[inline(always)]
pub(crate) fn tile<V: Vectors>(v: V, test: &TileTest, rows: [&Row; ROWS]) -> u128 {
    let mut blocks = [0; ROWS];
    for part in 0..parts::<V>() {
        let rise_x = v.mul(v.all(test.slope[0]), columns(v, test, part));
        for row in 0..ROWS {
            let rise = v.add(rise_x, v.all(test.rise[row]));
            let plane = v.add(v.add(v.all(test.nearness), rise), v.all(test.offset));
            blocks[row] |= bits(v, v.greater(load::<V, _>(rows[row], part), plane), part);
        }
    }
    let found = if test.lit { !word(blocks) } else { word(blocks) };
    // Of most tiles that is all there is to know.
    if found == 0 {
        return 0;
    }
    let mut within = [0; ROWS];
    for part in 0..parts::<V>() {
        let dx = columns(v, test, part);
        let dx_squared = v.mul(dx, dx);
        for row in 0..ROWS {
            let distance = v.add(dx_squared, v.all(test.dy_squared[row]));
            let mut near = v.bits(v.at_most(distance, v.all(test.reach_squared)));
            if let Some(key) = test.ratio {
                let nearer = v.sub(load::<V, _>(rows[row], part), v.all(test.nearness));
                let most = v.mul(v.all(key * RATIO_ROOM), v.mul(nearer, nearer));
                near &= v.bits(v.greater(nearer, v.all(0.0))) & !v.bits(v.greater(distance, most));
            }
            within[row] |= near << (width::<V>() * part);
        }
    }
    found & word(within)
}

/// [`super::Ops::equal`].
#[inline(always)]
pub(crate) fn equal<V: Vectors>(v: V, numbers: &[u32; LANES], number: u32) -> u32 {
    let mut found = 0;
    for part in 0..parts::<V>() {
        found |= bits(v, v.same_bits(load::<V, _>(numbers, part), number), part);
    }
    found
}

/// How far boxes are from receivers between `from` and `to` along an axis.
#[inline(always)]
pub(super) fn gap<V: Vectors>(v: V, low: V::F, high: V::F, from: V::F, to: V::F) -> V::F {
    let before = v.sub(low, to);
    let after = v.sub(from, high);
    v.larger(v.larger(before, after), v.all(0.0))
}

/// How far a plane rises from the centre of a box to its highest corner, its slopes without their
/// signs.
#[inline(always)]
pub(super) fn tilt<V: Vectors>(v: V, slope: [V::F; 2], half: [V::F; 2]) -> V::F {
    v.add(v.mul(slope[0], half[0]), v.mul(slope[1], half[1]))
}

/// [`super::Ops::group`].
#[inline(always)]
pub(crate) fn group<V: Vectors>(
    v: V,
    test: &GroupTest,
    boxes: &Boxes,
    nodes: &NodeGroup,
) -> Verdicts {
    let plane = test.plane;
    let mut verdicts = Verdicts { may_block: 0, may_be_lit: 0, keys: [0.0; LANES] };
    for part in 0..parts::<V>() {
        let (left, right) = (load::<V, _>(&boxes.left, part), load::<V, _>(&boxes.right, part));
        let (top, bottom) = (load::<V, _>(&boxes.top, part), load::<V, _>(&boxes.bottom, part));
        let dx = gap(v, left, right, v.all(test.from[0]), v.all(test.to[0]));
        let dy = gap(v, top, bottom, v.all(test.from[1]), v.all(test.to[1]));
        let distance = v.add(v.mul(dx, dx), v.mul(dy, dy));
        let near = bits(v, v.at_most(distance, v.all(test.reach_squared)), part);

        let x = v.sub(v.mul(v.add(left, right), v.all(0.5)), v.all(plane.u));
        let y = v.sub(v.mul(v.add(top, bottom), v.all(0.5)), v.all(plane.v));
        let rise = v.add(v.mul(v.all(plane.slope.x), x), v.mul(v.all(plane.slope.y), y));
        let at_center = v.add(v.all(plane.nearness), rise);
        let [spread_x, spread_y] = [v.all(test.spread.x), v.all(test.spread.y)];
        let away = tilt(v, [spread_x, spread_y], [v.abs(x), v.abs(y)]);

        let half_x = v.mul(v.sub(right, left), v.all(0.5));
        let half_y = v.mul(v.sub(bottom, top), v.all(0.5));
        let half = [half_x, half_y];
        let (x, y) = (load::<V, _>(&nodes.slope_x, part), load::<V, _>(&nodes.slope_y, part));
        let steeper_x = v.add(v.abs(v.sub(x, v.all(plane.slope.x))), spread_x);
        let steeper_y = v.add(v.abs(v.sub(y, v.all(plane.slope.y))), spread_y);
        let spread = v.add(tilt(v, [steeper_x, steeper_y], half), away);
        let (low, high) = (load::<V, _>(&nodes.low, part), load::<V, _>(&nodes.high, part));
        let highest = v.sub(v.add(high, spread), at_center);
        let lowest = v.sub(v.sub(low, spread), at_center);
        // Written so that NaN may block and may be lit.
        let mut out = bits(v, v.at_most(highest, v.all(test.least)), part);
        let above = bits(v, v.greater(lowest, v.all(test.most)), part);
        let mut keys = distance;
        if let Some(cone) = test.cone {
            let nearer =
                v.sub(v.add(high, tilt(v, [v.abs(x), v.abs(y)], half)), v.all(cone.nearness));
            keys = v.div(distance, v.mul(nearer, nearer));
            out |= bits(v, v.at_most(nearer, v.all(0.0)), part);
            out |= bits(v, v.greater(keys, v.all(cone.at_most)), part);
        }
        let width = width::<V>();
        verdicts.keys[part * width..][..width].copy_from_slice(cast_slice(bytes_of(&keys)));
        verdicts.may_block |= near & !out;
        verdicts.may_be_lit |= near & !above;
    }
    verdicts
}
