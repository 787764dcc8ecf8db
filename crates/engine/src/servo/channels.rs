//! What the threads hand to one another, and the wait-free channels for it.
//!
//! Latest values (a device's state, a force, a hand target) go through triple buffers; what must
//! not be lost (changes of occupancy, ticks, old bricks) through rings of a fixed size. Neither
//! side ever waits, and the servo neither allocates nor frees.
//!
//! Frames: `_in_device` is the device's own, all else is the scene; mm, N, s.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use palpate_device::DeviceState;
use palpate_haptics::local_force::LocalForce;
use palpate_haptics::needle::tissues::Tissues;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::material::LocalContact;
use palpate_volume::matter::SegmentSet;
use palpate_volume::shares::ShareBrick;
use rtrb::{Consumer, Producer, RingBuffer};
use serde::{Deserialize, Serialize};
use triple_buffer::{Input, Output, triple_buffer};

use crate::servo::servo_state::{ServoState, TickInputs};
use crate::touch::moved_poses::CurrentPoses;
use crate::touch::needle::NeedleStatus;
use crate::touch::settings::Settings;
use crate::touch::touch_feel::TouchFeel;
use crate::touch::touch_occupancy::GARBAGE_PER_CHANGE;
use crate::touch::touchable::{Touchable, union_brick};
use crate::touch::union_fractions::{FractionalBits, union_fraction_brick};

/// Commands that may wait for the servo.
const INBOX: usize = 4096;
/// Old bricks and roots that may wait to be freed.
const GARBAGE: usize = 2 * GARBAGE_PER_CHANGE;
/// Ticks whose records may wait for the picture: 2 s at 4 kHz.
const RECORDS: usize = 8192;
/// States that may wait for a recording; it asks for one at a time.
const SNAPSHOTS: usize = 4;

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

/// Servo → device: what to send.
#[derive(Clone, Copy, Debug)]
pub struct ForceCommand {
    /// When it was computed [s].
    pub time: f64,
    /// Number of the tick that computed it, from 1; 0 before the first.
    pub tick: u64,
    /// The contact as the device can follow it, in the device's frame, before the safety stage.
    pub law: LocalForce,
    /// Where a simulated hand pulls to, in the device's frame [mm].
    pub hand_in_device: DVec3,
    /// Largest force [N].
    pub max_force: f64,
}

/// Person → servo: where the hand pulls the device to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandTarget {
    /// In the scene [mm].
    pub point: DVec3,
    /// Rises with each target, so that a placement can tell the ones before it.
    pub number: u64,
}

/// Simulation → servo, executed in order.
#[derive(Debug)]
pub enum ServoCommand {
    /// Replaces all that can be touched.
    Root {
        /// Number of the change.
        sequence: u64,
        /// What is to be touched.
        touchable: Box<Touchable>,
    },
    /// Replaces some bricks of it.
    Bricks(BrickChange),
    /// Brings probe, device and hand to a point [mm].
    Place {
        /// Where to.
        point: DVec3,
        /// Hand targets up to this number are forgotten.
        hand: u64,
        /// Whether the device is brought there too, by moving the mapping.
        device_too: bool,
    },
    /// Turns the axes in which the device moves the probe.
    Turn(DMat3),
    /// Has the device move without the probe, or with it again.
    Clutch(bool),
    /// New settings.
    Settings(Settings),
    /// Where a moved segment is to go, a rigid motion [mm].
    Pose(SegmentId, DAffine3),
    /// How the surface of a segment feels from now on.
    Feel(SegmentId, TouchFeel),
    /// What is deformable from now on, and how it pushes.
    DeformableContact(DeformableContact),
    /// Takes a needle in the hand that can puncture these segments, or out of it.
    Needle(bool, Box<Tissues>),
    /// Asks for the servo's state at the end of this tick, from where it can be replayed.
    Mark,
}

/// The newest answer of a deformation model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DeformableContact {
    /// Deformable segments.
    pub segments: SegmentSet,
    /// How they push the tool; none where nothing is known of it.
    pub contact: Option<LocalContact>,
}

/// Servo → simulation: where a recording begins.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot {
    /// The state between two ticks. Its last command is the mark that asked for it.
    pub state: ServoState,
    /// Whether changes were held back, which a recording cannot begin with.
    pub held: bool,
}

/// The bricks of one edit.
#[derive(Debug)]
pub struct BrickChange {
    /// Number of the change.
    pub sequence: u64,
    /// Of the union: at most [`MAX_BRICKS`], by rising index, each once.
    pub swaps: Vec<BrickSwap<BitBrick>>,
    /// Of the segments that it changes, at most [`MAX_BRICKS`].
    pub parts: Vec<(SegmentId, BrickSwap<BitBrick>)>,
    /// What is known of the occupancy fractions of the union: at most [`MAX_FRACTIONS`], by rising
    /// index.
    pub fractions: Vec<BrickSwap<ShareBrick>>,
    /// The same of the segments, at most [`MAX_BRICKS`], for whoever records.
    pub part_fractions: Vec<FractionSwap>,
}

/// What is known of the shares in a brick of a segment.
pub type FractionSwap = (SegmentId, BrickSwap<ShareBrick>);

impl BrickChange {
    /// Bricks of segments that hold them by now; what becomes of the union follows from all
    /// segments that were not moved.
    #[must_use]
    pub fn new(
        sequence: u64,
        unmoved: &[FractionalBits<'_>],
        changed: Vec<(SegmentId, BrickSwap<BitBrick>)>,
        part_fractions: Vec<FractionSwap>,
    ) -> Self {
        let mut bricks: Vec<u32> = changed.iter().map(|(_, swap)| swap.index).collect();
        bricks.sort_unstable();
        bricks.dedup();
        let bits: Vec<&Bits> = unmoved.iter().map(|part| part.bits).collect();
        let swaps = bricks.iter().map(|&index| BrickSwap {
            index,
            brick: union_brick(&bits, index),
        });
        let swaps = swaps.collect();
        Self {
            sequence,
            swaps,
            parts: changed,
            fractions: Self::union_fractions(unmoved, bricks, &part_fractions),
            part_fractions,
        }
    }

    /// What becomes of the occupancy fractions of the union where bits or occupancy fractions of
    /// segments change.
    fn union_fractions(
        unmoved: &[FractionalBits<'_>],
        mut bricks: Vec<u32>,
        changed: &[FractionSwap],
    ) -> Vec<BrickSwap<ShareBrick>> {
        if unmoved.iter().all(|part| part.fractions.is_none()) {
            return Vec::new();
        }
        if let [first, _, ..] = unmoved {
            // where one segment goes on beside another there is no surface
            let directory = first.bits.bricks();
            let beside = |&index: &u32| directory.indices_beside(index);
            let beside: Vec<u32> = bricks.iter().flat_map(beside).collect();
            bricks.extend(beside);
        }
        bricks.extend(changed.iter().map(|(_, swap)| swap.index));
        bricks.sort_unstable();
        bricks.dedup();
        let swap = |index| BrickSwap {
            index,
            brick: union_fraction_brick(unmoved, index),
        };
        bricks.into_iter().map(swap).collect()
    }
}

/// Servo → simulation: what is to be freed there. The fields are only ever dropped.
#[derive(Debug)]
pub enum Garbage {
    /// An occupancy that is no longer touched.
    Root(Box<Touchable>),
    /// Bricks that are no longer touched.
    Bricks(BrickChange),
    /// What a command told of a needle, once that is known.
    Tissues(Box<Tissues>),
    /// A brick that was never touched.
    Brick(BrickSwap<BitBrick>),
    /// The same of occupancy fractions.
    Shares(BrickSwap<ShareBrick>),
}

/// Bricks of one edit, at most; larger edits go as a root.
pub const MAX_BRICKS: usize = 256;
/// Bricks of occupancy fractions that come with them, at most.
pub const MAX_FRACTIONS: usize = 2 * MAX_BRICKS;
/// Edits that are held back, at most; beyond, a root has to bring them all.
pub const MAX_HELD: usize = 8;

/// Servo → simulation: what touch has followed.
#[derive(Clone, Copy, Debug, Default)]
pub struct ServoStatus {
    /// The last change that was taken from the inbox.
    pub received: u64,
    /// First and last change that is in a root held back; none where `first` is 0.
    pub held_root: (u64, u64),
    /// Edits held back, then zeros.
    pub held_edits: [u64; MAX_HELD],
    /// Edits that were not even held, since too many are.
    pub skipped: u64,
    /// Moved segments that the probe keeps from where they are to go.
    pub stopped: SegmentSet,
    /// Placements refused, since there was no free voxel near the point.
    pub refused_places: u64,
    /// Radius of the probe that was admitted [mm].
    pub radius: f64,
    /// Where the device is.
    pub device: DVec3,
    /// Where the probe is.
    pub proxy: DVec3,
    /// The tool as soft tissue meets it.
    pub tool: DVec3,
    /// Whether an obstacle holds the probe back.
    pub contact: bool,
    /// The segment that is touched; 0 where there is none.
    pub touched: u8,
    /// Time of the tick [s].
    pub time: f64,
    /// Out of the surface that is touched; zero without contact.
    pub normal: DVec3,
    /// Size of the force that was last sent to the device [N].
    pub sent_force: f64,
    /// `scene_from_device`, axes only.
    pub axes: DMat3,
    /// `device_from_handle`.
    pub orientation: DQuat,
    /// The middle of the device's workspace in the scene [mm].
    pub origin: DVec3,
    /// Commands executed by then.
    pub command: u64,
}

/// Servo → picture: one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TickRecord {
    /// Number of the tick, from 0.
    pub tick: u64,
    /// Time of the tick [s].
    pub time: f64,
    /// Where the device was.
    pub device: DVec3,
    /// Where the hand pulled it to.
    pub hand: DVec3,
    /// Where the probe was.
    pub proxy: DVec3,
    /// Where the force came from, on the smooth surface.
    pub contact_point: DVec3,
    /// Out of the surface there; zero without contact.
    pub normal: DVec3,
    /// The force of the contact, before the safety stage.
    pub force: DVec3,
    /// The force that was last sent to the device when the tick began.
    pub sent_force: DVec3,
    /// Whether an obstacle held the probe back.
    pub contact: bool,
    /// How far the device was behind the probe [mm]; 0 without contact.
    pub depth: f64,
    /// Voxels asked for.
    pub visits: u32,
    /// What the tick was given.
    pub inputs: TickInputs,
    /// Number of the last command that was executed, in this tick or before it.
    pub command: u64,
}

/// The device thread's ends.
#[derive(Debug)]
pub struct DeviceChannels {
    /// To the servo.
    pub samples: Input<DeviceSample>,
    /// From the servo.
    pub forces: Output<ForceCommand>,
}

/// The servo's ends.
#[derive(Debug)]
pub struct ServoChannels {
    /// From the device.
    pub samples: Output<DeviceSample>,
    /// To the device.
    pub forces: Input<ForceCommand>,
    /// From the person.
    pub hand: Output<HandTarget>,
    /// From the simulation.
    pub inbox: Consumer<ServoCommand>,
    /// To the simulation.
    pub garbage: Producer<Garbage>,
    /// To the simulation.
    pub status: Input<ServoStatus>,
    /// To the simulation, where any of them has changed.
    pub poses: Input<CurrentPoses>,
    /// To the simulation, while a needle is felt and once more when it no longer is.
    pub needle: Input<NeedleStatus>,
    /// To the picture.
    pub records: Producer<TickRecord>,
    /// To the simulation.
    pub snapshots: Producer<Snapshot>,
}

/// The simulation's ends.
#[derive(Debug)]
pub struct SimulationChannels {
    /// To the servo.
    pub inbox: Producer<ServoCommand>,
    /// From the servo.
    pub garbage: Consumer<Garbage>,
    /// From the servo.
    pub status: Output<ServoStatus>,
    /// From the servo: where moved segments stand, at the time of the status or later.
    pub poses: Output<CurrentPoses>,
    /// From the servo: the needle, at the time of the status or later.
    pub needle: Output<NeedleStatus>,
    /// From the servo.
    pub snapshots: Consumer<Snapshot>,
}

/// All channels of a session.
#[derive(Debug)]
pub struct Channels {
    /// The device thread's ends.
    pub device: DeviceChannels,
    /// The servo's ends.
    pub servo: ServoChannels,
    /// The simulation's ends.
    pub simulation: SimulationChannels,
    /// The picture's end.
    pub records: Consumer<TickRecord>,
    /// The person's end.
    pub hand: Input<HandTarget>,
}

impl Channels {
    /// Empty channels; the hand is at `hand` [mm].
    #[must_use]
    pub fn new(hand: DVec3) -> Self {
        let (samples_in, samples_out) = triple_buffer(&DeviceSample::default());
        let (forces_in, forces_out) = triple_buffer(&ForceCommand {
            time: 0.0,
            tick: 0,
            law: LocalForce::NONE,
            hand_in_device: DVec3::ZERO,
            max_force: 0.0,
        });
        let (hand_in, hand_out) = triple_buffer(&HandTarget {
            point: hand,
            number: 0,
        });
        let (status_in, status_out) = triple_buffer(&ServoStatus::default());
        let (poses_in, poses_out) = triple_buffer(&CurrentPoses::default());
        let (needle_in, needle_out) = triple_buffer(&NeedleStatus::default());
        let (inbox_in, inbox_out) = RingBuffer::new(INBOX);
        let (garbage_in, garbage_out) = RingBuffer::new(GARBAGE);
        let (records_in, records_out) = RingBuffer::new(RECORDS);
        let (snapshots_in, snapshots_out) = RingBuffer::new(SNAPSHOTS);
        Self {
            device: DeviceChannels {
                samples: samples_in,
                forces: forces_out,
            },
            servo: ServoChannels {
                samples: samples_out,
                forces: forces_in,
                hand: hand_out,
                inbox: inbox_out,
                garbage: garbage_in,
                status: status_in,
                poses: poses_in,
                needle: needle_in,
                records: records_in,
                snapshots: snapshots_in,
            },
            simulation: SimulationChannels {
                inbox: inbox_in,
                garbage: garbage_out,
                status: status_out,
                poses: poses_out,
                needle: needle_out,
                snapshots: snapshots_out,
            },
            records: records_out,
            hand: hand_in,
        }
    }
}
