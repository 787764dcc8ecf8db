//! What every contact model does: move the proxy toward the device, and say what it met.
//!
//! Frame: the world's grid. A model is constant; all that changes is the proxy.

use crate::proxy::Proxy;
use crate::scene::{Solid, TouchScene};
use glam::DVec3;
use palpate_volume::occupancy::Occupancy;

/// What the proxy met on its way to the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contact {
    /// Whether a solid voxel holds the proxy back from the device.
    pub touching: bool,
    /// The solid voxel that stopped it last; its owner is the segment that is touched.
    pub stopped_by: Option<Solid>,
    /// Voxels read.
    pub visits: u32,
    /// Steps along the surface.
    pub slides: u32,
    /// The proxy stands in a solid voxel: guarantee 1 was broken, with `exact` by whoever
    /// changed the voxels without admission (it is left there), with the thesis' models also
    /// by the model itself.
    pub violation: bool,
}

/// A contact model: static dispatch, no state of its own.
pub trait ContactModel {
    /// Moves the proxy toward the device point by legal moves only: through face-connected
    /// free voxels (`exact`; the thesis' models promise none of it). A device point that is not
    /// finite leaves it where it is.
    fn advance<O: Occupancy>(
        &self,
        scene: &TouchScene<'_, O>,
        device_in_grid: DVec3,
        proxy: &mut Proxy,
    ) -> Contact;

    /// Most voxels that one call reads, whatever the volume.
    fn visit_bound(&self) -> u32;
}
