//! The directory of bricks, and the swap that the servo relies on.

use std::sync::Arc;

use crate::support::{DIMENSIONS, Random};
use assert_no_alloc::assert_no_alloc;
use glam::{IVec3, UVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::{BrickGrid, BrickSwap};
use palpate_volume::voxel_box::VoxelBox;

/// Stops the test program where a swap allocates or frees.
/// Bricks that hold the place they were made for.
fn numbered(dimensions: UVec3) -> BrickGrid<IVec3> {
    BrickGrid::from_fn(dimensions, |voxels| Some(Arc::new(voxels.min)))
}

#[test]
fn every_voxel_finds_the_brick_made_for_it() {
    for dimensions in DIMENSIONS {
        let bricks = numbered(dimensions);
        for voxel in VoxelBox::of_dimensions(dimensions).voxels() {
            assert_eq!(bricks.at(voxel), Some(&(voxel / 8 * 8)), "{dimensions}");
        }
    }
}

#[test]
fn boxes_of_all_bricks_cover_the_grid_once() {
    for dimensions in DIMENSIONS {
        let bricks = BrickGrid::<BitBrick>::empty(dimensions);
        let boxes = (0..bricks.len() as u32).map(|index| bricks.box_of(index));
        let covered: u64 = boxes.clone().map(|voxels| voxels.voxel_count()).sum();
        let around = boxes.fold(VoxelBox::EMPTY, |all, voxels| all.union(&voxels));
        assert_eq!(around, VoxelBox::of_dimensions(bricks.size() * 8));
        assert_eq!(around.voxel_count(), covered);
    }
}

#[test]
fn the_bricks_in_a_box_are_those_that_meet_it() {
    let mut random = Random::new(51);
    for dimensions in DIMENSIONS {
        let bricks = BrickGrid::<BitBrick>::empty(dimensions);
        for _ in 0..50 {
            let voxels = random.voxel_box(dimensions);
            let all = 0..bricks.len() as u32;
            let meeting = all.filter(|&index| !bricks.box_of(index).intersect(&voxels).is_empty());
            assert!(meeting.eq(bricks.indices_in(&voxels)), "{voxels:?}");
        }
    }
}

#[test]
fn a_swap_exchanges_one_brick_and_a_second_restores_it() {
    let mut bricks = numbered(UVec3::splat(20));
    let original = bricks.clone();
    let mut swap = BrickSwap {
        index: 5,
        brick: None,
    };
    bricks.swap(&mut swap);
    assert_eq!(bricks.get(5), None);
    assert_eq!(swap.brick.as_deref(), Some(&bricks.box_of(5).min));
    assert!(original.get(5).is_some(), "a clone keeps its own directory");

    bricks.swap(&mut swap);
    let same = |index: u32| match (bricks.get(index), original.get(index)) {
        (Some(ours), Some(theirs)) => Arc::ptr_eq(ours, theirs),
        _ => false,
    };
    assert!((0..bricks.len() as u32).all(same));
}

#[test]
fn a_swap_neither_allocates_nor_frees() {
    let mut bricks = BrickGrid::empty(UVec3::splat(64));
    let brick =
        |index: u32| (!index.is_multiple_of(3)).then(|| Arc::new(BitBrick([u64::from(index); 8])));
    let mut swaps: Vec<_> = (0..bricks.len() as u32)
        .map(|index| BrickSwap {
            index,
            brick: brick(index),
        })
        .collect();
    assert_no_alloc(|| {
        for _ in 0..3 {
            for swap in &mut swaps {
                bricks.swap(swap);
            }
        }
    });
    assert!(!bricks.is_empty());
}

#[test]
fn a_swap_beyond_the_directory_changes_nothing() {
    let mut bricks = numbered(UVec3::splat(8));
    let mut swap = BrickSwap {
        index: 1,
        brick: None,
    };
    bricks.swap(&mut swap);
    assert!(swap.brick.is_none() && bricks.get(0).is_some());
}
