//! What all threads of a session see: that it stops, why it failed, and its counters.

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use palpate_haptics::force::ForceOff;

use crate::servo::force_state::ForceState;

/// Interventions of the safety stage and violations of the guarantees since the start.
#[derive(Debug, Default)]
pub struct Counters {
    /// Forces cut to the limit.
    pub clamped: AtomicU64,
    /// Forces whose growth was slowed.
    pub slewed: AtomicU64,
    /// Forces that were not finite and became zero.
    pub not_finite: AtomicU64,
    /// Ticks in which the force was still rising to its full size.
    pub ramped: AtomicU64,
    /// Ticks that waited for a small force to begin with.
    pub waited: AtomicU64,
    /// Ticks in which the force was eased to what the device bears for long.
    pub eased: AtomicU64,
    /// Ticks in which energy was taken out of the coupling.
    pub damped: AtomicU64,
    /// Times that the watchdog took the force away.
    pub watchdog: AtomicU64,
    /// Ticks in which a guarantee was found broken (`guarantee_watch.rs`).
    pub violations: AtomicU64,
    /// What stands between the contact and the hand now, as a number.
    force_state: AtomicU8,
    /// Why no force is sent now, as a number.
    off: AtomicU8,
    /// Ticks whose record was lost, since nobody took the records in time.
    pub lost_records: AtomicU64,
}

impl Counters {
    /// What stands between the contact and the hand now.
    #[must_use]
    pub fn force_state(&self) -> ForceState {
        let number = usize::from(self.force_state.load(Ordering::Relaxed));
        FORCE_STATES.get(number).copied().unwrap_or(ForceState::Off)
    }

    /// Why no force is sent now; none while forces are on.
    #[must_use]
    pub fn off(&self) -> Option<ForceOff> {
        ForceOff::of_number(self.off.load(Ordering::Relaxed))
    }

    /// Tells why no force is sent now.
    pub fn set_off(&self, off: Option<ForceOff>) {
        self.off
            .store(off.map_or(0, |cause| cause as u8), Ordering::Relaxed);
    }

    /// Tells what stands between the contact and the hand now.
    pub fn set_force_state(&self, state: ForceState) {
        let number = FORCE_STATES.iter().position(|&known| known == state);
        self.force_state.store(
            number.unwrap_or(FORCE_STATES.len()) as u8,
            Ordering::Relaxed,
        );
    }
}

const FORCE_STATES: [ForceState; 5] = [
    ForceState::On,
    ForceState::Waiting,
    ForceState::Ramping,
    ForceState::Easing,
    ForceState::Off,
];

/// Seen by all threads of a session.
#[derive(Debug, Default)]
pub struct Shared {
    stopping: AtomicBool,
    failure: Mutex<Option<String>>,
    /// The session's counters.
    pub counters: Counters,
}

impl Shared {
    /// Whether the threads are to end.
    #[must_use]
    pub fn stopping(&self) -> bool {
        self.stopping.load(Ordering::Acquire)
    }

    /// Asks all threads to end.
    pub fn stop(&self) {
        self.stopping.store(true, Ordering::Release);
    }

    /// Asks all threads to end because one failed, which takes the force away; the first reason
    /// stays.
    pub fn fail(&self, reason: String) {
        // the reason is there before anybody can see that there is one
        self.lock_failure().get_or_insert(reason);
        self.counters.watchdog.fetch_add(1, Ordering::Relaxed);
        self.stop();
    }

    /// Why the session ended by itself, if it did.
    #[must_use]
    pub fn failure(&self) -> Option<String> {
        self.lock_failure().clone()
    }

    fn lock_failure(&self) -> std::sync::MutexGuard<'_, Option<String>> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
