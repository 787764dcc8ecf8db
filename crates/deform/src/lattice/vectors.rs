//! Functions compiled for the widest vectors that the machine has.
//!
//! The body is the same and no multiplication is joined with an addition, so that all widths
//! give the same bits.

/// Compiles `$body` as `$name` for plain, 256- and 512-bit vectors, and calls the widest that runs.
macro_rules! widest {
    ($(#[$doc:meta])* $visible:vis fn $name:ident($($argument:ident: $type:ty),* $(,)?) = $body:ident) => {
        $(#[$doc])*
        $visible fn $name($($argument: $type),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2($($argument: $type),*) {
                    $body($($argument),*);
                }
                #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
                fn avx512($($argument: $type),*) {
                    $body($($argument),*);
                }
                if is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("avx512dq")
                {
                    // SAFETY: the machine has these instructions, as was just asked.
                    unsafe { avx512($($argument),*) };
                    return;
                }
                if is_x86_feature_detected!("avx2") {
                    // SAFETY: the machine has these instructions, as was just asked.
                    unsafe { avx2($($argument),*) };
                    return;
                }
            }
            $body($($argument),*);
        }
    };
}

pub(super) use widest;

use glam::DVec3;

use super::layout::CHUNK;

/// One number for each node of a chunk.
pub(super) type Lanes = [f64; CHUNK];

/// A vector for each node: x, y and z apart. Shape [3, nodes].
pub(super) type Field = [Vec<f64>; 3];

/// `CHUNK` numbers from a place on.
#[inline(always)]
pub(super) fn lanes(values: &[f64], start: usize) -> &Lanes {
    values[start..start + CHUNK]
        .try_into()
        .expect("a chunk has this length")
}

/// `CHUNK` numbers from a place on, to be changed.
#[inline(always)]
pub(super) fn lanes_mut(values: &mut [f64], start: usize) -> &mut Lanes {
    (&mut values[start..start + CHUNK])
        .try_into()
        .expect("a chunk has this length")
}

/// Zero for each of `length` nodes.
pub(super) fn zero_field(length: usize) -> Field {
    std::array::from_fn(|_| vec![0.0; length])
}

/// The vector of a node.
pub(super) fn vector_at(field: &Field, index: usize) -> DVec3 {
    DVec3::new(field[0][index], field[1][index], field[2][index])
}
