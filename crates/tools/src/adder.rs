//! The adder: a ball that makes voxels of the chosen segments solid on its way.
//!
//! Where the segments are obstacles, it never fills where the probe's body is: the probe
//! would be inside an obstacle, and touch would hold the change back. Nor does it wall the
//! probe in: what its ball still covers waits, and is filled as soon as ball and body have
//! gone. So tissue grows behind the probe as it moves away, and what both stand in at
//! release stays free. Where the segments are no obstacles, it fills at once.

use std::collections::BTreeSet;

use glam::{DVec3, IVec3};
use palpate_volume::clip::ClipMask;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::{Voxels, VoxelsError};

use crate::sweep::Sweep;
use crate::tool::{Tool, ToolInput, ToolReport, grid_of};

/// A ball that makes voxels solid.
#[derive(Clone, Debug)]
pub struct Adder {
    radius: f64,
    segments: Vec<SegmentId>,
    cut_away: ClipMask,
    /// Voxels swept over that must be free still, as z, y, x.
    waiting: BTreeSet<[i32; 3]>,
    report: ToolReport,
}

impl Adder {
    pub(crate) fn new(radius: f64, segments: Vec<SegmentId>, cut_away: ClipMask) -> Self {
        Self {
            radius,
            segments,
            cut_away,
            waiting: BTreeSet::new(),
            report: ToolReport::default(),
        }
    }

    /// Leaves the voxels waiting that are kept free; gives the others.
    fn no_more_waiting(&mut self, kept_free: &Sweep) -> BTreeSet<[i32; 3]> {
        let (near, gone) = std::mem::take(&mut self.waiting)
            .into_iter()
            .partition(|&[z, y, x]| kept_free.holds(IVec3::new(x, y, z)));
        self.waiting = near;
        gone
    }

    fn wait_for(&mut self, sweep: &Sweep, kept_free: &Sweep) {
        for voxel in sweep.boxes().iter().flat_map(|region| region.voxels()) {
            if sweep.holds(voxel) && kept_free.holds(voxel) {
                self.waiting.insert([voxel.z, voxel.y, voxel.x]);
            }
        }
    }

    /// The ball around the probe in which nothing may be filled yet. Touch must take the
    /// change in without pushing the probe, which has moved on by then and knows its body by
    /// whole voxels: so the body, two voxels, and a way like the last.
    fn kept_free(&self, grid: &Grid, input: &ToolInput, from: DVec3, to: DVec3) -> Option<Sweep> {
        let body = input.body_radius?.max(0.0) + 2.0 * grid.spacing().length();
        let radius = body.max(self.radius) + from.distance(to);
        Some(Sweep::new(grid, to, to, radius))
    }
}

impl Tool for Adder {
    fn advance(&mut self, voxels: &Voxels, input: &ToolInput) -> Result<Option<Edit>, VoxelsError> {
        let Some((from, to)) = input.way() else {
            return Ok(None);
        };
        let grid = grid_of(voxels, &self.segments);
        let sweep = Sweep::new(grid, from, to, self.radius);
        let kept_free = self.kept_free(grid, input, from, to);
        let mut boxes = sweep.boxes().to_vec();
        let mut gone = BTreeSet::new();
        if let Some(kept_free) = &kept_free {
            gone = self.no_more_waiting(kept_free);
            self.wait_for(&sweep, kept_free);
            let of_gone = |&[z, y, x]: &[i32; 3]| VoxelBox::of_voxel(IVec3::new(x, y, z));
            boxes.extend(gone.iter().map(of_gone));
        }

        let may_fill = |voxel| {
            let is_kept_free = kept_free.as_ref().is_some_and(|ball| ball.holds(voxel));
            !is_kept_free && !self.cut_away.cuts(voxel)
        };
        let wanted =
            |voxel: IVec3| sweep.holds(voxel) || gone.contains(&[voxel.z, voxel.y, voxel.x]);
        let edit = voxels.label_edit_of(&self.segments, &boxes, |_, voxel, was| {
            was || (wanted(voxel) && may_fill(voxel))
        })?;
        Ok(self.report.noted(voxels, grid, edit, input.dt))
    }

    fn release(&mut self) {
        self.waiting.clear();
    }

    fn report(&self) -> ToolReport {
        self.report
    }
}
