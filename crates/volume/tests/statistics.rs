//! Count and bounding box that follow swaps, against counting again.

use crate::support::{Random, box_where};
use glam::UVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::statistics::Statistics;

/// Bricks of all densities, so that planes become empty and full again.
fn random_brick(random: &mut Random) -> BitBrick {
    let share = [0.0, 0.01, 0.5, 1.0][random.integer(0, 4) as usize];
    BitBrick::from_fn(UVec3::splat(8), |_| random.chance(share))
}

#[test]
fn count_and_box_follow_every_swap() {
    let mut random = Random::new(71);
    let dimensions = UVec3::new(24, 16, 32);
    let mut bits = Bits::empty(dimensions);
    let mut statistics = Statistics::of_bricks(bits.bricks());
    for step in 0..400 {
        // now and then nothing is left
        let emptied = step % 50 > 40;
        let index = random.integer(0, bits.bricks().len() as i32) as u32;
        let new = if emptied {
            BitBrick::EMPTY
        } else {
            random_brick(&mut random)
        };
        let mut swap = BrickSwap {
            index,
            brick: new.shared(),
        };
        let corner = bits.bricks().box_of(index).min;
        bits.swap(&mut swap);
        statistics.exchange(
            corner,
            swap.brick.as_deref(),
            bits.bricks().get(index).map(|b| &**b),
        );

        assert_eq!(statistics, Statistics::of_bricks(bits.bricks()));
        let solid = box_where(dimensions, |voxel| bits.is_solid(voxel));
        assert_eq!(statistics.bounding_box().unwrap_or_default(), solid);
    }
}

#[test]
fn nothing_solid_has_no_box() {
    let statistics = Statistics::of_bricks(Bits::empty(UVec3::ONE).bricks());
    assert_eq!((statistics.count(), statistics.bounding_box()), (0, None));
}
