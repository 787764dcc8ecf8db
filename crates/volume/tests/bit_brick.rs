//! Bricks of bits against one truth value per voxel.

use std::sync::Arc;

use glam::{IVec3, UVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::voxel_box::VoxelBox;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn voxels() -> impl Iterator<Item = IVec3> {
    VoxelBox::of_dimensions(UVec3::splat(8)).voxels()
}

/// Sparse to dense bricks.
fn bricks() -> impl Strategy<Value = BitBrick> {
    let word = prop_oneof![
        Just(0),
        any::<u64>(),
        Just(u64::MAX),
        (0..64u32).prop_map(|n| 1 << n)
    ];
    prop::array::uniform8(word).prop_map(BitBrick)
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(41),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_brick_rebuilt_from_its_voxels_is_the_same(brick in bricks()) {
        let rebuilt = BitBrick::from_fn(UVec3::splat(8), |voxel| brick.contains(voxel));
        prop_assert_eq!(rebuilt, brick);
        let solid = voxels().filter(|&voxel| brick.contains(voxel)).count();
        prop_assert_eq!(solid as u32, brick.count());
    }

    #[test]
    fn setting_a_voxel_changes_no_other(brick in bricks(), place in 0..512_usize, solid: bool) {
        let target = voxels().nth(place).expect("one of 512");
        let mut changed = brick;
        changed.set(target, solid);
        for voxel in voxels() {
            let expected = if voxel == target { solid } else { brick.contains(voxel) };
            prop_assert_eq!(changed.contains(voxel), expected);
        }
    }

    #[test]
    fn the_difference_is_the_smallest_box_of_what_differs(a in bricks(), b in bricks()) {
        let differing = voxels().filter(|&voxel| a.contains(voxel) != b.contains(voxel));
        let smallest = differing.fold(VoxelBox::EMPTY, |all, voxel| {
            all.union(&VoxelBox::of_voxel(voxel))
        });
        prop_assert_eq!(a.difference(&b), smallest);
    }
}

#[test]
fn grid_voxels_find_their_place_by_the_low_bits() {
    let mut brick = BitBrick::EMPTY;
    brick.set(IVec3::new(8 + 3, 16 + 5, 800 + 7), true);
    assert!(brick.contains(IVec3::new(3, 5, 7)));
    assert!(brick.contains(IVec3::new(-8 + 3, -16 + 5, -8 + 7)));
    assert_eq!(brick.0[7], 1 << (5 * 8 + 3));
}

#[test]
fn a_brick_is_one_cache_line() {
    assert_eq!((size_of::<BitBrick>(), align_of::<BitBrick>()), (64, 64));
}

#[test]
fn empty_bricks_are_not_kept_and_full_ones_are_shared() {
    assert!(BitBrick::EMPTY.shared().is_none());
    let full = [(); 2].map(|()| BitBrick::FULL.shared().expect("full"));
    assert!(Arc::ptr_eq(&full[0], &full[1]));
    assert!(BitBrick::is_shared_full(&full[0]));
    let cut = BitBrick::filled(UVec3::new(8, 8, 7))
        .shared()
        .expect("not empty");
    assert!(!BitBrick::is_shared_full(&cut));
    assert_eq!(BitBrick::filled(UVec3::splat(8)), BitBrick::FULL);
}
