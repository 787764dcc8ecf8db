//! What a session shows at one moment.
//!
//! Points in scene mm (LPS), forces in N in scene axes, times in s since the start.

use glam::{DAffine3, DVec3};
pub use palpate_haptics::force::ForceOff;

use crate::deformable::DeformationStatus;
use crate::notice::Notice;
use crate::scene::ToolStatus;
use crate::servo::ForceState;
use crate::threads::Rate;
use crate::touch::NeedleDisplay;

/// The pace of each thread.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rates {
    /// Reads the device and writes the forces.
    pub device: Rate,
    /// Computes the forces.
    pub servo: Rate,
    /// Owns the true voxels.
    pub simulation: Rate,
    /// Collects what is shown.
    pub picture: Rate,
    /// Whether device and servo have real-time priority.
    pub real_time: bool,
}

/// Interventions of the safety stage and violations of the guarantees since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Safety {
    /// Forces cut to the limit.
    pub clamped: u64,
    /// Forces whose growth was slowed.
    pub slewed: u64,
    /// Forces that were not finite and became zero.
    pub not_finite: u64,
    /// Ticks in which the force was still rising to its full size.
    pub ramped: u64,
    /// Ticks that waited for a small force to begin with.
    pub waited: u64,
    /// Ticks in which the force was eased to what the device bears for long.
    pub eased: u64,
    /// Ticks in which energy was taken out of the coupling.
    pub damped: u64,
    /// Times that the watchdog took the force away.
    pub watchdog: u64,
    /// Ticks in which the probe was found in a solid voxel: never, unless the engine is wrong.
    pub violations: u64,
    /// What stands between the contact and the hand now.
    pub force: ForceState,
    /// Why no force is sent; none while forces are on.
    pub off: Option<ForceOff>,
}

/// One tick of the force plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When [s].
    pub time: f64,
    /// The force sent to the device [N].
    pub force: DVec3,
}

/// What is now.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Number of the newest servo tick.
    pub tick: u64,
    /// Its time [s].
    pub time: f64,
    /// Number of the newest edit of the voxels.
    pub edit: u64,
    /// Where the device is.
    pub device: DVec3,
    /// Where the hand pulls it to.
    pub hand: DVec3,
    /// Where the probe is: never inside a touchable segment.
    pub proxy: DVec3,
    /// Where the force comes from, on the smooth surface.
    pub contact_point: DVec3,
    /// Out of the surface there; zero without contact.
    pub normal: DVec3,
    /// The force sent to the device.
    pub force: DVec3,
    /// Whether an obstacle holds the probe back.
    pub contact: bool,
    /// How far the device is behind the probe [mm]; 0 without contact.
    pub depth: f64,
    /// The segment that is touched; 0 where there is none.
    pub touched: u8,
    /// Radius that the probe has [mm]: less than the settings', where there is no room for it.
    pub probe_radius: f64,
    /// Where moved segments stand by now, by number [mm, from the scan to the scene].
    pub poses: Vec<(u8, DAffine3)>,
    /// The segment that follows the probe; 0 where none does.
    pub grabbed: u8,
    /// Whether the device moves without the probe.
    pub clutched: bool,
    /// The middle of the device's workspace.
    pub device_origin: DVec3,
    /// Changes of the voxels that touch does not follow yet.
    pub pending: usize,
    /// Whether there is an edit to take back.
    pub can_undo: bool,
    /// Whether there is an undone edit to apply again.
    pub can_redo: bool,
    /// Steps that were made, less those that were taken back; one that is not ended counts.
    pub step: u64,
    /// Steps that were made and ended, ever: where this rises, undone ones are forgotten.
    pub steps_made: u64,
    /// Rises with each change of a segment's voxels or of the list of segments.
    pub segments_version: u64,
    /// Rises with each change of voxels that no [`crate::picture::surfaces::PictureChange`] tells.
    pub voxels_version: u64,
    /// The tool in the hand, and what it has done.
    pub tool: ToolStatus,
    /// The needle, where it is that.
    pub needle: NeedleDisplay,
    /// Soft tissue.
    pub matter: DeformationStatus,
    /// Bytes that undo and redo hold on to.
    pub undo_bytes: usize,
    /// How many they may.
    pub undo_budget: usize,
    /// The pace of each thread.
    pub rates: Rates,
    /// Interventions and violations.
    pub safety: Safety,
    /// Since how long every input of the servo is kept [s]; none where it is not.
    pub recording: Option<f64>,
    /// Ticks since the frame before, thinned.
    pub samples: Vec<Sample>,
    /// Notices since the frame before.
    pub notices: Vec<Notice>,
}
