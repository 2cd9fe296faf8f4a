//! Soft shadow maps for linear lights against ray-traced truth and closed forms.
//!
//! `cargo test --release -p workspace-tests --test linear_skins -- --ignored --nocapture` prints
//! the figures of all scenes.

use glam::Vec3;
use linear_light::{
    Discontinuity, EdgeFilter, RectifiedLight, SkinOptions, SkinShadow, Transition,
    VisibilityChannels, visibility,
};
use raster::{DepthBuffer, Rasterizer};
use reference::{Receivers, Samples, Tracer};
use renderer::builtin;
use renderer::prepared::Prepared;
use renderer::scene::Scene;
use shadowmap_core::{Bias, Camera, DepthMap, Level, Light, Mesh, Surfaces, Threads, View};
use workspace_tests::{PENUMBRA, Stage, rmse};

/// A scene with a linear light and what a camera sees of it.
struct Shot {
    stage: Stage,
    ends: [Vec3; 2],
}

impl Shot {
    fn of(scene: Scene, size: u32) -> Shot {
        let stage = Stage::of(scene, size);
        let Light::Linear { a, b } = stage.linear() else { unreachable!() };
        Shot { stage, ends: [a, b] }
    }

    fn new(name: &str, size: u32) -> Shot {
        let scene = if name == "tilted" { tilted() } else { builtin::scene(name).unwrap() };
        Shot::of(scene, size)
    }

    fn light(&self, samples: usize, map: u32) -> RectifiedLight {
        let [a, b] = self.ends;
        RectifiedLight::fit(
            a,
            b,
            samples,
            [map; 2],
            self.stage.scene.mesh.positions.iter().copied(),
        )
    }

    fn linear(&self) -> Light {
        let [a, b] = self.ends;
        Light::Linear { a, b }
    }

    fn truth(&self) -> Vec<f32> {
        self.stage.truth(&self.linear())
    }

    fn camera<R>(&self, run: impl FnOnce(&Camera<'_>) -> R) -> R {
        let prepared = Prepared::new(&self.stage.scene);
        let surfaces = Surfaces::Table(prepared.surfaces());
        run(&Camera::new(&self.stage.view, self.stage.image.as_depth_map(), surfaces).unwrap())
    }

    /// Visibility with rectified maps.
    fn skins(&self, samples: usize, map: u32, options: &SkinOptions) -> Vec<f32> {
        let light = self.light(samples, map);
        let mesh = self.stage.scene.mesh.as_mesh();
        let buffers: Vec<_> = light.frusta().iter().map(|f| draw(f.views(), &mesh)).collect();
        let maps: Vec<_> = buffers.iter().map(|b| borrowed(b)).collect();
        let drawn = |(views, maps): (_, &Vec<_>)| {
            let mut channels = VisibilityChannels::new();
            channels.draw_rectified(views, maps, options);
            channels
        };
        let channels: Vec<_> = light.frusta().iter().zip(&maps).map(drawn).collect();
        let frusta = light.frusta().iter().zip(&maps).zip(&channels);
        let shadows: Vec<_> = frusta
            .map(|((views, maps), c)| SkinShadow::rectified(views, maps, c, Bias::default()))
            .collect();
        let mut out = vec![0.0; self.stage.image.nearness.len()];
        self.camera(|camera| visibility(camera, &shadows, options.threads, &mut out));
        out
    }

    /// Visibility with views that have nothing in common.
    fn unrelated(&self, views: &[View], options: &SkinOptions) -> Vec<f32> {
        let buffers = draw(views, &self.stage.scene.mesh.as_mesh());
        let maps = borrowed(&buffers);
        let mut channels = VisibilityChannels::new();
        channels.draw_unrelated(views, &maps, options);
        let shadow = SkinShadow::unrelated(views, &maps, &channels, Bias::default());
        let mut out = vec![0.0; self.stage.image.nearness.len()];
        self.camera(|camera| visibility(camera, &[shadow], options.threads, &mut out));
        out
    }

    /// The baseline: as many point lights, in the middles of equal parts of the light.
    fn points(&self, samples: u16) -> Vec<f32> {
        let Receivers { positions, normals, .. } = &self.stage.receivers;
        let light = self.linear();
        let mesh = self.stage.scene.mesh.as_mesh();
        let mut out = vec![0.0; positions.len()];
        let samples = Samples::Fixed(samples.into());
        Tracer::new(&mesh).visibility(&light, positions, normals, samples, Threads::Pool, &mut out);
        out
    }

    /// RMSE over all pixels that show something, and over those in the penumbra.
    fn rmse(&self, found: &[f32], truth: &[f32]) -> [f64; 2] {
        let seen = |i: &usize| self.stage.receivers.normals[*i] != Vec3::ZERO;
        let all = (0..truth.len()).filter(seen);
        [
            rms(all.clone(), found, truth),
            rms(all.filter(|&i| PENUMBRA.contains(&truth[i])), found, truth),
        ]
    }
}

/// The blocker of the built-in scene, above a ground that rises by 35 degrees along the light.
fn tilted() -> Scene {
    let mut scene = builtin::scene("blocker").unwrap();
    let (sin, cos) = 35.0_f32.to_radians().sin_cos();
    for p in scene.mesh.positions.iter_mut().filter(|p| p.y == 0.0) {
        (p.x, p.y) = (p.x * cos, p.x * sin);
    }
    scene
}

fn draw(views: &[View], mesh: &Mesh<'_>) -> Vec<DepthBuffer> {
    workspace_tests::draw(&mut Rasterizer::new(Level::detect(), Threads::Pool), views, mesh)
}

fn borrowed(buffers: &[DepthBuffer]) -> Vec<DepthMap<'_>> {
    buffers.iter().map(DepthBuffer::as_depth_map).collect()
}

fn rms(pixels: impl Iterator<Item = usize>, found: &[f32], expected: &[f32]) -> f64 {
    rmse(pixels.map(|i| (&found[i], &expected[i])))
}

fn with(transition: Transition) -> SkinOptions {
    SkinOptions { transition, ..SkinOptions::default() }
}

#[test]
fn blocker_against_the_closed_form() {
    let shot = Shot::new("blocker", 512);
    let found = shot.skins(2, 512, &SkinOptions::default());
    let Receivers { positions, normals, .. } = &shot.stage.receivers;
    let on_paper = |p: Vec3| {
        let a = ((-1.0 - 0.625 * p.x) / 0.375).max(-1.0);
        let b = ((1.0 - 0.625 * p.x) / 0.375).min(1.0);
        if (0.625 * p.z).abs() < 0.5 { 1.0 - (b - a).max(0.0) / 2.0 } else { 1.0 }
    };
    let expected: Vec<_> = positions.iter().map(|&p| on_paper(p)).collect();
    let ground = |i: &usize| normals[*i] != Vec3::ZERO && positions[*i].y < 0.1;
    let penumbra = |i: &usize| ground(i) && PENUMBRA.contains(&expected[*i]);
    // The silhouettes along the light cast a hard edge at |z| = 0.8, known to half a row of texels.
    let away = |i: &usize| penumbra(i) && (positions[*i].z.abs() - 0.8).abs() > 0.03;
    let all = rms((0..expected.len()).filter(ground), &found, &expected);
    let penumbra = rms((0..expected.len()).filter(away), &found, &expected);
    assert!(penumbra <= 0.005, "penumbra {penumbra}");
    assert!(all <= 0.012, "all {all}");
}

#[test]
fn torus_within_limits() {
    let shot = Shot::new("torus", 512);
    let truth = shot.truth();
    for (samples, limit) in [(2, 0.045), (3, 0.022), (5, 0.013)] {
        let found = shot.skins(samples, 1024, &SkinOptions::default());
        let [_, penumbra] = shot.rmse(&found, &truth);
        assert!(penumbra <= limit, "{samples} samples: {penumbra}");
    }
}

#[test]
fn crowded_within_limits() {
    let shot = Shot::new("crowded", 256);
    let truth = shot.truth();
    for (samples, limit) in [(2, 0.19), (3, 0.05), (5, 0.035)] {
        let found = shot.skins(samples, 512, &SkinOptions::default());
        let [_, penumbra] = shot.rmse(&found, &truth);
        assert!(penumbra <= limit, "{samples} samples: {penumbra}");
        // Two samples are too few for this scene (section 3.3).
        if samples > 2 {
            let [_, points] = shot.rmse(&shot.points(samples as u16), &truth);
            assert!(penumbra < points, "{samples} samples: {penumbra}, as points {points}");
        }
    }
}

#[test]
fn rational_is_never_worse_and_better_where_the_receiver_is_tilted() {
    for name in ["blocker", "torus", "crowded", "grille", "tilted"] {
        let shot = Shot::new(name, 256);
        let truth = shot.truth();
        for samples in [2, 3] {
            let [linear, rational] = [Transition::Linear, Transition::Rational].map(|transition| {
                shot.rmse(&shot.skins(samples, 512, &with(transition)), &truth)[1]
            });
            assert!(rational <= linear + 1e-4, "{name} {samples}: {rational}, linear {linear}");
            if name == "tilted" {
                assert!(rational < 0.02 && linear > 3.0 * rational, "{rational}, linear {linear}");
            }
        }
    }
}

#[test]
fn both_filters_find_the_silhouettes() {
    let shot = Shot::new("torus", 256);
    let truth = shot.truth();
    let filters = [EdgeFilter::DepthStep, EdgeFilter::Laplacian];
    for filter in filters {
        let discontinuity = Discontinuity { filter, ..Discontinuity::default() };
        let options = SkinOptions { discontinuity, ..SkinOptions::default() };
        let [_, penumbra] = shot.rmse(&shot.skins(3, 512, &options), &truth);
        assert!(penumbra < 0.03, "{filter:?}: {penumbra}");
    }
}

#[test]
fn too_few_samples_fail_as_figure_6_says() {
    // Two blockers in a row: some points are lit by the middle of the light alone, which neither
    // end knows of, and end up in full shadow. A third sample finds them.
    let shot = Shot::new("crowded", 256);
    let truth = shot.truth();
    let [two, three] = [2, 3].map(|samples| {
        let found = shot.skins(samples, 512, &SkinOptions::default());
        (0..truth.len()).filter(|&i| found[i] == 0.0 && truth[i] > 0.3).count()
    });
    assert!(two > 50 && three * 4 < two, "{two} and {three} dark points");
}

#[test]
fn a_grille_needs_a_sample_per_bar() {
    // Points that both ends of a segment see count as lit by all of it, whatever bars are in
    // between: with few samples the method is worse than as many point lights.
    let shot = Shot::new("grille", 256);
    let truth = shot.truth();
    let penumbra = |found: &[f32]| shot.rmse(found, &truth)[1];
    let [two, nine] = [2, 9].map(|samples| shot.skins(samples, 512, &SkinOptions::default()));
    assert!(penumbra(&two) > penumbra(&shot.points(2)));
    assert!(penumbra(&nine) < 0.03 && penumbra(&nine) < penumbra(&shot.points(9)));
}

#[test]
fn polygons_agree_with_spans() {
    for name in ["blocker", "torus", "crowded"] {
        let shot = Shot::new(name, 256);
        for transition in [Transition::Linear, Transition::Rational] {
            let options = with(transition);
            let light = shot.light(3, 512);
            let views = &light.frusta()[0];
            let buffers = draw(views.views(), &shot.stage.scene.mesh.as_mesh());
            let maps = borrowed(&buffers);
            let mut spans = VisibilityChannels::new();
            spans.draw_rectified(views, &maps, &options);
            let mut polygons = VisibilityChannels::new();
            polygons.draw_unrelated(views.views(), &maps, &options);
            let [spans, polygons] = [spans, polygons].map(|channels| {
                let shadow = SkinShadow::rectified(views, &maps, &channels, Bias::default());
                let mut out = vec![0.0; shot.stage.image.nearness.len()];
                shot.camera(|camera| visibility(camera, &[shadow], Threads::Pool, &mut out));
                out
            });
            let difference = rms(0..spans.len(), &spans, &polygons);
            assert!(difference < 0.01, "{name} {transition:?}: {difference}");
        }
    }
}

#[test]
fn unrelated_views_are_as_good() {
    let shot = Shot::new("torus", 256);
    let truth = shot.truth();
    let [a, b] = shot.ends;
    // Each sample looks at the torus, its image rolled by an angle of its own.
    let views = [0.0_f32, 0.5, 1.0].map(|t| {
        let up = Vec3::new((1.0 + 2.0 * t).cos(), 0.0, (1.0 + 2.0 * t).sin());
        View::perspective(a + (b - a) * t, Vec3::new(0.0, 0.0, 0.0), up, 1.9, 512, 512, 0.1)
    });
    let [_, penumbra] = shot.rmse(&shot.unrelated(&views, &SkinOptions::default()), &truth);
    assert!(penumbra < 0.06, "{penumbra}");
}

#[test]
fn levels_and_threads_give_the_same_picture() {
    let shot = Shot::new("crowded", 128);
    let plain =
        SkinOptions { level: Level::SCALAR, threads: Threads::One, ..with(Transition::default()) };
    let bits = |options: &SkinOptions| -> Vec<u32> {
        shot.skins(3, 256, options).iter().map(|v| v.to_bits()).collect()
    };
    let expected = bits(&plain);
    for level in Level::available() {
        let options = SkinOptions { level, threads: Threads::Pool, ..plain };
        assert!(bits(&options) == expected, "{}", level.kind().name());
    }
}

#[test]
#[ignore = "prints the figures of all scenes"]
fn figures() {
    for name in ["blocker", "tilted", "torus", "crowded", "grille"] {
        let shot = Shot::new(name, 512);
        let truth = shot.truth();
        for samples in [2, 3, 5, 9] {
            let [all, points] = shot.rmse(&shot.points(samples as u16), &truth);
            println!("{name}, {samples} point lights: all {all:.4}, penumbra {points:.4}");
            for map in [512, 1024] {
                for transition in [Transition::Linear, Transition::Rational] {
                    let found = shot.skins(samples, map, &with(transition));
                    let [all, penumbra] = shot.rmse(&found, &truth);
                    println!("  map {map}, {transition:?}: all {all:.4}, penumbra {penumbra:.4}");
                }
            }
        }
    }
}
