//! Unions of segments.

use std::sync::Arc;

use crate::support::Random;
use glam::UVec3;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::new(12, 10, 9);

#[test]
fn a_union_is_solid_where_any_part_is() {
    let mut random = Random::new(111);
    let parts = [(); 3].map(|()| {
        Segment::from_mask(DIMENSIONS, &random.mask(DIMENSIONS)).expect("one byte per voxel")
    });
    let slots = parts.clone().map(|part| Some(part.occupancy().clone()));
    for voxel in VoxelBox::of_dimensions(DIMENSIONS).dilate(2).voxels() {
        let any = parts.iter().any(|part| part.contains(voxel));
        assert_eq!(parts.is_solid(voxel), any);
        assert_eq!(parts[..].is_solid(voxel), any);
        assert_eq!(parts.to_vec().is_solid(voxel), any);
        assert_eq!(parts.each_ref().is_solid(voxel), any);
        assert_eq!(slots.is_solid(voxel), any);
        assert_eq!(Arc::new(&parts).is_solid(voxel), any);
        assert_eq!(Box::new(&parts).is_solid(voxel), any);
    }
}

#[test]
fn vacant_places_and_empty_unions_are_free() {
    let none: [Option<Segment>; 2] = [None, None];
    for voxel in VoxelBox::of_dimensions(DIMENSIONS).voxels() {
        assert!(!none.is_solid(voxel));
        assert!(!<[Segment; 0]>::default().is_solid(voxel));
    }
}
