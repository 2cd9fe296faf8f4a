//! Which SIMD instructions a machine has.

/// The name of a SIMD level. A name says nothing about this machine; a [`Level`] does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum LevelKind {
    /// Plain Rust: the specification that every other level equals bit for bit.
    Scalar,
    /// x86 with SSE4.1: four lanes.
    Sse41,
    /// x86 with AVX2: eight lanes.
    Avx2,
    /// x86 with AVX-512 F, BW, DQ and VL: sixteen lanes.
    Avx512,
    /// AArch64 with NEON: four lanes.
    Neon,
    /// WebAssembly with simd128: four lanes.
    Simd128,
}

impl LevelKind {
    /// All names, from the narrowest to the widest within each architecture.
    pub const ALL: [LevelKind; 6] = [
        LevelKind::Scalar,
        LevelKind::Sse41,
        LevelKind::Avx2,
        LevelKind::Avx512,
        LevelKind::Neon,
        LevelKind::Simd128,
    ];

    /// The name as it is written on a command line: `scalar`, `sse4.1`, `avx2`, `avx512`, `neon`,
    /// `simd128`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            LevelKind::Scalar => "scalar",
            LevelKind::Sse41 => "sse4.1",
            LevelKind::Avx2 => "avx2",
            LevelKind::Avx512 => "avx512",
            LevelKind::Neon => "neon",
            LevelKind::Simd128 => "simd128",
        }
    }
}

/// A SIMD level that this machine has.
///
/// A value of this type is the proof that its instructions may run: it is made by detection
/// ([`Level::detect`], [`Level::new`]), or promised by the caller
/// ([`Level::assume_supported`]). Functions with kernels take a `Level` and dispatch on
/// [`Level::kind`] once per stage.
///
/// ```
/// use shadowmap_core::Level;
/// for level in Level::available() {
///     println!("this machine has {}", level.kind().name());
/// }
/// assert!(Level::available().any(|level| level == Level::SCALAR));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Level(LevelKind);

impl Level {
    /// Plain Rust, which every machine has.
    pub const SCALAR: Level = Level(LevelKind::Scalar);

    /// The widest level of this machine. Without the `std` feature, the widest that the
    /// compiler was told of.
    #[must_use]
    pub fn detect() -> Level {
        Level::available().last().unwrap_or(Level::SCALAR)
    }

    /// Every level of this machine, the widest last.
    pub fn available() -> impl Iterator<Item = Level> {
        LevelKind::ALL.into_iter().filter_map(Level::new)
    }

    /// The level of that name, `None` if this machine lacks it.
    #[must_use]
    pub fn new(kind: LevelKind) -> Option<Level> {
        supported(kind).then_some(Level(kind))
    }

    /// A level that the caller knows to be there: the way in for targets without `std`, which
    /// cannot detect.
    ///
    /// # Safety
    ///
    /// The machine must have the instructions of `kind`, as its documentation lists them.
    #[must_use]
    #[allow(unsafe_code)]
    pub const unsafe fn assume_supported(kind: LevelKind) -> Level {
        Level(kind)
    }

    /// Its name, to dispatch on.
    #[must_use]
    pub const fn kind(self) -> LevelKind {
        self.0
    }
}

/// Whether this machine has the instructions: asked at run time where that is possible, else
/// what the compiler was told.
fn supported(kind: LevelKind) -> bool {
    #[cfg(all(feature = "std", any(target_arch = "x86", target_arch = "x86_64")))]
    {
        use std::is_x86_feature_detected as has;
        match kind {
            LevelKind::Scalar => true,
            LevelKind::Sse41 => has!("sse4.1"),
            LevelKind::Avx2 => has!("avx2"),
            LevelKind::Avx512 => {
                has!("avx512f") && has!("avx512bw") && has!("avx512dq") && has!("avx512vl")
            }
            LevelKind::Neon | LevelKind::Simd128 => false,
        }
    }
    #[cfg(not(all(feature = "std", any(target_arch = "x86", target_arch = "x86_64"))))]
    match kind {
        LevelKind::Scalar => true,
        LevelKind::Sse41 => cfg!(target_feature = "sse4.1"),
        LevelKind::Avx2 => cfg!(target_feature = "avx2"),
        LevelKind::Avx512 => cfg!(all(
            target_feature = "avx512f",
            target_feature = "avx512bw",
            target_feature = "avx512dq",
            target_feature = "avx512vl"
        )),
        LevelKind::Neon => cfg!(all(target_arch = "aarch64", target_feature = "neon")),
        LevelKind::Simd128 => cfg!(all(target_arch = "wasm32", target_feature = "simd128")),
    }
}
