//! Rays for detection alone: of exactly one length, near the surface, none of them meets it.
//!
//! They begin around a probe that slides over the surface, as those of a contact model do.
//! Frame: grid.

use glam::DVec3;
use palpate_volume::first_solid::{Outcome, first_solid_bounded};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;

use super::stroke::Stroke;
use crate::random::Random;

/// Farthest start from the probe along each axis [voxels].
const SPREAD: f64 = 2.0;
/// Directions tried per update.
const TRIES: usize = 16;

/// A ray from start to end.
pub type Ray = (DVec3, DVec3);

/// At most one ray of a length [voxels] for each update of a stroke; where the surface is all
/// around there is none.
#[must_use]
pub fn free_rays(
    grid: &Grid,
    solid: &impl Occupancy,
    stroke: &Stroke,
    length: f64,
    seed: u64,
) -> Vec<Ray> {
    let mut random = Random(!seed);
    let grid_from_scene = grid.grid_from_patient();
    stroke
        .probe
        .iter()
        .filter_map(|probe| {
            let probe = grid_from_scene.transform_point3(*probe);
            free_ray(solid, probe, length, &mut random)
        })
        .collect()
}

fn free_ray(solid: &impl Occupancy, probe: DVec3, length: f64, random: &mut Random) -> Option<Ray> {
    (0..TRIES).find_map(|_| {
        let spread = DVec3::splat(SPREAD);
        let start = random.in_box(probe - spread, probe + spread);
        let end = start + random.direction() * length;
        let traversal = first_solid_bounded(solid, start, end, u32::MAX);
        (traversal.outcome == Outcome::Free).then_some((start, end))
    })
}

/// Voxels that a free ray passes.
#[must_use]
pub fn visits((start, end): Ray) -> u64 {
    let steps = (end.floor() - start.floor()).abs();
    1 + (steps.x + steps.y + steps.z) as u64
}
