//! What is worked on: skin on soft tissue on bone, which lies bare at one side; a block made from
//! the number of a run.
//!
//! Voxels are cubes, or twice as high as wide; the bone's top has bumps. Frame: scene [mm].

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_deform::material::preset;
use palpate_deform::registry::ModelOptions;
use palpate_engine::error::SessionError;
use palpate_engine::touch::{Settings, TouchFeel};
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::tissue::Tissue;
use palpate_volume::voxel_box::VoxelBox;

use super::rig::Rig;
use crate::random::Random;

/// Width of the block [mm].
pub const WIDTH: f64 = 40.0;
/// Where skin ends and begins [mm].
pub const TOP: f64 = 26.0;
const SKIN: f64 = 24.0;
/// Where bone lies on average [mm].
pub const BONE: f64 = 12.0;
/// Up to here along x the bone reaches the top [mm].
pub const BARE: f64 = 14.0;
/// Height of the bumps [mm].
const BUMPS: f64 = 2.0;
/// Above the block there is air.
const HEIGHT: f64 = 36.0;

/// Numbers of the segments.
pub const SKIN_ID: SegmentId = SegmentId(1);
/// Soft tissue.
pub const SOFT_ID: SegmentId = SegmentId(2);
/// Bone, which is hard.
pub const BONE_ID: SegmentId = SegmentId(3);

/// Iterations of an answer: what a model does in the time that it has in a session.
const ITERATIONS: u32 = 24;

/// What a run works on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct World {
    /// Voxels [mm].
    pub spacing: DVec3,
    /// Of the probe [mm].
    pub radius: f64,
    phase: DVec3,
}

impl World {
    /// The world of a run.
    pub fn new(number: u64, random: &mut Random) -> Self {
        let tall = number % 2 == 1;
        let ball = number / 2 % 2 == 1;
        Self {
            spacing: DVec3::new(1.0, 1.0, if tall { 2.0 } else { 1.0 }),
            radius: if ball { 1.5 } else { 0.0 },
            phase: random.in_box(DVec3::ZERO, DVec3::splat(std::f64::consts::TAU)),
        }
    }

    /// Voxels along each axis.
    pub fn dimensions(&self) -> UVec3 {
        (DVec3::new(WIDTH, WIDTH, HEIGHT) / self.spacing)
            .round()
            .as_uvec3()
    }

    /// Where it stands: its corner is the scene's origin.
    pub fn grid(&self) -> Grid {
        let origin = 0.5 * self.spacing;
        Grid::new(self.dimensions(), self.spacing, origin, DMat3::IDENTITY)
            .expect("voxels of a millimetre or two")
    }

    /// The segment that a voxel is of.
    fn segment_at(&self, voxel: IVec3) -> Option<SegmentId> {
        let place = (voxel.as_dvec3() + 0.5) * self.spacing;
        let waves = 0.35 * place.truncate().extend(0.0) + self.phase;
        let bone = BONE + 0.5 * BUMPS * (waves.x.sin() + waves.y.sin());
        match place.z {
            z if z < bone || (place.x < BARE && z < TOP) => Some(BONE_ID),
            z if z < SKIN => Some(SOFT_ID),
            z if z < TOP => Some(SKIN_ID),
            _ => None,
        }
    }

    /// Whether a voxel is of the bone, which is always rigid.
    pub fn is_bone(&self, voxel: IVec3) -> bool {
        self.segment_at(voxel) == Some(BONE_ID)
    }

    /// The scan's values, as CT has them.
    fn intensities(&self) -> Intensities {
        let bounds = VoxelBox::of_dimensions(self.dimensions());
        let values: Vec<i16> = bounds
            .voxels()
            .map(|voxel| match self.segment_at(voxel) {
                Some(BONE_ID) => 1200,
                Some(_) => 40 + ((7 * voxel.x + 3 * voxel.y + voxel.z) % 23) as i16,
                None => -1000,
            })
            .collect();
        Intensities::new(self.dimensions(), values, 1.0, 0.0).expect("one value for each voxel")
    }

    /// A session in it whose soft tissue follows a model, the probe above the middle.
    pub fn rig(&self, model: &str, options: &ModelOptions) -> Result<Rig, SessionError> {
        let dimensions = self.dimensions();
        let grid = self.grid();
        let segments = [SKIN_ID, SOFT_ID, BONE_ID]
            .map(|id| Segment::from_fn(dimensions, |voxel| self.segment_at(voxel) == Some(id)));
        let settings = Settings {
            probe_radius: self.radius,
            // only then a force must never pull
            friction_static: 0.0,
            friction_kinetic: 0.0,
            damping: 0.0,
            ..Settings::default()
        };
        let start = DVec3::new(0.5 * WIDTH, 0.5 * WIDTH, TOP + 4.0);
        let scan = (grid, self.intensities());
        let mut rig = Rig::new(scan, segments.to_vec(), start, settings, true)?;
        rig.deformation.set_iterations(ITERATIONS);
        for (id, name) in [(SKIN_ID, "skin"), (SOFT_ID, "liver")] {
            let law = preset(name).and_then(|preset| preset.law());
            let law = law.expect("a preset of the list");
            rig.simulation.set_material(id, Some(law), false)?;
        }
        for id in [SKIN_ID, SOFT_ID, BONE_ID] {
            // only then a force must never pull
            rig.simulation.set_feel(id, TouchFeel::SLIPPERY)?;
        }
        rig.simulation
            .set_deformation(Some(model), options, false)?;
        Ok(rig)
    }
}

/// A drill of 2 mm that takes everything.
pub fn drill() -> ToolSettings {
    let segments = vec![SKIN_ID, SOFT_ID, BONE_ID];
    ToolSettings::new(ToolKind::Drill, 2.0, segments)
}

/// A needle that bone stops.
pub fn needle() -> ToolSettings {
    ToolSettings {
        kind: ToolKind::Needle,
        radius: 0.5,
        segments: vec![SKIN_ID, SOFT_ID],
        tissues: vec![Tissue::SKIN, Tissue::LIVER],
        ..drill()
    }
}
