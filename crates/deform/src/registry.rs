//! The models of deformation by name: what each offers to choose, and the model made of that.
//!
//! A new model is one entry in [`MODELS`]. Source: thesis 5.1.

mod options;

pub use options::{
    Boxes, Calibration, Fading, ModelOptions, Motion, OccupancyFractions, Offers, Prony, Range,
    WrongOption,
};

use thiserror::Error;

use crate::lattice::{InelasticSettings, LatticeModel, LatticeSettings};
use crate::model::DeformationModel;
use crate::particles::local_model::MOST_LAYERS;
use crate::particles::{GlobalModel, GlobalSettings, LocalModel, LocalSettings};

/// A model by the name that users write.
#[derive(Clone, Copy, Debug)]
pub struct Registered {
    /// Name in settings.
    pub name: &'static str,
    /// Title on the page.
    pub title: &'static str,
    /// Whether the model has nodes and bonds that can break; else it has particles.
    pub bonded: bool,
    /// What can be chosen of it.
    pub offers: Offers,
    /// Makes it with its default settings, but for what was chosen and is offered.
    pub make: fn(&ModelOptions) -> Box<dyn DeformationModel>,
}

impl Registered {
    /// Makes it, where it can be so.
    ///
    /// # Errors
    /// Where it does not offer what was chosen.
    pub fn with(&self, options: &ModelOptions) -> Result<Box<dyn DeformationModel>, WrongOption> {
        self.offers.check(self.name, options)?;
        Ok((self.make)(options))
    }
}

/// Options of the models with particles in a box.
const PARTICLES: Offers = Offers {
    boxes: Some(Boxes {
        least: 7,
        usual: 13,
        most: 31,
    }),
    binding: Some(OccupancyFractions {
        least: 0.0,
        usual: 0.0,
        most: 2.0,
    }),
    walls: true,
    fades: None,
    yields: None,
    layers: Some(MOST_LAYERS),
    calibration: true,
    motion: true,
    rearranges: true,
    whole_segment: false,
};

/// All models; a new one is one entry here.
pub const MODELS: &[Registered] = &[
    Registered {
        name: "lattice",
        title: "Lattice",
        bonded: true,
        offers: Offers {
            boxes: Some(Boxes {
                least: 9,
                usual: 21,
                most: 41,
            }),
            binding: None,
            walls: false,
            fades: Some(Fading {
                shares: Range {
                    least: 0.01,
                    most: 0.95,
                },
                times: Range {
                    least: 0.01,
                    most: 1000.0,
                },
            }),
            // beyond the most nothing is pressed
            yields: Some(Range {
                least: 0.005,
                most: 0.5,
            }),
            layers: None,
            calibration: false,
            motion: false,
            rearranges: false,
            whole_segment: true,
        },
        make: |options| Box::new(LatticeModel::new(LatticeSettings::from(options))),
    },
    Registered {
        name: "fcc-lj",
        title: "Particles, FCC",
        bonded: false,
        offers: PARTICLES,
        make: |options| Box::new(LocalModel::fcc_lj(LocalSettings::from(options))),
    },
    Registered {
        name: "cuboid-lj",
        title: "Particles, cuboid",
        bonded: false,
        offers: Offers {
            // FIRE needs an energy
            motion: false,
            ..PARTICLES
        },
        make: |options| Box::new(LocalModel::cuboid_lj(LocalSettings::from(options))),
    },
    Registered {
        name: "global-lj",
        title: "Particles, whole segment",
        bonded: false,
        offers: Offers {
            boxes: None,
            binding: Some(OccupancyFractions {
                least: 0.01,
                usual: 0.3,
                most: 2.0,
            }),
            walls: false,
            fades: None,
            yields: None,
            layers: None,
            calibration: true,
            motion: false,
            rearranges: false,
            whole_segment: false,
        },
        make: |options| Box::new(GlobalModel::global_lj(GlobalSettings::from(options))),
    },
];

/// A name that no model has.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("deformation model {given:?} given; allowed: {allowed}")]
pub struct UnknownModel {
    /// The name given.
    pub given: String,
    /// The names of [`MODELS`].
    pub allowed: String,
}

/// The model of a name.
///
/// # Errors
/// Where there is none.
pub fn model_from_name(name: &str) -> Result<&'static Registered, UnknownModel> {
    let known = MODELS.iter().find(|model| model.name == name);
    known.ok_or_else(|| UnknownModel {
        given: name.to_owned(),
        allowed: MODELS.iter().map(|m| m.name).collect::<Vec<_>>().join(", "),
    })
}

impl From<&ModelOptions> for LatticeSettings {
    /// The default settings, except for what is chosen.
    fn from(options: &ModelOptions) -> Self {
        let usual = Self::default();
        Self {
            nodes: options.edge.unwrap_or(usual.nodes),
            inelastic: InelasticSettings {
                yield_strain: options.yield_strain,
                prony: options.prony,
            },
            whole: options.whole_segment,
            ..usual
        }
    }
}

impl From<&ModelOptions> for LocalSettings {
    /// The default settings, except for what is chosen.
    fn from(options: &ModelOptions) -> Self {
        let usual = Self::default();
        Self {
            box_cells: options.edge.map_or(usual.box_cells, |cells| cells as i32),
            binding: options.binding.unwrap_or(usual.binding),
            walls: options.walls,
            layers: options.layers.unwrap_or(usual.layers),
            calibration: options.calibration.unwrap_or(usual.calibration),
            motion: options.motion.unwrap_or(usual.motion),
            rearranges: options.rearranges,
            ..usual
        }
    }
}

impl From<&ModelOptions> for GlobalSettings {
    /// The default settings, except for what is chosen.
    fn from(options: &ModelOptions) -> Self {
        let usual = Self::default();
        Self {
            binding: options.binding.unwrap_or(usual.binding),
            calibration: options.calibration.unwrap_or(usual.calibration),
            ..usual
        }
    }
}
