//! The bonded lattice: the default model.

use crate::model::{DeformationModel, ModelAnswer, ModelInput};

/// The bonded lattice as a model.
#[derive(Debug, Default)]
pub struct LatticeModel {}

impl DeformationModel for LatticeModel {
    fn advance(&mut self, _input: &ModelInput<'_>) -> ModelAnswer {
        ModelAnswer::default()
    }

    fn reset(&mut self) {}
}
