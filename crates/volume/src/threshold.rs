//! A segment of all voxels whose value lies in a range: the quickest way to bone.
//!
//! The range is turned into stored units once, by asking for the physical value of stored
//! ones, so that the result is exactly that of comparing physical values, also where the
//! slope is negative. Bricks are made in parallel, row by row of eight voxels.

use std::ops::RangeInclusive;

use glam::{IVec3, UVec3};

use crate::bit_brick::BitBrick;
use crate::bits::Bits;
use crate::grid::voxel_index;
use crate::intensities::Intensities;
use crate::intensity_brick::IntensityBrick;
use crate::overlay::Overlay;
use crate::segment::Segment;
use crate::voxel_box::VoxelBox;

/// Takes the voxels from `low` to `high`, both included, in physical units [HU for CT].
/// Nothing lies in a range that is NaN or upside down.
///
/// # Panics
/// Where the overlay belongs to another grid.
pub fn threshold(
    intensities: &Intensities,
    overlay: Option<&Overlay>,
    low: f64,
    high: f64,
) -> Segment {
    let dimensions = intensities.dimensions();
    if let Some(overlay) = overlay {
        assert_eq!(overlay.dimensions(), dimensions, "overlay of another grid");
    }
    let Some(range) = stored_range(intensities, low, high) else {
        return Segment::empty(dimensions);
    };
    Segment::from_bits(Bits::from_bricks(dimensions, |voxels| {
        match overlay.and_then(|overlay| overlay.bricks().at(voxels.min)) {
            Some(changed) => in_brick(changed, voxels.size(), &range),
            None => in_scan(intensities, voxels, &range),
        }
    }))
}

/// The stored values whose physical ones lie in a range; none where there are none.
pub fn stored_range(intensities: &Intensities, low: f64, high: f64) -> Option<RangeInclusive<i16>> {
    if low.is_nan() || high.is_nan() {
        return None;
    }
    // physical values rise with stored ones, or fall with a negative slope
    let physical = |stored: i32| intensities.physical(stored as i16);
    let (first, end) = if intensities.slope() > 0.0 {
        (
            first_where(|stored| physical(stored) >= low),
            first_where(|stored| physical(stored) > high),
        )
    } else {
        (
            first_where(|stored| physical(stored) <= high),
            first_where(|stored| physical(stored) < low),
        )
    };
    (first < end).then(|| first as i16..=(end - 1) as i16)
}

/// First stored value with a property that all larger ones have too; one beyond the last
/// where none has it.
fn first_where(holds: impl Fn(i32) -> bool) -> i32 {
    let (mut first, mut end) = (i32::from(i16::MIN), i32::from(i16::MAX) + 1);
    while first < end {
        let middle = (first + end).div_euclid(2);
        if holds(middle) {
            end = middle;
        } else {
            first = middle + 1;
        }
    }
    first
}

fn in_scan(scan: &Intensities, voxels: VoxelBox, range: &RangeInclusive<i16>) -> BitBrick {
    let size = voxels.size();
    rows_in_range(size, range, |y, z| {
        let first = voxel_index(scan.dimensions(), voxels.min + IVec3::new(0, y, z));
        &scan.values()[first..first + size.x as usize]
    })
}

fn in_brick(brick: &IntensityBrick, size: UVec3, range: &RangeInclusive<i16>) -> BitBrick {
    rows_in_range(size, range, |y, z| {
        let first = ((z << 3 | y) << 3) as usize;
        &brick.0[first..first + size.x as usize]
    })
}

/// Compares the rows of one brick; `row(y, z)` gives the stored values along x.
fn rows_in_range<'a>(
    size: UVec3,
    range: &RangeInclusive<i16>,
    row: impl Fn(i32, i32) -> &'a [i16],
) -> BitBrick {
    let mut brick = BitBrick::EMPTY;
    for (z, word) in (0..size.z as i32).zip(&mut brick.0) {
        for y in 0..size.y as i32 {
            *word |= u64::from(row_in_range(row(y, z), range)) << (8 * y);
        }
    }
    brick
}

/// One bit for each of at most eight values.
fn row_in_range(row: &[i16], range: &RangeInclusive<i16>) -> u8 {
    let (first, width) = (
        *range.start(),
        range.end().wrapping_sub(*range.start()) as u16,
    );
    // one comparison for both ends: what lies below the first wraps to a large number
    let bit = |stored: i16| u8::from(stored.wrapping_sub(first) as u16 <= width);
    match <[i16; 8]>::try_from(row) {
        Ok(row) => (0..8).fold(0, |bits, x| bits | bit(row[x]) << x),
        Err(_) => (0..)
            .zip(row)
            .fold(0, |bits, (x, &stored)| bits | bit(stored) << x),
    }
}
