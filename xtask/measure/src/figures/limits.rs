//! Where the methods fail, shown.

use maud::{Markup, html};
use renderer::method::Method;
use renderer::scene::Scene;

use super::Effort;
use super::gallery::Gallery;
use super::scenes::{built_in, hidden_from_both_ends, hidden_from_the_middle, torus_at};
use super::stage::Stage;
use super::way::Way;
use crate::page::{Section, Tiles};
use crate::picture::Picture;

const ID: &str = "limits";

/// Failures, each with its picture.
pub fn failures(effort: &Effort) -> Section {
    let mut pictures = Vec::new();
    let mut show = |name: &str, scene: &Scene, ways: &[Way]| -> Markup {
        let mut stage = Stage::new(scene, effort.size);
        // Of alternatives, the first that the methods fit.
        let light = stage.light(|light| ways.iter().all(|way| way.method.fits(light)));
        let mut tiles = Tiles::new(ID, ways.len() + 1);
        Gallery::new(&mut stage, light, effort, name, &mut tiles).compare(ways);
        let (rows, files): (Markup, Vec<(String, Picture)>) = tiles.finish();
        pictures.extend(files);
        rows
    };
    let way = Way::new;
    let many_edges = show(
        "edges-",
        &built_in("grille"),
        &[
            way(Method::PointSamples).samples(2),
            way(Method::Skins).samples(2),
            way(Method::Skins).samples(9),
        ],
    );
    let both_ends = show(
        "ends-",
        &hidden_from_both_ends(),
        &[
            way(Method::Skins).samples(3),
            way(Method::Intervals).samples(2),
            way(Method::Intervals).samples(3),
        ],
    );
    let middle = show(
        "middle-",
        &hidden_from_the_middle(),
        &[way(Method::Pcss), way(Method::Search), way(Method::PointSamples).samples(16)],
    );
    let coarse = show(
        "coarse-",
        &torus_at(0.4, 0.0),
        &[64, 128, 256].map(|size| way(Method::Search).map_size(size)),
    );
    let body = html! {
        p {
            "All methods here know a scene from a few depth maps. What none of the maps shows cannot "
            "cast a shadow, and what is smaller than a texel is seen by chance."
        }
        h3 { "Many edges: skins undersample" }
        p {
            "Nine bars under a light of 2 m. From two samples, skins join edges of different bars; "
            "it takes many more samples until neighbouring samples see the same edges."
        }
        (many_edges)
        h3 { "A blocker hidden from all samples of a linear light" }
        p {
            "The lower bar lies exactly behind an upper one for either end of the light. In both maps "
            "it does not exist. A sample in the middle sees it; skins still draw only the nearest "
            "of several blockers."
        }
        (both_ends)
        h3 { "A blocker hidden from the light’s middle" }
        p {
            "A single sample knows one layer. The lower bar is hidden behind a thin upper one that "
            "covers only a part of the light: its own shadow, the darker one, is missing. Sixteen "
            "point lights see it."
        }
        (middle)
        h3 { "Coarse maps" }
        p {
            "Near its contact with the ground a shadow is as sharp as its blocker, but the map’s edge "
            "is only known to a texel."
        }
        (coarse)
        h3 { "And in words" }
        ul {
            li {
                "Depth maps see cut-out surfaces, not half-transparent ones: what is more than half "
                "opaque blocks all light."
            }
            li {
                "Scenes of few triangles are cheap to trace, and more rays cost little there: for "
                "errors below what the maps resolve, rays are the faster way in the plots above. "
                "Maps win where there are many triangles or where they move; the time to build "
                "the ray tracer’s hierarchy is not in the plots."
            }
            li {
                "The ray tracer is this workspace’s own, in double precision, one pyramid of rays per "
                "pixel in the place of packets. A ray tracer made for speed, such as Embree, "
                "takes a fraction of its time where few rays are sent."
            }
        }
    };
    Section { id: ID, title: "Limits and failures".to_owned(), body, pictures }
}
