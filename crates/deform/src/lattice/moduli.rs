//! Stiffness of bonds and cells from Young's modulus and Poisson's ratio, in closed form.
//!
//! Equal springs k on the 6 face and 12 edge bonds give C11 = 3k/h and C12 = C44 = k/h: isotropic,
//! ν = 1/4, E = 2.5 k/h. A pressure λv · (J - 1) in each cell, J its volume over that at rest,
//! adds λv to C11 and C12 alike and nothing to C44, so that the sum stays isotropic:
//! μ = k/h and λ = k/h + λv.
//! Source: thesis errata, section 6.

use crate::material::Solid;

/// Poisson's ratios that the lattice holds. Below, the volume term would have to be negative;
/// above, rest is found too slowly.
pub const POISSON_RANGE: [f64; 2] = [0.25, 0.49];

/// What bonds and cells need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeModuli {
    /// Stiffness of a bond [N/mm].
    pub bond: f64,
    /// Bulk modulus that the volume term adds, λv [N/mm²].
    pub volume: f64,
    /// Poisson's ratio as used; the nearest of [`POISSON_RANGE`].
    pub poisson: f64,
}

impl LatticeModuli {
    /// Stiffness for nodes `spacing` [mm] apart.
    #[must_use]
    pub fn of(solid: &Solid, spacing: f64) -> Self {
        let [low, high] = POISSON_RANGE;
        let poisson = solid.poisson.clamp(low, high);
        let used = Solid { poisson, ..*solid };
        Self {
            bond: used.shear() * spacing,
            // 0 at 1/4 but for rounding
            volume: (used.lame() - used.shear()).max(0.0),
            poisson,
        }
    }
}
