//! What receivers can reach, and whether a node of the pyramid can matter to them.

use shadowmap_core::LightPoint;

use crate::pyramid::{FAN, LANES, Layout, NodeGroup};

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
        let mut all = receivers.clone();
        let (first, _) = all.next()?;
        let mut reach = Reach {
            u: [first.u; 2],
            v: [first.v; 2],
            radius,
            plane: first,
            least: f32::INFINITY,
            most: f32::NEG_INFINITY,
            cone: None,
        };
        let mut finite = true;
        for (point, _) in receivers.clone() {
            finite &= point.u.is_finite() && point.v.is_finite();
            reach.u = [reach.u[0].min(point.u), reach.u[1].max(point.u)];
            reach.v = [reach.v[0].min(point.v), reach.v[1].max(point.v)];
        }
        // The difference of two planes is greatest and least at corners of the box, which has room
        // for jitter and for rounding.
        let far = reach.u[0].abs() + reach.u[1].abs() + reach.v[0].abs() + reach.v[1].abs();
        let margin = (radius + 1.0) + (far + radius) * (1.0 / 1048576.0);
        let [left, right] = [reach.u[0] - margin, reach.u[1] + margin];
        let [top, bottom] = [reach.v[0] - margin, reach.v[1] + margin];
        for (point, offset) in receivers {
            for (s, t) in [(left, top), (right, top), (left, bottom), (right, bottom)] {
                let above = (point.plane_at(s, t) - first.plane_at(s, t)) + offset;
                finite &= above.is_finite();
                reach.least = reach.least.min(above);
                reach.most = reach.most.max(above);
            }
        }
        finite.then_some(reach)
    }
}

/// What the group kernels ask of 16 sibling nodes.
#[derive(Clone, Copy)]
pub(crate) struct GroupTest {
    /// Centre of the first texel of the first node.
    pub first: [f32; 2],
    /// Texels per node.
    pub size: [f32; 2],
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
    /// The test of a whole map's nodes, to be placed by [`GroupTest::at`].
    #[inline(always)]
    pub fn new(reach: &Reach, layout: &Layout, jitter: f32) -> Self {
        let plane = reach.plane;
        // Room for rounding, here and in the texels' own test: more than all errors together. The
        // nodes' bounds have their own.
        let extent = 4.0 * (layout.width as f32 + layout.height as f32 + 64.0);
        let steep = plane.slope.x.abs() + plane.slope.y.abs();
        let magnitude = plane.nearness.abs()
            + (reach.least.abs() + reach.most.abs())
            + steep * (plane.u.abs() + plane.v.abs() + extent);
        let room = magnitude * (1.0 / 1048576.0);
        let shift = jitter * (0.5 + (plane.u.abs() + plane.v.abs() + extent) * (1.0 / 1048576.0));
        let radius = reach.radius;
        GroupTest {
            first: [0.0; 2],
            size: [0.0; 2],
            from: [reach.u[0] - shift, reach.v[0] - shift],
            to: [reach.u[1] + shift, reach.v[1] + shift],
            reach_squared: radius * radius,
            plane,
            least: reach.least - room,
            most: reach.most + room,
            cone: reach.cone,
        }
    }

    /// Places the test at group (x, y) of a level.
    #[inline(always)]
    pub fn at(&mut self, level: usize, x: u32, y: u32) {
        let [width, height] = Layout::node_size(level);
        self.size = [width as f32, height as f32];
        self.first =
            [(u64::from(x * FAN) * width) as f32 + 0.5, (u64::from(y * FAN) * height) as f32 + 0.5];
    }
}

/// The 16 nodes of a group that are near enough to matter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Verdicts {
    /// Bit i: node i may hold a texel that blocks a receiver.
    pub may_block: u32,
    /// Bit i: node i may hold a texel that does not block every receiver.
    pub may_be_lit: u32,
    /// No texel of node i has a smaller key.
    pub keys: [f32; LANES],
}

/// What is computed for each of 16 sibling nodes, in plain Rust; the kernels do the same.
#[inline(always)]
pub(crate) fn group_scalar(test: &GroupTest, nodes: &NodeGroup) -> Verdicts {
    let mut verdicts = Verdicts { may_block: 0, may_be_lit: 0, keys: [0.0; LANES] };
    let GroupTest { first, size, from, to, plane, .. } = *test;
    let last = [size[0] - 1.0, size[1] - 1.0];
    for i in 0..LANES {
        let cell = [(i as u32 % FAN) as f32, (i as u32 / FAN) as f32];
        let start = [first[0] + cell[0] * size[0], first[1] + cell[1] * size[1]];
        let dx = (start[0] - to[0]).max(from[0] - (start[0] + last[0])).max(0.0);
        let dy = (start[1] - to[1]).max(from[1] - (start[1] + last[1])).max(0.0);
        let distance = dx * dx + dy * dy;
        let near = distance <= test.reach_squared;

        let half = [last[0] * 0.5, last[1] * 0.5];
        let (x, y) = ((start[0] + half[0]) - plane.u, (start[1] + half[1]) - plane.v);
        let at_center = plane.nearness + (plane.slope.x * x + plane.slope.y * y);
        let spread = (nodes.slope_x[i] - plane.slope.x).abs() * half[0]
            + (nodes.slope_y[i] - plane.slope.y).abs() * half[1];
        let below = (nodes.high[i] + spread) - at_center <= test.least;
        let above = (nodes.low[i] - spread) - at_center > test.most;

        let (mut key, mut outside) = (distance, false);
        if let Some(cone) = test.cone {
            let steep = nodes.slope_x[i].abs() * half[0] + nodes.slope_y[i].abs() * half[1];
            let nearer = (nodes.high[i] + steep) - cone.nearness;
            key = distance / (nearer * nearer);
            outside = nearer <= 0.0 || key > cone.at_most;
        }
        verdicts.keys[i] = key;
        verdicts.may_block |= u32::from(near && !below && !outside) << i;
        verdicts.may_be_lit |= u32::from(near && !above) << i;
    }
    verdicts
}
