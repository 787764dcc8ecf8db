//! Boxes against sets of voxels.

use crate::support::Random;
use glam::{IVec3, UVec3};
use palpate_volume::voxel_box::VoxelBox;

const AROUND: VoxelBox = VoxelBox::new(IVec3::splat(-5), IVec3::splat(12));

/// Pairs of boxes, some of them empty.
fn boxes() -> impl Iterator<Item = [VoxelBox; 2]> {
    let mut random = Random::new(31);
    (0..300).map(move |_| [(); 2].map(|()| random.voxel_box(UVec3::new(6, 5, 4))))
}

#[test]
fn a_box_holds_the_voxels_that_it_lists() {
    for [a, _] in boxes() {
        let listed: Vec<_> = a.voxels().collect();
        assert_eq!(listed.len() as u64, a.voxel_count());
        assert_eq!(a.is_empty(), listed.is_empty());
        for voxel in AROUND.voxels() {
            assert_eq!(a.contains(voxel), listed.contains(&voxel));
        }
    }
}

#[test]
fn a_union_is_the_smallest_box_with_both() {
    for [a, b] in boxes() {
        let union = a.union(&b);
        let both = AROUND
            .voxels()
            .filter(|&voxel| a.contains(voxel) || b.contains(voxel));
        let smallest = both.fold(VoxelBox::EMPTY, |all, voxel| {
            all.union(&VoxelBox::of_voxel(voxel))
        });
        assert_eq!(union, smallest, "{a:?} {b:?}");
        assert!(union.contains_box(&a) && union.contains_box(&b));
    }
}

#[test]
fn an_intersection_holds_what_both_hold() {
    for [a, b] in boxes() {
        let both = a.intersect(&b);
        for voxel in AROUND.voxels() {
            let expected = a.contains(voxel) && b.contains(voxel);
            assert_eq!(both.contains(voxel), expected, "{a:?} {b:?}");
        }
    }
}

#[test]
fn a_dilated_box_reaches_as_many_voxels_farther() {
    for [a, _] in boxes().filter(|[a, _]| !a.is_empty()) {
        assert_eq!(a.dilate(2).size(), a.size() + 4);
        assert_eq!(a.dilate(2).dilate(-2), a);
        assert!(a.dilate(-9).is_empty());
    }
    assert!(VoxelBox::EMPTY.dilate(3).is_empty());
}

#[test]
fn the_largest_boxes_do_not_overflow() {
    let all = VoxelBox::new(IVec3::MIN, IVec3::MAX);
    assert_eq!(all.dilate(1), all);
    assert_eq!(all.size(), UVec3::MAX);
    assert_eq!(all.voxel_count(), u64::MAX);
    assert!(VoxelBox::of_voxel(IVec3::MAX).is_empty());
}
