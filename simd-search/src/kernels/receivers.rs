//! The kernels for batches of receivers, written once for all instruction sets that have vectors.

use core::hint::black_box;
use core::mem::size_of;

use bytemuck::{AnyBitPattern, bytes_of, cast_slice, pod_read_unaligned};

use super::vectors::{LANE, Vectors, bits, gap, load, parts, tilt, width, word};
use crate::leaf::{Candidate, Leaf, Node, SiftTest, Tile};
use crate::map::{COLUMNS, ROWS, Row};
use crate::receivers::{BATCH, Seekers};

/// [`super::Ops::sift`].
#[inline(always)]
pub(crate) fn sift<V: Vectors>(v: V, test: &SiftTest, rows: [&Row; ROWS]) -> [u128; 2] {
    let [mut some, mut within] = [[0; ROWS]; 2];
    for part in 0..parts::<V>() {
        let (x, [lower, _]) = planes(v, test, part);
        let gap = gap(v, x, x, v.all(test.from), v.all(test.to));
        let gap_squared = v.mul(gap, gap);
        for row in 0..ROWS {
            let distance = v.add(gap_squared, v.all(test.dy_squared[row]));
            let near = v.at_most(distance, v.all(test.reach_squared));
            let plane = v.add(lower, v.all(test.lower[row]));
            let blocks = v.greater(load::<V, _>(rows[row], part), plane);
            some[row] |= bits(v, v.both(near, blocks), part);
            if test.lit {
                within[row] |= bits(v, near, part);
            }
        }
    }
    let some = word(some);
    // Many tiles hold nothing that blocks anyone.
    if !test.lit && some == 0 {
        return [0; 2];
    }
    let mut all = [0; ROWS];
    for part in 0..parts::<V>() {
        let (_, [_, upper]) = planes(v, test, part);
        for row in 0..ROWS {
            let plane = v.add(upper, v.all(test.upper[row]));
            all[row] |= bits(v, v.greater(load::<V, _>(rows[row], part), plane), part);
        }
    }
    // The upper plane is nowhere below the lower one.
    let all = some & word(all);
    if test.lit {
        let within = word(within);
        return [within & !all, within & !some];
    }
    [some, all]
}

/// The columns of a tile, and what they add to the bounds of the receivers' planes.
#[inline(always)]
fn planes<V: Vectors>(v: V, test: &SiftTest, part: usize) -> (V::F, [V::F; 2]) {
    let x = v.add(v.all(test.first), load::<V, _>(&LANE, part));
    let dx = v.sub(x, v.all(test.u));
    let rise = v.mul(v.all(test.slope), dx);
    let margin = v.mul(v.all(test.spread), v.abs(dx));
    (x, [v.sub(rise, margin), v.add(rise, margin)])
}

/// As many receivers as a vector has lanes.
struct Own<F> {
    u: F,
    v: F,
    nearness: F,
    slope: [F; 2],
    offset: F,
    distance: F,
    order: F,
}

impl<F: AnyBitPattern> Own<F> {
    /// The receivers from number `at` on.
    #[inline(always)]
    fn of(seekers: &Seekers, at: usize) -> Own<F> {
        Own {
            u: some(&seekers.u, at),
            v: some(&seekers.v, at),
            nearness: some(&seekers.nearness, at),
            slope: [some(&seekers.slope_x, at), some(&seekers.slope_y, at)],
            offset: some(&seekers.offset, at),
            distance: some(&seekers.distance, at),
            order: some(&seekers.order, at),
        }
    }
}

/// Numbers of a column from number `at` on.
#[inline(always)]
fn some<F: AnyBitPattern>(column: &[f32; BATCH], at: usize) -> F {
    pod_read_unaligned(cast_slice(&column[at..][..size_of::<F>() / size_of::<f32>()]))
}

/// [`super::Ops::concerned`].
#[inline(always)]
pub(crate) fn concerned<V: Vectors>(
    v: V,
    node: &Node,
    seekers: &Seekers,
    among: u64,
    lit: bool,
) -> u64 {
    let (mut lanes, width) = (0, width::<V>());
    for at in (0..seekers.count).step_by(width) {
        if among >> at & ((1 << width) - 1) != 0 {
            lanes |= u64::from(by_bounds(v, node, &Own::of(seekers, at), lit)) << at;
        }
    }
    lanes & among
}

/// [`super::Ops::matters`].
#[inline(always)]
pub(crate) fn matters<V: Vectors>(
    v: V,
    leaf: &Leaf,
    rows: [&Row; ROWS],
    seekers: &Seekers,
    lanes: u64,
    lit: bool,
) -> u64 {
    if leaf.holds_unknown(lit) {
        return lanes;
    }
    let (mut matters, width) = (0, width::<V>());
    for at in (0..seekers.count).step_by(width) {
        let some = (lanes >> at & ((1 << width) - 1)) as u32;
        if some == 0 {
            continue;
        }
        let own = Own::of(seekers, at);
        let none = if lit {
            by_texels::<V, true>(v, leaf, rows, &own)
        } else {
            by_texels::<V, false>(v, leaf, rows, &own)
        };
        matters |= u64::from(some & !none) << at;
    }
    matters
}

/// The receivers that a node may matter to, by its bounds.
#[inline(always)]
fn by_bounds<V: Vectors>(v: V, node: &Node, own: &Own<V::F>, lit: bool) -> u32 {
    let ([left, right], [top, bottom]) = (node.u, node.v);
    let dx = gap(v, v.all(left), v.all(right), own.u, own.u);
    let dy = gap(v, v.all(top), v.all(bottom), own.v, own.v);
    let distance = v.add(v.mul(dx, dx), v.mul(dy, dy));
    let near = bits(v, v.at_most(distance, own.distance), 0);
    if near == 0 {
        return 0;
    }
    let from_u = v.sub(v.all((left + right) * 0.5), own.u);
    let from_v = v.sub(v.all((top + bottom) * 0.5), own.v);
    let rise = v.add(v.mul(own.slope[0], from_u), v.mul(own.slope[1], from_v));
    let plane = v.add(v.add(own.nearness, rise), own.offset);
    let steeper_x = v.abs(v.sub(v.all(node.slope[0]), own.slope[0]));
    let steeper_y = v.abs(v.sub(v.all(node.slope[1]), own.slope[1]));
    let half = [v.all((right - left) * 0.5), v.all((bottom - top) * 0.5)];
    let spread = tilt(v, [steeper_x, steeper_y], half);
    let none = if lit {
        v.greater(v.sub(v.all(node.low), spread), plane)
    } else {
        v.at_most(v.add(v.all(node.high), spread), plane)
    };
    near & !bits(v, none, 0)
}

/// The receivers that no texel of a tile counts for, however far it is.
///
/// A plane is a number for each row plus one for each column: two operations for each texel.
#[inline(always)]
fn by_texels<V: Vectors, const LIT: bool>(
    v: V,
    leaf: &Leaf,
    rows: [&Row; ROWS],
    own: &Own<V::F>,
) -> u32 {
    let from_u = v.sub(v.all(leaf.first[0]), own.u);
    let from_v = v.sub(v.all(leaf.first[1]), own.v);
    let rise = v.add(v.mul(own.slope[0], from_u), v.mul(own.slope[1], from_v));
    let first = v.add(v.add(own.nearness, own.offset), rise);
    let mut rises = [first; COLUMNS];
    for column in 0..COLUMNS {
        rises[column] = v.mul(own.slope[0], v.all(LANE[column]));
    }
    // From the texels up to the plane: the least where they may block, the most where they may not.
    let farthest = v.all(if LIT { f32::NEG_INFINITY } else { f32::INFINITY });
    let mut nearest = farthest;
    let mut rest = leaf.rows;
    while rest != 0 {
        let row = rest.trailing_zeros() as usize % ROWS;
        rest &= rest - 1;
        // But for what the plane has in this row. Four at once, for each waits for the one before.
        let mut up = [farthest; 4];
        for column in 0..COLUMNS {
            let own = v.sub(rises[column], v.all(rows[row][column]));
            up[column % 4] = closer::<V, LIT>(v, own, up[column % 4]);
        }
        let up = [closer::<V, LIT>(v, up[0], up[1]), closer::<V, LIT>(v, up[2], up[3])];
        let up = closer::<V, LIT>(v, up[0], up[1]);
        let plane = v.add(first, v.mul(own.slope[1], v.all(LANE[row])));
        nearest = closer::<V, LIT>(v, v.add(up, plane), nearest);
    }
    let none = if LIT {
        v.greater(v.all(-leaf.room), nearest)
    } else {
        v.greater(nearest, v.all(leaf.room))
    };
    bits(v, none, 0)
}

/// Of two distances from a texel up to a plane, the one with which it is more likely to count.
#[inline(always)]
fn closer<V: Vectors, const LIT: bool>(v: V, a: V::F, b: V::F) -> V::F {
    if LIT { v.larger(a, b) } else { v.smaller(a, b) }
}

/// [`super::Ops::ask_tile`].
#[inline(always)]
pub(crate) fn ask_tile<V: Vectors>(
    v: V,
    tile: &Tile<'_>,
    seekers: &mut Seekers,
    lanes: u64,
    lit: bool,
) {
    let mut lanes = lanes;
    while lanes != 0 {
        let i = lanes.trailing_zeros() as usize % BATCH;
        lanes &= lanes - 1;
        let Some((distance, place)) = nearest_in_tile(v, tile, seekers, i, lit) else {
            continue;
        };
        let (column, row) = (place % COLUMNS as u32, place / COLUMNS as u32);
        let order = seekers.order(tile.first[0] + column, tile.first[1] + row);
        if distance < seekers.distance[i] || order < seekers.order[i] {
            (seekers.distance[i], seekers.order[i]) = (distance, order);
        }
    }
}

/// The squared distance of the texel of a tile that counts for receiver `i` and is the nearest, no
/// farther than the best so far, and its place in the tile.
#[inline(always)]
fn nearest_in_tile<V: Vectors>(
    v: V,
    tile: &Tile<'_>,
    seekers: &Seekers,
    i: usize,
    lit: bool,
) -> Option<(f32, u32)> {
    let Tile { first, rows } = *tile;
    let [left, top] = [first[0] as f32 + 0.5, first[1] as f32 + 0.5];
    let mut by_row = [[0.0; ROWS]; 2];
    for row in 0..ROWS {
        let dy = (top + row as f32) - seekers.v[i];
        (by_row[0][row], by_row[1][row]) = (seekers.slope_y[i] * dy, dy * dy);
    }
    // Kept in memory, for to spread a number from there over a vector takes no operation.
    let [rise_y, dy_squared] = black_box(&by_row);
    let nothing = v.all(f32::INFINITY);
    // Of each row, as many vectors as the narrowest instruction set needs.
    let mut distances = [[nothing; COLUMNS / 4]; ROWS];
    let mut least = nothing;
    for part in 0..parts::<V>() {
        let x = v.add(v.all(left), load::<V, _>(&LANE, part));
        let dx = v.sub(x, v.all(seekers.u[i]));
        let (dx_squared, rise_x) = (v.mul(dx, dx), v.mul(v.all(seekers.slope_x[i]), dx));
        for row in 0..ROWS {
            let distance = v.add(dx_squared, v.all(dy_squared[row]));
            let rise = v.add(rise_x, v.all(rise_y[row]));
            let plane = v.add(v.add(v.all(seekers.nearness[i]), rise), v.all(seekers.offset[i]));
            let blocks = v.greater(load::<V, _>(rows[row], part), plane);
            let [if_blocks, if_not] = if lit { [nothing, distance] } else { [distance, nothing] };
            let distance = v.choose(blocks, if_blocks, if_not);
            distances[row][part] = distance;
            least = v.smaller(distance, least);
        }
    }
    if v.bits(v.at_most(least, v.all(seekers.distance[i]))) == 0 {
        return None;
    }
    let [least, ..] = v.least_of_each([least; 4]);
    let mut found = [0; ROWS];
    for part in 0..parts::<V>() {
        for row in 0..ROWS {
            found[row] |= bits(v, v.at_most(distances[row][part], v.all(least)), part);
        }
    }
    Some((least, word(found).trailing_zeros()))
}

/// [`super::Ops::ask`].
#[inline(always)]
pub(crate) fn ask<V: Vectors>(
    v: V,
    texels: &[Candidate],
    seekers: &mut Seekers,
    lanes: u64,
    lit: bool,
) {
    let width = width::<V>();
    for at in (0..seekers.count).step_by(width) {
        if lanes >> at & ((1 << width) - 1) == 0 {
            continue;
        }
        let some = Own::of(seekers, at);
        let [distance, order] = if lit {
            ask_some::<V, true>(v, texels, some)
        } else {
            ask_some::<V, false>(v, texels, some)
        };
        seekers.distance[at..][..width].copy_from_slice(cast_slice(bytes_of(&distance)));
        seekers.order[at..][..width].copy_from_slice(cast_slice(bytes_of(&order)));
    }
}

/// The distance and the order of the best texels.
#[inline(always)]
fn ask_some<V: Vectors, const LIT: bool>(v: V, texels: &[Candidate], some: Own<V::F>) -> [V::F; 2] {
    let Own { u, v: w, nearness, slope, offset, distance: mut best, order: mut best_order } = some;
    for texel in texels {
        let (dx, dy) = (v.sub(v.all(texel.x), u), v.sub(v.all(texel.y), w));
        let distance = v.add(v.mul(dx, dx), v.mul(dy, dy));
        let near = v.at_most(distance, best);
        if v.bits(near) == 0 {
            continue;
        }
        let rise = v.add(v.mul(slope[0], dx), v.mul(slope[1], dy));
        let plane = v.add(v.add(nearness, rise), offset);
        let blocks = v.greater(v.all(texel.nearness), plane);
        let counts = if LIT { v.without(near, blocks) } else { v.both(near, blocks) };
        // Of those at the same distance the first in row-major order is the answer.
        let order = v.all(texel.order);
        let precedes = v.either(v.greater(best, distance), v.greater(best_order, order));
        let precedes = v.both(counts, precedes);
        best = v.choose(precedes, distance, best);
        best_order = v.choose(precedes, order, best_order);
    }
    [best, best_order]
}
