//! Segments against dense masks, and the size of a large one.

use crate::support::{DIMENSIONS, Random, box_where};
use glam::{DVec3, IVec3, UVec3};
use palpate_volume::grid::GridError;
use palpate_volume::segment::{Coverage, Segment, SegmentError};
use palpate_volume::voxel_box::VoxelBox;

#[test]
fn a_mask_goes_in_and_comes_out() {
    let mut random = Random::new(81);
    for dimensions in DIMENSIONS {
        let mask = random.mask(dimensions);
        let segment = Segment::from_mask(dimensions, &mask).expect("one byte per voxel");
        assert_eq!(segment.mask(), mask);
        let solid = mask.iter().filter(|&&value| value != 0).count();
        assert_eq!(segment.count(), solid as u64);
        let around = box_where(dimensions, |voxel| segment.contains(voxel));
        assert_eq!(segment.bounding_box().unwrap_or_default(), around);
    }
}

#[test]
fn painting_leaves_other_voxels_as_they_are() {
    let mut random = Random::new(82);
    for dimensions in DIMENSIONS {
        let mask = random.mask(dimensions);
        let segment = Segment::from_mask(dimensions, &mask).expect("one byte per voxel");
        let mut labels = vec![9; mask.len()];
        segment.paint(&mut labels, 4);
        let expected = mask.iter().map(|&value| if value != 0 { 4 } else { 9 });
        assert!(labels.iter().copied().eq(expected));
    }
}

#[test]
fn a_mask_of_another_size_is_refused() {
    let dimensions = UVec3::new(2, 3, 4);
    let error = Segment::from_mask(dimensions, &[1; 23]).expect_err("one too few");
    assert_eq!(
        error.to_string(),
        "23 mask values given for a grid of [2, 3, 4]; allowed: 24"
    );
    let none = UVec3::new(0, 3, 4);
    assert_eq!(
        Segment::from_mask(none, &[]).map(|segment| segment.count()),
        Err(SegmentError::Grid(GridError::Dimensions(none)))
    );
}

#[test]
fn bounds_spare_questions_but_change_no_answer() {
    let dimensions = UVec3::new(50, 41, 60);
    let ball = |voxel: IVec3| (voxel.as_dvec3() + 0.5 - 25.0).length() < 18.0;
    let by_voxel = Segment::from_fn(dimensions, ball);
    let by_bounds = Segment::from_bounds(dimensions, |voxels| cover_ball(&voxels), ball);
    assert_eq!(by_voxel.mask(), by_bounds.mask());
    assert_eq!(by_voxel.count(), by_bounds.count());
}

/// What a ball of radius 18 around (25, 25, 25) covers of a box, or mixed where near.
fn cover_ball(voxels: &VoxelBox) -> Coverage {
    let middle = (voxels.min + voxels.max).as_dvec3() / 2.0;
    let distance = (middle - 25.0).length();
    let reach = voxels.size().as_dvec3().length() / 2.0;
    if distance > 18.0 + reach {
        Coverage::Empty
    } else if distance < 18.0 - reach {
        Coverage::Full
    } else {
        Coverage::Mixed
    }
}

#[test]
fn clones_share_bricks_and_do_not_follow_one_another() {
    let mut segment = Segment::from_fn(UVec3::splat(16), |voxel| voxel.x == voxel.y);
    let clone = segment.clone();
    let [ours, theirs] = [&segment, &clone].map(|segment| segment.occupancy().bricks().get(0));
    assert!(std::ptr::eq(
        &**ours.expect("mixed"),
        &**theirs.expect("mixed")
    ));

    let mut swaps = [palpate_volume::brick_grid::BrickSwap {
        index: 0,
        brick: None,
    }];
    segment.swap(&mut swaps);
    assert!(!segment.contains(IVec3::ZERO) && clone.contains(IVec3::ZERO));
    assert_eq!(segment.count() + 64, clone.count());
}

/// The thin shell of a ball that fills a grid of 2048³: it must fit in 1 GiB.
#[test]
fn a_thin_shell_in_2048_cubed_fits_in_a_gibibyte() {
    const RADIUS: f64 = 1000.0;
    let dimensions = UVec3::splat(2048);
    let centre = DVec3::splat(1024.0);
    // squared, and asked for near the shell alone, so that the test is quick
    let within = |point: DVec3, margin: f64| {
        let [inner, outer] = [RADIUS - margin, RADIUS + margin].map(|radius| radius * radius);
        (inner..outer).contains(&point.distance_squared(centre))
    };
    let shell = Segment::from_bounds(
        dimensions,
        |voxels| {
            // half a brick's diagonal is 6.93, half the shell 1
            if within(voxels.min.as_dvec3() + 4.0, 8.0) {
                Coverage::Mixed
            } else {
                Coverage::Empty
            }
        },
        |voxel| within(voxel.as_dvec3() + 0.5, 1.0),
    );

    let bytes = shell.memory_bytes();
    println!("2048³ shell: {} MiB, {} voxels", bytes >> 20, shell.count());
    assert!(bytes < 1 << 30, "{bytes} bytes");
    // area times thickness; 1 % is far above the error of counting voxels
    let expected = 4.0 * std::f64::consts::PI * RADIUS * RADIUS * 2.0;
    let share = shell.count() as f64 / expected;
    assert!((share - 1.0).abs() < 0.01, "{share}");
    let around = VoxelBox::new(IVec3::splat(23), IVec3::splat(2025));
    assert_eq!(shell.bounding_box(), Some(around));
}
