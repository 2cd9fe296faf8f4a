//! Where the samples of a light lie: the one place that decides it, for rays and for point lights.

use core::f64::consts::PI;

use glam::{DVec3, Vec3};
use shadowmap_core::Light;

use crate::mask::Bounds;

/// How many points of a light are tried per receiver, and how they are placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// The same points for every receiver: the midpoints of equal parts for a linear light, a
    /// Hammersley set for every light with an area. The truth is `Fixed(4096)`.
    Fixed(u32),
    /// One random point in each of `count` equal strata, independent for every receiver: noise in
    /// place of banding. The strata of an area are `a` by `b` with `a * b == count` and `a <= b`
    /// as square as possible. The same `seed` gives the same bits again.
    Jittered {
        /// Number of points.
        count: u32,
        /// Chooses among the random sets.
        seed: u32,
    },
}

impl Samples {
    /// The samples of the truth that everything is measured against: 4096 fixed points.
    pub const TRUTH: Samples = Samples::Fixed(4096);

    /// How many points per receiver; at least 1.
    #[must_use]
    pub fn count(self) -> u32 {
        match self {
            Samples::Fixed(count) | Samples::Jittered { count, .. } => count.max(1),
        }
    }
}

/// The `count` point lights that together stand for `light`, as N hard shadow maps need them: the
/// midpoints of equal parts of a linear light, a Hammersley set on a light with an area.
///
/// A sphere counts as its disc that faces `toward`, since a shadow map cannot have one disc per
/// receiver. The samples of a sun are suns of angle 0.
#[must_use]
pub fn point_lights(light: &Light, count: u32, toward: Vec3) -> Vec<Light> {
    let mut points = Vec::new();
    unit_points(light, Samples::Fixed(count), 0, &mut points);
    let eye = toward.as_dvec3();
    let rays = LightRays::new(light, eye);
    let place = |&point: &[f32; 2]| {
        let ray = rays.to(point);
        if rays.w == 0.0 {
            Light::Sun { direction: (-ray).as_vec3(), angle: 0.0 }
        } else {
            Light::Point { position: (eye + ray).as_vec3() }
        }
    };
    points.iter().map(place).collect()
}

/// All rays from one receiver to a light: `origin + x u + y v` for the light's coordinates (x, y).
///
/// With `w` 1 a ray ends on the light at parameter 1; with `w` 0 (a sun) it never ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightRays {
    pub origin: DVec3,
    pub u: DVec3,
    pub v: DVec3,
    pub w: f64,
}

impl LightRays {
    /// The ray to the light's coordinates (x, y).
    pub fn to(&self, [x, y]: [f32; 2]) -> DVec3 {
        self.origin + self.u * f64::from(x) + self.v * f64::from(y)
    }

    pub fn new(light: &Light, from: DVec3) -> LightRays {
        let at = |origin: Vec3, u: DVec3, v: DVec3| LightRays {
            origin: origin.as_dvec3() - from,
            u,
            v,
            w: 1.0,
        };
        match *light {
            Light::Point { position } => at(position, DVec3::ZERO, DVec3::ZERO),
            Light::Linear { a, b } => at(a, b.as_dvec3() - a.as_dvec3(), DVec3::ZERO),
            Light::Triangle { a, b, c } => {
                at(a, b.as_dvec3() - a.as_dvec3(), c.as_dvec3() - a.as_dvec3())
            }
            Light::Rectangle { corner, edge_u, edge_v } => {
                at(corner, edge_u.as_dvec3(), edge_v.as_dvec3())
            }
            Light::Sphere { center, radius } => {
                let axis = (from - center.as_dvec3()).normalize_or(DVec3::NEG_Y);
                let [t, b] = disc_axes(axis);
                at(center, t * f64::from(radius), b * f64::from(radius))
            }
            Light::Sun { direction, angle } => {
                let axis = direction.as_dvec3().normalize_or(DVec3::NEG_Y);
                let [t, b] = disc_axes(axis);
                let radius = libm::tan(f64::from(angle) * 0.5);
                LightRays { origin: -axis, u: t * radius, v: b * radius, w: 0.0 }
            }
            // `Light` may grow kinds; one that is unknown here is its centre.
            _ => at(light.center().unwrap_or(Vec3::ZERO), DVec3::ZERO, DVec3::ZERO),
        }
    }
}

/// Two unit vectors that span the disc with the unit normal `d` (Duff et al. 2017, with y for z).
fn disc_axes(d: DVec3) -> [DVec3; 2] {
    let s = 1.0_f64.copysign(d.y);
    let k = -1.0 / (s + d.y);
    [
        DVec3::new(s * d.z * d.x * k, -s * d.z, 1.0 + s * d.z * d.z * k),
        DVec3::new(s + d.x * d.x * k, -d.x, d.z * d.x * k),
    ]
}

/// The light's coordinates of all of its points.
pub(crate) fn bounds(light: &Light) -> Bounds {
    let [center, half] = match light {
        Light::Point { .. } => [[0.0, 0.0], [0.0, 0.0]],
        Light::Linear { .. } => [[0.5, 0.0], [0.5, 0.0]],
        Light::Sphere { .. } | Light::Sun { .. } => [[0.0, 0.0], [1.0, 1.0]],
        _ => [[0.5, 0.5], [0.5, 0.5]],
    };
    Bounds { center, half }
}

/// The light's coordinates of all samples for receiver number `receiver`.
pub(crate) fn unit_points(light: &Light, samples: Samples, receiver: u32, out: &mut Vec<[f32; 2]>) {
    out.clear();
    let count = samples.count();
    match (light, samples) {
        (Light::Point { .. }, _) => out.push([0.0; 2]),
        (Light::Linear { .. }, Samples::Fixed(_)) => {
            out.extend((0..count).map(|i| [stratum(i, 0.5, count), 0.0]));
        }
        (Light::Linear { .. }, Samples::Jittered { seed, .. }) => {
            let place = |i| [stratum(i, random(seed, receiver, i, 0), count), 0.0];
            out.extend((0..count).map(place));
        }
        _ => out.extend(unit_square(samples, receiver).map(|point| warp(light, point))),
    }
}

/// The samples of the unit square for receiver number `receiver`.
pub(crate) fn unit_square(
    samples: Samples,
    receiver: u32,
) -> impl ExactSizeIterator<Item = [f32; 2]> {
    let count = samples.count();
    let divisors = (1..=count).take_while(|a| a * a <= count).filter(|a| count.is_multiple_of(*a));
    let columns = divisors.last().unwrap_or(1);
    (0..count as usize).map(move |i| {
        let i = i as u32;
        match samples {
            Samples::Fixed(_) => [stratum(i, 0.5, count), radical_inverse(i, count)],
            Samples::Jittered { seed, .. } => [
                stratum(i % columns, random(seed, receiver, i, 0), columns),
                stratum(i / columns, random(seed, receiver, i, 1), count / columns),
            ],
        }
    })
}

fn stratum(i: u32, offset: f64, count: u32) -> f32 {
    ((f64::from(i) + offset) / f64::from(count)) as f32
}

/// Van der Corput's sequence in base 2, moved to the middle of its cells.
fn radical_inverse(i: u32, count: u32) -> f32 {
    (f64::from(i.reverse_bits()) / 4_294_967_296.0 + 0.5 / f64::from(count)) as f32
}

/// From the unit square to the light's coordinates, areas kept.
fn warp(light: &Light, [x, y]: [f32; 2]) -> [f32; 2] {
    match light {
        Light::Sphere { .. } | Light::Sun { .. } => concentric(x, y),
        Light::Triangle { .. } => {
            let root = x.sqrt();
            [1.0 - root, y * root]
        }
        _ => [x, y],
    }
}

/// From the unit square to the unit disc (Shirley and Chiu 1997).
pub(crate) fn concentric(x: f32, y: f32) -> [f32; 2] {
    let (a, b) = (2.0 * f64::from(x) - 1.0, 2.0 * f64::from(y) - 1.0);
    let (r, phi) = if a.abs() > b.abs() {
        (a, PI / 4.0 * (b / a))
    } else if b != 0.0 {
        (b, PI / 2.0 - PI / 4.0 * (a / b))
    } else {
        (0.0, 0.0)
    };
    [(r * libm::cos(phi)) as f32, (r * libm::sin(phi)) as f32]
}

/// A random number in \[0, 1) from its coordinates alone: the finalizer of splitmix64 over them.
fn random(seed: u32, receiver: u32, sample: u32, axis: u32) -> f64 {
    let key = (u64::from(receiver) << 32) | (u64::from(sample) << 1) | u64::from(axis);
    let mut x = key.wrapping_add(u64::from(seed).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    for multiplier in [0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb] {
        x = (x ^ (x >> 30)).wrapping_mul(multiplier);
        x ^= x >> 27;
    }
    (x >> 11) as f64 / 9_007_199_254_740_992.0
}
