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

/// A segment made by a threshold: solid from `low` to `high`, in physical values.
#[derive(Clone, Copy, Debug)]
pub struct ThresholdShares<'a> {
    /// The scan.
    pub scan: &'a Intensities,
    /// What matter edits have put over it.
    pub overlay: Option<&'a Overlay>,
    /// Smallest solid value.
    pub low: f64,
    /// Largest solid value.
    pub high: f64,
    /// The value outside the grid, such as that of air.
    pub outside: f64,
}

impl ThresholdShares<'_> {
    /// How far a value is within the limits; negative outside of them.
    fn within(&self, voxel: IVec3) -> f64 {
        let stored = match self.overlay {
            Some(overlay) => overlay.stored(self.scan, voxel),
            None => self.scan.stored(voxel),
        };
        let value = stored.map_or(self.outside, |stored| self.scan.physical(stored));
        (value - self.low).min(self.high - value)
    }
}

impl Shares for ThresholdShares<'_> {
    const ANY: bool = true;

    fn share(&self, voxel: IVec3, solid: bool) -> Option<f32> {
        let here = self.within(voxel);
        if solid != (here >= 0.0) {
            return None;
        }
        // a plane through the voxel at distance d leaves the share ½ + d over the voxel's
        // width across it, which is the sum of its normal's parts; and d is the value over
        // the slope
        let slope: f64 = IVec3::AXES
            .into_iter()
            .map(|axis| 0.5 * (self.within(voxel + axis) - self.within(voxel - axis)).abs())
            .sum();
        let share = 0.5 + here / slope;
        share.is_finite().then(|| share.clamp(0.0, 1.0) as f32)
    }
}
