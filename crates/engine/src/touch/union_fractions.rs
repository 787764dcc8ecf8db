//! The occupancy fractions of several segments as those of one body, as `touchable.rs` joins their
//! bits.
//!
//! A solid voxel counts what is known of it in every segment that has it, the most that any of
//! them says; where one knows nothing of it, or another segment goes on beside it, it is no surface
//! of the body, and counts as its bit says. A free voxel counts the most that any segment says.
//!
//! Frame: grid.

use std::sync::Arc;

use glam::{IVec3, UVec3};
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::{BRICK, BrickSwap};
use palpate_volume::shares::{ShareBrick, Shares, share_of};

use crate::touch::touchable::Part;

/// Voxels of a segment, and what is known of their occupancy fractions.
#[derive(Clone, Copy, Debug)]
pub struct FractionalBits<'a> {
    /// The voxels.
    pub bits: &'a Bits,
    /// Their occupancy fractions; none of a segment that a threshold made.
    pub fractions: Option<&'a Shares>,
}

impl<'a> From<&'a Part> for FractionalBits<'a> {
    fn from(part: &'a Part) -> Self {
        let fractions = part
            .fractions
            .as_deref()
            .filter(|_| part.threshold.is_none());
        Self {
            bits: &part.bits,
            fractions,
        }
    }
}

/// The occupancy fractions of segments of one grid together.
#[must_use]
pub fn union_of_fractions(dimensions: UVec3, parts: &[FractionalBits<'_>]) -> Shares {
    if let [
        FractionalBits {
            fractions: Some(fractions),
            ..
        },
    ] = parts
    {
        return (*fractions).clone();
    }
    let mut union = Shares::unknown(dimensions);
    for index in 0..union.bricks().len() as u32 {
        if let Some(brick) = union_fraction_brick(parts, index) {
            let brick = Some(brick);
            union.swap(&mut BrickSwap { index, brick });
        }
    }
    union
}

/// One brick of the union.
#[must_use]
pub fn union_fraction_brick(parts: &[FractionalBits<'_>], index: u32) -> Option<Arc<ShareBrick>> {
    let brick = |part: &FractionalBits<'_>| part.fractions?.bricks().get(index).cloned();
    if let [part] = parts {
        return brick(part);
    }
    if !parts.iter().any(|part| brick(part).is_some()) {
        return None;
    }
    let first = parts.first()?.bits.bricks().box_of(index).min;
    // a brick and one voxel around it
    let near = palpate_volume::voxel_box::VoxelBox::new(first - 1, first + BRICK + 1);
    let there: Vec<_> = parts
        .iter()
        .filter(|part| {
            let bricks = part.bits.bricks();
            let indices = bricks.indices_in(&near);
            brick(part).is_some() || indices.into_iter().any(|index| bricks.get(index).is_some())
        })
        .collect();
    if let [part] = there[..] {
        return brick(part);
    }
    let mut union = ShareBrick::UNKNOWN;
    for z in 0..BRICK {
        for y in 0..BRICK {
            for x in 0..BRICK {
                let voxel = first + IVec3::new(x, y, z);
                union.set(voxel, union_byte(&there, voxel));
            }
        }
    }
    (union != ShareBrick::UNKNOWN).then(|| Arc::new(union))
}

/// The byte of a voxel of the union.
fn union_byte(parts: &[&FractionalBits<'_>], voxel: IVec3) -> u8 {
    let byte =
        |part: &FractionalBits<'_>| part.fractions.map_or(0, |fractions| fractions.byte(voxel));
    let known = parts.iter().map(|part| byte(part)).max().unwrap_or(0);
    if known == 0 {
        return 0;
    }
    let mut owners = parts
        .iter()
        .filter(|part| part.bits.is_solid(voxel))
        .peekable();
    if owners.peek().is_none() {
        return known;
    }
    let mut most = 0;
    for owner in owners {
        let own = byte(owner);
        let goes_on = |beside: IVec3| {
            let other = |part: &&&FractionalBits<'_>| part.bits.is_solid(beside);
            !owner.bits.is_solid(beside) && parts.iter().any(|part| other(&part))
        };
        let beside = [IVec3::X, IVec3::Y, IVec3::Z].into_iter();
        let is_inner = beside
            .flat_map(|axis| [voxel - axis, voxel + axis])
            .any(goes_on);
        if share_of(own, true).is_none() || is_inner {
            return 0;
        }
        most = most.max(own);
    }
    most
}
