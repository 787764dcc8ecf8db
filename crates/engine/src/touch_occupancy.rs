//! What the servo touches, and the changes of it that the probe's position does not admit yet.
//!
//! A change is admitted only where the probe stays free, or can be pushed to a free voxel along
//! free voxels. Else it is held, as a whole, and tried again each tick, until it is admitted or
//! newer changes of the same bricks have taken its place. So the probe can leave through what is
//! to be solid. Nothing here allocates or frees: bricks change places, and what is replaced goes
//! to the garbage ring. Source: design, section 5.

use glam::IVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::block::block_of_bricks;
use palpate_volume::brick_grid::{BRICK, BrickSwap};
use palpate_volume::occupancy::Occupancy;
use rtrb::Producer;

use crate::handover::{BrickChange, Garbage, MAX_BRICKS, MAX_HELD};

/// Garbage that one change can make: what every held change has in common with it, and itself.
const GARBAGE_PER_CHANGE: usize = MAX_BRICKS * (MAX_HELD + 1) + MAX_HELD + 3;

/// Decides whether the probe admits a change, and pushes it where it must.
pub trait Admit {
    /// Whether the probe is free in `new`, if need be after a push through voxels free in `old`.
    fn admit<N: Occupancy>(&mut self, old: &Bits, new: &N) -> bool;

    /// Where the probe is.
    fn voxel(&self) -> IVec3;
}

/// A root that is not admitted yet.
#[derive(Debug)]
struct HeldRoot {
    first: u64,
    last: u64,
    bits: Bits,
}

/// The occupancy and what is held back.
#[derive(Debug)]
pub struct TouchOccupancy {
    bits: Bits,
    held_root: Option<HeldRoot>,
    held: Vec<BrickChange>,
    garbage: Producer<Garbage>,
    /// Where the probe was when all that is held was last refused; none since a change.
    refused_at: Option<IVec3>,
    skipped: u64,
}

impl TouchOccupancy {
    /// An occupancy at the start.
    #[must_use]
    pub fn new(bits: Bits, garbage: Producer<Garbage>) -> Self {
        Self {
            bits,
            held_root: None,
            held: Vec::with_capacity(MAX_HELD),
            garbage,
            refused_at: None,
            skipped: 0,
        }
    }

    /// What is solid now.
    #[must_use]
    pub fn bits(&self) -> &Bits {
        &self.bits
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

    /// Tries all that is held again, where the probe or the occupancy has moved since. There
    /// must be room for it.
    pub fn retry(&mut self, probe: &mut impl Admit) {
        let nothing_new = self.refused_at == Some(probe.voxel());
        if !self.holds_back() || nothing_new {
            return;
        }
        self.retry_root(probe);
        let mut place = 0;
        while place < self.held.len() {
            if self.admits(&self.held[place], probe) {
                // another takes its place
                let change = self.held.swap_remove(place);
                self.put_bricks(change);
            } else {
                place += 1;
            }
        }
        self.refused_at = Some(probe.voxel());
    }

    /// Takes a new root; whatever was held is overtaken by it.
    pub fn take_root(&mut self, sequence: u64, bits: Bits, probe: &mut impl Admit) {
        let first = self.first_held().unwrap_or(sequence);
        self.forget_held_edits();
        let overtaken = self.held_root.take();
        if let Some(held) = overtaken {
            self.dispose(Garbage::Root(held.bits));
        }
        // what is held is something else now
        self.refused_at = None;
        if probe.admit(&self.bits, &bits) {
            self.put_root(bits);
        } else {
            self.held_root = Some(HeldRoot {
                first,
                last: sequence,
                bits,
            });
        }
    }

    /// Takes the bricks of one edit, all or none.
    pub fn take_bricks(&mut self, change: BrickChange, probe: &mut impl Admit) {
        self.follow_in_held_root(&change);
        self.follow_in_held_edits(&change);
        if self.admits(&change, probe) {
            self.put_bricks(change);
        } else if self.held.len() < MAX_HELD {
            self.held.push(change);
        } else {
            self.skipped += 1;
            self.dispose(Garbage::Bricks(change));
        }
    }

    /// The oldest change that is held back.
    fn first_held(&self) -> Option<u64> {
        let edits = self.held.iter().map(|change| change.sequence);
        edits
            .chain(self.held_root.as_ref().map(|held| held.first))
            .min()
    }

    fn retry_root(&mut self, probe: &mut impl Admit) {
        let Some(held) = self.held_root.take() else {
            return;
        };
        if probe.admit(&self.bits, &held.bits) {
            self.put_root(held.bits);
            // the root has followed every edit that came after it
            self.forget_held_edits();
        } else {
            self.held_root = Some(held);
        }
    }

    fn admits(&self, change: &BrickChange, probe: &mut impl Admit) -> bool {
        let new = Patched {
            base: &self.bits,
            swaps: &change.swaps,
        };
        probe.admit(&self.bits, &new)
    }

    /// A root held back must not bring back what a newer edit changes.
    fn follow_in_held_root(&mut self, change: &BrickChange) {
        let Some(held) = &mut self.held_root else {
            return;
        };
        for swap in &change.swaps {
            let mut newer = swap.clone();
            held.bits.swap(&mut newer);
            dispose(&mut self.garbage, Garbage::Brick(newer));
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
        }
        // what is held may have become something else
        self.refused_at = None;
    }

    fn forget_held_edits(&mut self) {
        while let Some(change) = self.held.pop() {
            self.dispose(Garbage::Bricks(change));
        }
    }

    fn put_root(&mut self, bits: Bits) {
        self.refused_at = None;
        let old = std::mem::replace(&mut self.bits, bits);
        self.dispose(Garbage::Root(old));
    }

    fn put_bricks(&mut self, mut change: BrickChange) {
        self.refused_at = None;
        for swap in &mut change.swaps {
            self.bits.swap(swap);
        }
        self.dispose(Garbage::Bricks(change));
    }

    fn dispose(&mut self, garbage: Garbage) {
        dispose(&mut self.garbage, garbage);
    }
}

fn dispose(ring: &mut Producer<Garbage>, garbage: Garbage) {
    let disposed = ring.push(garbage);
    debug_assert!(disposed.is_ok(), "room was made sure of");
}

/// An occupancy as it would be with some bricks exchanged.
struct Patched<'a> {
    base: &'a Bits,
    /// By rising index.
    swaps: &'a [BrickSwap<BitBrick>],
}

impl Patched<'_> {
    /// The brick that holds a voxel, by its first voxel or any other.
    #[inline]
    fn brick(&self, voxel: IVec3) -> &BitBrick {
        let dimensions = self.base.dimensions().as_ivec3();
        if voxel.cmplt(IVec3::ZERO).any() || voxel.cmpge(dimensions).any() {
            return &BitBrick::EMPTY;
        }
        let index = brick_index(self.base, voxel);
        let brick = match place_of(self.swaps, index).and_then(|place| self.swaps.get(place)) {
            Some(swap) => swap.brick.as_deref(),
            None => self.base.bricks().at(voxel),
        };
        brick.unwrap_or(&BitBrick::EMPTY)
    }
}

impl Occupancy for Patched<'_> {
    #[inline]
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.brick(voxel).contains(voxel)
    }

    // dilated by a ball, a patch is read in blocks
    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        block_of_bricks(min, |corner| self.brick(corner))
    }
}

/// Where the brick of this index is among swaps by rising index.
fn place_of(swaps: &[BrickSwap<BitBrick>], index: u32) -> Option<usize> {
    swaps.binary_search_by_key(&index, |swap| swap.index).ok()
}

/// Place in the directory of the brick that holds a voxel of the grid.
fn brick_index(bits: &Bits, voxel: IVec3) -> u32 {
    let size = bits.bricks().size();
    let brick = (voxel / BRICK).as_uvec3();
    (brick.z * size.y + brick.y) * size.x + brick.x
}
