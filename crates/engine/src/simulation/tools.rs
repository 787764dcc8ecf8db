//! Tools in the hand of the simulation, and how much undo holds.

use glam::DVec3;
use palpate_haptics::needle::approach::unit;
use palpate_tools::factory::ToolSettings;
use palpate_tools::journal::Action;
use palpate_tools::tool::ToolReport;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxels::VoxelsError;

use super::Simulation;
use crate::error::SessionError;
use crate::notice::Notice;
use crate::scene::Step;
use crate::servo::ServoCommand;
use crate::simulation::tool_stroke::ProbeStatus;
use crate::touch::{NeedlePlace, NeedleReport};

/// Where a needle that is taken out stands before its entry [mm].
const BEFORE_ENTRY: f64 = 2.0;

impl Simulation {
    /// Chooses the tool for the next strokes, or none; a stroke that is on ends.
    ///
    /// # Errors
    /// Where a setting is out of range, or a segment does not exist.
    pub fn set_tool(&mut self, settings: Option<ToolSettings>) -> Result<(), SessionError> {
        if let Some(settings) = &settings {
            let first = settings.segments.first();
            let grid = first.map_or(self.voxels().grid(), |id| self.voxels().grid_of(*id));
            settings.build(grid)?;
            let unknown = |id: &&SegmentId| self.voxels().segment(**id).is_none();
            if let Some(id) = settings.segments.iter().find(unknown) {
                return Err(VoxelsError::UnknownSegment(id.0).into());
            }
        }
        self.end_stroke();
        self.stroke.set_tool(settings);
        self.publish();
        Ok(())
    }

    /// Begins a stroke of the chosen tool, or ends it: what it changed is one step of undo.
    ///
    /// # Errors
    /// Where it is to begin and no tool is chosen, or the tool does not fit any more.
    pub fn stroke(&mut self, on: bool) -> Result<(), SessionError> {
        if !on {
            self.end_stroke();
            return Ok(());
        }
        if self.closes_with_answer {
            self.close_step();
        }
        let left_out = self.stroke.begin(&self.scene)?;
        if left_out > 0 {
            self.report(Notice::info(format!(
                "{left_out} of the chosen segments are locked, or stand elsewhere than the first one or \
                 on another grid: the tool passes them over."
            )));
        }
        if let Some(tissues) = self.stroke.needle() {
            self.needle.begin();
            self.touch
                .send(ServoCommand::Needle(true, Box::new(tissues)));
        }
        self.publish();
        Ok(())
    }

    /// Sets the direction in which the needle goes in from now on, inward, of any length; none for
    /// that of the push. A needle that is in stays on its line.
    ///
    /// # Errors
    /// Where it is zero or not finite.
    pub fn set_needle_direction(&mut self, direction: Option<DVec3>) -> Result<(), SessionError> {
        let checked = |given| unit(given).ok_or(SessionError::NeedleDirection(given));
        let direction = direction.map(checked).transpose()?;
        self.needle.aim(direction);
        self.touch.send(ServoCommand::NeedleDirection(direction));
        self.publish();
        Ok(())
    }

    /// What the needle has done since it was taken in the hand last.
    #[must_use]
    pub fn needle_report(&self) -> NeedleReport {
        self.needle.report().clone()
    }

    /// Takes the needle out on the way that it went in; false where none is in. The device comes
    /// along, and hand targets up to number `hand` are forgotten.
    ///
    /// # Errors
    /// Where no voxel near its entry is free.
    pub fn withdraw_needle(&mut self, hand: u64) -> Result<bool, SessionError> {
        let Some(NeedlePlace {
            entry, direction, ..
        }) = self.needle.report().place
        else {
            return Ok(false);
        };
        self.place(entry - direction * BEFORE_ENTRY, hand, true)?;
        Ok(true)
    }

    /// Makes obstacles of what the needle is out of, and none of what it has punctured.
    pub(super) fn advance_needle(&mut self) {
        let executed = self.touch.status().command;
        let punctured = self.needle.follow(self.touch.needle(), executed);
        if let Some(punctured) = punctured {
            let changed = self.scene.puncture(punctured);
            self.send_all(changed);
        }
    }

    /// The probe jumps: no needle is in any more.
    pub(super) fn pull_needle(&mut self) {
        let changed = self.scene.puncture(SegmentSet::EMPTY);
        self.send_all(changed);
    }

    /// What the tool has done in the stroke that is on, or in the last one.
    #[must_use]
    pub fn tool_report(&self) -> ToolReport {
        self.stroke.report()
    }

    /// Bytes that undo and redo hold on to, and how many they may.
    #[must_use]
    pub fn undo_bytes(&self) -> (usize, usize) {
        (self.journal.bytes(), self.journal.budget())
    }

    /// One pass of the tool, from where the probe was to where it is.
    pub(super) fn advance_tool(&mut self) {
        let probe = ProbeStatus::of(self.touch.status());
        let edit = match self.stroke.advance(&self.scene, &probe) {
            Ok(Some(edit)) => edit,
            Ok(None) => return,
            Err(error) => return self.break_off(&error.into()),
        };
        match self.perform(Step::of_edit(edit), Action::Do) {
            Ok(inverse) => self.stroke.note(inverse),
            Err(error) => self.break_off(&error),
        }
    }

    fn break_off(&mut self, error: &SessionError) {
        self.end_stroke();
        self.report(Notice::warning(format!("The tool stops: {error}.")));
    }

    pub(super) fn end_stroke(&mut self) {
        if self.unpressed.is_moved() && self.stroke.is_on() {
            self.closes_with_answer = true;
        } else {
            self.close_step();
        }
        if self.stroke.needle().is_some() {
            self.touch.send(ServoCommand::Needle(false, Box::default()));
        }
        self.stroke.end();
        self.publish();
    }

    /// Makes a step of what the stroke has changed so far: another change follows.
    pub(super) fn close_step(&mut self) {
        self.closes_with_answer = false;
        if let Some(inverse) = self.stroke.take_inverse() {
            self.done(inverse);
        }
    }
}
