//! A signal that wakes who waits for something new.

use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Rung by one thread, heard by others; nobody waits for those who do not listen.
#[derive(Debug, Default)]
pub struct ChangeSignal {
    count: Mutex<u64>,
    wake: Condvar,
}

impl ChangeSignal {
    /// Wakes all who wait.
    pub fn notify(&self) {
        // a number is whole, whoever panicked while he held it
        *self.count.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        self.wake.notify_all();
    }

    /// Waits until it has been given more than `heard` times, at most so long; gives how often it
    /// has been.
    #[must_use]
    pub fn wait(&self, known: u64, patience: Duration) -> u64 {
        let count = self.count.lock().unwrap_or_else(PoisonError::into_inner);
        let (count, _) = self
            .wake
            .wait_timeout_while(count, patience, |count| *count == known)
            .unwrap_or_else(PoisonError::into_inner);
        *count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_waits_is_woken_and_what_was_missed_is_heard_at_once() {
        let signal = ChangeSignal::default();
        assert_eq!(signal.wait(0, Duration::ZERO), 0);
        signal.notify();
        signal.notify();
        // an hour, were it not given already
        assert_eq!(signal.wait(0, Duration::from_secs(3600)), 2);
        std::thread::scope(|threads| {
            threads.spawn(|| signal.notify());
            assert_eq!(signal.wait(2, Duration::from_secs(3600)), 3);
        });
    }
}
