//! The specification that the kernels are tested against: one receiver after the other, every texel
//! of its two rows, sorted intervals.

use alloc::{vec, vec::Vec};

use super::border::Neighbour;
use super::contact::Ground;
use super::frame::{Facing, Frame, Frustum, UNKNOWN};
use super::rows::LITTLE;
use super::run::{Probe, Vertex};
use super::search::Tilt;

/// What each pixel of the frame's camera sees, if there is one frustum.
pub(super) fn visibility(frame: &Frame<'_>) -> Vec<f32> {
    let map = frame.camera.map();
    let mut out = vec![0.0; map.nearness().len()];
    for (i, out) in out.iter_mut().enumerate() {
        let (x, y) = (i as u32 % map.width(), i as u32 / map.width());
        let nearness = map.nearness()[i];
        if nearness > 0.0 {
            *out = receiver(frame, x, y, nearness).clamp(0.0, 1.0);
        }
    }
    out
}

fn receiver(frame: &Frame<'_>, x: u32, y: u32, nearness: f32) -> f32 {
    let (_, plane) = frame.camera.plane(x, y, nearness);
    let known = plane.0.iter().all(|p| p.is_finite()) && plane.0[..3] != [0.0; 3];
    let Some(facing) = Facing::new(frame, if known { plane } else { UNKNOWN }) else { return 0.0 };
    let frustum = frame.frusta[0].as_ref().unwrap();
    let [u, v, n, q] = frustum
        .warp
        .map(|r| ((r[0] * (x as f32 + 0.5) + r[1] * (y as f32 + 0.5)) + r[2] * nearness) + r[3]);
    let (u, v, w) = (u / q, v / q, n / q);
    let height = frustum.size[1] as f32;
    if !(q > 0.0 && u.is_finite() && w.is_finite() && v > 0.0 && v < height) {
        return facing.open();
    }
    let tilt = Tilt::new(&facing, frustum, w);
    // The two rows around the receiver, and the part that each has in it.
    let center = (v - 0.5).clamp(0.0, height - 1.0);
    let above = center as usize;
    let below = (above + 1).min(frustum.size[1] as usize - 1);
    let part = center - above as f32;
    // What is hidden, and how much that counts.
    let hidden = |row: usize, part: f32| {
        let (hidden, through) = hidden_in_row(frame, frustum, &facing, &tilt, [u, v, w], row);
        (hidden, if through { part * LITTLE } else { part })
    };
    let ((a, part_a), (b, part_b)) = (hidden(above, 1.0 - part), hidden(below, part));
    facing.open() - (part_a * a + part_b * b) / (part_a + part_b)
}

/// How much of the light one row hides from a receiver that is moved into its middle, and whether
/// that moved it through a blocker.
fn hidden_in_row(
    frame: &Frame<'_>,
    frustum: &Frustum<'_>,
    facing: &Facing,
    tilt: &Tilt,
    [u, v, w]: [f32; 3],
    y: usize,
) -> (f32, bool) {
    let moved = w + tilt.per_row * (y as f32 + 0.5 - v);
    let mut hidden: Vec<[f32; 2]> = Vec::new();
    let mut through = false;
    for (index, sample) in frustum.samples.iter().enumerate() {
        let shift = frustum.disparity * (0.5 - sample.t);
        let [a, b, c, d] = tilt.plane(sample.t, [u + shift * w, v, w]);
        let bias = frame.bias.constant * w * c.abs() + frame.bias.slope * (a.abs() + b.abs());
        let width = sample.map.width() as usize;
        let row = &sample.map.nearness()[y * width..(y + 1) * width];
        let blocks = |x: usize| {
            let plane = ((a * (x as f32 + 0.5)) + b * (y as f32 + 0.5)) + c * row[x] + d;
            plane > bias && row[x] > moved
        };
        let probe = Probe { u: u + shift * moved, nearness: moved };
        let [from, to] = frustum.span(index);
        let (from, to) = (from.max(facing.horizon[0]), to.min(facing.horizon[1]));
        let ground = Ground {
            map: &sample.map,
            y,
            plane: [a, b, c, d],
            bias,
            behind: moved,
            steepest: frustum.steepest(),
            shift,
            neighbours: Neighbour::both(frustum, index, y),
        };
        let mut x = 0;
        while x < width {
            if !blocks(x) {
                x += 1;
                continue;
            }
            let start = x;
            let linked = |x: usize| {
                (row[x] - row[x - 1]).abs() < frustum.steepest() * row[x].max(row[x - 1])
            };
            x += 1;
            while x < width && blocks(x) && linked(x) {
                x += 1;
            }
            let inner = [(start + 1).min(x - 1), (x - 1).max(start + 1) - 1];
            let ends =
                [ground.end(row, start, inner[0], -1.0), ground.end(row, x - 1, inner[1], 1.0)];
            for contact in ends.iter().filter_map(|end| end.contact) {
                let rows = v - (y as f32 + 0.5);
                let [here, there] = contact.away(u, moved, tilt.per_row, rows);
                through |= (here > 0.0) != (there > 0.0);
            }
            let center = |x: usize| Vertex { column: x as f32 + 0.5, nearness: row[x] };
            let mut interval = [f32::INFINITY, f32::NEG_INFINITY];
            for vertex in (start..x).map(center).chain(ends.map(|end| end.vertex)) {
                let t = sample.t + probe.hidden(vertex, frustum.disparity);
                interval = [interval[0].min(t), interval[1].max(t)];
            }
            let interval = [interval[0].max(from), interval[1].min(to)];
            if interval[0] < interval[1] {
                hidden.push(interval);
            }
        }
    }
    hidden.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut length, mut reached) = (0.0, f32::NEG_INFINITY);
    for [from, to] in hidden {
        length += (to - from.max(reached)).max(0.0);
        reached = reached.max(to);
    }
    (length, through)
}
