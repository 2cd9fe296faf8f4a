//! Loads a scene from bytes. What comes out must hold together.

use renderer::load::{Format, Limits, load_bytes};

const LIMITS: Limits = Limits { max_triangles: 100_000, max_memory: 64 << 20 };

pub fn load(format: Format, bytes: &[u8]) {
    let scene = match load_bytes(format, bytes, &LIMITS) {
        Ok(scene) => scene,
        Err(error) => {
            let line = error.to_string();
            assert!(!line.is_empty() && !line.contains(char::is_control), "{line:?}");
            return;
        }
    };
    let mesh = &scene.mesh;
    assert!(!mesh.triangles.is_empty());
    for &i in mesh.triangles.iter().flatten() {
        assert!(mesh.positions[i as usize].is_finite());
        assert!(scene.normals.get(i as usize).is_none_or(|n| n.is_finite()));
    }
    assert_eq!(mesh.ids.len(), mesh.triangles.len());
    assert!(mesh.ids.iter().all(|&id| (1..=scene.object_names.len()).contains(&(id as usize))));
    assert_eq!(scene.triangle_materials.len(), mesh.triangles.len());
    assert!(scene.triangle_materials.iter().all(|&m| (m as usize) < scene.materials.len()));
    for length in [scene.normals.len(), scene.uvs.len(), scene.colors.len()] {
        assert!(length == 0 || length == mesh.positions.len());
    }
    for material in &scene.materials {
        assert!(material.base_color.is_finite() && material.emissive.is_finite());
        assert!(material.texture.is_none_or(|t| t < scene.textures.len()));
    }
    for texture in &scene.textures {
        assert_eq!(texture.texels.len(), texture.width as usize * texture.height as usize);
    }
    for light in &scene.lights {
        assert!(light.intensity.is_finite() && light.color.is_finite());
        assert!(light.light.center().is_none_or(|c| c.is_finite()));
    }
    assert!(scene.camera.is_none_or(|c| c.eye.is_finite() && c.eye != c.target));
    // Fitting and grounding hold up too.
    let mut scene = scene;
    scene.fit();
    scene.add_ground();
}
