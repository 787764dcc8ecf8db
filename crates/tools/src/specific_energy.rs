//! How much work it takes to turn a mm³ of a tissue into chips, by what the scan says of it.
//!
//! **Cortical bone: 1300 N/mm²** (= 1.3 J/mm³). From the torques T and thrusts F of a 3.2 mm
//! twist drill in human femurs, fed at 120 mm/min (MacAvelia et al., "Biomechanical
//! measurements of surgical drilling force and torque in human versus artificial femurs",
//! J. Biomech. Eng. 134 (2012)): work per volume is 2π T / (feed per turn · area) + F / area,
//! with the printed figures 1240, 1310 and 1390 N/mm² at 1000, 1250 and 1500 turns/min.
//!
//! **Other densities: in proportion.** Apparent density ρ = 131 + 1.067 HU [kg/m³] (Rho,
//! Hobatho & Ashman, "Relations of mechanical properties to density and CT numbers in human
//! bone", Med. Eng. Phys. 17 (1995), proximal femur). The proportion is an assumption: a
//! straight line through no bone, no work.
//!
//! Units: N/mm², that is N·mm of work per mm³, or J/cm³.

/// Work per volume of cortical bone [N/mm²].
pub const CORTICAL: f64 = 1300.0;
/// Density of cortical bone [kg/m³].
const CORTICAL_DENSITY: f64 = 1900.0;
/// Density of bone where the scan reads 0 HU [kg/m³].
const DENSITY_AT_WATER: f64 = 131.0;
/// Rise of the density [kg/m³ per HU].
const DENSITY_PER_HU: f64 = 1.067;
/// Density of the lightest tissue that takes work [kg/m³]: the line falls below zero where a
/// scan reads less than fat, and nothing may be free of charge.
const LEAST_DENSITY: f64 = 20.0;

/// What the work per volume follows from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpecificEnergy {
    /// Bone, by the Hounsfield units of each voxel: for CT.
    OfBone,
    /// The same energy everywhere [N/mm²]: for scans whose values are not densities.
    Everywhere(f64),
}

impl SpecificEnergy {
    /// Work per volume [N/mm²] where the scan reads `value`; above zero.
    #[must_use]
    pub fn at(&self, value: f64) -> f64 {
        match self {
            Self::OfBone => {
                let density = DENSITY_AT_WATER + DENSITY_PER_HU * value;
                CORTICAL * density.max(LEAST_DENSITY) / CORTICAL_DENSITY
            }
            Self::Everywhere(energy) => *energy,
        }
    }
}
