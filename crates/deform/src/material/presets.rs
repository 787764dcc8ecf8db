//! Tissues by name, each with where its numbers come from.
//!
//! Living tissue varies by more than a factor of two between people, rates and ways to measure;
//! these are middle values for slow loading. Soft tissue is nearly incompressible (ν ≈ 0.49);
//! the presets say 0.45, since rest at 0.49 costs 2.5 times the time, but for the thesis' own.
//!
//! A number with its spread, or said to be of an abstract, was read in the paper named; one "as
//! cited" was found in works that cite that paper, and not in itself. Friction is assumed for all.
//! Densities of soft tissues: Mast, "Empirical relationships between acoustic parameters in
//! human soft tissues", ARLO 1 (2000), and the table of PMC3233242; of the lung with its blood,
//! 0.38 g/cm³: the table of PMC3859249. Those of kidney, spleen, breast, prostate, vessel wall and
//! tumour are usual figures of water-rich tissue, assumed.
//!
//! E is that of small strains. A preset stiffens with strain as far as a source has a figure: the exponent
//! is the one with which the lattice's own curve (`lattice/stiffening.rs`) is nearest to that
//! figure. Fat does not: its modulus is constant over the strains of Krouskop et al., Ultrason. Imaging
//! 20 (1998), abstract. Skin does (Ní Annaidh et al., J. Mech. Behav. Biomed. Mater. 5 (2012), abstract: from a
//! slope of 1.18 MPa to 21.6 MPa at a strain of 54 %, about an exponent of 4), and muscle (Bosboom et al.,
//! J. Biomech. 34 (2001), abstract: pressed rat muscle by Ogden's law with α = 21.4 ± 5.7, about an exponent
//! of 8 up to 30 %).

use super::{MaterialError, MaterialLaw, SolidSi};

/// A tissue that can be chosen by name.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Name of the preset in settings.
    pub name: &'static str,
    /// Where the numbers come from.
    pub source: &'static str,
    /// Young's moduli between which the sources have it, or one of their spreads around it [Pa].
    pub young_range: [f64; 2],
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
        stiffening: 0.0,
    }
}

/// The same solid, which stiffens with this exponent.
const fn stiffens(solid: SolidSi, stiffening: f64) -> SolidSi {
    SolidSi {
        stiffening,
        ..solid
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
        young_range: [5e9, 21e9],
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
        young_range: [3.4e4, 3.5e4],
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
        young_range: [3.9e3, 7.1e3],
        law: || MaterialLaw::constant(solid(5.5e3, 0.45, 1060.0, LIVER, 0.2)),
    },
    Preset {
        name: "skin",
        source: "E: Agache et al., Arch. Dermatol. Res. 269 (1980), 0.42 MPa in the young as cited, \
                 doubled with age by its abstract; fracture energy: 1.1 kJ/m² by needles, 1.7 to \
                 30 kJ/m² by scissors and tears, in the table of Chin. J. Mech. Eng. 35 (2022) 96; \
                 stiffening: Ní Annaidh et al., J. Mech. Behav. Biomed. Mater. 5 (2012), pulled, from a slope \
                 of 1.18 to 21.6 MPa at 54 % (abstract)",
        young_range: [4.2e5, 8.4e5],
        law: || MaterialLaw::constant(stiffens(solid(4.2e5, 0.45, 1090.0, 2500.0, 0.4), 4.0)),
    },
    Preset {
        name: "fat",
        source: "E: Comley & Fleck, Int. J. Solids Struct. 47 (2010), 1 to 3 kPa as cited; a shear \
                 modulus of 0.75 kPa by elastography (abstract of J. Mech. Behav. Biomed. Mater., \
                 2023, strain-dependent shear properties of adipose tissue) agrees; fracture \
                 energy: 4.1 kJ/m² in tears, in the table of Chin. J. Mech. Eng. 35 (2022) 96",
        young_range: [1.0e3, 3.0e3],
        law: || MaterialLaw::constant(solid(2.0e3, 0.45, 950.0, 4100.0, 0.2)),
    },
    Preset {
        name: "muscle",
        source: "E: Gennisson et al., Ultrasound Med. Biol. 36 (2010), at rest across the fibres \
                 (shear modulus about 4 kPa), as cited; 11.1 ± 4.1 kPa in the calf by shear waves (Arda et al., \
                 AJR 197 (2011), abstract) agrees; fracture energy: 0.55 to 8 kJ/m² in the \
                 table of Chin. J. Mech. Eng. 35 (2022) 96, their middle; stiffening: Bosboom et al., J. \
                 Biomech. 34 (2001), pressed rat muscle, Ogden's law with α = 21.4 ± 5.7 (abstract)",
        young_range: [7.0e3, 1.52e4],
        law: || MaterialLaw::constant(stiffens(solid(1.2e4, 0.45, 1050.0, 2000.0, 0.2), 8.0)),
    },
    Preset {
        name: "cartilage",
        source: "E and ν: Athanasiou et al., J. Orthop. Res. 9 (1991), in equilibrium (human knee), \
                 0.53 to 0.70 MPa, as cited; fracture energy: 0.14 to 1.2 kJ/m², Chin-Purcell & Lewis, J. Biomech. \
                 Eng. 118 (1996), as cited",
        young_range: [5.3e5, 7.0e5],
        law: || MaterialLaw::constant(solid(6.0e5, 0.25, 1100.0, 500.0, 0.02)),
    },
    Preset {
        name: "brain",
        source: "E: Budday et al., J. Mech. Behav. Biomed. Mater. 46 (2015), indentation of white \
                 and grey matter, 1.4 to 1.9 kPa, as cited; fracture energy: assumed",
        young_range: [1.4e3, 1.9e3],
        law: || MaterialLaw::constant(solid(1.7e3, 0.45, 1040.0, 10.0, 0.1)),
    },
    Preset {
        name: "kidney",
        source: "E: Arda et al., AJR 197 (2011), shear waves in 127 healthy people, 5.0 ± 2.9 kPa in the \
                 cortex (abstract); fracture energy: that of liver, assumed",
        young_range: [2.1e3, 7.9e3],
        law: || MaterialLaw::constant(solid(5.0e3, 0.45, 1050.0, LIVER, 0.2)),
    },
    Preset {
        name: "spleen",
        source: "E: Arda et al., AJR 197 (2011), shear waves in 127 healthy people, 2.9 ± 1.8 kPa \
                 (abstract); other devices have 19 to 23 kPa (Viceconti et al., World J. Radiol. 17 \
                 (2025), abstract); fracture energy: that of liver, assumed",
        young_range: [1.1e3, 2.3e4],
        law: || MaterialLaw::constant(solid(2.9e3, 0.45, 1050.0, LIVER, 0.2)),
    },
    Preset {
        name: "breast",
        source: "E: Samani et al., Phys. Med. Biol. 52 (2007), gland as soft as fat, 3.2 kPa as cited; \
                 3.2 ± 0.4 to 8.8 ± 1.1 kPa by indentation (Teixeira et al., 2023, Computer Methods, \
                 Imaging and Visualization in Biomechanics II, abstract); stiffening: gland an order of magnitude \
                 stiffer at high strain (Krouskop et al., Ultrason. Imaging 20 (1998), abstract), which \
                 is taken as 20 %; fracture energy: assumed",
        young_range: [2.8e3, 9.9e3],
        law: || MaterialLaw::constant(stiffens(solid(3.2e3, 0.45, 1020.0, 500.0, 0.2), 8.0)),
    },
    Preset {
        name: "prostate",
        source: "E: Urology 76 (2010) 1007, indentation of 46 prostates, 17.0 ± 9.0 kPa without cancer \
                 (abstract); fracture energy: assumed",
        young_range: [8.0e3, 2.6e4],
        law: || MaterialLaw::constant(solid(1.7e4, 0.45, 1045.0, 500.0, 0.2)),
    },
    Preset {
        name: "vessel-wall",
        source: "E: Hemmasizadeh et al., J. Mech. Behav. Biomed. Mater. 15 (2012), indentation of pig \
                 aortas, 60.3 ± 1.7 kPa inside and 70.3 ± 2.5 kPa outside (abstract); fracture energy: \
                 290 ± 110 J/m² by blades, 1.7 kJ/m² in tears, in the table of Chin. J. Mech. Eng. 35 \
                 (2022) 96",
        young_range: [5.8e4, 7.3e4],
        law: || MaterialLaw::constant(solid(6.5e4, 0.45, 1050.0, 290.0, 0.1)),
    },
    Preset {
        name: "lung",
        source: "E and ν: Lai-Fook et al., J. Appl. Physiol. 40 (1976), dogs, 1.5 to 2 times the \
                 pressure of inflation, ν 0.43 (abstract); here for 0.5 kPa, with 0.3 to 1.5 kPa as \
                 range; fracture energy: assumed",
        young_range: [4.5e2, 3.0e3],
        law: || MaterialLaw::constant(solid(9.0e2, 0.43, 380.0, 100.0, 0.2)),
    },
    Preset {
        name: "tumour",
        source: "E: Samani et al., Phys. Med. Biol. 52 (2007), high-grade ductal carcinoma of the breast, \
                 13 times as stiff as the gland around it, 3 to 6 times for other malignant tumours \
                 (abstract), of 3.2 kPa; cancer of the prostate 24.1 ± 14.5 kPa (Urology 76 (2010) \
                 1007, abstract); fracture energy: assumed",
        young_range: [9.6e3, 4.2e4],
        law: || MaterialLaw::constant(solid(4.2e4, 0.45, 1050.0, 500.0, 0.2)),
    },
    Preset {
        name: "cortical-bone",
        source: "E: Rho et al., J. Biomech. 26 (1993), 18.6 ± 3.5 GPa in tension, as cited; fracture \
                 energy: 0.82 to 1.15 kJ/m² by the abstract of ESDA2004, p. 527 (ASME, 2004)",
        young_range: [15.1e9, 22.1e9],
        law: || MaterialLaw::constant(solid(18.6e9, 0.30, 1900.0, CORTICAL, 0.3)),
    },
    Preset {
        name: "trabecular-bone",
        source: "E = 6.85 GPa · ρ^1.49, femoral neck: Morgan et al., J. Biomech. 36 (2003), as cited; \
                 powers of 1.49 to 2.18 by its abstract; density 0.1 to 1.2 g/cm³ over 0 to 1000 \
                 HU: Rho et al., Med. Eng. Phys. 17 (1995), rounded, as cited; fracture \
                 energy: assumed",
        young_range: [2.2e8, 9.0e9],
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
