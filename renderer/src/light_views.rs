//! Where a light's depth maps are taken from, fitted to what the light must cover.

use glam::{DVec3, Vec3};
use linear_light::SampleViews;
use shadowmap_core::{Extents, ImagePoint, Light, Spread, View, Window, fit_extents};

use crate::cover::Cover;
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
/// texels cover what can block it and what is seen of that. A receiver belongs to the view whose
/// axis is nearest to it.
///
/// `by_hand` replaces the fit for lights that have a place.
#[must_use]
pub fn fit(
    light: &Light,
    spot: Option<SpotCone>,
    by_hand: Option<ByHand>,
    size: u32,
    cover: &Cover,
) -> Vec<View> {
    match (*light, light.center()) {
        (Light::Sun { direction, angle }, _) => vec![fit_sun(direction, angle, size, cover)],
        (_, Some(eye)) => match by_hand {
            Some(ByHand { target, fov }) => {
                let near = nearest(eye.as_dvec3(), cover);
                vec![View::perspective(eye, target, up(target - eye), fov, size, size, near as f32)]
            }
            None => {
                let radius =
                    if let Light::Sphere { radius, .. } = light { radius.abs() } else { 0.0 };
                fit_point(eye.as_dvec3(), f64::from(radius), spot, size, cover)
            }
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
    cover: &Cover,
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
    let near = nearest(middle.as_dvec3(), cover) as f32;
    SampleViews::new(a, b, samples, towards, window, [size, size], near)
}

/// The up direction of a view along `forward`: -z if that is vertical, else y.
fn up(forward: Vec3) -> Vec3 {
    let flat = forward.with_y(0.0).length();
    if flat > 1e-3 * forward.length() { Vec3::Y } else { Vec3::NEG_Z }
}

/// A near plane closer than anything that could matter: a ten-thousandth of the farthest point.
fn nearest(eye: DVec3, cover: &Cover) -> f64 {
    let reach = cover.points().map(|p| p.distance_squared(eye)).fold(0.0, f64::max).sqrt();
    1e-4 * reach.max(1e-3)
}

fn fit_point(
    eye: DVec3,
    radius: f64,
    spot: Option<SpotCone>,
    size: u32,
    cover: &Cover,
) -> Vec<View> {
    let near = nearest(eye, cover);
    let view = |forward: DVec3, window: Window| {
        let forward = forward.as_vec3();
        let axes = View::axes_towards(forward, up(forward));
        View::perspective_window(eye.as_vec3(), axes, window, size, size, near as f32)
    };
    let sets = [&cover.blockers, &cover.receivers];
    let extents = |axis| fitted(sets.map(|points| seen_from(eye, axis, points)), radius);
    if let Some(cone) = spot.filter(|cone| libm::tan(f64::from(cone.outer)) <= MAX_TANGENT)
        && cone.outer < 1.5
    {
        // Nothing outside its cone is lit: of the window, only what the cone holds.
        let half = libm::tan(f64::from(cone.outer));
        let mut window = [-half, -half, half, half];
        if let Some(fitted) = extents(cone.direction.as_dvec3()) {
            for i in 0..2 {
                window[i] = fitted[i].max(window[i]).min(half - 1e-3);
                window[i + 2] = fitted[i + 2].min(half).max(window[i] + 1e-3);
            }
        }
        return vec![view(cone.direction.as_dvec3(), square(window, size))];
    }
    // Candidates for the axis: towards the middle of what blocks and of what is seen, and along
    // the world's axes. The best is the one whose square window is smallest.
    let middles = sets.map(|points| {
        let middle = middle(points.iter().map(|p| p.as_dvec3()));
        (middle - eye).normalize_or(DVec3::NEG_Y)
    });
    let axes = [DVec3::NEG_Y, DVec3::Y, DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z];
    let side = |e: &[f64; 4]| (e[2] - e[0]).max(e[3] - e[1]);
    let best = middles
        .into_iter()
        .chain(axes)
        .filter_map(|axis| Some((axis, extents(axis)?)))
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

/// The points on the image plane of a view from `eye`, `None` if one lies beside or behind it.
fn seen_from(eye: DVec3, axis: DVec3, points: &[Vec3]) -> Option<Vec<ImagePoint>> {
    let axis = axis.as_vec3();
    let [right, down, forward] = View::axes_towards(axis, up(axis)).map(Vec3::as_dvec3);
    let place = |p: &Vec3| {
        let p = p.as_dvec3() - eye;
        let z = p.dot(forward);
        let (x, y) = (p.dot(right) / z, p.dot(down) / z);
        (z > 0.0 && x.abs() <= 1e3 && y.abs() <= 1e3).then_some([x, y, 1.0 / z])
    };
    points.iter().map(place).collect()
}

fn fitted(sets: [Option<Vec<ImagePoint>>; 2], radius: f64) -> Option<Extents> {
    let [blockers, receivers] = sets.each_ref().map(|set| set.as_ref().map(|s| s.iter().copied()));
    fit_extents(blockers, receivers, Spread { shadow: [radius; 2], ..Spread::default() })
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

fn fit_sun(direction: Vec3, angle: f32, size: u32, cover: &Cover) -> View {
    let direction = direction.normalize_or(Vec3::NEG_Y);
    let axes = View::axes_towards(direction, up(direction));
    let [right, down, forward] = axes.map(Vec3::as_dvec3);
    let eye = middle(cover.points());
    let depths = cover.points().map(|p| (p - eye).dot(forward));
    let (near, far) =
        depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(near, far), z| (near.min(z), far.max(z)));
    let (near, far) = if near <= far { (near, far) } else { (-1.0, 1.0) };
    let sets = [&cover.blockers, &cover.receivers].map(|points| {
        let place = |p: &Vec3| {
            let p = p.as_dvec3() - eye;
            [p.dot(right), p.dot(down), far - p.dot(forward)]
        };
        Some(points.iter().map(place).collect())
    });
    let radius = libm::tan(f64::from(angle).abs() * 0.5);
    let extents = fitted(sets, radius).unwrap_or([-1.0, -1.0, 1.0, 1.0]);
    // Receivers in the farthest plane still have a nearness, and the nearest blocker is drawn.
    let spare = 0.01 * (far - near).max(1e-3 * (extents[2] - extents[0])).max(1e-6);
    let depths = [(near - spare) as f32, (far + spare) as f32];
    let window = square(extents, size);
    View::orthographic_window(eye.as_vec3(), axes, window, size, size, depths)
}
