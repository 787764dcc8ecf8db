//! Eight numbers at once, in the widest registers that the machine has.
//!
//! The pair loop is written once over [`Lanes`] and compiled three times: AVX-512, AVX2 with
//! FMA, and plain code for any other machine. Results of two kinds of machine differ in their
//! last bits, those of one machine never.

use super::space::Space;
use super::state::Site;

#[cfg(target_arch = "x86_64")]
pub(crate) use super::lanes_x86::{Halves, Wide};

/// Lanes of every kind.
pub const LANES: usize = 8;

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
pub(crate) struct Plain(pub(super) [f64; LANES]);

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
