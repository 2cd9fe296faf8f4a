//! What receivers can reach, and whether a node of the pyramid can matter to them.

use glam::Vec2;
use shadowmap_core::LightPoint;

use crate::pyramid::{FAN, LANES, Layout};

/// Receivers next to each other, as one: a box of places in the map, a radius, and two parallel
/// planes with all the receivers' planes between them.
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
    /// Wherever the receivers look, a receiver's plane plus its offset has at least the nearness
    /// of `plane` plus `least`, and at most that of `plane` plus `most`.
    pub least: f32,
    /// See [`Reach::least`].
    pub most: f32,
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
        let Receivers { u, v, nearness, slope_x, slope_y, offset } = *receivers;
        let slope = Vec2::new(*slope_x.first()?, *slope_y.first()?);
        let plane =
            LightPoint { u: *u.first()?, v: *v.first()?, nearness: *nearness.first()?, slope };
        let first = [plane.u, plane.v, plane.nearness, slope.x, slope.y, *offset.first()?];
        let columns = [u, v, nearness, slope_x, slope_y, offset];
        let mut places = [Extremes::NONE; 2];
        for_lanes(&columns, first, |[u, v, ..]| {
            places[0].add(u);
            places[1].add(v);
        });
        let (u, v) = (places[0].fold()?, places[1].fold()?);

        // Half the box, with room for jitter and for rounding.
        let far = (u[0].abs() + u[1].abs()) + (v[0].abs() + v[1].abs());
        let margin = (radius + 1.0) + (far + radius) * (1.0 / 1048576.0);
        let half = [(u[1] - u[0]) * 0.5 + margin, (v[1] - v[0]) * 0.5 + margin];
        let center = [(u[0] + u[1]) * 0.5, (v[0] + v[1]) * 0.5];
        let at_center = plane.plane_at(center[0], center[1]);
        // Two planes differ most at corners of the box.
        let mut above = [Extremes::NONE; 2];
        for_lanes(&columns, first, |[u, v, nearness, slope_x, slope_y, offset]| {
            let (mut least, mut most) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                let rise = slope_x[i] * (center[0] - u[i]) + slope_y[i] * (center[1] - v[i]);
                let above = ((nearness[i] + rise) - at_center) + offset[i];
                let spread =
                    (slope_x[i] - slope.x).abs() * half[0] + (slope_y[i] - slope.y).abs() * half[1];
                (least[i], most[i]) = (above - spread, above + spread);
            }
            above[0].add(&least);
            above[1].add(&most);
        });
        let (least, most) = (above[0].fold()?[0], above[1].fold()?[1]);
        Some(Reach { u, v, radius, plane, least, most, cone: None })
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

/// Calls `work` with 16 rows of a table at a time, the last ones filled up with `first`.
#[inline(always)]
fn for_lanes(columns: &[&[f32]; 6], first: [f32; 6], mut work: impl FnMut([&[f32; LANES]; 6])) {
    let count = columns[0].len();
    assert!(columns.iter().all(|column| column.len() == count), "slices of one length");
    let whole = columns.map(|column| column.as_chunks::<LANES>());
    for i in 0..count / LANES {
        work(whole.map(|(chunks, _)| &chunks[i]));
    }
    if !count.is_multiple_of(LANES) {
        let mut rest = first.map(|first| [first; LANES]);
        for (rest, (_, tail)) in rest.iter_mut().zip(whole) {
            rest[..tail.len()].copy_from_slice(tail);
        }
        work(rest.each_ref());
    }
}

/// The least and the greatest of many numbers, 16 at a time.
#[derive(Clone, Copy)]
struct Extremes {
    least: [f32; LANES],
    most: [f32; LANES],
    /// Becomes NaN with the first number that is not finite.
    finite: [f32; LANES],
}

impl Extremes {
    const NONE: Extremes = Extremes {
        least: [f32::INFINITY; LANES],
        most: [f32::NEG_INFINITY; LANES],
        finite: [0.0; LANES],
    };

    #[inline(always)]
    fn add(&mut self, numbers: &[f32; LANES]) {
        for i in 0..LANES {
            let number = numbers[i];
            self.least[i] = if number < self.least[i] { number } else { self.least[i] };
            self.most[i] = if number > self.most[i] { number } else { self.most[i] };
            self.finite[i] += number * 0.0;
        }
    }

    /// `None` if a number was not finite.
    #[inline(always)]
    fn fold(&self) -> Option<[f32; 2]> {
        let mut all = *self;
        let mut count = LANES / 2;
        while count > 0 {
            for i in 0..count {
                let j = i + count;
                all.least[i] =
                    if all.least[j] < all.least[i] { all.least[j] } else { all.least[i] };
                all.most[i] = if all.most[j] > all.most[i] { all.most[j] } else { all.most[i] };
                all.finite[i] += all.finite[j];
            }
            count /= 2;
        }
        (all.finite[0] == 0.0).then_some([all.least[0], all.most[0]])
    }
}

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
    /// that everywhere exceeds it by more than that blocks all.
    pub least: f32,
    pub most: f32,
    /// Keys are ratios, not squared distances.
    pub cone: Option<Cone>,
}

impl GroupTest {
    #[inline(always)]
    pub fn new(reach: &Reach, layout: &Layout, jitter: f32) -> Self {
        let plane = reach.plane;
        // Room for rounding, here and in the texels' own test: more than all errors together. The
        // nodes' bounds have their own.
        let extent = 4.0 * (layout.width as f32 + layout.height as f32 + 64.0);
        let steep = plane.slope.x.abs() + plane.slope.y.abs();
        let far = plane.u.abs() + plane.v.abs() + extent;
        let magnitude = plane.nearness.abs() + (reach.least.abs() + reach.most.abs()) + steep * far;
        let room = magnitude * (1.0 / 1048576.0);
        let shift = jitter * (0.5 + far * (1.0 / 1048576.0));
        GroupTest {
            from: [reach.u[0] - shift, reach.v[0] - shift],
            to: [reach.u[1] + shift, reach.v[1] + shift],
            reach_squared: reach.radius * reach.radius,
            plane,
            least: reach.least - room,
            most: reach.most + room,
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
        let [width, height] = Layout::node_size(level).map(|size| size as f32);
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
