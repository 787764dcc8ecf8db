//! Time of a piece of work that is to end early rather than late: processor time of its own thread.
//!
//! On a machine that is busy with other programs, wall time passes while the thread waits for a
//! core. Work that ended by it would be less and less done the busier the machine is, and what it
//! finds would depend on that. Processor time passes with the work alone. A limit on wall time
//! remains, [`STRETCH`] times as long, so that whoever waits gets something. Where the system
//! tells no processor time of a thread, wall time counts alone.
//!
//! For work on one thread: time that others spend for it does not count.

use std::time::{Duration, Instant};

use crate::model::Budget;

/// Wall time at most, over the processor time that is given.
const STRETCH: u32 = 4;

/// A piece of work that has begun.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WorkTime {
    /// Of the processor time of the thread.
    began: Option<Duration>,
    wall: Instant,
    given: Option<Duration>,
}

impl WorkTime {
    /// Begins now; given is the time that the budget leaves from now on.
    pub fn begin(budget: &Budget) -> Self {
        let wall = Instant::now();
        Self {
            began: thread_time(),
            wall,
            given: budget
                .deadline
                .map(|end| end.saturating_duration_since(wall)),
        }
    }

    /// The same time, from now on.
    pub fn anew(self) -> Self {
        Self {
            began: thread_time(),
            wall: Instant::now(),
            ..self
        }
    }

    /// Whether this share of the time is over.
    pub fn is_over(&self, share: f64) -> bool {
        let Some(given) = self.given.map(|given| given.mul_f64(share)) else {
            return false;
        };
        let wall = self.wall.elapsed();
        is_over(
            given,
            wall,
            self.began
                .zip(thread_time())
                .map(|(from, to)| to.saturating_sub(from)),
        )
    }
}

/// Whether a time is over after so much wall and processor time.
fn is_over(given: Duration, wall: Duration, processor: Option<Duration>) -> bool {
    // what is not over by the wall is not over by the processor
    match processor {
        Some(processor) => processor >= given || wall >= given * STRETCH,
        None => wall >= given,
    }
}

/// Processor time of the calling thread; none where the system does not tell.
#[cfg(target_os = "linux")]
fn thread_time() -> Option<Duration> {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: `time` is a valid timespec, and the system writes nothing else
    let result = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    (result == 0).then(|| {
        Duration::new(
            time.tv_sec.unsigned_abs(),
            u32::try_from(time.tv_nsec).unwrap_or(0),
        )
    })
}

/// Processor time of the calling thread; none where the system does not tell.
#[cfg(not(target_os = "linux"))]
fn thread_time() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIVEN: Duration = Duration::from_millis(16);

    #[test]
    fn a_thread_that_waits_for_a_core_still_has_its_time() {
        let waited = (STRETCH - 1) * GIVEN;
        assert!(!is_over(GIVEN, waited, Some(GIVEN / 2)));
        assert!(is_over(GIVEN, waited, Some(GIVEN)));
        // but nobody waits for it without end
        assert!(is_over(GIVEN, STRETCH * GIVEN, Some(GIVEN / 2)));
        // where only the wall is known, it counts
        assert!(is_over(GIVEN, GIVEN, None));
        assert!(!is_over(GIVEN, GIVEN / 2, None));
    }

    #[test]
    fn without_a_deadline_no_time_is_ever_over_and_a_past_one_is_at_once() {
        assert!(!WorkTime::begin(&Budget::iterations(1)).is_over(0.0));
        let late = Budget {
            deadline: Some(Instant::now()),
            ..Budget::iterations(1)
        };
        assert!(WorkTime::begin(&late).is_over(0.5));
    }

    #[test]
    fn time_that_begins_anew_is_whole_again() {
        let budget = Budget {
            deadline: Some(Instant::now() + Duration::from_secs(60)),
            ..Budget::iterations(1)
        };
        let begun = WorkTime::begin(&budget);
        let spent = WorkTime {
            began: None,
            wall: begun.wall.checked_sub(Duration::from_secs(90)).unwrap(),
            ..begun
        };
        assert!(spent.is_over(1.0) && !spent.anew().is_over(0.5));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn time_that_a_thread_sleeps_is_no_work() {
        let before = thread_time().unwrap();
        std::thread::sleep(Duration::from_millis(20));
        assert!(thread_time().unwrap() - before < Duration::from_millis(20));
    }
}
