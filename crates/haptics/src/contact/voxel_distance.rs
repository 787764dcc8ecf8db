//! How far a point is from where the proxy can stand in a voxel: the one distance that
//! every move of the contact model lowers.
//!
//! Frame: grid; distances in mm. The proxy stays a skin inside its voxel, so that neither
//! rounding nor a way through other frames carries it into a neighbour that may be solid.
//! Both functions below are used for every comparison, so that equal places are equal to
//! the bit and a strictly smaller distance is never undone by rounding.

use glam::{DVec3, IVec3};

/// How far inside its voxel the proxy stays [voxels]: far above the rounding of grid
/// coordinates (4e-9 at the coordinate limit), far below anything that can be felt.
const SKIN: f64 = 1e-8;

/// The point nearest to `target` where the proxy can stand in a voxel. Voxels are boxes
/// along the axes in mm as well, so that the nearest point is found axis by axis.
#[inline]
pub(crate) fn nearest_point(voxel: IVec3, target: DVec3) -> DVec3 {
    let corner = voxel.as_dvec3();
    let along = |axis: usize| {
        let (low, high) = (corner[axis] + SKIN, corner[axis] + (1.0 - SKIN));
        smaller(larger(target[axis], low), high)
    };
    DVec3::new(along(0), along(1), along(2))
}

/// The larger of two numbers that are not NaN: one instruction.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers that are not NaN.
#[inline]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Squared distance [mm²] along one axis from `target` to that point of a voxel.
#[inline]
pub(crate) fn squared_along(voxel: i32, target: f64, spacing: f64) -> f64 {
    let corner = f64::from(voxel);
    let [before, after] = [corner + SKIN - target, target - (corner + (1.0 - SKIN))];
    let outside = larger(larger(before, after), 0.0) * spacing;
    outside * outside
}

/// Squared distance [mm²] from `target` to that point of a voxel.
#[inline]
pub(crate) fn squared_distance(voxel: IVec3, target: DVec3, spacing: DVec3) -> f64 {
    let along = |axis: usize| squared_along(voxel[axis], target[axis], spacing[axis]);
    along(0) + along(1) + along(2)
}
