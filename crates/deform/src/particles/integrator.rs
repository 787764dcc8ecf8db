//! How particles move: velocity Verlet in physical and in scaled time, and FIRE to rest.
//!
//! Physical time is for tests and figures: a voxel of bone of 0.5 mm swings with T₀ = 0.6 µs,
//! so a frame of 33 ms would take a million steps. Scaled time multiplies every mass by one
//! declared factor; what is at rest is the same. Source: thesis 5.48; errata, section 7.

pub mod fire;
pub mod verlet;

pub use fire::Fire;
pub use verlet::VelocityVerlet;

/// The time in which particles move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeScale {
    /// Seconds.
    Physical,
    /// Seconds with every mass multiplied by this factor.
    Scaled {
        /// Over one: slower waves, longer steps.
        mass_factor: f64,
    },
}

impl TimeScale {
    /// The scale in which so many steps of k_t T₀ last a frame [s].
    pub fn for_frame(frame: f64, steps: u32, step_share: f64, period: f64) -> Self {
        let wanted = frame / (f64::from(steps) * step_share);
        Self::Scaled {
            mass_factor: (wanted / period).powi(2),
        }
    }

    /// Factor by which masses are multiplied.
    pub fn mass_factor(&self) -> f64 {
        match *self {
            Self::Physical => 1.0,
            Self::Scaled { mass_factor } => mass_factor,
        }
    }

    /// Δt = k_t T₀ [s], 5.48; k_t of 0.01 to 0.05, stable below 0.09.
    pub fn step(&self, step_share: f64, period: f64) -> f64 {
        step_share * period * self.mass_factor().sqrt()
    }
}
