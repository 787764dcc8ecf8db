//! The eraser: a ball that frees voxels of the chosen segments on its way.
//!
//! A label edit: the picture of the scan stays as it is.

use palpate_volume::clip::ClipMask;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::voxels::{Voxels, VoxelsError};

use crate::measure::changed_voxels;
use crate::sweep::Sweep;
use crate::tool::{Tool, ToolInput, ToolReport, grid_of};

/// A ball that frees voxels.
#[derive(Clone, Debug)]
pub struct Eraser {
    radius: f64,
    segments: Vec<SegmentId>,
    cut_away: ClipMask,
    report: ToolReport,
}

impl Eraser {
    pub(crate) fn new(radius: f64, segments: Vec<SegmentId>, cut_away: ClipMask) -> Self {
        Self {
            radius,
            segments,
            cut_away,
            report: ToolReport::default(),
        }
    }
}

impl Tool for Eraser {
    fn advance(&mut self, voxels: &Voxels, input: &ToolInput) -> Result<Option<Edit>, VoxelsError> {
        let Some((from, to)) = input.way() else {
            return Ok(None);
        };
        let grid = grid_of(voxels, &self.segments);
        let sweep = Sweep::new(grid, from, to, self.radius);
        let edit = voxels.label_edit_of(&self.segments, sweep.boxes(), |_, voxel, was| {
            was && (!sweep.holds(voxel) || self.cut_away.cuts(voxel))
        })?;
        Ok(self.report.noted(voxels, grid, edit, input.dt))
    }

    fn report(&self) -> ToolReport {
        self.report
    }
}

impl ToolReport {
    /// Counts a label edit of segments on a grid; none where it is empty.
    pub(crate) fn noted(
        &mut self,
        voxels: &Voxels,
        grid: &Grid,
        edit: Edit,
        dt: f64,
    ) -> Option<Edit> {
        if dt > 0.0 {
            self.time += dt.min(crate::tool::MAX_PASS);
        }
        if edit.is_empty() {
            return None;
        }
        let changed = changed_voxels(voxels, &edit);
        self.voxels += changed;
        self.volume += changed as f64 * grid.voxel_volume();
        Some(edit)
    }
}
