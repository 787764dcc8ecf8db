//! Computes a recorded session again, tick by tick, and compares every bit that came out.
//!
//! No threads and no clock: a servo goes on from the state that the recording began with and is
//! given the inputs and commands of each tick. The same build gives the same proxy and the same
//! force bit for bit; another build, or another machine, may not.
//!
//! The hash is FNV-1a with 64 bits (Fowler, Noll, Vo, 1991) over the bits of each tick's number,
//! proxy and force.

use std::sync::Arc;

use glam::DVec3;
use palpate_haptics::ball::BallError;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;

use crate::replay::recording::Recording;
use crate::replay::tape::{Tape, TapeCommand, TapeEntry, put, put_fractions, rooted};
use crate::servo::{
    Channels, MAX_COMMANDS_PER_TICK, ServoCommand, ServoLoop, Shared, SimulationChannels,
    TickRecord,
};
use crate::touch::{BrickChange, FractionalBits, Part, ScanValues, Touchable, unmoved};

/// Why a recording cannot be replayed at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReplayError {
    /// The tick at which the tape begins is missing.
    #[error("the recording does not hold tick {tick}, from where it can be replayed")]
    NoBeginning {
        /// The tick wanted.
        tick: u64,
    },
    /// No servo executes commands like this.
    #[error(
        "tick {tick} has executed {command} commands after {before}; allowed: none to \
         {MAX_COMMANDS_PER_TICK} more"
    )]
    Commands {
        /// The tick.
        tick: u64,
        /// Commands executed by then.
        command: u64,
        /// Commands executed by the tick before.
        before: u64,
    },
    /// No such probe fits these voxels.
    #[error(transparent)]
    Ball(#[from] BallError),
}

/// How far a replay came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplayEnd {
    /// To the last tick.
    Whole,
    /// To where ticks are missing.
    Lost {
        /// The last tick before them.
        after: u64,
        /// How many are missing there.
        count: u64,
    },
    /// To the last tick before commands are missing.
    Commands {
        /// The last tick before them.
        after: u64,
    },
}

/// The first tick that is not what it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Its number.
    pub tick: u64,
    /// Its time [s].
    pub time: f64,
    /// How far the proxy is from where it was [mm].
    pub proxy: f64,
    /// How much the force differs [N].
    pub force: f64,
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// The ticks as they were computed now.
    pub ticks: Recording,
    /// Where in the recording they begin.
    pub first_row: usize,
    /// How far it came.
    pub end: ReplayEnd,
    /// Hash of what was recorded, over the same ticks.
    pub recorded_hash: u64,
    /// Hash of what was computed now.
    pub replayed_hash: u64,
    /// Ticks that differ.
    pub different: u64,
    /// The first of them.
    pub first_difference: Option<Difference>,
}

impl Replayed {
    /// Whether every tick that was replayed is what it was, bit for bit.
    #[must_use]
    pub fn is_equal(&self) -> bool {
        self.different == 0
    }
}

/// Computes the ticks of a recording again.
///
/// # Errors
/// Where ticks and tape do not belong together.
pub fn replay(recording: &Recording, tape: &Tape) -> Result<Replayed, ReplayError> {
    let first = tape.state.tick;
    let first_row = recording
        .tick
        .binary_search(&first)
        .map_err(|_| ReplayError::NoBeginning { tick: first })?;
    let mut player = Player::new(tape)?;
    let mut replayed = Replayed {
        ticks: Recording::default(),
        first_row,
        end: ReplayEnd::Whole,
        recorded_hash: HASH_START,
        replayed_hash: HASH_START,
        different: 0,
        first_difference: None,
    };
    for (row, expected) in (first_row..recording.len()).zip(first..) {
        let tick = recording.tick[row];
        let after = expected.saturating_sub(1);
        if tick != expected {
            let count = tick.saturating_sub(expected);
            replayed.end = ReplayEnd::Lost { after, count };
            break;
        }
        if !player.send_up_to(tick, recording.command[row])? {
            replayed.end = ReplayEnd::Commands { after };
            break;
        }
        replayed.compare(recording, row, &player.tick(recording, row));
    }
    Ok(replayed)
}

impl Replayed {
    fn compare(&mut self, recording: &Recording, row: usize, now: &TickRecord) {
        let (proxy, force) = (recording.proxy[row], recording.force[row]);
        let was = [now.tick, recording.command[row]];
        self.recorded_hash = hash(self.recorded_hash, was, proxy, force);
        let is = [now.tick, now.command];
        self.replayed_hash = hash(self.replayed_hash, is, now.proxy, now.force);
        let same = was == is
            && bits(proxy) == bits(now.proxy)
            && bits(force) == bits(now.force)
            && recording.contact[row] == now.contact;
        if !same {
            self.different += 1;
            self.first_difference.get_or_insert(Difference {
                tick: now.tick,
                time: now.time,
                proxy: proxy.distance(now.proxy),
                force: force.distance(now.force),
            });
        }
        self.ticks.push(now, recording.touched[row]);
    }
}

/// A servo with all other ends of its channels in one hand.
struct Player<'a> {
    servo: ServoLoop,
    simulation: SimulationChannels,
    records: rtrb::Consumer<TickRecord>,
    entries: std::slice::Iter<'a, TapeEntry>,
    /// Commands sent.
    sent: u64,
    /// What the servo will touch once it has executed them.
    latest: Vec<Part>,
    grid: Grid,
    values: &'a ScanValues,
}

impl<'a> Player<'a> {
    fn new(tape: &'a Tape) -> Result<Self, ReplayError> {
        let channels = Channels::new(tape.state.hand);
        let shared = Arc::new(Shared::default());
        let touchable = Touchable::new(&tape.grid, tape.parts.clone(), tape.state.radius)?;
        let servo = ServoLoop::resume(tape.grid, touchable, tape.state, (channels.servo, shared));
        Ok(Self {
            servo,
            simulation: channels.simulation,
            records: channels.records,
            entries: tape.entries.iter(),
            sent: tape.state.command,
            grid: tape.grid,
            values: &tape.values,
            latest: tape.parts.clone(),
        })
    }

    /// Sends the commands that a tick executed; false where the tape ends before them.
    fn send_up_to(&mut self, tick: u64, command: u64) -> Result<bool, ReplayError> {
        let wanted = command.checked_sub(self.sent);
        if wanted.is_none_or(|wanted| wanted > MAX_COMMANDS_PER_TICK as u64) {
            return Err(ReplayError::Commands {
                tick,
                command,
                before: self.sent,
            });
        }
        while self.sent < command {
            let Some(entry) = self.entries.next() else {
                return Ok(false);
            };
            let command = self.command(entry)?;
            self.sent += 1;
            let pushed = self.simulation.inbox.push(command);
            assert!(pushed.is_ok(), "a tick's commands have room");
        }
        Ok(true)
    }

    /// A command as it was sent.
    fn command(&mut self, entry: &TapeEntry) -> Result<ServoCommand, ReplayError> {
        if let TapeCommand::Root { parts, .. } = &entry.command {
            self.latest = rooted(&self.latest, parts, self.values);
        }
        put(&mut self.latest, &entry.swaps);
        put_fractions(&mut self.latest, &entry.fractions);
        Ok(match entry.command {
            TapeCommand::Root { sequence, .. } => ServoCommand::Root {
                sequence,
                // the servo knows which radius the probe has
                touchable: Box::new(Touchable::new(&self.grid, self.latest.clone(), 0.0)?),
            },
            TapeCommand::Bricks { sequence } => ServoCommand::Bricks(BrickChange::new(
                sequence,
                &unmoved(&self.latest)
                    .map(FractionalBits::from)
                    .collect::<Vec<_>>(),
                entry.swaps.clone(),
                entry.fractions.clone(),
            )),
            TapeCommand::Place {
                point,
                hand,
                device_too,
            } => ServoCommand::Place {
                point,
                hand,
                device_too,
            },
            TapeCommand::Turn(rotation) => ServoCommand::Turn(rotation),
            TapeCommand::Clutch(on) => ServoCommand::Clutch(on),
            TapeCommand::Settings(settings) => ServoCommand::Settings(settings),
            TapeCommand::Pose(id, pose) => ServoCommand::Pose(SegmentId(id), pose),
            TapeCommand::Feel(id, feel) => ServoCommand::Feel(SegmentId(id), feel),
            TapeCommand::DeformableContact(deformable_contact) => {
                ServoCommand::DeformableContact(deformable_contact)
            }
            TapeCommand::Needle(on, ref tissues) => ServoCommand::Needle(on, tissues.clone()),
            TapeCommand::NeedleDirection(direction) => ServoCommand::NeedleDirection(direction),
            TapeCommand::Mark => ServoCommand::Mark,
        })
    }

    fn tick(&mut self, recording: &Recording, row: usize) -> TickRecord {
        self.servo.tick(&recording.inputs(row), DVec3::ZERO);
        while self.simulation.garbage.pop().is_ok() {}
        while self.simulation.snapshots.pop().is_ok() {}
        let record = self.records.pop().expect("every tick is recorded");
        TickRecord {
            // what the device was sent is no outcome of the servo
            sent_force: recording.sent_force[row],
            ..record
        }
    }
}

const HASH_START: u64 = 0xcbf2_9ce4_8422_2325;
const HASH_PRIME: u64 = 0x0100_0000_01b3;

/// The hash with another tick in it.
fn hash(before: u64, numbers: [u64; 2], proxy: DVec3, force: DVec3) -> u64 {
    let words = numbers.into_iter().chain(bits(proxy)).chain(bits(force));
    words.flat_map(u64::to_le_bytes).fold(before, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(HASH_PRIME)
    })
}

/// What a vector is made of: two that are equal as numbers may still differ in a sign of zero.
fn bits(vector: DVec3) -> [u64; 3] {
    vector.to_array().map(f64::to_bits)
}
