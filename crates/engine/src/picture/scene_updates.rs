//! What the simulation tells the picture of the scene: which voxels are now other ones.
//!
//! Bricks are shared, never copied, so that telling an edit costs what the edit costs. Boxes are
//! in voxels of the grid.

use std::time::SystemTime;

use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use crate::picture::ShownDisplacements;
use crate::scene::{Scene, SegmentVoxels, Step, SurfaceOptions};

/// Larger boxes are asked for anew instead of being sent.
const MOST_VOXELS: u64 = 1 << 24;

/// Something that is other than before.
#[derive(Debug)]
pub enum SceneUpdate {
    /// A segment has other voxels, all of them; none where it is gone.
    Segment(SegmentId, Option<SegmentVoxels>),
    /// Some bricks are other ones.
    Edit(EditUpdate),
    /// A segment is to be shown as a surface made in this way, or not as a surface any more.
    Show(SegmentId, Option<(SurfaceOptions, SegmentVoxels)>),
    /// Tissue stands beside its voxels, or in them again.
    Displacements(ShownDisplacements),
    /// What is to be seen at once.
    Together(Vec<Self>),
}

/// An edit as the picture follows it.
#[derive(Debug)]
pub struct EditUpdate {
    /// Its number.
    pub edit: u64,
    /// When it was applied.
    pub applied: SystemTime,
    /// The voxels that differ by it, of the grid that its segments stand on.
    pub dirty: VoxelBox,
    /// The bricks as they are now, by segment.
    pub segments: Vec<(SegmentId, Vec<BrickSwap<BitBrick>>)>,
    /// Stored values of the dirty box, x fastest; none where they stay as they are.
    pub stored: Option<Vec<i16>>,
    /// For each voxel of the dirty box, x fastest, the last of the labelled segments that has
    /// it; none where no segment is labelled.
    pub labels: Option<Vec<u8>>,
}

impl SceneUpdate {
    /// What a step changed, told from its inverse; nothing where no voxel is another one.
    #[must_use]
    pub fn of(inverse: &Step, scene: &Scene, labelled: &[SegmentId]) -> Vec<Self> {
        let voxels = scene.voxels();
        match inverse {
            Step::Edit { edit, .. } => vec![Self::Edit(EditUpdate::of(edit, voxels, labelled))],
            Step::Replace { id, .. } | Step::Insert { id, .. } | Step::Remove { id } => {
                vec![Self::Segment(*id, scene.voxels_of(*id))]
            }
            Step::Move { .. } | Step::Material { .. } | Step::Model(_) => Vec::new(),
            Step::Several(inverses) => {
                let updates = |inverse| Self::of(inverse, scene, labelled);
                inverses.iter().rev().flat_map(updates).collect()
            }
        }
    }

    /// Whether the picture's labels must be asked for anew, since they are too many to be told.
    #[must_use]
    pub fn needs_labels(&self) -> bool {
        match self {
            Self::Segment(..) => true,
            Self::Edit(edit) => edit.dirty.voxel_count() > MOST_VOXELS,
            Self::Show(..) | Self::Displacements(_) => false,
            Self::Together(several) => several.iter().any(Self::needs_labels),
        }
    }
}

impl EditUpdate {
    fn of(inverse: &Edit, voxels: &Voxels, labelled: &[SegmentId]) -> Self {
        let dirty = inverse.dirty;
        let changed = inverse.segments.first();
        let of_scan = changed.is_none_or(|(id, _)| voxels.grid_of(*id) == voxels.grid());
        let small = of_scan && dirty.voxel_count() <= MOST_VOXELS;
        let segments = inverse.segments.iter().map(|(id, swaps)| {
            let indices = swaps.iter().map(|swap| swap.index);
            (*id, bricks_of(voxels, *id, indices))
        });
        Self {
            edit: voxels.edit_number(),
            applied: SystemTime::now(),
            dirty,
            segments: segments.collect(),
            stored: (small && !inverse.intensities.is_empty()).then(|| voxels.stored_in(&dirty)),
            labels: (small && !labelled.is_empty()).then(|| voxels.labels_in(&dirty, labelled)),
        }
    }
}

fn bricks_of(
    voxels: &Voxels,
    id: SegmentId,
    indices: impl Iterator<Item = u32>,
) -> Vec<BrickSwap<BitBrick>> {
    let Some(segment) = voxels.segment(id) else {
        return Vec::new();
    };
    let bricks = segment.occupancy().bricks();
    indices
        .map(|index| BrickSwap {
            index,
            brick: bricks.get(index).cloned(),
        })
        .collect()
}
