//! A block of liver under a ball: what tests of the thesis' local models share.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "each test file uses its part, and stops where its scan is refused"
)]

use glam::{DMat3, DQuat, DVec3, IVec3, UVec3};
use palpate_deform::material::{Materials, SegmentMaterial, preset};
use palpate_deform::model::{
    Budget, DeformationModel, ModelAnswer, ModelInput, ToolShape, ToolState,
};
use palpate_deform::particles::{LocalModel, LocalSettings, Motion};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

/// Voxels along each axis.
pub const SIDE: i32 = 30;
/// The tissue fills z < TOP.
pub const TOP: i32 = 18;
/// Side of a voxel [mm].
pub const H: f64 = 0.8;

/// A block of liver with its own texture, air above.
pub fn scan(spacing: DVec3) -> (Voxels, Materials) {
    let dimensions = UVec3::splat(SIDE as u32);
    let solid = |voxel: IVec3| voxel.z < TOP;
    let texture = |voxel: IVec3| {
        if solid(voxel) {
            40 + ((voxel.x * 7 + voxel.y * 3 + voxel.z) % 23) as i16
        } else {
            -1000
        }
    };
    let values: Vec<i16> = VoxelBox::of_dimensions(dimensions)
        .voxels()
        .map(texture)
        .collect();
    let grid = Grid::new(
        dimensions,
        spacing,
        DVec3::new(5.0, -3.0, 11.0),
        DMat3::IDENTITY,
    )
    .unwrap();
    let intensities = Intensities::new(dimensions, values, 1.0, 0.0).unwrap();
    let mut voxels = Voxels::new(grid, intensities).unwrap();
    let segment = voxels
        .add_segment(Segment::from_fn(dimensions, solid))
        .unwrap();
    let law = preset("liver").unwrap().law().unwrap();
    let matter = SegmentMaterial {
        segment,
        law,
        regions: Vec::new(),
    };
    (
        voxels,
        Materials {
            segments: vec![matter],
        },
    )
}

/// A ball over the middle of the block, its lowest point so deep below the surface [voxels].
pub fn ball(voxels: &Voxels, depth: f64) -> ToolState {
    let radius = 2.0 * H;
    let middle = f64::from(SIDE / 2) + 0.5;
    let height = f64::from(TOP) - depth + 2.0;
    let place = DVec3::new(middle, middle, height);
    ToolState {
        id: 7,
        shape: ToolShape::Ball(radius),
        position: voxels.grid().patient_from_grid().transform_point3(place),
        orientation: DQuat::IDENTITY,
    }
}

pub fn models() -> Vec<(&'static str, Box<dyn DeformationModel>)> {
    let small = LocalSettings {
        box_cells: 11,
        ..LocalSettings::default()
    };
    let resting = LocalSettings {
        motion: Motion::Rest,
        ..small
    };
    vec![
        ("fcc-lj", Box::new(LocalModel::fcc_lj(small))),
        ("fcc-lj at rest", Box::new(LocalModel::fcc_lj(resting))),
        ("cuboid-lj", Box::new(LocalModel::cuboid_lj(small))),
    ]
}

/// One call, its edit applied.
pub fn advance(
    model: &mut dyn DeformationModel,
    voxels: &mut Voxels,
    materials: &Materials,
    tools: &[ToolState],
    iterations: u32,
) -> ModelAnswer {
    let budget = Budget::iterations(iterations);
    let answer = model.advance(&ModelInput {
        voxels,
        materials,
        tools,
        dt: 0.03,
        budget,
    });
    if let Some(edit) = answer.edit.clone() {
        voxels.apply(edit).unwrap();
    }
    answer
}

pub fn force(answer: &ModelAnswer) -> DVec3 {
    answer.contacts[0]
        .contact
        .map_or(DVec3::ZERO, |contact| contact.force)
}

/// All voxels: stored value and whether solid.
pub fn picture(voxels: &Voxels) -> Vec<(i16, bool)> {
    let segment = voxels.segment(SegmentId(1)).unwrap();
    let bounds = voxels.grid().bounds();
    bounds
        .voxels()
        .map(|v| (voxels.stored(v).unwrap(), segment.contains(v)))
        .collect()
}
