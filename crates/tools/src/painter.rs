//! The painter: gives what the probe touches to a segment, in a ball around the contact.
//!
//! The first of its segments is the one that it paints with; it gets voxels of the others, which
//! lose them, or keep them too where segments may overlap. Only solid voxels are painted, so that
//! what is solid stays so: where all of them are obstacles, touch changes by nothing. All of the
//! ball is painted, or only a layer under the surface that the probe can reach.
//!
//! It paints while the probe is in contact: on its way through the air it does nothing, however
//! near a surface is.
//!
//! A label edit. Frame: patient (LPS mm).

use glam::{DVec3, IVec3};
use palpate_volume::clip::ClipMask;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::{Voxels, VoxelsError};

use crate::surface_layer::SurfaceLayer;
use crate::sweep::Sweep;
use crate::tool::{Tool, ToolError, ToolInput, ToolReport, grid_of};

/// Depth of a layer, at most [smallest voxel sides]; deeper, it is the ball.
pub const MAX_DEPTH_IN_VOXELS: f64 = 8.0;
/// Way of the contact in one pass that counts, at most [radii of the ball]: the end of it.
const MAX_WAY_IN_RADII: f64 = 4.0;

/// Settings of a painter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PaintSettings {
    /// Only voxels whose centres are no deeper below the surface are painted [mm]; all of the ball
    /// where there is none.
    pub depth: Option<f64>,
    /// Painted voxels stay in the segments that have them, too.
    pub overlaps: bool,
}

impl PaintSettings {
    /// Refuses a depth that is not a positive number, or needs too much work.
    pub(crate) fn check(&self, grid: &Grid) -> Result<(), ToolError> {
        let allowed = MAX_DEPTH_IN_VOXELS * grid.smallest_spacing();
        match self.depth {
            // written so that NaN is refused
            Some(given) if !(given > 0.0 && given <= allowed) => {
                Err(ToolError::Depth { given, allowed })
            }
            _ => Ok(()),
        }
    }
}

/// A ball that gives voxels to a segment.
#[derive(Clone, Debug)]
pub struct Painter {
    radius: f64,
    segments: Vec<SegmentId>,
    settings: PaintSettings,
    cut_away: ClipMask,
    /// The probe was in contact in the pass before.
    touched: bool,
    report: ToolReport,
}

impl Painter {
    pub(crate) fn new(
        radius: f64,
        segments: Vec<SegmentId>,
        settings: PaintSettings,
        cut_away: ClipMask,
    ) -> Self {
        Self {
            radius,
            segments,
            settings,
            cut_away,
            touched: false,
            report: ToolReport::default(),
        }
    }

    /// Where the contact went in this pass; none without one.
    fn contact(&mut self, input: &ToolInput) -> Option<(DVec3, DVec3)> {
        let touched = std::mem::take(&mut self.touched);
        let (from, to) = input.way()?;
        let normal = input.contact_normal.try_normalize()?;
        self.touched = true;
        let to_surface = -normal * input.body_radius.unwrap_or_default().max(0.0);
        // the way through the air to a contact is no part of it
        let back = if touched { from - to } else { DVec3::ZERO };
        let end = to + to_surface;
        Some((
            end + back.clamp_length_max(MAX_WAY_IN_RADII * self.radius),
            end,
        ))
    }

    /// The layer under what the probe can reach from where it was and is.
    fn layer(
        &self,
        grid: &Grid,
        sweep: &Sweep,
        input: &ToolInput,
        solid: impl Fn(IVec3) -> bool,
    ) -> Option<SurfaceLayer> {
        let depth = self.settings.depth?;
        let voxel_at = |point| grid.grid_from_patient().transform_point3(point).floor();
        let seeds = [input.from, input.to].map(|point| voxel_at(point).as_ivec3());
        let ball = sweep
            .boxes()
            .iter()
            .fold(VoxelBox::EMPTY, |all, one| all.union(one));
        let region = ball.dilate((depth / grid.smallest_spacing()).ceil() as i32 + 1);
        let region = region
            .union(&VoxelBox::of_voxel(seeds[1]))
            .intersect(&grid.bounds());
        Some(SurfaceLayer::new(grid, region, &seeds, depth, solid))
    }
}

impl Tool for Painter {
    fn advance(&mut self, voxels: &Voxels, input: &ToolInput) -> Result<Option<Edit>, VoxelsError> {
        let Some((from, to)) = self.contact(input) else {
            return Ok(None);
        };
        let find = |id: &SegmentId| voxels.segment(*id).ok_or(VoxelsError::UnknownSegment(id.0));
        let segments = self
            .segments
            .iter()
            .map(find)
            .collect::<Result<Vec<_>, _>>()?;
        let Some((_, others)) = segments.split_first() else {
            return Ok(None);
        };
        let grid = grid_of(voxels, &self.segments);
        let sweep = Sweep::new(grid, from, to, self.radius);
        let has = |segments: &[&Segment], voxel: IVec3| {
            segments.iter().any(|one| one.contains(voxel)) && !self.cut_away.cuts(voxel)
        };
        let solid = |voxel: IVec3| has(&segments, voxel);
        let layer = self.layer(grid, &sweep, input, solid);
        let reached = |voxel: IVec3| {
            let is_near = layer.as_ref().is_none_or(|layer| layer.holds(voxel));
            is_near && sweep.holds(voxel) && has(others, voxel)
        };

        let (own, keeps) = (self.segments[0], self.settings.overlaps);
        let edit = voxels.label_edit_of(&self.segments, sweep.boxes(), |id, voxel, was| {
            // cheap questions first: most voxels do not change
            if id == own {
                was || reached(voxel)
            } else {
                was && (keeps || !reached(voxel))
            }
        })?;
        Ok(self.report.noted(voxels, grid, edit, input.dt))
    }

    fn release(&mut self) {
        self.touched = false;
    }

    fn report(&self) -> ToolReport {
        self.report
    }
}
