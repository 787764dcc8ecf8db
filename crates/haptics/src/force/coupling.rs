//! The virtual coupling: a spring and damper between the proxy and the device.
//!
//! Frame: any with axes in mm; stiffness N/mm, damping N·s/mm, force N.
//! The damper acts along the spring only, so that it adds no friction, and never by more
//! than the spring itself, so that the force starts from zero at the surface and never
//! pulls: F·(p − d) >= 0 for every velocity.
//! Source: Colgate, Stanley, Brown, "Issues in the haptic display of tool use", IROS
//! 1995; Hunt & Crossley, "Coefficient of restitution interpreted as damping in
//! vibroimpact", J. Applied Mechanics 42 (1975) for damping that grows with depth.

use glam::DVec3;

/// Stiffness and damping of the contact that the hand feels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// Spring between device and proxy [N/mm].
    pub stiffness: f64,
    /// Damping along the spring [N·s/mm].
    pub damping: f64,
}

impl Default for Coupling {
    /// Bone under the simulated device: three times its hand's stiffness, and half of what
    /// its own friction keeps passive without any damping here.
    fn default() -> Self {
        Self {
            stiffness: 1.0,
            damping: 0.0,
        }
    }
}

/// Why a coupling cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CouplingError {
    /// The spring is not a spring.
    #[error("stiffness is {0} N/mm; allowed: finite, 0..={MAX_STIFFNESS}")]
    Stiffness(f64),
    /// The damper is not a damper.
    #[error("damping is {0} N·s/mm; allowed: finite, 0..={MAX_DAMPING}")]
    Damping(f64),
}

/// Largest stiffness accepted [N/mm]; the stiffest devices bear 8.
pub const MAX_STIFFNESS: f64 = 20.0;
/// Largest damping accepted [N·s/mm]; the stiffest devices have 0.03 of their own.
pub const MAX_DAMPING: f64 = 1.0;

impl Coupling {
    /// Checks both figures, for values that a person gave.
    pub fn check(&self) -> Result<(), CouplingError> {
        if !(0.0..=MAX_STIFFNESS).contains(&self.stiffness) {
            return Err(CouplingError::Stiffness(self.stiffness));
        }
        if !(0.0..=MAX_DAMPING).contains(&self.damping) {
            return Err(CouplingError::Damping(self.damping));
        }
        Ok(())
    }

    /// Force on the device [N] for the way from it to the proxy [mm] and its velocity
    /// [mm/s]. A coupling that is no spring and damper gives no force.
    pub fn force(&self, proxy_from_device: DVec3, velocity: DVec3) -> DVec3 {
        let depth = proxy_from_device.length();
        if depth == 0.0 {
            return DVec3::ZERO;
        }
        let outward = proxy_from_device / depth;
        let spring = self.stiffness * depth;
        // `max` and `min` take the bound in place of a NaN, where `clamp` would panic
        let damper = (-self.damping * velocity.dot(outward))
            .max(-spring)
            .min(spring);
        outward * (spring + damper).max(0.0)
    }
}
