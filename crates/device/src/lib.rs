//! Devices that are felt with: one trait, a simulated device and a scripted path.
//!
//! Frame: `device`, right-handed, x right, y up, z toward the person, in mm about the
//! middle of the workspace. Time s, force N, stiffness N/mm, mass kg. Vendors' own frames
//! and units are converted in their drivers and exist nowhere else.
//!
//! This crate knows nothing of voxels, contact models or threads: it takes forces and
//! gives positions. It will not depend on any other crate of the project.

mod haptic_device;
pub mod output_delay;
pub mod scripted;
pub mod simulated;
pub mod velocity_estimate;
mod work;

pub use haptic_device::{DeviceLimits, DeviceState, HapticDevice, saturated};
pub use work::Work;
