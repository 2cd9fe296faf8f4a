//! Answers that are known on paper.

use glam::Vec3;
use raster::{AlphaMask, DepthBuffer, DrawStats, Payload, SkinVertex, draw_plain, draw_skins};
use shadowmap_core::{Mesh, View, Window};

const AXES: [Vec3; 3] = [Vec3::X, Vec3::NEG_Y, Vec3::NEG_Z];

/// One texel per metre at depth 1, the image centre on the -z axis.
fn view(size: u32, near: f32) -> View {
    let half = size as f32 * 0.5;
    View::perspective_window(Vec3::ZERO, AXES, Window::centered(half, half), size, size, near)
}

fn draw(view: &View, mesh: &Mesh<'_>, mask: Option<&AlphaMask<'_>>) -> (DepthBuffer, DrawStats) {
    let mut map = DepthBuffer::new(view.width(), view.height());
    let stats = draw_plain(view, mesh, mask, Payload::ObjectId, map.target());
    (map, stats)
}

#[test]
fn a_floor_through_the_near_plane_is_cut_where_depth_is_near() {
    // The plane y = -1 below the viewer, from behind to far ahead. Row v looks down by
    // t = v - 32 + 0.5 metres per metre, and meets the plane at depth 1 / t.
    let far = 1000.0;
    let corners = [[-far, far], [far, far], [far, -far], [-far, -far]];
    let positions = corners.map(|[x, z]| Vec3::new(x, -1.0, z));
    let mesh = Mesh { positions: &positions, triangles: &[[0, 1, 2], [2, 3, 0]], ids: &[3, 3] };
    let near = 0.05;
    let (map, stats) = draw(&view(64, near), &mesh, None);
    assert_eq!(stats, DrawStats { drawn: 2, clipped: 2, invalid: 0 });
    for y in 0..64 {
        let tangent = y as f32 - 31.5;
        let nearness = if tangent > 0.0 && tangent <= 1.0 / near { tangent } else { 0.0 };
        for x in 0..64 {
            let found = map.nearness[y * 64 + x];
            assert!((found - nearness).abs() <= 1e-5 * nearness, "({x}, {y}): {found}");
            assert_eq!(map.payload[y * 64 + x], if nearness > 0.0 { 3 } else { 0 });
        }
    }
}

#[test]
fn an_orthographic_view_keeps_what_lies_between_its_planes() {
    let window = Window::centered(4.0, 4.0);
    let view = View::orthographic_window(Vec3::ZERO, AXES, window, 8, 8, [1.0, 5.0]);
    // Depth x + 4 over the image: 0 at the left, 8 at the right; far - depth = 1 - x.
    let positions = [[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]]
        .map(|[x, y]| Vec3::new(x, y, -(x + 4.0)));
    let mesh = Mesh { positions: &positions, triangles: &[[0, 1, 2], [2, 3, 0]], ids: &[1, 1] };
    let (map, _) = draw(&view, &mesh, None);
    for row in map.nearness.chunks(8) {
        assert_eq!(row, [0.0, 3.5, 2.5, 1.5, 0.5, 0.0, 0.0, 0.0]);
    }
}

#[test]
fn of_two_equal_triangles_the_smaller_payload_wins_and_a_nearer_one_beats_both() {
    let triangle =
        |z: f32| [[-20.0, -20.0], [40.0, -20.0], [-20.0, 40.0]].map(|[x, y]| Vec3::new(x, y, z));
    let positions = [triangle(-2.0), triangle(-2.0), triangle(-1.0)].concat();
    let mesh =
        Mesh { positions: &positions[..6], triangles: &[[0, 1, 2], [3, 4, 5]], ids: &[9, 4] };
    assert!(draw(&view(4, 0.1), &mesh, None).0.payload.iter().all(|&id| id == 4));
    let triangles = [[6, 7, 8], [0, 1, 2], [3, 4, 5]];
    let mesh = Mesh { positions: &positions, triangles: &triangles, ids: &[12, 9, 4] };
    let (map, _) = draw(&view(4, 0.1), &mesh, None);
    assert!(map.payload.iter().all(|&id| id == 12));
    assert!(map.nearness.iter().all(|&nearness| nearness == 1.0));
}

#[test]
fn what_cannot_be_drawn_is_counted_and_left_out() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::NAN, Vec3::new(f32::INFINITY, 0.0, -1.0)];
    let triangles = [[0, 1, 4], [0, 1, 2], [3, 1, 0], [u32::MAX, 0, 0], [0, 1, 1]];
    let mesh = Mesh { positions: &positions, triangles: &triangles, ids: &[1; 5] };
    let (map, stats) = draw(&view(8, 0.1), &mesh, None);
    assert_eq!(stats, DrawStats { drawn: 0, clipped: 1, invalid: 4 });
    assert!(map.nearness.iter().all(|&nearness| nearness == 0.0));
}

#[test]
fn an_alpha_test_gets_perspective_correct_weights_also_of_clipped_triangles() {
    // The floor again, one triangle; its texture coordinates are its weights, so that the test
    // can rebuild the position, which the view puts back on the texel's centre.
    let positions =
        [[-900.0, 9.0], [900.0, 9.0], [0.0, -900.0]].map(|[x, z]| Vec3::new(x, -1.0, z));
    let view = view(64, 0.05);
    let mesh = Mesh { positions: &positions, triangles: &[[0, 1, 2]], ids: &[5] };
    let keep = |triangle: usize, b1: f32, b2: f32| {
        assert_eq!(triangle, 0);
        let p = positions[0] * (1.0 - b1 - b2) + positions[1] * b1 + positions[2] * b2;
        let seen = view.texel_from_world(p).unwrap();
        assert!(((seen.x - 0.5).round() - (seen.x - 0.5)).abs() < 2e-2, "{seen}");
        assert!(((seen.y - 0.5).round() - (seen.y - 0.5)).abs() < 2e-2, "{seen}");
        seen.x > 32.0
    };
    let mask = AlphaMask { masked: &[true], keep: &keep };
    let (map, _) = draw(&view, &mesh, Some(&mask));
    for y in 33..51 {
        for x in 0..64 {
            assert_eq!(map.payload[y * 64 + x], if x >= 32 { 5 } else { 0 }, "({x}, {y})");
        }
    }
}

#[test]
fn skins_interpolate_affinely_and_the_nearest_one_wins() {
    let vertex =
        |u: f32, v: f32, nearness: f32, visibility: f32| SkinVertex { u, v, nearness, visibility };
    // From 0 at u = 0 to 1 at u = 8, while nearness falls from 1 to 0.2.
    let ramp = [
        [vertex(0.0, 0.0, 1.0, 0.0), vertex(8.0, 0.0, 0.2, 1.0), vertex(8.0, 4.0, 0.2, 1.0)],
        [vertex(0.0, 0.0, 1.0, 0.0), vertex(8.0, 4.0, 0.2, 1.0), vertex(0.0, 4.0, 1.0, 0.0)],
    ];
    let flat = ramp.map(|t| t.map(|s| SkinVertex { nearness: 0.6, visibility: 0.25, ..s }));
    let mut expected = [0.0_f32; 8];
    for (x, expected) in expected.iter_mut().enumerate() {
        let t = (x as f32 + 0.5) / 8.0;
        *expected = if 1.0 - 0.8 * t > 0.6 { t } else { 0.25 };
    }
    for skins in [[ramp[0], ramp[1], flat[0], flat[1]], [flat[1], flat[0], ramp[1], ramp[0]]] {
        let (mut nearness, mut visibility) = (vec![0.0; 32], vec![1.0; 32]);
        draw_skins(&skins, 8, 4, &mut nearness, &mut visibility).unwrap();
        for row in visibility.chunks(8) {
            for (found, expected) in row.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-6, "{row:?}");
            }
        }
    }
    // Behind the destination's own depth nothing changes.
    let (mut nearness, mut visibility) = (vec![2.0; 32], vec![1.0; 32]);
    draw_skins(&ramp, 8, 4, &mut nearness, &mut visibility).unwrap();
    assert!(visibility.iter().all(|&v| v == 1.0));
    assert!(draw_skins(&ramp, 8, 5, &mut nearness, &mut visibility).is_err());
}
