//! The method as Brabec and Seidel published it: plain, scalar, with their parameters.
//!
//! Slow on purpose: every texel of the box around a receiver is looked at, one by one. It is what
//! the faster searches are measured against.
//!
//! Where the paper contradicts itself, its prose and figures decide:
//!
//! * Section 3.3 says that both sides meet at 0.5 on the hard edge. Its pseudocode has both
//!   inverted; here the outer side is `0.5 + 0.5 f`, rising to 1, the inner side `0.5 - 0.5 f`,
//!   falling to 0.
//! * Section 3.2 assigns `r_shrink` times the depth difference to `r_max`, section 3.3 multiplies
//!   by it. Here it multiplies.
//! * The printed inner width uses the depth difference between the lit texel and the receiver,
//!   which is 0 on a flat receiver: hence the ring in the paper's figure 7. The blocker's depth is
//!   known where the receiver projects to, and serves both sides ([`InnerWidth`]).
//! * The constant layer of section 3.2 is replaced by the receiver's tangent plane. Receivers
//!   without a normal ([`crate::Surface::UNKNOWN`]) keep the constant layer.

use shadowmap_core::{BandSlice, Bias, LightPoint, Threads, View, Warp, for_each_band};

use crate::counters::Tally;
use crate::math::sqrt;
use crate::receiver::Receiver;
use crate::{Camera, Counters, LightMap, Texels, Visibility};

/// Which sides of the hard edge are softened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Penumbra {
    /// None: the classic shadow map.
    Hard,
    /// Only outside of the hard shadow (section 3.2): visibility falls to 0 at its edge.
    Outer,
    /// Both sides (section 3.3): they meet at 0.5.
    #[default]
    Both,
}

/// Where the width of the inner penumbra comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum InnerWidth {
    /// The blocker in front of the receiver, as for the outer penumbra.
    #[default]
    Blocker,
    /// The lit texel that was found, as section 3.3 prints it: draws the ring of figure 7.
    LitTexel,
}

/// The paper's user-defined constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Search radius per depth of the receiver (metres from the light), in texels per metre.
    pub r_scale: f32,
    /// Search radius of a receiver at the light, in texels.
    pub r_bias: f32,
    /// Factor on the radius per metre of depth between blocker and receiver.
    pub r_shrink: f32,
    /// Which sides are softened.
    pub penumbra: Penumbra,
    /// Where the inner width comes from.
    pub inner_width: InnerWidth,
    /// How many low bits of the object IDs are compared (section 4.1: IDs modulo 2^n), at most 32;
    /// 8 for packed maps, whatever is given.
    pub id_bits: u32,
    /// Largest shift of a texel's position from its centre along each axis, in texels, by a hash
    /// of its coordinates (section 4.3). 0 = none; 0.5 helps maps of very low resolution.
    pub jitter: f32,
    /// Tolerance of the depth comparisons.
    pub bias: Bias,
}

impl Default for Parameters {
    /// A radius near 20 texels at 6 metres: the paper's figure 7, for a map of 256 x 256.
    fn default() -> Self {
        Parameters {
            r_scale: 3.0,
            r_bias: 0.0,
            r_shrink: 0.5,
            penumbra: Penumbra::Both,
            inner_width: InnerWidth::Blocker,
            id_bits: 32,
            jitter: 0.0,
            bias: Bias::default(),
        }
    }
}

/// Writes the visibility of the light from every pixel of the camera, row-major. Pixels that see
/// nothing, and surfaces that turn away from the light, get 0.
///
/// # Panics
///
/// If `out` has another length than the camera has pixels.
pub fn visibility<T: Visibility>(
    camera: &Camera<'_>,
    light: &LightMap<'_>,
    parameters: &Parameters,
    threads: Threads,
    out: &mut [T],
) -> Counters {
    assert_eq!(out.len(), camera.map().nearness().len(), "one visibility per pixel");
    let width = camera.map().width();
    if out.is_empty() {
        return Counters::default();
    }
    let warp = Warp::new(camera.view(), light.view());
    let tally = Tally::default();
    for_each_band(threads, BandSlice { data: out, len: width as usize }, &|y, row| {
        let mut counters = Counters::default();
        for (x, out) in row.data.iter_mut().enumerate() {
            let pixel = Receiver::of(camera, x as u32, y as u32, &warp, light.view());
            *out =
                T::from_unit(pixel.map_or(0.0, |receiver| {
                    one_pixel(light, &receiver, parameters, &mut counters)
                }));
        }
        tally.add(&counters);
    });
    tally.total()
}

fn one_pixel(
    light: &LightMap<'_>,
    receiver: &Receiver,
    parameters: &Parameters,
    counters: &mut Counters,
) -> f32 {
    counters.receivers += 1;
    let Some(point) = receiver.point else {
        counters.outside += 1;
        return 1.0;
    };
    if receiver.turned_away {
        return 0.0;
    }
    let Some(search) = Search::new(light, point, receiver.id, parameters) else {
        counters.outside += 1;
        return 1.0;
    };
    match (search.inner, parameters.penumbra) {
        (true, Penumbra::Hard | Penumbra::Outer) => return 0.0,
        (false, Penumbra::Hard) => return 1.0,
        _ => {}
    }
    counters.searches += 1;
    let found = search.nearest(&mut counters.cut_by_border);
    let f = found.map_or(1.0, |hit| search.fraction(&hit));
    match (search.inner, parameters.penumbra) {
        (true, _) => 0.5 - 0.5 * f,
        (false, Penumbra::Outer) => f,
        (false, _) => 0.5 + 0.5 * f,
    }
}

/// The search of section 3.3 for one receiver.
struct Search<'a> {
    light: &'a LightMap<'a>,
    parameters: &'a Parameters,
    point: LightPoint,
    id: u32,
    offset: f32,
    /// Depth of the receiver in metres.
    depth: f32,
    /// `r_max`, in texels.
    radius: f32,
    /// Whether the texel at the receiver blocks it.
    inner: bool,
    /// Nearness of the texel at the receiver.
    own: f32,
}

/// The nearest texel that a search found.
struct Hit {
    /// Squared distance in texels.
    squared: f32,
    nearness: f32,
}

impl<'a> Search<'a> {
    /// `None` if the receiver projects outside the map.
    fn new(
        light: &'a LightMap<'a>,
        point: LightPoint,
        id: u32,
        parameters: &'a Parameters,
    ) -> Option<Self> {
        let (width, height) = (light.view().width(), light.view().height());
        if !(point.u >= 0.0 && point.v >= 0.0)
            || point.u >= width as f32
            || point.v >= height as f32
        {
            return None;
        }
        let depth = light.view().depth_from_nearness(point.nearness);
        let radius = parameters.r_scale * depth.abs() + parameters.r_bias;
        let offset = parameters.bias.offset(&point);
        let mut search =
            Search { light, parameters, point, id, offset, depth, radius, inner: false, own: 0.0 };
        let (x, y) = (point.u as u32, point.v as u32);
        (search.own, _) = light.texel(x, y);
        search.inner = search.in_front(x, y, search.own);
        Some(search)
    }

    /// Whether a texel is nearer to the light than the receiver's plane.
    fn in_front(&self, x: u32, y: u32, nearness: f32) -> bool {
        nearness > self.point.plane_at(x as f32 + 0.5, y as f32 + 0.5) + self.offset
    }

    /// The nearest blocker (outer), or the nearest lit texel of the receiver's object (inner),
    /// within the radius; the first in row-major order among equals.
    fn nearest(&self, cut_by_border: &mut u32) -> Option<Hit> {
        let (u, v, r) = (self.point.u, self.point.v, self.radius);
        let (width, height) = (self.light.view().width(), self.light.view().height());
        if u - r < 0.0 || v - r < 0.0 || u + r > width as f32 || v + r > height as f32 {
            *cut_by_border += 1;
        }
        // A float outside the range of u32, NaN included, saturates.
        let columns = (u - r) as u32..((u + r) as u32).saturating_add(1).min(width);
        let rows = (v - r) as u32..((v + r) as u32).saturating_add(1).min(height);
        let id_mask = 1_u32.checked_shl(self.light.id_bits(self.parameters)).map_or(!0, |b| b - 1);
        let mut best = None;
        let mut limit = r * r;
        for y in rows {
            for x in columns.clone() {
                let (nearness, id) = self.light.texel(x, y);
                let same_object = (id ^ self.id) & id_mask == 0;
                let wanted = if self.inner {
                    same_object && !self.in_front(x, y, nearness)
                } else {
                    !same_object && self.in_front(x, y, nearness)
                };
                let [du, dv] = self.position(x, y);
                let (du, dv) = (du - u, dv - v);
                let squared = du * du + dv * dv;
                if wanted && squared < limit {
                    limit = squared;
                    best = Some(Hit { squared, nearness });
                }
            }
        }
        best
    }

    /// The centre of a texel, jittered if so wished.
    fn position(&self, x: u32, y: u32) -> [f32; 2] {
        let hash = (x ^ y.rotate_left(16)).wrapping_mul(0x9e37_79b1);
        let hash = (hash ^ (hash >> 15)).wrapping_mul(0x85eb_ca77);
        let hash = hash ^ (hash >> 13);
        let signed = |bits: u32| (bits & 0xffff) as f32 * (2.0 / 65535.0) - 1.0;
        let jitter = self.parameters.jitter;
        [x as f32 + (0.5 + jitter * signed(hash)), y as f32 + (0.5 + jitter * signed(hash >> 16))]
    }

    /// r / r_max in \[0, 1\], with r_max rescaled by the depth difference.
    fn fraction(&self, hit: &Hit) -> f32 {
        let depth_of = |nearness| self.light.view().depth_from_nearness(nearness);
        let difference = match (self.inner, self.parameters.inner_width) {
            (false, _) => self.depth - depth_of(hit.nearness),
            (true, InnerWidth::Blocker) => self.depth - depth_of(self.own),
            (true, InnerWidth::LitTexel) => depth_of(hit.nearness) - self.depth,
        };
        let r_max = self.radius * (self.parameters.r_shrink * difference);
        let f = sqrt(hit.squared) / r_max;
        // Written so that a width of nothing, even 0 / 0, is the end of the penumbra.
        if (0.0..1.0).contains(&f) { f } else { 1.0 }
    }
}

impl LightMap<'_> {
    /// Nearness and ID of a texel inside the map.
    fn texel(&self, x: u32, y: u32) -> (f32, u32) {
        let index = y as usize * self.view().width() as usize + x as usize;
        match self.texels() {
            Texels::Plain(map) => {
                (map.nearness()[index], map.ids().get(index).copied().unwrap_or(0))
            }
            Texels::Packed(map) => unpack(map.texels()[index], self.view()),
        }
    }

    fn id_bits(&self, parameters: &Parameters) -> u32 {
        match self.texels() {
            Texels::Plain(_) => parameters.id_bits,
            Texels::Packed(_) => 8,
        }
    }
}

fn unpack(texel: u32, view: &View) -> (f32, u32) {
    ((texel >> 8) as f32 * (view.max_nearness() / 16_777_215.0), texel & 0xff)
}

#[cfg(test)]
mod tests;
