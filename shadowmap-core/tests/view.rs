//! Views against answers known on paper, and planes against projected points.

use glam::camera::rh::{
    proj::{directx, opengl},
    view::look_at_mat4,
};
use glam::{Mat4, Vec3};
use proptest::prelude::*;
use shadowmap_core::{
    Bias, DepthConvention, DepthMap, ForeignDepth, HardShadow, LightPoint, Projection, View,
    Window, hard_shadow,
};

fn views() -> [View; 2] {
    let eye = Vec3::new(1.5, 6.0, 1.5);
    let axes = View::axes_towards(Vec3::new(-0.2, -1.0, -0.1), Vec3::NEG_Z);
    let window = Window { left: -0.7, top: -0.4, right: 0.3, bottom: 0.9 };
    [
        View::perspective_window(eye, axes, window, 640, 832, 0.1),
        View::orthographic_window(eye, axes, window, 640, 832, [0.5, 20.0]),
    ]
}

#[test]
fn centre_of_a_camera_is_where_it_looks() {
    let (eye, target) = (Vec3::new(0.0, 5.0, 8.0), Vec3::new(0.0, 0.8, 0.0));
    let view = View::perspective(eye, target, Vec3::Y, 0.7, 512, 512, 0.1);
    let seen = view.texel_from_world(target).unwrap();
    assert!((seen.x - 256.0).abs() < 1e-3 && (seen.y - 256.0).abs() < 1e-3);
    assert!((seen.z * eye.distance(target) - 1.0).abs() < 1e-6);
    // Up in the world is up in the image, right is right.
    let above = view.texel_from_world(target + Vec3::Y).unwrap();
    let right = view.texel_from_world(target + Vec3::X).unwrap();
    assert!(above.y < 255.0 && right.x > 257.0);
}

#[test]
fn edges_of_the_window_are_edges_of_the_map() {
    for view in views() {
        let [right, down, forward] = view.axes();
        let eye = Vec3::new(1.5, 6.0, 1.5);
        let corner = eye + 2.0 * forward;
        let scale = match view.projection() {
            shadowmap_core::Projection::Perspective => 2.0,
            shadowmap_core::Projection::Orthographic => 1.0,
        };
        let top_left = view.texel_from_world(corner + scale * (-0.7 * right - 0.4 * down)).unwrap();
        let bottom_right =
            view.texel_from_world(corner + scale * (0.3 * right + 0.9 * down)).unwrap();
        assert!(top_left.x.abs() < 1e-3 && top_left.y.abs() < 1e-3, "{top_left}");
        assert!((bottom_right.x - 640.0).abs() < 1e-3, "{bottom_right}");
        assert!((bottom_right.y - 832.0).abs() < 1e-3, "{bottom_right}");
    }
}

#[test]
fn nothing_behind_a_pinhole() {
    let [view, _] = views();
    assert_eq!(view.texel_from_world(Vec3::new(1.5, 7.0, 1.5)), None);
    assert_eq!(view.light_point(Vec3::new(1.5, 7.0, 1.5), Vec3::Y), None);
}

#[test]
fn foreign_matrices_give_the_same_view() {
    let (eye, target) = (Vec3::new(0.0, 5.0, 8.0), Vec3::new(0.0, 0.8, 0.0));
    let own = View::perspective(eye, target, Vec3::Y, 0.7, 640, 480, 0.1);
    let look = look_at_mat4(eye, target, Vec3::Y);
    let aspect = 640.0 / 480.0;
    let matrices = [
        (directx::perspective(0.7, aspect, 0.1, 100.0), [0.0, 1.0]),
        (opengl::perspective(0.7, aspect, 0.1, 100.0), [-1.0, 1.0]),
        (directx::perspective_infinite_reverse(0.7, aspect, 0.1), [1.0, 0.0]),
    ];
    for (projection, range) in matrices {
        let foreign = View::from_clip(projection * look, range, 640, 480).unwrap();
        assert!((foreign.max_nearness() - 10.0).abs() < 1e-2, "{}", foreign.max_nearness());
        assert!((foreign.focal() - own.focal()).length() < 1e-2);
        for point in [Vec3::ZERO, Vec3::new(1.0, 2.0, -3.0), Vec3::new(-2.0, 0.0, 4.0)] {
            let (a, b) = (own.texel_from_world(point).unwrap(), foreign.texel_from_world(point));
            let b = b.unwrap();
            assert!((a - b).abs().max_element() < 1e-2, "{a} {b}");
            assert!((a.z - b.z).abs() < 1e-6, "{a} {b}");
            assert!(foreign.world_from_texel(b.x, b.y, b.z).distance(point) < 1e-3);
        }
    }
    let ortho = directx::orthographic(-2.0, 2.0, -1.5, 1.5, 1.0, 21.0) * look;
    let foreign = View::from_clip(ortho, [0.0, 1.0], 640, 480).unwrap();
    let axes = View::axes_towards(target - eye, Vec3::Y);
    let own =
        View::orthographic_window(eye, axes, Window::centered(2.0, 1.5), 640, 480, [1.0, 21.0]);
    let (a, b) = (own.texel_from_world(Vec3::ONE), foreign.texel_from_world(Vec3::ONE));
    assert!((a.unwrap() - b.unwrap()).length() < 1e-3, "{a:?} {b:?}");
}

/// What every kind of buffer holds for a few points, and the nearness that must come of it.
#[test]
fn foreign_depth_becomes_nearness() {
    let (eye, target) = (Vec3::new(0.0, 5.0, 8.0), Vec3::new(0.0, 0.8, 0.0));
    let look = look_at_mat4(eye, target, Vec3::Y);
    let perspective = [
        (directx::perspective(0.7, 1.0, 0.1, 100.0), DepthConvention::ZeroToOne),
        (opengl::perspective(0.7, 1.0, 0.1, 100.0), DepthConvention::OpenGl),
        (directx::perspective_infinite_reverse(0.7, 1.0, 0.1), DepthConvention::ReversedZ),
        (directx::perspective(0.7, 1.0, 0.1, 100.0), DepthConvention::Linear),
        (directx::perspective(0.7, 1.0, 0.1, 100.0), DepthConvention::Distance),
        (directx::orthographic(-4.0, 4.0, -4.0, 4.0, 1.0, 21.0), DepthConvention::ZeroToOne),
        (opengl::orthographic(-4.0, 4.0, -4.0, 4.0, 1.0, 21.0), DepthConvention::OpenGl),
        (directx::orthographic(-4.0, 4.0, -4.0, 4.0, 1.0, 21.0), DepthConvention::Linear),
    ];
    for (projection, convention) in perspective {
        let clip = projection * look;
        let foreign = ForeignDepth::new(clip, convention, 512, 512).unwrap();
        let orthographic = foreign.view().projection() == Projection::Orthographic;
        for point in [Vec3::ZERO, Vec3::new(1.0, 2.0, -3.0), Vec3::new(-2.0, 0.0, 4.0)] {
            let ndc = clip.project_point3(point).z;
            let depth = -look.transform_point3(point).z;
            let value = match convention {
                DepthConvention::OpenGl => ndc * 0.5 + 0.5,
                DepthConvention::Linear if orthographic => depth - 1.0,
                DepthConvention::Linear => depth,
                DepthConvention::Distance => eye.distance(point),
                _ => ndc,
            };
            let seen = foreign.view().texel_from_world(point).unwrap();
            let nearness = foreign.nearness(seen.x, seen.y, value);
            let mut row = [0.0; 3];
            foreign.nearness_of_row(7, &[value; 3], &mut row);
            assert_eq!(row[2], foreign.nearness(2.5, 7.5, value), "{convention:?}");
            let error = (nearness - seen.z).abs() / seen.z;
            assert!(error < 1e-4, "{convention:?}: {nearness} for {}", seen.z);
        }
        // As near as can be, and yet a number.
        let nearest = foreign.nearness(256.0, 256.0, f32::from_bits(1));
        assert!(nearest.is_finite(), "{convention:?}: {nearest}");
        let nothing = match convention {
            DepthConvention::ReversedZ => 0.0,
            DepthConvention::Linear | DepthConvention::Distance => f32::INFINITY,
            _ => 1.0,
        };
        assert_eq!(foreign.nearness(9.0, 9.0, nothing), 0.0, "{convention:?}");
        assert_eq!(foreign.nearness(9.0, 9.0, f32::NAN), 0.0, "{convention:?}");
    }
}

#[test]
fn useless_matrices_are_refused() {
    for matrix in [Mat4::ZERO, Mat4::from_cols_array(&[f32::NAN; 16])] {
        assert_eq!(View::from_clip(matrix, [0.0, 1.0], 64, 64), None);
    }
}

#[test]
fn a_floating_blocker_blocks_and_the_receiver_itself_does_not() {
    let nearness = [0.25, 0.5, f32::NAN, 0.25];
    let map = DepthMap::new(4, 1, &nearness, &[]).unwrap();
    let shadow = |u| hard_shadow(&map, &LightPoint::flat(u, 0.5, 0.25), Bias::default());
    assert_eq!(shadow(0.5), HardShadow::Lit);
    assert_eq!(shadow(1.5), HardShadow::Blocked);
    assert_eq!(shadow(2.5), HardShadow::Lit, "a NaN never blocks");
    assert_eq!(shadow(-0.1), HardShadow::Outside);
    assert_eq!(shadow(4.0), HardShadow::Outside);
    assert_eq!(shadow(f32::NAN), HardShadow::Outside);
}

#[test]
fn slices_of_the_wrong_length_are_refused() {
    let error = DepthMap::new(4, 2, &[0.0; 7], &[]).unwrap_err();
    assert_eq!(error.to_string(), "nearness has 7 elements, its size needs 8");
    assert!(DepthMap::new(u32::MAX, u32::MAX, &[], &[]).is_err());
}

proptest! {
    /// The plane of a light point holds the other points of the receiver's plane.
    #[test]
    fn receiver_planes_are_affine_in_the_image(
        p in prop::array::uniform3(-2.0f32..2.0),
        n in prop::array::uniform3(-1.0f32..1.0),
        s in -0.5f32..0.5, t in -0.5f32..0.5,
    ) {
        let (p, n) = (Vec3::from(p), Vec3::from(n));
        prop_assume!(n.length() > 0.1);
        let n = n.normalize();
        for view in views() {
            let to_eye = Vec3::new(view.eye()[0], view.eye()[1], view.eye()[2])
                - p * view.eye()[3];
            prop_assume!(n.dot(to_eye.normalize()).abs() > 0.1);
            let q = p + n.any_orthonormal_pair().0 * s + n.any_orthonormal_pair().1 * t;
            let point = view.light_point(p, n).unwrap();
            let other = view.texel_from_world(q).unwrap();
            let error = point.plane_at(other.x, other.y) - other.z;
            prop_assert!(error.abs() < 1e-4 * other.z, "{error} of {}", other.z);
        }
    }

    #[test]
    fn texel_space_and_back(p in prop::array::uniform3(-2.0f32..2.0)) {
        let p = Vec3::from(p);
        for view in views() {
            let t = view.texel_from_world(p).unwrap();
            prop_assert!(view.world_from_texel(t.x, t.y, t.z).distance(p) < 1e-4);
        }
    }

    /// Whatever the numbers: no panic.
    #[test]
    fn any_number_is_survived(v in prop::array::uniform32(any::<f32>())) {
        let matrix = Mat4::from_cols_slice(&v[..16]);
        if let Some(view) = View::from_clip(matrix, [v[16], v[17]], 64, 64) {
            let _ = view.light_point(Vec3::from_slice(&v[18..21]), Vec3::from_slice(&v[21..24]));
        }
        let view = View::perspective(Vec3::from_slice(&v[18..21]), Vec3::from_slice(&v[21..24]),
            Vec3::from_slice(&v[24..27]), v[27], 64, 64, v[28]);
        let point = view.light_point(Vec3::from_slice(&v[21..24]), Vec3::from_slice(&v[24..27]));
        let map = [v[29]; 64 * 64];
        let map = DepthMap::new(64, 64, &map, &[]).unwrap();
        if let Some(point) = point {
            let _ = hard_shadow(&map, &point, Bias::default());
        }
    }
}
