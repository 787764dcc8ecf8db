//! What the servo touches, and the changes of it that the probe's position does not admit yet.
//!
//! A change is admitted only where the probe stays free, or can be pushed to a free voxel along
//! free voxels. Else it is held, as a whole, and tried again, one change per tick, until it is
//! admitted or newer changes of the same bricks have taken its place. So the probe can leave
//! through what is to be solid. Nothing here allocates or frees: bricks change places, and what is
//! replaced goes to the garbage ring. Source: design, section 5.

use arrayvec::ArrayVec;
use glam::{DAffine3, IVec3};
use palpate_haptics::admission::{Admission, PoseStep};
use palpate_haptics::ball::{Ball, MAX_BODIES, ProbeView, admit_radius};
use palpate_haptics::contact::Proxy;
use palpate_haptics::scene::{MAX_OBJECTS, ObjectPose, TouchScene};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;
use rtrb::Producer;

use crate::touch::moved_poses::MovedPoses;
use crate::touch::occupancy_change::{BrickChange, Garbage, MAX_BRICKS, MAX_FRACTIONS, MAX_HELD};
use crate::touch::patched::{Patched, place_of};
use crate::touch::probe::Probe;
use crate::touch::touchable::{Body, Touchable};

/// Garbage that one change can make: what every held change has in common with it, in the union,
/// in the parts and in fractions, and itself.
pub const GARBAGE_PER_CHANGE: usize =
    (2 * MAX_BRICKS + MAX_FRACTIONS) * (MAX_HELD + 1) + MAX_HELD + 3;

/// A root that is not admitted yet.
#[derive(Debug)]
struct HeldRoot {
    first: u64,
    last: u64,
    touchable: Box<Touchable>,
}

/// The occupancy and what is held back.
#[derive(Debug)]
pub struct TouchOccupancy {
    touchable: Touchable,
    held_root: Option<HeldRoot>,
    held: Vec<BrickChange>,
    /// That the probe is to have [mm]; what is touched has the one that it has.
    wanted_radius: f64,
    /// Work out what changes would make of what is solid.
    spares: Box<[Ball; MAX_BODIES]>,
    garbage: Producer<Garbage>,
    /// Where the probe was when changes were last refused; none since anything changed.
    refused_at: Option<IVec3>,
    /// How many of them were not tried there yet.
    untried: usize,
    /// Which of them was tried last.
    turn: usize,
    skipped: u64,
    version: u64,
}

impl TouchOccupancy {
    /// An occupancy at the start.
    #[must_use]
    pub fn new(touchable: Touchable, garbage: Producer<Garbage>) -> Self {
        let shape = touchable.world.shape();
        let spares = Box::new(std::array::from_fn(|_| Ball::new(*shape)));
        Self {
            wanted_radius: touchable.radius,
            spares,
            touchable,
            held_root: None,
            held: Vec::with_capacity(MAX_HELD),
            garbage,
            refused_at: None,
            untried: 0,
            turn: 0,
            skipped: 0,
            version: 1,
        }
    }

    /// What is solid now.
    #[must_use]
    pub fn touchable(&self) -> &Touchable {
        &self.touchable
    }

    /// Changes with whatever is touched.
    #[must_use]
    pub fn version(&self) -> u64 {
        self.version
    }

    /// What is touched, as a tick wants it.
    #[must_use]
    pub fn scene<'a>(&'a self, grid: &'a Grid) -> TouchScene<'a, Body> {
        self.touchable.scene(grid)
    }

    /// First and last number of the changes in a root held back; zeros where there is none.
    #[must_use]
    pub fn held_root(&self) -> (u64, u64) {
        self.held_root
            .as_ref()
            .map_or((0, 0), |held| (held.first, held.last))
    }

    /// Numbers of the edits held back, then zeros.
    #[must_use]
    pub fn held_edits(&self) -> [u64; MAX_HELD] {
        let mut numbers = [0; MAX_HELD];
        for (number, change) in numbers.iter_mut().zip(&self.held) {
            *number = change.sequence;
        }
        numbers
    }

    /// Edits that were not even held, since too many are; a new root has to bring them.
    #[must_use]
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Whether any change is held back.
    #[must_use]
    pub fn holds_back(&self) -> bool {
        self.held_root.is_some() || !self.held.is_empty()
    }

    /// Whether the garbage ring has room for whatever a new change replaces; without it no
    /// change is taken.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.garbage.slots() >= GARBAGE_PER_CHANGE
    }

    /// Tries one of the changes held back again, each in its turn, until all were refused where
    /// the probe and all else stands. There must be room for it.
    ///
    /// One per tick bounds the work; a change that could be admitted waits for as many ticks as
    /// changes are held at most.
    pub fn retry(&mut self, probe: &mut Probe<'_>) {
        let has_root = self.held_root.is_some();
        let grows = self.wanted_radius != self.touchable.radius;
        let count = self.held.len() + usize::from(has_root) + usize::from(grows);
        if self.refused_at != Some(probe.voxel()) {
            self.refused_at = Some(probe.voxel());
            self.untried = count;
        }
        if count == 0 || self.untried == 0 {
            return;
        }
        self.untried -= 1;
        self.turn = (self.turn + 1) % count;
        // after the edits comes the root, then the radius
        match self.turn.checked_sub(self.held.len()) {
            None => self.retry_edit(self.turn, probe),
            Some(0) if has_root => self.retry_root(probe),
            Some(_) => self.step_radius(probe),
        }
    }

    /// Wants a radius of the probe [mm]; it comes there step by step, as far as there is room.
    pub fn want_radius(&mut self, radius: f64) {
        if self.wanted_radius != radius {
            self.begin_turns();
            self.wanted_radius = radius;
            self.refused_at = None;
        }
    }

    /// Takes a new root; whatever was held is overtaken by it.
    pub fn take_root(
        &mut self,
        sequence: u64,
        mut touchable: Box<Touchable>,
        probe: &mut Probe<'_>,
    ) {
        let first = self.first_held().unwrap_or(sequence);
        self.forget_held_edits();
        let overtaken = self.held_root.take();
        if let Some(held) = overtaken {
            self.dispose(Garbage::Root(held.touchable));
        }
        // what is held is something else now
        self.refused_at = None;
        if self.admits_root(&mut touchable, probe) {
            self.put_root(touchable);
        } else {
            self.begin_turns();
            self.held_root = Some(HeldRoot {
                first,
                last: sequence,
                touchable,
            });
        }
    }

    /// Takes the bricks of one edit, all or none.
    pub fn take_bricks(&mut self, change: BrickChange, probe: &mut Probe<'_>) {
        self.follow_in_held_root(&change);
        self.follow_in_held_edits(&change);
        if self.admits(&change, probe) {
            self.put_bricks(change);
        } else if self.held.len() < MAX_HELD {
            self.begin_turns();
            self.held.push(change);
        } else {
            self.skipped += 1;
            self.dispose(Garbage::Bricks(change));
        }
    }

    /// Moves an object by one step, if the probe admits it; it may be pushed.
    pub fn step_pose(&mut self, place: usize, new: &ObjectPose, probe: &mut Probe<'_>) -> PoseStep {
        self.refused_at = None;
        self.touchable
            .step_pose(place, new, probe.grid, probe.proxy)
    }

    /// Takes a step of each segment that moves, as far as the probe admits it. A root held back
    /// follows, so that it is asked for with the segments where they stand. Gives the step of
    /// the touched one, if it took one.
    pub fn step_poses(
        &mut self,
        poses: &mut MovedPoses,
        grid: &Grid,
        (proxy, touched): (&mut Proxy, SegmentId),
    ) -> Option<DAffine3> {
        if !poses.is_moving() {
            return None;
        }
        let carried = poses.step(&mut self.touchable, grid, (proxy, touched));
        if let Some(held) = &mut self.held_root {
            poses.place(&mut held.touchable, grid);
        }
        self.refused_at = None;
        carried
    }

    /// A box that holds the voxels of a moved segment, and the grid of its own if it has one: of
    /// the newest root that has it.
    #[must_use]
    pub fn place_of(&self, id: SegmentId) -> Option<(VoxelBox, Option<&Grid>)> {
        let held = self.held_root.as_ref().map(|held| &*held.touchable);
        let roots = held.into_iter().chain([&self.touchable]);
        let mut places = roots.filter_map(|root| {
            let bounds = root.objects.get(root.object_of(id)?)?.bounds();
            Some((bounds, root.own_grid_of(id)))
        });
        places.next()
    }

    /// The oldest change that is held back.
    fn first_held(&self) -> Option<u64> {
        let edits = self.held.iter().map(|change| change.sequence);
        edits
            .chain(self.held_root.as_ref().map(|held| held.first))
            .min()
    }

    fn retry_root(&mut self, probe: &mut Probe<'_>) {
        let Some(mut held) = self.held_root.take() else {
            return;
        };
        if self.admits_root(&mut held.touchable, probe) {
            self.put_root(held.touchable);
            // the root has followed every edit that came after it
            self.forget_held_edits();
        } else {
            self.held_root = Some(held);
        }
    }

    /// The first change that is held begins the turns anew: what comes out of a tick follows from
    /// what a recording has, and it begins where nothing is held.
    fn begin_turns(&mut self) {
        if !self.holds_back() {
            self.turn = 0;
        }
    }

    /// Takes the next step toward the wanted radius; one that is too large for the voxels is
    /// never reached.
    fn step_radius(&mut self, probe: &mut Probe<'_>) {
        let next = self.touchable.radius_toward(self.wanted_radius);
        let scene = self.touchable.scene(probe.grid);
        match admit_radius(&scene, next, &mut self.spares, probe.proxy) {
            Ok(Admission::Held) | Err(_) => {}
            Ok(_) => self.put_radius(next),
        }
    }

    fn put_radius(&mut self, radius: f64) {
        if self.touchable.set_radius(radius).is_err() {
            // too large for the voxels: the probe stays as it is
            return;
        }
        self.version += 1;
        self.refused_at = None;
    }

    fn retry_edit(&mut self, place: usize, probe: &mut Probe<'_>) {
        // another takes its place
        let change = self.held.swap_remove(place);
        if self.admits(&change, probe) {
            self.put_bricks(change);
            return;
        }
        // back to where it was
        self.held.push(change);
        let last = self.held.len() - 1;
        self.held.swap(place, last);
    }

    /// It was made for the radius that is wanted, which the probe may not have yet; where the probe's is
    /// too large for it, it waits.
    fn admits_root(&self, new: &mut Touchable, probe: &mut Probe<'_>) -> bool {
        let grid = probe.grid;
        new.set_radius(self.touchable.radius).is_ok()
            && probe.admits(&self.touchable.scene(grid), &new.scene(grid))
    }

    fn admits(&mut self, change: &BrickChange, probe: &mut Probe<'_>) -> bool {
        let grid = probe.grid;
        let Touchable { world, objects, .. } = &self.touchable;
        let [spare, ..] = &mut *self.spares;
        let changed = Patched::new(&world.inner().bits, &change.swaps);
        // objects as they are, like what is changed
        let unchanged: ArrayVec<Patched<'_>, MAX_OBJECTS> = objects
            .iter()
            .take(MAX_OBJECTS)
            .map(|object| Patched::new(&object.occupancy().inner().bits, &[]))
            .collect();
        let views: ArrayVec<_, MAX_OBJECTS> = objects
            .iter()
            .zip(&unchanged)
            .map(|(object, same)| {
                let view = ProbeView::new(same, object.occupancy().ball());
                object.with_occupancy(view, object.bounds())
            })
            .collect();
        let new = TouchScene {
            occupancy: &world.among(&changed, spare),
            grid,
            objects: &views,
        };
        probe.admits(&self.touchable.scene(grid), &new)
    }

    /// A root held back must not bring back what a newer edit changes.
    fn follow_in_held_root(&mut self, change: &BrickChange) {
        let Some(held) = &mut self.held_root else {
            return;
        };
        for swap in &change.swaps {
            let mut newer = swap.clone();
            held.touchable.swap_world(&mut newer);
            dispose(&mut self.garbage, Garbage::Brick(newer));
        }
        for (id, swap) in &change.parts {
            let mut newer = swap.clone();
            held.touchable.swap_part(*id, &mut newer);
            dispose(&mut self.garbage, Garbage::Brick(newer));
        }
        for swap in &change.fractions {
            let mut newer = swap.clone();
            held.touchable.swap_fractions(&mut newer);
            dispose(&mut self.garbage, Garbage::Fractions(newer));
        }
    }

    /// Nor must an edit held back.
    fn follow_in_held_edits(&mut self, change: &BrickChange) {
        for held in &mut self.held {
            for swap in &change.swaps {
                if let Some(place) = place_of(&held.swaps, swap.index) {
                    let mut newer = swap.clone();
                    std::mem::swap(&mut held.swaps[place], &mut newer);
                    dispose(&mut self.garbage, Garbage::Brick(newer));
                }
            }
            for (id, swap) in &change.parts {
                let same = |(other, held): &&mut (SegmentId, BrickSwap<BitBrick>)| {
                    other == id && held.index == swap.index
                };
                if let Some((_, held)) = held.parts.iter_mut().find(same) {
                    let mut newer = swap.clone();
                    std::mem::swap(held, &mut newer);
                    dispose(&mut self.garbage, Garbage::Brick(newer));
                }
            }
            for swap in &change.fractions {
                if let Some(place) = place_of(&held.fractions, swap.index) {
                    let mut newer = swap.clone();
                    std::mem::swap(&mut held.fractions[place], &mut newer);
                    dispose(&mut self.garbage, Garbage::Fractions(newer));
                }
            }
        }
        // what is held may have become something else
        self.refused_at = None;
    }

    fn forget_held_edits(&mut self) {
        while let Some(change) = self.held.pop() {
            self.dispose(Garbage::Bricks(change));
        }
    }

    fn put_root(&mut self, mut touchable: Box<Touchable>) {
        self.version += 1;
        self.refused_at = None;
        std::mem::swap(&mut self.touchable, &mut touchable);
        self.dispose(Garbage::Root(touchable));
    }

    fn put_bricks(&mut self, mut change: BrickChange) {
        self.version += 1;
        self.refused_at = None;
        for swap in &mut change.swaps {
            self.touchable.swap_world(swap);
        }
        for (id, swap) in &mut change.parts {
            self.touchable.swap_part(*id, swap);
        }
        for swap in &mut change.fractions {
            self.touchable.swap_fractions(swap);
        }
        self.dispose(Garbage::Bricks(change));
    }

    /// Gives something back to be freed; there must be room.
    pub fn dispose(&mut self, garbage: Garbage) {
        dispose(&mut self.garbage, garbage);
    }
}

fn dispose(ring: &mut Producer<Garbage>, garbage: Garbage) {
    let disposed = ring.push(garbage);
    debug_assert!(disposed.is_ok(), "room was made sure of");
}
