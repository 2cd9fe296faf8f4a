//! The kernels for batches of receivers, written once for all instruction sets that have vectors.

use core::mem::size_of;

use bytemuck::{AnyBitPattern, bytes_of, cast_slice, pod_read_unaligned};

use super::vectors::{LANE, Vectors, bits, gap, load, parts, tilt, width, word};
use crate::leaf::{Candidate, Leaf, Matter, SiftTest, Tile};
use crate::map::{COLUMNS, ROWS, Row};
use crate::receivers::{BATCH, Seekers};

/// [`super::Ops::sift`].
#[inline(always)]
pub(crate) fn sift<V: Vectors>(v: V, test: &SiftTest, rows: [&Row; ROWS]) -> [u128; 2] {
    let [mut some, mut all, mut within] = [[0; ROWS]; 3];
    for part in 0..parts::<V>() {
        let x = v.add(v.all(test.first), load::<V, _>(&LANE, part));
        let gap = gap(v, x, x, v.all(test.from), v.all(test.to));
        let gap_squared = v.mul(gap, gap);
        let dx = v.sub(x, v.all(test.u));
        let rise = v.mul(v.all(test.slope), dx);
        let margin = v.mul(v.all(test.spread), v.abs(dx));
        let (lower, upper) = (v.sub(rise, margin), v.add(rise, margin));
        for row in 0..ROWS {
            let texels = load::<V, _>(rows[row], part);
            let distance = v.add(gap_squared, v.all(test.dy_squared[row]));
            let near = v.at_most(distance, v.all(test.reach_squared));
            let over_lower = v.greater(texels, v.add(lower, v.all(test.lower[row])));
            let over_upper = v.greater(texels, v.add(upper, v.all(test.upper[row])));
            some[row] |= bits(v, v.both(near, over_lower), part);
            all[row] |= bits(v, v.both(near, over_upper), part);
            if test.lit {
                within[row] |= bits(v, near, part);
            }
        }
    }
    let (some, all) = (word(some), word(all));
    if test.lit {
        let within = word(within);
        return [within & !all, within & !some];
    }
    [some, all]
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
pub(crate) fn concerned<V: Vectors>(v: V, leaf: &Leaf, seekers: &Seekers, lit: bool) -> u64 {
    let mut lanes = 0;
    for at in (0..seekers.count).step_by(width::<V>()) {
        lanes |= u64::from(by_bounds(v, leaf, &Own::of(seekers, at), lit)) << at;
    }
    lanes
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
) -> Matter {
    if leaf.holds_unknown(lit) {
        return Matter { lanes, rows: u32::MAX };
    }
    let mut matter = Matter::default();
    let width = width::<V>();
    for at in (0..seekers.count).step_by(width) {
        let own = (lanes >> at & ((1 << width) - 1)) as u32;
        if own == 0 {
            continue;
        }
        let found = by_texels(v, leaf, rows, &Own::of(seekers, at), lit);
        for row in 0..ROWS {
            matter.lanes |= u64::from(own & found[row]) << at;
            matter.rows |= u32::from(own & found[row] != 0) << row;
        }
    }
    matter
}

/// The receivers that a leaf may matter to, by its bounds.
#[inline(always)]
fn by_bounds<V: Vectors>(v: V, leaf: &Leaf, own: &Own<V::F>, lit: bool) -> u32 {
    let ([left, right], [top, bottom]) = (leaf.u, leaf.v);
    let dx = gap(v, v.all(left), v.all(right), own.u, own.u);
    let dy = gap(v, v.all(top), v.all(bottom), own.v, own.v);
    let distance = v.add(v.mul(dx, dx), v.mul(dy, dy));
    let near = bits(v, v.at_most(distance, own.distance), 0);

    let from_u = v.sub(v.all((left + right) * 0.5), own.u);
    let from_v = v.sub(v.all((top + bottom) * 0.5), own.v);
    let rise = v.add(v.mul(own.slope[0], from_u), v.mul(own.slope[1], from_v));
    let plane = v.add(v.add(own.nearness, rise), own.offset);
    let steeper_x = v.abs(v.sub(v.all(leaf.slope[0]), own.slope[0]));
    let steeper_y = v.abs(v.sub(v.all(leaf.slope[1]), own.slope[1]));
    let half = [v.all((right - left) * 0.5), v.all((bottom - top) * 0.5)];
    let spread = tilt(v, [steeper_x, steeper_y], half);
    let none = if lit {
        v.greater(v.sub(v.all(leaf.low), spread), plane)
    } else {
        v.at_most(v.add(v.all(leaf.high), spread), plane)
    };
    near & !bits(v, none, 0)
}

/// For each row of a tile, the receivers that a texel of it may count for, however far it is.
///
/// A plane is a number for each row plus one for each column: two operations for each texel.
#[inline(always)]
fn by_texels<V: Vectors>(
    v: V,
    leaf: &Leaf,
    rows: [&Row; ROWS],
    own: &Own<V::F>,
    lit: bool,
) -> [u32; ROWS] {
    let from_u = v.sub(v.all(leaf.first[0]), own.u);
    let from_v = v.sub(v.all(leaf.first[1]), own.v);
    let rise = v.add(v.mul(own.slope[0], from_u), v.mul(own.slope[1], from_v));
    let first = v.add(v.add(own.nearness, own.offset), rise);
    let mut rises = [first; COLUMNS];
    for column in 0..COLUMNS {
        rises[column] = v.mul(own.slope[0], v.all(LANE[column]));
    }
    let mut found = [0; ROWS];
    for row in 0..ROWS {
        if leaf.rows >> row & 1 == 0 {
            continue;
        }
        // From the texels up to the plane, but for what the plane has in this row. Four at once,
        // for each minimum waits for the one before.
        let mut up = [v.all(if lit { f32::NEG_INFINITY } else { f32::INFINITY }); 4];
        for column in 0..COLUMNS {
            let own = v.sub(rises[column], v.all(rows[row][column]));
            let up = &mut up[column % 4];
            *up = if lit { v.larger(own, *up) } else { v.smaller(own, *up) };
        }
        let plane = v.add(first, v.mul(own.slope[1], v.all(LANE[row])));
        let none = if lit {
            let most = v.larger(v.larger(up[0], up[1]), v.larger(up[2], up[3]));
            v.greater(v.all(-leaf.room), v.add(most, plane))
        } else {
            let least = v.smaller(v.smaller(up[0], up[1]), v.smaller(up[2], up[3]));
            v.greater(v.add(least, plane), v.all(leaf.room))
        };
        found[row] = !bits(v, none, 0);
    }
    found
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
    let Tile { first, rows, texels } = *tile;
    let [left, top] = [first[0] as f32 + 0.5, first[1] as f32 + 0.5];
    let [mut rise_y, mut dy_squared] = [[0.0; ROWS]; 2];
    for row in 0..ROWS {
        let dy = (top + row as f32) - seekers.v[i];
        (rise_y[row], dy_squared[row]) = (seekers.slope_y[i] * dy, dy * dy);
    }
    let nothing = v.all(f32::INFINITY);
    // Of each row, as many vectors as the narrowest instruction set needs.
    let mut distances = [[nothing; COLUMNS / 4]; ROWS];
    let mut least = nothing;
    for part in 0..parts::<V>() {
        let x = v.add(v.all(left), load::<V, _>(&LANE, part));
        let dx = v.sub(x, v.all(seekers.u[i]));
        let (dx_squared, rise_x) = (v.mul(dx, dx), v.mul(v.all(seekers.slope_x[i]), dx));
        for row in 0..ROWS {
            if (texels >> (row * COLUMNS)) as u16 == 0 {
                continue;
            }
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
