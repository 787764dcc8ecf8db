//! The thesis' collision test: samples of a straight move, one voxel length apart.
//!
//! What lies between two samples is not seen: of a ray through a chord of length c < 1 in
//! solid voxels a share 1 − c passes unnoticed, 35 % of those head-on through the thinnest
//! wall (1, 1, 0). Two points that the text leaves open are read in its favour: the end
//! point is sampled too, and the collision point is the exact entry into the solid between
//! the last free sample and the first solid one.
//!
//! Frame: grid, lengths in voxels. Source: R. Vlasov, thesis (2016), 4.2. `exact` uses the
//! traversal of `first_solid.rs` instead.

use glam::{DVec3, IVec3};
use palpate_volume::first_solid::{Outcome, first_solid_bounded};
use palpate_volume::occupancy::Occupancy;

/// Most voxels that finding the entry reads: a move of one voxel length passes 4, and 2 are
/// for rounding.
pub(crate) const ENTRY_VISITS: u32 = 6;

/// A collision that samples found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SampledHit {
    /// Way from the start to the collision point.
    pub distance: f64,
    /// Way to the last sample that was free; 0 where it is the start, which is not tested.
    pub last_free: f64,
    /// The solid voxel that is entered.
    pub voxel: IVec3,
}

/// Samples from `start` along the unit vector `direction`, as far as `length` or the first
/// sample beyond `reach`. Gives the collision and the voxels read.
pub(crate) fn sample_ray(
    occupancy: &(impl Occupancy + ?Sized),
    start: DVec3,
    direction: DVec3,
    length: f64,
    reach: f64,
) -> (Option<SampledHit>, u32) {
    let mut visits = 0;
    let mut last_free = 0.0;
    loop {
        let distance = f64::min(last_free + 1.0, length);
        let sample = start + direction * distance;
        visits += 1;
        if occupancy.is_solid(sample.floor().as_ivec3()) {
            let from = start + direction * last_free;
            let (share, voxel, entry_visits) = entry(occupancy, from, sample);
            let hit = SampledHit {
                distance: last_free + share * (distance - last_free),
                last_free,
                voxel,
            };
            return (Some(hit), visits + entry_visits);
        }
        if distance >= length || distance >= reach {
            return (None, visits);
        }
        last_free = distance;
    }
}

/// Where a move that ends in a solid voxel first enters one: its share, the voxel, visits.
fn entry(occupancy: &(impl Occupancy + ?Sized), from: DVec3, to: DVec3) -> (f64, IVec3, u32) {
    let traversal = first_solid_bounded(occupancy, from, to, ENTRY_VISITS);
    match traversal.outcome {
        Outcome::Hit(hit) => (hit.fraction, hit.voxel, traversal.visits),
        // only rounding at the end point gets here
        _ => (0.0, to.floor().as_ivec3(), traversal.visits),
    }
}
