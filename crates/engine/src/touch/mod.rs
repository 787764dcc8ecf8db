//! What the probe touches, how it feels, and how a change of it is admitted while the probe is there.
//!
//! Frames: the grid of the scan or of a segment, mm in the scene. Knows no thread and no channel.

pub mod body;
pub mod contact_model;
pub mod moved_poses;
pub mod needle;
pub mod occupancy_change;
pub mod occupancy_fractions;
pub mod owners;
pub mod part;
pub mod patched;
pub mod placement;
#[cfg(feature = "planted-fault")]
mod planted_fault;
pub mod probe;
pub mod rigid_obstacles;
pub mod scan_values;
pub mod settings;
pub mod touch_feel;
pub mod touch_occupancy;
pub mod touchable;
pub mod touched_surfaces;
