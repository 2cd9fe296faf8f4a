//! A rectangle light as a few lines, and a linear light with as many samples as it needs: camera
//! pass, maps and visibility together, beside rays, each with its error.

use glam::Vec3;
use renderer::frame::{Frame, Goal, Shot};
use renderer::lighting::{LightJob, LightOptions};
use renderer::method::Method;
use renderer::prepared::Prepared;
use renderer::scene::SceneLight;
use shadowmap_core::{Level, Light, Threads};

use super::rays::Rays;
use super::{Bench, Case, Group, Variant, setup};

/// The cases.
pub fn cases(quick: bool) -> [Case; 2] {
    let lines: &[u32] = if quick { &[4] } else { &[2, 4, 8, 16] };
    let rays: &[u32] = if quick { &[16] } else { &[4, 16, 64, 256] };
    let rectangle = Case::new(1, |bench| {
        let corner = Vec3::new(1.0, 6.0, 1.0);
        let light = Light::Rectangle { corner, edge_u: Vec3::X, edge_v: Vec3::Z };
        let of_lines = |count: &u32| (format!("{count} lines"), intervals(Some(*count)));
        beside_rays(bench, "torus", "rectangle", light, lines.iter().map(of_lines).collect(), rays);
    });
    let rays: &[u32] = if quick { &[16] } else { &[16, 64] };
    let tube = Case::new(1, |bench| {
        let light = Light::Linear { a: Vec3::new(0.5, 8.0, 1.5), b: Vec3::new(2.5, 8.0, 1.5) };
        let adaptive = ("adaptive samples".to_owned(), intervals(None));
        let two = ("2 samples".to_owned(), intervals(Some(2)));
        beside_rays(bench, "crowded", "linear", light, vec![two, adaptive], rays);
    });
    [rectangle, tube]
}

fn intervals(samples: Option<u32>) -> LightOptions {
    let method = Some(Method::Intervals);
    LightOptions { method, samples, map_size: 1024, ..LightOptions::default() }
}

/// Times a light on a scene by some options, and by rays.
fn beside_rays(
    bench: &mut Bench,
    name: &str,
    kind: &str,
    light: Light,
    mut options: Vec<(String, LightOptions)>,
    rays: &[u32],
) {
    let scene = setup::scene(name);
    let prepared = Prepared::new(&scene);
    let camera = setup::camera(&scene, 512);
    let truth = Rays::new(&scene.mesh.as_mesh(), light, &camera);
    let light =
        SceneLight { name: kind.to_owned(), light, color: Vec3::ONE, intensity: 1.0, spot: None };
    for &rays in rays {
        let method = Some(Method::RayTraced);
        let traced = LightOptions { method, samples: Some(rays), ..LightOptions::default() };
        options.push((format!("{rays} rays per pixel"), traced));
    }
    let jobs: Vec<(String, [LightJob; 1])> = options
        .into_iter()
        .map(|(variant, options)| {
            let job = LightJob::new(&light, &options, &prepared, &camera);
            (variant, [job.expect("the method knows the light")])
        })
        .collect();
    let mut errors = Vec::new();
    let mut variants = Vec::new();
    for (variant, lights) in &jobs {
        let shot = Shot {
            prepared: &prepared,
            camera: &camera,
            aa: 1,
            lights,
            tracer: Some(&truth.tracer),
            goal: Goal::Visibility,
        };
        let mut frame = Frame::new(Level::detect(), Threads::One);
        frame.render(&shot);
        let mut plain = Frame::new(Level::SCALAR, Threads::Pool);
        plain.render(&shot);
        assert!(
            frame.visibility() == plain.visibility(),
            "{name}, {variant}: differs from plain Rust"
        );
        let error = truth.penumbra_rmse(&frame.visibility()[0]);
        errors.push(format!("{variant} {error:.4}"));
        variants.push(Variant::new(variant.clone(), move || frame.render(&shot)));
    }
    bench.note(format!(
        "{name}, {kind} light, maps of 1024²: penumbra RMSE of {}",
        errors.join(", ")
    ));
    bench.compare(Group {
        name: format!("{name} {kind} light, maps of 1024"),
        x: None,
        work: Some((truth.pixels() as f64, "pixels")),
        variants,
    });
}
