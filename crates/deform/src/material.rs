//! Elastic constants of tissue: SI comes in here, and mm, N and kg go on.
//!
//! Constants of a tissue are given in Pa and kg/m³ ([`SolidSi`]), as books and people write
//! them, and are checked and converted in [`SolidSi::checked`] alone. A [`MaterialLaw`] gives
//! them for a voxel, from constants or from its intensity.
//!
//! Source: thesis 5.14, 5.15, 5.28.3; expression 5.54. Thesis errata, section 3: density alone
//! changes no force at rest, so that Young's modulus follows the intensity too.

mod presets;

pub use presets::{PRESETS, Preset, preset};

use std::sync::Arc;

use palpate_volume::clip::ClipMask;
use palpate_volume::edit::SegmentId;
use palpate_volume::voxel_box::VoxelBox;
use thiserror::Error;

/// Moduli that make sense [Pa], from mucus to diamond.
const YOUNG_LIMITS: [f64; 2] = [1.0, 2e12];
/// Densities that make sense [kg/m³], from gas to osmium.
const DENSITY_LIMITS: [f64; 2] = [0.1, 23_000.0];
/// Strain stiffening that makes sense; with more, a strain of 2 % would already be the last that is soft.
const STIFFENING_LIMITS: [f64; 2] = [0.0, 100.0];
/// N/mm² in a Pa.
const MEGAPASCAL: f64 = 1e-6;
/// kg/mm³ in a kg/m³.
const PER_CUBIC_MILLIMETRE: f64 = 1e-9;
/// 1 J/m² in N·mm/mm².
const JOULE_PER_SQUARE_METRE: f64 = 1e-3;

/// Constants that no matter has.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum MaterialError {
    /// Young's modulus.
    #[error("Young's modulus {0} Pa given; allowed: {low} to {high} Pa", low = YOUNG_LIMITS[0], high = YOUNG_LIMITS[1])]
    Young(f64),
    /// Poisson's ratio.
    #[error("Poisson's ratio {0} given; allowed: above -1 and below 0.5")]
    Poisson(f64),
    /// Density.
    #[error("density {0} kg/m³ given; allowed: {low} to {high} kg/m³", low = DENSITY_LIMITS[0], high = DENSITY_LIMITS[1])]
    Density(f64),
    /// Energy that a crack takes.
    #[error(
        "fracture energy {0} J/m² given; allowed: above 0, infinity for matter that never tears"
    )]
    FractureEnergy(f64),
    /// Friction.
    #[error("friction {0} given; allowed: 0 to 10")]
    Friction(f64),
    /// Strain stiffening.
    #[error("strain stiffening {0} given; allowed: {low} to {high}", low = STIFFENING_LIMITS[0], high = STIFFENING_LIMITS[1])]
    Stiffening(f64),
    /// An interval of intensities without width.
    #[error("intensities from {0} to {1} given; allowed: finite, the second one larger")]
    Interval(f64, f64),
    /// A power law that gives no modulus.
    #[error("power law {coefficient} Pa · ρ^{exponent} given; allowed: both above 0 and finite")]
    PowerLaw {
        /// Modulus at 1 g/cm³ [Pa].
        coefficient: f64,
        /// Exponent of the density.
        exponent: f64,
    },
    /// There is no such preset.
    #[error("this material is unknown; allowed: the names of `PRESETS`")]
    UnknownPreset,
}

/// Constants of an isotropic solid as people give them, in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidSi {
    /// Young's modulus E [Pa].
    pub young: f64,
    /// Poisson's ratio ν.
    pub poisson: f64,
    /// Density ρ [kg/m³].
    pub density: f64,
    /// Energy that a crack takes for its area [J/m²]; infinity where none opens.
    pub fracture_energy: f64,
    /// Coulomb friction with a tool.
    pub friction: f64,
    /// Strain stiffening: the exponent b of exp(b (I₁ − 3)), with which shear grows; 0 for none.
    pub stiffening: f64,
}

impl SolidSi {
    /// Checks them and takes them to mm, N and kg: the one place where this is done.
    ///
    /// # Errors
    /// Where a constant is one that no matter has.
    pub fn checked(&self) -> Result<Solid, MaterialError> {
        let within = |value: f64, [low, high]: [f64; 2]| value >= low && value <= high;
        if !within(self.young, YOUNG_LIMITS) {
            return Err(MaterialError::Young(self.young));
        }
        // written so that NaN is refused
        if !(self.poisson > -1.0 && self.poisson < 0.5) {
            return Err(MaterialError::Poisson(self.poisson));
        }
        if !within(self.density, DENSITY_LIMITS) {
            return Err(MaterialError::Density(self.density));
        }
        if self.fracture_energy.is_nan() || self.fracture_energy <= 0.0 {
            return Err(MaterialError::FractureEnergy(self.fracture_energy));
        }
        if !within(self.friction, [0.0, 10.0]) {
            return Err(MaterialError::Friction(self.friction));
        }
        if !within(self.stiffening, STIFFENING_LIMITS) {
            return Err(MaterialError::Stiffening(self.stiffening));
        }
        Ok(Solid {
            young: self.young * MEGAPASCAL,
            poisson: self.poisson,
            density: self.density * PER_CUBIC_MILLIMETRE,
            fracture_energy: self.fracture_energy * JOULE_PER_SQUARE_METRE,
            friction: self.friction,
            stiffening: self.stiffening,
        })
    }
}

/// Checked constants of an isotropic solid in mm, N and kg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Young's modulus E [N/mm²].
    pub young: f64,
    /// Poisson's ratio ν.
    pub poisson: f64,
    /// Density ρ [kg/mm³].
    pub density: f64,
    /// Energy that a crack takes for its area [N·mm/mm²]; infinity where none opens.
    pub fracture_energy: f64,
    /// Coulomb friction with a tool.
    pub friction: f64,
    /// Strain stiffening: the exponent b of exp(b (I₁ − 3)), with which shear grows; 0 for none.
    pub stiffening: f64,
}

impl Solid {
    /// The same constants in SI, as people write them.
    #[must_use]
    pub fn si(&self) -> SolidSi {
        SolidSi {
            young: self.young / MEGAPASCAL,
            poisson: self.poisson,
            density: self.density / PER_CUBIC_MILLIMETRE,
            fracture_energy: self.fracture_energy / JOULE_PER_SQUARE_METRE,
            friction: self.friction,
            stiffening: self.stiffening,
        }
    }

    /// Lamé's first parameter λ [N/mm²]. Source: thesis 5.46.
    #[must_use]
    pub fn lame(&self) -> f64 {
        self.young * self.poisson / ((1.0 + self.poisson) * (1.0 - 2.0 * self.poisson))
    }

    /// Shear modulus μ [N/mm²]. Source: thesis 5.47.
    #[must_use]
    pub fn shear(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// The solid between two, each constant at `share` of the way.
    fn between(low: &Self, high: &Self, share: f64) -> Self {
        // a share of infinity would be NaN at the ends
        let mix = |a: f64, b: f64| match share {
            _ if a == b || share <= 0.0 => a,
            _ if share >= 1.0 => b,
            _ if a.is_infinite() || b.is_infinite() => f64::INFINITY,
            _ => a + share * (b - a),
        };
        Self {
            young: mix(low.young, high.young),
            poisson: mix(low.poisson, high.poisson),
            density: mix(low.density, high.density),
            fracture_energy: mix(low.fracture_energy, high.fracture_energy),
            friction: mix(low.friction, high.friction),
            stiffening: mix(low.stiffening, high.stiffening),
        }
    }
}

/// How constants follow the intensity of a voxel. Made by the functions that check them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaterialLaw {
    /// The same constants at every intensity, as for MR scans.
    Constant(Solid),
    /// Each constant linear in HU between two solids, held at its ends (thesis 5.54).
    Linear {
        /// HU of `low` and of `high`.
        interval: [f64; 2],
        /// Constants at the lower end of the range.
        low: Solid,
        /// Constants at the upper end of the range.
        high: Solid,
    },
    /// E = coefficient · ρ^exponent, with the density linear in HU and held at its ends.
    Power {
        /// HU of the two densities.
        interval: [f64; 2],
        /// Apparent densities at the two ends [kg/mm³].
        density: [f64; 2],
        /// Modulus at 1 g/cm³ [N/mm²].
        coefficient: f64,
        /// Exponent of the density in g/cm³.
        exponent: f64,
        /// The constants that do not follow the density.
        other: Solid,
    },
}

impl MaterialLaw {
    /// The same constants everywhere.
    ///
    /// # Errors
    /// Where no matter has them.
    pub fn constant(solid: SolidSi) -> Result<Self, MaterialError> {
        Ok(Self::Constant(solid.checked()?))
    }

    /// Constants linear in HU (thesis 5.54, for E, ν and ρ alike).
    ///
    /// # Errors
    /// Where the interval is none or no matter has the constants.
    pub fn linear(interval: [f64; 2], low: SolidSi, high: SolidSi) -> Result<Self, MaterialError> {
        check_interval(interval)?;
        Ok(Self::Linear {
            interval,
            low: low.checked()?,
            high: high.checked()?,
        })
    }

    /// E by a power of the apparent density: `coefficient` [Pa at 1 g/cm³], `density` [kg/m³]
    /// at the ends of the interval of HU; `other` gives ν, fracture energy, friction and stiffening.
    ///
    /// # Errors
    /// Where the interval or the law is none, or no matter has the constants at its ends.
    pub fn power(
        interval: [f64; 2],
        density: [f64; 2],
        coefficient: f64,
        exponent: f64,
        other: SolidSi,
    ) -> Result<Self, MaterialError> {
        check_interval(interval)?;
        let positive = |value: f64| value > 0.0 && value.is_finite();
        if !(positive(coefficient) && positive(exponent)) {
            return Err(MaterialError::PowerLaw {
                coefficient,
                exponent,
            });
        }
        for density in density {
            let young = coefficient * (density * 1e-3).powf(exponent);
            let end = SolidSi {
                young,
                density,
                ..other
            };
            end.checked()?;
        }
        Ok(Self::Power {
            interval,
            density: density.map(|density| density * PER_CUBIC_MILLIMETRE),
            coefficient: coefficient * MEGAPASCAL,
            exponent,
            other: other.checked()?,
        })
    }

    /// The solid of a voxel of this intensity [HU]; outside its interval, and for NaN, that
    /// of the nearer end (for NaN, of the lower).
    #[must_use]
    pub fn at(&self, hounsfield: f64) -> Solid {
        match self {
            Self::Constant(solid) => *solid,
            Self::Linear {
                interval,
                low,
                high,
            } => Solid::between(low, high, share(*interval, hounsfield)),
            Self::Power {
                interval,
                density: [low, high],
                coefficient,
                exponent,
                other,
            } => {
                let density = low + share(*interval, hounsfield) * (high - low);
                let grams_per_cubic_centimetre = density * 1e6;
                Solid {
                    young: coefficient * grams_per_cubic_centimetre.powf(*exponent),
                    density,
                    ..*other
                }
            }
        }
    }

    /// The solids at the two ends of its interval of HU; the same twice where it has none.
    #[must_use]
    pub fn ends(&self) -> [Solid; 2] {
        [f64::NEG_INFINITY, f64::INFINITY].map(|hounsfield| self.at(hounsfield))
    }

    /// Coulomb friction of a surface of it, which has one for all of its voxels: the mean of its ends.
    #[must_use]
    pub fn friction(&self) -> f64 {
        let [low, high] = self.ends().map(|solid| solid.friction);
        0.5 * (low + high)
    }

    /// Whether it reads intensities as HU; such a law is for CT only.
    #[must_use]
    pub fn needs_hounsfield(&self) -> bool {
        !matches!(self, Self::Constant(_))
    }
}

/// Where a value lies in an interval, held at its ends; 0 for NaN.
#[expect(clippy::manual_clamp, reason = "clamp would hand NaN on")]
fn share([low, high]: [f64; 2], value: f64) -> f64 {
    ((value - low) / (high - low)).max(0.0).min(1.0)
}

fn check_interval([low, high]: [f64; 2]) -> Result<(), MaterialError> {
    let allowed = low.is_finite() && high.is_finite() && low < high;
    allowed
        .then_some(())
        .ok_or(MaterialError::Interval(low, high))
}

/// Stiffness of two half bonds in series: their harmonic mean, 0 where one is 0.
///
/// Source: thesis errata, section 3; expression 5.57 takes the arithmetic mean, which makes an
/// interface of bone and soft tissue half as stiff as bone.
#[must_use]
pub fn pair_stiffness(first: f64, second: f64) -> f64 {
    let sum = first + second;
    if sum > 0.0 {
        2.0 * first * (second / sum)
    } else {
        0.0
    }
}

/// Part that tissue takes in the deformation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Treatment {
    /// It deforms.
    #[default]
    Deformable,
    /// It is rigid: it stays where it is and holds what is bonded to it.
    Rigid,
    /// It is ignored, like empty space.
    Empty,
}

/// Some of a segment's voxels.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// The whole segment.
    Whole,
    /// What lies in a box of voxels.
    Within(VoxelBox),
    /// What belongs to another segment too.
    Shared(SegmentId),
    /// What is cut away of the scan.
    CutAway(Arc<ClipMask>),
}

/// What one segment is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentMaterial {
    /// Which one.
    pub segment: SegmentId,
    /// Law of its elastic constants.
    pub law: MaterialLaw,
    /// How its regions take part; of several that hold a voxel the last counts, and what is in none
    /// is deformable.
    pub regions: Vec<(Region, Treatment)>,
}

/// What the segments of a scan are made of. Where a voxel belongs to several, the last counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Materials {
    /// One for each segment that takes part; all others are as if empty.
    pub segments: Vec<SegmentMaterial>,
}
