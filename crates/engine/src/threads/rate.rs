//! How a thread keeps its pace: its rate over the last second and how late its ticks begin.
//!
//! The thread itself counts, without waiting; anybody may read at any time. Times in ns here,
//! in the reported figures in Hz and ms.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::threads::pacing::TickStart;

/// A tick that begins later than this counts as late [ns].
pub const LATE_NS: u64 = 2_000_000;

/// Upper ends of the lateness histogram's bins [µs]; the last bin holds all that is later.
pub const LATENESS_BINS_US: [u64; 21] = [
    5, 10, 15, 20, 30, 50, 70, 100, 150, 200, 300, 500, 700, 1_000, 1_500, 2_000, 3_000, 5_000,
    7_000, 10_000, 20_000,
];

const BIN_COUNT: usize = LATENESS_BINS_US.len() + 1;

/// The last second is kept in this many slices.
const SLICES: usize = 10;
const SLICE_NS: u64 = 1_000_000_000 / SLICES as u64;

/// What a thread's pace was.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rate {
    /// The rate it was started with.
    pub asked_hz: f64,
    /// Ticks begun in the last second.
    pub hz: f64,
    /// Ticks begun since the start.
    pub ticks: u64,
    /// Ticks since the start that began more than 2 ms late, or fell out when that late.
    pub late: u64,
    /// Ticks since the start that fell out.
    pub missed: u64,
    /// Worst lateness of the last second [ms].
    pub worst_late_ms: f64,
    /// Worst lateness since the start [ms].
    pub worst_ever_ms: f64,
    /// Begun ticks by lateness, bins as in [`LATENESS_BINS_US`].
    pub lateness: [u64; BIN_COUNT],
}

#[derive(Debug, Default)]
struct Cell {
    hz: AtomicU64,
    ticks: AtomicU64,
    late: AtomicU64,
    missed: AtomicU64,
    worst_ns: AtomicU64,
    worst_ever_ns: AtomicU64,
    last_ns: AtomicU64,
    lateness: [AtomicU64; BIN_COUNT],
}

/// Reads a thread's pace.
#[derive(Clone, Debug)]
pub struct RateReader {
    asked_hz: u32,
    cell: Arc<Cell>,
}

impl RateReader {
    /// The figures as they stand at `now_ns`; a thread that stands still has a rate of 0.
    #[must_use]
    pub fn read(&self, now_ns: u64) -> Rate {
        let cell = &*self.cell;
        let still = now_ns.saturating_sub(cell.last_ns.load(Relaxed)) > 1_000_000_000;
        let hz = f64::from_bits(cell.hz.load(Relaxed));
        let mut lateness = [0; BIN_COUNT];
        for (count, bin) in lateness.iter_mut().zip(&cell.lateness) {
            *count = bin.load(Relaxed);
        }
        Rate {
            asked_hz: f64::from(self.asked_hz),
            hz: if still { 0.0 } else { hz },
            ticks: cell.ticks.load(Relaxed),
            late: cell.late.load(Relaxed),
            missed: cell.missed.load(Relaxed),
            worst_late_ms: cell.worst_ns.load(Relaxed) as f64 * 1e-6,
            worst_ever_ms: cell.worst_ever_ns.load(Relaxed) as f64 * 1e-6,
            lateness,
        }
    }
}

/// Counts a thread's ticks; owned by the thread.
#[derive(Debug)]
pub struct RateMeter {
    cell: Arc<Cell>,
    period_ns: u64,
    first_ns: Option<u64>,
    /// Number of the running slice since `first_ns`.
    slice: u64,
    counts: [u64; SLICES + 1],
    worsts: [u64; SLICES + 1],
}

impl RateMeter {
    /// A meter of a thread that was asked for `asked_hz`, and its reader.
    #[must_use]
    pub fn new(asked_hz: u32) -> (Self, RateReader) {
        let cell = Arc::new(Cell::default());
        let reader = RateReader {
            asked_hz,
            cell: Arc::clone(&cell),
        };
        let meter = Self {
            cell,
            period_ns: 1_000_000_000 / u64::from(asked_hz.max(1)),
            first_ns: None,
            slice: 0,
            counts: [0; SLICES + 1],
            worsts: [0; SLICES + 1],
        };
        (meter, reader)
    }

    /// Counts one tick.
    pub fn count(&mut self, start: TickStart) {
        self.turn_slices(start.began_ns);
        let running = self.slice as usize % (SLICES + 1);
        self.counts[running] += 1;
        self.worsts[running] = self.worsts[running].max(start.late_ns);

        let cell = &*self.cell;
        let worst = self.worsts.iter().copied().max().unwrap_or(0);
        cell.worst_ns.store(worst, Relaxed);
        cell.worst_ever_ns.fetch_max(start.late_ns, Relaxed);
        cell.last_ns.store(start.began_ns, Relaxed);
        cell.ticks.fetch_add(1, Relaxed);
        cell.missed.fetch_add(start.skipped, Relaxed);
        cell.late.fetch_add(self.late_ticks(start), Relaxed);
        cell.lateness[bin_of(start.late_ns)].fetch_add(1, Relaxed);
    }

    /// The tick itself and those that fell out, as far as they were due more than 2 ms before.
    fn late_ticks(&self, start: TickStart) -> u64 {
        if start.late_ns <= LATE_NS {
            return 0;
        }
        let skipped_late = (start.late_ns - LATE_NS) / self.period_ns;
        1 + skipped_late.min(start.skipped)
    }

    /// Closes the slices that are over and computes the rate from the full ones.
    fn turn_slices(&mut self, now_ns: u64) {
        let first_ns = *self.first_ns.get_or_insert(now_ns);
        let slice = now_ns.saturating_sub(first_ns) / SLICE_NS;
        if slice == self.slice {
            return;
        }
        for passed in (self.slice + 1..=slice).take(SLICES + 1) {
            self.counts[passed as usize % (SLICES + 1)] = 0;
            self.worsts[passed as usize % (SLICES + 1)] = 0;
        }
        self.slice = slice;
        let full = slice.min(SLICES as u64);
        let ticks: u64 = self.counts.iter().sum();
        let hz = ticks as f64 / (full * SLICE_NS) as f64 * 1e9;
        self.cell.hz.store(hz.to_bits(), Relaxed);
    }
}

fn bin_of(late_ns: u64) -> usize {
    LATENESS_BINS_US.partition_point(|end_us| end_us * 1000 < late_ns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start(began_ns: u64, late_ns: u64, skipped: u64) -> TickStart {
        TickStart {
            began_ns,
            late_ns,
            skipped,
        }
    }

    #[test]
    fn a_thread_that_keeps_its_pace_shows_its_rate() {
        let (mut meter, reader) = RateMeter::new(1000);
        for tick in 0..3000 {
            meter.count(start(7 + tick * 1_000_000, 10_000, 0));
        }
        let rate = reader.read(3_000_000_000);
        // one tick more or less may fall into the second
        assert!((rate.hz - 1000.0).abs() <= 1.0, "{rate:?}");
        assert_eq!((rate.ticks, rate.late, rate.missed), (3000, 0, 0));
        // 10 µs late, each of them
        assert_eq!(rate.lateness[1], 3000);
    }

    #[test]
    fn the_rate_is_known_before_the_first_second_is_over() {
        let (mut meter, reader) = RateMeter::new(100);
        for tick in 0..31 {
            meter.count(start(tick * 10_000_000, 0, 0));
        }
        // 30 ticks in the three full slices
        assert_eq!(reader.read(300_000_000).hz, 100.0);
    }

    #[test]
    fn a_thread_that_stands_still_has_no_rate() {
        let (mut meter, reader) = RateMeter::new(100);
        for tick in 0..200 {
            meter.count(start(tick * 10_000_000, 0, 0));
        }
        assert_eq!(reader.read(9_000_000_000).hz, 0.0);
    }

    /// Of a stall of 5.5 ms at 1 kHz, the tick itself and those due 4.5, 3.5 and 2.5 ms before
    /// count as late; those due 1.5 and 0.5 ms before only fell out.
    #[test]
    fn ticks_that_fell_out_count_as_late_too() {
        let (mut meter, reader) = RateMeter::new(1000);
        meter.count(start(0, 0, 0));
        meter.count(start(6_500_000, 5_500_000, 5));
        let rate = reader.read(7_000_000);
        assert_eq!((rate.late, rate.missed), (4, 5));
        assert_eq!(rate.worst_late_ms, 5.5);
    }

    #[test]
    fn the_worst_lateness_is_forgotten_after_a_second_but_the_worst_ever_is_not() {
        let (mut meter, reader) = RateMeter::new(1000);
        meter.count(start(0, 1_500_000, 0));
        for tick in 1..2500 {
            meter.count(start(tick * 1_000_000, 0, 0));
        }
        let rate = reader.read(2_500_000_000);
        assert_eq!((rate.worst_late_ms, rate.worst_ever_ms), (0.0, 1.5));
    }
}
