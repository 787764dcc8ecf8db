//! Walls: an option by which particles may not leave the box nor enter empty voxels.
//!
//! The thesis tests a point half a link ahead *along the motion* and cancels the whole move:
//! with the lattice shifted into the voxels every outward move of a surface particle is then
//! cancelled, and free surfaces are frozen. Here the wall is the face of the cell itself, only
//! the coordinate that crosses it is put back, and the velocity through it is mirrored.
//! Source: thesis 5.13; errata, section 4.

use glam::{DVec3, IVec3};

use super::state::Particles;

/// Puts back what crossed a wall since `before`; `open` says into which cells of side `cell`
/// particles may go.
pub fn keep_inside(
    particles: &mut Particles,
    before: &[DVec3],
    cell: f64,
    open: impl Fn(IVec3) -> bool,
) {
    let cell_of = |place: DVec3| (place / cell).floor().as_ivec3();
    let Particles {
        sites, velocities, ..
    } = particles;
    for ((site, velocity), &before) in sites.iter_mut().zip(velocities).zip(before) {
        let mut place = site.position();
        let (from, to) = (cell_of(before), cell_of(place));
        if from == to || open(to) {
            continue;
        }
        for axis in 0..3 {
            if from[axis] != to[axis] {
                place[axis] = before[axis];
                velocity[axis] = -velocity[axis];
            }
        }
        site.set_position(place);
    }
}
