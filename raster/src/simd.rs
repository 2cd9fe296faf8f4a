//! The vector operations that the kernels are written in, once for all SIMD levels.
//!
//! One table of small named operations per instruction set; a kernel is a generic function over
//! [`Simd`] that is inlined into a function with the instructions enabled ([`kernel!`]). All
//! operations are IEEE or integer ones with the same bits at every level.
//!
//! Kernels use loops rather than closures: a closure is a function of its own, without the
//! instructions, and need not be inlined.

#[cfg(target_feature = "sse2")]
mod avx2;
#[cfg(target_feature = "sse2")]
mod avx512;
mod portable;
#[cfg(target_feature = "sse2")]
mod sse41;

#[cfg(target_feature = "sse2")]
pub(crate) use avx2::Avx2;
#[cfg(target_feature = "sse2")]
pub(crate) use avx512::Avx512;
pub(crate) use portable::Portable;
#[cfg(target_feature = "sse2")]
pub(crate) use sse41::Sse41;

/// The most lanes that any level has; arrays of lanes have this length.
pub(crate) const MAX_LANES: usize = 16;

/// A set of instructions. A value is the proof that the machine has them.
///
/// `F`, `I` and `D` are vectors of `LANES` single-precision numbers, 32-bit integers (wrapping)
/// and double-precision numbers; `M` has a yes or no per lane.
pub(crate) trait Simd: Copy {
    const LANES: usize;
    type F: Copy;
    type I: Copy;
    type D: Copy;
    type M: Copy;

    fn splat_f(self, a: f32) -> Self::F;
    fn splat_i(self, a: i32) -> Self::I;
    fn splat_d(self, a: f64) -> Self::D;
    /// 0, 1, 2, ...
    fn lanes(self) -> Self::I;

    fn add_f(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul_f(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a < b ? a : b`.
    fn min_f(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a > b ? a : b`.
    fn max_f(self, a: Self::F, b: Self::F) -> Self::F;

    fn add_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn sub_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn mul_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn min_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn max_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn or_i(self, a: Self::I, b: Self::I) -> Self::I;
    /// Shifts the sign in.
    fn shift_right<const BITS: u32>(self, a: Self::I) -> Self::I;
    fn shift_left<const BITS: u32>(self, a: Self::I) -> Self::I;

    fn add_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn sub_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn mul_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn div_d(self, a: Self::D, b: Self::D) -> Self::D;

    fn i_from_bits(self, a: Self::F) -> Self::I;
    fn f_from_bits(self, a: Self::I) -> Self::F;
    fn f_from_i(self, a: Self::I) -> Self::F;
    fn d_from_f(self, a: Self::F) -> Self::D;
    fn f_from_d(self, a: Self::D) -> Self::F;

    fn less_f(self, a: Self::F, b: Self::F) -> Self::M;
    fn equal_f(self, a: Self::F, b: Self::F) -> Self::M;
    /// [`Simd::less_f`] in the lanes of `m`.
    #[inline(always)]
    fn less_f_in(self, m: Self::M, a: Self::F, b: Self::F) -> Self::M {
        self.and_m(m, self.less_f(a, b))
    }
    /// [`Simd::equal_f`] in the lanes of `m`.
    #[inline(always)]
    fn equal_f_in(self, m: Self::M, a: Self::F, b: Self::F) -> Self::M {
        self.and_m(m, self.equal_f(a, b))
    }
    /// `a >= 0`.
    #[inline(always)]
    fn not_negative(self, a: Self::I) -> Self::M {
        self.greater_i(a, self.splat_i(-1))
    }
    fn greater_i(self, a: Self::I, b: Self::I) -> Self::M;
    /// `a < b`, both unsigned.
    fn below_u(self, a: Self::I, b: Self::I) -> Self::M;
    fn and_m(self, a: Self::M, b: Self::M) -> Self::M;
    fn or_m(self, a: Self::M, b: Self::M) -> Self::M;
    /// Bit `l` is lane `l`.
    fn bits(self, m: Self::M) -> u32;
    /// `m ? a : b`.
    fn select_f(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F;
    fn select_i(self, m: Self::M, a: Self::I, b: Self::I) -> Self::I;

    /// The first `LANES` elements. Loads and stores panic if there are fewer.
    fn load_f(self, from: &[f32]) -> Self::F;
    fn load_u(self, from: &[u32]) -> Self::I;
    fn store_f(self, to: &mut [f32], a: Self::F);
    fn store_u(self, to: &mut [u32], a: Self::I);
    fn store_d(self, to: &mut [f64; MAX_LANES], a: Self::D);

    /// `ROWS` times `LANES / ROWS` elements, each run of them `stride` after the one before.
    ///
    /// # Safety
    ///
    /// They must all be there to be read.
    #[inline(always)]
    #[allow(unsafe_code)]
    unsafe fn load_block<const ROWS: usize>(self, from: *const u32, stride: usize) -> Self::I {
        let (columns, mut lanes) = (Self::LANES / ROWS, [0; MAX_LANES]);
        for row in 0..ROWS {
            let lanes = lanes[row * columns..][..columns].as_mut_ptr();
            // SAFETY: the caller promises the elements.
            unsafe { lanes.copy_from_nonoverlapping(from.add(row * stride), columns) };
        }
        self.load_u(&lanes)
    }
    /// Stores the lanes of `m` where [`Simd::load_block`] loads from.
    ///
    /// # Safety
    ///
    /// All the elements must be there to be read and written.
    #[inline(always)]
    #[allow(unsafe_code)]
    unsafe fn blend_block<const ROWS: usize>(
        self,
        to: *mut u32,
        stride: usize,
        m: Self::M,
        a: Self::I,
    ) {
        let (columns, mut lanes) = (Self::LANES / ROWS, [0; MAX_LANES]);
        // SAFETY: the caller promises the elements.
        let old = unsafe { self.load_block::<ROWS>(to, stride) };
        self.store_u(&mut lanes, self.select_i(m, a, old));
        for row in 0..ROWS {
            let lanes = lanes[row * columns..][..columns].as_ptr();
            // SAFETY: the caller promises the elements.
            unsafe { to.add(row * stride).copy_from_nonoverlapping(lanes, columns) };
        }
    }

    /// Fetches what is soon to be written. The address need not be valid.
    #[inline(always)]
    fn prefetch(self, _at: *const u8) {}

    /// Fetches what is to be written later, not into the nearest cache but the next. The address
    /// need not be valid.
    #[inline(always)]
    fn prefetch_later(self, _at: *const u8) {}

    /// Fetches what is soon to be read. The address need not be valid.
    #[inline(always)]
    fn prefetch_read(self, _at: *const u8) {}

    /// Stores the lanes of `m` and leaves the others as they are.
    #[inline(always)]
    fn blend_f(self, to: &mut [f32], m: Self::M, a: Self::F) {
        let old = self.load_f(to);
        self.store_f(to, self.select_f(m, a, old));
    }
    /// As [`Simd::blend_f`].
    #[inline(always)]
    fn blend_u(self, to: &mut [u32], m: Self::M, a: Self::I) {
        let old = self.load_u(to);
        self.store_u(to, self.select_i(m, a, old));
    }

    /// The four parts of the table's entry for each corner of the first `LANES` triangles;
    /// `missing` where the index is out of range.
    fn gather(
        self,
        table: &[[f32; 4]],
        triangles: &[[u32; 3]],
        missing: [f32; 4],
    ) -> [[Self::F; 4]; 3];

    /// Stores the lanes whose bits are set, one after the other. All of the first `LANES` elements
    /// may be overwritten.
    #[inline(always)]
    fn compress_u(self, to: &mut [u32], bits: u32, a: Self::I) {
        let mut lanes = [0; MAX_LANES];
        self.store_u(&mut lanes, a);
        for (to, lane) in to.iter_mut().zip(set_bits(bits)) {
            *to = lanes[lane];
        }
    }

    /// As [`Simd::compress_u`].
    #[inline(always)]
    fn compress_f(self, to: &mut [f32], bits: u32, a: Self::F) {
        let mut lanes = [0.0; MAX_LANES];
        self.store_f(&mut lanes, a);
        for (to, lane) in to.iter_mut().zip(set_bits(bits)) {
            *to = lanes[lane];
        }
    }
}

/// The positions of the bits that are set, below [`MAX_LANES`].
#[inline(always)]
pub(crate) fn set_bits(mut bits: u32) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let lane = (bits != 0).then(|| bits.trailing_zeros() as usize % MAX_LANES);
        bits &= bits.wrapping_sub(1);
        lane
    })
}

/// Writes the operations of an instruction set down as a table.
///
/// Each becomes an `#[inline(always)]` method: the intrinsics get inlined where the kernel is,
/// inside a function with their instructions enabled.
macro_rules! operations {
    ($self:ident, unsafe:
        $($name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? = $body:expr;)*
    ) => {
        $(
            #[inline(always)]
            fn $name($self, $($argument: $type),*) $(-> $result)? {
                // SAFETY: a value of Self is the proof that the machine has the instructions, and
                // each pointer comes from a slice or array whose length is checked beside it.
                unsafe { $body }
            }
        )*
    };
    ($self:ident, safe:
        $($name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? = $body:expr;)*
    ) => {
        $(
            #[inline(always)]
            fn $name($self, $($argument: $type),*) $(-> $result)? {
                $body
            }
        )*
    };
}
pub(crate) use operations;

/// Defines `fn name(level, arguments)`: `body`, an `#[inline(always)]` function of a [`Simd`] and
/// the arguments, compiled for each SIMD level, and the dispatch among them. Call it once per
/// stage, never per texel.
macro_rules! kernel {
    ($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),* $(,)?) = $body:path) => {
        $(#[$doc])*
        #[allow(unsafe_code)]
        pub(crate) fn $name(level: shadowmap_core::Level, $($argument: $type),*) {
            #[cfg(target_feature = "sse2")]
            {
                use shadowmap_core::LevelKind;

                use crate::simd::{Avx2, Avx512, Sse41};

                #[target_feature(enable = "sse4.1")]
                fn sse41(simd: Sse41, $($argument: $type),*) {
                    $body(simd, $($argument),*)
                }
                #[target_feature(enable = "avx2")]
                fn avx2(simd: Avx2, $($argument: $type),*) {
                    $body(simd, $($argument),*)
                }
                #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
                fn avx512(simd: Avx512, $($argument: $type),*) {
                    $body(simd, $($argument),*)
                }
                match level.kind() {
                    // SAFETY: a Level is the proof that the machine has its instructions.
                    LevelKind::Sse41 => return unsafe { sse41(Sse41::new(), $($argument),*) },
                    // SAFETY: as above.
                    LevelKind::Avx2 => return unsafe { avx2(Avx2::new(), $($argument),*) },
                    // SAFETY: as above.
                    LevelKind::Avx512 => return unsafe { avx512(Avx512::new(), $($argument),*) },
                    _ => {}
                }
            }
            let _ = level;
            $body(crate::simd::Portable, $($argument),*)
        }
    };
}
pub(crate) use kernel;
