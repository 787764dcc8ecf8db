//! Lanes in the registers of AVX2.

use std::arch::x86_64 as arch;
use std::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

use super::{Floats, Gather, Ints, LANES, Lanes, Masks, Work};

/// Registers of 256 bits. Values of its types are made only in functions that were entered after the
/// machine had been asked for AVX2, so that every intrinsic here finds what it needs.
#[derive(Clone, Copy)]
pub(crate) struct Avx2;

/// Eight floats in a register.
#[derive(Clone, Copy)]
pub(crate) struct Float(arch::__m256);

/// Eight whole numbers in a register.
#[derive(Clone, Copy)]
pub(crate) struct Int(arch::__m256i);

/// All bits of a lane set, or none.
#[derive(Clone, Copy)]
pub(crate) struct Mask(arch::__m256);

impl Lanes for Avx2 {
    type Float = Float;
    type Int = Int;
    type Mask = Mask;
}

/// Calls intrinsics whose only demand is the processor's feature.
macro_rules! intrinsic {
    ($call:expr) => {
        // SAFETY: values of these types exist only in functions compiled for the feature and
        // entered after the processor had been asked for it (see `simd_dispatch`)
        unsafe { $call }
    };
}

macro_rules! lanewise {
    ($($type:ident: $trait:ident $method:ident $intrinsic:ident),*) => {
        $(impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(intrinsic!(arch::$intrinsic(self.0, other.0)))
            }
        })*
    };
}

lanewise!(
    Float: Add add _mm256_add_ps,
    Float: Sub sub _mm256_sub_ps,
    Float: Mul mul _mm256_mul_ps,
    Int: Add add _mm256_add_epi32,
    Int: Sub sub _mm256_sub_epi32,
    Int: Mul mul _mm256_mullo_epi32,
    Mask: BitAnd bitand _mm256_and_ps,
    Mask: BitOr bitor _mm256_or_ps
);

impl Neg for Float {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(intrinsic!(arch::_mm256_xor_ps(
            self.0,
            arch::_mm256_set1_ps(-0.0)
        )))
    }
}

impl Floats<Avx2> for Float {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(intrinsic!(arch::_mm256_set1_ps(value)))
    }
    #[inline(always)]
    fn load(values: &[f32; LANES]) -> Self {
        Self(intrinsic!(arch::_mm256_loadu_ps(values.as_ptr())))
    }
    #[inline(always)]
    fn store(self) -> [f32; LANES] {
        let mut values = [0.0; LANES];
        intrinsic!(arch::_mm256_storeu_ps(values.as_mut_ptr(), self.0));
        values
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm256_div_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(intrinsic!(arch::_mm256_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(intrinsic!(arch::_mm256_floor_ps(self.0)))
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self(intrinsic!(arch::_mm256_ceil_ps(self.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsic!(arch::_mm256_andnot_ps(
            arch::_mm256_set1_ps(-0.0),
            self.0
        )))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm256_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm256_max_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Mask {
        Mask(intrinsic!(arch::_mm256_cmp_ps::<{ arch::_CMP_LT_OQ }>(
            self.0, other.0
        )))
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> Mask {
        Mask(intrinsic!(arch::_mm256_cmp_ps::<{ arch::_CMP_LE_OQ }>(
            self.0, other.0
        )))
    }
    #[inline(always)]
    fn truncated(self) -> Int {
        Int(intrinsic!(arch::_mm256_cvttps_epi32(self.0)))
    }
    #[inline(always)]
    fn or_else(self, mask: Mask, other: Self) -> Self {
        Self(intrinsic!(arch::_mm256_blendv_ps(other.0, self.0, mask.0)))
    }
    #[inline(always)]
    fn from_bits(bits: Int) -> Self {
        Self(intrinsic!(arch::_mm256_castsi256_ps(bits.0)))
    }
    #[inline(always)]
    fn bits(self) -> Int {
        Int(intrinsic!(arch::_mm256_castps_si256(self.0)))
    }
}

impl Ints<Avx2> for Int {
    #[inline(always)]
    fn splat(value: i32) -> Self {
        Self(intrinsic!(arch::_mm256_set1_epi32(value)))
    }
    #[inline(always)]
    fn load(values: &[i32; LANES]) -> Self {
        Self(intrinsic!(arch::_mm256_loadu_si256(values.as_ptr().cast())))
    }
    #[inline(always)]
    fn store(self) -> [i32; LANES] {
        let mut values = [0; LANES];
        intrinsic!(arch::_mm256_storeu_si256(
            values.as_mut_ptr().cast(),
            self.0
        ));
        values
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm256_min_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm256_max_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(intrinsic!(arch::_mm256_and_si256(self.0, other.0)))
    }
    #[inline(always)]
    fn shifted_left<const BITS: i32>(self) -> Self {
        Self(intrinsic!(arch::_mm256_slli_epi32::<BITS>(self.0)))
    }
    #[inline(always)]
    fn shifted_right<const BITS: i32>(self) -> Self {
        Self(intrinsic!(arch::_mm256_srai_epi32::<BITS>(self.0)))
    }
    #[inline(always)]
    fn greater(self, other: Self) -> Mask {
        Mask(intrinsic!(arch::_mm256_castsi256_ps(
            arch::_mm256_cmpgt_epi32(self.0, other.0)
        )))
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Mask {
        Mask(intrinsic!(arch::_mm256_castsi256_ps(
            arch::_mm256_cmpeq_epi32(self.0, other.0)
        )))
    }
    #[inline(always)]
    fn or_else(self, mask: Mask, other: Self) -> Self {
        Self(intrinsic!(arch::_mm256_castps_si256(
            arch::_mm256_blendv_ps(
                arch::_mm256_castsi256_ps(other.0),
                arch::_mm256_castsi256_ps(self.0),
                mask.0
            )
        )))
    }
    #[inline(always)]
    fn to_float(self) -> Float {
        Float(intrinsic!(arch::_mm256_cvtepi32_ps(self.0)))
    }
}

impl Not for Mask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(intrinsic!(arch::_mm256_xor_ps(
            self.0,
            arch::_mm256_castsi256_ps(arch::_mm256_set1_epi32(-1))
        )))
    }
}

impl Masks for Mask {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(intrinsic!(arch::_mm256_castsi256_ps(
            arch::_mm256_set1_epi32(-i32::from(value))
        )))
    }
    #[inline(always)]
    fn from_bits(bits: u8) -> Self {
        Self(intrinsic!({
            let places = arch::_mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let here = arch::_mm256_and_si256(arch::_mm256_set1_epi32(i32::from(bits)), places);
            arch::_mm256_castsi256_ps(arch::_mm256_cmpeq_epi32(here, places))
        }))
    }
    #[inline(always)]
    fn bits(self) -> u8 {
        intrinsic!(arch::_mm256_movemask_ps(self.0)) as u8
    }
}

#[inline(never)]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
fn done_apart<W: Work<Avx2>>(work: W) -> W::Done {
    work.done()
}

impl Gather for Avx2 {
    #[inline(always)]
    fn apart<W: Work<Self>>(work: W) -> W::Done {
        intrinsic!(done_apart(work))
    }
    #[inline(always)]
    unsafe fn pairs(values: &[i16], places: &[i32; LANES], offset: i32) -> Int {
        let values = values.as_ptr().wrapping_offset(offset as isize);
        // SAFETY: the caller warrants each place and the next
        Int(unsafe { words(values.cast(), 2, places) })
    }
    #[inline(always)]
    unsafe fn fours(values: &[i16], places: &[i32; LANES], offset: i32) -> [Int; 2] {
        let values = values.as_ptr().wrapping_offset(offset as isize);
        // SAFETY: the caller warrants each place and the next three
        let (some, others) = unsafe {
            (
                halves(
                    two_longs(values, places[0], places[1]),
                    two_longs(values, places[4], places[5]),
                ),
                halves(
                    two_longs(values, places[2], places[3]),
                    two_longs(values, places[6], places[7]),
                ),
            )
        };
        intrinsic!({
            let (some, others) = (
                arch::_mm256_castsi256_ps(some),
                arch::_mm256_castsi256_ps(others),
            );
            let first = arch::_mm256_shuffle_ps::<0x88>(some, others);
            let last = arch::_mm256_shuffle_ps::<0xdd>(some, others);
            [
                Int(arch::_mm256_castps_si256(first)),
                Int(arch::_mm256_castps_si256(last)),
            ]
        })
    }
    #[inline(always)]
    unsafe fn ints(numbers: &[i32], places: Int) -> Int {
        // SAFETY: the caller warrants each place
        Int(unsafe { words(numbers.as_ptr().cast(), 4, &places.store()) })
    }
    #[inline(always)]
    unsafe fn bytes(bytes: &[u8], places: Int) -> Int {
        // SAFETY: the caller warrants each place and three bytes more
        let words = unsafe { words(bytes.as_ptr(), 1, &places.store()) };
        Int(words).and(Ints::splat(0xff))
    }
    #[inline(always)]
    unsafe fn rows(rows: &[[f32; 4]], places: Int) -> [Float; 4] {
        let places = places.store();
        // SAFETY: the caller warrants the places
        let [a, b, c, d] = unsafe {
            [
                two_rows(rows, places[0], places[4]),
                two_rows(rows, places[1], places[5]),
                two_rows(rows, places[2], places[6]),
                two_rows(rows, places[3], places[7]),
            ]
        };
        intrinsic!({
            let (ab_low, ab_high) = (
                arch::_mm256_unpacklo_ps(a, b),
                arch::_mm256_unpackhi_ps(a, b),
            );
            let (cd_low, cd_high) = (
                arch::_mm256_unpacklo_ps(c, d),
                arch::_mm256_unpackhi_ps(c, d),
            );
            [
                Float(arch::_mm256_shuffle_ps::<0x44>(ab_low, cd_low)),
                Float(arch::_mm256_shuffle_ps::<0xee>(ab_low, cd_low)),
                Float(arch::_mm256_shuffle_ps::<0x44>(ab_high, cd_high)),
                Float(arch::_mm256_shuffle_ps::<0xee>(ab_high, cd_high)),
            ]
        })
    }
}

/// A word of four bytes from each of eight places, counted in so many bytes. Many processors take half as long for
/// eight loads as for the instruction that gathers them, some a tenth since it was mended (Downfall, 2023).
///
/// No closures here and no `map`: what is not inlined at once is compiled without AVX2.
///
/// # Safety
/// The words must be there.
#[inline(always)]
unsafe fn words(from: *const u8, size: isize, places: &[i32; LANES]) -> arch::__m256i {
    let [a, b, c, d, e, f, g, h] = *places;
    // SAFETY: the caller warrants the places
    unsafe {
        halves(
            four_words(from, size, [a, b, c, d]),
            four_words(from, size, [e, f, g, h]),
        )
    }
}

/// # Safety
/// As for [`words`].
#[inline(always)]
unsafe fn four_words(from: *const u8, size: isize, [a, b, c, d]: [i32; 4]) -> arch::__m128i {
    // SAFETY: the caller warrants the places
    unsafe {
        arch::_mm_unpacklo_epi64(
            arch::_mm_unpacklo_epi32(word(from, size, a), word(from, size, b)),
            arch::_mm_unpacklo_epi32(word(from, size, c), word(from, size, d)),
        )
    }
}

/// # Safety
/// As for [`words`].
#[inline(always)]
unsafe fn word(from: *const u8, size: isize, place: i32) -> arch::__m128i {
    // SAFETY: the caller warrants the place
    unsafe { arch::_mm_loadu_si32(from.wrapping_offset(size * place as isize)) }
}

/// Four values from each of two places.
///
/// # Safety
/// They must be there.
#[inline(always)]
unsafe fn two_longs(values: *const i16, a: i32, b: i32) -> arch::__m128i {
    // SAFETY: the caller warrants the places
    unsafe {
        arch::_mm_unpacklo_epi64(
            arch::_mm_loadl_epi64(values.wrapping_offset(a as isize).cast()),
            arch::_mm_loadl_epi64(values.wrapping_offset(b as isize).cast()),
        )
    }
}

#[inline(always)]
fn halves(low: arch::__m128i, high: arch::__m128i) -> arch::__m256i {
    intrinsic!(arch::_mm256_inserti128_si256::<1>(
        arch::_mm256_castsi128_si256(low),
        high
    ))
}

/// One row in the lower half, one in the upper.
///
/// # Safety
/// Both places must lie within `rows`.
#[inline(always)]
unsafe fn two_rows(rows: &[[f32; 4]], low: i32, high: i32) -> arch::__m256 {
    // SAFETY: the caller warrants the places
    unsafe {
        let low = arch::_mm_loadu_ps(rows.as_ptr().add(low as usize).cast());
        let high = arch::_mm_loadu_ps(rows.as_ptr().add(high as usize).cast());
        arch::_mm256_insertf128_ps::<1>(arch::_mm256_castps128_ps256(low), high)
    }
}
