//! What the threads hand to one another, and the wait-free channels for it.
//!
//! Latest values (a device's state, a force, a hand target) go through triple buffers; what must
//! not be lost (changes of occupancy, ticks, old bricks) through rings of a fixed size. Neither
//! side ever waits, and the servo neither allocates nor frees.
//!
//! Frames: `_in_device` is the device's own, all else is the scene; mm, N, s.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use palpate_haptics::force::LocalForce;
use palpate_haptics::needle::tissues::Tissues;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment_set::SegmentSet;
use rtrb::{Consumer, Producer, RingBuffer};
use triple_buffer::{Input, Output, triple_buffer};

use crate::servo::inputs::{DeformableContact, DeviceSample, HandTarget, TickInputs};
use crate::servo::servo_state::ServoState;
use crate::touch::{
    BrickChange, CurrentPoses, GARBAGE_PER_CHANGE, Garbage, MAX_HELD, NeedleStatus, Settings,
    TouchFeel, Touchable,
};

/// Commands that may wait for the servo.
const INBOX: usize = 4096;
/// Old bricks and roots that may wait to be freed.
const GARBAGE: usize = 2 * GARBAGE_PER_CHANGE;
/// Ticks whose records may wait for the picture: 2 s at 4 kHz.
const RECORDS: usize = 8192;
/// States that may wait for a recording; it asks for one at a time.
const SNAPSHOTS: usize = 4;

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
    /// Sets the direction in which a needle goes in, inward; none for that of the push.
    NeedleDirection(Option<DVec3>),
    /// Asks for the servo's state at the end of this tick, from where it can be replayed.
    Mark,
}

/// Servo → simulation: where a recording begins.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot {
    /// The state between two ticks. Its last command is the mark that asked for it.
    pub state: ServoState,
    /// Whether changes were held back, which a recording cannot begin with.
    pub held: bool,
}

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
    /// Force that presses on what is touched, without friction and damping, over time since the start
    /// [N·s]; the ticks in which no force was sent do not count.
    pub pressed: f64,
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
