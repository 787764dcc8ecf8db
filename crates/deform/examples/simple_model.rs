//! A model of deformation in a few lines: each voxel is a spring of its own.
//!
//! Frame: patient [mm]. `docs/algorithms/adding-a-model.md` shows this file.

use glam::{DMat3, DVec3, IVec3};
use palpate_deform::model::{DeformationModel, ModelAnswer, ModelInput, ToolContact, ToolState};
use palpate_volume::material::LocalContact;
use palpate_volume::voxel_box::VoxelBox;

/// A ball is pushed out of each voxel whose middle is in it, by the stiffness of that voxel.
#[derive(Debug, Default)]
pub struct Springs;

impl DeformationModel for Springs {
    fn advance(&mut self, input: &ModelInput<'_>) -> ModelAnswer {
        let feel = |tool: &ToolState| ToolContact {
            tool: tool.id,
            contact: tool.is_usable().then(|| contact(input, tool)).flatten(),
        };
        ModelAnswer {
            contacts: input.tools.iter().map(feel).collect(),
            ..ModelAnswer::default()
        }
    }

    // it has no memory
    fn reset(&mut self) {}
}

fn contact(input: &ModelInput<'_>, tool: &ToolState) -> Option<LocalContact> {
    let grid = input.voxels.grid();
    let radius = tool.shape.half_axes().max_element();
    let centre = grid.grid_from_patient().transform_point3(tool.position);
    let [low, high] = [-radius, radius].map(|way| (centre + way / grid.spacing()).as_ivec3());
    let (mut force, mut stiffness) = (DVec3::ZERO, DMat3::ZERO);
    for voxel in VoxelBox::new(low, high + 1)
        .intersect(&grid.bounds())
        .voxels()
    {
        let middle = grid
            .patient_from_grid()
            .transform_point3(voxel.as_dvec3() + 0.5);
        let (out, depth) = (
            tool.position - middle,
            radius - tool.position.distance(middle),
        );
        if let (Some(spring), true) = (spring_of(input, voxel), depth > 0.0) {
            let normal = out.normalize_or_zero();
            force += spring * depth * normal;
            stiffness -=
                DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z) * spring;
        }
    }
    (force != DVec3::ZERO).then_some(LocalContact {
        position: tool.position,
        force,
        stiffness,
        validity: 0.5 * grid.smallest_spacing(),
    })
}

/// Young's modulus times the side of a voxel [N/mm]; none where nothing takes part.
fn spring_of(input: &ModelInput<'_>, voxel: IVec3) -> Option<f64> {
    let mut segments = input.materials.segments.iter().rev();
    let matter = segments.find(|m| {
        input
            .voxels
            .segment(m.segment)
            .is_some_and(|s| s.contains(voxel))
    })?;
    let solid = matter.law.at(input.voxels.value(voxel)?);
    Some(solid.young * input.voxels.grid().smallest_spacing())
}

/// Nothing runs by itself; the test presses with it.
pub fn main() {}
