//! First solid voxel along a straight move: the collision test of every contact model.
//!
//! Visits each voxel that the move passes through, in order, from face to face, so
//! that no wall is missed, however thin. Work is bounded by the voxels on the way.
//! Nothing here allocates or panics.
//!
//! Frame: grid; voxel (i, j, k) covers [i, i+1) on each axis; `walk.rs` says what holds on
//! the planes between. Source: Amanatides & Woo, "A fast voxel traversal algorithm for ray
//! tracing", Eurographics (1987). Thesis 4.2 samples every voxel length and can miss.

use std::ops::RangeInclusive;

use glam::{DVec3, IVec3};

use crate::bits::Bits;
use crate::occupancy::Occupancy;
use crate::walk::voxel_of;
pub use crate::walk::{COORDINATE_LIMIT, Face, Walk};

/// Where a move first meets a solid voxel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The solid voxel.
    pub voxel: IVec3,
    /// The voxel before it; the same where the move starts inside.
    pub last_free: IVec3,
    /// Share of the move that is free, 0..=1; 0 where it starts inside.
    pub fraction: f64,
    /// The face of `voxel` that is met, looking at `last_free`; its sign is 0 where the
    /// move starts inside.
    pub face: Face,
}

impl Hit {
    /// Whether the move begins in a solid voxel.
    pub fn starts_inside(&self) -> bool {
        self.face.sign == 0
    }
}

/// How a bounded traversal ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// Every voxel of the move is free, the end point's included.
    Free,
    /// The move meets a solid voxel.
    Hit(Hit),
    /// No visits are left; all voxels visited are free.
    OutOfVisits {
        /// The last voxel visited; it is free.
        voxel: IVec3,
        /// Share of the move that is known to be free: where it leaves `voxel`, 0..=1.
        fraction: f64,
    },
    /// A coordinate is not finite or beyond [`COORDINATE_LIMIT`]; nothing was visited.
    NotTraversable,
}

/// A bounded traversal and its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traversal {
    /// Voxels asked for.
    pub visits: u32,
    /// End of the traversal.
    pub outcome: Outcome,
}

/// Squared lengths of moves whose voxels are looked at together [voxels²]: shorter ones are walked
/// sooner, and around longer ones there is more often something.
const TOGETHER: RangeInclusive<f64> = 4.0..=36.0;

/// Finds the first solid voxel between two points, both ends included.
///
/// A move that cannot be traversed ([`Outcome::NotTraversable`]) is blocked where it starts,
/// so that nothing passes untested.
#[inline]
pub fn first_solid(occupancy: &(impl Occupancy + ?Sized), start: DVec3, end: DVec3) -> Option<Hit> {
    match first_solid_bounded(occupancy, start, end, u32::MAX).outcome {
        Outcome::Free => None,
        Outcome::Hit(hit) => Some(hit),
        // a walk within the limit has fewer than u32::MAX steps
        Outcome::OutOfVisits { .. } | Outcome::NotTraversable => Some(inside(nearest_voxel(start))),
    }
}

/// The first solid voxel among at most `max_visits` voxels, but always one.
#[inline]
pub fn first_solid_bounded(
    occupancy: &(impl Occupancy + ?Sized),
    start: DVec3,
    end: DVec3,
    max_visits: u32,
) -> Traversal {
    occupancy.first_solid(start, end, max_visits)
}

/// The traversal that asks for each voxel.
#[inline]
pub(crate) fn traversed(
    occupancy: &(impl Occupancy + ?Sized),
    start: DVec3,
    end: DVec3,
    max_visits: u32,
) -> Traversal {
    let Some(mut walk) = Walk::new(start, end) else {
        return Traversal {
            visits: 0,
            outcome: Outcome::NotTraversable,
        };
    };
    if occupancy.is_solid(walk.voxel()) {
        return Traversal {
            visits: 1,
            outcome: Outcome::Hit(inside(walk.voxel())),
        };
    }

    let steps = walk.steps_left().min(max_visits.saturating_sub(1));
    for step in 0..steps {
        walk.step();
        if occupancy.is_solid(walk.voxel()) {
            return Traversal {
                visits: step + 2,
                outcome: Outcome::Hit(entered(&walk)),
            };
        }
    }
    let outcome = if walk.steps_left() == 0 {
        Outcome::Free
    } else {
        Outcome::OutOfVisits {
            voxel: walk.voxel(),
            fraction: walk.exit_fraction(),
        }
    };
    Traversal {
        visits: steps + 1,
        outcome,
    }
}

/// A short move whose box of voxels is free: the voxels on its way are among them, and are looked at
/// together. None where it must be walked.
#[inline]
pub(crate) fn free_way(
    bits: &Bits,
    start: DVec3,
    end: DVec3,
    max_visits: u32,
) -> Option<Traversal> {
    // NaN is in no range
    if !TOGETHER.contains(&(end - start).length_squared()) {
        return None;
    }
    together(bits, start, end, max_visits)
}

/// Not put into the loops that ask: those of the shortest moves stay short.
#[inline(never)]
fn together(bits: &Bits, start: DVec3, end: DVec3, max_visits: u32) -> Option<Traversal> {
    let border = bits.dimensions().as_dvec3();
    let inside = |point: DVec3| point.cmpge(DVec3::ZERO).all() && point.cmplt(border).all();
    if !(inside(start) && inside(end)) {
        return None;
    }
    let [first, last] = [voxel_of(start), voxel_of(end)];
    let steps = (last - first).abs().element_sum() as u32;
    let is_free = steps < max_visits && bits.is_free(first.min(last), first.max(last));
    is_free.then_some(Traversal {
        visits: steps + 1,
        outcome: Outcome::Free,
    })
}

fn inside(voxel: IVec3) -> Hit {
    Hit {
        voxel,
        last_free: voxel,
        fraction: 0.0,
        face: Face::default(),
    }
}

fn entered(walk: &Walk) -> Hit {
    let face = walk.face();
    Hit {
        voxel: walk.voxel(),
        last_free: walk.voxel() + face.normal(),
        fraction: walk.fraction(),
        face,
    }
}

/// The voxel of a point, or of the point within the limit nearest to it; 0 for NaN.
fn nearest_voxel(point: DVec3) -> IVec3 {
    let limit = DVec3::splat(COORDINATE_LIMIT);
    // a cast from NaN gives 0
    point.max(-limit).min(limit).floor().as_ivec3()
}
