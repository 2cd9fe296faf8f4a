//! A linear light that owns its maps: the front door for whoever has a rasterizer.

use alloc::vec::Vec;

use shadowmap_core::{Bias, DepthMap, View};

use crate::{RectifiedLight, SkinOptions, SkinShadow, VisibilityChannels};

/// The depth maps and visibility channels of a linear light, drawn with a rasterizer of your own.
/// Keep it from frame to frame: it owns the memory.
#[derive(Clone, Debug)]
pub struct DrawnLight {
    light: RectifiedLight,
    /// Frustum after frustum, map after map.
    nearness: Vec<f32>,
    channels: Vec<VisibilityChannels>,
}

impl DrawnLight {
    /// A light whose maps have not been drawn: there is nothing to cast a shadow.
    #[must_use]
    pub fn new(light: RectifiedLight) -> DrawnLight {
        DrawnLight { light, nearness: Vec::new(), channels: Vec::new() }
    }

    /// Calls `draw` with each sample's view and its map, row-major and all 0, to be filled with
    /// nearness as [`View`] defines it, and makes the visibility channels.
    pub fn draw(&mut self, options: &SkinOptions, mut draw: impl FnMut(&View, &mut [f32])) {
        let views = || self.light.frusta().iter().flat_map(|frustum| frustum.views());
        self.nearness.clear();
        self.nearness.resize(views().map(texels).sum(), 0.0);
        let mut rest = &mut self.nearness[..];
        for view in views() {
            let (map, others) = core::mem::take(&mut rest).split_at_mut(texels(view));
            draw(view, map);
            rest = others;
        }
        self.channels.resize_with(self.light.frusta().len(), VisibilityChannels::new);
        let maps = maps_of(&self.light, &self.nearness);
        let mut maps = &maps[..];
        for (frustum, channels) in self.light.frusta().iter().zip(&mut self.channels) {
            let (these, others) = maps.split_at(frustum.views().len());
            channels.draw_rectified(frustum, these, options);
            maps = others;
        }
    }

    /// The light that was drawn.
    #[must_use]
    pub fn light(&self) -> &RectifiedLight {
        &self.light
    }

    /// Calls `shade` with what receivers are shaded with, one per frustum: for
    /// [`crate::visibility`], or to look up single receivers in the one of
    /// [`RectifiedLight::frustum_of`].
    ///
    /// # Panics
    ///
    /// If the maps have not been drawn.
    pub fn with_shadows<R>(&self, bias: Bias, shade: impl FnOnce(&[SkinShadow<'_>]) -> R) -> R {
        assert!(!self.channels.is_empty(), "the light's maps have been drawn");
        let maps = maps_of(&self.light, &self.nearness);
        let mut rest = &maps[..];
        let frusta = self.light.frusta().iter().zip(&self.channels);
        let shadows: Vec<_> = frusta
            .map(|(frustum, channels)| {
                let (these, others) = rest.split_at(frustum.views().len());
                rest = others;
                SkinShadow::rectified(frustum, these, channels, bias)
            })
            .collect();
        shade(&shadows)
    }
}

fn texels(view: &View) -> usize {
    view.width() as usize * view.height() as usize
}

fn maps_of<'a>(light: &RectifiedLight, mut nearness: &'a [f32]) -> Vec<DepthMap<'a>> {
    let views = light.frusta().iter().flat_map(|frustum| frustum.views());
    views
        .map(|view| {
            let (map, others) = nearness.split_at(texels(view));
            nearness = others;
            DepthMap::new(view.width(), view.height(), map, &[])
                .expect("a map has as many texels as its view")
        })
        .collect()
}
