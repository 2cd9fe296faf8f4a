//! How much of the light a few intervals hide, for sixteen receivers at a time.

use crate::lanes::{LANES, Lanes, Ops, max};

/// A blocked interval of the light per receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub from: Lanes,
    pub to: Lanes,
}

/// Beyond this many intervals each receiver's are sorted on their own.
const FEW: usize = 24;

/// The length of the union of `intervals`, none of which begins before `begin`, per receiver.
#[inline(always)]
pub(super) fn union_length(ops: impl Ops, intervals: &mut [Interval], begin: f32) -> Lanes {
    if intervals.len() <= FEW {
        sort_few(ops, intervals);
    } else {
        sort_many(intervals);
    }
    let mut reached = [begin; LANES];
    let mut length = [0.0; LANES];
    for interval in intervals {
        for i in 0..LANES {
            let from = max(interval.from[i], reached[i]);
            length[i] += max(interval.to[i] - from, 0.0);
            reached[i] = max(interval.to[i], reached[i]);
        }
    }
    length
}

/// Insertion sort by `from`, in all lanes at once. Runs come from left to right, so that little is
/// out of order.
#[inline(always)]
fn sort_few(ops: impl Ops, intervals: &mut [Interval]) {
    for sorted in 1..intervals.len() {
        for at in (1..=sorted).rev() {
            let (a, b) = (intervals[at - 1], intervals[at]);
            let later = ops.greater(&a.from, &b.from);
            if later == 0 {
                break;
            }
            let choose = |a: &Lanes, b: &Lanes| ops.select(later, a, b);
            intervals[at - 1] =
                Interval { from: choose(&b.from, &a.from), to: choose(&b.to, &a.to) };
            intervals[at] = Interval { from: choose(&a.from, &b.from), to: choose(&a.to, &b.to) };
        }
    }
}

/// The same one lane after the other: heap sort, which needs no memory and is never slow.
fn sort_many(intervals: &mut [Interval]) {
    for lane in 0..LANES {
        let sift = |intervals: &mut [Interval], mut parent: usize, end: usize| {
            loop {
                let mut child = 2 * parent + 1;
                if child >= end {
                    break;
                }
                if child + 1 < end && intervals[child].from[lane] < intervals[child + 1].from[lane]
                {
                    child += 1;
                }
                if intervals[parent].from[lane] >= intervals[child].from[lane] {
                    break;
                }
                swap(intervals, parent, child, lane);
                parent = child;
            }
        };
        for parent in (0..intervals.len() / 2).rev() {
            sift(intervals, parent, intervals.len());
        }
        for end in (1..intervals.len()).rev() {
            swap(intervals, 0, end, lane);
            sift(intervals, 0, end);
        }
    }
}

fn swap(intervals: &mut [Interval], a: usize, b: usize, lane: usize) {
    let (x, y) = (intervals[a], intervals[b]);
    (intervals[a].from[lane], intervals[a].to[lane]) = (y.from[lane], y.to[lane]);
    (intervals[b].from[lane], intervals[b].to[lane]) = (x.from[lane], x.to[lane]);
}
