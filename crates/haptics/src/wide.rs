//! Functions compiled a second time, for the wider vectors that most machines have.
//!
//! Wheels are built for machines without them. The body is the same, and no multiplication is
//! joined with an addition, so that both give the same bits.

/// Compiles `$body`, which has to be inlined, as `$name` for plain machines and for those with
/// AVX2, and calls what runs. A trait that it is generic over stands in brackets.
macro_rules! widest {
    (
        $(#[$doc:meta])*
        $visible:vis fn $name:ident$([$kind:ident: $trait:path])?(
            $($argument:ident: $type:ty),* $(,)?
        ) $(-> $result:ty)?
            = $body:path
    ) => {
        $(#[$doc])*
        $visible fn $name$(<$kind: $trait>)?($($argument: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,bmi1,bmi2,popcnt")]
                fn wide$(<$kind: $trait>)?($($argument: $type),*) $(-> $result)? {
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
#[inline(always)]
pub(crate) fn runs() -> bool {
    use std::sync::atomic::{AtomicU8, Ordering::Relaxed};
    /// 0 while nobody knows, 1 for no, 2 for yes.
    static KNOWN: AtomicU8 = AtomicU8::new(0);

    #[cold]
    fn look() -> bool {
        let runs = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("popcnt");
        KNOWN.store(1 + u8::from(runs), Relaxed);
        runs
    }
    match KNOWN.load(Relaxed) {
        0 => look(),
        known => known == 2,
    }
}
