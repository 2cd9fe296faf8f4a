//! Gathers the triangles of a file into one scene.

use glam::{DMat3, DMat4, DVec3, Vec2, Vec3, Vec4};

use super::error::Fault;
use super::limits::Budget;
use crate::scene::Scene;

/// Triangles in the space of their node. Attributes that are absent are empty.
#[derive(Default)]
pub(super) struct Part {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) colors: Vec<Vec4>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Index into the materials of the scene.
    pub(super) material: u32,
}

/// A scene in the making, and what may still be spent on it.
pub(super) struct Builder {
    pub(super) scene: Scene,
    pub(super) budget: Budget,
    dropped: usize,
}

/// Beyond this distance squared lengths leave the range of f32.
const FARTHEST: f32 = 1e18;

impl Builder {
    pub(super) fn new(budget: Budget) -> Self {
        Self { scene: Scene::default(), budget, dropped: 0 }
    }

    /// A new object ID.
    pub(super) fn object(&mut self, name: String) -> Result<u32, Fault> {
        self.budget
            .memory(size_of::<String>() as u64 + name.len() as u64, "the names of objects")?;
        self.scene.object_names.push(name);
        u32::try_from(self.scene.object_names.len())
            .map_err(|_| Fault::TooLarge("the scene has more than 2^32 objects".into()))
    }

    /// Places the triangles of `part` into the world.
    pub(super) fn place(&mut self, part: &Part, world: &DMat4, id: u32) -> Result<(), Fault> {
        let count = part.positions.len();
        self.budget.memory(
            count as u64 * vertex_bytes(part) + part.triangles.len() as u64 * 20,
            "the triangles of the scene",
        )?;
        let base = self.scene.mesh.positions.len();
        let Ok(first) = u32::try_from(base) else { return Err(too_many_vertices()) };
        if u32::try_from(base + count).is_err() {
            return Err(too_many_vertices());
        }

        let positions = part.positions.iter();
        let placed = positions.map(|p| world.transform_point3(p.as_dvec3()).as_vec3());
        self.scene.mesh.positions.extend(placed);
        self.place_attributes(part, world, base);

        let mirrored = DMat3::from_mat4(*world).determinant() < 0.0;
        let before = self.scene.mesh.triangles.len();
        for &[a, b, c] in &part.triangles {
            let triangle = if mirrored { [a, c, b] } else { [a, b, c] }.map(|i| first + i);
            let near = |i: u32| {
                let p = self.scene.mesh.positions[i as usize];
                p.is_finite() && p.abs().max_element() <= FARTHEST
            };
            if triangle.into_iter().all(near) {
                self.scene.mesh.triangles.push(triangle);
            }
        }
        let drawn = self.scene.mesh.triangles.len();
        self.dropped += part.triangles.len() - (drawn - before);
        self.scene.mesh.ids.resize(drawn, id);
        self.scene.triangle_materials.resize(drawn, part.material);
        Ok(())
    }

    fn place_attributes(&mut self, part: &Part, world: &DMat4, base: usize) {
        let scene = &mut self.scene;
        let normal_from_local = cofactors(DMat3::from_mat4(*world));
        let normals = part.normals.iter().map(|n| {
            let n = (normal_from_local * n.as_dvec3()).normalize_or_zero().as_vec3();
            if n.is_finite() { n } else { Vec3::ZERO }
        });
        let count = part.positions.len();
        append(&mut scene.normals, normals, base, count, Vec3::ZERO);
        append(&mut scene.uvs, part.uvs.iter().copied(), base, count, Vec2::ZERO);
        append(&mut scene.colors, part.colors.iter().copied(), base, count, Vec4::ONE);
    }

    /// The finished scene.
    pub(super) fn finish(mut self) -> Result<Scene, Fault> {
        if self.dropped > 0 {
            let dropped = self.dropped;
            let text = format!("{dropped} triangles are not finite or too far out, and not drawn");
            if self.scene.mesh.triangles.is_empty() {
                return Err(Fault::Empty(text));
            }
            self.scene.warn(text);
        }
        if self.scene.mesh.triangles.is_empty() {
            let reasons = self.scene.warnings.iter().map(|w| format!("; {w}"));
            let text = "the scene has no triangles".to_owned();
            return Err(Fault::Empty(reasons.fold(text, |text, reason| text + &reason)));
        }
        let mesh = &self.scene.mesh;
        let has_area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
            (b - a).cross(c - a) != DVec3::ZERO
        };
        if !mesh.triangles.iter().any(has_area) {
            return Err(Fault::Empty("no triangle of the scene has an area".into()));
        }
        Ok(self.scene)
    }
}

fn too_many_vertices() -> Fault {
    Fault::TooLarge("the scene has more than 2^32 vertices".into())
}

fn vertex_bytes(part: &Part) -> u64 {
    let mut bytes = size_of::<Vec3>();
    bytes += if part.normals.is_empty() { 0 } else { size_of::<Vec3>() };
    bytes += if part.uvs.is_empty() { 0 } else { size_of::<Vec2>() };
    bytes += if part.colors.is_empty() { 0 } else { size_of::<Vec4>() };
    bytes as u64
}

/// Appends an attribute of `count` vertices after `base` earlier ones, some of which may lack it.
fn append<T: Clone>(
    all: &mut Vec<T>,
    part: impl ExactSizeIterator<Item = T>,
    base: usize,
    count: usize,
    fill: T,
) {
    if all.is_empty() && part.len() == 0 {
        return;
    }
    all.resize(base, fill.clone());
    all.extend(part);
    all.resize(base + count, fill);
}

/// What normals are multiplied by where positions are multiplied by `m`: the matrix of cofactors,
/// which is the inverse transpose times the determinant, turned so that a mirror keeps normals on
/// their side. Exists for singular matrices too: a flattened solid keeps the normals of its flat
/// sides, and the others become zero.
fn cofactors(m: DMat3) -> DMat3 {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if x.dot(y.cross(z)) < 0.0 { cofactors * -1.0 } else { cofactors }
}

#[cfg(test)]
mod tests {
    use super::super::limits::Limits;
    use super::*;

    fn placed(world: DMat4, normal: Vec3) -> (Vec3, Vec3) {
        let mut builder = Builder::new(Budget::new(&Limits::default()));
        let part = Part {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![normal; 3],
            triangles: vec![[0, 1, 2]],
            ..Part::default()
        };
        builder.place(&part, &world, 1).unwrap();
        let scene = builder.scene;
        let [a, b, c] = scene.mesh.triangles[0].map(|i| scene.mesh.positions[i as usize]);
        (scene.normals[0], (b - a).cross(c - a).normalize_or_zero())
    }

    #[test]
    fn normals_and_winding_agree_under_any_transform() {
        let shear = DMat4::from_cols_array(&[
            1.0, 0.0, 0.0, 0.0, 0.7, 1.0, 0.2, 0.0, 0.3, 0.4, 2.0, 0.0, 5.0, 6.0, 7.0, 1.0,
        ]);
        for world in [
            DMat4::IDENTITY,
            DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)),
            DMat4::from_scale(DVec3::splat(-3.0)),
            DMat4::from_rotation_x(2.0) * DMat4::from_scale(DVec3::new(1.0, -0.1, 9.0)),
            shear,
            shear * DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)),
        ] {
            let (normal, flat) = placed(world, Vec3::Z);
            assert!((normal - flat).length() < 1e-6, "{world:?}: {normal} {flat}");
        }
    }

    #[test]
    fn singular_transforms_have_no_nan() {
        let flat = DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0));
        assert_eq!(placed(flat, Vec3::Z).0, Vec3::ZERO);
        assert_eq!(placed(flat, Vec3::Y).0, Vec3::Y);
        assert_eq!(placed(DMat4::from_scale(DVec3::ZERO), Vec3::Y).0, Vec3::ZERO);
        assert_eq!(placed(DMat4::from_scale(DVec3::splat(1e-300)), Vec3::Y).0, Vec3::ZERO);
    }

    #[test]
    fn triangles_beyond_reach_are_dropped() {
        let mut builder = Builder::new(Budget::new(&Limits::default()));
        let far = [f32::NAN, f32::INFINITY, -f32::INFINITY, 1e19, f32::MAX];
        let mut positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        positions.extend(far.map(|x| Vec3::new(0.0, x, 0.0)));
        let mut triangles: Vec<_> = (0..far.len() as u32).map(|i| [0, 1, 3 + i]).collect();
        triangles.push([0, 1, 2]);
        let part = Part { positions, triangles, ..Part::default() };
        builder.place(&part, &DMat4::IDENTITY, 1).unwrap();
        let scene = builder.finish().unwrap();
        assert_eq!(scene.mesh.triangles, [[0, 1, 2]]);
        assert_eq!((scene.mesh.ids.len(), scene.triangle_materials.len()), (1, 1));
        assert!(scene.warnings[0].starts_with("5 triangles"));
    }
}
