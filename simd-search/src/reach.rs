//! What receivers can reach, and whether a node of the pyramid can matter to them.

use glam::Vec2;
use shadowmap_core::LightPoint;

use crate::Side;
use crate::pyramid::{FAN, LANES, Layout};

/// Receivers next to each other, as one: a box of places in the map, a radius, and all their planes
/// as one plane with a margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Least and greatest texel coordinate u of the receivers.
    pub u: [f32; 2],
    /// Least and greatest texel coordinate v of the receivers.
    pub v: [f32; 2],
    /// How far the receivers look, in texels. For several, the greatest.
    pub radius: f32,
    /// A plane in texel space.
    pub plane: LightPoint,
    /// At the plane's (u, v), each receiver's plane plus its offset is between that of `plane` plus
    /// `least` and that of `plane` plus `most`.
    pub least: f32,
    /// See [`Reach::least`].
    pub most: f32,
    /// The receivers' slopes differ by no more than this from that of `plane`, along u and v.
    pub spread: Vec2,
    /// For blockers, the cone from the receivers to the light ([`crate::Key::Ratio`]).
    pub cone: Option<Cone>,
}

/// The blockers that lie between a receiver and the light: those with
/// `distance² <= at_most (nearness - receiver)²` and nearness greater than the receiver's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Nearness of the receiver, of several the least.
    pub nearness: f32,
    /// Square of the penumbra's radius in texels per unit of nearness.
    pub at_most: f32,
}

impl Reach {
    /// The reach of one receiver.
    #[must_use]
    pub fn of(point: LightPoint, offset: f32, radius: f32) -> Reach {
        let LightPoint { u, v, .. } = point;
        Reach {
            u: [u; 2],
            v: [v; 2],
            radius,
            plane: point,
            least: offset,
            most: offset,
            spread: Vec2::ZERO,
            cone: None,
        }
    }

    /// The reach of several receivers: `None` if there are none, or if any of them has coordinates
    /// that are not finite. The cone is not set.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    #[inline(always)]
    #[must_use]
    pub fn around(receivers: &Receivers<'_>, radius: f32) -> Option<Reach> {
        let Receivers { u: from_u, v: from_v, nearness, offset, .. } = *receivers;
        let (from_slope_x, from_slope_y) = (receivers.slope_x, receivers.slope_y);
        let count = from_u.len();
        let columns = [from_u, from_v, from_slope_x, from_slope_y];
        let all = [columns[1], columns[2], columns[3], nearness, offset];
        assert!(all.iter().all(|column| column.len() == count), "slices of one length");
        if count == 0 {
            return None;
        }
        let mut extremes = [Extremes::NONE; 4];
        let mut finite = [0.0; LANES];
        for chunk in 0..count.div_ceil(LANES) {
            for i in 0..4 {
                extremes[i].add(&lanes(columns[i], chunk), &mut finite);
            }
        }
        let [mut center, mut half] = [[0.0; 4]; 2];
        let mut ranges = [[0.0; 2]; 4];
        for i in 0..4 {
            let [least, most] = extremes[i].fold();
            ranges[i] = [least, most];
            center[i] = (least + most) * 0.5;
            let (above, below) = (most - center[i], center[i] - least);
            half[i] = if above > below { above } else { below };
        }
        let [u, v, slope_x, slope_y] = center;
        let rise = from_slope_x[0] * (u - from_u[0]) + from_slope_y[0] * (v - from_v[0]);
        let at_center = nearness[0] + rise;
        let mut above = Extremes::NONE;
        for chunk in 0..count.div_ceil(LANES) {
            let (from_u, from_v) = (lanes(from_u, chunk), lanes(from_v, chunk));
            let (slope_x, slope_y) = (lanes(from_slope_x, chunk), lanes(from_slope_y, chunk));
            let (nearness, offset) = (lanes(nearness, chunk), lanes(offset, chunk));
            let mut own = [0.0; LANES];
            for i in 0..LANES {
                let rise = slope_x[i] * (u - from_u[i]) + slope_y[i] * (v - from_v[i]);
                own[i] = ((nearness[i] + rise) - at_center) + offset[i];
            }
            above.add(&own, &mut finite);
        }
        let [least, most] = above.fold();
        if finite != [0.0; LANES] {
            return None;
        }
        Some(Reach {
            u: ranges[0],
            v: ranges[1],
            radius,
            plane: LightPoint { u, v, nearness: at_center, slope: Vec2::new(slope_x, slope_y) },
            least,
            most,
            spread: Vec2::new(half[2], half[3]),
            cone: None,
        })
    }
}

/// Several receivers, their coordinates in separate slices of one length: [`LightPoint`]s, and by
/// how much nearness must exceed their planes to block them.
#[derive(Clone, Copy, Debug)]
pub struct Receivers<'a> {
    /// Texel coordinates along a row.
    pub u: &'a [f32],
    /// Texel coordinates down the map.
    pub v: &'a [f32],
    /// Nearness of the receivers.
    pub nearness: &'a [f32],
    /// Change of their planes' nearness per texel along u.
    pub slope_x: &'a [f32],
    /// And along v.
    pub slope_y: &'a [f32],
    /// Offsets of their depth tests.
    pub offset: &'a [f32],
}

/// Sixteen numbers of a column, the last ones filled up with the first.
#[inline(always)]
fn lanes(column: &[f32], chunk: usize) -> [f32; LANES] {
    let rest = &column[chunk * LANES..];
    if let Some(whole) = rest.first_chunk() {
        return *whole;
    }
    let mut lanes = [column[0]; LANES];
    lanes[..rest.len()].copy_from_slice(rest);
    lanes
}

/// The least and the greatest of many numbers, 16 at a time.
#[derive(Clone, Copy)]
struct Extremes {
    least: [f32; LANES],
    most: [f32; LANES],
}

impl Extremes {
    const NONE: Extremes =
        Extremes { least: [f32::INFINITY; LANES], most: [f32::NEG_INFINITY; LANES] };

    /// Adds numbers. Those of `finite` become NaN with the first that is not finite.
    #[inline(always)]
    fn add(&mut self, numbers: &[f32; LANES], finite: &mut [f32; LANES]) {
        for i in 0..LANES {
            let number = numbers[i];
            self.least[i] = if number < self.least[i] { number } else { self.least[i] };
            self.most[i] = if number > self.most[i] { number } else { self.most[i] };
            finite[i] += number * 0.0;
        }
    }

    #[inline(always)]
    fn fold(&self) -> [f32; 2] {
        let mut all = *self;
        let mut count = LANES / 2;
        while count > 0 {
            for i in 0..count {
                let j = i + count;
                all.least[i] =
                    if all.least[j] < all.least[i] { all.least[j] } else { all.least[i] };
                all.most[i] = if all.most[j] > all.most[i] { all.most[j] } else { all.most[i] };
            }
            count /= 2;
        }
        [all.least[0], all.most[0]]
    }
}

/// Far from where `f32` ends: a millionth of the greatest [`GroupTest::room`].
const TAME: f32 = 1e30;

/// What the group kernels ask of 16 nodes.
#[derive(Clone, Copy)]
pub(crate) struct GroupTest {
    /// Receivers are at least at `from` and at most at `to`.
    pub from: [f32; 2],
    pub to: [f32; 2],
    pub reach_squared: f32,
    /// The plane that nodes are compared with.
    pub plane: LightPoint,
    /// A node that nowhere exceeds the plane by more than this does not block any receiver, one
    /// that everywhere exceeds it by more than that blocks all...
    pub least: f32,
    pub most: f32,
    /// ...and by this more for every texel away from the plane's (u, v).
    pub spread: Vec2,
    /// How much of that is room for rounding.
    pub room: f32,
    /// Keys are ratios, not squared distances.
    pub cone: Option<Cone>,
}

impl GroupTest {
    /// Whether no number that comes of the plane overflows, so that texels can be compared with it.
    #[inline(always)]
    pub fn is_tame(&self) -> bool {
        self.least.abs() < TAME && self.most.abs() < TAME && self.room < TAME
    }

    #[inline(always)]
    pub fn new(reach: &Reach, layout: &Layout, jitter: f32) -> Self {
        let plane = reach.plane;
        let extent = 4.0 * (layout.width as f32 + layout.height as f32 + 64.0);
        let far = plane.u.abs() + plane.v.abs() + extent;
        // No node that is visited and within reach is farther away, nor its centre: nodes are not
        // much larger than the box that is in reach, or of the lowest level.
        let near = reach.radius + ((reach.u[1] - reach.u[0]) + (reach.v[1] - reach.v[0]));
        let farthest = (4.0 * near + 256.0).min(far);
        // Room for rounding, here and in the texels' own test: more than all errors together. The
        // nodes' bounds have their own.
        let steep = plane.slope.x.abs() + plane.slope.y.abs();
        let steep = steep + (reach.spread.x + reach.spread.y);
        let magnitude =
            plane.nearness.abs() + (reach.least.abs() + reach.most.abs()) + steep * farthest;
        let room = magnitude * (1.0 / 1048576.0);
        let shift = jitter * (0.5 + far * (1.0 / 1048576.0));
        GroupTest {
            from: [reach.u[0] - shift, reach.v[0] - shift],
            to: [reach.u[1] + shift, reach.v[1] + shift],
            reach_squared: reach.radius * reach.radius,
            plane,
            least: reach.least - room,
            most: reach.most + room,
            spread: reach.spread,
            room,
            cone: reach.cone,
        }
    }
}

/// The parts of a map that 16 nodes bound: centres of their outermost texels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Boxes {
    pub left: [f32; LANES],
    pub right: [f32; LANES],
    pub top: [f32; LANES],
    pub bottom: [f32; LANES],
}

impl Boxes {
    /// The nodes of group (x, y) of a level. Centres of texels are exact, so that distances from
    /// them are rounded as a texel's own are: no texel of a node is closer than its box.
    #[inline(always)]
    pub fn of_group(level: usize, x: u32, y: u32) -> Boxes {
        let [width, height] = Layout::node_size(level);
        let (width, height) = (width as f32, height as f32);
        let (left, top) = ((x * FAN) as f32 * width + 0.5, (y * FAN) as f32 * height + 0.5);
        let mut boxes = Boxes {
            left: [left; LANES],
            right: [left + (width - 1.0); LANES],
            top: [top; LANES],
            bottom: [top + (height - 1.0); LANES],
        };
        for i in 0..LANES {
            let (column, row) = ((i as u32 % FAN) as f32 * width, (i as u32 / FAN) as f32 * height);
            boxes.left[i] += column;
            boxes.right[i] += column;
            boxes.top[i] += row;
            boxes.bottom[i] += row;
        }
        boxes
    }
}

/// What a group kernel says of 16 nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Verdicts {
    /// Bit i: node i is in reach and may hold a texel that blocks a receiver.
    pub may_block: u32,
    /// Bit i: node i is in reach and may hold a texel that does not block every receiver.
    pub may_be_lit: u32,
    /// No texel of node i has a smaller key.
    pub keys: [f32; LANES],
}

impl Verdicts {
    /// The nodes that may hold what is looked for.
    #[inline(always)]
    pub fn of(&self, side: Side) -> u32 {
        match side {
            Side::Blocker => self.may_block,
            Side::Lit => self.may_be_lit,
        }
    }
}
