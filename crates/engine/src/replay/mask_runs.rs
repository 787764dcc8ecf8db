//! A mask as a recording keeps it: runs of bricks that are alike.

use glam::UVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;

/// A brick, how many are alike from there on, and its words.
pub type MaskRun = (u32, u32, [u64; 8]);

/// The bricks of a mask that hold anything, those that are alike and beside one another as one.
#[must_use]
pub fn runs_of(mask: &Bits) -> Vec<MaskRun> {
    let mut runs: Vec<MaskRun> = Vec::new();
    for (index, brick) in (0..).zip(mask.bricks().entries()) {
        let Some(BitBrick(words)) = brick.as_deref() else {
            continue;
        };
        match runs.last_mut() {
            Some((first, count, last)) if *first + *count == index && last == words => *count += 1,
            _ => runs.push((index, 1, *words)),
        }
    }
    runs
}

/// The mask of these bricks; none where there are none.
#[must_use]
pub fn mask_of(runs: &[MaskRun], dimensions: UVec3) -> Option<Bits> {
    let mut mask = (!runs.is_empty()).then(|| Bits::empty(dimensions))?;
    let all = mask.bricks().len() as u32;
    for (first, count, words) in runs {
        let brick = BitBrick(*words).shared();
        for index in *first..first.saturating_add(*count).min(all) {
            let brick = brick.clone();
            mask.swap(&mut BrickSwap { index, brick });
        }
    }
    Some(mask)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mask_comes_back_from_its_runs() {
        let size = UVec3::new(40, 20, 9);
        let mask = Bits::from_bricks(size, |bounds| {
            BitBrick::from_fn(bounds.size(), |offset| {
                let voxel = bounds.min + offset;
                voxel.x > 10 && voxel.y < 17
            })
        });
        let runs = runs_of(&mask);
        let bricks = mask.bricks().entries().iter().flatten().count();
        assert!(runs.len() < bricks, "{} of {bricks}", runs.len());
        let again = mask_of(&runs, size).unwrap();
        assert!(again.difference(&mask).is_empty());
        assert!(mask_of(&[], size).is_none());
        // what no grid has is passed over
        assert!(
            mask_of(&[(7000, u32::MAX, [1; 8])], size)
                .unwrap()
                .bricks()
                .is_empty()
        );
    }
}
