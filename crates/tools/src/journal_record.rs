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
//!          feel 3 × (exists u8, f64), pose (exists u8, 12 × f64)
//! together changes u32
//! note     bytes of the caller
//! end      nothing
//! ```
//!
//! Source of LZ4: Collet, "LZ4 block format description" (2019), here by the crate lz4_flex.

use glam::{DAffine3, DVec3, UVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::{Edit, EditKind, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::intensity_brick::IntensityBrick;
use palpate_volume::overlay::Overlay;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use crate::journal_entry::{Action, Delta, Entry, Facts, Written};

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

/// Voxels of a segment with a grid of its own, at most: no file can ask for more memory.
const MOST_OWN_VOXELS: u64 = 1 << 33;

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

fn edit_bytes(action: Action, delta: &Delta, scan: &Intensities) -> Vec<u8> {
    let unedited = Overlay::empty(scan.dimensions());
    let values = |brick: Option<&IntensityBrick>, index| {
        brick
            .cloned()
            .unwrap_or_else(|| unedited.brick(scan, index))
    };
    let mut before = crc32fast::Hasher::new();
    let mut body = Vec::new();

    push_count(&mut body, delta.segments.len());
    for (id, bricks) in &delta.segments {
        body.push(id.0);
        push_count(&mut body, bricks.len());
        for brick in bricks {
            let [old, new] =
                [&brick.old, &brick.new].map(|brick| brick.as_deref().copied().unwrap_or_default());
            before.update(&words_as_bytes(&old.0));
            push_bits(&mut body, brick.index, &exclusive_or(&old, &new));
        }
    }
    push_count(&mut body, delta.intensities.len());
    for brick in &delta.intensities {
        let old = values(brick.old.as_deref(), brick.index);
        before.update(&values_as_bytes(&old.0));
        body.extend(brick.index.to_le_bytes());
        body.push(u8::from(brick.new.is_some()));
        if let Some(new) = &brick.new {
            body.extend(values_as_bytes(&differences(&old, new).0));
        }
    }

    let mut bytes = vec![number_of(action), u8::from(delta.kind == EditKind::Matter)];
    bytes.extend(before.finalize().to_le_bytes());
    bytes.extend(body);
    bytes
}

fn edit_of(bytes: &[u8], voxels: &Voxels) -> Result<Entry, Wrong> {
    let mut reader = Reader(bytes);
    let action = reader.action()?;
    let kind = match reader.byte()? {
        0 => EditKind::Label,
        1 => EditKind::Matter,
        _ => return Err("neither a label nor a matter edit"),
    };
    let checksum = reader.number()?;
    let mut before = crc32fast::Hasher::new();
    let mut edit = Edit::empty(kind);

    for _ in 0..reader.count()? {
        let id = SegmentId(reader.byte()?);
        let segment = voxels.segment(id).ok_or("a segment that does not exist")?;
        let bricks = segment.occupancy().bricks();
        let mut swaps = Vec::new();
        for _ in 0..reader.count()? {
            let (index, differs) = reader.bits()?;
            let old = bricks.get(index).map_or(BitBrick::EMPTY, |brick| **brick);
            before.update(&words_as_bytes(&old.0));
            let new = exclusive_or(&old, &differs);
            let dirty = dirty_of(segment.grid(voxels.grid()), index, &differs)?;
            edit.dirty = edit.dirty.union(&dirty);
            let brick = new.shared();
            swaps.push(BrickSwap { index, brick });
        }
        edit.segments.push((id, swaps));
    }
    for _ in 0..reader.count()? {
        let index = reader.number()?;
        let exists = reader.byte()? != 0;
        part_of(voxels.grid(), index)?;
        let old = voxels.overlay().brick(voxels.intensities(), index);
        before.update(&values_as_bytes(&old.0));
        let new = if exists {
            Some(differences(&old, &reader.values()?))
        } else {
            None
        };
        let shown = match &new {
            Some(new) => new.clone(),
            None => Overlay::empty(voxels.grid().dimensions()).brick(voxels.intensities(), index),
        };
        let dirty = dirty_of(voxels.grid(), index, &where_different(&old, &shown))?;
        edit.dirty = edit.dirty.union(&dirty);
        let brick = new.map(Into::into);
        edit.intensities.push(BrickSwap { index, brick });
    }

    if before.finalize() != checksum {
        return Err("it follows on other voxels");
    }
    if kind == EditKind::Label && !edit.intensities.is_empty() {
        return Err("a label edit of intensities");
    }
    reader.end()?;
    Ok(Entry::Edit(action, edit))
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
    reader.end()?;
    let facts = Facts {
        touchable,
        range,
        made_by,
        feel,
        pose: exists.then_some(pose),
    };
    Ok(Entry::Facts(id, facts))
}

/// The part of a brick inside the grid.
fn part_of(grid: &Grid, index: u32) -> Result<VoxelBox, Wrong> {
    let bricks = grid.dimensions().map(|n| n.div_ceil(8));
    let all = u64::from(bricks.x) * u64::from(bricks.y) * u64::from(bricks.z);
    if u64::from(index) >= all {
        return Err("a brick beyond the scan");
    }
    let row = index / bricks.x;
    let place = glam::UVec3::new(index % bricks.x, row % bricks.y, row / bricks.y);
    let min = 8 * place.as_ivec3();
    Ok(VoxelBox::new(min, min + 8).intersect(&grid.bounds()))
}

/// The smallest box of the voxels whose bit is set; all must be inside the grid.
fn dirty_of(grid: &Grid, index: u32, bits: &BitBrick) -> Result<VoxelBox, Wrong> {
    let part = part_of(grid, index)?;
    let dirty = bits.difference(&BitBrick::EMPTY);
    if dirty.is_empty() {
        return Ok(dirty);
    }
    let dirty = VoxelBox::new(dirty.min + part.min, dirty.max + part.min);
    if !part.contains_box(&dirty) {
        return Err("voxels beyond the scan");
    }
    Ok(dirty)
}

fn where_different(a: &IntensityBrick, b: &IntensityBrick) -> BitBrick {
    BitBrick::from_fn(glam::UVec3::splat(8), |voxel| {
        a.stored(voxel) != b.stored(voxel)
    })
}

fn exclusive_or(a: &BitBrick, b: &BitBrick) -> BitBrick {
    BitBrick(std::array::from_fn(|z| a.0[z] ^ b.0[z]))
}

fn differences(a: &IntensityBrick, b: &IntensityBrick) -> IntensityBrick {
    IntensityBrick(std::array::from_fn(|place| a.0[place] ^ b.0[place]))
}

fn words_as_bytes(words: &[u64; 8]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn values_as_bytes(values: &[i16; 512]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

fn push_count(bytes: &mut Vec<u8>, count: usize) {
    // bricks of a scan are fewer than its voxels, and those fit
    bytes.extend((count as u32).to_le_bytes());
}

fn push_numbers(bytes: &mut Vec<u8>, numbers: &[f64]) {
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
}

fn push_affine(bytes: &mut Vec<u8>, affine: &DAffine3) {
    push_numbers(bytes, &affine.to_cols_array());
}

fn push_bits(bytes: &mut Vec<u8>, index: u32, bits: &BitBrick) {
    bytes.extend(index.to_le_bytes());
    bytes.extend(words_as_bytes(&bits.0));
}

fn number_of(action: Action) -> u8 {
    match action {
        Action::Do => 0,
        Action::Undo => 1,
        Action::Redo => 2,
        Action::Start => 3,
    }
}

/// What is left to read.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Wrong> {
        let (taken, left) = self.0.split_first_chunk().ok_or("it ends too early")?;
        self.0 = left;
        Ok(*taken)
    }

    fn byte(&mut self) -> Result<u8, Wrong> {
        Ok(self.take::<1>()?[0])
    }

    fn number(&mut self) -> Result<u32, Wrong> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn count(&mut self) -> Result<usize, Wrong> {
        Ok(self.number()? as usize)
    }

    fn action(&mut self) -> Result<Action, Wrong> {
        match self.byte()? {
            0 => Ok(Action::Do),
            1 => Ok(Action::Undo),
            2 => Ok(Action::Redo),
            3 => Ok(Action::Start),
            _ => Err("neither there, done, undone nor redone"),
        }
    }

    fn segment(&mut self) -> Result<SegmentId, Wrong> {
        match self.byte()? {
            0 => Err("segment 0, which stands for none"),
            id => Ok(SegmentId(id)),
        }
    }

    fn flag(&mut self) -> Result<bool, Wrong> {
        match self.byte()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err("neither yes nor no"),
        }
    }

    fn float(&mut self) -> Result<f64, Wrong> {
        let number = f64::from_le_bytes(self.take()?);
        number.is_finite().then_some(number).ok_or("no number")
    }

    /// A number that may be without end.
    fn limit(&mut self) -> Result<f64, Wrong> {
        let number = f64::from_le_bytes(self.take()?);
        (!number.is_nan()).then_some(number).ok_or("no number")
    }

    fn affine(&mut self) -> Result<DAffine3, Wrong> {
        let mut columns = [0.0; 12];
        for number in &mut columns {
            *number = self.float()?;
        }
        Ok(DAffine3::from_cols_array(&columns))
    }

    fn grid(&mut self) -> Result<Grid, Wrong> {
        let dimensions = UVec3::new(self.number()?, self.number()?, self.number()?);
        if u64::from(dimensions.x) * u64::from(dimensions.y) > MOST_OWN_VOXELS
            || dimensions.as_u64vec3().element_product() > MOST_OWN_VOXELS
        {
            return Err("more voxels than a segment of its own may have");
        }
        let spacing = DVec3::new(self.float()?, self.float()?, self.float()?);
        let patient_from_grid = self.affine()?;
        Grid::from_affine(dimensions, spacing, patient_from_grid).map_err(|_| "a grid that is none")
    }

    fn bits(&mut self) -> Result<(u32, BitBrick), Wrong> {
        let index = self.number()?;
        let mut brick = BitBrick::EMPTY;
        for word in &mut brick.0 {
            *word = u64::from_le_bytes(self.take()?);
        }
        Ok((index, brick))
    }

    fn values(&mut self) -> Result<IntensityBrick, Wrong> {
        let mut brick = IntensityBrick::ZERO;
        for value in &mut brick.0 {
            *value = i16::from_le_bytes(self.take()?);
        }
        Ok(brick)
    }

    fn end(&self) -> Result<(), Wrong> {
        self.0
            .is_empty()
            .then_some(())
            .ok_or("more bytes than it needs")
    }
}
