//! Where matter stands beside its voxels, told to the picture.

use std::sync::Arc;

use palpate_deform::model::DisplacementField;

use super::Simulation;
use crate::deformable::displacements::Displaced;
use crate::picture::scene_updates::SceneNews;

impl Simulation {
    /// Has the model forget all displacements, and the picture with it.
    pub(super) fn forget_deformation(&mut self) {
        self.deformation.forget();
        if let Some(news) = self.displaced_news(None) {
            self.tell_picture(news);
        }
    }

    /// What the picture is to be told of a field; nothing where that looks as before.
    pub(super) fn displaced_news(
        &mut self,
        field: Option<&DisplacementField>,
    ) -> Option<SceneNews> {
        let grid = *self.voxels().grid();
        let now = field.and_then(|field| Displaced::of(field, &grid));
        let is_other = match (&now, &self.displaced) {
            (Some(now), Some(before)) => now.differs(before, &grid),
            (now, before) => now.is_some() != before.is_some(),
        };
        if !is_other {
            return None;
        }
        self.displaced = now.map(Arc::new);
        Some(SceneNews::Displaced(self.displaced.clone()))
    }
}
