//! Linear lights: maps, bounds and visibility of intervals beside rays of equal error; the channels
//! of skins beside the maps, and beside the paper's way to draw them.

use linear_light::{
    FrustumMaps, INTERVAL_BIAS, IntervalVisibility, RectifiedLight, SampleMap, SkinOptions,
    SkinShadow, VisibilityChannels,
};
use raster::{DepthBuffer, Payload, Rasterizer, Target, draw_plain};
use renderer::lighting::{LightJob, LightOptions, Plan};
use renderer::method::Method;
use renderer::prepared::Prepared;
use renderer::scene::{Scene, SceneLight};
use shadowmap_core::{Bias, Camera, DepthMap, Level, Mesh, Surfaces, Threads, View};

use super::rays::Rays;
use super::{Bench, Case, Group, Variant, area, count, on, setup};
use crate::compare::compare;

/// Side of the camera's image.
const SIDE: u32 = 512;

/// The cases of this part.
pub fn cases(quick: bool) -> Vec<Case> {
    let sizes: &[u32] = if quick { &[1024] } else { &[512, 1024, 2048] };
    let five_samples = usize::from(!quick);
    let mut cases = Vec::new();
    for name in ["torus", "crowded"] {
        cases.push(Case::new(sizes.len() + five_samples, move |bench| {
            let shot = Shot::new(name);
            let rays = Rays::new(&shot.scene.mesh.as_mesh(), shot.light().light, &shot.view);
            for &size in sizes {
                intervals(bench, &shot, &rays, size, 2);
            }
            if five_samples > 0 {
                intervals(bench, &shot, &rays, 1024, 5);
            }
        }));
        cases.push(Case::new(2, move |bench| skins(bench, &Shot::new(name))));
    }
    cases.extend(area::cases(quick));
    cases
}

/// A scene, and what its camera sees.
struct Shot {
    name: &'static str,
    scene: Scene,
    view: View,
    image: DepthBuffer,
}

impl Shot {
    fn new(name: &'static str) -> Shot {
        let scene = setup::scene(name);
        let view = setup::camera(&scene, SIDE);
        let mut image = DepthBuffer::new(SIDE, SIDE);
        let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
        rasterizer.draw(&view, &scene.mesh.as_mesh(), Payload::TriangleIndex, image.target());
        Shot { name, scene, view, image }
    }

    fn light(&self) -> &SceneLight {
        setup::light(&self.scene, true)
    }

    /// The scene's linear light with views as the program takes them.
    fn line(&self, prepared: &Prepared<'_>, size: u32, samples: u32) -> RectifiedLight {
        let options = LightOptions {
            method: Some(Method::Intervals),
            samples: Some(samples),
            map_size: size,
            ..LightOptions::default()
        };
        let job = LightJob::new(self.light(), &options, prepared, &self.view).expect("it fits");
        match job.plan {
            Plan::Lines(mut lines) => lines.remove(0).1,
            _ => unreachable!("a linear light is a line"),
        }
    }
}

fn draw(rasterizer: &mut Rasterizer, mesh: &Mesh<'_>, views: &[View], maps: &mut [DepthBuffer]) {
    let mut targets: Vec<Target<'_>> = maps.iter_mut().map(DepthBuffer::target).collect();
    rasterizer.draw_many(views, mesh, Payload::ObjectId, &mut targets);
}

/// Maps of these views, each as the plain rasterizer draws it.
fn checked_maps(rasterizer: &mut Rasterizer, mesh: &Mesh<'_>, views: &[View]) -> Vec<DepthBuffer> {
    let plain = |view: &View| {
        let mut map = DepthBuffer::new(view.width(), view.height());
        draw_plain(view, mesh, None, Payload::ObjectId, map.target());
        map
    };
    let expected: Vec<DepthBuffer> = views.iter().map(plain).collect();
    let mut maps = expected.clone();
    draw(rasterizer, mesh, views, &mut maps);
    assert!(maps == expected, "the maps of a linear light differ from the plain version");
    maps
}

/// Every stage of intervals, at every level and on two threads, and rays.
fn intervals(bench: &mut Bench, shot: &Shot, rays: &Rays<'_>, size: u32, samples: u32) {
    let prepared = Prepared::new(&shot.scene);
    let mesh = shot.scene.mesh.as_mesh();
    let line = shot.line(&prepared, size, samples);
    let views = &line.frusta()[0];
    let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
    let maps = checked_maps(&mut rasterizer, &mesh, views.views());
    let mut drawn = maps.clone();
    let last = (samples - 1) as f32;
    let samples_at = maps.iter().enumerate();
    let kept: Vec<SampleMap<'_>> = samples_at
        .map(|(k, map)| SampleMap { t: k as f32 / last, map: map.as_depth_map() })
        .collect();
    let frusta = [FrustumMaps { views, samples: &kept }];
    let surfaces = Surfaces::Table(prepared.surfaces());
    let camera = Camera::new(&shot.view, shot.image.as_depth_map(), surfaces).expect("one size");
    let pixels = shot.image.nearness.len();
    let judge = |level: Level, threads: Threads| {
        let mut intervals = IntervalVisibility::new(level, threads);
        let mut out = vec![0.0; pixels];
        intervals.prepare(&frusta);
        intervals.visibility(&camera, &frusta, INTERVAL_BIAS, &mut out);
        (intervals, out)
    };
    let (_, expected) = judge(Level::SCALAR, Threads::One);
    let mut bounds = IntervalVisibility::new(Level::detect(), Threads::One);
    let mut variants = vec![
        Variant::new("maps", move || draw(&mut rasterizer, &mesh, views.views(), &mut drawn))
            .moving(8 * size * size * samples),
        Variant::new("bounds of the maps", || bounds.prepare(&frusta)),
    ];
    let one_thread = Level::available().map(|level| (level, Threads::One));
    for (level, threads) in one_thread.chain([(Level::detect(), Threads::Pool)]) {
        let (mut intervals, mut out) = on(threads, || judge(level, threads));
        let name = level.kind().name();
        assert!(out == expected, "{name} differs from the plain level");
        let (camera, frusta) = (&camera, &frusta);
        let name = format!("visibility, {name}, {}", count(threads));
        let run = move || {
            intervals.visibility(camera, frusta, INTERVAL_BIAS, &mut out);
        };
        // The camera's pass is read, the mask written.
        variants.push(Variant::on(threads, name, run).moving(12.0 * pixels as f64));
    }
    let counts: &[u32] = if bench.quick() { &[32] } else { &[16, 32, 64] };
    let mut errors = vec![format!("intervals {:.4}", rays.penumbra_rmse(&expected))];
    for &count in counts {
        let mut out = vec![0.0; pixels];
        rays.trace(count, Threads::One, &mut out);
        errors.push(format!("{count} rays {:.4}", rays.penumbra_rmse(&out)));
        variants.push(Variant::new(format!("{count} rays per pixel"), move || {
            rays.trace(count, Threads::One, &mut out);
        }));
    }
    bench.note(format!(
        "{}, {samples} maps of {size}²: penumbra RMSE of {}",
        shot.name,
        errors.join(", ")
    ));
    bench.compare(Group {
        name: format!("{} intervals, {samples} maps, side {size}", shot.name),
        x: Some(("map side, texels", f64::from(size))),
        work: Some((pixels as f64, "pixels")),
        variants,
    });
}

/// The most that shading with channels of polygons may differ from shading with those of rows, RMS.
const POLYGON_TOLERANCE: f64 = 0.01;

/// The channels of three samples and shading with them, relative to drawing the maps; and relative
/// to the channels as section 3.2 has them: skin polygons rasterized into each neighbour's view.
fn skins(bench: &mut Bench, shot: &Shot) {
    let (size, samples) = (512, 3);
    let prepared = Prepared::new(&shot.scene);
    let mesh = shot.scene.mesh.as_mesh();
    let line = shot.line(&prepared, size, samples);
    let views = &line.frusta()[0];
    let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
    let maps = checked_maps(&mut rasterizer, &mesh, views.views());
    let mut drawn = maps.clone();
    let maps: Vec<DepthMap<'_>> = maps.iter().map(DepthBuffer::as_depth_map).collect();
    let options = |level| SkinOptions { level, threads: Threads::One, ..SkinOptions::default() };
    let channel = |channels: &VisibilityChannels| {
        let mut out = vec![0.0; (size * size) as usize];
        channels.channel(1, &mut out);
        out
    };
    let mut plain = VisibilityChannels::new();
    plain.draw_rectified(views, &maps, &options(Level::SCALAR));
    let expected = channel(&plain);
    let mut polygons = VisibilityChannels::new();
    polygons.draw_unrelated(views.views(), &maps, &options(Level::detect()));
    let surfaces = Surfaces::Table(prepared.surfaces());
    let camera = Camera::new(&shot.view, shot.image.as_depth_map(), surfaces).expect("one size");
    let shade = |channels: &VisibilityChannels, out: &mut [f32]| {
        let shadow = SkinShadow::rectified(views, &maps, channels, Bias::default());
        linear_light::visibility(&camera, &[shadow], Threads::One, out);
    };
    let mut out = vec![0.0; shot.image.nearness.len()];
    let mut by_polygons = out.clone();
    shade(&plain, &mut out);
    shade(&polygons, &mut by_polygons);
    let difference = compare(camera.map().width(), &out, &by_polygons).rmse;
    assert!(difference < POLYGON_TOLERANCE, "polygons differ by {difference} from rows");
    bench.note(format!(
        "{}: the channels' baseline is the method as the paper writes it, skin polygons rasterized \
         into each neighbour's view; shading with rows differs from shading with it by {difference:.4} RMS",
        shot.name
    ));
    let mut variants =
        vec![Variant::new("maps", move || draw(&mut rasterizer, &mesh, views.views(), &mut drawn))];
    for level in Level::available() {
        let (mut channels, maps) = (VisibilityChannels::new(), &maps);
        channels.draw_rectified(views, maps, &options(level));
        let name = level.kind().name();
        assert!(channel(&channels) == expected, "{name} differs from the plain level");
        variants.push(Variant::new(format!("channels by rows, {name}"), move || {
            channels.draw_rectified(views, maps, &options(level));
        }));
    }
    variants.push(Variant::new("visibility", || shade(&plain, &mut out)));
    bench.compare(Group {
        name: format!("{} skins, {samples} maps of {size}", shot.name),
        x: None,
        work: None,
        variants,
    });
    let mut rows = VisibilityChannels::new();
    bench.compare(Group {
        name: format!("{} channels, polygons of the paper and rows", shot.name),
        x: None,
        work: None,
        variants: vec![
            Variant::new("channels by polygons, as in the paper", || {
                polygons.draw_unrelated(views.views(), &maps, &options(Level::detect()));
            }),
            Variant::new("channels by rows", || {
                rows.draw_rectified(views, &maps, &options(Level::detect()));
            }),
        ],
    });
}
