//! The README's table of errors.

use renderer::method::Method;
use shadowmap_core::Light;

use super::Effort;
use super::scenes::built_in;
use super::stage::Stage;
use super::way::Way;

/// Side of the maps.
const MAP: u32 = 1024;

/// Scenes and which of their lights.
const LINES: [(&str, Kind); 8] = [
    ("torus", Kind::Sphere(0.5)),
    ("torus", Kind::Sphere(0.1)),
    ("blocker", Kind::Sphere(0.5)),
    ("crowded", Kind::Sphere(0.5)),
    ("torus", Kind::Linear),
    ("blocker", Kind::Linear),
    ("crowded", Kind::Linear),
    ("grille", Kind::Linear),
];

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// With this radius.
    Sphere(f32),
    Linear,
}

/// RMSE in the penumbra, one row per light.
pub fn table(effort: &Effort) -> String {
    let mut text =
        "\n| scene and light | ours | the papers' own | today's habit | rays per pixel for \
                    the same |\n|---|--:|--:|--:|--:|\n"
            .to_owned();
    for (name, kind) in LINES {
        let scene = built_in(name);
        let mut stage = Stage::new(&scene, effort.size);
        let is_linear = |light: &Light| matches!(light, Light::Linear { .. });
        let mut light = stage.light(|light| is_linear(light) == (kind == Kind::Linear)).clone();
        let (what, [ours, paper, habit]) = match kind {
            Kind::Sphere(radius) => {
                let center = light.light.center().expect("a sphere has a centre");
                light.light = Light::Sphere { center, radius };
                let paper = Way::new(Method::SearchPaper).map_size(256);
                let ways = [Way::new(Method::Search).map_size(MAP), paper];
                (
                    format!("sphere of {radius} m"),
                    [ways[0], ways[1], Way::new(Method::Pcss).map_size(MAP)],
                )
            }
            Kind::Linear => {
                let way = |method, samples| Way::new(method).samples(samples).map_size(MAP);
                let ways = [(Method::Intervals, 2), (Method::Skins, 2), (Method::PointSamples, 4)];
                ("linear, 2 m".to_owned(), ways.map(|(method, samples)| way(method, samples)))
            }
        };
        let truth = stage.truth(&light);
        let mut error = |way: &Way| {
            let shadow = stage.shadow(std::slice::from_ref(&light), way, 1);
            stage.compare(&shadow.values, &truth).penumbra_rmse
        };
        let [found, paper, habit] = [ours, paper, habit].map(|way| (error(&way), way));
        let cell = |(error, way): (f64, Way)| match way.method {
            Method::Search => format!("**{error:.4}**"),
            Method::Intervals => format!("**{error:.4}** (2 maps)"),
            Method::Skins => format!("{error:.3} (2 maps)"),
            Method::PointSamples => format!("{error:.3} (4 point lights)"),
            Method::Pcss => format!("{error:.3} (PCSS)"),
            _ => format!("{error:.3}"),
        };
        let rays = rays_for(found.0, &mut error);
        text += &format!(
            "| `{name}`, {what} | {} | {} | {} | {rays} |\n",
            cell(found),
            cell(paper),
            cell(habit)
        );
    }
    text
}

/// The least power of two of rays whose error is no larger.
fn rays_for(most: f64, error: &mut impl FnMut(&Way) -> f64) -> String {
    let counts = (2..=10).map(|power| 1 << power);
    let enough = |rays: &u32| error(&Way::new(Method::RayTraced).samples(*rays)) <= most;
    counts.into_iter().find(enough).map_or("more than 1024".to_owned(), |rays| rays.to_string())
}
