//! Functions compiled a second time, for the wider vectors that most machines have.
//!
//! Wheels are built for machines without them. The body is the same, and no multiplication is
//! joined with an addition, so that both give the same bits.

/// Compiles `$body`, which has to be inlined, as `$name` for plain machines and for those with
/// AVX2, and calls what runs.
macro_rules! widest {
    (
        $(#[$doc:meta])*
        $visible:vis fn $name:ident($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)?
            = $body:path
    ) => {
        $(#[$doc])*
        $visible fn $name($($argument: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,bmi1,bmi2,popcnt")]
                fn wide($($argument: $type),*) $(-> $result)? {
                    $body($($argument),*)
                }
                if $crate::wide::runs() {
                    // SAFETY: the machine has these instructions, as was just asked
                    return unsafe { wide($($argument),*) };
                }
            }
            $body($($argument),*)
        }
    };
}

pub(crate) use widest;

/// Whether the machine has them; looked up once, by whoever asks first.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(crate) fn runs() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("popcnt")
}
