//! Matter that gives way under the probe.

use palpate_deform::material::MaterialLaw;
use palpate_deform::model::{DeformationModel, MODELS, ModelEvent, UnknownModel, model_from_name};
use palpate_tools::journal_entry::Action;
use palpate_volume::edit::SegmentId;
use palpate_volume::voxels::VoxelsError;

use super::Simulation;
use crate::deformation::DeformationNow;
use crate::error::SessionError;
use crate::frame::Notice;
use crate::handover::ServoCommand;
use crate::scene::Step;

impl Simulation {
    /// Chooses the model by which matter gives way, or none.
    ///
    /// # Errors
    /// Where there is none of that name.
    pub fn set_deformation(&mut self, name: Option<&str>) -> Result<(), SessionError> {
        let model = name.map(|name| {
            let model = model_from_name(name)?;
            let known = MODELS.iter().map(|known| known.name);
            Ok::<_, UnknownModel>((known.into_iter().find(|known| *known == name), model))
        });
        let model = model.transpose()?;
        self.set_deformation_model(model.and_then(|(name, model)| Some((name?, model))));
        Ok(())
    }

    /// Has matter give way by this model, under this name, or not at all.
    pub fn set_deformation_model(
        &mut self,
        model: Option<(&'static str, Box<dyn DeformationModel>)>,
    ) {
        self.deformation.set_model(model);
        self.publish();
    }

    /// Tells what a segment is made of; without a material it is hard. This changes no voxel and
    /// is not undone.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn set_material(
        &mut self,
        id: SegmentId,
        law: Option<MaterialLaw>,
    ) -> Result<(), SessionError> {
        if self.voxels().segment(id).is_none() {
            return Err(VoxelsError::UnknownSegment(id.0).into());
        }
        self.deformation.set_law(id, law);
        self.segments_version += 1;
        self.publish();
        Ok(())
    }

    /// What a segment is made of; none where it is hard.
    #[must_use]
    pub fn material(&self, id: SegmentId) -> Option<MaterialLaw> {
        self.deformation.law(id)
    }

    /// How the deformation goes.
    #[must_use]
    pub fn deformation(&self) -> DeformationNow {
        self.deformation.now()
    }

    /// Takes the model's answer, if one has come, and asks again. What it moves from contact to
    /// release is one step of undo.
    pub(super) fn advance_deformation(&mut self) {
        // a needle has a law of its own, and moves no matter
        if self.touch.status().needle.on {
            return;
        }
        let outcome = self.deformation.exchange(&self.scene, self.touch.status());
        if let Some(edit) = outcome.edit {
            match self.perform(Step::of_edit(edit), Action::Do) {
                Ok(inverse) => {
                    self.stroke.note(inverse);
                    self.deformation.followed(self.voxels().edit_number());
                }
                Err(error) => {
                    self.deformation.forget();
                    self.tell(Notice::warning(format!("Matter does not move: {error}.")));
                }
            }
        }
        if let Some(giving_way) = outcome.giving_way {
            let released = giving_way
                .contact
                .is_none_or(|law| law.force == glam::DVec3::ZERO);
            if released && !self.stroke.is_on() {
                self.close_step();
            }
            self.touch.send(ServoCommand::GiveWay(giving_way));
        }
        for event in outcome.events {
            self.tell_of_event(event);
        }
    }

    fn tell_of_event(&self, event: ModelEvent) {
        match event {
            // shown as numbers
            ModelEvent::BondsBroken { .. } | ModelEvent::Slipped { .. } => {}
            ModelEvent::PoissonClamped { asked, used } => self.tell(Notice::warning(format!(
                "Poisson's ratio {asked} is out of what this model can do; {used} is used."
            ))),
            ModelEvent::Reset => self.tell(Notice::warning(
                "The deformation was lost to impossible numbers and begins anew.",
            )),
        }
    }
}
