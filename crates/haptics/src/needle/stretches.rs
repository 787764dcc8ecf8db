//! What a straight move meets, stretch by stretch, in all grids at once: that of the scan, and those
//! of the bodies that were moved, each walked voxel by voxel in its own frame.
//!
//! Fractions of the move are the same in every grid, since poses are affine. Where bodies overlap
//! they count together, by the rule of segments in one grid: what is hard before all else, else all
//! tissues at once. Closed: bounded by the voxels that whoever walks allows.
//!
//! Frame: grid of the scan.

use arrayvec::ArrayVec;
use glam::{DAffine3, DVec3};
use palpate_volume::walk::Walk;

use super::tissues::{Met, TissueMap, World};
use crate::scene::MAX_OBJECTS;

/// The scan and all bodies.
const MAX_BODIES: usize = MAX_OBJECTS + 1;

/// A part of the move in which nothing changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Share of the move before it, 0..=1.
    pub begin: f64,
    /// Share of the move until its end, 0..=1.
    pub end: f64,
    /// What stands there.
    pub met: Met,
}

/// The move in one of the grids.
#[derive(Debug)]
struct Way {
    body: usize,
    walk: Walk,
    met: Met,
}

/// The stretches of a move, from one to the next.
#[derive(Debug)]
pub struct Stretches<'a, M> {
    world: &'a World<'a, M>,
    ways: ArrayVec<Way, MAX_BODIES>,
}

impl<'a, M: TissueMap> Stretches<'a, M> {
    /// Stands on the first stretch of a move; none where an end is not finite or too far.
    #[must_use]
    pub fn new(from: DVec3, to: DVec3, world: &'a World<'a, M>) -> Option<Self> {
        let mut stretches = Self {
            world,
            ways: ArrayVec::new(),
        };
        stretches.walk(0, Walk::new(from, to)?);
        let spacing = world.scan.grid.spacing();
        let (low, high) = (from.min(to) * spacing, from.max(to) * spacing);
        for (number, body) in bodies(world) {
            let is_near = low.cmple(body.high).all() && high.cmpge(body.low).all();
            let there = |point| body.body_from_scan.transform_point3(point);
            if is_near && let Some(walk) = Walk::new(there(from), there(to)) {
                stretches.walk(number, walk);
            }
        }
        Some(stretches)
    }

    fn walk(&mut self, body: usize, walk: Walk) {
        let met = self.world.at(body, walk.voxel());
        // there are no more bodies than places
        let _ = self.ways.try_push(Way { body, walk, met });
    }

    /// How many grids are walked.
    #[must_use]
    pub fn grids(&self) -> u32 {
        u32::try_from(self.ways.len()).unwrap_or(u32::MAX)
    }

    /// Where it stands.
    #[must_use]
    pub fn now(&self) -> Stretch {
        let begins = self.ways.iter().map(|way| way.walk.fraction());
        let mets = self.ways.iter().map(|way| way.met);
        Stretch {
            begin: begins.fold(0.0, f64::max),
            end: self.end(),
            met: mets.fold(Met::Nothing, Met::and),
        }
    }

    fn end(&self) -> f64 {
        let ends = self.ways.iter().map(|way| way.walk.exit_fraction());
        ends.fold(1.0, f64::min)
    }

    /// Goes on to the next stretch; false at the end of the move.
    pub fn advance(&mut self) -> bool {
        let end = self.end();
        let mut advances = false;
        for way in &mut self.ways {
            if way.walk.exit_fraction() <= end && way.walk.advance() {
                way.met = self.world.at(way.body, way.walk.voxel());
                advances = true;
            }
        }
        advances
    }
}

/// What stands at a point.
pub fn met_at<M: TissueMap>(point: DVec3, world: &World<'_, M>) -> Met {
    let voxel_of = |point: DVec3| point.floor().as_ivec3();
    bodies(world).fold(world.at(0, voxel_of(point)), |met, (number, body)| {
        let there = body.body_from_scan.transform_point3(point);
        met.and(world.at(number, voxel_of(there)))
    })
}

/// The smallest spacing of all grids [mm].
pub fn finest<M: TissueMap>(world: &World<'_, M>) -> f64 {
    let scan = world.scan.grid.smallest_spacing();
    bodies(world).fold(scan, |finest, (_, body)| finest.min(body.spacing))
}

/// The bodies beside the scan, by their numbers.
fn bodies<'a, M: TissueMap>(world: &World<'a, M>) -> impl Iterator<Item = (usize, NeedleBody<'a>)> {
    let map = world.scan.map;
    (1..MAX_BODIES).map_while(move |number| Some((number, map.body(number)?)))
}

/// A body that stands elsewhere than the scan has it, or on a grid of its own.
#[derive(Clone, Copy, Debug)]
pub struct NeedleBody<'a> {
    /// Takes points of the scan's grid to the body's.
    pub body_from_scan: &'a DAffine3,
    /// A box along the axes of the scan's grid that holds it [mm from the corner of that grid].
    pub low: DVec3,
    /// Its other corner [mm].
    pub high: DVec3,
    /// The smallest side of its voxels [mm].
    pub spacing: f64,
}
