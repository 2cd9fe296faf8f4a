//! The kernels that make the pyramid, written once for all instruction sets that have vectors.

use super::vectors::{LANE, Vectors, load, parts, tilt, width};
use crate::build::{Bounds, Family};
use crate::leaves::{FIRST, Ranges, SIDE_BY_SIDE, Slopes, Tiles};
use crate::map::ROWS;
use crate::pyramid::NodeGroup;

/// [`super::Ops::leaves`].
#[inline(always)]
pub(crate) fn leaves<V: Vectors>(v: V, tiles: &Tiles<'_>, slopes: &Slopes) -> Ranges {
    let [mut low, mut high] = [[v.all(0.0); SIDE_BY_SIDE]; 2];
    let mut ranges = Ranges::default();
    // First all of them, in a loop that is not unrolled: there are registers for one at a time.
    for leaf in 0..tiles.count.min(SIDE_BY_SIDE) {
        let known;
        (low[leaf], high[leaf], known) = range(v, tiles, slopes, leaf);
        ranges.unknown |= u32::from(!known) << leaf;
    }
    for first in (0..SIDE_BY_SIDE).step_by(4) {
        let [mut four_low, mut four_high] = [[v.all(0.0); 4]; 2];
        for i in 0..4 {
            (four_low[i], four_high[i]) = (low[first + i], high[first + i]);
        }
        ranges.low[first..first + 4].copy_from_slice(&v.least_of_each(four_low));
        ranges.high[first..first + 4].copy_from_slice(&v.greatest_of_each(four_high));
    }
    ranges
}

/// The range of a leaf's texels above its plane, in as many columns as a vector has lanes, and
/// whether none of them is a NaN.
#[inline(always)]
fn range<V: Vectors>(v: V, tiles: &Tiles<'_>, slopes: &Slopes, leaf: usize) -> (V::F, V::F, bool) {
    let [mut low, mut high] = [v.all(0.0); 2];
    let mut known = v.at_most(low, high);
    for part in 0..parts::<V>() {
        let [mut least, mut most] = [v.all(0.0); 2];
        for i in 0..ROWS / 2 {
            let above = load::<V, _>(&tiles.rows[ROWS / 2 - 1 - i][leaf], part);
            let below = load::<V, _>(&tiles.rows[ROWS / 2 + i][leaf], part);
            known = v.ordered(known, above, below);
            let down = v.all(slopes.down[i][leaf]);
            let [above, below] = [v.add(above, down), v.sub(below, down)];
            let [smaller, larger] = [v.smaller(above, below), v.larger(above, below)];
            least = if i == 0 { smaller } else { v.smaller(smaller, least) };
            most = if i == 0 { larger } else { v.larger(larger, most) };
        }
        // The same for all rows, and subtracted once, for rounded subtraction is monotone.
        let x = v.add(v.all(FIRST[0]), load::<V, _>(&LANE, part));
        let rise = v.mul(v.all(slopes.x[leaf]), x);
        [least, most] = [v.sub(least, rise), v.sub(most, rise)];
        low = if part == 0 { least } else { v.smaller(least, low) };
        high = if part == 0 { most } else { v.larger(most, high) };
    }
    (low, high, v.bits(known) == (1 << width::<V>()) - 1)
}

/// [`super::Ops::parent`].
#[inline(always)]
pub(crate) fn parent<V: Vectors>(v: V, children: &NodeGroup, family: &Family) -> [Bounds; 2] {
    let slopes = Family::slopes(children);
    let half = [v.all(family.half[0]), v.all(family.half[1])];
    // The lower end and the upper one, turned over so that both are the least, of both bounds.
    let mut ends = [v.all(f32::INFINITY); 4];
    for i in 0..2 {
        let slope = [v.all(slopes[i][0]), v.all(slopes[i][1])];
        for part in 0..parts::<V>() {
            let [x, y] = [load::<V, _>(&family.x, part), load::<V, _>(&family.y, part)];
            let plane = v.add(v.mul(slope[0], x), v.mul(slope[1], y));
            let steeper_x = v.abs(v.sub(load::<V, _>(&children.slope_x, part), slope[0]));
            let steeper_y = v.abs(v.sub(load::<V, _>(&children.slope_y, part), slope[1]));
            let spread = tilt(v, [steeper_x, steeper_y], half);
            let low = v.sub(v.sub(load::<V, _>(&children.low, part), spread), plane);
            let high = v.sub(plane, v.add(load::<V, _>(&children.high, part), spread));
            ends[2 * i] = v.smaller(low, ends[2 * i]);
            ends[2 * i + 1] = v.smaller(high, ends[2 * i + 1]);
        }
    }
    let [low, high, planar_low, planar_high] = v.least_of_each(ends);
    [
        Bounds { slope: slopes[0], low, high: -high },
        Bounds { slope: slopes[1], low: planar_low, high: -planar_high },
    ]
}
