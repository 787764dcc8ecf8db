//! A scan as it is drawn: its voxels at one edit, and what is known of its bricks.

use glam::IVec3;
use palpate_volume::grid::Grid;
use palpate_volume::voxels::Voxels;
use thiserror::Error;

use crate::bricks::BrickRanges;
use crate::field::Field;

/// A scan that cannot be drawn.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SceneError {
    /// Places in memory would not fit into 31 bits.
    #[error("a scan of {given} voxels given; allowed: {allowed}")]
    TooLarge {
        /// Its voxels.
        given: usize,
        /// The most that can be drawn.
        allowed: usize,
    },
}

/// Most voxels of a scan, one less than places that the ray caster can count, for the value beside the last.
const MOST_VOXELS: usize = i32::MAX as usize - 1;

/// A scan and its segments as they are drawn. Values are shared with the session, not copied.
#[derive(Clone, Debug)]
pub struct Scene {
    voxels: Voxels,
    pub(crate) field: Field,
    pub(crate) ranges: BrickRanges,
}

impl Scene {
    /// Takes voxels as they are now; reads each value once.
    ///
    /// # Errors
    /// Where there are too many.
    pub fn new(voxels: Voxels) -> Result<Self, SceneError> {
        // a scan of one column is held twice as wide
        let given = voxels.grid().voxel_count();
        let columns = voxels.grid().dimensions().x as usize;
        let held = if columns > 1 { given } else { 2 * given };
        if held > MOST_VOXELS {
            return Err(SceneError::TooLarge {
                given,
                allowed: MOST_VOXELS,
            });
        }
        let field = field_of(&voxels);
        let ranges = BrickRanges::new(&field);
        Ok(Self {
            voxels,
            field,
            ranges,
        })
    }

    /// Takes the voxels of a later edit of the same scan; reads only the bricks that were changed.
    ///
    /// # Panics
    /// Where they are those of another scan.
    pub fn follow(&mut self, voxels: Voxels) {
        assert_eq!(
            voxels.grid().dimensions(),
            self.voxels.grid().dimensions(),
            "voxels of another scan"
        );
        let changed = changed_bricks(&self.voxels, &voxels);
        self.voxels = voxels;
        self.field = field_of(&self.voxels);
        for (low, high) in changed {
            self.ranges.renew(&self.field, low, high);
        }
    }

    /// Where the voxels stand.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        self.voxels.grid()
    }

    /// The voxels that are drawn.
    #[must_use]
    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }
}

fn field_of(voxels: &Voxels) -> Field {
    let spacing = voxels.grid().spacing().as_vec3();
    Field::new(voxels.intensities(), voxels.overlay(), spacing)
}

/// Boxes of the bricks whose values were changed by edits, first and last voxel.
fn changed_bricks(before: &Voxels, now: &Voxels) -> Vec<(IVec3, IVec3)> {
    let (before, now) = (before.overlay().bricks(), now.overlay().bricks());
    (0..now.len() as u32)
        .filter(|&index| match (before.get(index), now.get(index)) {
            (Some(one), Some(other)) => !std::sync::Arc::ptr_eq(one, other),
            (one, other) => one.is_some() != other.is_some(),
        })
        .map(|index| now.box_of(index))
        .map(|voxels| (voxels.min, voxels.max - 1))
        .collect()
}
