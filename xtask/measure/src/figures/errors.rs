//! How far every method is from the truth, in numbers.

use glam::Vec3;
use maud::html;
use renderer::method::Method;
use renderer::scene::SceneLight;
use shadowmap_core::Light;

use super::Effort;
use super::gallery::{Gallery, milliseconds};
use super::scenes::built_in;
use super::stage::Stage;
use super::way::Way;
use crate::page::{Section, Tiles, table};

const HEAD: [&str; 6] = ["method", "RMSE in the penumbra", "RMSE", "largest error", "FLIP", "time"];

/// One table per scene and light.
pub fn tables(effort: &Effort) -> Section {
    let scenes: &[&str] = if effort.quick {
        &["torus", "blocker"]
    } else {
        &["torus", "blocker", "crowded", "grille"]
    };
    let mut body = html! {};
    let mut pictures = Vec::new();
    for name in scenes {
        let scene = built_in(name);
        let mut stage = Stage::new(&scene, effort.size);
        for light in &scene.lights {
            let rows = rows(&mut stage, light, effort);
            let mut tiles = Tiles::new("errors", 4);
            let prefix = format!("{name}-{}-", light.name);
            let mut gallery = Gallery::new(&mut stage, light, effort, &prefix, &mut tiles);
            gallery.errors(&pictured(&light.light));
            let (row, drawn) = tiles.finish();
            pictures.extend(drawn);
            body = html! {
                (body)
                h3 { (name) ", " (kind(light)) }
                (table(&HEAD, &rows))
                (row)
            };
        }
    }
    let scene = built_in("torus");
    let mut stage = Stage::new(&scene, effort.size);
    body = html! {
        (body)
        h3 { "torus, rectangle light of 1 m by 1 m" }
        p { "A rectangle is a few linear lights side by side; samples are these lines here, each "
            "seen from two maps." }
        (table(&HEAD, &rows(&mut stage, &rectangle(), effort)))
    };
    Section { id: "errors", title: "Errors of every method".to_owned(), body, pictures }
}

fn rows(stage: &mut Stage<'_>, light: &SceneLight, effort: &Effort) -> Vec<Vec<String>> {
    let truth = stage.truth(light);
    let ways = ways(&light.light);
    let row = |way: &Way| {
        let shadow = stage.shadow(std::slice::from_ref(light), way, effort.repeats);
        let error = stage.compare(&shadow.values, &truth);
        vec![
            way.name(),
            format!("{:.4}", error.penumbra_rmse),
            format!("{:.4}", error.rmse),
            format!("{:.3}", error.max),
            format!("{:.4}", error.flip),
            milliseconds(shadow.milliseconds),
        ]
    };
    ways.iter().map(row).collect()
}

/// Around the centre of the torus's sphere light.
fn rectangle() -> SceneLight {
    let corner = Vec3::new(1.0, 6.0, 1.0);
    let light = Light::Rectangle { corner, edge_u: Vec3::X, edge_v: Vec3::Z };
    let name = "rectangle".to_owned();
    SceneLight { name, light, color: Vec3::ONE, intensity: 1.0, spot: None }
}

/// What is compared on a light of this kind.
fn ways(light: &Light) -> Vec<Way> {
    if let Light::Rectangle { .. } = light {
        let lines = [2, 4, 8, 16].map(|k| Way::new(Method::Intervals).samples(k).map_size(1024));
        let rays = [4, 16, 64, 256].map(|rays| Way::new(Method::RayTraced).samples(rays));
        return lines.into_iter().chain(rays).collect();
    }
    let mut ways = vec![
        Way::new(Method::Hard).map_size(1024),
        Way::new(Method::PointSamples).samples(4),
        Way::new(Method::PointSamples).samples(16),
    ];
    match light {
        Light::Sphere { .. } => ways.extend([
            Way::new(Method::Pcf).map_size(1024),
            Way::new(Method::Pcss).map_size(1024),
            Way::new(Method::SearchPaper).map_size(256),
            Way::new(Method::Search).map_size(256),
            Way::new(Method::Search).map_size(512),
            Way::new(Method::Search).map_size(1024),
        ]),
        _ => ways.extend([
            Way::new(Method::Skins).samples(2),
            Way::new(Method::Skins).samples(2).map_size(1024),
            Way::new(Method::Skins).samples(3).map_size(1024),
            Way::new(Method::Skins).samples(5).map_size(1024),
            Way::new(Method::Intervals).samples(2),
            Way::new(Method::Intervals).samples(2).map_size(1024),
            Way::new(Method::Intervals).samples(3).map_size(1024),
        ]),
    }
    ways.extend([4, 16, 64].map(|rays| Way::new(Method::RayTraced).samples(rays)));
    ways
}

/// Whose errors are shown as pictures.
fn pictured(light: &Light) -> [Way; 3] {
    match light {
        Light::Sphere { .. } => [
            Way::new(Method::Pcss).map_size(1024),
            Way::new(Method::Search).map_size(1024),
            Way::new(Method::RayTraced).samples(16),
        ],
        _ => [
            Way::new(Method::Skins).samples(2).map_size(1024),
            Way::new(Method::Intervals).samples(2).map_size(1024),
            Way::new(Method::RayTraced).samples(16),
        ],
    }
}

fn kind(light: &SceneLight) -> String {
    match light.light {
        Light::Sphere { radius, .. } => format!("sphere light of radius {radius} m"),
        Light::Linear { a, b } => format!("linear light of {} m", a.distance(b)),
        _ => light.name.clone(),
    }
}
