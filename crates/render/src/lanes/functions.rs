//! Functions of a real variable as polynomials, accurate to a few units of 1e-7 relative to the result.

use super::{Floats, Ints, Lanes};

/// 2 to a power between -126 and 127; less is nearly 0.
#[inline(always)]
fn exp2<L: Lanes>(power: L::Float) -> L::Float {
    let power = power.max(Floats::splat(-126.0)).min(Floats::splat(127.0));
    let whole = power.floor();
    let rest = power - whole;
    // Taylor's series of 2^x about 1/2 would do as well; these are of 2^x about 0, to the 7th power
    let mut sum = L::Float::splat(1.525_273_3e-5);
    for coefficient in [
        1.540_353e-4,
        1.333_355_8e-3,
        9.618_129e-3,
        5.550_411e-2,
        2.402_265e-1,
        6.931_472e-1,
        1.0,
    ] {
        sum = sum * rest + Floats::splat(coefficient);
    }
    let exponent = whole.truncated() + Ints::splat(127);
    sum * L::Float::from_bits(exponent.shifted_left::<23>())
}

/// e to a power that is not positive.
#[inline(always)]
pub(crate) fn exp_of_negative<L: Lanes>(power: L::Float) -> L::Float {
    exp2::<L>(power * Floats::splat(std::f32::consts::LOG2_E))
}

/// Logarithm to base 2 of a positive number.
#[inline(always)]
fn log2<L: Lanes>(number: L::Float) -> L::Float {
    let bits = number.bits();
    let exponent = bits.shifted_right::<23>() - Ints::splat(127);
    let mantissa = bits.and(Ints::splat(0x007f_ffff)) + Ints::splat(0x3f80_0000);
    let m = L::Float::from_bits(mantissa);
    // ln m = 2 artanh((m - 1) / (m + 1)), between 0 and 1/3
    let one = L::Float::splat(1.0);
    let ratio = (m - one).div(m + one);
    let square = ratio * ratio;
    let mut sum = L::Float::splat(1.0 / 11.0);
    for coefficient in [1.0 / 9.0, 1.0 / 7.0, 1.0 / 5.0, 1.0 / 3.0, 1.0] {
        sum = sum * square + Floats::splat(coefficient);
    }
    let natural = L::Float::splat(2.0 * std::f32::consts::LOG2_E) * ratio * sum;
    exponent.to_float() + natural
}

/// A number from 0 on to a positive power.
#[inline(always)]
pub(crate) fn power<L: Lanes>(number: L::Float, exponent: f32) -> L::Float {
    let tiny = L::Float::splat(1e-30);
    exp2::<L>(log2::<L>(number.max(tiny)) * Floats::splat(exponent))
}

/// Hermite's cubic from 0 at 0 to 1 at `end`.
#[inline(always)]
pub(crate) fn smoothstep<L: Lanes>(end: f32, value: L::Float) -> L::Float {
    let place = (value * Floats::splat(1.0 / end))
        .max(Floats::splat(0.0))
        .min(Floats::splat(1.0));
    place * place * (L::Float::splat(3.0) - place - place)
}
