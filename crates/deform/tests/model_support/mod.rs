//! A soft block in a small scan, a model and its tool, as tests of voxels share them.
use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3, IVec3};
use palpate_deform::material::{MaterialLaw, Materials, SegmentMaterial, SolidSi};
use palpate_deform::model::{
    Budget, DeformationModel, ModelAnswer, ModelInput, ToolShape, ToolState,
};
use palpate_deform::registry::{ModelOptions, model_from_name};
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

/// Soft, and never breaks.
pub const LIVER: SolidSi = SolidSi {
    young: 1e6,
    poisson: 0.3,
    density: 1060.0,
    fracture_energy: f64::INFINITY,
    friction: 0.0,
    stiffening: 0.0,
};
/// Upper face of the block [mm].
pub const TOP: f64 = 18.0;
/// Of the tool [mm].
pub const RADIUS: f64 = 3.0;
/// The only segment.
pub const BLOCK: SegmentId = SegmentId(1);

/// The stored value and whether it is solid, for each voxel.
pub type Picture = Vec<(i16, bool)>;

/// One answer to a ball at a place and of a radius [mm]; its edit is applied, as a session does.
pub fn answer_to_ball(
    model: &mut dyn DeformationModel,
    voxels: &mut Voxels,
    materials: &Materials,
    (position, radius): (DVec3, f64),
    budget: Budget,
) -> ModelAnswer {
    let tool = ToolState {
        id: 3,
        shape: ToolShape::Ball(radius),
        position,
        orientation: DQuat::IDENTITY,
    };
    let answer = model.advance(&ModelInput {
        voxels,
        materials,
        tools: &[tool],
        dt: 0.03,
        budget,
    });
    if let Some(edit) = answer.edit.clone() {
        voxels.apply(edit).expect("of this scan");
    }
    answer
}

/// A block of 36 × 36 × 18 mm and what presses on it. A voxel reads ten times its layer.
pub struct Bench {
    pub voxels: Voxels,
    pub materials: Materials,
    pub model: Box<dyn DeformationModel>,
}

impl Bench {
    /// With the default model, on cubes of 1 mm.
    pub fn new(solid: SolidSi) -> Self {
        let model =
            (model_from_name("lattice").expect("a known name").make)(&ModelOptions::default());
        Self::with(solid, DVec3::ONE, model)
    }

    pub fn with(solid: SolidSi, spacing: DVec3, model: Box<dyn DeformationModel>) -> Self {
        let dimensions = (36.0 / spacing).round().as_uvec3();
        let grid = Grid::new(dimensions, spacing, 0.5 * spacing, DMat3::IDENTITY).expect("a grid");
        let layer = |voxel: IVec3| 10 * voxel.z as i16;
        let values: Arc<[i16]> = VoxelBox::of_dimensions(dimensions)
            .voxels()
            .map(layer)
            .collect();
        let intensities = Intensities::new(dimensions, values, 1.0, 0.0).expect("intensities");
        let mut voxels = Voxels::new(grid, intensities).expect("one grid");
        let top = (TOP / spacing.z).round() as i32;
        let block = Segment::from_fn(dimensions, |voxel| voxel.z < top);
        assert_eq!(voxels.add_segment(block).expect("a free number"), BLOCK);
        let materials = Materials {
            segments: vec![SegmentMaterial {
                segment: BLOCK,
                law: MaterialLaw::constant(solid).expect("matter"),
                regions: Vec::new(),
            }],
        };
        Self {
            voxels,
            materials,
            model,
        }
    }

    pub fn grid(&self) -> &Grid {
        self.voxels.grid()
    }

    /// One answer with the tool there.
    pub fn advance(&mut self, tool: DVec3) -> ModelAnswer {
        let budget = Budget::iterations(200);
        let model = self.model.as_mut();
        answer_to_ball(
            model,
            &mut self.voxels,
            &self.materials,
            (tool, RADIUS),
            budget,
        )
    }

    /// Takes tissue away, as a drill does, and gives the inverse.
    pub fn cut(&mut self, region: &VoxelBox) -> Edit {
        let edit = self.voxels.voxel_edit(region, |_, mut matter| {
            matter.stored = -1000;
            matter.segments = matter.segments.without(BLOCK);
            matter
        });
        self.voxels.apply(edit).expect("of this scan")
    }

    pub fn undo(&mut self, inverse: Edit) {
        self.voxels.apply(inverse).expect("of this scan");
    }

    pub fn is_solid(&self, voxel: IVec3) -> bool {
        let block = self.voxels.segment(BLOCK).expect("the block");
        block.contains(voxel)
    }

    /// From which layer the tissue of a voxel is.
    pub fn layer_of(&self, voxel: IVec3) -> i32 {
        i32::from(self.voxels.stored(voxel).expect("in the scan")) / 10
    }

    pub fn picture(&self) -> Picture {
        let look = |voxel| {
            (
                self.voxels.stored(voxel).unwrap_or_default(),
                self.is_solid(voxel),
            )
        };
        self.grid().bounds().voxels().map(look).collect()
    }

    /// Voxels that are not as in a picture.
    pub fn changed(&self, picture: &Picture) -> u32 {
        let now = self.picture();
        let differ = now.iter().zip(picture).filter(|(now, then)| now != then);
        differ.count() as u32
    }
}
