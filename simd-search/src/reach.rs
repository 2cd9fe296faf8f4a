//! What receivers can reach, and whether a node of the pyramid can matter to them.

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

    /// The reach of several receivers, each with its offset: `None` if there are none, or if any
    /// of them has coordinates that are not finite.
    #[must_use]
    pub fn around(
        receivers: impl Iterator<Item = (LightPoint, f32)> + Clone,
        radius: f32,
    ) -> Option<Reach> {
        let (plane, _) = receivers.clone().next()?;
        // Comparisons instead of `min` and `max`: what is not a number is found at the end.
        let (mut u, mut v, mut sum) = ([plane.u; 2], [plane.v; 2], 0.0);
        for (point, _) in receivers.clone() {
            u = widen(u, point.u);
            v = widen(v, point.v);
            sum += point.u + point.v;
        }
        // Half the box, with room for jitter and for rounding.
        let far = (u[0].abs() + u[1].abs()) + (v[0].abs() + v[1].abs());
        let margin = (radius + 1.0) + (far + radius) * (1.0 / 1048576.0);
        let half = [(u[1] - u[0]) * 0.5 + margin, (v[1] - v[0]) * 0.5 + margin];
        let center = [(u[0] + u[1]) * 0.5, (v[0] + v[1]) * 0.5];
        let at_center = plane.plane_at(center[0], center[1]);
        // Two planes differ most at corners of the box.
        let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
        for (point, offset) in receivers {
            let above = (point.plane_at(center[0], center[1]) - at_center) + offset;
            let tilt = point.slope - plane.slope;
            let spread = tilt.x.abs() * half[0] + tilt.y.abs() * half[1];
            least = if above - spread < least { above - spread } else { least };
            most = if above + spread > most { above + spread } else { most };
            sum += above + spread;
        }
        sum.is_finite().then_some(Reach { u, v, radius, plane, least, most, cone: None })
    }
}

/// A range that contains `x` as well.
#[inline(always)]
fn widen([least, most]: [f32; 2], x: f32) -> [f32; 2] {
    [if x < least { x } else { least }, if x > most { x } else { most }]
}

/// What the group kernels ask of 16 nodes of one size.
#[derive(Clone, Copy)]
pub(crate) struct GroupTest {
    /// Receivers are at least at `from` and at most at `to`.
    from: [f32; 2],
    to: [f32; 2],
    pub reach_squared: f32,
    /// The plane that nodes are compared with.
    pub plane: LightPoint,
    /// A node that nowhere exceeds the plane by more than this does not block any receiver, one
    /// that everywhere exceeds it by more than that blocks all.
    pub least: f32,
    pub most: f32,
    /// Keys are ratios, not squared distances.
    pub cone: Option<Cone>,
    /// From the centre of a node to its outermost texel centres.
    pub half: [f32; 2],
    /// For each node, the least squared distance of a texel from a receiver.
    pub distance: [f32; LANES],
    /// For each node, the nearness of the plane at its centre.
    pub at_center: [f32; LANES],
}

impl GroupTest {
    /// The test of a whole map's nodes, to be placed by [`GroupTest::at`].
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
            half: [0.0; 2],
            distance: [0.0; LANES],
            at_center: [0.0; LANES],
        }
    }

    /// Places the test at group (x, y) of a level.
    #[inline(always)]
    pub fn at(&mut self, level: usize, x: u32, y: u32) {
        let [width, height] = Layout::node_size(level);
        let [(dx, rise_x, half_x), (dy, rise_y, half_y)] = [
            self.along(0, self.plane.u, self.plane.slope.x, u64::from(x), width),
            self.along(1, self.plane.v, self.plane.slope.y, u64::from(y), height),
        ];
        self.half = [half_x, half_y];
        for i in 0..LANES {
            let (column, row) = (i % FAN as usize, i / FAN as usize);
            self.distance[i] = dx[column] + dy[row];
            self.at_center[i] = self.plane.nearness + (rise_x[column] + rise_y[row]);
        }
    }

    /// Along one axis, for the four nodes of group `x`: the least squared distance, what the plane
    /// gains from its origin to the node's centre; and from the centre to the outermost texels.
    #[inline(always)]
    fn along(
        &self,
        axis: usize,
        origin: f32,
        slope: f32,
        x: u64,
        size: u64,
    ) -> ([f32; 4], [f32; 4], f32) {
        let last = size as f32 - 1.0;
        let half = last * 0.5;
        let (mut distance, mut rise) = ([0.0; 4], [0.0; 4]);
        for i in 0..4 {
            // Centres of texels are exact, so these differences are rounded as a texel's own are,
            // and none of the node's texels is closer.
            let first = ((x * 4 + i as u64) * size) as f32 + 0.5;
            let (before, after) = (first - self.to[axis], self.from[axis] - (first + last));
            let gap = if before > after { before } else { after };
            distance[i] = if gap > 0.0 { gap * gap } else { 0.0 };
            rise[i] = slope * ((first + half) - origin);
        }
        (distance, rise, half)
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
