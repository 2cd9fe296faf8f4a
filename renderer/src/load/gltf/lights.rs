//! Lights (KHR_lights_punctual) and cameras.
//!
//! The extension's lights have no size; `extras` give them one, of the node or else of the light
//! (where Blender exports custom properties to), in units of the node's own space:
//!
//! | extras | light |
//! |---|---|
//! | `radius` | a sphere around the node's origin |
//! | `length` | a line along the node's x axis, its middle at the origin |
//! | `width`, `height` | a rectangle in the node's x-y plane, its middle at the origin |
//! | `angle` | a sun of this angular diameter in radians |

use std::f32::consts::FRAC_PI_2;

use glam::{DMat3, DMat4, DVec3, Vec3};
use serde_json::Value;
use shadowmap_core::Light;

use super::super::error::quoted;
use super::json::{Camera, Light as JsonLight, Root};
use super::nodes::Placed;
use crate::scene::{CameraProjection, Scene, SceneCamera, SceneLight, SpotCone};

/// Adds the lights of the placed nodes, and the camera of the first that has one.
pub(super) fn read(root: &Root, placed: &[Placed], scene: &mut Scene) {
    for Placed { node, world } in placed {
        let json = &root.nodes[*node];
        if let Some(reference) = &json.extensions.light {
            let definition = &root.lights()[reference.light];
            let name = json.name.as_ref().or(definition.name.as_ref()).cloned().unwrap_or_default();
            let extras = [json.extras.as_ref(), definition.extras.as_ref()];
            match light(definition, extras, world) {
                Some(light) => scene.lights.push(SceneLight { name, ..light }),
                None => scene.warn(format!("the light {} is left out", quoted(&name))),
            }
        }
        if let (Some(index), None) = (json.camera, scene.camera) {
            scene.camera = camera(&root.cameras[index], world);
            if scene.camera.is_none() {
                scene.warn(format!("cameras[{index}] is left out"));
            }
        }
    }
}

/// `None` when its kind is unknown, or a number is out of range.
fn light(json: &JsonLight, extras: [Option<&Value>; 2], world: &DMat4) -> Option<SceneLight> {
    let place = |p: DVec3| world.transform_point3(p).as_vec3();
    let size = |name: &str| {
        let mut values = extras.into_iter().filter_map(|e| e?.get(name)?.as_f64());
        values.next().filter(|&size| size > 0.0)
    };
    let forward = direction(world, DVec3::NEG_Z)?;
    let shape = if json.kind == "directional" {
        let angle = size("angle").unwrap_or(0.0).min(std::f64::consts::PI);
        Light::Sun { direction: forward, angle: angle as f32 }
    } else if let Some(length) = size("length") {
        let half = DVec3::new(length * 0.5, 0.0, 0.0);
        Light::Linear { a: place(-half), b: place(half) }
    } else if let Some((width, height)) = size("width").zip(size("height")) {
        let vector = |v: DVec3| world.transform_vector3(v).as_vec3();
        Light::Rectangle {
            corner: place(DVec3::new(-width * 0.5, -height * 0.5, 0.0)),
            edge_u: vector(DVec3::X * width),
            edge_v: vector(DVec3::Y * height),
        }
    } else if let Some(radius) = size("radius") {
        let scale = DMat3::from_mat4(*world).determinant().abs().cbrt();
        Light::Sphere { center: place(DVec3::ZERO), radius: (radius * scale) as f32 }
    } else {
        Light::Point { position: place(DVec3::ZERO) }
    };
    let spot = match json.kind.as_str() {
        "directional" | "point" => None,
        "spot" => {
            let spot = json.spot.as_ref();
            let outer = spot.and_then(|s| s.outer_cone_angle).unwrap_or(FRAC_PI_2 as f64 / 2.0);
            let inner = spot.and_then(|s| s.inner_cone_angle).unwrap_or(0.0);
            let (inner, outer) = (inner as f32, (outer as f32).min(FRAC_PI_2));
            let in_order = 0.0 <= inner && inner < outer;
            Some(SpotCone { direction: forward, inner, outer }).filter(|_| in_order)
        }
        _ => return None,
    };
    let color = Vec3::from(json.color.unwrap_or([1.0; 3]).map(|c| c as f32));
    let intensity = json.intensity.unwrap_or(1.0) as f32;
    let finite = is_finite(&shape) && color.is_finite() && intensity.is_finite();
    let valid = finite && color.min_element() >= 0.0 && intensity >= 0.0;
    let light = SceneLight { name: String::new(), light: shape, color, intensity, spot };
    (valid && (json.kind != "spot" || spot.is_some())).then_some(light)
}

fn is_finite(light: &Light) -> bool {
    match *light {
        Light::Point { position } => position.is_finite(),
        Light::Sphere { center, radius } => center.is_finite() && radius.is_finite(),
        Light::Linear { a, b } => a.is_finite() && b.is_finite(),
        Light::Rectangle { corner, edge_u, edge_v } => {
            corner.is_finite() && edge_u.is_finite() && edge_v.is_finite()
        }
        // A sun's direction is finite because it is of unit length.
        _ => true,
    }
}

fn camera(json: &Camera, world: &DMat4) -> Option<SceneCamera> {
    let projection = match (&json.perspective, &json.orthographic) {
        (Some(perspective), _) => {
            let vertical_fov = perspective.yfov as f32;
            (0.0..std::f32::consts::PI).contains(&vertical_fov).then_some(())?;
            CameraProjection::Perspective { vertical_fov }
        }
        (None, Some(orthographic)) => {
            CameraProjection::Orthographic { height: 2.0 * orthographic.ymag.abs() as f32 }
        }
        (None, None) => return None,
    };
    let visible = match projection {
        CameraProjection::Perspective { vertical_fov } => vertical_fov > 0.0,
        CameraProjection::Orthographic { height } => height > 0.0 && height.is_finite(),
    };
    let eye = world.transform_point3(DVec3::ZERO);
    // As far away as the origin, so that rounding does not turn the camera.
    let target = eye + direction(world, DVec3::NEG_Z)?.as_dvec3() * eye.length().max(1.0);
    let (eye, target) = (eye.as_vec3(), target.as_vec3());
    let up = direction(world, DVec3::Y)?;
    (visible && eye.is_finite() && target != eye).then_some(SceneCamera {
        eye,
        target,
        up,
        projection,
    })
}

/// An axis of a node in the world, of unit length; `None` where the node has no such axis.
fn direction(world: &DMat4, axis: DVec3) -> Option<Vec3> {
    world.transform_vector3(axis).try_normalize().map(|d| d.as_vec3())
}
