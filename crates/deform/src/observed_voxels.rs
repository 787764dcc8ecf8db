//! Whether voxels are as a model left them, so that it need not look at all of them again.

use glam::IVec3;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::Voxels;

use crate::voxel_ledger::Ledger;

/// The voxels as they were after an answer.
#[derive(Clone, Copy, Debug)]
pub struct ObservedVoxels {
    edit_number: u64,
    /// One voxel that the answer's edit changes, and its new state.
    wrote: Option<(IVec3, VoxelState)>,
}

impl ObservedVoxels {
    /// The voxels as they are now, before an answer changes them.
    pub fn now(voxels: &Voxels) -> Self {
        Self {
            edit_number: voxels.edit_number(),
            wrote: None,
        }
    }

    /// Takes note of the edit of the answer.
    pub fn note(&mut self, ledger: &Ledger) {
        self.wrote = ledger.last_written();
    }

    /// Whether the voxels are as they were, or the answer's edit is all that changed.
    pub fn explains(&self, voxels: &Voxels) -> bool {
        voxels.edit_number() == self.edit_number || self.was_taken(voxels)
    }

    /// Whether the answer's edit, if there was one, is in the voxels, and nothing else has changed.
    pub fn is_followed(&self, voxels: &Voxels) -> bool {
        match self.wrote {
            Some(_) => self.was_taken(voxels),
            None => voxels.edit_number() == self.edit_number,
        }
    }

    fn was_taken(&self, voxels: &Voxels) -> bool {
        let is_written = |(voxel, matter)| voxels.state(voxel) == Some(matter);
        voxels.edit_number() == self.edit_number + 1 && self.wrote.is_some_and(is_written)
    }
}
