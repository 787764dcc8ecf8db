//! Journal entries as bytes, all numbers little-endian.
//!
//! An edit holds, for each brick, the exclusive or of what was and what is, so that most of
//! it is zeros for LZ4 to squeeze, and a checksum of what was: replayed on other voxels, it
//! is refused. A brick of the overlay that is gone is said to be gone; where there was none,
//! the scan's own values stand for it.
//!
//! ```text
//! edit     action u8, kind u8, checksum u32,
//!          segments u32 × (id u8, bricks u32 × (place u32, bits 8 × u64)),
//!          values u32 × (place u32, exists u8, 512 × u16 where it exists)
//! put      action u8, id u8, bricks u32 × (place u32, bits 8 × u64)
//! put own  action u8, id u8, grid, bricks u32 × (place u32, bits 8 × u64)
//! grid     dimensions 3 × u32, spacing 3 × f64, patient from grid 12 × f64 by columns
//! remove   action u8, id u8
//! move     action u8, id u8, goes on u8, pose 12 × f64 by columns
//! facts    id u8, touchable u8, range, made by: 2 × (exists u8, 2 × f64),
//!          feel 3 × (exists u8, f64), pose (exists u8, 12 × f64), since version 3: locked u8
//! together changes u32
//! note     bytes of the caller
//! end      nothing
//! ```
//!
//! Source of LZ4: Collet, "LZ4 block format description" (2019), here by the crate lz4_flex.

use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

use crate::journal::entry::{Action, Entry, Facts, Written};

mod bytes;
mod edits;

use bytes::{Reader, number_of, push_affine, push_bits, push_count, push_numbers};
use edits::{dirty_of, edit_bytes, edit_of};

const EDIT: u8 = 1;
const PUT: u8 = 2;
const REMOVE: u8 = 3;
const NOTE: u8 = 4;
const STEP_END: u8 = 5;
// since version 2
const PUT_OWN: u8 = 6;
const MOVE: u8 = 7;
const FACTS: u8 = 8;
const TOGETHER: u8 = 9;

const UNKNOWN_KIND: Wrong = "a kind of record that this version does not know";

/// LZ4 makes at most so many bytes of one.
const MOST_EXPANSION: usize = 255;

/// A record: its kind and what it holds.
pub(crate) type Record = (u8, Vec<u8>);

/// What cannot be, in words.
type Wrong = &'static str;

/// Writes an entry about voxels over `scan`.
pub(crate) fn encode(entry: &Written, scan: &Intensities) -> Record {
    match entry {
        Written::Edit(action, delta) => (EDIT, pack(&edit_bytes(*action, delta, scan))),
        Written::Put(action, id, segment) => {
            let kind = segment.own_grid().map_or(PUT, |_| PUT_OWN);
            (kind, pack(&put_bytes(*action, *id, segment)))
        }
        Written::Remove(action, id) => (REMOVE, vec![number_of(*action), id.0]),
        Written::Move(action, id, pose, goes_on) => {
            let mut bytes = vec![number_of(*action), id.0, u8::from(*goes_on)];
            push_affine(&mut bytes, pose);
            (MOVE, bytes)
        }
        Written::Facts(id, facts) => (FACTS, facts_bytes(*id, facts)),
        Written::Together(count) => (TOGETHER, count.to_le_bytes().to_vec()),
        Written::Note(bytes) => (NOTE, bytes.clone()),
        Written::StepEnd => (STEP_END, Vec::new()),
    }
}

/// Reads an entry that follows on these voxels; what is wrong with it where it cannot be.
pub(crate) fn decode(kind: u8, bytes: &[u8], voxels: &Voxels) -> Result<Entry, Wrong> {
    match kind {
        EDIT => edit_of(&unpack(bytes)?, voxels),
        PUT => put_of(&unpack(bytes)?, Some(voxels.grid())),
        PUT_OWN => put_of(&unpack(bytes)?, None),
        MOVE => move_of(bytes),
        FACTS => facts_of(bytes),
        TOGETHER => {
            let mut reader = Reader(bytes);
            let count = reader.number()?;
            reader.end()?;
            Ok(Entry::Together(count))
        }
        REMOVE => {
            let mut reader = Reader(bytes);
            Ok(Entry::Remove(reader.action()?, SegmentId(reader.byte()?)))
        }
        NOTE => Ok(Entry::Note(bytes.to_vec())),
        STEP_END => Ok(Entry::StepEnd),
        _ => Err(UNKNOWN_KIND),
    }
}

/// What a record counts for where steps are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Counted {
    /// A note.
    Nothing,
    /// Something changed.
    Change(Action),
    /// So many of the next changes belong together.
    Together(u32),
    /// What changed since the last end is one step.
    StepEnd,
}

/// What a record counts for; it is not looked into further.
pub(crate) fn counted(kind: u8, bytes: &[u8]) -> Result<Counted, Wrong> {
    match kind {
        EDIT | PUT | PUT_OWN => Reader(&unpack(bytes)?).action().map(Counted::Change),
        REMOVE => Reader(bytes).action().map(Counted::Change),
        MOVE => Ok(match move_of(bytes)? {
            Entry::Move {
                action,
                goes_on: false,
                ..
            } => Counted::Change(action),
            _ => Counted::Nothing,
        }),
        TOGETHER => Reader(bytes).number().map(Counted::Together),
        NOTE | FACTS => Ok(Counted::Nothing),
        STEP_END => Ok(Counted::StepEnd),
        _ => Err(UNKNOWN_KIND),
    }
}

fn pack(bytes: &[u8]) -> Vec<u8> {
    lz4_flex::block::compress_prepend_size(bytes)
}

fn unpack(bytes: &[u8]) -> Result<Vec<u8>, Wrong> {
    let size = Reader(bytes).count()?;
    // memory is taken only for what so many bytes can hold
    if size > bytes.len().saturating_mul(MOST_EXPANSION) {
        return Err("more unpacked bytes than it can hold");
    }
    lz4_flex::block::decompress_size_prepended(bytes).map_err(|_| "bytes that LZ4 cannot unpack")
}

fn put_bytes(action: Action, id: SegmentId, segment: &Segment) -> Vec<u8> {
    let bricks = segment.occupancy().bricks().entries();
    let mut bytes = vec![number_of(action), id.0];
    if let Some(grid) = segment.own_grid() {
        let dimensions = grid.dimensions().to_array();
        bytes.extend(dimensions.iter().flat_map(|n| n.to_le_bytes()));
        push_numbers(&mut bytes, &grid.spacing().to_array());
        push_affine(&mut bytes, &grid.patient_from_grid());
    }
    push_count(&mut bytes, bricks.iter().flatten().count());
    for (index, brick) in bricks.iter().enumerate() {
        if let Some(brick) = brick {
            push_bits(&mut bytes, index as u32, brick);
        }
    }
    bytes
}

/// A segment on the grid of the scan, or where none is given on the one that is written.
fn put_of(bytes: &[u8], scan: Option<&Grid>) -> Result<Entry, Wrong> {
    let mut reader = Reader(bytes);
    let (action, id) = (reader.action()?, reader.segment()?);
    let own = match scan {
        Some(_) => None,
        None => Some(reader.grid()?),
    };
    let grid = scan.or(own.as_ref()).ok_or("a segment without a grid")?;
    let mut segment = Segment::empty(grid.dimensions());
    for _ in 0..reader.count()? {
        let (index, bits) = reader.bits()?;
        dirty_of(grid, index, &bits)?;
        let brick = bits.shared();
        segment.swap(&mut [BrickSwap { index, brick }]);
    }
    reader.end()?;
    let segment = match own {
        Some(grid) => segment.on_grid(grid),
        None => segment,
    };
    Ok(Entry::Put(action, id, segment))
}

fn move_of(bytes: &[u8]) -> Result<Entry, Wrong> {
    let mut reader = Reader(bytes);
    let entry = Entry::Move {
        action: reader.action()?,
        id: reader.segment()?,
        goes_on: reader.flag()?,
        pose: reader.affine()?,
    };
    reader.end()?;
    Ok(entry)
}

fn facts_bytes(id: SegmentId, facts: &Facts) -> Vec<u8> {
    let mut bytes = vec![id.0, u8::from(facts.touchable)];
    for range in [facts.range, facts.made_by] {
        bytes.push(u8::from(range.is_some()));
        let (low, high) = range.unwrap_or_default();
        push_numbers(&mut bytes, &[low, high]);
    }
    for number in facts.feel {
        bytes.push(u8::from(number.is_some()));
        push_numbers(&mut bytes, &[number.unwrap_or_default()]);
    }
    bytes.push(u8::from(facts.pose.is_some()));
    push_affine(&mut bytes, &facts.pose.unwrap_or_default());
    bytes.push(u8::from(facts.locked));
    bytes
}

fn facts_of(bytes: &[u8]) -> Result<Entry, Wrong> {
    let mut reader = Reader(bytes);
    let (id, touchable) = (reader.segment()?, reader.flag()?);
    let mut range = || {
        let exists = reader.flag()?;
        let range = (reader.limit()?, reader.limit()?);
        Ok(exists.then_some(range))
    };
    let (range, made_by) = (range()?, range()?);
    let mut feel = [None; 3];
    for number in &mut feel {
        let exists = reader.flag()?;
        let given = reader.float()?;
        *number = exists.then_some(given);
    }
    let exists = reader.flag()?;
    let pose = reader.affine()?;
    let has_more = !reader.0.is_empty();
    let locked = has_more && reader.flag()?;
    reader.end()?;
    let facts = Facts {
        touchable,
        range,
        made_by,
        feel,
        pose: exists.then_some(pose),
        locked,
    };
    Ok(Entry::Facts(id, facts))
}
