//! Bricks of stored values.

use glam::{IVec3, UVec3};
use palpate_volume::intensity_brick::IntensityBrick;
use palpate_volume::voxel_box::VoxelBox;

#[test]
fn memory_runs_along_x_then_y_then_z() {
    let mut brick = IntensityBrick::ZERO;
    let voxels = || VoxelBox::of_dimensions(UVec3::splat(8)).voxels();
    for (stored, voxel) in (0..).zip(voxels()) {
        brick.set(voxel, stored);
    }
    assert!((0..512).eq(brick.0));
    assert!((0..512).eq(voxels().map(|voxel| brick.stored(voxel))));
}

#[test]
fn grid_voxels_find_their_place_by_the_low_bits() {
    let mut brick = IntensityBrick::ZERO;
    brick.set(IVec3::new(17, 10, 803), -5);
    assert_eq!(brick.stored(IVec3::new(1, 2, 3)), -5);
}
