//! A bell that wakes who waits for something new.

use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Rung by one thread, heard by others; nobody waits for those who do not listen.
#[derive(Debug, Default)]
pub struct Bell {
    rung: Mutex<u64>,
    wake: Condvar,
}

impl Bell {
    /// Wakes all who wait.
    pub fn ring(&self) {
        // a number is whole, whoever panicked while he held it
        *self.rung.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        self.wake.notify_all();
    }

    /// Waits until it has been rung more than `heard` times, at most so long; gives how often it
    /// has been.
    #[must_use]
    pub fn wait(&self, heard: u64, patience: Duration) -> u64 {
        let rung = self.rung.lock().unwrap_or_else(PoisonError::into_inner);
        let (rung, _) = self
            .wake
            .wait_timeout_while(rung, patience, |rung| *rung == heard)
            .unwrap_or_else(PoisonError::into_inner);
        *rung
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_waits_is_woken_and_what_was_missed_is_heard_at_once() {
        let bell = Bell::default();
        assert_eq!(bell.wait(0, Duration::ZERO), 0);
        bell.ring();
        bell.ring();
        // an hour, were it not rung already
        assert_eq!(bell.wait(0, Duration::from_secs(3600)), 2);
        std::thread::scope(|threads| {
            threads.spawn(|| bell.ring());
            assert_eq!(bell.wait(2, Duration::from_secs(3600)), 3);
        });
    }
}
