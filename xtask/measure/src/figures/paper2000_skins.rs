//! The figures of the 2000 paper that explain skins and visibility channels.

use linear_light::{SkinOptions, Transition};
use maud::{Markup, html};
use renderer::method::Method;
use renderer::scene::Scene;
use shadowmap_core::Light;

use super::Effort;
use super::gallery::section;
use super::line::Line;
use super::samples::Samples;
use super::scenes::{built_in, pair, slope};
use super::stage::Stage;
use super::way::Way;
use crate::page::{Section, Tiles};
use crate::plot::{Axes, Curve, Scale, Stroke, plot};

/// The plane of the light, a little off the middle of a texel row.
const Z: f32 = 0.01;

const ALONG: Axes<'_> = Axes {
    x: "position along the receiver, x (m)",
    y: "visibility",
    scale: Scale::Linear([0.0, 1.05]),
};

fn map_size(effort: &Effort) -> u32 {
    if effort.quick { 512 } else { 1024 }
}

fn points(effort: &Effort) -> u32 {
    if effort.quick { 400 } else { 1600 }
}

/// Visibility along a line on the receiver.
pub fn figure_2(effort: &Effort) -> Section {
    let draw = |scene: &Scene, ends: [f32; 2], height: f32| {
        let mut line = Line::new(scene, ends, Z, height, points(effort));
        let skins = |transition| {
            let options = SkinOptions { transition, ..SkinOptions::default() };
            line.contributions(&Samples::new(scene, 2, map_size(effort), &options)).1
        };
        let (linear, rational) = (skins(Transition::Linear), skins(Transition::Rational));
        let two_lights = Way::new(Method::PointSamples).samples(2).map_size(map_size(effort));
        let curves = [
            Curve::new("truth", Stroke::Truth, line.truth()),
            Curve::new("skins, 2 samples, linear as in the paper", Stroke::Line, linear),
            Curve::new("skins, 2 samples, by equation 1", Stroke::Line, rational),
            Curve::new("two point lights", Stroke::Dashed, line.visibility(&two_lights)),
        ];
        plot(ALONG, &curves)
    };
    let parallel = draw(&built_in("blocker"), [-3.5, 3.5], 1.0);
    let leaning = draw(&slope(25.0), [-5.0, 2.5], 1.7);
    Section {
        id: "2000-2",
        title: "2000, figure 2: visibility along the receiver".to_owned(),
        body: html! {
            p {
                "A linear light of 2 m, a plate below it, and the visibility of the light along a "
                "line on the receiver. Where light and receiver are parallel, visibility changes "
                "linearly across the penumbra, and linear skins are exact up to the resolution "
                "of the maps. Where the receiver leans it does not (section 3.1): the linear skin "
                "misses the curve, equation 1, evaluated per texel, follows it."
            }
            div.plots {
                div { h3 { "Light and receiver are parallel" } (parallel) }
                div { h3 { "The receiver leans by 25 degrees" } (leaning) }
            }
        },
        pictures: Vec::new(),
    }
}

/// Skins, and what each sample contributes.
pub fn figure_4(effort: &Effort) -> Section {
    let scene = built_in("blocker");
    let samples = Samples::new(&scene, 2, map_size(effort), &SkinOptions::default());
    let Light::Linear { a, b } = scene.lights[0].light else { unreachable!("a linear light") };
    let [left, right] = [0, 1].map(|k| samples.cut(k, Z, 3.5));
    let ends = [a, b].map(|p| (f64::from(p.x), f64::from(p.y)));
    let curves = [
        Curve::new("light", Stroke::Truth, ends.to_vec()),
        Curve::new("surfaces seen by the left sample", Stroke::Line, left.surfaces),
        Curve::new("its skins", Stroke::Dashed, left.skins),
        Curve::new("skins of the right sample", Stroke::Dashed, right.skins),
    ];
    let axes = Axes { x: "x (m)", y: "height (m)", scale: Scale::Linear([0.0, 4.5]) };
    Section {
        id: "2000-4",
        title: "2000, figure 4: skins, and what each sample contributes".to_owned(),
        body: html! {
            p {
                "Above: one row of the depth maps of both ends of the light, put back into the "
                "world. At each edge of the blocker a skin joins it to the receiver behind. Seen "
                "from the other end of the light, the receivers behind a skin lie in the penumbra. "
                "Below: the contribution of each sample to the visibility of the receiver, from "
                "its visibility channel, and their sum."
            }
            div.plots {
                (plot(axes, &curves))
                (contributions(&scene, &samples, effort, 1.0))
            }
        },
        pictures: Vec::new(),
    }
}

/// The visibility channels of two samples.
pub fn figure_5(effort: &Effort) -> Section {
    let scene = built_in("torus");
    let mut scene = scene;
    // The linear light is the one that samples are made of.
    scene.lights.retain(|light| matches!(light.light, Light::Linear { .. }));
    let mut tiles = Tiles::new("2000-5", 3);
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(|_| true);
    tiles.push(
        "scene",
        stage.picture(std::slice::from_ref(light), &Way::truth()),
        "the scene, ray-traced",
    );
    let samples = Samples::new(&scene, 2, effort.size, &SkinOptions::default());
    for (k, name) in ["left", "right"].into_iter().enumerate() {
        let caption = format!("visibility channel of the {name} end of the light, in its view");
        tiles.push(&format!("channel-{name}"), samples.channel(k), &caption);
    }
    section(
        "2000-5",
        "2000, figure 5: visibility channels",
        html! {
            "Grey, 0.5, is half of the light: what both samples see gets the rest from the other. A "
            "skin runs from 0 at the blocker’s edge to 1 at the end of the penumbra. The bars at "
            "the borders are skins between the ground’s own edge and the nothing behind it."
        },
        tiles,
    )
}

/// A third sample.
pub fn figure_7(effort: &Effort) -> Section {
    let scene = pair();
    let of = |count| Samples::new(&scene, count, map_size(effort), &SkinOptions::default());
    let [two, three] = [2, 3].map(|count| contributions(&scene, &of(count), effort, 1.0));
    Section {
        id: "2000-7",
        title: "2000, figures 6 and 7: a third sample cures what two do not see".to_owned(),
        body: html! {
            p {
                "Two plates, one beside the other. Below the gap between them neither end of the "
                "light is seen but its middle is: with two samples that is umbra (figure 6), and "
                "the visibility jumps. A third sample in the middle sees through the gap."
            }
            div.plots {
                div { h3 { "Two samples" } (two) }
                div { h3 { "Three samples" } (three) }
            }
        },
        pictures: Vec::new(),
    }
}

/// What each sample contributes along the middle of the receiver, looked at from `height`.
fn contributions(scene: &Scene, samples: &Samples, effort: &Effort, height: f32) -> Markup {
    let line = Line::new(scene, [-3.5, 3.5], Z, height, points(effort));
    let (parts, sum) = line.contributions(samples);
    let mut curves = vec![
        Curve::new("truth", Stroke::Truth, line.truth()),
        Curve::new("sum of all samples", Stroke::Line, sum),
    ];
    let names = match parts.len() {
        2 => vec!["left sample", "right sample"],
        _ => vec!["left sample", "middle sample", "right sample"],
    };
    let named = names.into_iter().zip(parts);
    curves.extend(named.map(|(name, part)| Curve::new(name, Stroke::Dashed, part)));
    plot(ALONG, &curves)
}
