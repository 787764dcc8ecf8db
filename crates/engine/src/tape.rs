//! What the servo was told while a recording ran, and the state that it began with.
//!
//! Together with the inputs of each tick ([`crate::recording`]) this is all that a replay needs.
//! The sender notes each command as it sends it; the servo says with each tick how many commands
//! it had obeyed by then. What a new root changes is kept brick by brick, so that a threshold
//! that is dragged for minutes costs what it changes and not what the scan holds.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, IVec3};
use palpate_haptics::needle::tissues::Tissues;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::shares::{ShareBrick, Shares};
use palpate_volume::voxel_box::VoxelBox;
use rtrb::Consumer;
use serde::{Deserialize, Serialize};

use crate::feel::Feel;
use crate::handover::{GivingWay, ServoCommand, ShareSwap, Snapshot};
use crate::mask_runs::{MaskRun, mask_of, runs_of};
use crate::scan_values::{ScanValues, Threshold};
use crate::scene::ThresholdRange;
use crate::servo_state::ServoState;
use crate::settings::Settings;
use crate::touchable::{MovedPart, Part};

/// Memory for the changes of one recording, at most; a brick counts as if nobody shared it.
pub const MAX_TAPE_BYTES: usize = 1 << 29;

/// A swap with a brick of its own, whose counters fill a cache line.
const SWAP_BYTES: usize = size_of::<PartSwap>() + 2 * size_of::<BitBrick>();
const SHARE_BYTES: usize = size_of::<ShareSwap>() + size_of::<ShareBrick>();

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
    Feel(u8, Feel),
    /// What gave way from then on.
    GiveWay(GivingWay),
    /// A needle was taken in the hand, or out of it.
    Needle(bool, Box<Tissues>),
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
    /// Where it is hard although it gives way.
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
    /// What became known of shares, in the same order.
    pub shares: Vec<ShareSwap>,
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
    /// What the servo will touch once it has obeyed all that was noted.
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
            + entry.shares.len() * SHARE_BYTES;
        if self.bytes > max_bytes {
            self.is_full = true;
        } else {
            self.entries.push(entry);
        }
    }

    fn entry(&mut self, command: &ServoCommand) -> TapeEntry {
        let (mut swaps, mut shares) = (Vec::new(), Vec::new());
        let command = match command {
            ServoCommand::Root {
                sequence,
                touchable,
            } => {
                for part in &touchable.parts {
                    swaps.extend(changed_bricks(&self.latest, part));
                    shares.extend(changed_shares(&self.latest, part));
                }
                self.latest.clone_from(&touchable.parts);
                TapeCommand::Root {
                    sequence: *sequence,
                    parts: touchable.parts.iter().map(TapePart::from).collect(),
                }
            }
            ServoCommand::Bricks(change) => {
                swaps.clone_from(&change.parts);
                shares.clone_from(&change.part_shares);
                put(&mut self.latest, &swaps);
                put_shares(&mut self.latest, &shares);
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
            ServoCommand::GiveWay(giving_way) => TapeCommand::GiveWay(*giving_way),
            ServoCommand::Needle(on, tissues) => TapeCommand::Needle(*on, tissues.clone()),
            ServoCommand::Mark => TapeCommand::Mark,
        };
        TapeEntry {
            command,
            swaps,
            shares,
        }
    }
}

/// Puts bricks in the place of those that are there.
pub fn put(parts: &mut [Part], swaps: &[PartSwap]) {
    for (id, swap) in swaps {
        if let Ok(place) = place_of(parts, *id) {
            parts[place].bits.swap(&mut swap.clone());
        }
    }
}

/// Puts what is known of shares in the place of what was.
pub fn put_shares(parts: &mut [Part], swaps: &[ShareSwap]) {
    for (id, swap) in swaps {
        if let Ok(place) = place_of(parts, *id) {
            let part = &mut parts[place];
            let unknown = || Arc::new(Shares::unknown(part.bits.dimensions()));
            let shares = part.shares.get_or_insert_with(unknown);
            Arc::make_mut(shares).swap(&mut swap.clone());
        }
    }
}

/// Parts as a new root has them: those that stay keep their voxels, new ones have none yet.
#[must_use]
pub fn rooted(old: &[Part], new: &[TapePart], values: &ScanValues) -> Vec<Part> {
    let part = |part: &TapePart| {
        let id = SegmentId(part.id);
        let own = part.own_grid.as_ref().map(Grid::dimensions);
        let dimensions = own.unwrap_or(values.dimensions());
        let bits = match place_of(old, id) {
            Ok(place) if old[place].bits.dimensions() == dimensions => old[place].bits.clone(),
            _ => Bits::empty(dimensions),
        };
        let known = place_of(old, id)
            .ok()
            .and_then(|place| old[place].shares.clone());
        let is_mask = part.threshold.is_none();
        let shares = known.filter(|known| is_mask && known.dimensions() == dimensions);
        let moved = part.moved.map(|(min, max, pose)| MovedPart {
            own_grid: part.own_grid,
            bounds: VoxelBox::new(min, max),
            pose,
        });
        Part {
            id,
            bits,
            moved,
            threshold: part.threshold.map(|range| Threshold {
                range,
                values: values.clone(),
            }),
            shares,
            punctured: part.punctured,
            rigid: mask_of(&part.rigid, dimensions),
        }
    };
    new.iter().map(part).collect()
}

fn place_of(parts: &[Part], id: SegmentId) -> Result<usize, usize> {
    parts.binary_search_by_key(&id.0, |part| part.id.0)
}

/// The bricks of a part that hold other voxels than before.
fn changed_bricks(old: &[Part], new: &Part) -> Vec<PartSwap> {
    let old = place_of(old, new.id).ok().map(|place| &old[place].bits);
    let old = old.filter(|bits| bits.dimensions() == new.bits.dimensions());
    let before = |index| old.and_then(|bits| bits.bricks().get(index));
    (0..)
        .zip(new.bits.bricks().entries())
        .filter(|(index, brick)| !is_same(before(*index), brick.as_ref()))
        .map(|(index, brick)| {
            let brick = brick.clone();
            (new.id, BrickSwap { index, brick })
        })
        .collect()
}

/// The same of shares.
fn changed_shares(old: &[Part], new: &Part) -> Vec<ShareSwap> {
    let old = place_of(old, new.id).ok().map(|place| &old[place]);
    let old = old.and_then(|old| old.shares.as_ref());
    let old = old.filter(|old| old.dimensions() == new.bits.dimensions());
    let Some(shares) = &new.shares else {
        return Vec::new();
    };
    if old.is_some_and(|old| Arc::ptr_eq(old, shares)) {
        return Vec::new();
    }
    let before = |index| old.and_then(|shares| shares.bricks().get(index));
    (0..)
        .zip(shares.bricks().entries())
        .filter(|(index, brick)| !is_same(before(*index), brick.as_ref()))
        .map(|(index, brick)| {
            let brick = brick.clone();
            (new.id, BrickSwap { index, brick })
        })
        .collect()
}

fn is_same<B: PartialEq>(old: Option<&Arc<B>>, new: Option<&Arc<B>>) -> bool {
    match (old, new) {
        (Some(old), Some(new)) => Arc::ptr_eq(old, new) || old == new,
        (old, new) => old.is_none() && new.is_none(),
    }
}
