//! What a session shows: frames, rates, surfaces, and recordings of its ticks.

use std::time::Duration;

use palpate_volume::edit::SegmentId;

use super::{Session, lock};
use crate::error::SessionError;
use crate::picture::{Frame, PictureChange, Rates, ShownSurface, VoxelChange};
use crate::replay::{Recording, Tape};
use crate::scene::SurfaceOptions;
use crate::simulation::Simulation;

impl Session {
    /// Shows a segment as a surface made in this way, or as none.
    ///
    /// # Errors
    /// Where such a surface cannot be made, there is no such segment, or the session has ended.
    pub fn show_surface(
        &self,
        id: SegmentId,
        options: Option<SurfaceOptions>,
    ) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.show_surface(id, options))?
    }

    /// Has voxels and surfaces that are shown follow edits every so many-th frame of the picture,
    /// 1 to 4, for machines that are slow (thesis 5.2.2); 1 is at once.
    pub fn follow_edits(&self, every: u32) {
        self.pace.set(every);
    }

    /// Names the segments that the picture shows by their labels, the last of several on top.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn set_labelled(&self, labelled: Vec<SegmentId>) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_labelled(labelled))
    }

    /// Waits until surfaces have followed edits more than `heard` times, at most so long; gives
    /// how often they have.
    #[must_use]
    pub fn wait_for_changes(&self, heard: u64, patience: Duration) -> u64 {
        self.signal.wait(heard, patience)
    }

    /// What changed in voxels and surfaces since the call before, oldest first; never waits.
    #[must_use]
    pub fn picture_changes(&self) -> Vec<PictureChange> {
        // while surfaces are made there is nothing new yet
        self.surfaces
            .try_lock()
            .map(|mut surfaces| surfaces.changes())
            .unwrap_or_default()
    }

    /// Stored values at rest of a box around all tissue that tools press; none where none is pressed.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn values_at_rest(&self) -> Result<Option<VoxelChange>, SessionError> {
        self.ask(|simulation| {
            let region = simulation.moved();
            (!region.is_empty()).then(|| VoxelChange {
                region,
                stored: Some(simulation.voxels_at_rest().stored_in(&region)),
                labels: None,
            })
        })
    }

    /// All surfaces as they are now; waits until they follow the voxels.
    #[must_use]
    pub fn whole_surfaces(&self) -> PictureChange {
        lock(&self.surfaces).whole()
    }

    /// The surfaces of all segments that are shown, where they stand by now; none while they are made, which may take long.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn shown_surfaces(&self) -> Result<Option<Vec<ShownSurface>>, SessionError> {
        let shown = self.surfaces.try_lock().map(|surfaces| surfaces.shown());
        shown.ok().map(|surfaces| self.placed(surfaces)).transpose()
    }

    /// The same; waits while they are made.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn made_surfaces(&self) -> Result<Vec<ShownSurface>, SessionError> {
        let shown = lock(&self.surfaces).shown();
        self.placed(shown)
    }

    /// Surfaces where their segments stand by now.
    fn placed(&self, mut surfaces: Vec<ShownSurface>) -> Result<Vec<ShownSurface>, SessionError> {
        if surfaces.is_empty() {
            return Ok(surfaces);
        }
        self.ask(move |simulation| {
            for surface in &mut surfaces {
                surface.pose = simulation.current_pose(surface.id).unwrap_or_default();
            }
            surfaces
        })
    }

    /// What is now, with all samples and notices since the frame before. A session that has
    /// ended shows its last state, without force.
    #[must_use]
    pub fn frame(&self) -> Frame {
        let now_ns = self.now_ns();
        self.lock_picture().frame(now_ns)
    }

    /// The pace of each thread.
    #[must_use]
    pub fn rates(&self) -> Rates {
        let now_ns = self.now_ns();
        self.lock_picture().rates(now_ns)
    }

    /// Begins a recording of every tick; one that runs is thrown away.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn start_recording(&self) -> Result<(), SessionError> {
        self.check_running()?;
        // ticks first, so that the tape begins among them
        self.lock_picture().start_recording();
        self.ask(Simulation::begin_tape)
    }

    /// Ends the recording and gives it; none where none runs.
    #[must_use]
    pub fn stop_recording(&self) -> Option<Recording> {
        self.finish_recording().map(|(recording, _)| recording)
    }

    /// Ends the recording and gives its ticks, and what else a replay needs. That is missing
    /// where a change waited for the probe all the time, and in the first tick.
    #[must_use]
    pub fn finish_recording(&self) -> Option<(Recording, Option<Tape>)> {
        // ticks first, so that the tape has all that they executed
        let recording = self.lock_picture().stop_recording();
        let tape = lock(&self.tape).finish();
        recording.map(|recording| (recording, tape))
    }
}
