//! Occupancy fractions of masks, worked out in the background: which are known, which are to be,
//! and the loop that does it, region by region.
//!
//! A change of voxels forgets the occupancy fractions of all voxels that it changed and of those
//! beside them, in the same command that changes the bits; what is around it is worked out again.
//! Until then its voxels count as their bits say. What was worked out is told only when touch
//! follows all changes, and without what has changed since.
//!
//! Frame: the grid of each segment.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::time::Duration;

use glam::{IVec3, Vec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::occupancy_fractions::{FractionBrick, OccupancyFractions};
use palpate_volume::relax::{regions, relaxed_fractions};
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

use crate::scene::{Scene, TouchChange};
use crate::touch::FractionSwap;

/// How far from a change fractions are worked out again [voxels].
const REACH: i32 = 8;
/// Longest side of a region [voxels].
const LONGEST: i32 = 64;

/// A region to be worked out.
#[derive(Debug)]
pub struct FractionJob {
    bits: Bits,
    spacing: Vec3,
    region: VoxelBox,
    known: Arc<OccupancyFractions>,
}

/// What came of it.
pub type FractionAnswer = Vec<BrickSwap<FractionBrick>>;

/// A mask whose occupancy fractions are known, as far as they are.
#[derive(Debug)]
struct Kept {
    bits: Bits,
    fractions: Arc<OccupancyFractions>,
}

/// The region that is worked on.
#[derive(Debug)]
struct Asked {
    id: SegmentId,
    /// What has changed since.
    changed: Vec<VoxelBox>,
}

/// What is known, and the loop's other end.
#[derive(Debug)]
pub struct MaskFractions {
    kept: BTreeMap<SegmentId, Kept>,
    /// Regions to be worked out, the next one first.
    queue: VecDeque<(SegmentId, VoxelBox)>,
    asked: Option<Asked>,
    jobs: Sender<FractionJob>,
    answers: Receiver<FractionAnswer>,
    on: bool,
}

impl MaskFractions {
    /// Nothing is known nor worked out until it is switched on; and the loop that does it.
    #[must_use]
    pub fn new() -> (Self, FractionLoop) {
        let (jobs, job_inbox) = mpsc::channel();
        let (answers, answer_inbox) = mpsc::channel();
        let fractions = Self {
            kept: BTreeMap::new(),
            queue: VecDeque::new(),
            asked: None,
            jobs,
            answers: answer_inbox,
            on: false,
        };
        let fraction_loop = FractionLoop {
            jobs: job_inbox,
            answers,
        };
        (fractions, fraction_loop)
    }

    /// Works fractions out from now on, or not: then masks are touched by their bits alone.
    pub fn switch(&mut self, on: bool) {
        self.on = on;
    }

    /// Regions that are still to be worked out.
    #[must_use]
    pub fn left(&self) -> usize {
        self.queue.len() + usize::from(self.asked.is_some())
    }

    /// Follows a change of what is touched: forgets fractions where voxels changed, and gives what
    /// it forgot.
    pub fn follow(&mut self, scene: &mut Scene, change: &TouchChange) -> Vec<FractionSwap> {
        if !self.on {
            return Vec::new();
        }
        let (bricks, ids) = match change {
            TouchChange::Bricks(bricks, ids) => (Some(&bricks[..]), ids),
            TouchChange::All(ids) => (None, ids),
            TouchChange::Nothing | TouchChange::Pose(..) | TouchChange::FirstPose(..) => {
                return Vec::new();
            }
        };
        let mut forgotten = Vec::new();
        for &id in ids {
            let swaps = self.follow_segment(scene, id, bricks);
            forgotten.extend(swaps.into_iter().map(|swap| (id, swap)));
        }
        forgotten
    }

    /// Follows some bricks of a segment, or all.
    fn follow_segment(
        &mut self,
        scene: &mut Scene,
        id: SegmentId,
        bricks: Option<&[u32]>,
    ) -> Vec<BrickSwap<FractionBrick>> {
        let segment = scene.voxels().segment(id).filter(|_| scene.is_mask(id));
        let Some(bits) = segment.map(Segment::occupancy) else {
            self.forget(id);
            scene.set_fractions(id, None);
            return Vec::new();
        };
        let Some(kept) = self.kept.get_mut(&id).filter(|kept| kept.fits(bits)) else {
            // what nobody touches needs no fractions
            if scene.is_obstacle(id) {
                self.begin(id, bits.clone(), scene);
            }
            return Vec::new();
        };
        let changed = kept.follow(bits, bricks);
        if changed.is_empty() {
            return Vec::new();
        }
        // nobody else has them now, so that they need not be copied
        scene.set_fractions(id, None);
        let forgotten = kept.forget(&changed);
        scene.set_fractions(id, Some(Arc::clone(&kept.fractions)));
        self.want_again(id, &changed);
        forgotten
    }

    /// Takes what was worked out, if anything was, and has the next region worked out; gives what
    /// is known now.
    pub fn advance(&mut self, scene: &mut Scene) -> Vec<FractionSwap> {
        let known = self.take(scene);
        if self.asked.is_none() {
            self.ask(scene);
        }
        known
    }

    fn begin(&mut self, id: SegmentId, bits: Bits, scene: &mut Scene) {
        self.forget(id);
        let fractions = Arc::new(OccupancyFractions::unknown(bits.dimensions()));
        self.queue
            .extend(regions(&bits).into_iter().map(|region| (id, region)));
        scene.set_fractions(id, Some(Arc::clone(&fractions)));
        self.kept.insert(id, Kept { bits, fractions });
    }

    fn forget(&mut self, id: SegmentId) {
        self.kept.remove(&id);
        self.queue.retain(|(other, _)| *other != id);
        if let Some(asked) = &mut self.asked
            && asked.id == id
        {
            // what comes of it is of no use
            asked.changed = vec![EVERYTHING];
        }
    }

    /// Has what is around a change worked out again, before all else.
    fn want_again(&mut self, id: SegmentId, changed: &[VoxelBox]) {
        for changed in changed {
            let region = changed.dilate(REACH);
            let near = self.queue.iter_mut().find(|(other, wanted)| {
                let both = wanted.union(&region);
                *other == id && both.size().as_ivec3().max_element() <= LONGEST
            });
            match near {
                Some((_, wanted)) => *wanted = wanted.union(&region),
                None => self.queue.push_front((id, region)),
            }
        }
        if let Some(asked) = &mut self.asked
            && asked.id == id
        {
            asked.changed.extend_from_slice(changed);
        }
    }

    fn take(&mut self, scene: &mut Scene) -> Vec<FractionSwap> {
        let Ok(mut answer) = self.answers.try_recv() else {
            return Vec::new();
        };
        let Some(asked) = self.asked.take() else {
            return Vec::new();
        };
        let Some(kept) = self.kept.get_mut(&asked.id) else {
            return Vec::new();
        };
        if asked.changed.contains(&EVERYTHING) {
            return Vec::new();
        }
        for swap in &mut answer {
            let all = kept.fractions.bricks().box_of(swap.index);
            for changed in &asked.changed {
                forget_in(swap, &all.intersect(&changed.dilate(1)));
            }
        }
        scene.set_fractions(asked.id, None);
        let fractions = Arc::make_mut(&mut kept.fractions);
        for swap in &answer {
            fractions.swap(&mut swap.clone());
        }
        scene.set_fractions(asked.id, Some(Arc::clone(&kept.fractions)));
        answer.into_iter().map(|swap| (asked.id, swap)).collect()
    }

    fn ask(&mut self, scene: &Scene) {
        let Some((id, region)) = self.queue.pop_front() else {
            return;
        };
        let Some(kept) = self.kept.get(&id) else {
            return;
        };
        let job = FractionJob {
            bits: kept.bits.clone(),
            spacing: scene.voxels().grid_of(id).spacing().as_vec3(),
            region,
            known: Arc::clone(&kept.fractions),
        };
        if self.jobs.send(job).is_ok() {
            let changed = Vec::new();
            self.asked = Some(Asked { id, changed });
        }
    }
}

impl Kept {
    fn fits(&self, bits: &Bits) -> bool {
        self.bits.dimensions() == bits.dimensions()
    }

    /// Follows some bricks, or all; gives a box for each that holds the voxels that changed.
    fn follow(&mut self, new: &Bits, bricks: Option<&[u32]>) -> Vec<VoxelBox> {
        let all = 0..self.bits.bricks().len() as u32;
        let changed = |index: &u32| {
            self.changed_box(new, *index)
                .map(|changed| (*index, changed))
        };
        let changed: Vec<_> = match bricks {
            Some(bricks) => bricks.iter().filter_map(changed).collect(),
            None => all.filter_map(|index| changed(&index)).collect(),
        };
        for &(index, _) in &changed {
            let brick = new.bricks().get(index).cloned();
            self.bits.swap(&mut BrickSwap { index, brick });
        }
        changed.into_iter().map(|(_, changed)| changed).collect()
    }

    fn changed_box(&self, new: &Bits, index: u32) -> Option<VoxelBox> {
        let [old, new] = [&self.bits, new].map(|bits| bits.bricks().get(index));
        if old.map(Arc::as_ptr) == new.map(Arc::as_ptr) {
            return None;
        }
        let [old, new] = [old, new].map(|brick| brick.map_or(BitBrick::EMPTY, |brick| **brick));
        let difference = old.difference(&new);
        let first = self.bits.bricks().box_of(index).min;
        let changed = VoxelBox::new(difference.min + first, difference.max + first);
        (!difference.is_empty()).then_some(changed)
    }

    /// Forgets the occupancy fractions of the voxels of some boxes and of those beside them.
    fn forget(&mut self, changed: &[VoxelBox]) -> Vec<BrickSwap<FractionBrick>> {
        let mut forgotten: BTreeMap<u32, BrickSwap<FractionBrick>> = BTreeMap::new();
        for changed in changed {
            let near = changed.dilate(1);
            for index in self.fractions.bricks().indices_in(&near) {
                let Some(brick) = self.fractions.bricks().get(index) else {
                    continue;
                };
                let brick = Some(Arc::clone(brick));
                let swap = forgotten.entry(index).or_insert(BrickSwap { index, brick });
                forget_in(
                    swap,
                    &self.fractions.bricks().box_of(index).intersect(&near),
                );
            }
        }
        if !forgotten.is_empty() {
            let fractions = Arc::make_mut(&mut self.fractions);
            for swap in forgotten.values() {
                fractions.swap(&mut swap.clone());
            }
        }
        forgotten.into_values().collect()
    }
}

/// A change of all there is.
const EVERYTHING: VoxelBox = VoxelBox::new(IVec3::MIN, IVec3::MAX);

/// Forgets the occupancy fractions of some voxels of a brick.
fn forget_in(swap: &mut BrickSwap<FractionBrick>, voxels: &VoxelBox) {
    if let Some(brick) = &mut swap.brick
        && !voxels.is_empty()
    {
        let brick = Arc::make_mut(brick);
        voxels.voxels().for_each(|voxel| brick.set(voxel, 0));
    }
}

/// Jobs on one side, answers on the other.
#[derive(Debug)]
pub struct FractionLoop {
    jobs: Receiver<FractionJob>,
    answers: Sender<FractionAnswer>,
}

impl FractionLoop {
    /// Does what is asked for, if anything is.
    pub fn step(&self) {
        if let Ok(job) = self.jobs.try_recv() {
            self.answer(&job);
        }
    }

    /// Waits for a job, at most so long, and does it; false once none will come any more.
    #[must_use]
    pub fn wait(&self, patience: Duration) -> bool {
        match self.jobs.recv_timeout(patience) {
            Ok(job) => self.answer(&job),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        true
    }

    fn answer(&self, job: &FractionJob) {
        let answer = relaxed_fractions(&job.bits, job.spacing, &job.region, &job.known);
        // whoever asked may have gone
        let _ = self.answers.send(answer);
    }
}
