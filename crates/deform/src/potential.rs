//! Interaction potentials of two particles, as functions of their distance.
//!
//! Units are the caller's: energies in the unit of D, lengths in that of a, so forces come in
//! D/a. A positive force pushes apart. Closer than a tenth of a counts as a tenth, and a
//! distance that is no number as infinitely far, so no answer is ever infinite or NaN.
//! Source: thesis 5.6–5.7 after Krivtsov, *Deformation and fracture of solids with
//! microstructure* (2007); corrected where its printed constants are wrong (5.15, 5.17, 5.18,
//! 5.25: inverted roots and a lost factor).

use thiserror::Error;

pub mod composite;
pub mod cuboid;
pub mod lennard_jones;
pub mod mie;
pub mod morse;
pub mod switched;

pub use composite::{Limited, Repulsive, Shifted, Spline, Stretched};
pub use cuboid::CuboidLennardJones;
pub use lennard_jones::LennardJones;
pub use mie::Mie;
pub use morse::Morse;
pub use switched::Switched;

/// A potential that cannot be.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum PotentialError {
    /// A length, energy or factor that must be positive and finite is not.
    #[error("{name} {given} given; allowed: a positive finite number")]
    NotPositive {
        /// What was given.
        name: &'static str,
        /// The value given.
        given: f64,
    },
    /// The exponents of a Mie potential in the wrong order.
    #[error("Mie exponents n = {n}, m = {m} given; allowed: 0 < m < n <= 60")]
    Exponents {
        /// Exponent of the repulsion.
        n: f64,
        /// Exponent of the attraction.
        m: f64,
    },
    /// A range in which something is faded, cut or limited lies wrong.
    #[error("{name} {given} given; allowed: {low} to {high}")]
    Range {
        /// What was given.
        name: &'static str,
        /// The value given.
        given: f64,
        /// Least allowed.
        low: f64,
        /// Greatest allowed.
        high: f64,
    },
}

/// Energy and force of two particles at a distance.
pub trait PairLaw {
    /// Π(r).
    fn energy(&self, distance: f64) -> f64;
    /// f(r) = −Π′(r); positive pushes apart.
    fn force(&self, distance: f64) -> f64;
}

/// A pair law with one well, described by its characteristics.
pub trait Potential: PairLaw {
    /// The nine numbers of 5.5–5.12.
    fn characteristics(&self) -> Characteristics;
}

/// What describes a potential with one well (thesis 5.5–5.12).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Characteristics {
    /// σ: where the energy is zero.
    pub zero: f64,
    /// a: where the force is zero.
    pub equilibrium: f64,
    /// b: where the attraction is greatest; farther, the link breaks.
    pub critical: f64,
    /// D = −Π(a): energy of the link.
    pub depth: f64,
    /// f* = −f(b): strength of the link.
    pub strength: f64,
    /// C = Π″(a): stiffness of the link.
    pub stiffness: f64,
}

impl Characteristics {
    /// ε* = (b − a)/a: strain at which the link breaks.
    pub fn ultimate_strain(&self) -> f64 {
        (self.critical - self.equilibrium) / self.equilibrium
    }

    /// k* = C (b − a)/f*: how far the law is from linear.
    pub fn nonlinearity(&self) -> f64 {
        self.stiffness * (self.critical - self.equilibrium) / self.strength
    }

    /// k_v = √(a² C/(2 D)): speed of sound over speed of dissociation; the greater, the more
    /// brittle.
    pub fn dynamics(&self) -> f64 {
        self.equilibrium * (self.stiffness / (2.0 * self.depth)).sqrt()
    }

    /// The depth that gives this stiffness, 5.51: D = C a²/(2 k_v²).
    pub fn depth_for_stiffness(&self, stiffness: f64) -> f64 {
        stiffness * self.equilibrium.powi(2) / (2.0 * self.dynamics().powi(2))
    }
}

/// Refuses what is not a positive finite number.
pub(crate) fn positive(name: &'static str, given: f64) -> Result<f64, PotentialError> {
    if given > 0.0 && given.is_finite() {
        Ok(given)
    } else {
        Err(PotentialError::NotPositive { name, given })
    }
}

/// Refuses what lies outside a range.
pub(crate) fn within(
    name: &'static str,
    given: f64,
    low: f64,
    high: f64,
) -> Result<f64, PotentialError> {
    if given >= low && given <= high {
        Ok(given)
    } else {
        Err(PotentialError::Range {
            name,
            given,
            low,
            high,
        })
    }
}

/// A distance at which every law has a finite value.
pub(crate) fn bounded(distance: f64, equilibrium: f64) -> f64 {
    if distance.is_nan() {
        f64::INFINITY
    } else {
        distance.max(0.1 * equilibrium)
    }
}

/// Where a function changes sign between two places, by bisection to the last bit.
pub(crate) fn root(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    let rising = function(high) > 0.0;
    // 1100 halvings pass every double; a bracket of two neighbours ends it long before
    for _ in 0..1100 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if (function(middle) > 0.0) == rising {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}
