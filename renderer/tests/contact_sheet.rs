//! Models that the methods were not made for, at default settings, beside rays: a contact sheet in
//! `target/contact-sheet.png`, a row of ours, rays and difference per model and light.

use std::path::Path;

use reference::{Cutouts, Tracer};
use renderer::camera::{CameraOptions, choose, view};
use renderer::default_light::default_lights;
use renderer::frame::{Frame, Goal, Shot};
use renderer::lighting::{LightJob, LightOptions};
use renderer::load::{Limits, load};
use renderer::method::Method;
use renderer::prepared::Prepared;
use shadowmap_core::{Level, Threads};
use test_models::public_models;

const SIDE: u32 = 256;

/// Thin bars, foliage, interiors, terrain, clutter. The greatest share of pixels whose shadow is
/// off by more than a half, and the root mean square of the difference, over both lights.
const MODELS: [(&str, f32, f32); 10] = [
    ("folding_chair/foldingChair.obj", 0.004, 0.05),
    ("orchids/orchids.obj", 0.004, 0.05),
    ("dungeon_hall.glb", 0.004, 0.05),
    ("garage/garage.gltf", 0.004, 0.065),
    ("home_theater/home-theater.gltf", 0.004, 0.09),
    ("camp/camp.gltf", 0.004, 0.05),
    ("many_cubes/many-cubes.gltf", 0.004, 0.05),
    ("flight_helmet.glb", 0.004, 0.05),
    ("cornell_box.obj", 0.004, 0.05),
    ("three_storey_building_noindex.glb", 0.004, 0.05),
];

/// What rays and the default method see of the model's lights, or of each of those it would get.
fn draw(path: &Path) -> Vec<[Vec<f32>; 2]> {
    let mut scene = load(path, &Limits::default()).unwrap();
    let camera = choose(&scene, &CameraOptions::default()).unwrap();
    scene.lights = default_lights(&scene, &camera);
    let prepared = Prepared::new(&scene);
    let camera = view(&camera, [SIDE; 2], prepared.bounds());
    let is_solid =
        |triangle: u32, [_, b1, b2]: [f32; 3]| prepared.is_solid(triangle as usize, b1, b2);
    let cutouts = Cutouts { has_holes: prepared.masked(), is_opaque: &is_solid };
    let tracer = Tracer::with_cutouts(&scene.mesh.as_mesh(), cutouts);
    let mut frame = Frame::new(Level::detect(), Threads::Pool);
    let mut see = |light, method, samples| {
        let options = LightOptions { method, samples, map_size: 1024, ..LightOptions::default() };
        let lights = [LightJob::new(light, &options, &prepared, &camera).unwrap()];
        frame.render(&Shot {
            prepared: &prepared,
            camera: &camera,
            aa: 1,
            lights: &lights,
            tracer: Some(&tracer),
            goal: Goal::Visibility,
        });
        frame.visibility()[0].clone()
    };
    let both = |light| [see(light, None, None), see(light, Some(Method::RayTraced), Some(64))];
    scene.lights.iter().map(both).collect()
}

#[test]
fn unseen_models_look_as_rays_say() {
    let Some(folder) = public_models() else { return };
    let side = SIDE as usize;
    let mut rows: Vec<Vec<f32>> = Vec::new();
    let mut wrong = Vec::new();
    for (name, most_off, most_rms) in MODELS {
        for [found, truth] in draw(&folder.join(name)) {
            let difference: Vec<f32> = found.iter().zip(&truth).map(|(f, t)| f - t).collect();
            let off = difference.iter().filter(|d| d.abs() > 0.5).count();
            let off = off as f32 / difference.len() as f32;
            let squares: f32 = difference.iter().map(|d| d * d).sum();
            let rms = (squares / difference.len() as f32).sqrt();
            println!("{name}: {:.2} % off by more than a half, RMSE {rms:.4}", off * 100.0);
            if off > most_off || rms > most_rms {
                wrong.push(name);
            }
            for y in 0..side {
                let line = y * side..(y + 1) * side;
                let mut row = found[line.clone()].to_vec();
                row.extend(&truth[line.clone()]);
                row.extend(difference[line].iter().map(|d| 0.5 + 0.5 * d));
                rows.push(row);
            }
        }
    }
    // Two columns.
    let half = rows.len() / 2;
    let bytes = |row: &[f32]| row.iter().map(|v| (v * 255.0 + 0.5) as u8).collect::<Vec<u8>>();
    let pixels: Vec<u8> =
        (0..half).flat_map(|y| [bytes(&rows[y]), bytes(&rows[half + y])].concat()).collect();
    let sheet = image::GrayImage::from_raw(6 * SIDE, half as u32, pixels).unwrap();
    let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target");
    std::fs::create_dir_all(&target).unwrap();
    sheet.save(target.join("contact-sheet.png")).unwrap();
    assert!(wrong.is_empty(), "{wrong:?}");
}
