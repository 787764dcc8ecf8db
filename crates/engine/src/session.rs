//! A session: a scan that is touched with a device, from start to stop.
//!
//! Points in scene mm (LPS), forces N, times s. All methods may be called from any thread; none
//! of them makes the device or the servo wait.

use std::sync::mpsc::{self, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use glam::{DAffine3, DVec3, IVec3};
use palpate_device::DeviceLimits;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::{Voxels, VoxelsError};

use crate::assembly::{Assembly, assemble};
use crate::bell::Bell;
use crate::clock;
use crate::error::SessionError;
use crate::feel::Feel;
use crate::frame::{Frame, Notice, Rates};
use crate::gap_bodies::GapBodies;
use crate::handover::HandTarget;
use crate::kept_surface::SurfaceMaking;
use crate::live::{Live, Paces};
use crate::mapping::rotation_of_view;
use crate::offline::Offline;
use crate::picture::Picture;
use crate::recording::Recording;
use crate::scene::{Properties, ThresholdRange};
use crate::session_config::{SessionConfig, check, check_point};
use crate::settings::Settings;
use crate::shared::Shared;
use crate::simulation::{SegmentState, Simulation, checked_box};
use crate::surface_loop::SurfacePace;
use crate::surfaces::{PictureChange, Surfaces};
use crate::tape::{Tape, TapeRecorder};

mod changes;
mod objects;

/// Edits of more voxels than this are built outside the simulation thread.
const SMALL_EDIT: u64 = 1 << 20;
/// How often such an edit is built again because another came in between.
const BUILDS: usize = 4;
/// Longest stretch of an offline session in one call [s].
const LONGEST_RUN: f64 = 3600.0;

/// The threads, or the loops of an offline session.
enum Run {
    Live(Live),
    Offline(Box<Mutex<Offline>>),
}

/// A running session. It ends when it is dropped.
pub struct Session {
    run: Run,
    picture: Arc<Mutex<Picture>>,
    surfaces: Arc<Mutex<Surfaces>>,
    pace: SurfacePace,
    bell: Arc<Bell>,
    hand: Mutex<(triple_buffer::Input<HandTarget>, u64)>,
    shared: Arc<Shared>,
    notices: Sender<Notice>,
    tape: Arc<Mutex<TapeRecorder>>,
    gap_bodies: Mutex<GapBodies>,
    grid: Grid,
    device_name: String,
    device_limits: DeviceLimits,
}

impl Session {
    /// Starts a session.
    ///
    /// # Errors
    /// Where rate, settings, start or segments are not allowed, or the system refuses a thread.
    pub fn start(config: SessionConfig) -> Result<Self, SessionError> {
        check(&config)?;
        let grid = config.grid;
        let device_name = config.device.name().to_owned();
        let device_limits = config.device.limits();
        let real_time = config.real_time;
        let paces = Paces {
            device_hz: config.device_rate_hz(),
            servo_hz: config.rate_hz,
        };
        let Assembly {
            loops,
            picture,
            surfaces,
            pace,
            bell,
            hand,
            shared,
            notices,
            tape,
        } = assemble(config)?;

        let run = if real_time {
            let (live, granted) = Live::start(loops, Arc::clone(&shared), paces)?;
            lock(&picture).real_time = granted.is_ok();
            tell_of_priority(&notices, &granted);
            Run::Live(live)
        } else {
            let offline = Offline::new(loops, Arc::clone(&shared), paces);
            Run::Offline(Box::new(Mutex::new(offline)))
        };
        Ok(Self {
            run,
            picture,
            surfaces,
            pace,
            bell,
            hand: Mutex::new((hand, 0)),
            shared,
            notices,
            tape,
            gap_bodies: Mutex::default(),
            grid,
            device_name,
            device_limits,
        })
    }

    /// Name of the device.
    #[must_use]
    pub fn device_name(&self) -> &str {
        &self.device_name
    }

    /// What the device bears.
    #[must_use]
    pub fn device_limits(&self) -> DeviceLimits {
        self.device_limits
    }

    /// Moves the target to which the hand pulls the device.
    ///
    /// # Errors
    /// Where the point is not allowed or the session has ended.
    pub fn hand(&self, point: DVec3) -> Result<(), SessionError> {
        check_point("hand", point)?;
        self.check_running()?;
        let mut hand = lock(&self.hand);
        hand.1 += 1;
        let number = hand.1;
        hand.0.write(HandTarget { point, number });
        Ok(())
    }

    /// Brings probe, device and hand to a point, or to the free voxel nearest to it; gives
    /// where they are.
    ///
    /// # Errors
    /// Where the point is not allowed, no voxel near it is free, or the session has ended.
    pub fn place(&self, point: DVec3) -> Result<DVec3, SessionError> {
        check_point("place", point)?;
        let number = lock(&self.hand).1;
        self.ask(move |simulation| simulation.place(point, number, true))?
    }

    /// Turns the device's axes to those of the view: right and up in the scene.
    ///
    /// # Errors
    /// Where the axes are no view or the session has ended.
    pub fn view(&self, right: DVec3, up: DVec3) -> Result<(), SessionError> {
        let rotation = rotation_of_view(right, up)?;
        self.ask(move |simulation| simulation.turn(rotation))
    }

    /// Takes new settings, as far as the device bears them; gives those that hold.
    ///
    /// # Errors
    /// Where one of them is out of range or the session has ended.
    pub fn set_settings(&self, settings: Settings) -> Result<Settings, SessionError> {
        self.ask(move |simulation| simulation.set_settings(settings))?
    }

    /// The settings that hold.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn settings(&self) -> Result<Settings, SessionError> {
        self.ask(|simulation| simulation.settings())
    }

    /// Adds a segment; undo takes it away again where `undoable`.
    ///
    /// # Errors
    /// Where it belongs to another grid, there are 255, or the session has ended.
    pub fn add_segment(
        &self,
        segment: Segment,
        properties: Properties,
        undoable: bool,
    ) -> Result<SegmentId, SessionError> {
        self.ask(move |simulation| simulation.add_segment(segment, properties, undoable))?
    }

    /// Gives a segment other voxels, which are the threshold `range` where there is one.
    ///
    /// # Errors
    /// Where there is no such segment, the voxels belong to another grid, or the session has
    /// ended.
    pub fn replace_segment(
        &self,
        id: SegmentId,
        segment: Segment,
        range: Option<ThresholdRange>,
    ) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.replace_segment(id, segment, range))?
    }

    /// Removes a segment.
    ///
    /// # Errors
    /// Where there is no such segment or the session has ended.
    pub fn remove_segment(&self, id: SegmentId) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.remove_segment(id))?
    }

    /// Makes a segment an obstacle, or no obstacle.
    ///
    /// # Errors
    /// Where there is no such segment or the session has ended.
    pub fn set_touchable(&self, id: SegmentId, touchable: bool) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_touchable(id, touchable))?
    }

    /// Moves a segment to a pose [mm, from the scan to the scene]; touch goes there smoothly, and
    /// stops where the probe is pinched.
    ///
    /// # Errors
    /// Where the pose is no rigid motion, there is no such segment, too many are moved, or the
    /// session has ended.
    pub fn move_segment(&self, id: SegmentId, pose: DAffine3) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.move_segment(id, pose))?
    }

    /// Changes how the surface of a segment feels.
    ///
    /// # Errors
    /// Where a value is out of range, there is no such segment, or the session has ended.
    pub fn set_feel(&self, id: SegmentId, feel: Feel) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_feel(id, feel))?
    }

    /// Shows a segment as a surface made in this way, or as none.
    ///
    /// # Errors
    /// Where such a surface cannot be made, there is no such segment, or the session has ended.
    pub fn show_surface(
        &self,
        id: SegmentId,
        making: Option<SurfaceMaking>,
    ) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.show_surface(id, making))?
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
        self.bell.wait(heard, patience)
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

    /// All surfaces as they are now; waits until they follow the voxels.
    #[must_use]
    pub fn whole_surfaces(&self) -> PictureChange {
        lock(&self.surfaces).whole()
    }

    /// Makes a segment of all voxels with low <= value <= high, or gives segment `id` these
    /// voxels; gives its number.
    ///
    /// # Errors
    /// Where the range is none, there is no such segment, there are 255, or the session has
    /// ended.
    pub fn threshold(
        &self,
        id: Option<SegmentId>,
        range: ThresholdRange,
    ) -> Result<SegmentId, SessionError> {
        let (low, high) = range;
        if !(low.is_finite() && high.is_finite() && low <= high) {
            return Err(SessionError::Range { low, high });
        }
        let build = move |voxels: &Voxels| Ok(voxels.threshold(low, high));
        self.build_and_commit(build, move |simulation, segment| match id {
            Some(id) => simulation
                .replace_segment(id, segment, Some(range))
                .map(|()| id),
            None => {
                let properties = Properties::of_threshold(true, Some(range));
                simulation.add_segment(segment, properties, true)
            }
        })
    }

    /// Makes all voxels from `low` up to, but without, `high` solid or free in one segment.
    ///
    /// # Errors
    /// Where there is no such segment, the box holds no voxel of the scan, or the session has
    /// ended.
    pub fn fill_box(
        &self,
        id: SegmentId,
        low: IVec3,
        high: IVec3,
        solid: bool,
    ) -> Result<(), SessionError> {
        let region = checked_box(low, high, &self.grid)?;
        if region.voxel_count() <= SMALL_EDIT {
            return self.ask(move |simulation| simulation.fill_box(id, &region, solid))?;
        }
        let build = move |voxels: &Voxels| Ok(voxels.label_edit(id, &region, |_, _| solid)?);
        self.build_and_commit(build, Simulation::apply)
    }

    /// Takes the newest change back; false where there is none.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn undo(&self) -> Result<bool, SessionError> {
        self.ask(Simulation::undo)?
    }

    /// Does the last undone change again; false where there is none.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn redo(&self) -> Result<bool, SessionError> {
        self.ask(Simulation::redo)?
    }

    /// The true voxels of a segment.
    ///
    /// # Errors
    /// Where there is no such segment or the session has ended.
    pub fn segment(&self, id: SegmentId) -> Result<Segment, SessionError> {
        self.ask(move |simulation| {
            let segment = simulation.voxels().segment(id).cloned();
            segment.ok_or(VoxelsError::UnknownSegment(id.0).into())
        })?
    }

    /// All segments, by rising number.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn segments(&self) -> Result<Vec<SegmentState>, SessionError> {
        self.ask(|simulation| simulation.segments())
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
        // ticks first, so that the tape has all that they obeyed
        let recording = self.lock_picture().stop_recording();
        let tape = lock(&self.tape).finish();
        recording.map(|recording| (recording, tape))
    }

    /// Steps an offline session for so many seconds.
    ///
    /// # Errors
    /// Where the session runs in real time or has ended, or the time is not allowed.
    pub fn run(&self, seconds: f64) -> Result<(), SessionError> {
        let Run::Offline(offline) = &self.run else {
            return Err(SessionError::NotOffline);
        };
        if !(0.0..=LONGEST_RUN).contains(&seconds) {
            return Err(SessionError::Duration(seconds));
        }
        self.check_running()?;
        lock(offline).run(seconds);
        self.check_running()
    }

    /// Ends the session: zero force, then no threads, in less than a second where no disk keeps the
    /// journal waiting. Again it does nothing.
    pub fn stop(&self) {
        match &self.run {
            Run::Live(live) => {
                for thread in live.stop() {
                    self.tell(Notice::error(format!(
                        "The {thread} thread does not end and is left behind; switch the device \
                         off if it pushes."
                    )));
                }
            }
            Run::Offline(offline) => lock(offline).stop(),
        }
    }

    /// Why the session ended by itself, if it did.
    #[must_use]
    pub fn failure(&self) -> Option<String> {
        self.shared.failure()
    }

    /// Whether the session runs.
    #[must_use]
    pub fn is_running(&self) -> bool {
        !self.shared.stopping()
    }

    /// Has the simulation answer; waits for it.
    fn ask<R: Send + 'static>(
        &self,
        question: impl FnOnce(&mut Simulation) -> R + Send + 'static,
    ) -> Result<R, SessionError> {
        self.check_running()?;
        match &self.run {
            Run::Offline(offline) => Ok(question(lock(offline).simulation())),
            Run::Live(live) => {
                let (sender, answer) = mpsc::sync_channel(1);
                let asked = live.ask(Box::new(move |simulation| {
                    // whoever asked may have gone
                    let _ = sender.send(question(simulation));
                }));
                match answer.recv() {
                    Ok(answer) if asked => Ok(answer),
                    _ => Err(self.end_reason()),
                }
            }
        }
    }

    /// Builds a large change from a snapshot, here and not in the simulation thread, and commits
    /// it where no edit came in between; else builds it again.
    fn build_and_commit<C: Send + 'static, R: Send + 'static>(
        &self,
        build: impl Fn(&Voxels) -> Result<C, SessionError> + Send + 'static,
        commit: impl Fn(&mut Simulation, C) -> Result<R, SessionError> + Copy + Send + 'static,
    ) -> Result<R, SessionError> {
        for _ in 0..BUILDS {
            let snapshot = self.ask(|simulation| simulation.voxels().clone())?;
            let number = snapshot.edit_number();
            let change = build(&snapshot)?;
            let committed = self.ask(move |simulation| {
                let same = simulation.voxels().edit_number() == number;
                same.then(|| commit(simulation, change))
            })?;
            if let Some(result) = committed {
                return result;
            }
        }
        // under edits without end the simulation waits once
        self.ask(move |simulation| {
            let change = build(simulation.voxels())?;
            commit(simulation, change)
        })?
    }

    fn check_running(&self) -> Result<(), SessionError> {
        if self.is_running() {
            Ok(())
        } else {
            Err(self.end_reason())
        }
    }

    fn end_reason(&self) -> SessionError {
        self.failure()
            .map_or(SessionError::Stopped, SessionError::Failed)
    }

    fn now_ns(&self) -> u64 {
        match &self.run {
            Run::Live(_) => clock::now_ns(),
            Run::Offline(offline) => lock(offline).now_ns(),
        }
    }

    fn lock_picture(&self) -> MutexGuard<'_, Picture> {
        lock(&self.picture)
    }

    fn tell(&self, notice: Notice) {
        // the picture lives as long as the session
        let _ = self.notices.send(notice);
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.stop();
    }
}

fn tell_of_priority(notices: &Sender<Notice>, granted: &Result<(), String>) {
    if let Err(reason) = granted {
        // the picture lives as long as the session
        let _ = notices.send(Notice::warning(format!(
            "No real-time priority ({reason}): touch runs, but a busy machine can make it late."
        )));
    }
}

/// What the locks guard is whole even where a thread failed while it held one.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
