//! Keeps a tape while a session runs: a mark, the servo's state there, and what is sent after it.

use palpate_volume::bit_brick::BitBrick;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy_fractions::FractionBrick;
use rtrb::Consumer;

use super::bricks::{changed_bricks, changed_fractions, put, put_fractions};
use super::{PartSwap, Tape, TapeCommand, TapeEntry, TapePart};
use crate::servo::{ServoCommand, ServoState, Snapshot};
use crate::touch::{FractionSwap, Part, ScanValues};

/// Memory for the changes of one recording, at most; a brick counts as if nobody shared it.
pub const MAX_TAPE_BYTES: usize = 1 << 29;

/// A swap with a brick of its own, whose counters fill a cache line.
const SWAP_BYTES: usize = size_of::<PartSwap>() + 2 * size_of::<BitBrick>();
const SHARE_BYTES: usize = size_of::<FractionSwap>() + size_of::<FractionBrick>();

/// Keeps a tape; shared by the simulation, which sends, and whoever wants the recording.
#[derive(Debug)]
pub struct TapeRecorder {
    snapshots: Consumer<Snapshot>,
    stage: Stage,
    max_bytes: usize,
}

/// How far a recording is.
#[derive(Debug)]
enum Stage {
    /// Nobody wants one.
    Idle,
    /// It begins as soon as the servo follows all changes.
    Wanted,
    /// All that is sent is noted.
    Running(Box<Writer>),
}

/// What is noted.
#[derive(Debug)]
struct Writer {
    /// Number of the mark.
    mark: u64,
    grid: Grid,
    values: ScanValues,
    first: Vec<Part>,
    /// The servo's state at the mark, once it has told it.
    state: Option<ServoState>,
    /// What the servo will touch once it has executed all that was noted.
    latest: Vec<Part>,
    entries: Vec<TapeEntry>,
    bytes: usize,
    is_full: bool,
}

impl TapeRecorder {
    /// A recorder that gets the servo's states here.
    #[must_use]
    pub fn new(snapshots: Consumer<Snapshot>) -> Self {
        Self {
            snapshots,
            stage: Stage::Idle,
            max_bytes: MAX_TAPE_BYTES,
        }
    }

    /// Limits the memory for changes, for tests.
    pub fn limit(&mut self, max_bytes: usize) {
        self.max_bytes = max_bytes;
    }

    /// Asks for a tape; one that runs is thrown away.
    pub fn want(&mut self) {
        self.stage = Stage::Wanted;
    }

    /// Whether a tape waits for its beginning.
    #[must_use]
    pub fn is_wanted(&self) -> bool {
        matches!(self.stage, Stage::Wanted)
    }

    /// Whether the running tape is full.
    #[must_use]
    pub fn is_full(&self) -> bool {
        matches!(&self.stage, Stage::Running(writer) if writer.is_full)
    }

    /// Notes that the mark with this number is sent, and what will be solid by then. Which of
    /// the scan's values the servo reads counts from here: at the mark it forgets what it made
    /// of others.
    pub fn begin(&mut self, mark: u64, (grid, values): (Grid, ScanValues), parts: Vec<Part>) {
        values.begin_marking();
        self.stage = Stage::Running(Box::new(Writer {
            mark,
            grid,
            values,
            first: parts.clone(),
            state: None,
            latest: parts,
            entries: Vec::new(),
            bytes: 0,
            is_full: false,
        }));
    }

    /// Notes a command that is sent after the mark.
    pub fn note(&mut self, command: &ServoCommand) {
        if let Stage::Running(writer) = &mut self.stage {
            writer.note(command, self.max_bytes);
        }
    }

    /// Takes the state that the servo was asked for.
    pub fn collect(&mut self) {
        while let Ok(Snapshot { state, held }) = self.snapshots.pop() {
            match &mut self.stage {
                Stage::Running(writer) if writer.mark == state.command => {
                    if held {
                        self.stage = Stage::Wanted;
                    } else {
                        writer.state = Some(state);
                    }
                }
                // the state of a recording that was thrown away
                _ => {}
            }
        }
    }

    /// Ends the recording and gives it; none where it has not begun.
    pub fn finish(&mut self) -> Option<Tape> {
        self.collect();
        match std::mem::replace(&mut self.stage, Stage::Idle) {
            Stage::Running(writer) => Some(Tape {
                grid: writer.grid,
                state: writer.state?,
                parts: writer.first,
                values: writer.values.end_marking(),
                entries: writer.entries,
                is_full: writer.is_full,
            }),
            Stage::Idle | Stage::Wanted => None,
        }
    }
}

impl Writer {
    fn note(&mut self, command: &ServoCommand, max_bytes: usize) {
        if self.is_full {
            return;
        }
        let entry = self.entry(command);
        self.bytes += size_of::<TapeEntry>()
            + entry.swaps.len() * SWAP_BYTES
            + entry.fractions.len() * SHARE_BYTES;
        if self.bytes > max_bytes {
            self.is_full = true;
        } else {
            self.entries.push(entry);
        }
    }

    fn entry(&mut self, command: &ServoCommand) -> TapeEntry {
        let (mut swaps, mut fractions) = (Vec::new(), Vec::new());
        let command = match command {
            ServoCommand::Root {
                sequence,
                touchable,
            } => {
                for part in &touchable.parts {
                    swaps.extend(changed_bricks(&self.latest, part));
                    fractions.extend(changed_fractions(&self.latest, part));
                }
                self.latest.clone_from(&touchable.parts);
                TapeCommand::Root {
                    sequence: *sequence,
                    parts: touchable.parts.iter().map(TapePart::from).collect(),
                }
            }
            ServoCommand::Bricks(change) => {
                swaps.clone_from(&change.parts);
                fractions.clone_from(&change.part_fractions);
                put(&mut self.latest, &swaps);
                put_fractions(&mut self.latest, &fractions);
                TapeCommand::Bricks {
                    sequence: change.sequence,
                }
            }
            &ServoCommand::Place {
                point,
                hand,
                device_too,
            } => TapeCommand::Place {
                point,
                hand,
                device_too,
            },
            ServoCommand::Turn(rotation) => TapeCommand::Turn(*rotation),
            ServoCommand::Clutch(on) => TapeCommand::Clutch(*on),
            ServoCommand::Settings(settings) => TapeCommand::Settings(*settings),
            ServoCommand::Pose(id, pose) => TapeCommand::Pose(id.0, *pose),
            ServoCommand::Feel(id, feel) => TapeCommand::Feel(id.0, *feel),
            ServoCommand::DeformableContact(deformable_contact) => {
                TapeCommand::DeformableContact(*deformable_contact)
            }
            ServoCommand::Needle(on, tissues) => TapeCommand::Needle(*on, tissues.clone()),
            ServoCommand::NeedleDirection(direction) => TapeCommand::NeedleDirection(*direction),
            ServoCommand::Mark => TapeCommand::Mark,
        };
        TapeEntry {
            command,
            swaps,
            fractions,
        }
    }
}
