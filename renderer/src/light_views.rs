//! Where a light's depth maps are taken from, fitted to what the light must cover.

use glam::{DVec3, Vec3};
use linear_light::SampleViews;
use shadowmap_core::{Light, View, Window};

use crate::scene::SpotCone;

/// The widest tangent of a single fitted perspective window, 66 degrees to either side. Beyond it,
/// several faces around the light spend their texels better.
const MAX_TANGENT: f64 = 2.25;

/// Half the side of one of several faces, in tangents. They meet at 1; the rest is for penumbrae
/// that reach across from the neighbouring face.
const FACE_TANGENT: f64 = 1.25;

/// Texels left free around a fitted window, for whatever looks at a texel's neighbours.
const MARGIN: f64 = 2.0;

/// A light frustum by hand: a square one, looking at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByHand {
    /// What the light looks at.
    pub target: Vec3,
    /// The angle that the frustum spans, in radians.
    pub fov: f32,
}

/// The views, one or several, that a light's middle needs so that maps of `size` times `size`
/// texels cover `points`, the vertices of all blockers and receivers. A receiver belongs to the
/// view whose axis is nearest to it ([`crate::faces`]).
///
/// `by_hand` replaces the fit for lights that have a place.
#[must_use]
pub fn fit(
    light: &Light,
    spot: Option<SpotCone>,
    by_hand: Option<ByHand>,
    size: u32,
    points: impl Iterator<Item = Vec3> + Clone,
) -> Vec<View> {
    let points = points.filter(|p| p.is_finite()).map(Vec3::as_dvec3);
    match (*light, light.center()) {
        (Light::Sun { direction, .. }, _) => vec![fit_sun(direction, size, points)],
        (_, Some(eye)) => match by_hand {
            Some(ByHand { target, fov }) => {
                let near = nearest(eye.as_dvec3(), points);
                vec![View::perspective(eye, target, up(target - eye), fov, size, size, near as f32)]
            }
            None => fit_point(eye.as_dvec3(), spot, size, points),
        },
        (_, None) => Vec::new(),
    }
}

/// The rectified views of a linear light whose window is square as far as its middle sees: it takes
/// in what a frustum by hand from the middle would, turned so that it stands across the light.
#[must_use]
pub fn by_hand_line(
    a: Vec3,
    b: Vec3,
    samples: usize,
    by_hand: ByHand,
    size: u32,
    points: &[Vec3],
) -> SampleViews {
    let middle = (a + b) * 0.5;
    let towards = by_hand.target - middle;
    let axis = (b - a).normalize_or(Vec3::X);
    let depth = (towards - axis * towards.dot(axis)).length().max(1e-6);
    let half = libm::tan(f64::from(by_hand.fov) * 0.5) as f32;
    // The middle sees the target at this tangent along the light, and either end sees the light's
    // half length more.
    let along = towards.dot(axis) / depth;
    let reach = half + a.distance(b) * 0.5 / depth;
    let window = Window { left: along - reach, right: along + reach, top: -half, bottom: half };
    let points = points.iter().filter(|p| p.is_finite()).map(|p| p.as_dvec3());
    let near = nearest(middle.as_dvec3(), points) as f32;
    SampleViews::new(a, b, samples, towards, window, [size, size], near)
}

/// The up direction of a view along `forward`: -z if that is vertical, else y.
fn up(forward: Vec3) -> Vec3 {
    let flat = forward.with_y(0.0).length();
    if flat > 1e-3 * forward.length() { Vec3::Y } else { Vec3::NEG_Z }
}

/// A near plane closer than anything that could matter: a ten-thousandth of the farthest point.
fn nearest(eye: DVec3, points: impl Iterator<Item = DVec3>) -> f64 {
    let reach = points.map(|p| p.distance_squared(eye)).fold(0.0, f64::max).sqrt();
    1e-4 * reach.max(1e-3)
}

fn fit_point(
    eye: DVec3,
    spot: Option<SpotCone>,
    size: u32,
    points: impl Iterator<Item = DVec3> + Clone,
) -> Vec<View> {
    let near = nearest(eye, points.clone());
    let view = |forward: DVec3, window: Window| {
        let forward = forward.as_vec3();
        let axes = View::axes_towards(forward, up(forward));
        View::perspective_window(eye.as_vec3(), axes, window, size, size, near as f32)
    };
    if let Some(cone) = spot.filter(|cone| libm::tan(f64::from(cone.outer)) <= MAX_TANGENT)
        && cone.outer < 1.5
    {
        // Nothing outside its cone is lit: of the scene's window, only what the cone holds.
        let half = libm::tan(f64::from(cone.outer));
        let mut extents = [-half, -half, half, half];
        if let Some(fitted) = extents_of(eye, cone.direction.as_dvec3(), points) {
            for i in 0..2 {
                extents[i] = extents[i].max(fitted[i]).min(half - 1e-3);
                extents[i + 2] = extents[i + 2].min(fitted[i + 2]).max(extents[i] + 1e-3);
            }
        }
        return vec![view(cone.direction.as_dvec3(), square(extents, size))];
    }
    // Candidates for the axis: towards the middle of the scene, and along the world's axes. The
    // best is the one whose square window is smallest.
    let middle = middle(points.clone());
    let to_middle = (middle - eye).normalize_or(DVec3::NEG_Y);
    let axes = [DVec3::NEG_Y, DVec3::Y, DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z];
    let side = |e: &[f64; 4]| (e[2] - e[0]).max(e[3] - e[1]);
    let best = std::iter::once(to_middle)
        .chain(axes)
        .filter_map(|axis| Some((axis, extents_of(eye, axis, points.clone())?)))
        .min_by(|(_, a), (_, b)| side(a).total_cmp(&side(b)));
    match best {
        Some((axis, extents)) if side(&extents) <= 2.0 * MAX_TANGENT => {
            vec![view(axis, square(extents, size))]
        }
        _ => {
            let half = FACE_TANGENT as f32;
            axes.map(|axis| view(axis, Window::centered(half, half))).into()
        }
    }
}

fn middle(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (min, max) = points.fold(start, |(min, max), p| (min.min(p), max.max(p)));
    if min.is_finite() && max.is_finite() { (min + max) * 0.5 } else { DVec3::ZERO }
}

/// Left, top, right, bottom of what a view from `eye` along `axis` sees of the points, in tangents;
/// `None` if one lies behind it or there is none.
fn extents_of(
    eye: DVec3,
    axis: DVec3,
    mut points: impl Iterator<Item = DVec3>,
) -> Option<[f64; 4]> {
    let axis = axis.as_vec3();
    let [right, down, forward] = View::axes_towards(axis, up(axis)).map(Vec3::as_dvec3);
    let start = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    let extents = points.try_fold(start, |[left, top, far_right, bottom], p| {
        let p = p - eye;
        let z = p.dot(forward);
        let (x, y) = (p.dot(right) / z, p.dot(down) / z);
        let seen = z > 0.0 && x.abs() <= 1e3 && y.abs() <= 1e3;
        seen.then(|| [left.min(x), top.min(y), far_right.max(x), bottom.max(y)])
    })?;
    extents.iter().all(|e| e.is_finite()).then_some(extents)
}

/// The square window around extents, with a few texels to spare.
fn square([left, top, right, bottom]: [f64; 4], size: u32) -> Window {
    let center = [(left + right) * 0.5, (top + bottom) * 0.5];
    let spare = f64::from(size) / (f64::from(size) - 2.0 * MARGIN).max(1.0);
    let half = ((right - left).max(bottom - top) * 0.5).max(1e-4) * spare;
    Window {
        left: (center[0] - half) as f32,
        top: (center[1] - half) as f32,
        right: (center[0] + half) as f32,
        bottom: (center[1] + half) as f32,
    }
}

fn fit_sun(direction: Vec3, size: u32, points: impl Iterator<Item = DVec3> + Clone) -> View {
    let direction = direction.normalize_or(Vec3::NEG_Y);
    let axes = View::axes_towards(direction, up(direction));
    let [right, down, forward] = axes.map(Vec3::as_dvec3);
    let eye = middle(points.clone());
    let start = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    let (mut extents, mut near, mut far) = (start, f64::INFINITY, f64::NEG_INFINITY);
    for p in points {
        let p = p - eye;
        let (x, y, z) = (p.dot(right), p.dot(down), p.dot(forward));
        let [l, t, r, b] = extents;
        extents = [l.min(x), t.min(y), r.max(x), b.max(y)];
        (near, far) = (near.min(z), far.max(z));
    }
    if near > far {
        (extents, near, far) = ([-1.0, -1.0, 1.0, 1.0], -1.0, 1.0);
    }
    // Receivers in the farthest plane still have a nearness, and the nearest blocker is drawn.
    let spare = 0.01 * (far - near).max(1e-3 * (extents[2] - extents[0])).max(1e-6);
    let depths = [(near - spare) as f32, (far + spare) as f32];
    let window = square(extents, size);
    View::orthographic_window(eye.as_vec3(), axes, window, size, size, depths)
}
