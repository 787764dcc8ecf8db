//! What the servo carries from tick to tick.
//!
//! State, inputs (`inputs.rs`), what is solid and the commands of the simulation decide what comes out of a
//! tick, and nothing else does: that is what record and replay rest on. Whatever a tick is to
//! remember stands in [`ServoState`], and is recorded by standing there.
//!
//! Frames: `_in_device` is the device's own, all else is the scene; mm, N, s.

use glam::DVec3;
use palpate_haptics::needle::Needle;
use palpate_haptics::soft_contact::SoftContact;
use palpate_haptics::tick::TickState;
use serde::{Deserialize, Serialize};

use crate::servo::inputs::DeformableContact;
use crate::servo::mapping::Mapping;
use crate::touch::{MovedPoses, Settings, TouchFeels};

/// All that changes from tick to tick, besides what is solid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServoState {
    /// The proxy, and whatever touch remembers.
    pub touch: TickState,
    /// `scene_from_device`.
    pub mapping: Mapping,
    /// Settings that the device bears.
    pub settings: Settings,
    /// How each segment feels.
    pub feels: TouchFeels,
    /// Radius of the probe that was admitted [mm]; the settings have the one that is wanted.
    pub radius: f64,
    /// Where moved segments stand and go.
    pub poses: MovedPoses,
    /// The segment that is touched; 0 where there is none.
    pub touched: u8,
    /// What is deformable.
    #[serde(default, rename = "giving_way")]
    pub deformable_contact: DeformableContact,
    /// How its force is followed.
    #[serde(default)]
    pub soft: SoftContact,
    /// The needle in the hand, or none.
    #[serde(default)]
    pub needle: Needle,
    /// Where the hand pulls the device to [mm].
    pub hand: DVec3,
    /// Where the probe stays while the device moves without it [mm].
    #[serde(default)]
    pub clutch: Option<DVec3>,
    /// Hand targets up to this number are older than the last placement.
    pub forgotten_hand: u64,
    /// The last change of what is solid that was taken from the inbox.
    pub received: u64,
    /// Placements refused.
    pub refused_places: u64,
    /// Commands executed since the start: they are numbered from 1, in their order.
    pub command: u64,
    /// Number of the tick to come, from 0.
    pub tick: u64,
}
