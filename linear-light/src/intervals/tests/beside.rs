use super::*;

/// A wall beyond the right end of the light, and a shelf on it in front of its middle.
fn shelf_on_wall() -> (Scene, [Vec3; 4]) {
    let v = Vec3::new;
    let shelf = [v(2.4, 2.0, -0.5), v(3.0, 2.0, -0.5), v(3.0, 2.0, 0.5)];
    let [a, b, c] = shelf;
    let scene = Scene::new(&[[v(3.0, 0.0, -3.0), v(3.0, 0.0, 3.0), v(3.0, 3.0, 3.0)], shelf]);
    (scene, [a, b, c, a + c - b])
}

#[test]
fn beyond_the_lights_end_a_shadow_falls_only_where_something_throws_it() {
    let (v, (scene, shelf)) = (Vec3::new, shelf_on_wall());
    let [a, b] = [v(-1.0, 2.9, 0.0), v(1.0, 2.9, 0.0)];
    let view = View::perspective(v(0.0, 1.5, 0.0), v(3.0, 1.5, 0.0), Vec3::Y, 0.7, 96, 64, 0.1);
    let camera_map = scene.draw(core::slice::from_ref(&view), Payload::TriangleIndex);
    let table = Surfaces::Table(&scene.table);
    let camera = Camera::new(&view, camera_map[0].as_depth_map(), table).unwrap();
    // The maps are as wide as the shelf, and the wall goes on to either side.
    let (blockers, receivers) = (shelf.into_iter(), scene.positions.iter().copied());
    let light = RectifiedLight::fit_around(a, b, 2, [128; 2], blockers, receivers);
    let maps: Vec<_> =
        light.frusta().iter().map(|f| scene.draw(f.views(), Payload::ObjectId)).collect();
    let samples: Vec<_> = maps.iter().map(|maps| samples(maps)).collect();
    let frusta = light.frusta().iter().zip(&samples);
    let frusta: Vec<_> = frusta.map(|(views, samples)| FrustumMaps { views, samples }).collect();
    let mut out = vec![f32::NAN; camera_map[0].nearness.len()];
    let mut intervals = IntervalVisibility::new(Level::detect(), Threads::One);
    intervals.prepare(&frusta);
    intervals.visibility(&camera, &frusta, INTERVAL_BIAS, &mut out);
    let (mut below, mut beside, mut above) = (0, 0, 0);
    for (i, &seen) in out.iter().enumerate() {
        let (x, y) = ((i % 96) as f32 + 0.5, (i / 96) as f32 + 0.5);
        let p = view.world_from_texel(x, y, camera_map[0].nearness[i]);
        if p.x < 2.99 || light.frusta()[light.frustum_of(p)].beyond().is_none() {
            continue;
        }
        // The shelf's sides as the light sees them: in planes through its line.
        let side = (p.z / (2.9 - p.y)).abs() - 0.5 / 0.9;
        if side > 0.05 {
            assert_eq!(seen, 1.0, "beside the shadow, at {p}");
            beside += 1;
        } else if p.y > 2.05 {
            // Closer to the light's line than any shadow falls.
            assert_eq!(seen, 1.0, "above the shelf, at {p}");
            above += 1;
        } else if side < -0.05 && (1.87..1.95).contains(&p.y) {
            assert_eq!(seen, 0.0, "in the shadow, at {p}");
            below += 1;
        }
    }
    println!("{below} receivers below the shelf, {beside} beside it, {above} above it");
    assert!(below > 50 && beside > 200 && above > 50);
}
