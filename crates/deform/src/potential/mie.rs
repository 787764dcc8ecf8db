//! The Mie potential ("Mi" in the thesis): Lennard-Jones with free exponents n > m.
//!
//! Source: thesis 5.20–5.26; the printed k* (5.25) holds the inverse of the right root.

use super::{Characteristics, PairLaw, Potential, PotentialError, bounded, positive};

/// Π = D/(n − m) (m (a/r)ⁿ − n (a/r)ᵐ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mie {
    equilibrium: f64,
    depth: f64,
    n: f64,
    m: f64,
}

impl Mie {
    /// With equilibrium distance a, depth D and the exponents of repulsion and attraction.
    ///
    /// # Errors
    /// Where a or D is not positive and finite, or not 0 < m < n ≤ 60.
    pub fn new(equilibrium: f64, depth: f64, n: f64, m: f64) -> Result<Self, PotentialError> {
        if !(m > 0.0 && m < n && n <= 60.0) {
            return Err(PotentialError::Exponents { n, m });
        }
        Ok(Self {
            equilibrium: positive("equilibrium distance", equilibrium)?,
            depth: positive("depth", depth)?,
            n,
            m,
        })
    }
}

impl PairLaw for Mie {
    fn energy(&self, distance: f64) -> f64 {
        let Self { n, m, .. } = *self;
        let ratio = self.equilibrium / bounded(distance, self.equilibrium);
        self.depth / (n - m) * (m * ratio.powf(n) - n * ratio.powf(m))
    }

    fn force(&self, distance: f64) -> f64 {
        let Self { n, m, .. } = *self;
        let ratio = self.equilibrium / bounded(distance, self.equilibrium);
        let scale = self.depth / self.equilibrium * n * m / (n - m);
        scale * (ratio.powf(n + 1.0) - ratio.powf(m + 1.0))
    }
}

impl Potential for Mie {
    fn characteristics(&self) -> Characteristics {
        let Self { n, m, .. } = *self;
        let (a, depth) = (self.equilibrium, self.depth);
        let root = 1.0 / (n - m);
        // the root of 5.22 by logarithms: (n + 1)^(n + 1) leaves the doubles for large n
        let strength = (root * ((m + 1.0) * (m + 1.0).ln() - (n + 1.0) * (n + 1.0).ln())).exp();
        Characteristics {
            zero: a * (m / n).powf(root),
            equilibrium: a,
            critical: a * ((n + 1.0) / (m + 1.0)).powf(root),
            depth,
            strength: m * n * depth / a * strength,
            stiffness: m * n * depth / (a * a),
        }
    }
}
