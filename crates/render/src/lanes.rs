//! Eight rays side by side: the arithmetic of the ray caster, written once and compiled for AVX2 and
//! for any machine.
//!
//! Both give the same bits: nothing is fused, and functions of a real variable are the same polynomials
//! (`functions.rs`). Every method is inlined into a loop that is compiled for the feature; so no closures
//! in those loops, whose bodies would be compiled without it.

use std::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

mod functions;
mod plain;
mod vector;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(crate) use functions::{exp_of_negative, power, smoothstep};
pub(crate) use plain::Plain;
pub(crate) use vector::Vector;
#[cfg(target_arch = "x86_64")]
pub(crate) use x86::Avx2;

/// Lanes of every kind.
pub(crate) const LANES: usize = 8;

/// The three kinds of numbers of one instruction set.
pub(crate) trait Lanes: Copy + 'static {
    /// Eight floats.
    type Float: Floats<Self>;
    /// Eight whole numbers.
    type Int: Ints<Self>;
    /// Eight truth values.
    type Mask: Masks;
}

/// Eight floats.
pub(crate) trait Floats<L: Lanes>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    fn splat(value: f32) -> Self;
    fn load(values: &[f32; LANES]) -> Self;
    fn store(self) -> [f32; LANES];
    fn div(self, other: Self) -> Self;
    fn sqrt(self) -> Self;
    fn floor(self) -> Self;
    fn ceil(self) -> Self;
    fn abs(self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn less(self, other: Self) -> L::Mask;
    fn at_most(self, other: Self) -> L::Mask;
    /// Toward zero; lanes beyond an `i32` are undefined numbers.
    fn truncated(self) -> L::Int;
    /// `self` where the mask is set, else `other`.
    fn or_else(self, mask: L::Mask, other: Self) -> Self;
    /// The number with these bits.
    fn from_bits(bits: L::Int) -> Self;
    fn bits(self) -> L::Int;
}

/// Eight whole numbers; sums and products wrap around.
pub(crate) trait Ints<L: Lanes>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    fn splat(value: i32) -> Self;
    fn load(values: &[i32; LANES]) -> Self;
    fn store(self) -> [i32; LANES];
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn and(self, other: Self) -> Self;
    fn shifted_left<const BITS: i32>(self) -> Self;
    /// With the sign.
    fn shifted_right<const BITS: i32>(self) -> Self;
    fn greater(self, other: Self) -> L::Mask;
    fn equal(self, other: Self) -> L::Mask;
    fn or_else(self, mask: L::Mask, other: Self) -> Self;
    fn to_float(self) -> L::Float;
}

/// Eight truth values.
pub(crate) trait Masks:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    fn splat(value: bool) -> Self;
    fn from_bits(bits: u8) -> Self;
    /// One bit for each lane.
    fn bits(self) -> u8;

    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }

    #[inline(always)]
    fn all(self) -> bool {
        self.bits() == u8::MAX
    }
}

/// Work that is compiled as a function of its own; see [`Gather::apart`].
pub(crate) trait Work<L: Gather> {
    type Done;

    /// Does it. To be inlined.
    fn done(self) -> Self::Done;
}

/// Look-ups in memory, one for each lane.
pub(crate) trait Gather: Lanes {
    /// Does work in a function of its own, compiled for the instruction set: what is done seldom and from several
    /// places, so that it is compiled once.
    fn apart<W: Work<Self>>(work: W) -> W::Done;

    /// Two neighbouring values from each place, an offset further: the first in the low half, sign and all, the
    /// second in the high one.
    ///
    /// # Safety
    /// Each place and the one after it must lie within `values`.
    unsafe fn pairs(values: &[i16], places: &[i32; LANES], offset: i32) -> Self::Int;

    /// Four values from each place on, an offset further: the first two and the last two as in [`Self::pairs`].
    ///
    /// # Safety
    /// Each place and the three after it must lie within `values`.
    unsafe fn fours(values: &[i16], places: &[i32; LANES], offset: i32) -> [Self::Int; 2];

    /// Two neighbouring floats from each place.
    ///
    /// # Safety
    /// Each place and the one after it must lie within `floats`.
    #[inline(always)]
    unsafe fn neighbours(floats: &[f32], places: Self::Int) -> [Self::Float; 2] {
        // a float is two halves, and two floats are four
        let places = (places + places).store();
        // SAFETY: the caller warrants each place and the next
        let [first, second] = unsafe { Self::fours(bytemuck::cast_slice(floats), &places, 0) };
        [Floats::from_bits(first), Floats::from_bits(second)]
    }

    /// Whole numbers.
    ///
    /// # Safety
    /// Each place must lie within `numbers`.
    unsafe fn ints(numbers: &[i32], places: Self::Int) -> Self::Int;

    /// Bytes as whole numbers.
    ///
    /// # Safety
    /// Each place must lie within `bytes`, three more bytes before its end.
    unsafe fn bytes(bytes: &[u8], places: Self::Int) -> Self::Int;

    /// Rows of four floats, column by column.
    ///
    /// # Safety
    /// Each place must lie within `rows`.
    unsafe fn rows(rows: &[[f32; 4]], places: Self::Int) -> [Self::Float; 4];
}
