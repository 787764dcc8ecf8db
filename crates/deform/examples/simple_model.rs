//! A model of deformation in a few lines: each voxel is a spring of its own.
//!
//! Frame: patient [mm]. `docs/extend/adding-a-model.md` shows this file.

use glam::{DMat3, DVec3};
use palpate_deform::model::{DeformationModel, ModelAnswer, ModelInput, ToolContact, ToolState};
use palpate_volume::{material::LocalContact, voxel_box::VoxelBox};

/// A ball is pushed out of each voxel of the first tissue whose middle is in it: without memory.
#[derive(Debug)]
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

    fn reset(&mut self) {}
}

fn contact(input: &ModelInput<'_>, tool: &ToolState) -> Option<LocalContact> {
    let matter = input.materials.segments.first()?;
    let segment = input.voxels.segment(matter.segment)?;
    let grid = input.voxels.grid();
    let radius = tool.shape.half_axes().max_element();
    let centre = grid.grid_from_patient().transform_point3(tool.position);
    let [low, high] = [-radius, radius].map(|way| (centre + way / grid.spacing()).as_ivec3());
    let (mut force, mut stiffness) = (DVec3::ZERO, DMat3::ZERO);
    let near = VoxelBox::new(low, high + 1).intersect(&grid.bounds());
    for voxel in near.voxels() {
        let middle = voxel.as_dvec3() + 0.5;
        let out = tool.position - grid.patient_from_grid().transform_point3(middle);
        if out.length() < radius && segment.contains(voxel) {
            let solid = matter.law.at(input.voxels.value(voxel)?);
            // Young's modulus times the side of a voxel [N/mm]
            let spring = solid.young * grid.smallest_spacing();
            let normal = out.normalize_or_zero();
            let pull = |way: f64| -spring * way * normal;
            stiffness += DMat3::from_cols(pull(normal.x), pull(normal.y), pull(normal.z));
            force += spring * (radius - out.length()) * normal;
        }
    }
    (force != DVec3::ZERO).then_some(LocalContact {
        position: tool.position,
        force,
        stiffness,
        validity: 0.5 * grid.smallest_spacing(),
    })
}

/// Nothing runs by itself; the test presses with it.
pub fn main() {}
