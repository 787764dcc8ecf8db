//! What can be chosen of a model beside its name, what each model offers, and what is refused.
//!
//! Source: thesis 5.9 (box), 5.12 (binding), 5.13 (walls), 5.14 (calibration), 5.17 (motion),
//! 5.21 (layers); errata, sections 6 and 7 (what yields and fades).

use thiserror::Error;

pub use crate::lattice::Prony;
pub use crate::particles::Motion;
pub use crate::particles::calibration::Calibration;

/// Options of a model; what is none has its default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelOptions {
    /// Nodes or cells along each edge of its box.
    pub edge: Option<u32>,
    /// Springs to the initial positions, as a share of a link's stiffness (5.12).
    pub binding: Option<f64>,
    /// Whether particles are kept out of empty voxels (5.13).
    pub walls: bool,
    /// Force that fades while tissue is held; none for elastic tissue.
    pub prony: Option<Prony>,
    /// Strain from which on tissue stays as it is pressed; none where it comes back.
    pub yield_strain: Option<f64>,
    /// Parts of the work of an answer, from the tool outward (5.21).
    pub layers: Option<u32>,
    /// Rule by which the stiffness of particles follows from the material.
    pub calibration: Option<Calibration>,
    /// Method by which particles come to rest.
    pub motion: Option<Motion>,
    /// Whether particles stay where a tool has pushed them (5.28.3); else all of them come back.
    pub rearranges: bool,
    /// Whether the body behind the box gives as the whole segment does (5.29).
    pub whole_segment: bool,
}

/// Options that a model offers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Offers {
    /// Boxes; none where it has no box.
    pub boxes: Option<Boxes>,
    /// Range of the binding stiffness; none where particles are not bound.
    pub binding: Option<OccupancyFractions>,
    /// Whether particles can be kept out of empty voxels.
    pub walls: bool,
    /// Ranges of stress relaxation; none where the force cannot fade.
    pub fades: Option<Fading>,
    /// Strains from which on its tissue can stay as it is pressed; none where it always comes back.
    pub yields: Option<Range>,
    /// Layers at most, one is usual; none where its work is not parted.
    pub layers: Option<u32>,
    /// Whether calibrations can be chosen.
    pub calibration: bool,
    /// Whether motions can be chosen.
    pub motion: bool,
    /// Whether its particles can stay where a tool has pushed them.
    pub rearranges: bool,
    /// Whether the whole segment can be behind the box.
    pub whole_segment: bool,
}

/// Boxes of a model that moves with the tool, by the nodes or cells along each edge: odd.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Boxes {
    /// Fewest.
    pub least: u32,
    /// Number in the default settings.
    pub usual: u32,
    /// Most.
    pub most: u32,
}

/// Range of a ratio, with its default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OccupancyFractions {
    /// Least.
    pub least: f64,
    /// Value in the default settings.
    pub usual: f64,
    /// Most.
    pub most: f64,
}

/// Range of an option that is off by default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least.
    pub least: f64,
    /// Most.
    pub most: f64,
}

/// Ranges of stress relaxation (Prony).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fading {
    /// Fraction of the force that fades, within 0 to 1.
    pub shares: Range,
    /// Time constants [s].
    pub times: Range,
}

impl Offers {
    /// Refuses what the model of this name does not offer.
    ///
    /// # Errors
    /// Names the option, what was given and what is allowed.
    pub fn check(&self, name: &'static str, options: &ModelOptions) -> Result<(), WrongOption> {
        if let Some(edge) = options.edge {
            self.check_edge(name, edge)?;
        }
        if let Some(binding) = options.binding {
            let Some(OccupancyFractions { least, most, .. }) = self.binding else {
                return Err(not_offered(name, "binding"));
            };
            check_within(name, "binding", "", binding, Range { least, most })?;
        }
        if let Some(Prony { share, time }) = options.prony {
            let Some(Fading { shares, times }) = self.fades else {
                return Err(not_offered(name, "a force that fades"));
            };
            check_within(name, "a share that fades", "", share, shares)?;
            check_within(name, "a time of fading", " s", time, times)?;
        }
        if let Some(strain) = options.yield_strain {
            let Some(strains) = self.yields else {
                return Err(not_offered(name, "a yield strain"));
            };
            check_within(name, "a yield strain", "", strain, strains)?;
        }
        self.check_particles(name, options)
    }

    fn check_particles(
        &self,
        name: &'static str,
        options: &ModelOptions,
    ) -> Result<(), WrongOption> {
        if let Some(layers) = options.layers {
            let most = self.layers.ok_or(not_offered(name, "layers"))?;
            let range = Range {
                least: 1.0,
                most: f64::from(most),
            };
            check_within(name, "layers", "", f64::from(layers), range)?;
        }
        let chosen = [
            ("walls", options.walls, self.walls),
            (
                "calibration",
                options.calibration.is_some(),
                self.calibration,
            ),
            ("motion", options.motion.is_some(), self.motion),
            ("rearrangement", options.rearranges, self.rearranges),
            (
                "the whole segment",
                options.whole_segment,
                self.whole_segment,
            ),
        ];
        match chosen.iter().find(|(_, is, may)| *is && !*may) {
            Some((option, ..)) => Err(not_offered(name, option)),
            None => Ok(()),
        }
    }

    fn check_edge(&self, name: &'static str, edge: u32) -> Result<(), WrongOption> {
        let Boxes { least, most, .. } = self.boxes.ok_or(WrongOption::NoBox { name })?;
        if edge.is_multiple_of(2) || !(least..=most).contains(&edge) {
            return Err(WrongOption::Edge {
                name,
                edge,
                least,
                most,
            });
        }
        Ok(())
    }
}

fn not_offered(name: &'static str, option: &'static str) -> WrongOption {
    WrongOption::NotOffered { name, option }
}

fn check_within(
    name: &'static str,
    option: &'static str,
    unit: &'static str,
    given: f64,
    Range { least, most }: Range,
) -> Result<(), WrongOption> {
    // NaN is in no range
    if (least..=most).contains(&given) {
        return Ok(());
    }
    Err(WrongOption::Number {
        name,
        option,
        unit,
        given,
        least,
        most,
    })
}

/// Why options are refused.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum WrongOption {
    /// The model has no box.
    #[error("a box given for {name}; allowed: none, it takes all matter")]
    NoBox {
        /// The model.
        name: &'static str,
    },
    /// The box cannot have this size.
    #[error("a box of {edge} along each edge given for {name}; allowed: odd, {least} to {most}")]
    Edge {
        /// The model.
        name: &'static str,
        /// The value given.
        edge: u32,
        /// Fewest.
        least: u32,
        /// Most.
        most: u32,
    },
    /// The model has no such option.
    #[error("{option} given for {name}; allowed: none, this model has no such option")]
    NotOffered {
        /// The model.
        name: &'static str,
        /// What was asked of it.
        option: &'static str,
    },
    /// A number that is out of range or not a number.
    #[error("{option} of {given}{unit} given for {name}; allowed: {least} to {most}{unit}")]
    Number {
        /// The model.
        name: &'static str,
        /// What was asked of it.
        option: &'static str,
        /// Unit of the number, with a space before it.
        unit: &'static str,
        /// The value given.
        given: f64,
        /// Least.
        least: f64,
        /// Most.
        most: f64,
    },
}
