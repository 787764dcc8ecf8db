//! Tools in the hand of a session, soft tissue, and the journal that keeps changes on
//! disk.

use std::path::PathBuf;

use glam::DVec3;
use palpate_deform::material::{MaterialLaw, Region, Treatment};
use palpate_deform::registry::ModelOptions;
use palpate_tools::factory::ToolSettings;
use palpate_tools::journal::ScanHash;
use palpate_volume::edit::SegmentId;

use super::Session;
use crate::deformable::{DeformationStatus, ForceSource, ShownParts};
use crate::error::SessionError;
use crate::simulation::{Kept, Recovered, Simulation};
use crate::touch::NeedleReport;

impl Session {
    /// Chooses the tool for the next strokes, or none; a stroke that is on ends.
    ///
    /// # Errors
    /// Where a setting is out of range, a segment does not exist, or the session has ended.
    pub fn set_tool(&self, settings: Option<ToolSettings>) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_tool(settings))?
    }

    /// Begins a stroke of the chosen tool, or ends it: what it changed is one step of undo.
    ///
    /// # Errors
    /// Where it is to begin and no tool is chosen, or the session has ended.
    pub fn stroke(&self, on: bool) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.stroke(on))?
    }

    /// Sets the direction in which the needle goes in from now on, inward, of any length; none for
    /// that of the push.
    ///
    /// # Errors
    /// Where it is zero or not finite, or the session has ended.
    pub fn set_needle_direction(&self, direction: Option<DVec3>) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_needle_direction(direction))?
    }

    /// Takes the needle out on the way that it went in; false where none is in.
    ///
    /// # Errors
    /// Where no voxel near its entry is free, or the session has ended.
    pub fn withdraw_needle(&self) -> Result<bool, SessionError> {
        let number = self.hand.taken_over();
        self.ask(move |simulation| simulation.withdraw_needle(number))?
    }

    /// What the needle has done since it was taken in the hand last.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn needle_report(&self) -> Result<NeedleReport, SessionError> {
        self.ask(|simulation| simulation.needle_report())
    }

    /// Chooses the model of soft tissue under the probe and what it offers to choose,
    /// or none; an undoable choice is taken back by undo.
    ///
    /// # Errors
    /// Where there is none of that name, it cannot be so, or the session has ended.
    pub fn set_deformation(
        &self,
        model: Option<String>,
        options: ModelOptions,
        undoable: bool,
    ) -> Result<(), SessionError> {
        self.ask(move |simulation| {
            simulation.set_deformation(model.as_deref(), &options, undoable)
        })?
    }

    /// Tells what a segment is made of; without a material it is hard. An undoable
    /// change is taken back by undo.
    ///
    /// # Errors
    /// Where there is no such segment, or the session has ended.
    pub fn set_material(
        &self,
        id: SegmentId,
        law: Option<MaterialLaw>,
        undoable: bool,
    ) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_material(id, law, undoable))?
    }

    /// Tells how regions of a segment with a material take part.
    ///
    /// # Errors
    /// Where there is no such segment, or the session has ended.
    pub fn set_regions(
        &self,
        id: SegmentId,
        regions: Vec<(Region, Treatment)>,
    ) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_regions(id, regions))?
    }

    /// Chooses what a tool feels of soft tissue.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn set_force_source(&self, source: ForceSource) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_force_source(source))
    }

    /// How the deformation goes.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn deformation(&self) -> Result<DeformationStatus, SessionError> {
        self.ask(|simulation| simulation.deformation())
    }

    /// Has the nodes or particles of the model shown, or no more.
    pub fn show_model_parts(&self, on: bool) {
        self.deformable_view.want(on);
    }

    /// The parts of the model, where they are shown and were not given before.
    #[must_use]
    pub fn model_parts(&self) -> Option<ShownParts> {
        self.deformable_view.take()
    }

    /// What a journal of this scan holds; none where there is no such file.
    ///
    /// # Errors
    /// Where the file is no journal of this scan, another session writes it, or the session has
    /// ended.
    pub fn inspect_journal(
        &self,
        path: PathBuf,
        hash: ScanHash,
    ) -> Result<Option<Kept>, SessionError> {
        // the file may be long: only the voxels come from the simulation
        let voxels = self.voxels_at_rest()?;
        Kept::at(&path, hash, &voxels)
    }

    /// Begins a journal in a new file, with what is there now.
    ///
    /// # Errors
    /// Where the file exists already, the disk says no, or the session has ended.
    pub fn begin_journal(&self, path: PathBuf, hash: ScanHash) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.begin_journal(&path, hash))?
    }

    /// Writes what is there now into a new file, as the head of a journal without steps; a journal
    /// that runs goes on.
    ///
    /// # Errors
    /// Where the file exists already, the disk says no, or the session has ended.
    pub fn keep_state(&self, path: PathBuf, hash: ScanHash) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.keep_state(&path, hash))?
    }

    /// Does again what a journal of this scan says, and goes on with it.
    ///
    /// # Errors
    /// Where the file is no journal of this scan, a record cannot be, or the session has ended.
    pub fn recover_journal(
        &self,
        path: PathBuf,
        hash: ScanHash,
    ) -> Result<Recovered, SessionError> {
        self.ask(move |simulation| simulation.recover_journal(&path, hash))?
    }

    /// Keeps bytes beside the voxels, where there is a journal.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn note_in_journal(&self, bytes: Vec<u8>) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.note_in_journal(bytes))
    }

    /// Writes what waits and closes the journal.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn end_journal(&self) -> Result<(), SessionError> {
        self.ask(Simulation::end_journal)
    }
}
