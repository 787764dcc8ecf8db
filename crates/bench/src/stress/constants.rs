//! What is constant in a run, for those who check it.

use glam::{DMat3, DVec3};
use palpate_haptics::force::ForceLimits;

use super::felt::Felt;

/// What is constant in a run.
#[derive(Clone, Copy, Debug)]
pub struct Constants {
    /// Voxel size [mm].
    pub spacing: DVec3,
    /// Columns are the grid's axes in the scene.
    pub direction: DMat3,
    /// Middle of voxel 0 in the scene [mm].
    pub origin: DVec3,
    /// Radius of the probe [mm].
    pub radius: f64,
    /// Most voxels of a tick.
    pub visit_bound: u32,
    /// What may be sent.
    pub limits: ForceLimits,
    /// Time between ticks [s].
    pub dt: f64,
    /// Of the spring [N/mm].
    pub stiffness: f64,
    /// Of the damper beside it [N·s/mm].
    pub damping: f64,
    /// Whether the force is across the surface only.
    pub frictionless: bool,
    /// What it follows.
    pub felt: Felt,
}

impl Constants {
    /// A point of the grid in the scene [mm].
    pub fn in_scene(&self, point: DVec3) -> DVec3 {
        self.origin + self.direction * (self.spacing * (point - 0.5))
    }
}
