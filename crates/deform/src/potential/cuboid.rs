//! The thesis' cuboid Lennard-Jones law: the equilibrium distance grows off the axes so that
//! imaginary cubes of side a touch.
//!
//! a_cube/r = a/‖d‖∞, so the energy (5.64) is Lennard-Jones of the Chebyshev norm, a proper
//! potential. The thesis takes only the radial part of its gradient as force: that force is
//! not conservative (work along closed paths, and a block of such particles heats up without
//! end unless damped). Source: thesis 5.18, 5.62–5.65.

use glam::DVec3;

use super::{PotentialError, positive};

/// Cuboid Lennard-Jones between two particles; frame: the axes of the cubes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CuboidLennardJones {
    side: f64,
    depth: f64,
}

impl CuboidLennardJones {
    /// With the side a of the cubes and depth D.
    ///
    /// # Errors
    /// Where one of them is not positive and finite.
    pub fn new(side: f64, depth: f64) -> Result<Self, PotentialError> {
        Ok(Self {
            side: positive("side", side)?,
            depth: positive("depth", depth)?,
        })
    }

    /// (a/‖d‖∞)⁶, with cubes nearer than a tenth of a side taken as a tenth apart.
    fn sixth(&self, offset: DVec3) -> f64 {
        let apart = offset.abs().max_element();
        if offset.is_nan() {
            return 0.0;
        }
        (self.side / apart.max(0.1 * self.side)).powi(6)
    }

    /// Π(d), 5.64.
    pub fn energy(&self, offset: DVec3) -> f64 {
        let sixth = self.sixth(offset);
        self.depth * (sixth * sixth - 2.0 * sixth)
    }

    /// The thesis' force on the particle at `offset` from the other: along the line between
    /// them, −∂Π/∂r.
    pub fn radial_force(&self, offset: DVec3) -> DVec3 {
        let sixth = self.sixth(offset);
        let squared = offset.length_squared();
        if !(squared > 0.0 && squared.is_finite()) {
            return DVec3::ZERO;
        }
        // f(r)/r with s = r/a_cube: 12 D (s⁻¹² − s⁻⁶)/r²
        12.0 * self.depth * (sixth * sixth - sixth) / squared.max(0.01 * self.side.powi(2)) * offset
    }

    /// The true force −∇Π: along the dominant axis only, so without resistance to shear.
    pub fn gradient_force(&self, offset: DVec3) -> DVec3 {
        let sixth = self.sixth(offset);
        let apart = offset.abs().max_element().max(0.1 * self.side);
        let axis = offset.abs().max_position();
        if offset.is_nan() {
            return DVec3::ZERO;
        }
        let size = 12.0 * self.depth / apart * (sixth * sixth - sixth);
        let mut force = DVec3::ZERO;
        force[axis] = size * offset[axis].signum();
        force
    }
}
