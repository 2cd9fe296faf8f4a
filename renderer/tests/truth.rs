//! What is drawn against rays and against answers known on paper.

use glam::Vec3;
use reference::Tracer;
use renderer::camera::{CameraOptions, choose, view};
use renderer::frame::{Frame, Goal, Shot};
use renderer::lighting::{LightJob, LightOptions};
use renderer::method::Method;
use renderer::prepared::Prepared;
use renderer::scene::{Scene, SceneLight};
use renderer::{builtin, receivers};
use shadowmap_core::{Camera, Level, Light, Surfaces, Threads, View};

const SIDE: u32 = 256;

/// A frame of a scene under one light.
struct Drawn {
    view: View,
    frame: Frame,
}

fn draw(scene: &Scene, light: Light, method: Method, samples: Option<u32>, map_size: u32) -> Drawn {
    let prepared = Prepared::new(scene);
    let camera = choose(scene, &CameraOptions::default()).unwrap();
    let view = view(&camera, [SIDE, SIDE], prepared.bounds());
    let options =
        LightOptions { method: Some(method), samples, map_size, ..LightOptions::default() };
    let light =
        SceneLight { name: String::new(), light, color: Vec3::ONE, intensity: 1.0, spot: None };
    let job = LightJob::new(&light, &options, &prepared, &view).unwrap();
    let tracer = Tracer::new(&scene.mesh.as_mesh());
    let mut frame = Frame::new(Level::detect(), Threads::Pool);
    frame.render(&Shot {
        prepared: &prepared,
        camera: &view,
        aa: 1,
        lights: &[job],
        tracer: Some(&tracer),
        goal: Goal::Visibility,
    });
    Drawn { view, frame }
}

impl Drawn {
    /// Root of the mean squared difference over the pixels whose visibility in `truth` lies in the
    /// penumbra, and over all.
    fn errors(&self, truth: &[f32]) -> (f64, f64) {
        let found = &self.frame.visibility()[0];
        let (mut all, mut penumbra, mut count) = (0.0, 0.0, 0);
        for (&found, &truth) in found.iter().zip(truth) {
            let square = f64::from(found - truth).powi(2);
            all += square;
            if truth > 0.002 && truth < 0.998 {
                penumbra += square;
                count += 1;
            }
        }
        assert!(count > 100, "there is a penumbra");
        ((penumbra / f64::from(count)).sqrt(), (all / truth.len() as f64).sqrt())
    }
}

#[test]
fn depths_and_ids_equal_rays() {
    for name in ["torus", "blocker", "crowded", "grille"] {
        let scene = builtin::scene(name).unwrap();
        let light = scene.lights[0].light;
        let Drawn { view, frame } = draw(&scene, light, Method::Hard, Some(1), 16);
        let tracer = Tracer::new(&scene.mesh.as_mesh());
        let rays = tracer.receivers(&view, Threads::Pool);
        let id = |triangle: Option<&u32>| triangle.map_or(0, |&id| id);
        let drawn: Vec<u32> = frame
            .camera()
            .payload
            .iter()
            .map(|&index| id(scene.mesh.ids.get((index as usize).wrapping_sub(1))))
            .collect();
        let traced: Vec<u32> =
            rays.triangles.iter().map(|&index| id(scene.mesh.ids.get(index as usize))).collect();
        let side = SIDE as usize;
        let mut different = 0;
        for (i, &n) in frame.camera().nearness.iter().enumerate() {
            let (x, y) = (i % side, i / side);
            let around = |ids: &[u32], wanted: u32| {
                let columns = x.saturating_sub(1)..=(x + 1).min(side - 1);
                (y.saturating_sub(1)..=(y + 1).min(side - 1))
                    .any(|y| columns.clone().any(|x| ids[y * side + x] == wanted))
            };
            if drawn[i] != traced[i] {
                different += 1;
                assert!(around(&traced, drawn[i]) && around(&drawn, traced[i]), "{name} {x} {y}");
            } else if n > 0.0 {
                let [depth, expected] = [1.0 / n, depth_of(&view, rays.positions[i])];
                // Within an object, two surfaces can meet in a pixel.
                let edge = rays.triangles[i] + 1 != frame.camera().payload[i];
                assert!(edge || (depth / expected - 1.0).abs() < 1e-5, "{name} {x} {y}");
            }
        }
        assert!(different * 1000 <= drawn.len(), "{name}: {different} IDs differ");
    }
}

fn depth_of(view: &View, position: Vec3) -> f32 {
    1.0 / view.texel_from_world(position).unwrap().z
}

/// Visibility of the light (-1, 4, 0) to (1, 4, 0) from the ground of `blocker`.
fn closed_form(p: Vec3) -> f32 {
    if (0.625 * p.z).abs() >= 0.5 {
        return 1.0;
    }
    let a = ((-1.0 - 0.625 * p.x) / 0.375).max(-1.0);
    let b = ((1.0 - 0.625 * p.x) / 0.375).min(1.0);
    1.0 - (b - a).max(0.0) / 2.0
}

#[test]
fn point_samples_meet_the_closed_form_on_the_ground_of_blocker() {
    let scene = builtin::scene("blocker").unwrap();
    let light = scene.lights[0].light;
    let drawn = draw(&scene, light, Method::PointSamples, Some(64), 1024);
    let prepared = Prepared::new(&scene);
    let surfaces = Surfaces::Table(prepared.surfaces());
    let map = drawn.frame.camera().as_depth_map();
    let camera = Camera::new(&drawn.view, map, surfaces).unwrap();
    let count = drawn.frame.camera().nearness.len();
    let (mut positions, mut normals) = (vec![Vec3::ZERO; count], vec![Vec3::ZERO; count]);
    receivers::world(&camera, Threads::One, &mut positions, &mut normals);
    let found = &drawn.frame.visibility()[0];
    let truth: Vec<f32> = (0..count)
        .map(|i| match drawn.frame.camera().payload[i] {
            // The ground's two triangles.
            1 | 2 => closed_form(positions[i]),
            _ => found[i],
        })
        .collect();
    let (penumbra, _) = drawn.errors(&truth);
    assert!(penumbra < 0.02, "penumbra RMSE {penumbra}");
}

#[test]
fn rays_meet_the_closed_form_on_the_ground_of_blocker() {
    let scene = builtin::scene("blocker").unwrap();
    let light = scene.lights[0].light;
    let drawn = draw(&scene, light, Method::RayTraced, Some(1024), 16);
    let found = &drawn.frame.visibility()[0];
    for (i, &n) in drawn.frame.camera().nearness.iter().enumerate() {
        if matches!(drawn.frame.camera().payload[i], 1 | 2) {
            let (x, y) = (i as u32 % SIDE, i as u32 / SIDE);
            let p = drawn.view.world_from_texel(x as f32 + 0.5, y as f32 + 0.5, n);
            let off = (found[i] - closed_form(p)).abs();
            let row_of_the_edge = ((0.625 * p.z).abs() - 0.5).abs() < 0.001;
            assert!(off < 2e-3 || row_of_the_edge, "{x} {y}: {off}");
        }
    }
}

#[test]
fn many_point_samples_meet_rays_for_every_light() {
    let scene = builtin::scene("torus").unwrap();
    let v = Vec3::new;
    for (name, light, limit) in [
        ("sphere", Light::Sphere { center: v(1.5, 6.0, 1.5), radius: 0.5 }, 0.06),
        ("sun", Light::Sun { direction: v(-0.2, -1.0, -0.3), angle: 0.1 }, 0.06),
        ("linear", Light::Linear { a: v(0.5, 6.0, 1.5), b: v(2.5, 6.0, 1.5) }, 0.04),
        (
            "triangle",
            Light::Triangle { a: v(0.5, 6.0, 1.0), b: v(2.5, 6.0, 1.0), c: v(1.5, 6.0, 2.5) },
            0.06,
        ),
        (
            "rect",
            Light::Rectangle {
                corner: v(1.0, 6.0, 1.0),
                edge_u: v(1.0, 0.0, 0.0),
                edge_v: v(0.0, 0.0, 1.0),
            },
            0.06,
        ),
        // In the middle of the scene, seen through several faces.
        ("inside", Light::Linear { a: v(-0.1, 1.6, 0.2), b: v(0.1, 1.6, 0.2) }, 0.06),
    ] {
        let truth = draw(&scene, light, Method::RayTraced, Some(256), 16);
        let drawn = draw(&scene, light, Method::PointSamples, Some(64), 512);
        let (penumbra, all) = drawn.errors(&truth.frame.visibility()[0]);
        println!("{name}: {penumbra:.4} in the penumbra, {all:.4} in all");
        assert!(penumbra < limit, "{name}: {penumbra}");
    }
}

/// Small plates at random places under the light, one behind the other.
fn plates() -> Scene {
    let mut scene = builtin::scene("blocker").unwrap();
    let mut state = 1_u32;
    let mut random = |from: f32, to: f32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        from + (to - from) * (state >> 8) as f32 / (1 << 24) as f32
    };
    for _ in 0..200 {
        let p = Vec3::new(random(-1.5, 1.5), random(0.3, 3.0), random(-1.5, 1.5));
        let [x, z] = [Vec3::X * 0.15, Vec3::Z * 0.15];
        scene.add_object(
            "plate",
            0,
            &[p - x - z, p - x + z, p + x + z, p + x - z],
            &[[0, 1, 2], [0, 2, 3]],
        );
    }
    scene.normals.resize(scene.mesh.positions.len(), Vec3::ZERO);
    scene
}

#[test]
fn samples_are_added_where_blockers_hide_each_other_from_both_ends() {
    let scene = plates();
    let light = scene.lights[0].light;
    let truth = draw(&scene, light, Method::RayTraced, Some(512), 16);
    let [two, adaptive] = [Some(2), None].map(|samples| {
        draw(&scene, light, Method::Intervals, samples, 512).errors(&truth.frame.visibility()[0]).0
    });
    println!("two samples {two:.4}, as many as it takes {adaptive:.4}");
    assert!(adaptive < 0.042 && adaptive < 0.55 * two);
}
