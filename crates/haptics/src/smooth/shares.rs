//! How much of a voxel at the surface is solid, from the intensities that it was made from.
//!
//! A threshold makes whole voxels solid or free; the intensities still tell where between
//! two voxels the threshold is crossed. Counting each voxel at the surface by its share takes
//! most of the stairs away, and leaves all the rest as it is: what the proxy does not reach is
//! filled, noise is blurred, and a voxel that was edited counts as its bit says.
//!
//! This in place of a trilinear surface at the threshold: its gradient steps from voxel to
//! voxel, it is as rough as the noise, and it knows nothing of edits nor of thin walls.
//!
//! Frame: grid.

use glam::IVec3;
use palpate_volume::intensities::Intensities;
use palpate_volume::overlay::Overlay;

/// Tells shares of voxels.
pub trait Shares {
    /// Whether it ever tells one.
    const ANY: bool;

    /// The share of a voxel at the surface that is solid, 0..=1; at least ½ for a solid one and
    /// at most ½ for a free one. None where nothing is known beyond its bit.
    fn share(&self, voxel: IVec3, solid: bool) -> Option<f32>;
}

/// Bits and no more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoShares;

impl Shares for NoShares {
    const ANY: bool = false;

    fn share(&self, _voxel: IVec3, _solid: bool) -> Option<f32> {
        None
    }
}

/// A segment made by a threshold: solid from a lowest to a highest value.
#[derive(Clone, Copy, Debug)]
pub struct ThresholdShares<'a> {
    scan: &'a Intensities,
    overlay: Option<&'a Overlay>,
    /// Limits, and the value outside the grid, as stored.
    low: f32,
    high: f32,
    outside: f32,
    /// From a voxel to the next along each axis in memory.
    strides: [usize; 3],
}

impl<'a> ThresholdShares<'a> {
    /// A threshold on a scan under what matter edits have put over it; without such edits the
    /// overlay is best left out, since looking there takes time. `limits` and the value
    /// `outside` the grid, such as that of air, are physical.
    pub fn new(
        scan: &'a Intensities,
        overlay: Option<&'a Overlay>,
        limits: [f64; 2],
        outside: f64,
    ) -> Self {
        let stored = |value: f64| ((value - scan.intercept()) / scan.slope()) as f32;
        let [first, second] = limits.map(stored);
        let [nx, ny] = [scan.dimensions().x as usize, scan.dimensions().y as usize];
        Self {
            scan,
            overlay,
            // a negative slope turns them around
            low: first.min(second),
            high: first.max(second),
            outside: stored(outside),
            strides: [1, nx, nx * ny],
        }
    }

    /// How far a stored value is within the limits; negative outside of them.
    fn within(&self, stored: f32) -> f32 {
        (stored - self.low).min(self.high - stored)
    }

    /// A voxel and its neighbours before and after it along each axis, within the limits.
    fn around(&self, voxel: IVec3) -> (f32, [[f32; 2]; 3]) {
        let last = self.scan.dimensions().as_ivec3() - 1;
        let inner = voxel.cmpgt(IVec3::ZERO).all() && voxel.cmplt(last).all();
        if inner && self.overlay.is_none() {
            let [x, y, z] = voxel.to_array().map(|i| i as usize);
            let [_, row, layer] = self.strides;
            let place = z * layer + y * row + x;
            let values = self.scan.values();
            let at = |place: usize| {
                let stored = values.get(place).map_or(self.outside, |&v| f32::from(v));
                self.within(stored)
            };
            return (
                at(place),
                self.strides
                    .map(|stride| [at(place - stride), at(place + stride)]),
            );
        }
        let at = |voxel: IVec3| {
            let stored = match self.overlay {
                Some(overlay) => overlay.stored(self.scan, voxel),
                None => self.scan.stored(voxel),
            };
            self.within(stored.map_or(self.outside, f32::from))
        };
        (
            at(voxel),
            [IVec3::X, IVec3::Y, IVec3::Z].map(|axis| [at(voxel - axis), at(voxel + axis)]),
        )
    }
}

impl Shares for ThresholdShares<'_> {
    const ANY: bool = true;

    fn share(&self, voxel: IVec3, solid: bool) -> Option<f32> {
        let (here, around) = self.around(voxel);
        if solid != (here >= 0.0) {
            return None;
        }
        // a plane through the voxel at distance d leaves the share ½ + d over the voxel's
        // width across it, which is the sum of its normal's parts; and d is the value over
        // the slope
        let [x, y, z] = around.map(|[before, after]| 0.5 * (after - before).abs());
        let share = 0.5 + here / (x + y + z);
        share.is_finite().then(|| share.clamp(0.0, 1.0))
    }
}
