//! Blocks of voxels at any place against single questions.

use glam::{IVec3, UVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;

/// Random voxels, with empty and full bricks among them.
fn noise(dimensions: UVec3, seed: u64) -> Segment {
    Segment::from_fn(dimensions, |voxel| {
        let hash = |v: IVec3, salt: u64| {
            let place = (v.z as u64) << 40 | (v.y as u64) << 20 | v.x as u64;
            let mixed = (place ^ (seed + salt) << 60).wrapping_mul(0xd6e8_feb8_6659_fd93);
            (mixed ^ mixed >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93) >> 61
        };
        match hash(voxel >> 3_i32, 1) {
            0..3 => hash(voxel, 2) < 3,
            3..6 => false,
            _ => true,
        }
    })
}

fn by_single_questions(occupancy: &impl Occupancy, min: IVec3) -> BitBrick {
    BitBrick::from_fn(UVec3::splat(8), |offset| occupancy.is_solid(min + offset))
}

#[test]
fn a_block_holds_what_single_questions_find_also_across_the_border() {
    // dimensions that are no multiples of a brick
    let dimensions = UVec3::new(29, 16, 21);
    let parts = [noise(dimensions, 1), noise(dimensions, 2)];
    for z in -12..24 {
        for y in -12..20 {
            for x in -12..33 {
                let min = IVec3::new(x, y, z);
                assert_eq!(parts[0].block(min), by_single_questions(&parts[0], min));
                if (x + y + z) % 5 == 0 {
                    assert_eq!(parts.block(min), by_single_questions(&parts, min));
                }
            }
        }
    }
}

#[test]
fn a_block_far_outside_is_empty() {
    let segment = noise(UVec3::splat(16), 3);
    for far in [-16_777_224, 16_777_216] {
        assert_eq!(segment.block(IVec3::splat(far)), BitBrick::EMPTY);
        assert_eq!(segment.block(IVec3::new(far, 0, 0)), BitBrick::EMPTY);
    }
    assert_eq!(None::<Segment>.block(IVec3::ZERO), BitBrick::EMPTY);
}
