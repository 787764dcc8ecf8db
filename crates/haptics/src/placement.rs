//! Where the proxy can start: the free voxel nearest to a point.
//!
//! Frame: grid; distances in mm. Not part of a tick: it reads up to (2 r + 1)³ voxels.

use crate::proxy::Proxy;
use crate::voxel_distance::squared_distance;
use glam::{DVec3, IVec3};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;

/// The proxy at the free point nearest to `point`, in mm, among the voxels at most `radius`
/// away along each axis. It is the point itself where that is free; none where everything
/// is solid or the point not finite.
pub fn nearest_free(
    occupancy: &(impl Occupancy + ?Sized),
    grid: &Grid,
    point: DVec3,
    radius: i32,
) -> Option<Proxy> {
    let proxy = Proxy::at(point)?;
    if !occupancy.is_solid(proxy.voxel()) {
        return Some(proxy);
    }

    // shell by shell; each voxel of shell r is at least (r - 1) voxels away
    let spacing = grid.spacing();
    let mut best: Option<(f64, IVec3)> = None;
    for shell in 1..=radius.max(0) {
        let least = f64::from(shell - 1) * spacing.min_element();
        if best.is_some_and(|(distance, _)| distance <= least * least) {
            break;
        }
        visit_shell(shell, |offset| {
            let voxel = proxy.voxel() + offset;
            let distance = squared_distance(voxel, point, spacing);
            let nearer = best.is_none_or(|(nearest, _)| distance < nearest);
            if nearer && !occupancy.is_solid(voxel) {
                best = Some((distance, voxel));
            }
        });
    }
    best.map(|(_, voxel)| Proxy::nearest_in(voxel, point))
}

/// All offsets with a largest component of `shell` > 0.
fn visit_shell(shell: i32, mut visit: impl FnMut(IVec3)) {
    for z in -shell..=shell {
        for y in -shell..=shell {
            let on_face = z.abs() == shell || y.abs() == shell;
            // inside the shell only the two ends of a row belong to it
            let stride = if on_face { 1 } else { 2 * shell };
            let mut x = -shell;
            while x <= shell {
                visit(IVec3::new(x, y, z));
                x += stride;
            }
        }
    }
}
