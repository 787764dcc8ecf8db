//! What a body knows of the occupancy fractions of its voxels: of those that thresholds made, from
//! the scan's values, which say where between voxels they end; of masks, what was worked out from
//! their bits.
//!
//! A voxel counts by the values where a segment that a threshold made has it, or for a free one,
//! where such a segment has a voxel beside it. Where a mask covers such a voxel too, the values
//! count: they know more of the surface. All others count as was worked out, and where nothing
//! was, as their bits say.
//!
//! Frame: grid. Nothing here allocates after it was made.

use std::sync::Arc;

use glam::{IVec3, UVec3};
use palpate_haptics::smooth::occupancy_fractions::Limits;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::{BRICK, BrickSwap};
use palpate_volume::edit::SegmentId;
use palpate_volume::occupancy_fractions::{FractionBrick, OccupancyFractions, fraction_of};
use palpate_volume::voxel_box::VoxelBox;

use crate::touch::part::Part;
use crate::touch::scan_values::ScanValues;

/// Most segments of thresholds in one body whose occupancy fractions are known; further ones are
/// taken for masks, so that work stays bounded.
const MAX_OWNERS: usize = 8;

/// Occupancy fractions of the voxels of one body.
#[derive(Clone, Debug)]
pub struct BodyFractions {
    made: Option<Made>,
    /// Those of all masks together; none where the body has no masks.
    worked_out: Option<OccupancyFractions>,
}

/// What thresholds made.
#[derive(Clone, Debug)]
struct Made {
    values: ScanValues,
    limits: Limits,
    /// Its voxels, where the body has others as well.
    owners: Vec<(SegmentId, Bits)>,
}

impl BodyFractions {
    /// Of a body that is made of these parts of one scan, or of one part on a grid of its own.
    #[must_use]
    pub fn of(dimensions: UVec3, parts: &[&Part]) -> Option<Self> {
        let has_masks = parts.iter().any(|part| part.threshold.is_none());
        let known = Self {
            made: Made::of(parts),
            worked_out: has_masks.then(|| {
                let parts: Vec<_> = parts
                    .iter()
                    .map(|part| FractionalBits::from(*part))
                    .collect();
                union_of_fractions(dimensions, &parts)
            }),
        };
        (known.made.is_some() || known.worked_out.is_some()).then_some(known)
    }

    /// Exchanges a brick of a part, if it is there.
    pub fn swap_part(&mut self, id: SegmentId, swap: &mut BrickSwap<BitBrick>) {
        let owners = self.made.iter_mut().flat_map(|made| &mut made.owners);
        if let Some((_, bits)) = owners.into_iter().find(|(owner, _)| *owner == id) {
            bits.swap(swap);
        }
    }

    /// Exchanges a brick of what was worked out.
    pub fn swap_fractions(&mut self, swap: &mut BrickSwap<FractionBrick>) {
        if let Some(fractions) = &mut self.worked_out {
            fractions.swap(swap);
        }
    }

    /// The occupancy fraction of a voxel; see `Occupancy::share`.
    #[inline]
    #[must_use]
    pub fn share(&self, voxel: IVec3, solid: bool) -> Option<f32> {
        if let Some(made) = &self.made
            && (made.owners.is_empty() || made.has(voxel, solid))
        {
            return made.values.share(&made.limits, voxel, solid);
        }
        self.worked_out.as_ref()?.fraction(voxel, solid)
    }

    /// What those of some voxels are beyond their bits; see `Occupancy::fraction_changes`.
    #[inline]
    pub fn fraction_changes(&self, voxels: &[(IVec3, bool)], changes: &mut [f32]) {
        match &self.made {
            Some(made) => made.values.fraction_changes(&made.limits, voxels, changes),
            None => changes.fill(0.0),
        }
        if self
            .made
            .as_ref()
            .is_some_and(|made| made.owners.is_empty())
        {
            return;
        }
        for (change, &(voxel, solid)) in changes.iter_mut().zip(voxels) {
            if self
                .made
                .as_ref()
                .is_none_or(|made| !made.has(voxel, solid))
            {
                let known = self.worked_out.as_ref();
                let share = known.and_then(|fractions| fractions.fraction(voxel, solid));
                *change = share.map_or(0.0, |share| share - f32::from(u8::from(solid)));
            }
        }
    }
}

impl Made {
    fn of(parts: &[&Part]) -> Option<Self> {
        let made = parts
            .iter()
            .filter_map(|part| Some((*part, part.threshold.as_ref()?)))
            .take(MAX_OWNERS);
        let values = made.clone().next()?.1.values.clone();
        let ranges = made.clone().map(|(_, threshold)| threshold.range);
        let limits = Limits::new(values.rescale(), ranges);
        let owner = |part: &Part| (part.id, part.bits.clone());
        let owners = match parts {
            [_] => Vec::new(),
            _ => made.map(|(part, _)| owner(part)).collect(),
        };
        Some(Self {
            values,
            limits,
            owners,
        })
    }

    /// Whether a threshold made a voxel, or for a free one, a voxel beside it.
    #[inline(never)]
    fn has(&self, voxel: IVec3, solid: bool) -> bool {
        let has = |voxel: IVec3| self.owners.iter().any(|(_, bits)| bits.is_solid(voxel));
        if solid {
            return has(voxel);
        }
        [IVec3::X, IVec3::Y, IVec3::Z]
            .into_iter()
            .any(|axis| has(voxel - axis) || has(voxel + axis))
    }
}

// --- of several segments together ---------------------------------------------------------
//
// A solid voxel counts what is known of it in every segment that has it, the most that any of
// them says; where one knows nothing of it, or another segment goes on beside it, it is no surface
// of the body, and counts as its bit says. A free voxel counts the most that any segment says.

/// Voxels of a segment, and what is known of their occupancy fractions.
#[derive(Clone, Copy, Debug)]
pub struct FractionalBits<'a> {
    /// The voxels.
    pub bits: &'a Bits,
    /// Their occupancy fractions; none of a segment that a threshold made.
    pub fractions: Option<&'a OccupancyFractions>,
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
pub fn union_of_fractions(dimensions: UVec3, parts: &[FractionalBits<'_>]) -> OccupancyFractions {
    if let [
        FractionalBits {
            fractions: Some(fractions),
            ..
        },
    ] = parts
    {
        return (*fractions).clone();
    }
    let mut union = OccupancyFractions::unknown(dimensions);
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
pub fn union_fraction_brick(
    parts: &[FractionalBits<'_>],
    index: u32,
) -> Option<Arc<FractionBrick>> {
    let brick = |part: &FractionalBits<'_>| part.fractions?.bricks().get(index).cloned();
    if let [part] = parts {
        return brick(part);
    }
    if !parts.iter().any(|part| brick(part).is_some()) {
        return None;
    }
    let first = parts.first()?.bits.bricks().box_of(index).min;
    // a brick and one voxel around it
    let near = VoxelBox::new(first - 1, first + BRICK + 1);
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
    let mut union = FractionBrick::UNKNOWN;
    for z in 0..BRICK {
        for y in 0..BRICK {
            for x in 0..BRICK {
                let voxel = first + IVec3::new(x, y, z);
                union.set(voxel, union_byte(&there, voxel));
            }
        }
    }
    (union != FractionBrick::UNKNOWN).then(|| Arc::new(union))
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
        if fraction_of(own, true).is_none() || is_inner {
            return 0;
        }
        most = most.max(own);
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::touch::scan_values::Threshold;
    use glam::UVec3;
    use palpate_volume::intensities::Intensities;
    use palpate_volume::threshold::threshold;
    use palpate_volume::voxel_box::VoxelBox;

    #[test]
    fn shares_told_at_once_are_those_told_one_by_one_beside_a_mask_too() {
        let size = UVec3::new(17, 9, 12);
        let values: Vec<i16> = (0..17 * 9 * 12).map(|i| (i * 37 % 1000) as i16).collect();
        let scan = Intensities::new(size, values, 1.0, 0.0).expect("one value per voxel");
        let range = (400.0, 700.0);
        let made = Part {
            id: SegmentId(1),
            bits: threshold(&scan, None, range.0, range.1).occupancy().clone(),
            moved: None,
            threshold: Some(Threshold {
                range,
                values: ScanValues::of(&scan),
            }),
            fractions: None,
            punctured: false,
            rigid: None,
        };
        let mask = Part {
            id: SegmentId(2),
            bits: threshold(&scan, None, 650.0, 900.0).occupancy().clone(),
            threshold: None,
            ..made.clone()
        };
        for parts in [vec![&made], vec![&made, &mask]] {
            let fractions = BodyFractions::of(size, &parts).expect("a threshold made one");
            let solid = |voxel: IVec3| parts.iter().any(|part| part.bits.is_solid(voxel));
            let voxels = VoxelBox::of_dimensions(size).voxels();
            let voxels: Vec<_> = voxels.map(|voxel| (voxel, solid(voxel))).collect();
            let mut changes = vec![f32::NAN; voxels.len()];
            fractions.fraction_changes(&voxels, &mut changes);
            let one_by_one = voxels.iter().map(|(voxel, solid)| {
                let bit = f32::from(u8::from(*solid));
                fractions
                    .share(*voxel, *solid)
                    .map_or(0.0, |share| share - bit)
            });
            assert!(one_by_one.clone().any(|change| change != 0.0));
            assert!(changes.iter().copied().eq(one_by_one));
        }
    }
}
