//! Ticks at a fixed rate on an absolute schedule.
//!
//! Tick n is due at `start + n · period`. A thread that falls behind skips the ticks whose
//! successor is due already and counts them: it never runs ticks in a burst to catch up.

use crate::threads::clock;

/// Rate of the simulation thread [Hz].
pub const SIMULATION_HZ: u32 = 100;
/// Rate of the picture thread [Hz].
pub const PICTURE_HZ: u32 = 60;

/// One tick that has begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickStart {
    /// When it began, on the monotonic clock [ns].
    pub began_ns: u64,
    /// How long after its due time it began [ns].
    pub late_ns: u64,
    /// Ticks that fell out just after it, since they were over before this one began.
    pub skipped: u64,
}

/// The schedule of one thread.
#[derive(Clone, Copy, Debug)]
pub struct Pacer {
    period_ns: u64,
    due_ns: u64,
}

impl Pacer {
    /// A schedule whose first tick is due at `start_ns`; the rate must lie in 1..=100 000 Hz.
    #[must_use]
    pub fn new(rate_hz: u32, start_ns: u64) -> Self {
        assert!((1..=100_000).contains(&rate_hz), "no rate: {rate_hz} Hz");
        Self {
            period_ns: 1_000_000_000 / u64::from(rate_hz),
            due_ns: start_ns,
        }
    }

    /// When the next tick is due, on the monotonic clock [ns].
    #[must_use]
    pub fn due_ns(&self) -> u64 {
        self.due_ns
    }

    /// Sleeps until the next tick is due and begins it.
    pub fn wait(&mut self) -> TickStart {
        clock::sleep_until(self.due_ns);
        self.begin(clock::now_ns())
    }

    /// Begins the tick that is due, at `now_ns`.
    pub fn begin(&mut self, now_ns: u64) -> TickStart {
        let late_ns = now_ns.saturating_sub(self.due_ns);
        let skipped = late_ns / self.period_ns;
        self.due_ns += (1 + skipped) * self.period_ns;
        TickStart {
            began_ns: now_ns,
            late_ns,
            skipped,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The grid of due times stays where it was, however late a tick begins.
    #[test]
    fn late_ticks_are_skipped_and_the_schedule_does_not_drift() {
        let mut pacer = Pacer::new(1000, 5_000_000);
        assert_eq!(pacer.begin(5_000_100).skipped, 0);

        // 3.4 ms late: the three ticks that would have begun meanwhile fall out
        let start = pacer.begin(9_400_000);
        assert_eq!((start.late_ns, start.skipped), (3_400_000, 3));
        assert_eq!(pacer.due_ns(), 10_000_000);
        assert_eq!(pacer.begin(10_000_000).late_ns, 0);
    }

    #[test]
    fn a_tick_that_begins_early_is_not_late() {
        let mut pacer = Pacer::new(4000, 1_000_000);
        assert_eq!(pacer.begin(999_000).late_ns, 0);
        assert_eq!(pacer.due_ns(), 1_250_000);
    }

    #[test]
    fn waiting_sleeps_until_the_tick_is_due() {
        let start = clock::now_ns() + 3_000_000;
        let mut pacer = Pacer::new(1000, start);
        assert!(pacer.wait().began_ns >= start);
        assert!(pacer.wait().began_ns >= start + 1_000_000);
    }
}
