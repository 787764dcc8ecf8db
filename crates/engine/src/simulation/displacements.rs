//! Where tissue stands beside its voxels, told to the picture.

use std::sync::Arc;

use palpate_deform::lattice::DEEPEST;
use palpate_deform::model::DisplacementField;

use super::Simulation;
use crate::deformable::Displacements;
use crate::picture::{MOST_BOXES, SceneUpdate, ShownDisplacements};

/// How far the body behind what is pressed is shown to move, at most [mm].
const BEHIND: f64 = 20.0;

impl Simulation {
    /// Where tissue stands beside its voxels, as the picture was told it last.
    #[must_use]
    pub fn displacements(&self) -> ShownDisplacements {
        self.displacements.clone()
    }

    /// Has the model forget all displacements, and the picture with it.
    pub(super) fn forget_deformation(&mut self) {
        self.deformation.forget();
        if let Some(updates) = self.displacement_update([None; MOST_BOXES]) {
            self.publish_update(updates);
        }
    }

    /// What the picture is to be told of a field that voxels follow, and of that of the body behind, which none
    /// follows; nothing where both look as before.
    pub(super) fn displacement_update(
        &mut self,
        [pressed, behind]: [Option<&DisplacementField>; MOST_BOXES],
    ) -> Option<SceneUpdate> {
        // nodes in the empty space beside a face may go farther than matter ever is beside its
        // voxels; the picture follows no more than that
        let farthest = self.voxels().grid().spacing().max_element();
        self.field_update([pressed.zip(Some(farthest)), behind.zip(Some(BEHIND))])
    }

    /// Shows tissue where a needle drags it, which no voxel follows.
    pub(super) fn show_needle_drag(&mut self, field: Option<&DisplacementField>) {
        if let Some(update) = self.field_update([field.zip(Some(DEEPEST)), None]) {
            self.publish_update(update);
        }
    }

    /// Of fields, and how far each is followed [mm].
    fn field_update(
        &mut self,
        fields: [Option<(&DisplacementField, f64)>; MOST_BOXES],
    ) -> Option<SceneUpdate> {
        let grid = *self.voxels().grid();
        let shown = |(field, farthest)| Displacements::of(field, &grid, farthest);
        let now: Vec<_> = fields.into_iter().flatten().filter_map(shown).collect();
        let both = now.iter().zip(&self.displacements);
        let is_same = now.len() == self.displacements.len()
            && both
                .into_iter()
                .all(|(now, before)| !now.differs(before, &grid));
        if is_same {
            return None;
        }
        self.displacements = now.into_iter().map(Arc::new).collect();
        Some(SceneUpdate::Displacements(self.displacements.clone()))
    }
}
