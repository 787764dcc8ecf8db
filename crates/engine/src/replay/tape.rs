//! What the servo was told while a recording ran, and the state that it began with.
//!
//! Together with the inputs of each tick ([`crate::replay::recording`]) this is all that a replay
//! needs. The sender notes each command as it sends it; the servo says with each tick how many
//! commands it had executed by then. What a new root changes is kept brick by brick, so that a
//! threshold that is dragged for minutes costs what it changes and not what the scan holds.

use glam::{DAffine3, DMat3, DVec3, IVec3};
use palpate_haptics::needle::tissues::Tissues;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use serde::{Deserialize, Serialize};

use crate::replay::mask_runs::{MaskRun, runs_of};
use crate::servo::{DeformableContact, ServoState};
use crate::touch::{
    FractionSwap, MovedPart, Part, ScanValues, Settings, ThresholdRange, TouchFeel,
};

mod bricks;
mod recorder;

pub use bricks::{put, put_fractions, rooted};
pub use recorder::{MAX_TAPE_BYTES, TapeRecorder};

/// A command, without its bricks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TapeCommand {
    /// All that can be touched was replaced; the bricks are those that it changed.
    Root {
        /// Number of the change.
        sequence: u64,
        /// The segments, by rising number.
        parts: Vec<TapePart>,
    },
    /// Some bricks were replaced.
    Bricks {
        /// Number of the change.
        sequence: u64,
    },
    /// Probe, hand and perhaps the device were brought to a point [mm].
    Place {
        /// Where to.
        point: DVec3,
        /// Hand targets up to this number were forgotten.
        hand: u64,
        /// Whether the device was brought there too.
        device_too: bool,
    },
    /// The axes of the device were turned.
    Turn(DMat3),
    /// The device moved without the probe, or with it again.
    Clutch(bool),
    /// New settings.
    Settings(Settings),
    /// A moved segment was to go there.
    Pose(u8, DAffine3),
    /// How the surface of a segment felt from then on.
    Feel(u8, TouchFeel),
    /// What was deformable from then on.
    #[serde(rename = "GiveWay")]
    DeformableContact(DeformableContact),
    /// A needle was taken in the hand, or out of it.
    Needle(bool, Box<Tissues>),
    /// The direction in which a needle was to go in; none for that of the push.
    NeedleDirection(Option<DVec3>),
    /// A recording began anew.
    Mark,
}

/// A segment that can be touched, without its voxels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TapePart {
    /// Which segment.
    pub id: u8,
    /// Where it was moved: a box that holds its voxels, first voxel and one past the last, and
    /// the pose that a servo starts from that does not know the segment yet.
    pub moved: Option<(IVec3, IVec3, DAffine3)>,
    /// The threshold that made it.
    pub threshold: Option<ThresholdRange>,
    /// Whether a needle had punctured it.
    #[serde(default)]
    pub punctured: bool,
    /// The grid of its voxels, where it is not the scan's; only of moved ones.
    #[serde(default)]
    pub own_grid: Option<Grid>,
    /// Where it is rigid although it is deformable.
    #[serde(default)]
    pub rigid: Vec<MaskRun>,
}

impl From<&Part> for TapePart {
    fn from(part: &Part) -> Self {
        Self {
            id: part.id.0,
            moved: part
                .moved
                .map(|MovedPart { bounds, pose, .. }| (bounds.min, bounds.max, pose)),
            own_grid: part.moved.and_then(|moved| moved.own_grid),
            threshold: part.threshold.as_ref().map(|threshold| threshold.range),
            punctured: part.punctured,
            rigid: part.rigid.as_ref().map_or_else(Vec::new, runs_of),
        }
    }
}

/// A brick of a segment.
pub type PartSwap = (SegmentId, BrickSwap<BitBrick>);

/// A command with its bricks.
#[derive(Clone, Debug)]
pub struct TapeEntry {
    /// What was to be done.
    pub command: TapeCommand,
    /// Bricks of a change, by rising segment and index, each once.
    pub swaps: Vec<PartSwap>,
    /// What became known of occupancy fractions, in the same order.
    pub fractions: Vec<FractionSwap>,
}

/// The state that a recording began with, and every command since.
#[derive(Clone, Debug)]
pub struct Tape {
    /// Where the scan stands.
    pub grid: Grid,
    /// The servo's state before the tick `state.tick`, with nothing held back.
    pub state: ServoState,
    /// What could be touched then, by rising number.
    pub parts: Vec<Part>,
    /// The scan's values, of which those that touch read are marked.
    pub values: ScanValues,
    /// Commands from number `state.command + 1` on, without a gap.
    pub entries: Vec<TapeEntry>,
    /// Whether there was no memory for the commands that came after.
    pub is_full: bool,
}
