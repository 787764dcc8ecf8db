//! What a journal on disk says: one change of the voxels after the other.

use std::sync::Arc;

use glam::DAffine3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::{BrickGrid, BrickSwap};
use palpate_volume::edit::{Edit, EditKind, SegmentId};
use palpate_volume::intensity_brick::IntensityBrick;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

/// Which scan a journal belongs to: a hash of its values that the caller chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScanHash(pub [u8; 32]);

/// Why something changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// State when the journal began; not a step.
    Start,
    /// Done by the user. Entries up to the next [`Entry::StepEnd`] are one step.
    Do,
    /// A step was taken back; each entry is a whole step.
    Undo,
    /// A step was done again; each entry is a whole step.
    Redo,
}

/// What is known of a segment beside its voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Facts {
    /// Whether it is an obstacle.
    pub touchable: bool,
    /// The threshold that it is, low and high; none where its voxels come from elsewhere.
    pub range: Option<(f64, f64)>,
    /// The threshold that made it, whatever edits did since.
    pub made_by: Option<(f64, f64)>,
    /// How it feels: stiffness [N/mm], static and kinetic friction; none is as the settings say.
    pub feel: [Option<f64>; 3],
    /// Pose of a moved segment [mm, scene from scan]; none where it was not moved.
    pub pose: Option<DAffine3>,
    /// Whether its voxels are locked.
    pub locked: bool,
}

/// One entry as it is read.
#[derive(Clone, Debug)]
pub enum Entry {
    /// Bricks changed.
    Edit(Action, Edit),
    /// A segment was added, or all of its voxels replaced.
    Put(Action, SegmentId, Segment),
    /// A segment was removed.
    Remove(Action, SegmentId),
    /// A segment was moved [mm, from the scan to the scene].
    Move {
        /// Why.
        action: Action,
        /// Which segment.
        id: SegmentId,
        /// Where to; nobody has checked yet that it is a rigid motion.
        pose: DAffine3,
        /// Whether it continues the move before: both are one step.
        goes_on: bool,
    },
    /// What is known of a segment from here on; no step.
    Facts(SegmentId, Facts),
    /// So many of the next changes belong together: all of them, or none.
    Together(u32),
    /// What the caller keeps beside voxels, such as names.
    Note(Vec<u8>),
    /// What was done since the last end is one step.
    StepEnd,
}

/// One entry as it is written: bricks are shared, nothing is copied.
#[derive(Clone, Debug)]
pub(crate) enum Written {
    Edit(Action, Delta),
    Put(Action, SegmentId, Segment),
    Remove(Action, SegmentId),
    Move(Action, SegmentId, DAffine3, bool),
    Facts(SegmentId, Facts),
    Together(u32),
    Note(Vec<u8>),
    StepEnd,
}

/// Bricks before and after an edit.
#[derive(Clone, Debug)]
pub(crate) struct Delta {
    pub(crate) kind: EditKind,
    pub(crate) segments: Vec<(SegmentId, Vec<Changed<BitBrick>>)>,
    pub(crate) intensities: Vec<Changed<IntensityBrick>>,
}

/// One brick before and after.
#[derive(Clone, Debug)]
pub(crate) struct Changed<B> {
    pub(crate) index: u32,
    pub(crate) old: Option<Arc<B>>,
    pub(crate) new: Option<Arc<B>>,
}

impl Delta {
    /// What an edit changed, by its inverse and the voxels that it was applied to.
    pub(crate) fn of_applied(inverse: &Edit, voxels: &Voxels) -> Self {
        let of_segment = |(id, swaps): &(SegmentId, Vec<BrickSwap<BitBrick>>)| {
            let segment = voxels.segment(*id)?;
            Some((*id, changed(swaps, segment.occupancy().bricks())))
        };
        Self {
            kind: inverse.kind,
            segments: inverse.segments.iter().filter_map(of_segment).collect(),
            intensities: changed(&inverse.intensities, voxels.overlay().bricks()),
        }
    }
}

/// What voxels are when their journal begins: each segment, and the overlay if there is one.
pub(crate) fn start_of(voxels: &Voxels) -> Vec<Written> {
    let put =
        |(id, segment): (SegmentId, &Segment)| Written::Put(Action::Start, id, segment.clone());
    let mut entries: Vec<_> = voxels.segments().map(put).collect();
    let bricks = voxels.overlay().bricks();
    let there = |(index, brick): (usize, &Option<Arc<IntensityBrick>>)| {
        brick.as_ref().map(|brick| Changed {
            index: index as u32,
            old: None,
            new: Some(Arc::clone(brick)),
        })
    };
    let intensities: Vec<_> = bricks
        .entries()
        .iter()
        .enumerate()
        .filter_map(there)
        .collect();
    if !intensities.is_empty() {
        let delta = Delta {
            kind: EditKind::Voxel,
            segments: Vec::new(),
            intensities,
        };
        entries.push(Written::Edit(Action::Start, delta));
    }
    entries
}

fn changed<B>(old: &[BrickSwap<B>], now: &BrickGrid<B>) -> Vec<Changed<B>> {
    let changed = |swap: &BrickSwap<B>| Changed {
        index: swap.index,
        old: swap.brick.clone(),
        new: now.get(swap.index).cloned(),
    };
    old.iter().map(changed).collect()
}
