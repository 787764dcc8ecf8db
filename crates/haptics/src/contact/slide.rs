//! One slide of the proxy along the surface: to the nearest reachable free voxel.
//!
//! Distances are taken in mm from the device point to the nearest point of a voxel, because
//! that is where the proxy goes: so the distance that falls is the very length of the
//! coupling spring. Reachable means face to face through free voxels of the
//! window; it contains each diagonal step with a monotone free path, and more, which
//! gets the proxy over the stairs that voxels make of a slope.
//!
//! Frame: grid. Source: thesis 4.8 and its errata; see `exact.rs`.

use crate::contact::flood::reached;
use crate::contact::slide_window::{LayerDistances, SlideWindow};
use glam::{DVec3, IVec3};
use palpate_volume::occupancy::Occupancy;

/// Voxels that one slide reads.
pub(crate) const SLIDE_VISITS: u32 = 8 * 8 * 8;

/// The voxel to slide to from the free voxel `from`, or none where it is best.
#[inline(always)]
pub(crate) fn slide(
    occupancy: &(impl Occupancy + ?Sized),
    spacing: DVec3,
    device: DVec3,
    from: IVec3,
) -> Option<IVec3> {
    let window = SlideWindow::new(from, device);
    let distances = LayerDistances::new(window.min, device, spacing);
    let start = from - window.min;

    // what would be strictly better, if it can be reached
    let here = distances.of(start);
    if here == 0.0 {
        return None;
    }
    let free = window.free(occupancy);
    let nearer = distances.nearer(&free, here);
    if nearer.iter().all(|&word| word == 0) {
        return None;
    }

    // of that, what is reached face to face
    let start_bit = 1 << (start.y * 8 + start.x);
    let reached = reached(&free, start.z as usize, start_bit);
    let candidates = std::array::from_fn(|z| nearer[z] & reached[z]);
    distances
        .nearest(&candidates)
        .map(|offset| window.min + offset)
}
