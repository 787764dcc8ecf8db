//! What crates above share about how tissue feels.
//!
//! Units: stiffness N/mm, force N, lengths mm; friction coefficients have none.

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// How the surface of a segment feels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Force per depth [N/mm], before the device's own limit.
    pub stiffness: f64,
    /// Coulomb coefficient of a probe that sticks.
    pub friction_static: f64,
    /// Coulomb coefficient of a probe that slides; at most the static one.
    pub friction_kinetic: f64,
}

/// A contact near a tool as a linear law that the servo can follow between two results of
/// a slower simulation. Frame: scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocalContact {
    /// Where the tool was [mm].
    pub position: DVec3,
    /// Force on the tool there [N].
    pub force: DVec3,
    /// Change of the force with the tool's position [N/mm]; a spring has a negative one.
    pub stiffness: DMat3,
    /// Distance from `position` within which the law holds [mm].
    pub validity: f64,
}

impl LocalContact {
    /// Force on the tool at a place [N]; none where the law does not hold.
    pub fn force_at(&self, tool: DVec3) -> Option<DVec3> {
        let moved = tool - self.position;
        (moved.length() <= self.validity).then(|| self.force + self.stiffness * moved)
    }
}
