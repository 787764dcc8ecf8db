//! What the servo is given from outside: the device, the hand, and the answer of soft tissue.
//!
//! Frames: `_in_device` is the device's own, all else is the scene; mm, N, s.

use glam::{DQuat, DVec3};
use palpate_device::DeviceState;
use palpate_volume::material::LocalContact;
use palpate_volume::segment_set::SegmentSet;
use serde::{Deserialize, Serialize};

/// Device → servo: where the device is.
#[derive(Clone, Copy, Debug, Default)]
pub struct DeviceSample {
    /// Number of the reading, from 1; 0 before the first.
    pub number: u64,
    /// When it was read [s].
    pub time: f64,
    /// What was read, in the device's frame.
    pub state: DeviceState,
    /// The force that was last sent, in the device's frame [N].
    pub sent_in_device: DVec3,
}

/// Person → servo: where the hand pulls the device to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandTarget {
    /// In the scene [mm].
    pub point: DVec3,
    /// Rises with each target, so that a placement can tell the ones before it.
    pub number: u64,
}

/// The newest answer of a deformation model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DeformableContact {
    /// Deformable segments.
    pub segments: SegmentSet,
    /// How they push the tool; none where nothing is known of it.
    pub contact: Option<LocalContact>,
    /// Whether it stays where the next answer is late; none in recordings of 0.1 does.
    #[serde(default)]
    pub stays: bool,
}

/// What a tick is given from outside, besides commands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TickInputs {
    /// Time of the tick [s].
    pub time: f64,
    /// Number of the device's newest reading, from 1; 0 before the first.
    pub reading: u64,
    /// When that was read [s].
    pub read_at: f64,
    /// Where the device was, in its own frame [mm].
    pub position_in_device: DVec3,
    /// Its velocity, in its own frame [mm/s].
    pub velocity_in_device: DVec3,
    /// `device_from_handle`.
    pub orientation: DQuat,
    /// Pressed buttons, one bit each.
    pub buttons: u32,
    /// Where the person last wanted the hand to be.
    pub hand: HandTarget,
    /// Whether what a tick replaces can be given back to be freed; else nothing is replaced.
    pub has_room: bool,
}

impl TickInputs {
    /// The inputs of a tick at `time` [s].
    #[must_use]
    pub fn new(time: f64, sample: &DeviceSample, hand: HandTarget, has_room: bool) -> Self {
        Self {
            time,
            reading: sample.number,
            read_at: sample.time,
            position_in_device: sample.state.position,
            velocity_in_device: sample.state.velocity,
            orientation: sample.state.orientation,
            buttons: sample.state.buttons,
            hand,
            has_room,
        }
    }

    /// Whether the device was read at all.
    #[must_use]
    pub fn is_read(&self) -> bool {
        self.reading > 0
    }
}
