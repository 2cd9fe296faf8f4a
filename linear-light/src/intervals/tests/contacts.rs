use super::*;

/// A box 2 metres wide, 1.5 high and 1 deep on a ground, and where its front faces: the front's
/// plane cuts the light in the middle and crosses rows and columns of the maps.
fn box_on_ground(yaw: f32) -> (Scene, Vec3) {
    let v = Vec3::new;
    let (along, normal) = (v(yaw.sin(), 0.0, -yaw.cos()), v(yaw.cos(), 0.0, yaw.sin()));
    let top = v(0.0, 1.5, 0.0);
    let scene = Scene::new(&[
        [v(-5.0, 0.0, -5.0), v(-5.0, 0.0, 5.0), v(5.0, 0.0, 5.0)],
        [-along, along, along + top],
        [-along - normal, along - normal, along - normal + top],
        [-along - normal + top, -along + top, along + top],
        [-along - normal, -along, -along + top],
        [along - normal, along, along + top],
    ]);
    (scene, normal)
}

/// What a point of the ground sees that lies `distance` in front of the box: rays to what of the
/// light is behind the front's plane pass through it below the top, or above.
fn beside_box_on_paper(distance: f32, yaw: f32) -> f32 {
    let behind = distance * (4.0 - 1.5) / 1.5 / yaw.cos();
    0.5 + 0.5 * behind
}

#[test]
fn a_receiver_at_the_foot_of_a_box_sees_what_is_in_front_of_it() {
    for yaw in [0.3_f32, 0.8, -1.2] {
        let (scene, normal) = box_on_ground(yaw);
        // Pixels of 4 millimetres, texels of 20.
        let eye = normal * 2.0 + Vec3::new(0.0, 2.0, 0.0);
        let view = View::perspective(eye, normal * 0.02, Vec3::Y, 0.1, 80, 60, 0.1);
        let camera_map = scene.draw(core::slice::from_ref(&view), Payload::TriangleIndex);
        let camera =
            Camera::new(&view, camera_map[0].as_depth_map(), Surfaces::Table(&scene.table))
                .unwrap();
        let points = scene.positions.iter().copied();
        let light = RectifiedLight::fit(LIGHT[0], LIGHT[1], 2, [512; 2], points);
        let views = &light.frusta()[0];
        let maps = scene.draw(views.views(), Payload::ObjectId);
        let samples = samples(&maps);
        let maps = FrustumMaps { views, samples: &samples };
        let out = visibility(Level::detect(), Threads::One, &camera, maps);
        let (mut ground, mut worst) = (0, 0.0_f32);
        let (mut front, mut worst_of_front) = (0, 0.0_f32);
        for (i, &v) in out.iter().enumerate() {
            let (x, y) = ((i % 80) as f32 + 0.5, (i / 80) as f32 + 0.5);
            let p = view.world_from_texel(x, y, camera_map[0].nearness[i]);
            let distance = p.dot(normal);
            if p.y.abs() < 1e-4 && distance > 2e-3 {
                worst = worst.max((v - beside_box_on_paper(distance, yaw)).abs());
                ground += 1;
            } else if distance.abs() < 1e-4 && p.y > 2e-3 {
                // The front sees the half of the light that is before it, down to the ground.
                worst_of_front = worst_of_front.max((v - 0.5).abs());
                front += 1;
            }
        }
        println!("turned by {yaw}: {ground} pixels, off by {worst:.3} at most");
        assert!(ground > 1000 && worst < 0.1, "{ground} pixels, off by {worst}");
        println!("    its front: {front} pixels, off by {worst_of_front:.3} at most");
        assert!(front > 1000 && worst_of_front < 0.02, "{front} pixels, off by {worst_of_front}");
    }
}
