//! One function compiled for several vector instruction sets; the widest that the machine has runs.
//!
//! Wheels are built for machines without them. Where one body serves all sets, no multiplication is
//! joined with an addition, so that all of them give the same bits.

/// Vector instruction sets that functions are compiled for, by rising width.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SimdLevel {
    /// What every machine has.
    Plain,
    /// AVX2 with FMA, BMI1, BMI2 and POPCNT.
    Avx2,
    /// AVX-512 F, VL and DQ, beside AVX2.
    Avx512,
}

impl Default for SimdLevel {
    /// The widest that the machine has.
    fn default() -> Self {
        Self::widest()
    }
}

impl SimdLevel {
    /// The widest that the machine has; looked up once, by the first caller.
    #[inline(always)]
    #[must_use]
    pub fn widest() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            x86::widest()
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            Self::Plain
        }
    }

    /// This level, or the widest that the machine has where that is less.
    #[inline(always)]
    #[must_use]
    pub fn available(self) -> Self {
        self.min(Self::widest())
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::SimdLevel;
    use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

    const PLAIN: u8 = 1;
    const AVX2: u8 = 2;
    const AVX512: u8 = 3;

    /// 0 until the first look-up.
    static KNOWN: AtomicU8 = AtomicU8::new(0);

    #[inline(always)]
    pub(super) fn widest() -> SimdLevel {
        let known = match KNOWN.load(Relaxed) {
            0 => look_up(),
            known => known,
        };
        match known {
            AVX512 => SimdLevel::Avx512,
            AVX2 => SimdLevel::Avx2,
            _ => SimdLevel::Plain,
        }
    }

    #[cold]
    fn look_up() -> u8 {
        let avx2 = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("popcnt");
        let avx512 = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512dq");
        let known = match (avx2, avx512) {
            (true, true) => AVX512,
            (true, false) => AVX2,
            _ => PLAIN,
        };
        KNOWN.store(known, Relaxed);
        known
    }
}

/// Makes a function whose body is compiled for plain machines and for the instruction sets in
/// brackets, and which runs the widest of them that the machine has. Bodies have to be inlined:
/// what they only call is compiled for plain machines.
///
/// ```
/// # use palpate_volume::simd_dispatch;
/// simd_dispatch! {
///     /// One body for all sets.
///     fn total(numbers: &[f64]) -> f64 = [avx512, avx2] total_body
/// }
///
/// #[inline(always)]
/// fn total_body(numbers: &[f64]) -> f64 {
///     numbers.iter().sum()
/// }
/// assert_eq!(total(&[1.0, 2.0]), 3.0);
/// ```
///
/// Generic parameters stand in brackets after the name. `[avx512 => wide, avx2 => half] plain, at
/// level` has a body for each set, and runs at most the given [`SimdLevel`];
/// without `avx512 => wide` that of AVX2 serves it too.
#[macro_export]
macro_rules! simd_dispatch {
    (
        $(#[$doc:meta])*
        $visible:vis fn $name:ident $([$($generics:tt)*])? ($($argument:ident: $type:ty),* $(,)?)
        $(-> $result:ty)? = [avx2] $body:path
    ) => {
        $(#[$doc])*
        $visible fn $name $(<$($generics)*>)? ($($argument: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            let level = $crate::simd_dispatch::SimdLevel::widest();
            $crate::simd_dispatch! {
                @run level, avx2, [$($($generics)*)?] [$($argument: $type),*] [$(-> $result)?] $body
            }
            $body($($argument),*)
        }
    };
    (
        $(#[$doc:meta])*
        $visible:vis fn $name:ident $([$($generics:tt)*])? ($($argument:ident: $type:ty),* $(,)?)
        $(-> $result:ty)? = [avx512, avx2] $body:path
    ) => {
        $(#[$doc])*
        $visible fn $name $(<$($generics)*>)? ($($argument: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            let level = $crate::simd_dispatch::SimdLevel::widest();
            $crate::simd_dispatch! {
                @run level, avx512, [$($($generics)*)?] [$($argument: $type),*] [$(-> $result)?] $body
            }
            $crate::simd_dispatch! {
                @run level, avx2, [$($($generics)*)?] [$($argument: $type),*] [$(-> $result)?] $body
            }
            $body($($argument),*)
        }
    };
    (
        $(#[$doc:meta])*
        $visible:vis fn $name:ident $([$($generics:tt)*])? ($($argument:ident: $type:ty),* $(,)?)
        $(-> $result:ty)? = [avx512 => $wide:path, avx2 => $half:path] $plain:path, at $level:expr
    ) => {
        $(#[$doc])*
        $visible fn $name $(<$($generics)*>)? ($($argument: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            let level = $crate::simd_dispatch::SimdLevel::available($level);
            $crate::simd_dispatch! {
                @run level, avx512, [$($($generics)*)?] [$($argument: $type),*] [$(-> $result)?] $wide
            }
            $crate::simd_dispatch! {
                @run level, avx2, [$($($generics)*)?] [$($argument: $type),*] [$(-> $result)?] $half
            }
            $plain($($argument),*)
        }
    };

    (
        $(#[$doc:meta])*
        $visible:vis fn $name:ident $([$($generics:tt)*])? ($($argument:ident: $type:ty),* $(,)?)
        $(-> $result:ty)? = [avx2 => $half:path] $plain:path, at $level:expr
    ) => {
        $(#[$doc])*
        $visible fn $name $(<$($generics)*>)? ($($argument: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            let level = $crate::simd_dispatch::SimdLevel::available($level);
            $crate::simd_dispatch! {
                @run level, avx2, [$($($generics)*)?] [$($argument: $type),*] [$(-> $result)?] $half
            }
            $plain($($argument),*)
        }
    };
    (@run $level:ident, avx2, $generics:tt $arguments:tt $result:tt $body:path) => {
        $crate::simd_dispatch! {
            @with "avx2,fma,bmi1,bmi2,popcnt", $level >= $crate::simd_dispatch::SimdLevel::Avx2,
            $generics $arguments $result $body
        }
    };
    (@run $level:ident, avx512, $generics:tt $arguments:tt $result:tt $body:path) => {
        $crate::simd_dispatch! {
            @with "avx512f,avx512vl,avx512dq,avx2,fma,bmi1,bmi2,popcnt",
            $level >= $crate::simd_dispatch::SimdLevel::Avx512,
            $generics $arguments $result $body
        }
    };
    (
        @with $features:literal, $has_them:expr,
        [$($generics:tt)*] [$($argument:ident: $type:ty),*] [$($result:tt)*] $body:path
    ) => {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = $features)]
            fn compiled<$($generics)*>($($argument: $type),*) $($result)* {
                $body($($argument),*)
            }
            if $has_them {
                // SAFETY: the machine has these instructions, as was just asked
                return unsafe { compiled($($argument),*) };
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::SimdLevel;

    simd_dispatch! {
        fn at_most(level: SimdLevel) -> SimdLevel = [avx512 => avx512, avx2 => avx2] plain, at level
    }
    fn plain(_: SimdLevel) -> SimdLevel {
        SimdLevel::Plain
    }
    fn avx2(_: SimdLevel) -> SimdLevel {
        SimdLevel::Avx2
    }
    fn avx512(_: SimdLevel) -> SimdLevel {
        SimdLevel::Avx512
    }

    #[test]
    fn what_runs_is_the_widest_that_is_asked_for_and_that_the_machine_has() {
        let widest = SimdLevel::widest();
        for level in [SimdLevel::Plain, SimdLevel::Avx2, SimdLevel::Avx512] {
            assert_eq!(at_most(level), level.min(widest));
        }
        assert_eq!(SimdLevel::default(), widest);
    }

    simd_dispatch! {
        fn sums[const N: usize](numbers: &[[f64; N]]) -> [f64; N] = [avx512, avx2] sums_body
    }
    simd_dispatch! {
        fn sums_up_to_avx2[const N: usize](numbers: &[[f64; N]]) -> [f64; N] = [avx2] sums_body
    }

    #[inline(always)]
    fn sums_body<const N: usize>(numbers: &[[f64; N]]) -> [f64; N] {
        numbers.iter().fold([0.0; N], |sum, numbers| {
            std::array::from_fn(|i| sum[i] * 0.3 + numbers[i] * numbers[i])
        })
    }

    #[test]
    fn one_body_gives_the_same_bits_for_each_set() {
        let mut random = oorandom::Rand64::new(3);
        let numbers: Vec<[f64; 16]> = (0..99)
            .map(|_| std::array::from_fn(|_| random.rand_float() - 0.5))
            .collect();
        let plain = sums_body(&numbers).map(f64::to_bits);
        assert_eq!(sums(&numbers).map(f64::to_bits), plain);
        assert_eq!(sums_up_to_avx2(&numbers).map(f64::to_bits), plain);
    }
}
