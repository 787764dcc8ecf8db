//! A model that lies: to it all tissue is air, and what is hard must push back all the same.

use glam::{DMat3, DVec3};
use palpate_deform::model::{DeformationModel, ModelAnswer, ModelInput, ToolContact, ToolState};
use palpate_volume::material::LocalContact;

/// Nothing pushes any tool, nowhere.
#[derive(Debug)]
pub struct Air;

impl DeformationModel for Air {
    fn advance(&mut self, input: &ModelInput<'_>) -> ModelAnswer {
        let nothing = |tool: &ToolState| ToolContact {
            tool: tool.id,
            contact: Some(LocalContact {
                position: tool.position,
                force: DVec3::ZERO,
                stiffness: DMat3::ZERO,
                validity: 100.0,
            }),
        };
        ModelAnswer {
            contacts: input.tools.iter().map(nothing).collect(),
            ..ModelAnswer::default()
        }
    }

    fn reset(&mut self) {}
}
