//! Where tissue stands beside its voxels, told to the picture.

use std::sync::Arc;

use palpate_deform::lattice::DEEPEST;
use palpate_deform::model::DisplacementField;

use super::Simulation;
use crate::deformable::Displacements;
use crate::picture::{SceneUpdate, ShownDisplacements};

impl Simulation {
    /// Where tissue stands beside its voxels, as the picture was told it last.
    #[must_use]
    pub fn displacements(&self) -> ShownDisplacements {
        self.displacements.clone()
    }

    /// Has the model forget all displacements, and the picture with it.
    pub(super) fn forget_deformation(&mut self) {
        self.deformation.forget();
        if let Some(updates) = self.displacement_update(None) {
            self.publish_update(updates);
        }
    }

    /// What the picture is to be told of a field that voxels follow; nothing where that looks as before.
    pub(super) fn displacement_update(
        &mut self,
        field: Option<&DisplacementField>,
    ) -> Option<SceneUpdate> {
        // nodes in the empty space beside a face may go farther than matter ever is beside its
        // voxels; the picture follows no more than that
        let farthest = self.voxels().grid().spacing().max_element();
        self.field_update(field, farthest)
    }

    /// Shows tissue where a needle drags it, which no voxel follows.
    pub(super) fn show_needle_drag(&mut self, field: Option<&DisplacementField>) {
        if let Some(update) = self.field_update(field, DEEPEST) {
            self.publish_update(update);
        }
    }

    fn field_update(
        &mut self,
        field: Option<&DisplacementField>,
        farthest: f64,
    ) -> Option<SceneUpdate> {
        let grid = *self.voxels().grid();
        let now = field.and_then(|field| Displacements::of(field, &grid, farthest));
        let is_other = match (&now, &self.displacements) {
            (Some(now), Some(before)) => now.differs(before, &grid),
            (now, before) => now.is_some() != before.is_some(),
        };
        if !is_other {
            return None;
        }
        self.displacements = now.map(Arc::new);
        Some(SceneUpdate::Displacements(self.displacements.clone()))
    }
}
