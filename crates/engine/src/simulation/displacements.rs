//! Where tissue stands beside its voxels, told to the picture.

use std::sync::Arc;

use palpate_deform::lattice::DEEPEST;
use palpate_deform::model::DisplacementField;

use super::Simulation;
use crate::deformable::{Displacements, Following, UNSEEN};
use crate::picture::{MOST_BOXES, SceneUpdate, ShownDisplacements};

/// The body behind what is pressed: all of it is drawn again wherever it moves.
const BEHIND: Following = Following {
    farthest: 20.0,
    least: 0.1,
};
/// Tissue that a needle drags.
const DRAGGED: Following = Following {
    farthest: DEEPEST,
    least: UNSEEN,
};

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
        let following = Following {
            farthest: self.voxels().grid().spacing().max_element(),
            least: UNSEEN,
        };
        self.field_update([pressed.zip(Some(following)), behind.zip(Some(BEHIND))])
    }

    /// Shows tissue where a needle drags it, which no voxel follows.
    pub(super) fn show_needle_drag(&mut self, field: Option<&DisplacementField>) {
        if let Some(update) = self.field_update([field.zip(Some(DRAGGED)), None]) {
            self.publish_update(update);
        }
    }

    /// Of fields; those that look as before stay the same ones.
    fn field_update(
        &mut self,
        fields: [Option<(&DisplacementField, Following)>; MOST_BOXES],
    ) -> Option<SceneUpdate> {
        let grid = *self.voxels().grid();
        let shown = |(field, following)| Displacements::of(field, &grid, following);
        let now: Vec<_> = fields.into_iter().flatten().filter_map(shown).collect();
        let before = std::mem::take(&mut self.displacements);
        let is_as_many = now.len() == before.len();
        let mut is_same = is_as_many;
        for (number, now) in now.into_iter().enumerate() {
            let known = before
                .get(number)
                .filter(|known| is_as_many && !now.differs(known));
            is_same &= known.is_some();
            self.displacements
                .push(known.map_or_else(|| Arc::new(now), Arc::clone));
        }
        if is_same {
            return None;
        }
        Some(SceneUpdate::Displacements(self.displacements.clone()))
    }
}
