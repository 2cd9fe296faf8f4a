//! The rasterizer against its oracle, on any mesh from any view.

use glam::Vec3;
use raster::{AlphaMask, DepthBuffer, Payload, Rasterizer, SkinVertex, draw_plain, draw_skins};
use shadowmap_core::{Level, Mesh, Threads};

use crate::any::{Bytes, assert_same};

pub fn check(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let [width, height] = bytes.size(48);
    let view = bytes.view([width, height]);
    let positions: Vec<Vec3> = (0..bytes.up_to(15)).map(|_| bytes.vector()).collect();
    let index = |bytes: &mut Bytes<'_>| match bytes.byte() {
        255 => bytes.word(),
        i => u32::from(i) % (positions.len() as u32 + 1),
    };
    let triangles: Vec<[u32; 3]> =
        (0..bytes.up_to(19)).map(|_| [0; 3].map(|_| index(bytes))).collect();
    // As many IDs as triangles, or not.
    let ids: Vec<u32> = (0..bytes.up_to(19)).map(|_| bytes.byte().into()).collect();
    let mesh = Mesh { positions: &positions, triangles: &triangles, ids: &ids };
    let payload = if bytes.flag() { Payload::ObjectId } else { Payload::TriangleIndex };
    let masked: Vec<bool> = (0..bytes.up_to(19)).map(|_| bytes.flag()).collect();
    let keep = |triangle: usize, b1: f32, b2: f32| {
        assert!((0.0..=1.0).contains(&b1) && (0.0..=1.0).contains(&b2), "{b1} {b2}");
        (b1 * 3.0 + b2 * 5.0) as usize % 2 == triangle % 2
    };
    let mask = bytes.flag().then_some(AlphaMask { masked: &masked, keep: &keep });

    let mut expected = DepthBuffer::new(width, height);
    let stats = draw_plain(&view, &mesh, mask.as_ref(), payload, expected.target());
    for level in [Level::SCALAR, bytes.level()] {
        let mut found = DepthBuffer::new(width, height);
        let mut rasterizer = Rasterizer::new(level, Threads::One);
        let (views, mut target) = (std::slice::from_ref(&view), [found.target()]);
        let drawn = match &mask {
            Some(mask) => rasterizer.draw_masked(views, &mesh, mask, payload, &mut target),
            None => rasterizer.draw_many(views, &mesh, payload, &mut target),
        };
        assert_eq!(drawn, stats, "{}", level.kind().name());
        assert_eq!(found.payload, expected.payload, "{}", level.kind().name());
        assert_same(level.kind().name(), &found.nearness, &expected.nearness);
    }
    for nearness in &expected.nearness {
        assert!(nearness.is_finite() && *nearness >= 0.0, "{nearness} in {view:?}");
    }
    skins(bytes, [width, height]);
}

fn skins(bytes: &mut Bytes<'_>, [width, height]: [u32; 2]) {
    let vertex = |bytes: &mut Bytes<'_>| SkinVertex {
        u: bytes.fraction() * width as f32,
        v: bytes.fraction() * height as f32,
        nearness: bytes.number(),
        visibility: bytes.fraction(),
    };
    let skins: Vec<_> = (0..bytes.up_to(5)).map(|_| [0; 3].map(|_| vertex(bytes))).collect();
    let texels = width as usize * height as usize;
    let (mut nearness, mut visibility) = (vec![bytes.number(); texels], vec![1.0; texels]);
    let drawn = draw_skins(&skins, width, height, &mut nearness, &mut visibility);
    drawn.expect("the sizes agree");
    assert!(visibility.iter().all(|v| !v.is_nan()), "a skin left something that is no number");
}
