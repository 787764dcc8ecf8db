//! The fraction of the lamp's light that reaches a cell: along one line toward it.

use std::ops::Range;

use glam::Vec3;
use palpate_volume::simd_dispatch;

use crate::light_volume::clarity::{Beside, Clarity, Scratch};
use crate::light_volume::sky::dim;

/// Cells along the longest line.
pub(super) const MOST_CELLS: u32 = 256;

/// Light of which nothing more has to be taken.
const DARK: f32 = 0.01;

/// Cells between two looks at whether it is dark everywhere.
const LOOKS: u32 = 8;

simd_dispatch! {
    /// Fractions of the lamp's light that reach some cells of a row. `stride`: toward it, a cell's edge long [cells].
    pub(super) fn reach_row(
        stride: Vec3,
        clarity: &Clarity,
        row: (i32, i32),
        span: &Range<usize>,
        scratch: &mut Scratch,
    ) = [avx2] reach_row_body
}

#[inline(always)]
fn reach_row_body(
    stride: Vec3,
    clarity: &Clarity,
    row: (i32, i32),
    span: &Range<usize>,
    scratch: &mut Scratch,
) {
    scratch.clear[span.clone()].fill(1.0);
    for cell in 1..=MOST_CELLS {
        match clarity.beside(row, stride * cell as f32, span, scratch) {
            Beside::Outside => break,
            Beside::All => {}
            Beside::Some(cells) => dim(&mut scratch.clear[cells], &scratch.passing),
        }
        let is_dark = |share: &f32| *share <= DARK;
        if cell % LOOKS == 0 && scratch.clear[span.clone()].iter().all(is_dark) {
            break;
        }
    }
    let Scratch { clear, sum, .. } = scratch;
    sum[span.clone()].copy_from_slice(&clear[span.clone()]);
}
