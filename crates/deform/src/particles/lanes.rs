//! Eight numbers at once, in the widest registers that the machine has.
//!
//! The pair loop is written once over [`Lanes`] and compiled three times: AVX-512, AVX2 with
//! FMA, and plain code for any other machine. Results of two kinds of machine differ in their
//! last bits, those of one machine never.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64 as arch;

use super::space::Space;
use super::state::Site;

/// Lanes of every kind.
pub const LANES: usize = 8;

/// Which registers to compute in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Registers {
    /// The widest that the machine has.
    #[default]
    Best,
    /// AVX-512, where there is.
    Avx512,
    /// AVX2 and FMA, where there is.
    Avx2,
    /// Those that every machine has.
    Plain,
}

impl Registers {
    /// Never more than the machine has, and never `Best`.
    pub(crate) fn there(self) -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let wide = matches!(self, Self::Best | Self::Avx512);
            if wide && is_x86_feature_detected!("avx512f") {
                return Self::Avx512;
            }
            let fused = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            if self != Self::Plain && fused {
                return Self::Avx2;
            }
        }
        Self::Plain
    }
}

/// Eight doubles and what the pair loop does with them. A mask has one bit per lane.
pub trait Lanes: Copy {
    fn splat(value: f64) -> Self;
    fn load(values: &[f64; LANES]) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    /// `self * factor + term`, rounded once where the machine can.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn sqrt(self) -> Self;
    fn max(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    fn abs(self) -> Self;
    /// To the nearest whole number, half to even.
    fn round(self) -> Self;
    /// Which lanes are less; a lane that is no number is not.
    fn less(self, other: Self) -> u8;
    /// Lanes of `self` where the mask has a bit, else zero.
    fn keep(self, mask: u8) -> Self;
    /// x, y, z and softness of eight sites.
    ///
    /// # Safety
    /// Every index must lie within `sites`.
    unsafe fn gather(sites: &[Site], indices: &[u32; LANES]) -> [Self; 4];
    /// Appends those values whose bit is set.
    fn push_where(mask: u8, values: &[u32; LANES], list: &mut Vec<u32>);
    /// Sum of the lanes, always in the same order.
    fn sum(self) -> f64;
}

/// Σ of the squares of three coordinates.
#[inline(always)]
pub(crate) fn squared_length<V: Lanes>(offset: [V; 3]) -> V {
    let [x, y, z] = offset;
    x.mul_add(x, y.mul_add(y, z.mul(z)))
}

/// Sides of a box that repeats itself, and their inverses.
#[derive(Clone, Copy)]
pub(crate) struct Wrap<V> {
    sides: [V; 3],
    inverses: [V; 3],
}

impl<V: Lanes> Wrap<V> {
    #[inline(always)]
    pub(crate) fn new(space: Space) -> Self {
        let sides = space.sides();
        Self {
            sides: [V::splat(sides.x), V::splat(sides.y), V::splat(sides.z)],
            inverses: [
                V::splat(sides.x.recip()),
                V::splat(sides.y.recip()),
                V::splat(sides.z.recip()),
            ],
        }
    }

    /// The shortest of all equal offsets.
    #[inline(always)]
    pub(crate) fn nearest(&self, offset: [V; 3]) -> [V; 3] {
        [
            self.along(0, offset[0]),
            self.along(1, offset[1]),
            self.along(2, offset[2]),
        ]
    }

    #[inline(always)]
    fn along(&self, axis: usize, offset: V) -> V {
        offset.sub(self.sides[axis].mul(offset.mul(self.inverses[axis]).round()))
    }
}

/// Plain code.
#[derive(Clone, Copy)]
pub(crate) struct Plain([f64; LANES]);

impl Plain {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }
}

impl Lanes for Plain {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; LANES])
    }
    #[inline(always)]
    fn load(values: &[f64; LANES]) -> Self {
        Self(*values)
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self.mul(factor).add(term)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(self.0.map(f64::round_ties_even))
    }
    #[inline(always)]
    fn less(self, other: Self) -> u8 {
        (0..LANES).fold(0, |mask, i| mask | u8::from(self.0[i] < other.0[i]) << i)
    }
    #[inline(always)]
    fn keep(self, mask: u8) -> Self {
        Self(std::array::from_fn(|i| {
            if mask >> i & 1 != 0 { self.0[i] } else { 0.0 }
        }))
    }
    #[inline(always)]
    unsafe fn gather(sites: &[Site], indices: &[u32; LANES]) -> [Self; 4] {
        let site = |i: usize| &sites[indices[i] as usize];
        [
            Self(std::array::from_fn(|i| site(i).x)),
            Self(std::array::from_fn(|i| site(i).y)),
            Self(std::array::from_fn(|i| site(i).z)),
            Self(std::array::from_fn(|i| site(i).softness)),
        ]
    }
    #[inline(always)]
    fn push_where(mut mask: u8, values: &[u32; LANES], list: &mut Vec<u32>) {
        while mask != 0 {
            list.push(values[mask.trailing_zeros() as usize]);
            mask &= mask - 1;
        }
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        let [a, b, c, d, e, f, g, h] = self.0;
        ((a + e) + (c + g)) + ((b + f) + (d + h))
    }
}

/// One register of AVX-512. Made only in functions that were entered after the machine had
/// been asked for it, so that every intrinsic here finds what it needs.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(crate) struct Wide(arch::__m512d);

/// Calls intrinsics whose only demand is the processor's feature.
#[cfg(target_arch = "x86_64")]
macro_rules! intrinsic {
    ($call:expr) => {
        // SAFETY: values of this type exist only in functions compiled for the feature and
        // entered after the processor had been asked for it (see `pair_force::accumulate`)
        unsafe { $call }
    };
}

#[cfg(target_arch = "x86_64")]
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

#[cfg(target_arch = "x86_64")]
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
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(crate) struct Halves(arch::__m256d, arch::__m256d);

#[cfg(target_arch = "x86_64")]
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

#[cfg(target_arch = "x86_64")]
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
