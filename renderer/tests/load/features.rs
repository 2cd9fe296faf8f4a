//! What comes out of sound files.

use glam::{Vec2, Vec3, Vec4};
use renderer::load::{Format, Limits, load, load_bytes};
use renderer::scene::{AlphaMode, CameraProjection, Scene, SceneLight, Wrap};
use serde_json::json;
use shadowmap_core::Light;
use test_models::{MTL, OBJ, everything, png};

fn gltf(bytes: &[u8]) -> Scene {
    load_bytes(Format::Gltf, bytes, &Limits::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn corners(scene: &Scene, triangle: usize) -> [Vec3; 3] {
    scene.mesh.triangles[triangle].map(|i| scene.mesh.positions[i as usize])
}

#[test]
fn everything_of_gltf() {
    let scene = gltf(&everything().glb());
    assert_eq!(scene.warnings, ["points and lines are not drawn"]);
    assert_eq!(scene.object_names, ["child", "node 2", "node 3", "node 4"]);
    assert_eq!(scene.mesh.ids, [1, 1, 2, 2, 2, 2, 3, 4]);
    assert_eq!(corners(&scene, 1), [[2., 0., 0.], [4., 2., 0.], [2., 2., 0.]].map(Vec3::from));
    // The strip turns every other triangle.
    assert_eq!(corners(&scene, 2), [[0., 0., 10.], [2., 0., 10.], [0., 2., 10.]].map(Vec3::from));
    assert_eq!(corners(&scene, 3), [[2., 0., 10.], [2., 2., 10.], [0., 2., 10.]].map(Vec3::from));
    assert_eq!(corners(&scene, 4), [[2., 0., 10.], [2., 2., 10.], [0., 0., 10.]].map(Vec3::from));
    // The sparse triangle is turned by 90 degrees.
    let expected = [[0., 0., 0.], [0., 6., 0.], [-6., 0., 0.]].map(Vec3::from);
    for (found, expected) in corners(&scene, 6).into_iter().zip(expected) {
        assert!((found - expected).length() < 1e-5);
    }
    // The mirrored one keeps its front.
    assert_eq!(corners(&scene, 7), [[0., 0., 0.], [0., 2., 0.], [-2., 0., 0.]].map(Vec3::from));

    assert_eq!(scene.normals[0], Vec3::Z);
    assert_eq!(scene.normals[5], Vec3::ZERO);
    assert_eq!(scene.uvs[1], Vec2::new(2.25, 0.0));
    assert_eq!(scene.colors[0], Vec4::new(1.0, 0.0, 128.0 / 255.0, 1.0));
    assert_eq!(scene.colors[4], Vec4::ONE);
    assert_eq!(scene.triangle_materials, [0, 0, 1, 1, 1, 1, 1, 1]);
    let leaf = &scene.materials[0];
    assert_eq!(leaf.base_color, Vec4::new(1.0, 0.5, 0.25, 1.0));
    assert_eq!((leaf.alpha_mode, leaf.double_sided), (AlphaMode::Mask(0.25), true));
    assert_eq!(leaf.emissive, Vec3::new(2.0, 0.0, 0.0));
    let texture = &scene.textures[leaf.texture.unwrap()];
    assert_eq!((texture.width, texture.height), (2, 1));
    assert_eq!((texture.wrap, texture.nearest), ([Wrap::Clamp, Wrap::Mirror], true));
    assert_eq!(texture.texels, [[255, 255, 255, 255], [255, 0, 0, 128]]);
}

#[test]
fn lights_and_camera() {
    let scene = gltf(&everything().gltf());
    let SceneLight { name, light, color, intensity, .. } = &scene.lights[0];
    assert_eq!((name.as_str(), *intensity), ("bulb", 40.0));
    assert_eq!(*color, Vec3::new(1.0, 0.5, 0.25));
    assert_eq!(*light, Light::Sphere { center: Vec3::new(0.0, 5.0, 0.0), radius: 0.5 });
    let (a, b) = (Vec3::new(-2.0, 6.0, 0.0), Vec3::new(2.0, 6.0, 0.0));
    assert_eq!(scene.lights[1].light, Light::Linear { a, b });
    let corner = Vec3::new(-1.0, -0.5, 0.0);
    let (edge_u, edge_v) = (Vec3::X * 2.0, Vec3::Y);
    assert_eq!(scene.lights[2].light, Light::Rectangle { corner, edge_u, edge_v });
    let spot = scene.lights[2].spot.unwrap();
    assert_eq!((spot.direction, spot.inner, spot.outer), (Vec3::NEG_Z, 0.2, 0.6));
    assert_eq!(scene.lights[3].light, Light::Sun { direction: Vec3::NEG_Z, angle: 0.01 });
    let camera = scene.camera.unwrap();
    assert_eq!((camera.eye, camera.up), (Vec3::Z * 10.0, Vec3::Y));
    assert_eq!((camera.target - camera.eye).normalize(), Vec3::NEG_Z);
    assert_eq!(camera.projection, CameraProjection::Perspective { vertical_fov: 0.7 });
}

#[test]
fn binary_and_text_are_the_same() {
    let (glb, text) = (gltf(&everything().glb()), gltf(&everything().gltf()));
    assert_eq!(glb.mesh.positions, text.mesh.positions);
    assert_eq!(glb.textures, text.textures);
    assert_eq!(glb.lights, text.lights);
}

#[test]
fn one_node_has_an_object_per_primitive() {
    let mut file = everything();
    *file.at("/nodes/0/children") = json!([2]);
    let scene = gltf(&file.glb());
    assert_eq!(scene.object_names, ["node 2/0", "node 2/1"]);
    assert_eq!(scene.mesh.ids, [1, 1, 2, 2]);
}

#[test]
fn instances_are_repeated() {
    let mut file = everything();
    file.at("/nodes/0/children").as_array_mut().unwrap().push(11.into());
    file.at("/nodes").as_array_mut().unwrap().push(json!({ "mesh": 0 }));
    let scene = gltf(&file.glb());
    assert_eq!(scene.mesh.triangles.len(), 10);
    assert_eq!(corners(&scene, 8), [[0., 0., 0.], [2., 0., 0.], [2., 2., 0.]].map(Vec3::from));
}

#[test]
fn what_is_left_out_is_said_once() {
    let mut file = everything();
    for node in ["/nodes/1", "/nodes/2"] {
        file.at(node)["skin"] = 0.into();
        file.at(node)["extensions"] = json!({ "EXT_mesh_gpu_instancing": {} });
    }
    file.json["animations"] = json!([{ "nonsense": [] }]);
    file.at("/extensionsUsed").as_array_mut().unwrap().push("X_unheard_of".into());
    file.at("/meshes/0/primitives/0")["targets"] = json!([{}]);
    *file.at("/images/0") = json!({ "uri": "missing.png" });
    let mut warnings = gltf(&file.glb()).warnings;
    warnings.sort();
    let starts = [
        "animations",
        "extensions that are not supported: \"X_unheard_of\"",
        "instances",
        "morph targets",
        "points and lines",
        "skins",
        "textures[0] is left out",
    ];
    assert_eq!(warnings.len(), starts.len(), "{warnings:?}");
    for (warning, start) in warnings.iter().zip(starts) {
        assert!(warning.starts_with(start), "{warning}");
    }
}

#[test]
fn files_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mut file = everything();
    file.json["buffers"][0]["uri"] = "sub%20folder/the.bin".into();
    *file.at("/images/0") = json!({ "uri": "the.png" });
    std::fs::create_dir(at("sub folder")).unwrap();
    std::fs::write(at("sub folder/the.bin"), &file.binary).unwrap();
    std::fs::write(at("the.png"), png()).unwrap();
    std::fs::write(at("Scene.GLTF"), file.json.to_string()).unwrap();
    let scene = load(&at("Scene.GLTF"), &Limits::default()).unwrap();
    assert_eq!((scene.name.as_str(), scene.mesh.triangles.len()), ("Scene", 8));
    assert_eq!(scene.textures.len(), 1);
}

#[test]
fn everything_of_obj() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.obj"), OBJ).unwrap();
    std::fs::write(folder.path().join("colors.mtl"), MTL).unwrap();
    let scene = load(&folder.path().join("scene.obj"), &Limits::default()).unwrap();
    assert_eq!(scene.warnings, ["points and lines are not drawn"]);
    assert_eq!(scene.object_names, ["first", "first/group", "second"]);
    assert_eq!(scene.mesh.ids, [1, 2, 2, 2, 2, 2, 3]);
    let color = |t: usize| scene.materials[scene.triangle_materials[t] as usize].base_color;
    assert_eq!(color(0), Vec4::new(1.0, 0.0, 0.0, 1.0));
    assert_eq!(color(3), Vec4::new(0.0, 0.0, 1.0, 0.5));
    assert_eq!(corners(&scene, 0), [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.]].map(Vec3::from));
    assert!(scene.mesh.triangles[0].iter().all(|&i| scene.normals[i as usize] == Vec3::Z));
    // Smoothing is off for the last.
    assert!(scene.mesh.triangles[6].iter().all(|&i| scene.normals[i as usize] == Vec3::ZERO));
}

#[test]
fn obj_without_normals_is_smooth_up_to_its_edges() {
    // A tent of two slopes: gentle, it is smooth along the ridge; steep, it has an edge. Open
    // sheets may have faces that are wound the other way.
    for (height, second, smooth) in [
        (0.2, "3 4 6 5", true),
        (0.2, "5 6 4 3", true),
        (3.0, "3 4 6 5", false),
        (3.0, "5 6 4 3", false),
    ] {
        let text = format!(
            "v -1 0 0\nv -1 0 1\nv 0 {height} 0\nv 0 {height} 1\nv 1 0 0\nv 1 0 1\n\
             f 1 2 4 3\nf {second}\n"
        );
        let scene = load_bytes(Format::Obj, text.as_bytes(), &Limits::default()).unwrap();
        let mut ridge = (0..scene.normals.len())
            .filter(|&i| scene.mesh.positions[i].x == 0.0)
            .map(|i| scene.normals[i]);
        assert_eq!(ridge.all(|n| (n.abs() - Vec3::Y).length() < 1e-6), smooth);
    }
}

#[test]
fn missing_materials_are_a_warning() {
    let scene = load_bytes(Format::Obj, OBJ.as_bytes(), &Limits::default()).unwrap();
    assert_eq!(scene.mesh.triangles.len(), 7);
    assert!(scene.warnings.iter().any(|w| w.starts_with("materials are left out")));
}

#[test]
fn limits() {
    let bytes = everything().glb();
    for (limits, name) in [
        (Limits { max_triangles: 7, ..Limits::default() }, "7 triangles"),
        (Limits { max_memory: 3000, ..Limits::default() }, "memory"),
    ] {
        let error = load_bytes(Format::Gltf, &bytes, &limits).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
    let limits = Limits { max_triangles: 6, ..Limits::default() };
    assert!(load_bytes(Format::Obj, OBJ.as_bytes(), &limits).is_err());
}
