//! Where the proxy can start: the free voxel nearest to a point.
//!
//! Frame: grid; distances in mm. Not part of a tick: it reads up to (2 r + 1)³ voxels.

use crate::contact::Proxy;
use crate::contact::voxel_distance::squared_distance;
use crate::scene::TouchScene;
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
    let spacing = grid.spacing();
    let voxel = search_shells(proxy.voxel(), spacing, radius, |voxel, nearest| {
        let distance = squared_distance(voxel, point, spacing);
        (distance < nearest && !occupancy.is_solid(voxel)).then_some((distance, voxel))
    })?;
    Some(Proxy::nearest_in(voxel, point))
}

/// The same among objects: at the nearest of some points of each voxel of the world (its
/// nearest, and 3×3×3 in its inside) that is free in every body. So it can miss gaps thinner
/// than a third of a voxel.
pub fn nearest_free_in<O: Occupancy>(
    scene: &TouchScene<'_, O>,
    point: DVec3,
    radius: i32,
) -> Option<Proxy> {
    let proxy = Proxy::at(point)?;
    if scene.solid_at(point).is_none() {
        return Some(proxy);
    }
    let spacing = scene.grid.spacing();
    let found = search_shells(proxy.voxel(), spacing, radius, |voxel, nearest| {
        if squared_distance(voxel, point, spacing) >= nearest || scene.occupancy.is_solid(voxel) {
            return None;
        }
        let inside = (0..27).map(|i| {
            let third = IVec3::new(i % 3, i / 3 % 3, i / 9).as_dvec3();
            voxel.as_dvec3() + (third + 0.5) / 3.0
        });
        std::iter::once(Proxy::nearest_in(voxel, point).point())
            .chain(inside)
            .filter(|&place| scene.solid_at(place).is_none())
            .map(|place| (((place - point) * spacing).length_squared(), place))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|(distance, _)| *distance < nearest)
    })?;
    Proxy::at(found)
}

/// Visits voxels in order of their distance, more or less, as long as one can be nearer than the
/// best; `nearer` gives its squared distance [mm²] and place if it is nearer than what it is given.
fn search_shells<P>(
    start: IVec3,
    spacing: DVec3,
    radius: i32,
    nearer: impl Fn(IVec3, f64) -> Option<(f64, P)>,
) -> Option<P> {
    // shell by shell; each voxel of shell r is at least (r - 1) voxels away
    let mut best: Option<(f64, P)> = None;
    for shell in 0..=radius.max(0) {
        let nearest = |best: &Option<(f64, P)>| best.as_ref().map_or(f64::INFINITY, |best| best.0);
        let least = f64::from(shell - 1).max(0.0) * spacing.min_element();
        if nearest(&best) <= least * least {
            break;
        }
        visit_shell(shell, |offset| {
            if let Some(found) = nearer(start + offset, nearest(&best)) {
                best = Some(found);
            }
        });
    }
    best.map(|(_, place)| place)
}

/// All offsets with a largest component of `shell`.
fn visit_shell(shell: i32, mut visit: impl FnMut(IVec3)) {
    if shell == 0 {
        return visit(IVec3::ZERO);
    }
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
