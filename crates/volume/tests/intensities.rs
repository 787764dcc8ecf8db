//! Values, ranges and histograms against plain loops.

use crate::support::Random;
use glam::{IVec3, UVec3};
use palpate_volume::intensities::{Intensities, IntensitiesError};
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::new(61, 53, 47);

/// Values from `low` to `high`, more than one task's share.
fn scan(low: i32, high: i32, slope: f64) -> Intensities {
    let mut random = Random::new(91);
    let count = VoxelBox::of_dimensions(DIMENSIONS).voxel_count();
    let values: Vec<i16> = (0..count)
        .map(|_| random.integer(low, high + 1) as i16)
        .collect();
    Intensities::new(DIMENSIONS, values, slope, 7.5).expect("one value per voxel")
}

#[test]
fn a_value_is_the_rescaled_stored_one() {
    let scan = scan(-900, 2000, -0.5);
    for (voxel, &stored) in VoxelBox::of_dimensions(DIMENSIONS)
        .voxels()
        .zip(scan.values().iter())
    {
        assert_eq!(scan.stored(voxel), Some(stored));
        assert_eq!(scan.value(voxel), Some(-0.5 * f64::from(stored) + 7.5));
    }
    assert_eq!(scan.stored(IVec3::NEG_ONE), None);
    assert_eq!(scan.value(DIMENSIONS.as_ivec3()), None);
}

#[test]
fn the_range_is_that_of_all_values() {
    for slope in [2.0, -2.0] {
        let scan = scan(-1024, 3071, slope);
        assert_eq!(scan.stored_range(), (-1024, 3071));
        let ends = [scan.physical(-1024), scan.physical(3071)];
        assert_eq!(scan.range(), (ends[0].min(ends[1]), ends[0].max(ends[1])));
    }
}

#[test]
fn a_histogram_counts_every_voxel_in_the_bin_of_its_value() {
    for (slope, bins) in [(0.25, 50), (-3.0, 64), (1.0, 1), (1.0, 5000)] {
        let scan = scan(-500, 800, slope);
        let histogram = scan.histogram(bins);
        let width = (histogram.high - histogram.low) / bins as f64;
        let mut expected = vec![0; bins];
        for &stored in scan.values().iter() {
            let place = (scan.physical(stored) - histogram.low) / width;
            expected[place as usize] += 1;
        }
        assert_eq!(histogram.counts, expected, "slope {slope}, {bins} bins");
        // half a stored unit around the outermost values
        let (low, high) = scan.range();
        assert_eq!(histogram.low, low - slope.abs() / 2.0);
        assert_eq!(histogram.high, high + slope.abs() / 2.0);
    }
}

#[test]
fn a_histogram_of_one_value_or_of_all_has_a_width() {
    let one = scan(40, 40, 1.0).histogram(10);
    assert_eq!((one.low, one.high), (47.0, 48.0));
    assert_eq!(one.counts.iter().sum::<u64>(), 61 * 53 * 47);
    let values: Vec<i16> = (i16::MIN..=i16::MAX).collect();
    let all = Intensities::new(UVec3::new(256, 256, 1), values, 1.0, 0.0).expect("all values");
    assert_eq!(all.histogram(256).counts, vec![256; 256]);
}

#[test]
fn values_that_are_no_scan_are_refused() {
    let new = |values: Vec<i16>, slope, intercept| {
        Intensities::new(UVec3::new(2, 2, 2), values, slope, intercept).map(|_| ())
    };
    let length = new(vec![0; 7], 1.0, 0.0).expect_err("one too few");
    assert_eq!(
        length.to_string(),
        "7 values given for a grid of [2, 2, 2]; allowed: 8"
    );
    for (slope, intercept) in [
        (0.0, 0.0),
        (f64::NAN, 0.0),
        (f64::INFINITY, 0.0),
        (1.0, f64::NAN),
    ] {
        let error = new(vec![0; 8], slope, intercept).expect_err("not invertible");
        assert!(matches!(error, IntensitiesError::Rescale { .. }));
    }
}

#[test]
fn a_clone_shares_the_values() {
    let scan = scan(0, 9, 1.0);
    assert!(std::sync::Arc::ptr_eq(scan.values(), scan.clone().values()));
}
