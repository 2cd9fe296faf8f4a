//! The built-in scenes hold the numbers that measurements elsewhere rely on.

use glam::{DVec3, Vec3};
use renderer::builtin;
use shadowmap_core::Light;

#[test]
fn triangles_and_objects_are_as_published() {
    for (name, triangles, objects) in
        [("torus", 4098, 2), ("blocker", 4, 2), ("crowded", 51602, 22), ("grille", 110, 10)]
    {
        let scene = builtin::scene(name).unwrap();
        assert_eq!(scene.name, name);
        assert_eq!(scene.mesh.triangles.len(), triangles, "{name}");
        assert_eq!(scene.object_names.len(), objects, "{name}");
        assert_eq!(scene.object_names[0], "ground");
        assert_eq!(scene.mesh.ids[0], 1);
        assert_eq!(*scene.mesh.ids.last().unwrap() as usize, objects, "{name}");
        assert!(scene.mesh.ids.is_sorted(), "{name}");
        assert_eq!(scene.normals.len(), scene.mesh.positions.len(), "{name}");
        assert_eq!(scene.triangle_materials.len(), triangles, "{name}");
    }
    assert!(builtin::scene("no such scene").is_none());
}

#[test]
fn every_named_scene_has_a_camera_and_lights() {
    for name in builtin::NAMES {
        let scene = builtin::scene(name).unwrap();
        assert!(scene.camera.is_some(), "{name}");
        assert_eq!(scene.lights.len(), 2, "{name}");
        let positions = &scene.mesh.positions;
        assert!(scene.mesh.triangles.iter().flatten().all(|&i| (i as usize) < positions.len()));
        assert!(positions.iter().all(|p| p.is_finite()), "{name}");
    }
}

#[test]
fn the_torus_lies_on_its_tilted_surface() {
    let scene = builtin::scene("torus").unwrap();
    // The axis of a torus tilted about x by 30 degrees: (0, cos 30, sin 30).
    let axis = DVec3::new(0.0, 0.75f64.sqrt(), 0.5);
    let center = DVec3::new(0.0, 1.5, 0.0);
    for &p in &scene.mesh.positions[4..] {
        let offset = p.as_dvec3() - center;
        let along = offset.dot(axis);
        let ring = (offset - axis * along).length() - 1.0;
        assert!((along.hypot(ring) - 0.35).abs() < 1e-6, "{p}");
    }
    // Vertex (0, 0): u = v = 0.
    assert_eq!(scene.mesh.positions[4], Vec3::new(1.35, 1.5, 0.0));
}

#[test]
fn yaw_turns_z_towards_x() {
    // The second box of `crowded`: half extents (0.4, 0.5, 0.3), yaw 30.
    let scene = builtin::scene("crowded").unwrap();
    let first = scene.mesh.ids.iter().position(|&id| id == 6).unwrap();
    assert_eq!(scene.object_names[5], "box 2");
    let vertices = scene.mesh.triangles[first..first + 12].iter().flatten();
    let (sin, cos) = (0.5, 0.75f64.sqrt());
    let corner = DVec3::new(0.4 * cos + 0.3 * sin, 0.5, -0.4 * sin + 0.3 * cos);
    let wanted = (DVec3::new(-1.5, 0.5, 2.6) + corner).as_vec3();
    assert!(vertices.into_iter().any(|&i| scene.mesh.positions[i as usize] == wanted));
}

#[test]
fn lights_stand_where_the_table_says() {
    let lights = |name: &str| -> Vec<Light> {
        builtin::scene(name).unwrap().lights.into_iter().map(|light| light.light).collect()
    };
    let linear = |ax, bx, y, z| Light::Linear { a: Vec3::new(ax, y, z), b: Vec3::new(bx, y, z) };
    let disc = |x, y, z, radius| Light::Sphere { center: Vec3::new(x, y, z), radius };
    assert_eq!(lights("torus"), [disc(1.5, 6.0, 1.5, 0.5), linear(0.5, 2.5, 6.0, 1.5)]);
    assert_eq!(lights("blocker"), [linear(-1.0, 1.0, 4.0, 0.0), disc(0.0, 4.0, 0.0, 0.5)]);
    assert_eq!(lights("crowded"), [disc(1.5, 8.0, 1.5, 0.5), linear(0.5, 2.5, 8.0, 1.5)]);
    assert_eq!(lights("grille"), [linear(-1.0, 1.0, 4.0, 0.0), disc(0.0, 4.0, 0.0, 0.3)]);
}
