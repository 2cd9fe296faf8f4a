//! The samples of a light for one receiver after another.

use shadowmap_core::Light;

use crate::mask::{Bounds, Mask, Region, SampleTree};
use crate::sampling::{self, Samples};

/// The samples of one light, and which of them the current receiver does not see. They are placed
/// when the first is blocked: most receivers see all of a light.
#[derive(Clone, Debug)]
pub(crate) struct LightSamples<'a> {
    light: &'a Light,
    bounds: Bounds,
    samples: Samples,
    count: usize,
    receiver: u32,
    /// Whether `tree` holds the samples of the receiver, and whether `mask` is its own.
    placed: bool,
    masked: bool,
    points: Vec<[f32; 2]>,
    tree: SampleTree,
    mask: Mask,
}

impl<'a> LightSamples<'a> {
    pub fn new(light: &'a Light, samples: Samples) -> LightSamples<'a> {
        // A point is a point, however often it is looked at.
        let count = if matches!(light, Light::Point { .. }) { 1 } else { samples.count() };
        let mut all = LightSamples {
            light,
            bounds: sampling::bounds(light),
            samples,
            count: count as usize,
            receiver: 0,
            placed: false,
            masked: false,
            points: Vec::new(),
            tree: SampleTree::default(),
            mask: Mask::default(),
        };
        // Fixed samples are placed once for all receivers.
        if let Samples::Fixed(_) = samples {
            sampling::unit_points(light, samples, 0, &mut all.points);
            SampleTree::sort(&mut all.points);
            all.tree.rebuild(&all.points);
            all.placed = true;
        }
        all
    }

    /// Starts over with no sample blocked, for receiver number `receiver`.
    pub fn turn_to(&mut self, receiver: u32) {
        self.receiver = receiver;
        self.placed = matches!(self.samples, Samples::Fixed(_));
        self.masked = false;
    }

    pub fn light(&self) -> &'a Light {
        self.light
    }

    /// A box around all samples, wherever they are placed.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// How many samples there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Blocks the samples inside `region`, those that `blocks` agrees to if it is given. True if
    /// none is open any more.
    pub fn block(&mut self, region: &Region, blocks: Option<&dyn Fn([f32; 2]) -> bool>) -> bool {
        self.place();
        if !self.masked {
            self.mask.reset(&self.tree);
            self.masked = true;
        }
        self.mask.cover(&self.tree, region, blocks);
        self.mask.is_full()
    }

    /// How many samples are open.
    pub fn open(&self) -> usize {
        if self.masked { self.mask.open() as usize } else { self.count }
    }

    /// The light's coordinates of the open samples.
    pub fn open_points(&mut self) -> impl Iterator<Item = [f32; 2]> {
        self.place();
        let (mask, masked) = (&self.mask, self.masked);
        let open = move |&(i, _): &(usize, &[f32; 2])| !masked || mask.is_open(i);
        self.points.iter().enumerate().filter(open).map(|(_, &point)| point)
    }

    fn place(&mut self) {
        if !self.placed {
            sampling::unit_points(self.light, self.samples, self.receiver, &mut self.points);
            self.tree.rebuild(&self.points);
            self.placed = true;
        }
    }
}
