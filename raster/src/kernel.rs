//! One algorithm, compiled once for the instructions of each level.

/// Defines `fn name(level, arguments)`: `body`, which must be `#[inline(always)]`, compiled for
/// each SIMD level, and the dispatch among them. Call it once per stage, never per texel.
macro_rules! kernel {
    ($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),* $(,)?) = $body:path) => {
        $(#[$doc])*
        #[allow(unsafe_code)]
        pub(crate) fn $name(level: shadowmap_core::Level, $($argument: $type),*) {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            {
                #[target_feature(enable = "sse4.1")]
                fn sse41($($argument: $type),*) {
                    $body($($argument),*)
                }
                #[target_feature(enable = "avx2")]
                fn avx2($($argument: $type),*) {
                    $body($($argument),*)
                }
                #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
                fn avx512($($argument: $type),*) {
                    $body($($argument),*)
                }
                match level.kind() {
                    // SAFETY: a Level is the proof that its instructions may run.
                    shadowmap_core::LevelKind::Sse41 => return unsafe { sse41($($argument),*) },
                    // SAFETY: as above.
                    shadowmap_core::LevelKind::Avx2 => return unsafe { avx2($($argument),*) },
                    // SAFETY: as above.
                    shadowmap_core::LevelKind::Avx512 => return unsafe { avx512($($argument),*) },
                    _ => {}
                }
            }
            // On other machines the compiler was told of NEON or simd128, or there is neither.
            let _ = level;
            $body($($argument),*)
        }
    };
}
pub(crate) use kernel;
