//! The Lennard-Jones potential in its equilibrium form, Π = D((a/r)¹² − 2(a/r)⁶).
//!
//! Source: thesis 5.13–5.19. Of the printed constants f* (504/159), ε* and k* are wrong; right
//! are f* = 504/169 (7/13)^(1/6) D/a = 2.690, ε* = (13/7)^(1/6) − 1 = 0.1087, k* = 2.909.

use super::{Characteristics, PairLaw, Potential, PotentialError, bounded, positive};

/// Lennard-Jones, 12–6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LennardJones {
    equilibrium: f64,
    depth: f64,
}

impl LennardJones {
    /// With equilibrium distance a and depth D.
    ///
    /// # Errors
    /// Where one of them is not positive and finite.
    pub fn new(equilibrium: f64, depth: f64) -> Result<Self, PotentialError> {
        Ok(Self {
            equilibrium: positive("equilibrium distance", equilibrium)?,
            depth: positive("depth", depth)?,
        })
    }
}

impl PairLaw for LennardJones {
    fn energy(&self, distance: f64) -> f64 {
        let sixth = (self.equilibrium / bounded(distance, self.equilibrium)).powi(6);
        self.depth * (sixth * sixth - 2.0 * sixth)
    }

    fn force(&self, distance: f64) -> f64 {
        let ratio = self.equilibrium / bounded(distance, self.equilibrium);
        12.0 * self.depth / self.equilibrium * (ratio.powi(13) - ratio.powi(7))
    }
}

impl Potential for LennardJones {
    fn characteristics(&self) -> Characteristics {
        let (a, depth) = (self.equilibrium, self.depth);
        Characteristics {
            zero: a * 0.5_f64.powf(1.0 / 6.0),
            equilibrium: a,
            critical: a * (13.0_f64 / 7.0).powf(1.0 / 6.0),
            depth,
            strength: 504.0 / 169.0 * (7.0_f64 / 13.0).powf(1.0 / 6.0) * depth / a,
            stiffness: 72.0 * depth / (a * a),
        }
    }
}
