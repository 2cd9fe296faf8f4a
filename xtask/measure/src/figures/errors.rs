//! How far every method is from the truth, in numbers.

use maud::html;
use renderer::method::Method;
use renderer::scene::SceneLight;
use shadowmap_core::Light;

use super::Effort;
use super::gallery::{Gallery, Of, milliseconds};
use super::page::{Section, Tiles, table};
use super::scenes::built_in;
use super::stage::Stage;
use super::way::Way;

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
            let mut tiles = Tiles::new("errors");
            let mut gallery = Gallery::new(&mut stage, light, effort, &mut tiles);
            gallery.show_truth(Of::Visibility);
            for way in pictured(&light.light) {
                gallery.show(&way, &[Of::Error]);
            }
            let (row, drawn) = tiles.finish();
            let of_light = |(file, picture)| (format!("{name}-{}-{file}", light.name), picture);
            pictures.extend(drawn.into_iter().map(of_light));
            body = html! {
                (body)
                h3 { (name) ", " (kind(light)) }
                (table(&HEAD, &rows))
                (row)
            };
        }
    }
    Section { id: "errors", title: "Errors of every method".to_owned(), body, pictures }
}

fn rows(stage: &mut Stage<'_>, light: &SceneLight, effort: &Effort) -> Vec<Vec<String>> {
    let truth = stage.truth(light);
    let ways = ways(&light.light);
    let row = |way: &Way| {
        let shadow = stage.shadow(light, way, effort.repeats);
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

/// What is compared on a light of this kind.
fn ways(light: &Light) -> Vec<Way> {
    let mut ways = vec![
        Way::new(Method::Hard).map_size(1024),
        Way::new(Method::PointSamples).samples(4),
        Way::new(Method::PointSamples).samples(16),
    ];
    if let Light::Sphere { .. } = light {
        ways.extend([
            Way::new(Method::Pcf).map_size(1024),
            Way::new(Method::Pcss).map_size(1024),
            Way::new(Method::SearchPaper).map_size(256),
            Way::new(Method::SearchPaper).map_size(1024),
        ]);
    }
    ways.extend([4, 16, 64].map(|rays| Way::new(Method::RayTraced).samples(rays)));
    ways
}

/// Whose errors are shown as pictures.
fn pictured(light: &Light) -> Vec<Way> {
    match light {
        Light::Sphere { .. } => vec![
            Way::new(Method::Pcss).map_size(1024),
            Way::new(Method::SearchPaper).map_size(1024),
        ],
        _ => vec![Way::new(Method::PointSamples).samples(16)],
    }
}

fn kind(light: &SceneLight) -> String {
    match light.light {
        Light::Sphere { radius, .. } => format!("sphere light of radius {radius} m"),
        Light::Linear { a, b } => format!("linear light of {} m", a.distance(b)),
        _ => light.name.clone(),
    }
}
