//! The needle: a tool that changes no voxel. What it does is felt: the servo has its law, and
//! leaves out what it has punctured.

use palpate_volume::edit::Edit;
use palpate_volume::voxels::{Voxels, VoxelsError};

use crate::tool::{MAX_PASS, Tool, ToolInput, ToolReport};

/// A needle in the hand.
#[derive(Clone, Copy, Debug, Default)]
pub struct Needle {
    report: ToolReport,
}

impl Tool for Needle {
    fn advance(
        &mut self,
        _voxels: &Voxels,
        input: &ToolInput,
    ) -> Result<Option<Edit>, VoxelsError> {
        // written so that NaN adds nothing
        if input.dt > 0.0 {
            self.report.time += input.dt.min(MAX_PASS);
        }
        Ok(None)
    }

    fn report(&self) -> ToolReport {
        self.report
    }
}
