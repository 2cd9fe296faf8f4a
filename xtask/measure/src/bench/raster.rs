//! The rasterizer: depth and ID maps of a full-screen quad, a torus and a sphere of a million
//! triangles, against the plain version; three maps of a linear light in one pass; growth.

use std::f64::consts::{PI, TAU};

use glam::Vec3;
use linear_light::SampleViews;
use raster::{DepthBuffer, Payload, Rasterizer, draw_plain};
use renderer::scene::TriangleMesh;
use shadowmap_core::{Level, Threads, View, Window};

use super::{Bench, Case, Group, Variant, count, on, setup};

/// Nearness and ID of a texel.
const BYTES_PER_TEXEL: f64 = 8.0;

/// The cases of this part.
pub fn cases(quick: bool) -> Vec<Case> {
    let sizes: &[u32] = if quick { &[256, 1024] } else { &[256, 512, 1024, 2048] };
    let mut cases = Vec::new();
    for (name, mesh, degrees) in [
        ("quad", quad as fn() -> TriangleMesh, 60.0),
        ("torus", torus, 90.0),
        ("sphere 1M", million, 60.0),
    ] {
        for &size in sizes {
            cases.push(Case::new(1, move |bench| levels(bench, name, &mesh(), degrees, size)));
        }
    }
    cases.push(Case::new(1, |bench| linear_light(bench, &million())));
    let rings: &[u32] = if quick { &[32, 256] } else { &[32, 64, 128, 256, 512, 1024, 2048] };
    for &ring in rings {
        let triangles = f64::from(ring) * f64::from(ring);
        let name = format!("growth with triangles: {triangles}");
        cases.push(Case::new(1, move |bench| {
            growth(bench, name, ("triangles", triangles), &sphere(ring, ring / 2), 60.0, 1024);
        }));
    }
    for size in [256, 512, 1024, 2048, 4096] {
        let texels = f64::from(size) * f64::from(size);
        let name = format!("growth with texels: {texels}");
        cases.push(Case::new(1, move |bench| {
            growth(bench, name, ("texels", texels), &torus(), 90.0, size);
        }));
    }
    cases
}

/// The light's view of a scene.
fn view(degrees: f32, size: u32) -> View {
    let (eye, target) = (Vec3::new(1.5, 6.0, 1.5), Vec3::ZERO);
    View::perspective(eye, target, Vec3::NEG_Z, degrees.to_radians(), size, size, 0.1)
}

/// The plain version, every level on one thread, and the best level on two.
fn levels(bench: &mut Bench, name: &str, mesh: &TriangleMesh, degrees: f32, size: u32) {
    let view = view(degrees, size);
    let mesh = mesh.as_mesh();
    let mut expected = DepthBuffer::new(size, size);
    draw_plain(&view, &mesh, None, Payload::ObjectId, expected.target());
    let mut plain = expected.clone();
    let bytes = BYTES_PER_TEXEL * f64::from(size) * f64::from(size);
    let plainly = || {
        draw_plain(&view, &mesh, None, Payload::ObjectId, plain.target());
    };
    let mut variants = vec![Variant::new("plain", plainly).moving(bytes)];
    let one_thread = Level::available().map(|level| (level, Threads::One));
    for (level, threads) in one_thread.chain([(Level::detect(), Threads::Pool)]) {
        let mut rasterizer = Rasterizer::new(level, threads);
        let mut map = DepthBuffer::new(size, size);
        let mut draw = move |map: &mut DepthBuffer| {
            rasterizer.draw(&view, &mesh, Payload::ObjectId, map.target());
        };
        on(threads, || draw(&mut map));
        let name = level.kind().name();
        assert!(map == expected, "{name} differs from the plain version");
        let name = format!("{name}, {}", count(threads));
        variants.push(Variant::on(threads, name, move || draw(&mut map)).moving(bytes));
    }
    let work = if name == "quad" {
        (f64::from(size * size), "pixels")
    } else {
        (mesh.triangles.len() as f64, "triangles")
    };
    bench.compare(Group {
        name: format!("{name} {size}"),
        x: Some(("map side, texels", f64::from(size))),
        work: Some(work),
        variants,
    });
}

/// One map against three, the samples of a linear light of 2 metres.
fn linear_light(bench: &mut Bench, mesh: &TriangleMesh) {
    let size = 1024;
    let mesh = mesh.as_mesh();
    let (from, to) = (Vec3::new(0.5, 6.0, 1.5), Vec3::new(2.5, 6.0, 1.5));
    // As wide as the views from one place, around where all three see the sphere.
    let window = Window { left: -0.82, right: 0.334, top: -0.577, bottom: 0.577 };
    let light = SampleViews::new(from, to, 3, -from, window, [size; 2], 0.1);
    let views = light.views();
    let mut one = DepthBuffer::new(size, size);
    let [mut a, mut b, mut c] = [(); 3].map(|()| DepthBuffer::new(size, size));
    let mut rasterizers = [(); 2].map(|()| Rasterizer::new(Level::detect(), Threads::One));
    let [single, many] = &mut rasterizers;
    many.draw_many(views, &mesh, Payload::ObjectId, &mut [a.target(), b.target(), c.target()]);
    for (view, map) in views.iter().zip([&a, &b, &c]) {
        draw_plain(view, &mesh, None, Payload::ObjectId, one.target());
        assert!(*map == one, "a map of a linear light differs from the plain version");
    }
    bench.compare(Group {
        name: "sphere 1M, maps of a linear light".to_owned(),
        x: None,
        work: Some((mesh.triangles.len() as f64, "triangles")),
        variants: vec![
            Variant::new("1 map", || {
                single.draw(&views[1], &mesh, Payload::ObjectId, one.target());
            }),
            Variant::new("3 maps", || {
                let mut targets = [a.target(), b.target(), c.target()];
                many.draw_many(views, &mesh, Payload::ObjectId, &mut targets);
            }),
        ],
    });
}

/// One point of a growth curve.
fn growth(
    bench: &mut Bench,
    name: String,
    x: (&'static str, f64),
    mesh: &TriangleMesh,
    degrees: f32,
    size: u32,
) {
    let (view, mesh) = (view(degrees, size), mesh.as_mesh());
    let mut expected = DepthBuffer::new(size, size);
    draw_plain(&view, &mesh, None, Payload::ObjectId, expected.target());
    let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
    let mut map = DepthBuffer::new(size, size);
    rasterizer.draw(&view, &mesh, Payload::ObjectId, map.target());
    assert!(map == expected, "{name}: differs from the plain version");
    bench.compare(Group {
        name,
        x: Some(x),
        work: Some((x.1, x.0)),
        variants: vec![Variant::new("1 thread", || {
            rasterizer.draw(&view, &mesh, Payload::ObjectId, map.target());
        })],
    });
}

fn torus() -> TriangleMesh {
    setup::scene("torus").mesh
}

/// A million triangles.
fn million() -> TriangleMesh {
    sphere(1000, 500)
}

/// A uv sphere of radius 2: `around` times `down` quads, poles on y.
fn sphere(around: u32, down: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for i in 0..around {
        for j in 0..=down {
            let (phi, theta) =
                (TAU * f64::from(i) / f64::from(around), PI * f64::from(j) / f64::from(down));
            let (sin_phi, cos_phi) = libm::sincos(phi);
            let (sin_theta, cos_theta) = libm::sincos(theta);
            let p = [sin_theta * cos_phi, cos_theta, sin_theta * sin_phi];
            mesh.positions.push(Vec3::from_array(p.map(|x| (2.0 * x) as f32)));
        }
    }
    for i in 0..around {
        for j in 0..down {
            let vertex = |i: u32, j: u32| (i % around) * (down + 1) + j;
            let [a, b] = [vertex(i, j), vertex(i, j + 1)];
            let [c, d] = [vertex(i + 1, j + 1), vertex(i + 1, j)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
            mesh.ids.extend([1; 2]);
        }
    }
    mesh
}

/// Two triangles that fill the map, slanted.
fn quad() -> TriangleMesh {
    let corners = [[-9.0, -1.0, -9.0], [9.0, -1.0, -9.0], [9.0, 0.5, 9.0], [-9.0, 0.5, 9.0]];
    TriangleMesh {
        positions: corners.map(Vec3::from_array).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ids: vec![1, 2],
    }
}
