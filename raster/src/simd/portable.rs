//! Four lanes of the `wide` crate: SSE2, NEON, simd128 where the compiler was told of them, else
//! plain arrays.

use wide::{f32x4, f64x2, i32x4};

use super::{MAX_LANES, Simd, operations};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

type F = f32x4;
type I = i32x4;
type D = [f64x2; 2];
/// All bits of a lane are set, or none.
type M = i32x4;

impl Simd for Portable {
    const LANES: usize = 4;
    type F = F;
    type I = I;
    type D = D;
    type M = M;

    operations! { self, safe:
        splat_f(a: f32) -> F = F::splat(a);
        splat_i(a: i32) -> I = I::splat(a);
        splat_d(a: f64) -> D = [f64x2::splat(a); 2];
        lanes() -> I = I::new([0, 1, 2, 3]);

        add_f(a: F, b: F) -> F = a + b;
        mul_f(a: F, b: F) -> F = a * b;
        min_f(a: F, b: F) -> F = a.simd_lt(b).select(a, b);
        max_f(a: F, b: F) -> F = a.simd_gt(b).select(a, b);

        add_i(a: I, b: I) -> I = a + b;
        sub_i(a: I, b: I) -> I = a - b;
        mul_i(a: I, b: I) -> I = a * b;
        min_i(a: I, b: I) -> I = a.min(b);
        max_i(a: I, b: I) -> I = a.max(b);
        or_i(a: I, b: I) -> I = a | b;

        add_d(a: D, b: D) -> D = [a[0] + b[0], a[1] + b[1]];
        sub_d(a: D, b: D) -> D = [a[0] - b[0], a[1] - b[1]];
        mul_d(a: D, b: D) -> D = [a[0] * b[0], a[1] * b[1]];
        div_d(a: D, b: D) -> D = [a[0] / b[0], a[1] / b[1]];

        i_from_bits(a: F) -> I = bytemuck::cast(a);
        f_from_bits(a: I) -> F = bytemuck::cast(a);
        f_from_i(a: I) -> F = F::from_i32x4(a);
        d_from_f(a: F) -> D = {
            let [a, b, c, d] = a.to_array().map(f64::from);
            [f64x2::new([a, b]), f64x2::new([c, d])]
        };
        f_from_d(a: D) -> F = {
            let ([a, b], [c, d]) = (a[0].to_array(), a[1].to_array());
            F::new([a as f32, b as f32, c as f32, d as f32])
        };

        less_f(a: F, b: F) -> M = bytemuck::cast(a.simd_lt(b));
        equal_f(a: F, b: F) -> M = bytemuck::cast(a.simd_eq(b));
        greater_i(a: I, b: I) -> M = a.simd_gt(b);
        below_u(a: I, b: I) -> M = {
            let sign = I::splat(i32::MIN);
            (b ^ sign).simd_gt(a ^ sign)
        };
        and_m(a: M, b: M) -> M = a & b;
        or_m(a: M, b: M) -> M = a | b;
        bits(m: M) -> u32 = m.to_bitmask();
        select_f(m: M, a: F, b: F) -> F = bytemuck::cast::<M, F>(m).select(a, b);
        select_i(m: M, a: I, b: I) -> I = m.select(a, b);

        load_f(from: &[f32]) -> F = F::new(*from.first_chunk().expect("four lanes"));
        load_u(from: &[u32]) -> I =
            I::new(bytemuck::cast(*from.first_chunk::<4>().expect("four lanes")));
        store_f(to: &mut [f32], a: F) =
            *to.first_chunk_mut().expect("four lanes") = a.to_array();
        store_u(to: &mut [u32], a: I) =
            *to.first_chunk_mut::<4>().expect("four lanes") = bytemuck::cast(a.to_array());
        store_d(to: &mut [f64; MAX_LANES], a: D) = {
            to[..2].copy_from_slice(a[0].as_array());
            to[2..4].copy_from_slice(a[1].as_array());
        };

        gather(table: &[[f32; 4]], triangles: &[[u32; 3]], missing: [f32; 4]) -> [[F; 4]; 3] = [
            gather(table, triangles, 0, missing),
            gather(table, triangles, 1, missing),
            gather(table, triangles, 2, missing),
        ];
    }

    #[inline(always)]
    fn shift_right<const BITS: u32>(self, a: I) -> I {
        a >> BITS as i32
    }

    #[inline(always)]
    fn shift_left<const BITS: u32>(self, a: I) -> I {
        a << BITS as i32
    }
}

#[inline(always)]
fn gather(table: &[[f32; 4]], triangles: &[[u32; 3]], corner: usize, missing: [f32; 4]) -> [F; 4] {
    let triangles = &triangles[..4];
    let entry = |lane: usize| -> F {
        F::new(table.get(triangles[lane][corner] as usize).copied().unwrap_or(missing))
    };
    F::transpose([entry(0), entry(1), entry(2), entry(3)])
}
