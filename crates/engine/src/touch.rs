//! What the probe touches, how it feels, and how a change of it is admitted while the probe is there.
//!
//! Frames: the grid of the scan or of a segment, mm in the scene. Knows no thread and no channel.

mod body;
mod contact_model;
mod moved_poses;
mod needle;
mod occupancy_change;
mod occupancy_fractions;
mod owners;
mod part;
mod patched;
mod placement;
#[cfg(feature = "planted-fault")]
mod planted_fault;
mod probe;
mod rigid_obstacles;
mod scan_values;
mod settings;
mod touch_feel;
mod touch_occupancy;
mod touchable;
mod touched_surfaces;

pub use body::BodyVoxels;
pub use contact_model::{LimitedModel, Model};
pub use moved_poses::{CurrentPoses, MovedPoses};
pub use needle::{NeedleDisplay, NeedlePlace, NeedleReport, NeedleStatus, NeedleWatch, sharp};
pub use occupancy_change::{
    BrickChange, FractionSwap, Garbage, MAX_BRICKS, MAX_FRACTIONS, MAX_HELD,
};
pub use occupancy_fractions::{BodyFractions, FractionalBits};
pub use owners::Owners;
pub use part::{MovedPart, Part};
pub use placement::{PLACEMENT_REACH, free_point, in_front_of};
pub use probe::Probe;
pub use rigid_obstacles::{RigidObstacles, RigidWorld};
pub use scan_values::{ScanValues, Threshold, ThresholdRange};
pub use settings::{MAX_RADIUS, MOST_PRESSURE, Settings, SettingsError, Smoothing, check_radius};
pub use touch_feel::{TouchFeel, TouchFeels};
pub use touch_occupancy::{GARBAGE_PER_CHANGE, TouchOccupancy};
pub use touchable::{Body, Touchable, union_of, unmoved};
pub use touched_surfaces::TouchedSurfaces;
