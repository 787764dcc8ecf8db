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

/// Voxels and shares as good as random, a function of the place: for tests that both give the same.
#[cfg(test)]
#[derive(Debug)]
pub(crate) struct Noise {
    /// Of a hundred voxels, so many are solid.
    pub(crate) density: u32,
}

#[cfg(test)]
impl Noise {
    fn random(voxel: glam::IVec3) -> u32 {
        let voxel = voxel.wrapping_mul(glam::IVec3::new(73_856_093, 19_349_663, 83_492_791));
        let bits = (voxel.x ^ voxel.y ^ voxel.z) as u32;
        (0..3).fold(bits, |bits, _| {
            (bits ^ bits >> 15).wrapping_mul(0x2c1b_3c6d)
        }) >> 8
    }
}

#[cfg(test)]
impl palpate_volume::occupancy::Occupancy for Noise {
    fn is_solid(&self, voxel: glam::IVec3) -> bool {
        Self::random(voxel) % 100 < self.density
    }

    fn share(&self, voxel: glam::IVec3, solid: bool) -> Option<f32> {
        let share = (Self::random(voxel) >> 8) as f32 / 131_072.0;
        Some(if solid { 1.0 - share } else { share })
    }
}
