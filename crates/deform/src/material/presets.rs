//! Tissues by name, each with where its numbers come from.
//!
//! Living tissue varies by more than a factor of two between people, rates and ways to measure;
//! these are middle values for slow loading. Soft tissue is nearly incompressible (ν ≈ 0.49);
//! the presets say 0.45, the highest that the lattice holds, but for the thesis' own.
//!
//! A number with its spread, or said to be of an abstract, was read in the paper named; one "as
//! cited" was found in works that cite that paper, and not in itself. Friction is assumed for all.
//! Densities of soft tissues: Mast, "Empirical relationships between acoustic parameters in
//! human soft tissues", ARLO 1 (2000), and the table of PMC3233242.

use super::{MaterialError, MaterialLaw, SolidSi};

/// A tissue that can be chosen by name.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Name of the preset in settings.
    pub name: &'static str,
    /// Where the numbers come from.
    pub source: &'static str,
    law: fn() -> Result<MaterialLaw, MaterialError>,
}

impl Preset {
    /// Its constants.
    ///
    /// # Errors
    /// Never for those of [`PRESETS`]; a test holds that.
    pub fn law(&self) -> Result<MaterialLaw, MaterialError> {
        (self.law)()
    }
}

/// The preset of a name.
///
/// # Errors
/// Where there is none.
pub fn preset(name: &str) -> Result<&'static Preset, MaterialError> {
    let known = PRESETS.iter().find(|preset| preset.name == name);
    known.ok_or(MaterialError::UnknownPreset)
}

const fn solid(
    young: f64,
    poisson: f64,
    density: f64,
    fracture_energy: f64,
    friction: f64,
) -> SolidSi {
    SolidSi {
        young,
        poisson,
        density,
        fracture_energy,
        friction,
    }
}

/// Fracture energies that several presets share [J/m²].
const LIVER: f64 = 164.0;
const CORTICAL: f64 = 1000.0;

/// All presets.
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "thesis-bone",
        source: "thesis 5.28.3; fracture energy: that of cortical bone",
        law: || {
            MaterialLaw::linear(
                [700.0, 3000.0],
                solid(5e9, 0.30, 920.0, CORTICAL, 0.3),
                solid(21e9, 0.32, 1900.0, CORTICAL, 0.3),
            )
        },
    },
    Preset {
        name: "thesis-soft-tissue",
        source: "thesis 5.28.3; fracture energy: that of liver",
        law: || {
            MaterialLaw::linear(
                [10.0, 60.0],
                solid(3.4e4, 0.47, 1100.0, LIVER, 0.2),
                solid(3.5e4, 0.48, 1200.0, LIVER, 0.2),
            )
        },
    },
    Preset {
        name: "liver",
        source: "E: Roulot et al., J. Hepatol. 48 (2008), 5.49 ± 1.59 kPa in healthy people; fracture \
                 energy: Gokgol et al., Med. Eng. Phys. 34 (2012), 164 ± 6 J/m², needles in bovine liver",
        law: || MaterialLaw::constant(solid(5.5e3, 0.45, 1060.0, LIVER, 0.2)),
    },
    Preset {
        name: "skin",
        source: "E: Agache et al., Arch. Dermatol. Res. 269 (1980), 0.42 MPa in the young as cited, \
                 doubled with age by its abstract; fracture energy: 1.1 kJ/m² by needles, 1.7 to \
                 30 kJ/m² by scissors and tears, in the table of Chin. J. Mech. Eng. 35 (2022) 96",
        law: || MaterialLaw::constant(solid(4.2e5, 0.45, 1090.0, 2500.0, 0.4)),
    },
    Preset {
        name: "fat",
        source: "E: Comley & Fleck, Int. J. Solids Struct. 47 (2010), 1 to 3 kPa as cited; a shear \
                 modulus of 0.75 kPa by elastography (abstract of J. Mech. Behav. Biomed. Mater., \
                 2023, strain-dependent shear properties of adipose tissue) agrees; fracture \
                 energy: 4.1 kJ/m² in tears, in the table of Chin. J. Mech. Eng. 35 (2022) 96",
        law: || MaterialLaw::constant(solid(2.0e3, 0.45, 950.0, 4100.0, 0.2)),
    },
    Preset {
        name: "muscle",
        source: "E: Gennisson et al., Ultrasound Med. Biol. 36 (2010), at rest across the fibres \
                 (shear modulus about 4 kPa), as cited; fracture energy: 0.55 to 8 kJ/m² in the \
                 table of Chin. J. Mech. Eng. 35 (2022) 96, their middle",
        law: || MaterialLaw::constant(solid(1.2e4, 0.45, 1050.0, 2000.0, 0.2)),
    },
    Preset {
        name: "cartilage",
        source: "E and ν: Athanasiou et al., J. Orthop. Res. 9 (1991), in equilibrium (human knee), \
                 as cited; fracture energy: 0.14 to 1.2 kJ/m², Chin-Purcell & Lewis, J. Biomech. \
                 Eng. 118 (1996), as cited",
        law: || MaterialLaw::constant(solid(6.0e5, 0.25, 1100.0, 500.0, 0.02)),
    },
    Preset {
        name: "brain",
        source: "E: Budday et al., J. Mech. Behav. Biomed. Mater. 46 (2015), indentation of white \
                 and grey matter, 1.4 to 1.9 kPa, as cited; fracture energy: assumed",
        law: || MaterialLaw::constant(solid(1.7e3, 0.45, 1040.0, 10.0, 0.1)),
    },
    Preset {
        name: "cortical-bone",
        source: "E: Rho et al., J. Biomech. 26 (1993), 18.6 GPa in tension, as cited; fracture \
                 energy: 0.82 to 1.15 kJ/m² by the abstract of ESDA2004, p. 527 (ASME, 2004)",
        law: || MaterialLaw::constant(solid(18.6e9, 0.30, 1900.0, CORTICAL, 0.3)),
    },
    Preset {
        name: "trabecular-bone",
        source: "E = 6.85 GPa · ρ^1.49, femoral neck: Morgan et al., J. Biomech. 36 (2003), as cited; \
                 powers of 1.49 to 2.18 by its abstract; density 0.1 to 1.2 g/cm³ over 0 to 1000 \
                 HU: Rho et al., Med. Eng. Phys. 17 (1995), rounded, as cited; fracture \
                 energy: assumed",
        law: || {
            MaterialLaw::power(
                [0.0, 1000.0],
                [100.0, 1200.0],
                6.85e9,
                1.49,
                solid(1e9, 0.30, 1000.0, 300.0, 0.3),
            )
        },
    },
];
