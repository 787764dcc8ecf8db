//! A session: a scan that is touched with a device, from start to stop.
//!
//! Points in scene mm (LPS), forces N, times s. All methods may be called from any thread; none
//! of them makes the device or the servo wait.

use std::sync::mpsc::{self, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::DVec3;
use palpate_device::DeviceLimits;
use palpate_volume::clip::{Clip, Plane};
use palpate_volume::grid::Grid;
use palpate_volume::voxels::Voxels;

use crate::deformable::DeformableView;
use crate::error::SessionError;
use crate::notice::Notice;
use crate::picture::{FrameCollector, SurfacePace, Surfaces};
use crate::replay::TapeRecorder;
use crate::scene::GapBodies;
use crate::servo::{Shared, rotation_of_view};
use crate::session::assembly::{Assembly, assemble};
use crate::session::config::check;
use crate::session::live::{Live, Paces};
use crate::session::offline::Offline;
use crate::simulation::{SharedHand, Simulation};
use crate::threads::{ChangeSignal, clock};
use crate::touch::Settings;

mod assembly;
mod changes;
mod config;
mod drawn;
mod live;
mod objects;
mod offline;
mod press;
mod segments;
mod showing;

pub use config::{Reference, SessionConfig, check_point};
pub use drawn::Drawn;

/// How often a large edit is built again because another came in between.
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
    picture: Arc<Mutex<FrameCollector>>,
    surfaces: Arc<Mutex<Surfaces>>,
    pace: SurfacePace,
    signal: Arc<ChangeSignal>,
    deformable_view: Arc<DeformableView>,
    hand: SharedHand,
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
            signal,
            deformable_view,
            hand,
            shared,
            notices,
            tape,
        } = assemble(config)?;

        let run = if real_time {
            let (live, granted) = Live::start(loops, Arc::clone(&shared), paces)?;
            lock(&picture).real_time = granted.is_ok();
            report_priority(&notices, &granted);
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
            signal,
            deformable_view,
            hand,
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

    /// Moves the target to which the hand pulls the device, which ends a press.
    ///
    /// # Errors
    /// Where the point is not allowed or the session has ended.
    pub fn hand(&self, point: DVec3) -> Result<(), SessionError> {
        check_point("hand", point)?;
        self.check_running()?;
        let mut hand = self.hand.lock();
        hand.take_over();
        hand.pull_to(point);
        Ok(())
    }

    /// Brings probe, device and hand to a point, or to the free voxel nearest to it, which ends a
    /// press; gives where they are.
    ///
    /// # Errors
    /// Where the point is not allowed, no voxel near it is free, or the session has ended.
    pub fn place(&self, point: DVec3) -> Result<DVec3, SessionError> {
        check_point("place", point)?;
        let number = self.hand.taken_over();
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

    /// Cuts the scene for touch at these planes, in the place of those before: what lies before one is
    /// neither felt nor changed by tools. Voxels stay as they are.
    ///
    /// # Errors
    /// Where they are no clip, or the session has ended.
    pub fn set_clip(&self, planes: Vec<Plane>) -> Result<(), SessionError> {
        let clip = Clip::new(planes)?;
        self.ask(move |simulation| simulation.set_clip(clip))
    }

    /// The planes that cut the scene for touch.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn clip(&self) -> Result<Vec<Plane>, SessionError> {
        self.ask(|simulation| simulation.clip().planes().to_vec())
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
                    self.report(Notice::error(format!(
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

    /// The true voxels as they are now. Bricks are shared, so little is copied.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn voxels(&self) -> Result<Voxels, SessionError> {
        self.ask(|simulation| simulation.voxels().clone())
    }

    /// The same without what tools press of soft tissue: what is saved, and what people change.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn voxels_at_rest(&self) -> Result<Voxels, SessionError> {
        self.ask(|simulation| simulation.voxels_at_rest().clone())
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
            let snapshot = self.voxels_at_rest()?;
            let number = snapshot.edit_number();
            let change = build(&snapshot)?;
            let committed = self.ask(move |simulation| {
                let same = simulation.voxels_at_rest().edit_number() == number;
                same.then(|| commit(simulation, change))
            })?;
            if let Some(result) = committed {
                return result;
            }
        }
        // under edits without end the simulation waits once
        self.ask(move |simulation| {
            let change = build(simulation.voxels_at_rest())?;
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

    fn lock_picture(&self) -> MutexGuard<'_, FrameCollector> {
        lock(&self.picture)
    }

    fn report(&self, notice: Notice) {
        // the picture lives as long as the session
        let _ = self.notices.send(notice);
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.stop();
    }
}

fn report_priority(notices: &Sender<Notice>, granted: &Result<(), String>) {
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
