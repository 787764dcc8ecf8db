//! What an overlay hides and what shows through.

use std::sync::Arc;

use glam::{IVec3, UVec3};
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::intensities::Intensities;
use palpate_volume::intensity_brick::IntensityBrick;
use palpate_volume::overlay::Overlay;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::new(19, 9, 8);

fn scan() -> Intensities {
    let values: Vec<i16> = (0..19 * 9 * 8).collect();
    Intensities::new(DIMENSIONS, values, 1.0, 0.0).expect("one value per voxel")
}

#[test]
fn the_scan_shows_through_where_there_is_no_brick() {
    let (scan, overlay) = (scan(), Overlay::empty(DIMENSIONS));
    for voxel in VoxelBox::of_dimensions(DIMENSIONS).dilate(1).voxels() {
        assert_eq!(overlay.stored(&scan, voxel), scan.stored(voxel));
    }
}

#[test]
fn a_brick_hides_the_scan_below_it_alone() {
    let (scan, mut overlay) = (scan(), Overlay::empty(DIMENSIONS));
    overlay.swap(&mut BrickSwap {
        index: 1,
        brick: Some(Arc::new(IntensityBrick([-7; 512]))),
    });
    let hidden = overlay.bricks().box_of(1);
    for voxel in VoxelBox::of_dimensions(DIMENSIONS).dilate(1).voxels() {
        let expected = match scan.stored(voxel) {
            Some(_) if hidden.contains(voxel) => Some(-7),
            below => below,
        };
        assert_eq!(overlay.stored(&scan, voxel), expected, "{voxel}");
    }
    assert_eq!(overlay.brick(&scan, 1), IntensityBrick([-7; 512]));
}

#[test]
fn a_copied_brick_is_the_scan_and_zero_beyond_the_border() {
    let (scan, overlay) = (scan(), Overlay::empty(DIMENSIONS));
    for index in 0..overlay.bricks().len() as u32 {
        let brick = overlay.brick(&scan, index);
        for voxel in overlay.bricks().box_of(index).voxels() {
            let below = scan.stored(voxel).unwrap_or(0);
            assert_eq!(brick.stored(voxel), below, "{voxel}");
        }
    }
}

#[test]
fn a_brick_costs_a_kibibyte() {
    let mut overlay = Overlay::empty(DIMENSIONS);
    let before = overlay.memory_bytes();
    overlay.swap(&mut BrickSwap {
        index: 0,
        brick: Some(Arc::new(IntensityBrick::ZERO)),
    });
    // and two counters
    assert_eq!(overlay.memory_bytes() - before, 1024 + 16);
    assert_eq!(overlay.stored(&scan(), IVec3::ZERO), Some(0));
}
