//! Moves near a surface, where a probe spends its time.
//!
//! Frame: grid.

use glam::{DVec3, IVec3};
use palpate_volume::first_solid::first_solid;
use palpate_volume::segment::Segment;

/// How far from the surface a move starts, along each axis [voxels].
const NEAR: f64 = 4.0;

/// One straight move.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// Where it starts.
    pub start: DVec3,
    /// Where it ends.
    pub end: DVec3,
}

/// Moves of one length in random directions that start near the surface, in the open, and
/// either all meet it (`hit`) or all do not.
pub fn moves_near_surface(solid: &Segment, length: f64, count: usize, hit: bool) -> Vec<Move> {
    let surface = surface_voxels(solid);
    let mut random = oorandom::Rand64::new(7);
    let mut moves = Vec::with_capacity(count);
    while moves.len() < count {
        let voxel = surface[random.rand_range(0..surface.len() as u64) as usize];
        let start = voxel.as_dvec3() + 0.5 + NEAR * in_cube(&mut random);
        let end = start + length * direction(&mut random);
        let met = first_solid(solid, start, end);
        if met.is_some() == hit && met.is_none_or(|met| !met.starts_inside()) {
            moves.push(Move { start, end });
        }
    }
    moves
}

/// Solid voxels with a free one beside them.
fn surface_voxels(solid: &Segment) -> Vec<IVec3> {
    let all = solid.bounding_box().expect("something is solid").voxels();
    let neighbours = [
        IVec3::X,
        IVec3::Y,
        IVec3::Z,
        IVec3::NEG_X,
        IVec3::NEG_Y,
        IVec3::NEG_Z,
    ];
    all.filter(|&voxel| solid.contains(voxel))
        .filter(|&voxel| neighbours.iter().any(|&step| !solid.contains(voxel + step)))
        .collect()
}

/// A point of the cube from -1 to 1.
fn in_cube(random: &mut oorandom::Rand64) -> DVec3 {
    let mut coordinate = || 2.0 * random.rand_float() - 1.0;
    DVec3::new(coordinate(), coordinate(), coordinate())
}

/// A direction, all equally likely.
fn direction(random: &mut oorandom::Rand64) -> DVec3 {
    loop {
        let point = in_cube(random);
        if (0.01..1.0).contains(&point.length_squared()) {
            return point.normalize();
        }
    }
}
