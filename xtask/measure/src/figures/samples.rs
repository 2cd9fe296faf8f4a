//! The maps of a linear light's samples, and what can be seen in them.

use glam::Vec3;
use linear_light::{RectifiedLight, SampleViews, SkinOptions, SkinShadow, VisibilityChannels};
use raster::{DepthBuffer, Payload, Rasterizer};
use renderer::scene::Scene;
use shadowmap_core::{Bias, Level, Light, Threads};

use crate::picture::Picture;

/// A linear light seen from its samples.
pub struct Samples {
    views: SampleViews,
    maps: Vec<DepthBuffer>,
    channels: VisibilityChannels,
}

/// What one row of a map sees, in the plane of the light: lines of (x, y) in metres, apart by NaN.
pub struct Cut {
    /// Surfaces.
    pub surfaces: Vec<(f64, f64)>,
    /// Skins: from the edge of a blocker to the receiver behind it.
    pub skins: Vec<(f64, f64)>,
}

const GAP: (f64, f64) = (f64::NAN, f64::NAN);

impl Samples {
    /// The maps, `size` texels wide and high, of `count` samples of the scene's first light, which
    /// must be linear and need a single frustum; and their visibility channels.
    pub fn new(scene: &Scene, count: usize, size: u32, options: &SkinOptions) -> Samples {
        let Light::Linear { a, b } = scene.lights[0].light else {
            panic!("the first light of such a scene is linear");
        };
        let vertices = scene.mesh.positions.iter().copied();
        let light = RectifiedLight::fit(a, b, count, [size; 2], vertices);
        let views = light.frusta()[0].clone();
        let mut maps: Vec<DepthBuffer> = views
            .views()
            .iter()
            .map(|view| DepthBuffer::new(view.width(), view.height()))
            .collect();
        let mut targets: Vec<_> = maps.iter_mut().map(DepthBuffer::target).collect();
        Rasterizer::new(Level::detect(), Threads::Pool).draw_many(
            views.views(),
            &scene.mesh.as_mesh(),
            Payload::ObjectId,
            &mut targets,
        );
        let mut channels = VisibilityChannels::new();
        let seen: Vec<_> = maps.iter().map(DepthBuffer::as_depth_map).collect();
        channels.draw_rectified(&views, &seen, options);
        Samples { views, maps, channels }
    }

    /// What each sample contributes to the visibility of each receiver: a list per sample.
    pub fn contributions(&self, positions: &[Vec3], normals: &[Vec3]) -> Vec<Vec<f32>> {
        let maps: Vec<_> = self.maps.iter().map(DepthBuffer::as_depth_map).collect();
        let shadow = SkinShadow::rectified(&self.views, &maps, &self.channels, Bias::default());
        let mut all = vec![vec![0.0; positions.len()]; maps.len()];
        for (i, (&position, &normal)) in positions.iter().zip(normals).enumerate() {
            shadow.light(position, normal, |sample, share| all[sample][i] += share);
        }
        all
    }

    /// The visibility channel of sample `k` as grey, in that sample's own view.
    pub fn channel(&self, k: usize) -> Picture {
        let width = self.maps[k].width() as usize;
        let mut values = vec![0.0; width * self.maps[k].height() as usize];
        self.channels.channel(k, &mut values);
        Picture::gray(width, &values)
    }

    /// What the row of map `k` through (0, 0, z) sees, up to `reach` to either side.
    pub fn cut(&self, k: usize, z: f32, reach: f64) -> Cut {
        let view = &self.views.views()[k];
        let row = view.texel_from_world(Vec3::new(0.0, 0.0, z)).expect("in front of the light").y;
        let (width, y) = (view.width() as usize, row as usize);
        let map = self.maps[k].as_depth_map();
        let row = &map.nearness()[y * width..][..width];
        let ids = &map.ids()[y * width..][..width];
        let place = |x: usize| {
            let p = view.world_from_texel(x as f32 + 0.5, y as f32 + 0.5, row[x]);
            (f64::from(p.x), f64::from(p.y))
        };
        let mut cut = Cut { surfaces: Vec::new(), skins: Vec::new() };
        for x in 0..width {
            if row[x] <= 0.0 || place(x).0.abs() > reach {
                continue;
            }
            if x > 0 && row[x - 1] > 0.0 && ids[x - 1] != ids[x] {
                cut.skins.extend([place(x - 1), place(x), GAP]);
                cut.surfaces.push(GAP);
            }
            cut.surfaces.push(place(x));
        }
        cut
    }
}
