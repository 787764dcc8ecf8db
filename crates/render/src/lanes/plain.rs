//! Lanes for machines of any kind: two registers of four, of the instructions that all machines of an architecture have.

use std::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

use wide::{f32x8, i32x8};

use super::{Floats, Gather, Ints, LANES, Lanes, Masks, Work};

/// What every machine has.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

/// Eight floats.
#[derive(Clone, Copy)]
pub(crate) struct Float(f32x8);

/// Eight whole numbers.
#[derive(Clone, Copy)]
pub(crate) struct Int(i32x8);

/// All bits of a lane set, or none.
#[derive(Clone, Copy)]
pub(crate) struct Mask(i32x8);

impl Lanes for Plain {
    type Float = Float;
    type Int = Int;
    type Mask = Mask;
}

macro_rules! lanewise {
    ($($type:ident: $trait:ident $method:ident),*) => {
        $(impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        })*
    };
}

lanewise!(
    Float: Add add, Float: Sub sub, Float: Mul mul,
    Int: Add add, Int: Sub sub, Int: Mul mul,
    Mask: BitAnd bitand, Mask: BitOr bitor
);

#[inline(always)]
fn bits_of(floats: f32x8) -> i32x8 {
    bytemuck::cast(floats)
}

#[inline(always)]
fn with_bits(bits: i32x8) -> f32x8 {
    bytemuck::cast(bits)
}

impl Neg for Float {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Floats<Plain> for Float {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(f32x8::splat(value))
    }
    #[inline(always)]
    fn store(self) -> [f32; LANES] {
        self.0.to_array()
    }
    #[inline(always)]
    fn load(values: &[f32; LANES]) -> Self {
        Self(f32x8::new(*values))
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(self.0.floor())
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self(self.0.ceil())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // as the processor has it: the second where they cannot be compared
        self.or_else(self.less(other), other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.or_else(other.less(self), other)
    }
    #[inline(always)]
    fn less(self, other: Self) -> Mask {
        Mask(bits_of(self.0.simd_lt(other.0)))
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> Mask {
        Mask(bits_of(self.0.simd_le(other.0)))
    }
    #[inline(always)]
    fn truncated(self) -> Int {
        Int(self.0.fast_trunc_int())
    }
    #[inline(always)]
    fn or_else(self, mask: Mask, other: Self) -> Self {
        Self(with_bits(mask.choose(bits_of(self.0), bits_of(other.0))))
    }
    #[inline(always)]
    fn from_bits(bits: Int) -> Self {
        Self(with_bits(bits.0))
    }
    #[inline(always)]
    fn bits(self) -> Int {
        Int(bits_of(self.0))
    }
}

impl Ints<Plain> for Int {
    #[inline(always)]
    fn splat(value: i32) -> Self {
        Self(i32x8::splat(value))
    }
    #[inline(always)]
    fn load(values: &[i32; LANES]) -> Self {
        Self(i32x8::new(*values))
    }
    #[inline(always)]
    fn store(self) -> [i32; LANES] {
        self.0.to_array()
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
    #[inline(always)]
    fn shifted_left<const BITS: i32>(self) -> Self {
        Self(self.0 << BITS)
    }
    #[inline(always)]
    fn shifted_right<const BITS: i32>(self) -> Self {
        Self(self.0 >> BITS)
    }
    #[inline(always)]
    fn greater(self, other: Self) -> Mask {
        Mask(self.0.simd_gt(other.0))
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Mask {
        Mask(self.0.simd_eq(other.0))
    }
    #[inline(always)]
    fn or_else(self, mask: Mask, other: Self) -> Self {
        Self(mask.choose(self.0, other.0))
    }
    #[inline(always)]
    fn to_float(self) -> Float {
        Float(f32x8::from_i32x8(self.0))
    }
}

impl Mask {
    #[inline(always)]
    fn choose(self, one: i32x8, other: i32x8) -> i32x8 {
        (one & self.0) | (other & !self.0)
    }
}

impl Not for Mask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Masks for Mask {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(i32x8::splat(-i32::from(value)))
    }
    #[inline(always)]
    fn from_bits(bits: u8) -> Self {
        let places = i32x8::new([1, 2, 4, 8, 16, 32, 64, 128]);
        Self((i32x8::splat(i32::from(bits)) & places).simd_eq(places))
    }
    #[inline(always)]
    fn bits(self) -> u8 {
        self.0.to_bitmask() as u8
    }
}

impl Gather for Plain {
    #[inline(never)]
    fn apart<W: Work<Self>>(work: W) -> W::Done {
        work.done()
    }
    #[inline(always)]
    unsafe fn pairs(values: &[i16], places: &[i32; LANES], offset: i32) -> Int {
        Ints::load(&places.map(|place| {
            let place = (place + offset) as usize;
            i32::from(values[place + 1]) << 16 | i32::from(values[place] as u16)
        }))
    }
    #[inline(always)]
    unsafe fn fours(values: &[i16], places: &[i32; LANES], offset: i32) -> [Int; 2] {
        // SAFETY: the caller warrants each place and the next three
        unsafe {
            [
                Self::pairs(values, places, offset),
                Self::pairs(values, places, offset + 2),
            ]
        }
    }
    #[inline(always)]
    unsafe fn ints(numbers: &[i32], places: Int) -> Int {
        Ints::load(&places.store().map(|place| numbers[place as usize]))
    }
    #[inline(always)]
    unsafe fn bytes(bytes: &[u8], places: Int) -> Int {
        let mut found = [0; LANES];
        for (byte, place) in found.iter_mut().zip(places.store()) {
            *byte = i32::from(bytes[place as usize]);
        }
        Ints::load(&found)
    }
    #[inline(always)]
    unsafe fn rows(rows: &[[f32; 4]], places: Int) -> [Float; 4] {
        let mut columns = [[0.0; LANES]; 4];
        for (lane, place) in places.store().into_iter().enumerate() {
            for (column, value) in columns.iter_mut().zip(rows[place as usize]) {
                column[lane] = value;
            }
        }
        [
            Floats::load(&columns[0]),
            Floats::load(&columns[1]),
            Floats::load(&columns[2]),
            Floats::load(&columns[3]),
        ]
    }
}
