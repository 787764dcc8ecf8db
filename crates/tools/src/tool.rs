//! What all tools share: what they are told of the probe, and what they tell.
//!
//! Frame: patient (LPS mm) of the scan. For a segment that was moved, whoever calls brings
//! the probe into the segment's own frame first ([`ToolInput::moved`]).

use std::fmt;

use glam::{DAffine3, DVec3};
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::tissue::{MAX_TISSUES, TissueError};
use palpate_volume::voxels::{Voxels, VoxelsError};
use thiserror::Error;

/// Radius of a tool, at most [mm].
pub const MAX_RADIUS: f64 = 50.0;
/// Radius of a tool, at most [smallest voxel sides]; with it, the voxels of a pass are bounded.
pub const MAX_RADIUS_IN_VOXELS: f64 = 32.0;
/// A way of the probe longer than this in one pass [mm] is a jump, not a stroke.
pub const MAX_WAY: f64 = 500.0;
/// A pass lasts so long at most [s]; what is beyond it did no work.
pub const MAX_PASS: f64 = 0.1;

/// What a tool is told in one pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolInput {
    /// Where the probe was in the last pass [mm].
    pub from: DVec3,
    /// Where the probe is now [mm].
    pub to: DVec3,
    /// Radius of the probe's own body [mm], 0 for a point; none where nothing that the tool
    /// changes is an obstacle to it.
    pub body_radius: Option<f64>,
    /// Mean force that pressed on the surface since the last pass, without friction [N].
    pub force: f64,
    /// Direction out of the obstacle, of any length; zero without contact.
    pub contact_normal: DVec3,
    /// Time since the last pass [s].
    pub dt: f64,
}

impl ToolInput {
    /// The same probe in another frame, such as that of a segment which was moved.
    #[must_use]
    pub fn moved(&self, target_from_source: &DAffine3) -> Self {
        Self {
            from: target_from_source.transform_point3(self.from),
            to: target_from_source.transform_point3(self.to),
            contact_normal: target_from_source.transform_vector3(self.contact_normal),
            ..*self
        }
    }

    /// The probe's way of this pass [mm]; none where a number is no place, and only its end
    /// where it jumped.
    pub(crate) fn way(&self) -> Option<(DVec3, DVec3)> {
        if !self.to.is_finite() || !self.from.is_finite() {
            return None;
        }
        let is_jump = self.from.distance(self.to) > MAX_WAY;
        Some((if is_jump { self.to } else { self.from }, self.to))
    }
}

/// What a tool has done since it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolReport {
    /// Voxels that it changed.
    pub voxels: u64,
    /// Their volume [mm³].
    pub volume: f64,
    /// Time at work [s].
    pub time: f64,
    /// Work done on tissue [N·mm]; 0 for tools that do none.
    pub energy: f64,
    /// Power of the newest pass [N·mm/s].
    pub load: f64,
}

/// A tool that changes voxels while the probe moves with the button pressed.
pub trait Tool: Send + fmt::Debug {
    /// What the probe's way of this pass changes, built from the present voxels; none where
    /// nothing changes. The caller applies it.
    ///
    /// # Errors
    /// Where a chosen segment does not exist.
    fn advance(&mut self, voxels: &Voxels, input: &ToolInput) -> Result<Option<Edit>, VoxelsError>;

    /// The button is released: what a stroke left open is forgotten.
    fn release(&mut self) {}

    /// Report of what the tool has done so far.
    fn report(&self) -> ToolReport;
}

/// The grid that segments stand on which a tool works on at once: that of the first one.
pub(crate) fn grid_of<'a>(voxels: &'a Voxels, segments: &[SegmentId]) -> &'a Grid {
    segments
        .first()
        .map_or(voxels.grid(), |id| voxels.grid_of(*id))
}

/// A tool that cannot be made.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ToolError {
    /// There is no such tool.
    #[error("tool {0:?} given; allowed: eraser, adder, drill, needle, painter")]
    UnknownTool(String),
    /// Not a radius, or too large.
    #[error("radius {given} mm given; allowed: above 0 to {allowed} mm")]
    Radius {
        /// The value given [mm].
        given: f64,
        /// The largest one in this scan [mm].
        allowed: f64,
    },
    /// A setting of the drill that is out of range or not a number.
    #[error("{what} {given} of the drill given; allowed: {allowed}")]
    Drill {
        /// Which one.
        what: &'static str,
        /// The value given.
        given: f64,
        /// What may be given.
        allowed: &'static str,
    },
    /// Not a depth, or too deep.
    #[error(
        "depth {given} mm given; allowed: above 0 to {allowed} mm, or none for all of the ball"
    )]
    Depth {
        /// The value given [mm].
        given: f64,
        /// The largest one for these voxels [mm].
        allowed: f64,
    },
    /// A painter needs a segment to paint with, and others to paint.
    #[error(
        "{0} segment given to the painter; allowed: one to paint with, and those to be painted"
    )]
    NothingToPaint(usize),
    /// A tissue whose figures are out of range.
    #[error(transparent)]
    Tissue(#[from] TissueError),
    /// A needle needs to know what it goes into.
    #[error(
        "{tissues} tissues for {segments} segments given; allowed: one for each, at most {MAX_TISSUES} different ones"
    )]
    Tissues {
        /// Tissues given.
        tissues: usize,
        /// Segments given.
        segments: usize,
    },
    /// No segment is chosen.
    #[error("no segment given; allowed: one or more to work on")]
    NoSegment,
}
