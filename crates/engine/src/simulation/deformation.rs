//! Soft tissue under the probe.

use palpate_deform::at_rest::AtRest;
use palpate_deform::material::MaterialLaw;
use palpate_deform::model::{DeformationModel, DisplacementField, ModelEvent};
use palpate_deform::registry::{ModelOptions, model_from_name};
use palpate_tools::journal::Action;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::voxels::VoxelsError;

use super::Simulation;
use crate::deformable::{DeformationStatus, ForceSource};
use crate::error::SessionError;
use crate::notice::Notice;
use crate::picture::{MOST_BOXES, SceneUpdate};
use crate::scene::{ModelChoice, Step};
use crate::servo::{DeformableContact, ServoCommand};

impl Simulation {
    /// Chooses the model of soft tissue and what it offers to choose, or none; an
    /// undoable choice is taken back by undo.
    ///
    /// # Errors
    /// Where there is none of that name, or it cannot be so.
    pub fn set_deformation(
        &mut self,
        name: Option<&str>,
        options: &ModelOptions,
        undoable: bool,
    ) -> Result<(), SessionError> {
        let known = name.map(model_from_name).transpose()?;
        // asked for only to refuse what it cannot be
        known.map(|known| known.with(options)).transpose()?;
        let choice = known.map(|known| ModelChoice {
            name: known.name,
            options: *options,
        });
        let is_other = choice != self.scene.model();
        self.change_segments(Step::Model(choice), undoable && is_other)
    }

    /// Has soft tissue follow this model, under this name, or not at all. This is not undone.
    pub fn set_deformation_model(
        &mut self,
        model: Option<(&'static str, Box<dyn DeformationModel>)>,
    ) {
        let name = model.as_ref().map(|(name, _)| *name);
        let choice = name.map(|name| ModelChoice {
            name,
            options: ModelOptions::default(),
        });
        self.scene.set_known_model(choice);
        self.deformation.set_model(model);
        self.publish();
    }

    /// Tells what a segment is made of; without a material it is hard. Its friction is felt where
    /// the segment has none of its own. This changes no voxel; an undoable change is taken back by
    /// undo.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn set_material(
        &mut self,
        id: SegmentId,
        law: Option<MaterialLaw>,
        undoable: bool,
    ) -> Result<(), SessionError> {
        if self.voxels().segment(id).is_none() {
            return Err(VoxelsError::UnknownSegment(id.0).into());
        }
        let is_other = law != self.material(id);
        self.change_segments(Step::Material { id, law }, undoable && is_other)
    }

    /// Performs a step of deformation. What is dented meanwhile is no part of it, and goes on.
    fn change_segments(&mut self, step: Step, undoable: bool) -> Result<(), SessionError> {
        let inverse = self.perform(step, Action::Do)?;
        if undoable {
            let bytes = inverse.bytes();
            self.journal.done(inverse, bytes);
        }
        self.publish();
        Ok(())
    }

    /// Has the model follow a step of deformation, told by its inverse.
    pub(super) fn follow_deformable_segments(&mut self, inverse: &Step) {
        match inverse {
            Step::Material { id, .. } => {
                self.deformation.forget_displacements();
                self.publish_feel(*id);
            }
            Step::Model(_) => {
                let model = self.scene.model().and_then(|choice| {
                    // what the scene knows was made before
                    let known = model_from_name(choice.name).ok()?;
                    Some((known.name, known.with(&choice.options).ok()?))
                });
                self.deformation.set_model(model);
            }
            _ => {}
        }
    }

    /// What a segment is made of; none where it is hard.
    #[must_use]
    pub fn material(&self, id: SegmentId) -> Option<MaterialLaw> {
        self.scene.properties_of(id).law
    }

    /// How the deformation goes.
    #[must_use]
    pub fn deformation(&self) -> DeformationStatus {
        let options = self.scene.model().map(|choice| choice.options);
        DeformationStatus {
            options: options.unwrap_or_default(),
            ..self.deformation.now()
        }
    }

    /// Chooses what a tool feels of soft tissue. This is not undone.
    pub fn set_force_source(&mut self, source: ForceSource) {
        self.deformation.set_force_source(source);
        self.publish();
    }

    /// Takes the model's answer as soon as it has come, between two passes, and asks again.
    pub fn answer_came(&mut self) {
        self.touch.exchange(&self.scene);
        self.take_answer();
        if self.deformation.may_go_on(self.touch.status()) {
            self.ask_on();
        }
        self.publish();
    }

    /// In a pass: takes the model's answer, if one has come. Where voxels follow it, the next pass
    /// asks again; else this one does.
    pub(super) fn advance_deformation(&mut self) {
        if !self.take_answer() {
            self.ask_on();
        }
    }

    fn ask_on(&mut self) {
        if self.has_needle() {
            let drag = self.touch.needle().drag;
            self.deformation
                .go_on_with_needle(&self.scene, self.touch.status(), drag);
            return;
        }
        if let Some(hard) = self.deformation.go_on(&self.scene, self.touch.status()) {
            self.give_way(hard, [None; MOST_BOXES], Vec::new());
        }
    }

    /// Whether tissue is moved by a needle, for the eye alone: a needle has a law of its own.
    fn has_needle(&self) -> bool {
        self.touch.needle().on || self.deformation.shows_needle()
    }

    fn take_needle_answer(&mut self) {
        // what is seen is of the tool before
        if !self.deformation.shows_needle() && !self.displacements.is_empty() {
            self.forget_deformation();
        }
        if let Some(field) = self.deformation.take_needle() {
            self.show_needle_drag(field.as_ref());
        }
    }

    /// Takes the model's answer, if one has come; whether it changed voxels. What it moves from
    /// contact to release is one step of undo.
    fn take_answer(&mut self) -> bool {
        if self.has_needle() {
            self.take_needle_answer();
            return false;
        }
        let outcome = self.deformation.take(&self.scene, self.touch.status());
        // voxels that moved, and what they do not show yet, are seen at once
        let mut seen = Vec::new();
        let has_edit = outcome.edit.is_some();
        if let Some(edit) = outcome.edit {
            let comes_back = outcome.at_rest.is_some();
            match self.move_tissue(edit, comes_back) {
                Ok(updates) => {
                    seen = updates;
                    self.deformation.followed(self.voxels().edit_number());
                }
                Err(error) => {
                    self.forget_deformation();
                    self.report(Notice::warning(format!("Matter does not move: {error}.")));
                }
            }
        }
        if let Some(at_rest) = outcome.at_rest {
            self.keep_what_stays(at_rest);
        }
        if let Some(deformable_contact) = outcome.deformable_contact {
            let displacements = [&outcome.displacement, &outcome.behind].map(Option::as_ref);
            self.give_way(deformable_contact, displacements, seen);
        }
        for event in outcome.events {
            self.report_event(event);
        }
        has_edit
    }

    /// Applies what a model moves, and gives what the picture is to be told. Where it `comes_back` it is
    /// no change of the scan: neither undo nor the journal know of it.
    fn move_tissue(
        &mut self,
        edit: Edit,
        comes_back: bool,
    ) -> Result<Vec<SceneUpdate>, SessionError> {
        if !comes_back {
            let step = Step::of_edit(edit);
            let (inverse, updates) = self.perform_unpublished(step, Action::Do, false)?;
            self.stroke.note(inverse);
            return Ok(updates);
        }
        self.unpressed.begin(self.scene.voxels());
        self.perform_unnoted(self.elastic(edit))
            .map(|(_, updates)| updates)
    }

    fn elastic(&self, edit: Edit) -> Step {
        Step::of_elastic_edit(edit, |id| self.scene.properties_of(id).range)
    }

    /// Notes what a model leaves changed without a tool: what has yielded, and where cut tissue was.
    fn keep_what_stays(&mut self, at_rest: AtRest) {
        let stays = self.unpressed.follow_model(at_rest, self.scene.voxels());
        if let Some(edit) = stays {
            let ids = edit.segments.iter().map(|(id, _)| *id);
            let ranges = ids.map(|id| (id, self.scene.exchange_range(id, None)));
            let ranges = ranges.collect();
            let inverse = Step::Edit { edit, ranges };
            self.write_down(Action::Do, &inverse, false);
            self.stroke.note(inverse);
        }
        if self.closes_with_answer {
            self.close_step();
        }
    }

    /// Has pressed tissue come to rest at once, so that a change is made of that; where a tool still
    /// presses, the next answers move it again.
    pub(super) fn release_tissue(&mut self) {
        let Some(edit) = self.unpressed.release(self.scene.voxels()) else {
            return;
        };
        match self.perform_unnoted(self.elastic(edit)) {
            Ok((_, updates)) => {
                for update in updates {
                    self.publish_update(update);
                }
            }
            Err(error) => self.report(Notice::warning(format!("Tissue stays pressed: {error}."))),
        }
    }

    /// Has touch follow what is deformable, and tells the picture, with what it is to see at once.
    fn give_way(
        &mut self,
        deformable_contact: DeformableContact,
        displacements: [Option<&DisplacementField>; MOST_BOXES],
        mut seen: Vec<SceneUpdate>,
    ) {
        let released = deformable_contact
            .contact
            .is_none_or(|law| law.force == glam::DVec3::ZERO);
        if released && !self.stroke.is_on() {
            self.close_deformation();
        }
        self.touch
            .send(ServoCommand::DeformableContact(deformable_contact));
        seen.extend(self.displacement_update(displacements));
        if !seen.is_empty() {
            self.publish_update(SceneUpdate::Together(seen));
        }
    }

    /// Makes a step of what the deformation has changed; none where all of it came back.
    fn close_deformation(&mut self) {
        // what is on its way back is part of the step
        if self.deformation.now().report.comes_back() || !self.stroke.has_changed() {
            return;
        }
        let Some(inverse) = self.stroke.take_inverse() else {
            return;
        };
        if inverse.would_change(self.voxels_at_rest()) {
            self.done(inverse);
            return;
        }
        // nothing is left to take back
        if let Some(file) = &mut self.file {
            file.end_step();
        }
    }

    fn report_event(&self, event: ModelEvent) {
        match event {
            // shown as numbers
            ModelEvent::BondsBroken { .. } | ModelEvent::Slipped { .. } => {}
            ModelEvent::PoissonClamped { asked, used } => {
                let used = (1e3 * used).round() / 1e3;
                self.report(Notice::warning(format!(
                    "Poisson's ratio {asked} is out of what this model can do; {used} is used."
                )));
            }
            ModelEvent::Reset => self.report(Notice::warning(
                "The deformation was lost to impossible numbers and begins anew.",
            )),
        }
    }
}
