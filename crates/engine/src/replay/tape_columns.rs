//! A tape as columns of plain numbers, as files hold it.
//!
//! State and commands are MessagePack with named fields, numbers to the bit; bricks are a place in
//! the directory and eight words each, no solid voxel where there is no brick; values of the scan
//! are a place and 512 numbers each. What comes from a file is checked before anything is made of
//! it.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use palpate_haptics::ball::{BallError, BallShape};
use palpate_haptics::scene::{MAX_OBJECTS, ObjectPose, PoseError};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::{BRICK, BrickSwap};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensity_brick::IntensityBrick;
use palpate_volume::occupancy_fractions::FractionBrick;
use palpate_volume::voxel_box::VoxelBox;
use serde::{Deserialize, Serialize};

use crate::replay::tape::{
    PartSwap, Tape, TapeCommand, TapeEntry, TapePart, put, put_fractions, rooted,
};
use crate::servo::ServoState;
use crate::touch::{FractionSwap, MAX_BRICKS, ScanValues, Settings, SettingsError, check_radius};

/// Most voxels of a scan in a file; more are not read, so that no file can ask for all memory.
pub const MAX_FILE_VOXELS: u64 = 1 << 33;

/// Names the build that computes; see `build.rs` of this crate.
pub const BUILD: &str = env!("PALPATE_BUILD");

/// A tape by columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TapeColumns {
    /// Grid and state, MessagePack.
    pub start: Vec<u8>,
    /// All commands, MessagePack, one after the other.
    pub commands: Vec<u8>,
    /// Where each command ends in `commands`.
    pub command_ends: Vec<u64>,
    /// Where the bricks of each command end in `bricks`.
    pub brick_ends: Vec<u64>,
    /// Bricks of all commands.
    pub bricks: BrickColumns,
    /// Bricks that were solid at the start.
    pub solid: BrickColumns,
    /// The scan's values that touch read.
    pub values: ValueColumns,
    /// Where the occupancy fractions of each command end in `fractions`.
    pub fraction_ends: Vec<u64>,
    /// What became known of occupancy fractions by all commands.
    pub fractions: FractionColumns,
    /// What was known of occupancy fractions at the start.
    pub known: FractionColumns,
}

/// Bricks of occupancy fractions by columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FractionColumns {
    /// Number of the segment.
    pub segment: Vec<u8>,
    /// Place in the directory, x fastest.
    pub index: Vec<u32>,
    /// A byte for each voxel, x fastest; all 0 where nothing is known.
    pub bytes: Vec<[u8; 512]>,
}

/// Bricks of stored values by columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ValueColumns {
    /// Place in the directory, x fastest, rising.
    pub index: Vec<u32>,
    /// Stored values, x fastest.
    pub stored: Vec<[i16; 512]>,
}

/// Bricks by columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BrickColumns {
    /// Number of the segment.
    pub segment: Vec<u8>,
    /// Place in the directory, x fastest.
    pub index: Vec<u32>,
    /// Voxels: one word per z, bit = 8 · y + x.
    pub words: Vec<[u64; 8]>,
}

/// Why columns are no tape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TapeError {
    /// The state cannot be read.
    #[error("the state at the start cannot be read ({0})")]
    Start(String),
    /// A command cannot be read.
    #[error("command {number} cannot be read ({reason})")]
    Command {
        /// Which one, from 0.
        number: usize,
        /// Why.
        reason: String,
    },
    /// Settings that no session has.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Columns of different length, or ends that do not rise.
    #[error("its columns do not fit together")]
    Lengths,
    /// Too many bricks at once, or not by rising place.
    #[error("its bricks are out of order")]
    Bricks,
    /// A pose that is no rigid motion.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// Segments out of order, or more moved ones than there can be.
    #[error("its segments are out of order")]
    Parts,
    /// A threshold that makes no segment.
    #[error("it has a threshold from {low} to {high}; allowed: numbers, low <= high")]
    Threshold {
        /// Its lower end.
        low: f64,
        /// Its upper end.
        high: f64,
    },
    /// Values that mean nothing.
    #[error(
        "its values have slope {slope} and intercept {intercept}; allowed: finite, slope not 0"
    )]
    Rescale {
        /// Physical units per stored unit.
        slope: f64,
        /// Physical value of stored 0.
        intercept: f64,
    },
    /// No such probe fits these voxels.
    #[error(transparent)]
    Ball(#[from] BallError),
    /// Voxels beyond the border of the scan.
    #[error("it has voxels outside of its scan")]
    Outside,
    /// More voxels than are read.
    #[error("its scan has {given} voxels; allowed: at most {MAX_FILE_VOXELS}")]
    TooLarge {
        /// Voxels of the scan.
        given: u64,
    },
}

/// What stands in front of the commands.
#[derive(Serialize, Deserialize)]
struct Start {
    grid: Grid,
    state: ServoState,
    parts: Vec<TapePart>,
    /// Slope and intercept of the scan's values.
    rescale: (f64, f64),
    is_full: bool,
}

impl From<&Tape> for TapeColumns {
    fn from(tape: &Tape) -> Self {
        let mut columns = Self {
            start: packed(&Start {
                grid: tape.grid,
                state: tape.state,
                parts: tape.parts.iter().map(TapePart::from).collect(),
                rescale: tape.values.rescale(),
                is_full: tape.is_full,
            }),
            ..Self::default()
        };
        for part in &tape.parts {
            for (index, brick) in (0..).zip(part.bits.bricks().entries()) {
                if let Some(brick) = brick {
                    columns.solid.push(part.id, index, **brick);
                }
            }
            let known = part
                .fractions
                .iter()
                .flat_map(|fractions| fractions.bricks().entries());
            for (index, brick) in (0..).zip(known) {
                if brick.is_some() {
                    columns.known.push(part.id, index, brick.as_deref());
                }
            }
        }
        for (index, brick) in tape.values.read_bricks() {
            columns.values.index.push(index);
            columns.values.stored.push(brick.0);
        }
        for entry in &tape.entries {
            columns.commands.extend(packed(&entry.command));
            columns.command_ends.push(columns.commands.len() as u64);
            for (id, swap) in &entry.swaps {
                let brick = swap.brick.as_deref().copied();
                columns
                    .bricks
                    .push(*id, swap.index, brick.unwrap_or_default());
            }
            columns.brick_ends.push(columns.bricks.index.len() as u64);
            for (id, swap) in &entry.fractions {
                columns
                    .fractions
                    .push(*id, swap.index, swap.brick.as_deref());
            }
            columns
                .fraction_ends
                .push(columns.fractions.index.len() as u64);
        }
        columns
    }
}

impl TryFrom<&TapeColumns> for Tape {
    type Error = TapeError;

    fn try_from(columns: &TapeColumns) -> Result<Self, TapeError> {
        let start: Start = rmp_serde::from_slice(&columns.start)
            .map_err(|error| TapeError::Start(error.to_string()))?;
        let Start {
            grid,
            state,
            parts,
            rescale,
            is_full,
        } = start;
        let given = grid.voxel_count() as u64;
        if given > MAX_FILE_VOXELS {
            return Err(TapeError::TooLarge { given });
        }
        check_settings(&state.settings, &grid)?;
        BallShape::new(state.radius, grid.spacing())?;
        check_parts(&parts, &grid)?;

        let mut frames = Frames::new(&grid, &parts);
        let values = columns.values.scan_values(rescale, &frames.scan)?;
        let mut parts = rooted(&[], &parts, &values);
        let solid = columns.solid.swaps(0..columns.solid.index.len(), &frames)?;
        put(&mut parts, &solid);
        let known = columns.known.swaps(0..columns.known.index.len(), &frames)?;
        put_fractions(&mut parts, &known);
        let entries = columns.entries(&mut frames, &grid)?;
        Ok(Self {
            grid,
            state,
            parts,
            values,
            entries,
            is_full,
        })
    }
}

impl TapeColumns {
    /// The commands for a servo that touches voxels of these frames to begin with.
    fn entries(&self, frames: &mut Frames, grid: &Grid) -> Result<Vec<TapeEntry>, TapeError> {
        if self.command_ends.len() != self.brick_ends.len() {
            return Err(TapeError::Lengths);
        }
        let commands = ranges(&self.command_ends, self.commands.len())?;
        let bricks = ranges(&self.brick_ends, self.bricks.index.len())?;
        let mut fractions = self.fraction_ranges()?.into_iter();
        let mut entries = Vec::with_capacity(commands.len());
        for (number, (bytes, bricks)) in commands.into_iter().zip(bricks).enumerate() {
            let command: TapeCommand =
                rmp_serde::from_slice(&self.commands[bytes]).map_err(|error| {
                    let reason = error.to_string();
                    TapeError::Command { number, reason }
                })?;
            let fractions = fractions.next().unwrap_or_default();
            check(&command, bricks.len().max(fractions.len()), grid)?;
            if let TapeCommand::Root { parts, .. } = &command {
                frames.follow(parts);
            }
            entries.push(TapeEntry {
                command,
                swaps: self.bricks.swaps(bricks, frames)?,
                fractions: self.fractions.swaps(fractions, frames)?,
            });
        }
        Ok(entries)
    }

    /// The occupancy fractions of each command; tapes of before there were any have no ends of
    /// them.
    fn fraction_ranges(&self) -> Result<Vec<Range<usize>>, TapeError> {
        if self.fraction_ends.len() != self.command_ends.len() && !self.fraction_ends.is_empty() {
            return Err(TapeError::Lengths);
        }
        ranges(&self.fraction_ends, self.fractions.index.len())
    }
}

impl ValueColumns {
    /// The values for a grid of the size of `bits`.
    fn scan_values(&self, rescale: (f64, f64), bits: &Bits) -> Result<ScanValues, TapeError> {
        let (slope, intercept) = rescale;
        if !(slope.is_finite() && slope != 0.0 && intercept.is_finite()) {
            return Err(TapeError::Rescale { slope, intercept });
        }
        if self.index.len() != self.stored.len() {
            return Err(TapeError::Lengths);
        }
        let in_order = self.index.is_sorted_by(|before, after| before < after);
        let count = bits.bricks().len();
        if !in_order
            || self
                .index
                .last()
                .is_some_and(|&last| last as usize >= count)
        {
            return Err(TapeError::Bricks);
        }
        let bricks = self.index.iter().zip(&self.stored);
        let bricks = bricks.map(|(&index, stored)| (index, Arc::new(IntensityBrick(*stored))));
        Ok(ScanValues::of_bricks(bits.dimensions(), rescale, bricks))
    }
}

impl FractionColumns {
    fn push(&mut self, id: SegmentId, index: u32, brick: Option<&FractionBrick>) {
        self.segment.push(id.0);
        self.index.push(index);
        self.bytes.push(brick.unwrap_or(&FractionBrick::UNKNOWN).0);
    }

    /// Some of the bricks, checked against the grids that they stand on.
    fn swaps(&self, range: Range<usize>, frames: &Frames) -> Result<Vec<FractionSwap>, TapeError> {
        let count = self.index.len();
        if self.bytes.len() != count || self.segment.len() != count {
            return Err(TapeError::Lengths);
        }
        let places = places(&self.segment, &self.index, range.clone(), frames)?;
        let bricks = places.into_iter().zip(&self.bytes[range]);
        let swap = |((id, index), &bytes): ((u8, u32), &[u8; 512])| {
            let brick = FractionBrick(bytes);
            let brick = (brick != FractionBrick::UNKNOWN).then(|| Arc::new(brick));
            (SegmentId(id), BrickSwap { index, brick })
        };
        Ok(bricks.map(swap).collect())
    }
}

/// Places of some bricks, strictly rising, so that each is there once.
fn places(
    segment: &[u8],
    index: &[u32],
    range: Range<usize>,
    frames: &Frames,
) -> Result<Vec<(u8, u32)>, TapeError> {
    let index = &index[range.clone()];
    let segment = &segment[range];
    let places: Vec<(u8, u32)> = segment.iter().copied().zip(index.iter().copied()).collect();
    let in_order = places.is_sorted_by(|before, after| before < after);
    let within = places
        .iter()
        .all(|&(id, index)| (index as usize) < frames.of(id).bricks().len());
    if in_order && within {
        Ok(places)
    } else {
        Err(TapeError::Bricks)
    }
}

impl BrickColumns {
    fn push(&mut self, id: SegmentId, index: u32, brick: BitBrick) {
        self.segment.push(id.0);
        self.index.push(index);
        self.words.push(brick.0);
    }

    /// Some of the bricks, checked against the grids that they stand on.
    fn swaps(&self, range: Range<usize>, frames: &Frames) -> Result<Vec<PartSwap>, TapeError> {
        let count = self.index.len();
        if self.words.len() != count || self.segment.len() != count {
            return Err(TapeError::Lengths);
        }
        let places = places(&self.segment, &self.index, range.clone(), frames)?;
        let bricks = places.into_iter().zip(&self.words[range]);
        bricks
            .map(|((id, index), &words)| {
                let brick = swap(index, BitBrick(words), frames.of(id))?;
                Ok((SegmentId(id), brick))
            })
            .collect()
    }
}

/// Voxels of the size of the grids that segments stand on.
struct Frames {
    scan: Bits,
    /// Of segments with a grid of their own, by number.
    own: BTreeMap<u8, Bits>,
}

impl Frames {
    fn new(grid: &Grid, parts: &[TapePart]) -> Self {
        let mut frames = Self {
            scan: Bits::empty(grid.dimensions()),
            own: BTreeMap::new(),
        };
        frames.follow(parts);
        frames
    }

    /// Takes the grids of a new root.
    fn follow(&mut self, parts: &[TapePart]) {
        for part in parts {
            match &part.own_grid {
                Some(grid) => self.own.insert(part.id, Bits::empty(grid.dimensions())),
                None => self.own.remove(&part.id),
            };
        }
    }

    fn of(&self, id: u8) -> &Bits {
        self.own.get(&id).unwrap_or(&self.scan)
    }
}

/// A brick to put in its place; none of its voxels may be beyond the border.
fn swap(index: u32, brick: BitBrick, bits: &Bits) -> Result<BrickSwap<BitBrick>, TapeError> {
    let voxels = bits.bricks().box_of(index);
    let inside = voxels.intersect(&VoxelBox::of_dimensions(bits.dimensions()));
    let size = (inside.max - inside.min).as_uvec3();
    if size.min_element() < BRICK as u32 {
        let allowed = BitBrick::filled(size);
        if (0..8).any(|z| brick.0[z] & !allowed.0[z] != 0) {
            return Err(TapeError::Outside);
        }
    }
    Ok(BrickSwap {
        index,
        brick: brick.shared(),
    })
}

/// Refuses settings that no session has on such a grid.
fn check_settings(settings: &Settings, grid: &Grid) -> Result<(), TapeError> {
    settings.check()?;
    check_radius(settings.probe_radius, grid)?;
    Ok(())
}

/// Refuses segments that are not by rising number, too many moved ones and poses that are none.
fn check_parts(parts: &[TapePart], grid: &Grid) -> Result<(), TapeError> {
    let in_order = parts.is_sorted_by(|before, after| before.id < after.id);
    let moved = parts.iter().filter(|part| part.moved.is_some()).count();
    if !in_order || moved > MAX_OBJECTS || parts.iter().any(|part| part.id == 0) {
        return Err(TapeError::Parts);
    }
    for (low, high) in parts.iter().filter_map(|part| part.threshold) {
        // an end that limits nothing is infinite
        if low.is_nan() || high.is_nan() || low > high {
            return Err(TapeError::Threshold { low, high });
        }
    }
    for part in parts {
        let own = part.own_grid.as_ref();
        match part.moved {
            Some((_, _, pose)) => drop(ObjectPose::new(own.unwrap_or(grid), grid, pose)?),
            None if own.is_some() => return Err(TapeError::Parts),
            None => {}
        }
        let given = own.map_or(0, |own| own.voxel_count() as u64);
        if given > MAX_FILE_VOXELS {
            return Err(TapeError::TooLarge { given });
        }
    }
    Ok(())
}

/// Refuses a command that no simulation sends.
fn check(command: &TapeCommand, bricks: usize, grid: &Grid) -> Result<(), TapeError> {
    let allowed = match command {
        TapeCommand::Root { parts, .. } => {
            check_parts(parts, grid)?;
            usize::MAX
        }
        TapeCommand::Bricks { .. } => MAX_BRICKS,
        TapeCommand::Settings(settings) => {
            check_settings(settings, grid)?;
            0
        }
        TapeCommand::Pose(_, pose) => {
            ObjectPose::new(grid, grid, *pose)?;
            0
        }
        TapeCommand::Feel(_, feel) => {
            feel.check()?;
            0
        }
        TapeCommand::Place { .. }
        | TapeCommand::Turn(_)
        | TapeCommand::Clutch(_)
        // whatever is no spring is not followed
        | TapeCommand::DeformableContact(_)
        // and no direction is that of the push
        | TapeCommand::NeedleDirection(_)
        | TapeCommand::Needle(..)
        | TapeCommand::Mark => 0,
    };
    if bricks > allowed {
        return Err(TapeError::Bricks);
    }
    Ok(())
}

/// The ranges between rising ends, the last of which is `length`.
fn ranges(ends: &[u64], length: usize) -> Result<Vec<std::ops::Range<usize>>, TapeError> {
    let last = ends.last().copied().unwrap_or(0);
    if !ends.is_sorted() || last != length as u64 {
        return Err(TapeError::Lengths);
    }
    let starts = std::iter::once(0).chain(ends.iter().copied());
    let pairs = starts.zip(ends.iter().copied());
    Ok(pairs
        .map(|(start, end)| start as usize..end as usize)
        .collect())
}

fn packed(value: &impl Serialize) -> Vec<u8> {
    rmp_serde::to_vec_named(value).expect("numbers and names can be written")
}
