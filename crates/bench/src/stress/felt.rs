//! Where the force of a run comes from: the voxels' stairs, their blur, or occupancy fractions of
//! voxels at the surface, which are made up: whatever is known of them, a guarantee is a guarantee.
//!
//! Frame: the grid of a body.

use std::sync::Arc;

use glam::IVec3;
use palpate_engine::touch::{BodyFractions, Part, ScanValues, Threshold};
use palpate_haptics::smooth::Smoothing;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::intensities::Intensities;
use palpate_volume::occupancy_fractions::{FractionBrick, OccupancyFractions, byte_of};
use palpate_volume::voxel_box::VoxelBox;

use crate::random::Random;

/// Fraction of the voxels of masks of which nothing is known.
const UNKNOWN: f64 = 0.1;
/// The value from which on made-up scans are solid, and how far they go from it.
const LEVEL: f64 = 300.0;
const SPREAD: f64 = 1000.0;

/// What the force of a run follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Felt {
    /// The hard probe.
    Stairs,
    /// The blurred voxels.
    Bits,
    /// The same with fractions that were worked out, as masks have them.
    Mask,
    /// The same with fractions by values of a scan, as thresholds have them.
    Threshold,
}

impl Felt {
    /// Three of ten runs feel stairs, the others each of the rest as often.
    pub fn random(random: &mut Random) -> Self {
        let smooth = [Self::Bits, Self::Mask, Self::Threshold];
        let place = (10.0 * random.share()).floor() - 3.0;
        if place < 0.0 {
            return Self::Stairs;
        }
        smooth[(place as usize) % smooth.len()]
    }

    /// Whether forces step little.
    pub fn is_smooth(self) -> bool {
        self != Self::Stairs
    }

    /// As a tick is told.
    pub fn smoothing(self) -> Smoothing {
        match self {
            Self::Stairs => Smoothing::Off,
            Self::Bits => Smoothing::Bits,
            Self::Mask | Self::Threshold => Smoothing::Intensities,
        }
    }

    /// What is known of a body with these voxels.
    pub fn fractions(self, bits: &Bits, random: &mut Random) -> Option<BodyFractions> {
        let part = match self {
            Self::Stairs | Self::Bits => return None,
            Self::Mask => Part {
                fractions: Some(Arc::new(made_up_fractions(bits, random))),
                ..part(bits)
            },
            Self::Threshold => Part {
                threshold: Some(made_up_threshold(bits, random)),
                ..part(bits)
            },
        };
        BodyFractions::of(bits.dimensions(), &[&part])
    }

    /// What is known of bricks after an edit. The values of a scan stay what they are.
    pub fn after(
        self,
        swaps: &[BrickSwap<BitBrick>],
        random: &mut Random,
    ) -> Vec<BrickSwap<FractionBrick>> {
        if self != Self::Mask {
            return Vec::new();
        }
        let share = |swap: &BrickSwap<BitBrick>| {
            let solid = |voxel| {
                swap.brick
                    .as_ref()
                    .is_some_and(|brick| brick.contains(voxel))
            };
            BrickSwap {
                index: swap.index,
                brick: Some(Arc::new(made_up_brick(solid, random))),
            }
        };
        swaps.iter().map(share).collect()
    }
}

fn part(bits: &Bits) -> Part {
    Part {
        id: SegmentId(1),
        bits: bits.clone(),
        moved: None,
        threshold: None,
        fractions: None,
        punctured: false,
        rigid: None,
    }
}

fn made_up_fractions(bits: &Bits, random: &mut Random) -> OccupancyFractions {
    let mut fractions = OccupancyFractions::unknown(bits.dimensions());
    for index in 0..fractions.bricks().entries().len() as u32 {
        let corner = fractions.bricks().box_of(index).min;
        let brick = made_up_brick(|voxel| bits.is_solid(corner + voxel), random);
        fractions.swap(&mut BrickSwap {
            index,
            brick: Some(Arc::new(brick)),
        });
    }
    fractions
}

fn made_up_brick(solid: impl Fn(IVec3) -> bool, random: &mut Random) -> FractionBrick {
    let mut brick = FractionBrick::UNKNOWN;
    for voxel in VoxelBox::new(IVec3::ZERO, IVec3::splat(8)).voxels() {
        if random.share() >= UNKNOWN {
            brick.set(voxel, byte_of(random.share() as f32, solid(voxel)));
        }
    }
    brick
}

fn made_up_threshold(bits: &Bits, random: &mut Random) -> Threshold {
    let value = |voxel: IVec3| {
        let away = SPREAD * random.share();
        (LEVEL
            + if bits.is_solid(voxel) {
                away
            } else {
                -1.0 - away
            }) as i16
    };
    let voxels = VoxelBox::of_dimensions(bits.dimensions()).voxels();
    let values: Vec<i16> = voxels.map(value).collect();
    let scan = Intensities::new(bits.dimensions(), values, 1.0, 0.0);
    Threshold {
        range: (LEVEL, f64::MAX),
        values: ScanValues::of(&scan.expect("one value per voxel")),
    }
}
