//! The loop that makes surfaces follow the voxels, at its own pace.
//!
//! It follows updates as they come, or on slow machines every k-th frame of the picture (thesis
//! 5.2.2): what comes in between is followed in one go.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::picture::scene_updates::SceneUpdate;
use crate::picture::surfaces::Surfaces;
use crate::threads::{ChangeSignal, PICTURE_HZ};

/// Surfaces follow at least every so many-th frame.
pub const SLOWEST_PACE: u32 = 4;

/// Every how many frames surfaces follow; shared by those who set it and the loop.
#[derive(Clone, Debug)]
pub struct SurfacePace(Arc<AtomicU32>);

impl Default for SurfacePace {
    fn default() -> Self {
        Self(Arc::new(AtomicU32::new(1)))
    }
}

impl SurfacePace {
    /// Has surfaces follow every so many-th frame, 1 to [`SLOWEST_PACE`]; 1 is at once.
    pub fn set(&self, every: u32) {
        self.0.store(every.clamp(1, SLOWEST_PACE), Relaxed);
    }

    /// Every how many frames.
    #[must_use]
    pub fn every(&self) -> u32 {
        self.0.load(Relaxed)
    }

    /// How long after they followed surfaces may follow again.
    fn rest(&self) -> Duration {
        match self.every() {
            1 => Duration::ZERO,
            every => Duration::from_secs(1) * every / PICTURE_HZ,
        }
    }
}

/// Updates on one side, surfaces on the other.
#[derive(Debug)]
pub struct SurfaceLoop {
    inbox: Receiver<SceneUpdate>,
    surfaces: Arc<Mutex<Surfaces>>,
    pace: SurfacePace,
    /// Rung once surfaces follow.
    signal: Arc<ChangeSignal>,
    /// Frames since the start.
    frame: u32,
    followed: Option<Instant>,
}

impl SurfaceLoop {
    /// Surfaces that follow these updates, at a pace, and signal once they do.
    #[must_use]
    pub fn new(
        inbox: Receiver<SceneUpdate>,
        surfaces: Arc<Mutex<Surfaces>>,
        pace: SurfacePace,
        signal: Arc<ChangeSignal>,
    ) -> Self {
        Self {
            inbox,
            surfaces,
            pace,
            signal,
            frame: 0,
            followed: None,
        }
    }

    /// Follows all updates that have come, where it is the frame for it.
    pub fn step(&mut self) {
        self.frame = self.frame.wrapping_add(1);
        if self.frame.is_multiple_of(self.pace.every())
            && let Ok(updates) = self.inbox.try_recv()
        {
            self.follow(updates);
        }
    }

    /// Waits for updates, at most so long, and follows them; false once none will come any more.
    pub fn wait(&mut self, patience: Duration) -> bool {
        match self.inbox.recv_timeout(patience) {
            Ok(updates) => {
                let since = self.followed.map_or(Duration::MAX, |at| at.elapsed());
                std::thread::sleep(self.pace.rest().saturating_sub(since));
                self.follow(updates);
                self.followed = Some(Instant::now());
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        true
    }

    fn follow(&self, first: SceneUpdate) {
        // what a panic left behind is still a surface
        let mut surfaces = self.surfaces.lock().unwrap_or_else(PoisonError::into_inner);
        surfaces.take(first);
        while let Ok(updates) = self.inbox.try_recv() {
            surfaces.take(updates);
        }
        surfaces.follow();
        drop(surfaces);
        self.signal.notify();
    }
}
