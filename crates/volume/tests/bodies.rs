//! Bodies are voxels that hang together through faces and edges.

use std::collections::HashMap;

use glam::{IVec3, UVec3};
use palpate_volume::bodies::Bodies;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

#[test]
fn voxels_that_share_an_edge_are_one_body_and_those_that_share_a_corner_are_two() {
    for (second, expected) in [
        (IVec3::new(2, 1, 1), 1),
        (IVec3::new(2, 2, 1), 1),
        (IVec3::new(1, 0, 2), 1),
        (IVec3::new(2, 2, 2), 2),
        (IVec3::new(0, 2, 2), 2),
        (IVec3::new(3, 1, 1), 2),
    ] {
        let segment = Segment::from_fn(UVec3::splat(4), |v| v == IVec3::ONE || v == second);
        assert_eq!(
            Bodies::of(segment.occupancy()).count(),
            expected,
            "{second}"
        );
    }
}

/// A flood over the eighteen neighbours of each voxel finds the same bodies, on random bits.
#[test]
fn bodies_are_those_of_a_flood() {
    let dimensions = UVec3::new(21, 9, 12);
    let mut random = oorandom::Rand32::new(3);
    for share in [0.05, 0.15, 0.3, 0.7] {
        let solid: Vec<bool> = VoxelBox::of_dimensions(dimensions)
            .voxels()
            .map(|_| random.rand_float() < share)
            .collect();
        let at = |v: IVec3| solid[((v.z * 9 + v.y) * 21 + v.x) as usize];
        let segment = Segment::from_fn(dimensions, at);
        let bodies = Bodies::of(segment.occupancy());
        let bounds = VoxelBox::of_dimensions(dimensions);
        let (mut flooded, mut count) = (HashMap::<IVec3, u32>::new(), 0);
        for start in bounds.voxels().filter(|&v| at(v)) {
            if flooded.contains_key(&start) {
                continue;
            }
            let mut left = vec![start];
            while let Some(voxel) = left.pop() {
                if flooded.insert(voxel, count).is_some() {
                    continue;
                }
                let beside = VoxelBox::of_voxel(voxel).dilate(1).intersect(&bounds);
                left.extend(beside.voxels().filter(|&other| {
                    at(other)
                        && (other - voxel).length_squared() <= 2
                        && !flooded.contains_key(&other)
                }));
            }
            count += 1;
        }
        assert_eq!(bodies.count(), count as usize);
        assert_eq!(bodies.voxel_count(), flooded.len() as u64);
        for voxel in bounds.voxels() {
            // both count bodies by their first voxel, z and y slowest
            assert_eq!(bodies.at(voxel), flooded.get(&voxel).copied(), "{voxel}");
        }
    }
}
