//! Sparse bits against one truth value per voxel.

use crate::support::{DIMENSIONS, Random, box_where};
use glam::UVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::voxel_box::VoxelBox;

/// Bits of a mask, x fastest.
fn bits(dimensions: UVec3, mask: &[u8]) -> Bits {
    Bits::from_bricks(dimensions, |voxels| {
        BitBrick::from_fn(voxels.size(), |offset| {
            let voxel = (voxels.min + offset).as_uvec3();
            mask[((voxel.z * dimensions.y + voxel.y) * dimensions.x + voxel.x) as usize] != 0
        })
    })
}

#[test]
fn every_voxel_reads_as_it_was_made_and_none_outside_is_solid() {
    let mut random = Random::new(61);
    for dimensions in DIMENSIONS {
        let mask = random.mask(dimensions);
        let bits = bits(dimensions, &mask);
        let bounds = VoxelBox::of_dimensions(dimensions);
        for (voxel, &value) in bounds.voxels().zip(&mask) {
            assert_eq!(bits.is_solid(voxel), value != 0, "{voxel} of {dimensions}");
        }
        for voxel in bounds.dilate(9).voxels() {
            assert!(bounds.contains(voxel) || !bits.is_solid(voxel), "{voxel}");
        }
    }
}

#[test]
fn the_difference_is_the_smallest_box_of_what_differs() {
    let mut random = Random::new(62);
    for dimensions in DIMENSIONS {
        let [a, b] = [(); 2].map(|()| bits(dimensions, &random.mask(dimensions)));
        let differs = box_where(dimensions, |voxel| a.is_solid(voxel) != b.is_solid(voxel));
        assert_eq!(a.difference(&b), differs);
        assert_eq!(a.difference(&a.clone()), VoxelBox::EMPTY);
    }
}

#[test]
fn empty_and_full_bricks_cost_their_directory_entry() {
    let dimensions = UVec3::splat(64);
    let entries = 8 * 8 * 8 * 8;
    assert_eq!(Bits::empty(dimensions).memory_bytes(), entries);
    let full = Bits::from_bricks(dimensions, |_| BitBrick::FULL);
    assert_eq!(full.memory_bytes(), entries);
}

#[test]
#[should_panic(expected = "not those of a grid")]
fn dimensions_of_no_grid_are_a_broken_invariant() {
    let _ = Bits::empty(UVec3::new(0, 1, 1));
}
