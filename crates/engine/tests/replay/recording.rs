//! What the picture keeps of the servo's ticks: all of them, or it says so.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, Sender};

use glam::DVec3;
use palpate_engine::notice::{Notice, NoticeLevel};
use palpate_engine::picture::{FrameCollector, FrameSources, RateReaders, SimulationStatus};
use palpate_engine::servo::{Shared, TickRecord};
use palpate_engine::threads::RateMeter;
use rtrb::{Producer, RingBuffer};
use triple_buffer::{Input, triple_buffer};

/// A picture with bare ends.
struct Bare {
    picture: FrameCollector,
    records: Producer<TickRecord>,
    status: Input<SimulationStatus>,
    shared: Arc<Shared>,
    tick: u64,
    _notices: Sender<Notice>,
}

impl Bare {
    fn new() -> Self {
        let (records, records_out) = RingBuffer::new(64);
        let (status, status_out) = triple_buffer(&SimulationStatus::default());
        let (notices, notices_out) = mpsc::channel();
        let shared = Arc::new(Shared::default());
        let reader = || RateMeter::new(1000).1;
        let sources = FrameSources {
            records: records_out,
            status: status_out,
            notices: notices_out,
            rates: RateReaders {
                device: reader(),
                servo: reader(),
                simulation: reader(),
                picture: reader(),
            },
            shared: Arc::clone(&shared),
        };
        Self {
            picture: FrameCollector::new(sources, 1000, DVec3::ZERO),
            records,
            status,
            shared,
            tick: 0,
            _notices: notices,
        }
    }

    fn tick(&mut self, contact: bool) {
        let record = TickRecord {
            tick: self.tick,
            time: self.tick as f64 * 1e-3,
            contact,
            ..TickRecord::default()
        };
        self.records.push(record).unwrap();
        self.tick += 1;
    }

    fn warnings(&mut self) -> Vec<String> {
        let notices = self.picture.frame(0).notices.into_iter();
        notices
            .filter(|notice| notice.level == NoticeLevel::Warning)
            .map(|notice| notice.text)
            .collect()
    }
}

#[test]
fn a_recording_that_is_full_says_so_once_and_keeps_what_it_has() {
    let mut bare = Bare::new();
    bare.picture.limit_recordings(10);
    bare.tick(false);
    bare.picture.start_recording();
    for _ in 0..25 {
        bare.tick(true);
    }
    let warnings = bare.warnings();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("full after 10 ticks"), "{warnings:?}");
    bare.tick(true);
    assert!(bare.warnings().is_empty());
    let recording = bare.picture.stop_recording().unwrap();
    assert_eq!(recording.tick, (1..11).collect::<Vec<u64>>());
    assert!(recording.is_whole());
}

#[test]
fn lost_ticks_are_told_when_the_recording_ends() {
    let mut bare = Bare::new();
    let lost = |bare: &Bare, count| {
        let counters = &bare.shared.counters;
        counters.lost_records.fetch_add(count, Ordering::Relaxed);
    };
    // those from before do not belong to it
    lost(&bare, 5);
    bare.picture.start_recording();
    bare.tick(false);
    lost(&bare, 7);
    assert!(bare.picture.stop_recording().is_some());
    let warnings = bare.warnings();
    assert!(
        warnings[0].starts_with("7 ticks are missing"),
        "{warnings:?}"
    );
}

#[test]
fn the_segment_that_is_touched_stands_in_ticks_with_contact_only() {
    let mut bare = Bare::new();
    bare.picture.start_recording();
    bare.status.write(SimulationStatus {
        touched: 3,
        ..SimulationStatus::default()
    });
    bare.tick(false);
    bare.tick(true);
    let recording = bare.picture.stop_recording().unwrap();
    assert_eq!(recording.touched, [0, 3]);
}

#[test]
fn a_frame_tells_how_long_the_recording_is() {
    let mut bare = Bare::new();
    assert_eq!(bare.picture.frame(0).recording, None);
    bare.picture.start_recording();
    assert_eq!(bare.picture.frame(0).recording, Some(0.0));
    for _ in 0..21 {
        bare.tick(false);
    }
    // 21 ticks are 20 ms from the first to the last; rounding of times of some ms
    let seconds = bare.picture.frame(0).recording.unwrap();
    assert!((seconds - 0.020).abs() < 1e-12, "{seconds}");
    assert!(bare.picture.stop_recording().is_some());
    assert_eq!(bare.picture.frame(0).recording, None);
}
