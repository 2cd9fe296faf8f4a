//! Time against error.

use maud::html;
use renderer::method::Method;
use renderer::scene::SceneLight;
use shadowmap_core::Light;

use super::Effort;
use super::scenes::built_in;
use super::stage::Stage;
use super::way::Way;
use crate::page::Section;
use crate::plot::{Axes, Curve, Scale, Stroke, plot};

/// One plot per scene and light.
pub fn plots(effort: &Effort) -> Section {
    let scenes: &[&str] = if effort.quick { &["torus"] } else { &["torus", "blocker", "crowded"] };
    let axes = Axes {
        x: "time for maps, channels and shadows (ms)",
        y: "RMSE of visibility in the penumbra",
        scale: Scale::Logarithmic,
    };
    let mut body = html! {};
    for name in scenes {
        let scene = built_in(name);
        let mut stage = Stage::new(&scene, effort.size);
        for light in &scene.lights {
            let curves = curves(&mut stage, light, effort);
            body = html! { (body) div { h3 { (name) ", " (light.name) } (plot(axes, &curves)) } };
        }
    }
    Section {
        id: "time",
        title: "Time against error".to_owned(),
        body: html! { div.plots { (body) } },
        pictures: Vec::new(),
    }
}

fn curves(stage: &mut Stage<'_>, light: &SceneLight, effort: &Effort) -> Vec<Curve> {
    let truth = stage.truth(light);
    let mut curve = |name: &str, ways: Vec<Way>| {
        let point = |way: &Way| {
            let shadow = stage.shadow(std::slice::from_ref(light), way, effort.repeats);
            (shadow.milliseconds, stage.compare(&shadow.values, &truth).penumbra_rmse)
        };
        Curve::new(name, Stroke::Marked, ways.iter().map(point).collect())
    };
    let counts = |last: u32| (0..=last).map(|power| 1 << power);
    let rays = counts(8).map(|n| Way::new(Method::RayTraced).samples(n)).collect();
    let points = counts(5).map(|n| Way::new(Method::PointSamples).samples(n)).collect();
    let mut curves =
        vec![curve("ray tracing, 1 to 256 rays", rays), curve("1 to 32 point lights", points)];
    let sizes = |way: Way| [256, 512, 1024, 2048].map(|n| way.map_size(n)).to_vec();
    match light.light {
        Light::Sphere { .. } => {
            let [search, pcss] = [Method::Search, Method::Pcss].map(|m| sizes(Way::new(m)));
            curves.push(curve("search, 256² to 2048²", search));
            curves.push(curve("percentage-closer soft shadows, 256² to 2048²", pcss));
            let paper = vec![Way::new(Method::SearchPaper).map_size(256)];
            curves.push(curve("search as in the 2002 paper, 256²", paper));
        }
        _ => {
            let intervals = sizes(Way::new(Method::Intervals).samples(2));
            curves.push(curve("intervals from 2 samples, 256² to 2048²", intervals));
            for count in [2, 5] {
                let skins = sizes(Way::new(Method::Skins).samples(count));
                curves.push(curve(&format!("skins between {count} samples, 256² to 2048²"), skins));
            }
        }
    }
    curves
}
