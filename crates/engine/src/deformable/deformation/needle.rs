//! Tissue that a needle drags, for the eye alone: no force and no voxel follows it.

use glam::DVec3;
use palpate_deform::lattice::NeedleDrag;
use palpate_deform::model::DisplacementField;

use super::{Deformation, REACH};
use crate::deformable::deformable_segments::soft_segments;
use crate::deformable::deformation_loop::{DeformationAnswer, MovedBy};
use crate::scene::Scene;
use crate::servo::ServoStatus;

impl Deformation {
    /// Whether tissue is seen moved by a needle, or will be once an answer has come: until it is not,
    /// tools press nothing.
    #[must_use]
    pub fn shows_needle(&self) -> bool {
        self.needle_asked || self.needle_seen
    }

    /// Takes where tissue is seen around a needle, if an answer has come: the field, or none where its
    /// voxels are. What a tool pressed before is not taken any more.
    pub fn take_needle(&mut self) -> Option<Option<DisplacementField>> {
        // nothing is felt of the model, and so nothing is late
        self.now.force = DVec3::ZERO;
        self.now.late = false;
        match self.answers.try_recv().ok()? {
            DeformationAnswer::Needle(field) => {
                self.needle_asked = false;
                self.needle_seen = field.is_some();
                Some(field)
            }
            DeformationAnswer::Model(_) => {
                self.asked = None;
                self.known = None;
                None
            }
        }
    }

    /// Asks where tissue is seen around a needle that drags it so, and until it is back at rest.
    pub fn go_on_with_needle(
        &mut self,
        scene: &Scene,
        status: &ServoStatus,
        drag: Option<NeedleDrag>,
    ) {
        let has_model = self.model.is_some() && self.next.is_none();
        let is_soft = |drag: &NeedleDrag| !soft_segments(scene, drag.tip(), REACH).is_empty();
        let drag = drag.filter(|drag| has_model && is_soft(drag));
        let is_needed = drag.is_some() || self.needle_seen;
        if self.asked.is_none() && !self.needle_asked && is_needed {
            self.needle_asked = self.send(scene, status, MovedBy::Needle(drag));
        }
    }
}
