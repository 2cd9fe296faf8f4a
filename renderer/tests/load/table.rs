//! Public models against what independent readers found in them.

use glam::Vec3;
use renderer::load::{Fault, Limits, load};
use renderer::scene::Scene;

/// File, triangles, objects, corners of the bounding box.
type Row = (&'static str, usize, usize, [f32; 3], [f32; 3]);

#[rustfmt::skip]
#[expect(clippy::approx_constant)] // A polygon that happens to end at y = 3.142.
const TABLE: &[Row] = &[
    ("spot.obj", 5856, 1, [-0.472, -0.737, -0.669], [0.472, 0.954, 1.049]),
    ("teapot.obj", 6320, 1, [-1.905, -1.0, -1.27], [2.18, 1.0, 1.27]),
    ("cornell_box.obj", 34, 7, [0.0, 0.0, 0.0], [556.0, 548.8, 559.2]),
    ("folding_chair/foldingChair.obj", 3480, 2, [-18.677, 0.288, -21.654], [18.474, 47.403, 17.527]),
    ("orchids/orchids.obj", 44830, 32, [-12.236, 0.0, -18.168], [18.894, 57.444, 17.107]),
    ("flight_helmet.glb", 94722, 6, [-0.204, 0.0, -0.172], [0.163, 0.716, 0.2]),
    ("home_theater/home-theater.gltf", 7915, 20, [-3.022, -1.517, -4.518], [3.051, 1.8, 2.587]),
    ("garage/garage.gltf", 11358, 17, [-3.43, -0.048, -3.483], [3.348, 2.928, 4.066]),
    ("camp/camp.gltf", 6285, 12, [-10.072, -3.378, -9.072], [11.545, 7.714, 13.54]),
    ("dungeon_hall.glb", 27690, 49, [-9.0, -1.05, -7.13], [9.0, 4.0, 7.25]),
    ("kenney_character.glb", 550, 6, [-0.6, 0.0, -0.324], [0.6, 1.1, 0.311]),
    ("three_storey_building_noindex.glb", 72, 3, [-23.207, 0.0, 0.0], [32.873, 9.0, 63.361]),
    ("mode5_strips.gltf", 2786, 54, [-18.506, 1.778, 15.686], [38.644, 66.314, 91.804]),
    ("many_cubes/many-cubes.gltf", 6012, 501, [-3.779, -3.896, -4.02], [4.785, 4.466, 4.322]),
    ("alpha_blend_modes.glb", 61, 9, [-4.3, -0.1, -0.75], [4.3, 2.3, 0.55]),
    ("instanced_teapots/24_gpu_instancing.gltf", 8066, 3, [-339.411, 0.0, -339.411], [339.411, 4.095, 339.411]),
    ("features/concave_polygon.obj", 64, 1, [-1.146, 1.658, 1.606], [-1.146, 3.142, 3.09]),
    ("features/cubes_point_light.glb", 36, 3, [-4.284, -1.938, -2.994], [4.603, 3.591, 3.639]),
    ("features/layouts.glb", 4820, 7, [-6.0, 0.0, -6.0], [6.0, 2.8, 6.0]),
    ("features/sparse_accessors.gltf", 4108, 3, [-4.5, 0.0, -2.0], [7.0, 1.2, 2.0]),
    ("features/transforms.glb", 294, 16, [-8.0, 0.0, -8.0], [8.0, 4.578, 8.0]),
    ("compressed/meshopt-fallback.gltf", 60, 2, [-1.0, -1.0, -1.0], [1.0, 3.712, 1.0]),
];

#[test]
fn public_models() {
    let Some(folder) = test_models::public_models() else { return };
    let square = |n| {
        let name: &str =
            Box::leak(format!("primitive_modes/Mesh_PrimitiveMode_{n:02}.gltf").into());
        (name, 2, 1, [-0.5, -0.5, 0.0], [0.5, 0.5, 0.0])
    };
    let squares: Vec<Row> = [4, 5, 6, 11, 12, 13, 14, 15].map(square).into();
    for &(name, triangles, objects, min, max) in TABLE.iter().chain(&squares) {
        let scene = match load(&folder.join(name), &Limits::default()) {
            Ok(scene) => scene,
            Err(e) => panic!("{e}"),
        };
        println!("{name}: {:?}", scene.warnings);
        check_consistency(name, &scene);
        assert_eq!(scene.mesh.triangles.len(), triangles, "{name}");
        assert_eq!(scene.object_names.len(), objects, "{name}: {:?}", scene.object_names);
        let bounds = scene.bounds().unwrap();
        for (found, expected) in [(bounds.min, min), (bounds.max, max)] {
            assert!((found - Vec3::from(expected)).abs().max_element() < 6e-4, "{name}: {found}");
        }
    }
}

fn check_consistency(name: &str, scene: &Scene) {
    let vertices = scene.mesh.positions.len();
    let triangles = scene.mesh.triangles.len();
    assert_eq!(scene.mesh.ids.len(), triangles, "{name}");
    assert_eq!(scene.triangle_materials.len(), triangles, "{name}");
    for length in [scene.normals.len(), scene.uvs.len(), scene.colors.len()] {
        assert!(length == 0 || length == vertices, "{name}");
    }
    assert!(scene.mesh.triangles.iter().flatten().all(|&i| (i as usize) < vertices), "{name}");
    assert!(scene.normals.iter().all(|n| n.is_finite()), "{name}");
    assert!(scene.triangle_materials.iter().all(|&m| (m as usize) < scene.materials.len()));
    assert!(scene.materials.iter().all(|m| m.texture.is_none_or(|t| t < scene.textures.len())));
    assert!(
        scene.mesh.ids.iter().all(|&id| (1..=scene.object_names.len()).contains(&(id as usize)))
    );
}

#[test]
fn points_and_lines_are_nothing_to_render() {
    let Some(folder) = test_models::public_models() else { return };
    for n in [0, 1, 2, 3, 7, 8, 9, 10] {
        let name = format!("primitive_modes/Mesh_PrimitiveMode_{n:02}.gltf");
        let error = load(&folder.join(&name), &Limits::default()).unwrap_err();
        println!("{error}");
        assert!(matches!(error.fault, Fault::Empty(_)), "{error}");
    }
}

#[test]
fn compressed_models_are_refused_by_name() {
    let Some(folder) = test_models::public_models() else { return };
    for (name, extension) in [
        ("BoxDraco.gltf", "KHR_draco_mesh_compression"),
        ("DenseSphere_draco.glb", "KHR_draco_mesh_compression"),
        ("BoxMeshopt.glb", "EXT_meshopt_compression"),
    ] {
        let error = load(&folder.join("compressed").join(name), &Limits::default()).unwrap_err();
        println!("{error}");
        assert!(matches!(error.fault, Fault::Unsupported(_)), "{error}");
        assert!(error.to_string().contains(extension), "{error}");
    }
}

#[test]
fn negative_models_end_in_one_line() {
    let Some(folder) = test_models::public_models() else { return };
    let mut files = 0;
    for entry in std::fs::read_dir(folder.join("negative")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "bin") {
            continue;
        }
        let error = load(&path, &Limits::default()).unwrap_err().to_string();
        let name = path.file_name().unwrap().to_str().unwrap();
        println!("{}", error.replace(folder.to_str().unwrap(), ""));
        assert!(error.contains(name) && !error.contains('\n'), "{error}");
        files += 1;
    }
    assert_eq!(files, 24);
}

#[test]
fn concave_polygon_keeps_its_hole() {
    let Some(folder) = test_models::public_models() else { return };
    let path = folder.join("features/concave_polygon.obj");
    let mesh = load(&path, &Limits::default()).unwrap().mesh;
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).length() * 0.5
    };
    let total: f32 = mesh.triangles.iter().map(area).sum();
    assert!((total - 0.2455).abs() < 1e-4, "{total}");
}
