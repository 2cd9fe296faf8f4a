//! Numbers, views and maps of any bytes whatsoever: special values as likely as ordinary ones, and
//! ordinary scenes often enough that the code behind the first test is reached.

use arbitrary::Unstructured;
use glam::{Mat4, Vec2, Vec3};
use shadowmap_core::{Bias, DepthMap, Level, LightPoint, View, Window};

/// Where the bytes of a case are taken from; zeros when they have run out.
pub struct Bytes<'a>(Unstructured<'a>);

/// Values that arithmetic finds hard.
const SPECIAL: [f32; 20] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    f32::NAN,
    -f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-45,
    f32::EPSILON,
    1e18,
    -1e18,
    1e-18,
    8_388_609.0,
    4_294_967_296.0,
    2_147_483_648.0,
];

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8]) -> Bytes<'a> {
        Bytes(Unstructured::new(bytes))
    }

    pub fn byte(&mut self) -> u8 {
        self.0.arbitrary().unwrap_or_default()
    }

    pub fn flag(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    /// From 0 to `most`.
    pub fn up_to(&mut self, most: u32) -> u32 {
        self.0.int_in_range(0..=most).unwrap_or_default()
    }

    pub fn word(&mut self) -> u32 {
        self.0.arbitrary().unwrap_or_default()
    }

    /// Any number whatsoever.
    pub fn number(&mut self) -> f32 {
        match self.byte() {
            i @ 0..20 => SPECIAL[usize::from(i)],
            20..28 => f32::from_bits(self.word()),
            // From -8 to 8, most of them on no grid.
            i => (f32::from(i) - 142.0) / 14.0 + f32::from(self.byte()) / 3600.0,
        }
    }

    /// Most often from 0 to 1.
    pub fn fraction(&mut self) -> f32 {
        if self.byte() < 16 { self.number() } else { f32::from(self.byte()) / 255.0 }
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    /// A direction of unit length, most often.
    pub fn normal(&mut self) -> Vec3 {
        let vector = self.vector();
        if self.byte() < 16 { vector } else { vector.normalize_or(Vec3::Y) }
    }

    pub fn bias(&mut self) -> Bias {
        if self.byte() < 200 {
            return Bias::default();
        }
        Bias { constant: self.number(), slope: self.number() }
    }

    pub fn window(&mut self) -> Window {
        if self.byte() < 160 {
            return Window::centered(1.0, 1.0);
        }
        let [left, top, right, bottom] = [0; 4].map(|_| self.number());
        Window { left, top, right, bottom }
    }

    /// Sides of a map, now and then 0.
    pub fn size(&mut self, most: u32) -> [u32; 2] {
        [0; 2].map(|_| if self.byte() < 2 { 0 } else { 1 + self.up_to(most - 1) })
    }

    /// Any view; every other one looks down at the scene around the origin.
    pub fn view(&mut self, size: [u32; 2]) -> View {
        let sound = self.flag();
        self.view_that(sound, size)
    }

    /// A view that looks down at the scene around the origin, if it is to be `sound`; else any.
    pub fn view_that(&mut self, sound: bool, [width, height]: [u32; 2]) -> View {
        let eye = if sound { Vec3::new(0.5, 5.0, 1.0) + self.small() } else { self.vector() };
        let target = if sound { self.small() } else { self.vector() };
        let near = if sound { 0.1 } else { self.number() };
        let axes = if sound || self.flag() {
            View::axes_towards(target - eye, Vec3::Y)
        } else {
            [self.vector(), self.vector(), self.vector()]
        };
        match self.byte() % if sound { 3 } else { 4 } {
            0 => {
                let fov = if sound { 1.0 } else { self.number() };
                View::perspective(eye, target, Vec3::Y, fov, width, height, near)
            }
            1 => {
                let window = if sound { Window::centered(1.0, 0.8) } else { self.window() };
                View::perspective_window(eye, axes, window, width, height, near)
            }
            2 => {
                let far = if sound { 12.0 } else { self.number() };
                let window = if sound { Window::centered(3.0, 3.0) } else { self.window() };
                View::orthographic_window(eye, axes, window, width, height, [near, far])
            }
            _ => {
                let range = [[0.0, 1.0], [-1.0, 1.0], [1.0, 0.0]][usize::from(self.byte() % 3)];
                View::from_clip(self.matrix(), range, width, height).unwrap_or_else(|| {
                    View::perspective(eye, target, Vec3::Y, 1.0, width, height, near)
                })
            }
        }
    }

    /// A shift that keeps a sound view sound.
    fn small(&mut self) -> Vec3 {
        Vec3::from_array([0; 3].map(|_| f32::from(self.byte()) / 255.0 - 0.5))
    }

    /// A projection with a few of its numbers replaced.
    pub fn matrix(&mut self) -> Mat4 {
        let mut columns =
            [1.5, 0.0, 0.0, 0.0, 0.0, 0.2, -1.0, -0.98, 0.0, -1.5, -0.2, -0.19, 0.0, 0.0, 4.9, 5.0];
        for _ in 0..self.up_to(4) {
            let at = self.up_to(15) as usize;
            columns[at] = self.number();
        }
        Mat4::from_cols_array(&columns)
    }

    /// Nearness and object IDs of any surfaces.
    pub fn map(&mut self, size: [u32; 2]) -> Map {
        self.map_that(false, size)
    }

    /// A map of any surfaces for each of the views, of its size.
    pub fn maps_of(&mut self, views: &[View]) -> Vec<Map> {
        views.iter().map(|view| self.map([view.width(), view.height()])).collect()
    }

    /// A background with rectangles in front of it; unless it is to be `sound`, anywhere, or noise.
    pub fn map_that(&mut self, sound: bool, size: [u32; 2]) -> Map {
        let texels = size[0] as usize * size[1] as usize;
        let background = self.nearness(sound);
        let mut map = Map { size, nearness: vec![background; texels], ids: vec![1; texels] };
        if !sound && self.byte() < 24 {
            let palette = [0; 6].map(|_| self.number());
            let mut noise = crate::Random(self.word().into());
            map.nearness.iter_mut().for_each(|texel| *texel = palette[noise.below(6)]);
        }
        for id in 2..2 + self.up_to(5) {
            let nearness = self.nearness(sound);
            let [x, y] = size.map(|side| self.up_to(side) as usize);
            let [width, height] = [0; 2].map(|_| self.up_to(12) as usize);
            let row = size[0] as usize;
            for y in y..(y + height).min(size[1] as usize) {
                let texels = y * row + x..y * row + (x + width).min(row);
                map.nearness[texels.clone()].fill(nearness);
                map.ids[texels].fill(id);
            }
        }
        map
    }

    /// Most often that of something 2 to 8 m away.
    fn nearness(&mut self, sound: bool) -> f32 {
        if !sound && self.byte() < 60 {
            self.number()
        } else {
            1.0 / (2.0 + f32::from(self.byte()) / 42.0)
        }
    }

    /// A receiver in a map of that size; now and then any.
    pub fn light_point(&mut self, [width, height]: [u32; 2]) -> LightPoint {
        if self.byte() < 40 {
            let [u, v, nearness] = self.vector().to_array();
            return LightPoint { u, v, nearness, slope: Vec2::new(self.number(), self.number()) };
        }
        let [u, v] = [width, height].map(|side| self.fraction() * side as f32);
        let slope = Vec2::new(self.fraction() - 0.5, self.fraction() - 0.5) * 0.01;
        LightPoint { u, v, nearness: self.nearness(false), slope }
    }

    /// A level beside the scalar one to compare with it; the scalar one where there is no other.
    pub fn level(&mut self) -> Level {
        let levels: Vec<Level> = Level::available().collect();
        levels[usize::from(self.byte()) % levels.len()]
    }
}

/// A map that owns its texels.
#[derive(Clone, Debug)]
pub struct Map {
    pub size: [u32; 2],
    pub nearness: Vec<f32>,
    pub ids: Vec<u32>,
}

impl Map {
    pub fn as_depth_map(&self) -> DepthMap<'_> {
        let [width, height] = self.size;
        DepthMap::new(width, height, &self.nearness, &self.ids).expect("one texel each")
    }

    /// The same map with one value everywhere.
    pub fn filled(&self, nearness: f32) -> Map {
        Map { nearness: vec![nearness; self.nearness.len()], ..self.clone() }
    }
}

/// Panics unless every number is a visibility.
pub fn assert_unit(values: &[f32]) {
    for (i, value) in values.iter().enumerate() {
        assert!((0.0..=1.0).contains(value), "the visibility of pixel {i} is {value}");
    }
}

/// Panics unless both have the same bits.
pub fn assert_same(what: &str, a: &[f32], b: &[f32]) {
    assert_eq!(a.len(), b.len(), "{what}");
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        assert_eq!(a.to_bits(), b.to_bits(), "{what}: {a} and {b} at pixel {i}");
    }
}
