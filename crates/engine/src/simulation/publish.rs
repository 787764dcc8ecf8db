//! What the simulation tells: its status, sentences, and changes of the scene.

use super::Simulation;
use crate::notice::Notice;
use crate::picture::{SceneUpdate, SimulationStatus};
use crate::replay::MAX_TAPE_BYTES;

impl Simulation {
    pub(super) fn report_held_changes(&mut self) {
        let held = self.touch.is_held();
        if held && !self.was_held {
            self.report(Notice::warning(
                "A change waits: what it makes solid surrounds the probe. Move the probe out, or \
                 undo the change.",
            ));
        }
        self.was_held = held;

        let stopped = self.touch.is_stopped();
        if stopped && !self.was_stopped {
            self.report(Notice::warning(
                "A segment stops on its way: it would pinch the probe. It goes on once the probe \
                 is out.",
            ));
        }
        self.was_stopped = stopped;
    }

    pub(super) fn report_refused_places(&mut self) {
        let refused = self.touch.status().refused_places;
        if refused > self.refused_places {
            self.report(Notice::warning(
                "The probe stays where it is: there is no free voxel near the point.",
            ));
        }
        self.refused_places = refused;
    }

    pub(super) fn report_full_tape(&mut self) {
        let full = self.touch.is_tape_full();
        if full && !self.was_full {
            self.report(Notice::warning(format!(
                "The recording has no room for more changes (limit: {} MB): what comes after \
                 this one cannot be replayed.",
                MAX_TAPE_BYTES >> 20
            )));
        }
        self.was_full = full;
    }

    pub(super) fn publish(&mut self) {
        let status = SimulationStatus {
            edit: self.voxels().edit_number(),
            touched: self.touch.status().touched,
            probe_radius: self.touch.status().radius,
            poses: self.current_poses(),
            grabbed: self.grip.as_ref().map_or(0, |grip| grip.id().0),
            clutched: self.clutched,
            device_origin: self.touch.status().origin,
            pending: self.touch.pending(),
            can_undo: self.journal.can_undo() || self.stroke.has_changed(),
            can_redo: self.journal.can_redo(),
            step: self.journal.position() + u64::from(self.stroke.has_changed()),
            steps_made: self.journal.made(),
            segments_version: self.segments_version,
            voxels_version: self.voxels_version,
            tool: self.stroke.now(),
            needle: self.needle.now(),
            matter: self.deformation(),
            undo_bytes: self.journal.bytes(),
            undo_budget: self.journal.budget(),
        };
        self.status.write(status);
    }

    pub(super) fn publish_update(&self, updates: SceneUpdate) {
        // without a picture nobody draws any more
        let _ = self.updates.send(updates);
    }

    pub(super) fn report(&self, notice: Notice) {
        // without a picture nobody reads notices any more
        let _ = self.notices.send(notice);
    }
}
