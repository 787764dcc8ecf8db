//! What a session has to be drawn: its voxels, and tissue that stands beside them.

use palpate_volume::voxels::Voxels;

use super::Session;
use crate::error::SessionError;
use crate::picture::ShownDisplacements;

/// Voxels and displacements of one moment.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The true voxels; none where they are those of the edit that is known.
    pub voxels: Option<Voxels>,
    /// Where tissue stands beside them.
    pub displacements: ShownDisplacements,
}

impl Session {
    /// What is to be drawn now, for whoever knows the voxels of an edit.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn drawn_since(&self, edit_number: u64) -> Result<Drawn, SessionError> {
        self.ask(move |simulation| {
            let voxels = simulation.voxels();
            Drawn {
                voxels: (voxels.edit_number() != edit_number).then(|| voxels.clone()),
                displacements: simulation.displacements(),
            }
        })
    }
}
