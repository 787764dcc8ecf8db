//! The Morse potential, Π = D(e^(−2α(r − a)) − 2e^(−α(r − a))).
//!
//! Given by k_v = α a, the dimensionless number that says how brittle it is at a given
//! stiffness; the α that the thesis calls dimensionless is one over a length.
//! Source: thesis 5.27–5.33.

use std::f64::consts::LN_2;

use super::{Characteristics, PairLaw, Potential, PotentialError, bounded, positive, within};

/// Morse, finite at every distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Morse {
    equilibrium: f64,
    depth: f64,
    dynamics: f64,
}

impl Morse {
    /// With equilibrium distance a, depth D and k_v.
    ///
    /// # Errors
    /// Where a or D is not positive and finite, or k_v not in 1 to 300 (e^(2 k_v) must be a
    /// number, and below ln 2 there is no zero at a positive distance).
    pub fn new(equilibrium: f64, depth: f64, dynamics: f64) -> Result<Self, PotentialError> {
        Ok(Self {
            equilibrium: positive("equilibrium distance", equilibrium)?,
            depth: positive("depth", depth)?,
            dynamics: within("k_v", dynamics, 1.0, 300.0)?,
        })
    }

    fn decay(&self, distance: f64) -> f64 {
        let distance = bounded(distance, self.equilibrium);
        (-self.dynamics * (distance / self.equilibrium - 1.0)).exp()
    }
}

impl PairLaw for Morse {
    fn energy(&self, distance: f64) -> f64 {
        let decay = self.decay(distance);
        self.depth * (decay * decay - 2.0 * decay)
    }

    fn force(&self, distance: f64) -> f64 {
        let decay = self.decay(distance);
        2.0 * self.dynamics / self.equilibrium * self.depth * (decay * decay - decay)
    }
}

impl Potential for Morse {
    fn characteristics(&self) -> Characteristics {
        let (a, depth, alpha) = (
            self.equilibrium,
            self.depth,
            self.dynamics / self.equilibrium,
        );
        Characteristics {
            zero: a - LN_2 / alpha,
            equilibrium: a,
            critical: a + LN_2 / alpha,
            depth,
            strength: 0.5 * alpha * depth,
            stiffness: 2.0 * alpha * alpha * depth,
        }
    }
}
