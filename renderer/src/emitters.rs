//! Lights as the shading sees them: a few points each, whose light adds up.

use glam::Vec3;
use shadowmap_core::Light;

use crate::scene::{Bounds, SceneLight};

/// Brightness of a white surface that faces all lights at once, in the unit of the picture, where
/// 1 is white.
const EXPOSURE: f32 = 1.12;

/// A point or a direction that light comes from. A receiver at P with unit normal n gets
/// `color * cone² * max(0, n . l) / |l|³` with `l = place.xyz - place.w * P` and
/// `cone = clamp(cone_scale * cos + cone_offset, 0, 1)`, cos between `axis` and -l.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// A point (w = 1) or a unit direction towards the light (w = 0).
    pub place: [f32; 4],
    /// Linear RGB.
    pub color: Vec3,
    /// The way a spot light shines, of unit length.
    pub axis: Vec3,
    /// Falloff towards the edge of a spot light's cone; 0 without one.
    pub cone_scale: f32,
    /// Falloff towards the edge of a spot light's cone; 1 without one.
    pub cone_offset: f32,
}

/// Appends the points of one light; their brightness times `exposure` adds up to the light's.
pub fn push_emitters(light: &SceneLight, exposure: f32, emitters: &mut Vec<Emitter>) {
    let (cone_scale, cone_offset, axis) = light.spot.map_or((0.0, 1.0, Vec3::ZERO), |cone| {
        let [inner, outer] = [cone.inner, cone.outer].map(|a| libm::cos(f64::from(a)) as f32);
        let scale = 1.0 / (inner - outer).max(1e-3);
        (scale, -outer * scale, cone.direction)
    });
    let color = light.color * light.intensity * exposure;
    let mut push = |place: [f32; 4], weight: f32| {
        emitters.push(Emitter { place, color: color * weight, axis, cone_scale, cone_offset });
    };
    let at = |p: Vec3| [p.x, p.y, p.z, 1.0];
    match light.light {
        Light::Sun { direction, .. } => {
            let to_light = -direction.normalize_or(Vec3::NEG_Y);
            push([to_light.x, to_light.y, to_light.z, 0.0], 1.0);
        }
        Light::Linear { a, b } => {
            for (t, weight) in GAUSS {
                push(at(a + (b - a) * t), weight);
            }
        }
        Light::Triangle { a, b, c } => {
            // Hammer's three-point rule, exact for polynomials of degree 2.
            for [s, t] in [[1.0 / 6.0, 1.0 / 6.0], [2.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 2.0 / 3.0]] {
                push(at(a + (b - a) * s + (c - a) * t), 1.0 / 3.0);
            }
        }
        Light::Rectangle { corner, edge_u, edge_v } => {
            for (s, weight_u) in GAUSS {
                for (t, weight_v) in GAUSS {
                    push(at(corner + edge_u * s + edge_v * t), weight_u * weight_v);
                }
            }
        }
        other => push(at(other.center().unwrap_or(Vec3::ZERO)), 1.0),
    }
}

/// Gauss's quadrature with three points on \[0, 1\]: place and weight.
const GAUSS: [(f32, f32); 3] =
    [(0.112_701_66, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_35, 5.0 / 18.0)];

/// The factor on all lights that makes a white surface in the middle of the scene, facing the
/// light, come out white: lights from files are in candela or lux, and some are a thousand
/// times others.
#[must_use]
pub fn exposure<'a>(lights: impl Iterator<Item = &'a SceneLight>, bounds: Option<Bounds>) -> f32 {
    let middle = bounds.map_or(Vec3::ZERO, |bounds| bounds.center());
    let extent = bounds.map_or(1.0, |bounds| bounds.extent().length());
    let arriving = |light: &SceneLight| {
        let color = light.color * light.intensity;
        let brightest = color.max_element();
        match light.light.center() {
            // A light in the middle of the scene lights what is around it.
            Some(center) => brightest / center.distance_squared(middle).max(0.04 * extent * extent),
            None => brightest,
        }
    };
    // Not all lights fall on one surface: their squares are summed.
    let squares = lights.map(arriving).filter(|value| value.is_finite()).map(|value| value * value);
    let exposure = EXPOSURE / squares.sum::<f32>().sqrt();
    if exposure.is_finite() { exposure } else { 1.0 }
}
