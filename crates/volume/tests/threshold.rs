//! Thresholds against comparing each physical value.

use crate::support::{DIMENSIONS, Random};
use glam::{IVec3, UVec3};
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::intensities::Intensities;
use palpate_volume::intensity_brick::IntensityBrick;
use palpate_volume::overlay::Overlay;
use palpate_volume::segment::Segment;
use palpate_volume::threshold::{stored_range, threshold};
use palpate_volume::voxel_box::VoxelBox;

/// Rescalings of scanners and odd ones: exact, rounded, falling, huge, tiny.
const RESCALINGS: [(f64, f64); 6] = [
    (1.0, -1024.0),
    (0.1, 0.3),
    (-1.0, 100.0),
    (-0.037, -5.0),
    (1e300, 0.0),
    (1e-9, 1e6),
];

fn noise(dimensions: UVec3, (slope, intercept): (f64, f64), random: &mut Random) -> Intensities {
    let count = VoxelBox::of_dimensions(dimensions).voxel_count();
    let values: Vec<i16> = (0..count)
        .map(|_| match random.integer(0, 20) {
            0 => i16::MIN,
            1 => i16::MAX,
            _ => random.integer(-1000, 1000) as i16,
        })
        .collect();
    Intensities::new(dimensions, values, slope, intercept).expect("one value per voxel")
}

/// Compares voxel by voxel.
fn dense(scan: &Intensities, low: f64, high: f64) -> Vec<u8> {
    let physical = scan.values().iter().map(|&stored| scan.physical(stored));
    physical
        .map(|value| u8::from(low <= value && value <= high))
        .collect()
}

fn bounds(scan: &Intensities, random: &mut Random) -> (f64, f64) {
    // often exactly on a value that occurs, where rounding would show
    let mut bound = || {
        let place = random.integer(0, scan.values().len() as i32) as usize;
        scan.physical(scan.values()[place])
    };
    (bound(), bound())
}

#[test]
fn a_threshold_is_that_of_the_physical_values() {
    let mut random = Random::new(101);
    for (dimensions, rescaling) in DIMENSIONS
        .iter()
        .cycle()
        .zip(RESCALINGS.iter().cycle())
        .take(90)
    {
        let scan = noise(*dimensions, *rescaling, &mut random);
        let (low, high) = bounds(&scan, &mut random);
        let segment = threshold(&scan, None, low, high);
        let expected = dense(&scan, low, high);
        assert_eq!(segment.mask(), expected, "{low} to {high}, {rescaling:?}");
        let solid = expected.iter().map(|&value| u64::from(value)).sum::<u64>();
        assert_eq!(segment.count(), solid);
    }
}

#[test]
fn every_stored_value_falls_on_the_right_side() {
    let values: Vec<i16> = (i16::MIN..=i16::MAX).collect();
    let mut random = Random::new(102);
    for (slope, intercept) in RESCALINGS {
        let all = Intensities::new(UVec3::new(256, 256, 1), values.clone(), slope, intercept);
        let all = all.expect("one value per voxel");
        for _ in 0..5 {
            let (low, high) = bounds(&all, &mut random);
            let expected = dense(&all, low, high);
            assert_eq!(threshold(&all, None, low, high).mask(), expected);
        }
        let range = stored_range(&all, f64::NEG_INFINITY, f64::INFINITY);
        assert_eq!(range, Some(i16::MIN..=i16::MAX));
    }
}

#[test]
fn a_range_that_is_nan_or_upside_down_holds_nothing() {
    let mut random = Random::new(103);
    for rescaling in RESCALINGS {
        let scan = noise(UVec3::splat(9), rescaling, &mut random);
        let (a, b) = scan.range();
        for (low, high) in [
            (b, a),
            (f64::NAN, b),
            (a, f64::NAN),
            (f64::INFINITY, f64::INFINITY),
        ] {
            // 1e300 · 32767 is infinite, and so in a range that ends there
            let infinite = low == f64::INFINITY && b == f64::INFINITY;
            let count = threshold(&scan, None, low, high).count();
            assert!(infinite || count == 0, "{low} to {high}, {rescaling:?}");
        }
    }
}

#[test]
fn values_of_an_overlay_count_instead_of_those_below() {
    let mut random = Random::new(104);
    let dimensions = UVec3::new(20, 17, 9);
    let scan = noise(dimensions, (-0.5, 3.0), &mut random);
    let mut overlay = Overlay::empty(dimensions);
    for index in [0, 4, overlay.bricks().len() as u32 - 1] {
        let mut brick = IntensityBrick::ZERO;
        for stored in &mut brick.0 {
            *stored = random.integer(-1000, 1000) as i16;
        }
        overlay.swap(&mut BrickSwap {
            index,
            brick: Some(brick.into()),
        });
    }
    let segment = threshold(&scan, Some(&overlay), -100.0, 200.0);
    for voxel in VoxelBox::of_dimensions(dimensions).voxels() {
        let stored = overlay.stored(&scan, voxel).expect("inside");
        let expected = (-100.0..=200.0).contains(&scan.physical(stored));
        assert_eq!(segment.contains(voxel), expected, "{voxel}");
    }
}

#[test]
fn all_and_nothing_cost_no_bricks() {
    let scan = Intensities::new(UVec3::splat(32), vec![50; 32 * 32 * 32], 1.0, 0.0);
    let scan = scan.expect("one value per voxel");
    let bricks = |segment: &Segment| segment.occupancy().memory_bytes() - 64 * 8;
    let all = threshold(&scan, None, 50.0, 50.0);
    let nothing = threshold(&scan, None, 51.0, 60.0);
    assert_eq!((all.count(), bricks(&all)), (32 * 32 * 32, 0));
    assert_eq!((nothing.count(), bricks(&nothing)), (0, 0));
    assert!(all.contains(IVec3::splat(31)) && nothing.bounding_box().is_none());
}
