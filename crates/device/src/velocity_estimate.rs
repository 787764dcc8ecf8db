//! Velocity from a position that moves in encoder steps.
//!
//! The difference of two readings jumps by step / dt; a first-order filter smooths it, as
//! the drivers of real devices do.

use glam::DVec3;

/// A filtered difference of positions [mm/s].
#[derive(Clone, Debug)]
pub struct VelocityEstimate {
    /// Time constant of the filter [s]; 0 leaves the plain difference.
    time_constant: f64,
    last: DVec3,
    velocity: DVec3,
}

impl VelocityEstimate {
    /// An estimate at rest at `position` [mm].
    pub fn new(position: DVec3, time_constant: f64) -> Self {
        Self {
            time_constant,
            last: position,
            velocity: DVec3::ZERO,
        }
    }

    /// Takes the position [mm] after another `dt` > 0 [s] and gives the velocity.
    pub fn update(&mut self, position: DVec3, dt: f64) -> DVec3 {
        let difference = (position - self.last) / dt;
        self.last = position;
        self.velocity += (difference - self.velocity) * (dt / (self.time_constant + dt));
        self.velocity
    }
}
