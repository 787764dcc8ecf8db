//! The loop that makes surfaces follow the voxels, at its own pace.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use crate::scene_news::SceneNews;
use crate::surfaces::Surfaces;

/// News on one side, surfaces on the other.
#[derive(Debug)]
pub struct SurfaceLoop {
    inbox: Receiver<SceneNews>,
    surfaces: Arc<Mutex<Surfaces>>,
}

impl SurfaceLoop {
    /// Surfaces that follow these news.
    #[must_use]
    pub fn new(inbox: Receiver<SceneNews>, surfaces: Arc<Mutex<Surfaces>>) -> Self {
        Self { inbox, surfaces }
    }

    /// Follows all news that have come.
    pub fn step(&self) {
        if let Ok(news) = self.inbox.try_recv() {
            self.follow(news);
        }
    }

    /// Waits for news, at most so long, and follows them; false once none will come any more.
    pub fn wait(&self, patience: Duration) -> bool {
        match self.inbox.recv_timeout(patience) {
            Ok(news) => self.follow(news),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        true
    }

    fn follow(&self, first: SceneNews) {
        // what a panic left behind is still a surface
        let mut surfaces = self.surfaces.lock().unwrap_or_else(PoisonError::into_inner);
        surfaces.take(first);
        while let Ok(news) = self.inbox.try_recv() {
            surfaces.take(news);
        }
        surfaces.follow();
    }
}
