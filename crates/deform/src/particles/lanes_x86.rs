//! Eight lanes in the registers of x86-64: one of AVX-512, or two of AVX2.
//!
//! Every function is inlined into the pair loop or the search for neighbours, which are compiled
//! for the feature; so no closures here, whose bodies would be compiled without it.

use std::arch::x86_64 as arch;

use super::lanes::{LANES, Lanes, Plain};
use super::state::Site;

/// One register of AVX-512. Made only in functions that were entered after the machine had
/// been asked for it, so that every intrinsic here finds what it needs.
#[derive(Clone, Copy)]
pub(crate) struct Wide(arch::__m512d);

/// Calls intrinsics whose only demand is the processor's feature.
macro_rules! intrinsic {
    ($call:expr) => {
        // SAFETY: values of this type exist only in functions compiled for the feature and
        // entered after the processor had been asked for it (see `simd_dispatch`)
        unsafe { $call }
    };
}

impl Wide {
    /// One site in the lower half, one in the upper.
    ///
    /// # Safety
    /// Both indices must lie within `sites`.
    #[inline(always)]
    unsafe fn two_rows(sites: &[Site], low: u32, high: u32) -> arch::__m512d {
        // SAFETY: the caller warrants the indices; a site is four doubles, aligned to 32 bytes
        unsafe {
            let low = sites.as_ptr().add(low as usize).cast::<f64>();
            let high = sites.as_ptr().add(high as usize).cast::<f64>();
            let lower = arch::_mm512_castpd256_pd512(arch::_mm256_load_pd(low));
            arch::_mm512_insertf64x4::<1>(lower, arch::_mm256_load_pd(high))
        }
    }
}

impl Lanes for Wide {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(intrinsic!(arch::_mm512_set1_pd(value)))
    }
    #[inline(always)]
    fn load(values: &[f64; LANES]) -> Self {
        Self(intrinsic!(arch::_mm512_loadu_pd(values.as_ptr())))
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm512_add_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm512_sub_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm512_mul_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(intrinsic!(arch::_mm512_fmadd_pd(self.0, factor.0, term.0)))
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm512_div_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(intrinsic!(arch::_mm512_sqrt_pd(self.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm512_max_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm512_min_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsic!(arch::_mm512_abs_pd(self.0)))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(intrinsic!(arch::_mm512_roundscale_pd::<0>(self.0)))
    }
    #[inline(always)]
    fn less(self, other: Self) -> u8 {
        intrinsic!(arch::_mm512_cmp_pd_mask::<{ arch::_CMP_LT_OQ }>(
            self.0, other.0
        ))
    }
    #[inline(always)]
    fn keep(self, mask: u8) -> Self {
        Self(intrinsic!(arch::_mm512_maskz_mov_pd(mask, self.0)))
    }
    #[inline(always)]
    unsafe fn gather(sites: &[Site], indices: &[u32; LANES]) -> [Self; 4] {
        // SAFETY: the caller warrants the indices; a site is four doubles, aligned to 32 bytes
        unsafe {
            let rows = [
                Self::two_rows(sites, indices[0], indices[4]),
                Self::two_rows(sites, indices[1], indices[5]),
                Self::two_rows(sites, indices[2], indices[6]),
                Self::two_rows(sites, indices[3], indices[7]),
            ];
            // x x z z | x x z z and y y w w | y y w w
            let (even, odd) = (
                [
                    arch::_mm512_unpacklo_pd(rows[0], rows[1]),
                    arch::_mm512_unpacklo_pd(rows[2], rows[3]),
                ],
                [
                    arch::_mm512_unpackhi_pd(rows[0], rows[1]),
                    arch::_mm512_unpackhi_pd(rows[2], rows[3]),
                ],
            );
            let first = arch::_mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
            let second = arch::_mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
            [
                Self(arch::_mm512_permutex2var_pd(even[0], first, even[1])),
                Self(arch::_mm512_permutex2var_pd(odd[0], first, odd[1])),
                Self(arch::_mm512_permutex2var_pd(even[0], second, even[1])),
                Self(arch::_mm512_permutex2var_pd(odd[0], second, odd[1])),
            ]
        }
    }
    #[inline(always)]
    fn push_where(mask: u8, values: &[u32; LANES], list: &mut Vec<u32>) {
        let mut picked = [0_u32; 2 * LANES];
        intrinsic!({
            let values =
                arch::_mm512_castsi256_si512(arch::_mm256_loadu_si256(values.as_ptr().cast()));
            let picks = arch::_mm512_maskz_compress_epi32(u16::from(mask), values);
            arch::_mm512_storeu_si512(picked.as_mut_ptr().cast(), picks);
        });
        let length = list.len() + mask.count_ones() as usize;
        list.extend_from_slice(&picked[..LANES]);
        list.truncate(length);
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        let mut lanes = [0.0; LANES];
        intrinsic!(arch::_mm512_storeu_pd(lanes.as_mut_ptr(), self.0));
        Plain(lanes).sum()
    }
}

/// Two registers of AVX2, made under the same rule as [`Wide`].
#[derive(Clone, Copy)]
pub(crate) struct Halves(arch::__m256d, arch::__m256d);

impl Halves {
    /// x, y, z and softness of four sites.
    ///
    /// # Safety
    /// Every index must lie within `sites`.
    #[inline(always)]
    unsafe fn four(sites: &[Site], indices: [u32; 4]) -> [arch::__m256d; 4] {
        let first = sites.as_ptr();
        // SAFETY: the caller warrants the indices; a site is four doubles, aligned to 32 bytes
        unsafe {
            let rows = [
                arch::_mm256_load_pd(first.add(indices[0] as usize).cast()),
                arch::_mm256_load_pd(first.add(indices[1] as usize).cast()),
                arch::_mm256_load_pd(first.add(indices[2] as usize).cast()),
                arch::_mm256_load_pd(first.add(indices[3] as usize).cast()),
            ];
            let even = [
                arch::_mm256_unpacklo_pd(rows[0], rows[1]),
                arch::_mm256_unpacklo_pd(rows[2], rows[3]),
            ];
            let odd = [
                arch::_mm256_unpackhi_pd(rows[0], rows[1]),
                arch::_mm256_unpackhi_pd(rows[2], rows[3]),
            ];
            [
                arch::_mm256_permute2f128_pd::<0x20>(even[0], even[1]),
                arch::_mm256_permute2f128_pd::<0x20>(odd[0], odd[1]),
                arch::_mm256_permute2f128_pd::<0x31>(even[0], even[1]),
                arch::_mm256_permute2f128_pd::<0x31>(odd[0], odd[1]),
            ]
        }
    }
}

impl Lanes for Halves {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        let half = intrinsic!(arch::_mm256_set1_pd(value));
        Self(half, half)
    }
    #[inline(always)]
    fn load(values: &[f64; LANES]) -> Self {
        intrinsic!(Self(
            arch::_mm256_loadu_pd(values.as_ptr()),
            arch::_mm256_loadu_pd(values[4..].as_ptr()),
        ))
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        intrinsic!(Self(
            arch::_mm256_add_pd(self.0, other.0),
            arch::_mm256_add_pd(self.1, other.1)
        ))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        intrinsic!(Self(
            arch::_mm256_sub_pd(self.0, other.0),
            arch::_mm256_sub_pd(self.1, other.1)
        ))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        intrinsic!(Self(
            arch::_mm256_mul_pd(self.0, other.0),
            arch::_mm256_mul_pd(self.1, other.1)
        ))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        intrinsic!(Self(
            arch::_mm256_fmadd_pd(self.0, factor.0, term.0),
            arch::_mm256_fmadd_pd(self.1, factor.1, term.1),
        ))
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        intrinsic!(Self(
            arch::_mm256_div_pd(self.0, other.0),
            arch::_mm256_div_pd(self.1, other.1)
        ))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        intrinsic!(Self(
            arch::_mm256_sqrt_pd(self.0),
            arch::_mm256_sqrt_pd(self.1)
        ))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        intrinsic!(Self(
            arch::_mm256_max_pd(self.0, other.0),
            arch::_mm256_max_pd(self.1, other.1)
        ))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        intrinsic!(Self(
            arch::_mm256_min_pd(self.0, other.0),
            arch::_mm256_min_pd(self.1, other.1)
        ))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let sign = Self::splat(-0.0);
        intrinsic!(Self(
            arch::_mm256_andnot_pd(sign.0, self.0),
            arch::_mm256_andnot_pd(sign.1, self.1)
        ))
    }
    #[inline(always)]
    fn round(self) -> Self {
        intrinsic!(Self(
            arch::_mm256_round_pd::<0>(self.0),
            arch::_mm256_round_pd::<0>(self.1)
        ))
    }
    #[inline(always)]
    fn less(self, other: Self) -> u8 {
        intrinsic!({
            let low = arch::_mm256_cmp_pd::<{ arch::_CMP_LT_OQ }>(self.0, other.0);
            let high = arch::_mm256_cmp_pd::<{ arch::_CMP_LT_OQ }>(self.1, other.1);
            (arch::_mm256_movemask_pd(low) | arch::_mm256_movemask_pd(high) << 4) as u8
        })
    }
    #[inline(always)]
    fn keep(self, mask: u8) -> Self {
        intrinsic!({
            let bits = arch::_mm256_setr_epi64x(1, 2, 4, 8);
            let (low, high) = (i64::from(mask), i64::from(mask >> 4));
            let low = arch::_mm256_and_si256(arch::_mm256_set1_epi64x(low), bits);
            let high = arch::_mm256_and_si256(arch::_mm256_set1_epi64x(high), bits);
            let low = arch::_mm256_castsi256_pd(arch::_mm256_cmpeq_epi64(low, bits));
            let high = arch::_mm256_castsi256_pd(arch::_mm256_cmpeq_epi64(high, bits));
            Self(
                arch::_mm256_and_pd(low, self.0),
                arch::_mm256_and_pd(high, self.1),
            )
        })
    }
    #[inline(always)]
    unsafe fn gather(sites: &[Site], indices: &[u32; LANES]) -> [Self; 4] {
        let [a, b, c, d, e, f, g, h] = *indices;
        // SAFETY: the caller warrants the indices
        let (low, high) = unsafe {
            (
                Self::four(sites, [a, b, c, d]),
                Self::four(sites, [e, f, g, h]),
            )
        };
        [
            Self(low[0], high[0]),
            Self(low[1], high[1]),
            Self(low[2], high[2]),
            Self(low[3], high[3]),
        ]
    }
    #[inline(always)]
    fn push_where(mask: u8, values: &[u32; LANES], list: &mut Vec<u32>) {
        Plain::push_where(mask, values, list);
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        let mut lanes = [0.0; LANES];
        intrinsic!({
            arch::_mm256_storeu_pd(lanes.as_mut_ptr(), self.0);
            arch::_mm256_storeu_pd(lanes[4..].as_mut_ptr(), self.1);
        });
        Plain(lanes).sum()
    }
}
