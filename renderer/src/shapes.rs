//! The solids that the built-in scenes are made of.
//!
//! Vertices are computed in double precision, with trigonometry from `libm`, and rounded once,
//! so that a scene is the same to the bit on every machine. Triangles wind counter-clockwise
//! seen from outside.

use glam::{DVec3, Vec3};

/// A solid's vertices and triangles.
#[derive(Clone, Debug, Default)]
pub struct Solid {
    /// Positions in metres.
    pub positions: Vec<Vec3>,
    /// Unit normals of a smooth solid, as many as positions; empty for a faceted one.
    pub normals: Vec<Vec3>,
    /// Three indices into `positions` each.
    pub triangles: Vec<[u32; 3]>,
}

/// A rotation about the y axis by `degrees`: z turns towards x.
#[must_use]
pub fn yaw(degrees: f64, p: DVec3) -> DVec3 {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    DVec3::new(p.x * cos + p.z * sin, p.y, -p.x * sin + p.z * cos)
}

/// A rotation about the x axis by `degrees`: y turns towards z.
#[must_use]
pub fn pitch(degrees: f64, p: DVec3) -> DVec3 {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    DVec3::new(p.x, p.y * cos - p.z * sin, p.y * sin + p.z * cos)
}

/// The square |x|, |z| <= `half` at height 0, facing up.
#[must_use]
pub fn ground(half: f64) -> Solid {
    rectangle(DVec3::ZERO, half, half)
}

/// A horizontal rectangle of half sides `half_x` and `half_z` around `center`, facing up.
#[must_use]
pub fn rectangle(center: DVec3, half_x: f64, half_z: f64) -> Solid {
    let corner = |sx: f64, sz: f64| (center + DVec3::new(sx * half_x, 0.0, sz * half_z)).as_vec3();
    Solid {
        positions: vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)],
        normals: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

/// A torus of major radius `major` and minor radius `minor` around the y axis, rotated about x by
/// `tilt` and then about y by `yaw_degrees`, of `nu` cells around and `nv` across.
#[must_use]
pub fn torus(
    center: DVec3,
    [major, minor]: [f64; 2],
    [tilt, yaw_degrees]: [f64; 2],
    [nu, nv]: [u32; 2],
) -> Solid {
    use core::f64::consts::TAU;
    tube(nu, nv, |i, j| {
        let (sin_u, cos_u) = libm::sincos(TAU * f64::from(i) / f64::from(nu));
        let (sin_v, cos_v) = libm::sincos(TAU * f64::from(j) / f64::from(nv));
        let ring = major + minor * cos_v;
        let p = DVec3::new(ring * cos_u, minor * sin_v, ring * sin_u);
        let normal = DVec3::new(cos_v * cos_u, sin_v, cos_v * sin_u);
        [yaw(yaw_degrees, pitch(tilt, p)) + center, yaw(yaw_degrees, pitch(tilt, normal))]
    })
}

/// A closed tube of `nu` cells along and `nv` around; `vertex(i, j)` gives the
/// position and the unit normal of its corners.
#[must_use]
pub fn tube(nu: u32, nv: u32, vertex: impl Fn(u32, u32) -> [DVec3; 2]) -> Solid {
    let mut solid = Solid::default();
    for i in 0..nu {
        for j in 0..nv {
            let [position, normal] = vertex(i, j);
            solid.positions.push(position.as_vec3());
            solid.normals.push(normal.as_vec3());
            let at = |i: u32, j: u32| (i % nu) * nv + j % nv;
            let (p00, p01, p11, p10) = (at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
            solid.triangles.push([p00, p01, p11]);
            solid.triangles.push([p00, p11, p10]);
        }
    }
    solid
}

/// A box of half extents `half` around `center`, rotated about y.
#[must_use]
pub fn cuboid(center: DVec3, half: DVec3, yaw_degrees: f64) -> Solid {
    let corner = |index: u32| {
        let sign = |bit: u32| if index >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let p = DVec3::new(sign(0) * half.x, sign(1) * half.y, sign(2) * half.z);
        (yaw(yaw_degrees, p) + center).as_vec3()
    };
    // Corner index bits are x, y, z; each face counter-clockwise from outside.
    const FACES: [[u32; 4]; 6] =
        [[1, 3, 7, 5], [0, 4, 6, 2], [2, 6, 7, 3], [0, 1, 5, 4], [4, 5, 7, 6], [0, 2, 3, 1]];
    Solid {
        positions: (0..8).map(corner).collect(),
        normals: Vec::new(),
        triangles: FACES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

/// A sphere of 64 x 32 cells with its poles on the y axis.
#[must_use]
pub fn sphere(center: DVec3, radius: f64) -> Solid {
    use core::f64::consts::{PI, TAU};
    const AROUND: u32 = 64;
    const DOWN: u32 = 32;
    let mut solid = Solid::default();
    let mut vertex = |direction: DVec3| {
        solid.positions.push((center + radius * direction).as_vec3());
        solid.normals.push(direction.as_vec3());
    };
    vertex(DVec3::Y);
    for j in 1..DOWN {
        let (sin_theta, cos_theta) = libm::sincos(PI * f64::from(j) / f64::from(DOWN));
        for i in 0..AROUND {
            let (sin_phi, cos_phi) = libm::sincos(TAU * f64::from(i) / f64::from(AROUND));
            vertex(DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi));
        }
    }
    vertex(-DVec3::Y);
    let bottom = solid.positions.len() as u32 - 1;
    let ring = |j: u32, i: u32| 1 + (j - 1) * AROUND + i % AROUND;
    for i in 0..AROUND {
        solid.triangles.push([0, ring(1, i + 1), ring(1, i)]);
        for j in 1..DOWN - 1 {
            let [a, b] = [ring(j, i), ring(j, i + 1)];
            let [c, d] = [ring(j + 1, i), ring(j + 1, i + 1)];
            solid.triangles.push([a, b, d]);
            solid.triangles.push([a, d, c]);
        }
        solid.triangles.push([ring(DOWN - 1, i), ring(DOWN - 1, i + 1), bottom]);
    }
    solid
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the signed volume: positive when triangles wind counter-clockwise from outside.
    fn volume(solid: &Solid) -> f64 {
        let corner = |i: u32| solid.positions[i as usize].as_dvec3();
        solid
            .triangles
            .iter()
            .map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0)
            .sum()
    }

    #[test]
    fn solids_are_closed_and_face_outwards() {
        use core::f64::consts::PI;
        let cuboid = cuboid(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.5, 1.0, 1.5), 30.0);
        assert_eq!(cuboid.triangles.len(), 12);
        assert!((volume(&cuboid) - 6.0).abs() < 1e-5);
        let sphere = sphere(DVec3::new(-1.0, 0.5, 0.0), 0.5);
        assert_eq!(sphere.triangles.len(), 3968);
        let exact = 4.0 / 3.0 * PI * 0.125;
        assert!((volume(&sphere) / exact - 1.0).abs() < 0.01);
        let torus = torus(DVec3::new(0.0, 1.5, 0.0), [1.0, 0.35], [30.0, 0.0], [64, 32]);
        assert_eq!(torus.triangles.len(), 4096);
        let exact = 2.0 * PI * PI * 0.35 * 0.35;
        assert!((volume(&torus) / exact - 1.0).abs() < 0.02);
        for solid in [cuboid, sphere, torus] {
            let mut edges = std::collections::HashMap::new();
            for [a, b, c] in solid.triangles {
                for (p, q) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((p.min(q), p.max(q))).or_insert(0) += if p < q { 1 } else { -1 };
                }
            }
            assert!(edges.values().all(|&balance| balance == 0), "an edge has one side only");
        }
    }
}
