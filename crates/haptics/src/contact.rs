//! What every contact model does: move the proxy toward the device, and say what it met.
//!
//! Frame: the world's grid. A model is constant; all that changes is the proxy.

mod bit_rows;
pub(crate) mod bodies;
mod corner_search;
pub(crate) mod descent;
mod exact;
pub(crate) mod flood;
mod many_bodies;
mod node_lattice;
mod proxy;
mod slide;
mod slide_many;
mod slide_window;
pub(crate) mod voxel_distance;

pub use exact::{Exact, ExactLimits};
pub use proxy::Proxy;

use crate::scene::{Solid, TouchScene};
use glam::DVec3;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;

/// What the proxy met on its way to the device.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// The way of the proxy in this tick, from models whose forces need it.
    pub path: Option<SlidePath>,
}

/// The way of a proxy in one tick, as the thesis measures it: in voxels, also where they are
/// not cubes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlidePath {
    /// p₂ − p₁: from where the proxy was to where it is.
    pub moved: DVec3,
    /// w: length of all moves.
    pub length: f64,
    /// N_bv: number of the border voxels that it went through.
    pub border_voxels: u32,
    /// w_bv: length of the moves through them.
    pub border_length: f64,
    /// v_bv: the sum of these moves.
    pub border_sum: DVec3,
}

/// What a model is given to make a force of its own.
#[derive(Clone, Copy, Debug)]
pub struct ForceInput<'a> {
    /// Where the scan stands.
    pub grid: &'a Grid,
    /// d₂: the device, grid.
    pub device_in_grid: DVec3,
    /// p₂: the proxy after the tick, grid.
    pub proxy_in_grid: DVec3,
    /// What the proxy met.
    pub contact: &'a Contact,
    /// k [N/mm].
    pub stiffness: f64,
    /// μ, without unit.
    pub friction: f64,
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

    /// Whether the model makes its own force; friction and the smooth contact point then have
    /// no part in it.
    fn has_own_force(&self) -> bool {
        false
    }

    /// The model's own force on the device [N], along the axes of the grid in mm. None, as by
    /// default, where the force is that of touch: from the smooth contact point, with Coulomb
    /// friction.
    fn own_force(&self, _input: &ForceInput<'_>) -> Option<DVec3> {
        None
    }
}
