//! What the simulation publishes for the picture, besides changes of the scene.
//!
//! Points in scene mm (LPS).

use std::sync::mpsc::Sender;

use glam::DVec3;

use crate::deformable::DeformationStatus;
use crate::notice::Notice;
use crate::picture::scene_updates::SceneUpdate;
use crate::scene::ToolStatus;
use crate::touch::{CurrentPoses, NeedleDisplay};

/// What the picture shows of the simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SimulationStatus {
    /// Number of the newest edit.
    pub edit: u64,
    /// The segment that the probe touches; 0 where there is none.
    pub touched: u8,
    /// Radius that the probe has [mm]: less than the settings', where there is no room for it.
    pub probe_radius: f64,
    /// Where moved segments stand by now.
    pub poses: CurrentPoses,
    /// The segment that follows the probe; 0 where none does.
    pub grabbed: u8,
    /// Whether the device moves without the probe.
    pub clutched: bool,
    /// The middle of the device's workspace in the scene [mm].
    pub device_origin: DVec3,
    /// Changes that touch does not follow yet.
    pub pending: usize,
    /// Whether there is a change to take back.
    pub can_undo: bool,
    /// Whether there is an undone change to do again.
    pub can_redo: bool,
    /// Steps that were made, less those that were taken back; one that is not ended counts.
    pub step: u64,
    /// Steps that were made and ended, ever.
    pub steps_made: u64,
    /// Rises with each change of a segment's voxels or of the list of segments.
    pub segments_version: u64,
    /// Rises with each change of voxels that the picture is not told box by box.
    pub voxels_version: u64,
    /// The tool in the hand.
    pub tool: ToolStatus,
    /// The needle, where it is that.
    pub needle: NeedleDisplay,
    /// Soft tissue.
    pub matter: DeformationStatus,
    /// Bytes that undo and redo hold on to.
    pub undo_bytes: usize,
    /// How many they may.
    pub undo_budget: usize,
}

/// Where the simulation publishes what is shown.
#[derive(Debug)]
pub struct PictureEnds {
    /// Its status.
    pub status: triple_buffer::Input<SimulationStatus>,
    /// Sentences for the person.
    pub notices: Sender<Notice>,
    /// Changes of the scene.
    pub updates: Sender<SceneUpdate>,
}
