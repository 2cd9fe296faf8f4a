//! Sixteen numbers at a time.
//!
//! Arithmetic is written on plain arrays, which the compiler turns into vector instructions of
//! whatever width the calling function may use. Only turning comparisons into bits has to be
//! spelled out per instruction set, and minima, which the compiler otherwise takes apart: every
//! kernel takes a `Ops` for that.

/// Numbers in one vector, and texels in one segment of a map's row.
pub(crate) const LANES: usize = 16;

pub(crate) type Lanes = [f32; LANES];

/// As many object IDs.
pub(crate) type Ids = [u32; LANES];

/// What every instruction set writes by hand: from lanes to bits and back.
pub(crate) trait Ops: Copy {
    /// Bit i says whether lane i of `a` is greater than that of `b`. False for NaN.
    fn greater(self, a: &Lanes, b: &Lanes) -> u32;
    /// Bit i says whether lane i of `a` is `b`.
    fn equal(self, a: &Ids, b: u32) -> u32;
    /// Lane i of `a` where bit i is set, of `b` elsewhere.
    fn select(self, bits: u32, a: &Lanes, b: &Lanes) -> Lanes;
    /// [`min`], lane by lane.
    fn min(self, a: &Lanes, b: &Lanes) -> Lanes;
    /// [`max`], lane by lane.
    fn max(self, a: &Lanes, b: &Lanes) -> Lanes;
    /// The least lane.
    fn least(self, a: &Lanes) -> f32;
    /// The greatest lane.
    fn greatest(self, a: &Lanes) -> f32;
}

/// The bit of each lane.
pub(crate) const BIT: [u32; LANES] =
    [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768];

/// The lane numbers.
pub(crate) const INDEX: Lanes =
    [0., 1., 2., 3., 4., 5., 6., 7., 8., 9., 10., 11., 12., 13., 14., 15.];

#[inline(always)]
pub(crate) fn lanes<T: Copy + Default>(f: impl Fn(usize) -> T) -> [T; LANES] {
    let mut out = [T::default(); LANES];
    for (i, out) in out.iter_mut().enumerate() {
        *out = f(i);
    }
    out
}

/// A bit for each of the first `count` lanes.
#[inline(always)]
pub(crate) fn within(count: usize) -> u32 {
    (1 << count.min(LANES)) - 1
}

/// Minimum and maximum as one vector instruction has them: the second operand if either is NaN.
#[inline(always)]
pub(crate) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(crate) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// All lanes as one: first those eight apart, then four, two and one.
#[inline(always)]
pub(crate) fn reduce(a: &Lanes, f: impl Fn(f32, f32) -> f32) -> f32 {
    let (mut b, mut c) = ([0.0; 8], [0.0; 4]);
    for i in 0..8 {
        b[i] = f(a[i], a[i + 8]);
    }
    for i in 0..4 {
        c[i] = f(b[i], b[i + 4]);
    }
    f(f(c[0], c[2]), f(c[1], c[3]))
}

/// The least lane and its number, the lowest of those with equal keys. NaN is never the least.
#[inline(always)]
pub(crate) fn least_lane(ops: impl Ops, keys: &Lanes) -> (f32, usize) {
    let least = ops.least(keys);
    let mask = !ops.greater(keys, &[least; LANES]) & 0xffff;
    (least, mask.trailing_zeros() as usize % LANES)
}

/// The first elements of a row, as many as there are, and zeros.
#[inline(always)]
pub(crate) fn take<T: Copy + Default>(row: &[T]) -> [T; LANES] {
    if let Some(all) = row.first_chunk() {
        return *all;
    }
    let mut out = [T::default(); LANES];
    out[..row.len()].copy_from_slice(row);
    out
}

/// Writes the first elements of a row, as many as there are.
#[inline(always)]
pub(crate) fn put(row: &mut [f32], values: &Lanes) {
    match row.first_chunk_mut() {
        Some(all) => *all = *values,
        None => row.copy_from_slice(&values[..row.len()]),
    }
}

/// The elements at sixteen indices. Those past the end, of which a caller has none, would get the
/// last element: looking them up so takes no branch per lane.
#[inline(always)]
pub(crate) fn gather(from: &[f32], index: [usize; LANES]) -> Lanes {
    let Some(last) = from.len().checked_sub(1) else { return [0.0; LANES] };
    lanes(|i| from[index[i].min(last)])
}

/// Sixteen texels of a row from `start`; 0, nothing, beyond its ends.
#[inline(always)]
pub(crate) fn texels(row: &[f32], start: usize) -> Lanes {
    if let Some(Some(all)) = row.get(start..).map(|row| row.first_chunk()) {
        return *all;
    }
    let mut out = [0.0; LANES];
    for (out, texel) in out.iter_mut().zip(row.iter().skip(start)) {
        *out = *texel;
    }
    out
}

/// The left neighbours of sixteen texels from `start`.
#[inline(always)]
pub(crate) fn left_neighbours(row: &[f32], start: usize) -> Lanes {
    if start > 0 {
        return texels(row, start - 1);
    }
    let own = texels(row, 0);
    let mut out = [0.0; LANES];
    out[1..].copy_from_slice(&own[..LANES - 1]);
    out
}
