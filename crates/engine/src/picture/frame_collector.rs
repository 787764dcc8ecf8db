//! Collects what the servo did since the last look and makes a frame of it.
//!
//! The picture thread calls `collect` at its rate, so that the servo's records never pile up;
//! whoever shows the session takes a frame whenever he likes.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::Receiver;

use glam::DVec3;
use palpate_haptics::force::ForceOff;
use rtrb::Consumer;
use triple_buffer::Output;

use crate::notice::Notice;
use crate::picture::frame::{Frame, Rates, Safety, Sample};
use crate::picture::simulation_status::SimulationStatus;
use crate::replay::{MAX_TICKS, Recording};
use crate::servo::{ForceState, Shared, TickRecord};
use crate::threads::RateReader;

/// Samples of the force plot per second, at most.
const SAMPLES_PER_SECOND: u32 = 250;
/// Samples kept for a frame that nobody takes: 10 s.
const MAX_SAMPLES: usize = 10 * SAMPLES_PER_SECOND as usize;
/// Notices kept for a frame that nobody takes.
const MAX_NOTICES: usize = 1000;

/// Where each thread's pace can be read.
#[derive(Debug)]
pub struct RateReaders {
    /// Of the device thread.
    pub device: RateReader,
    /// Of the servo thread.
    pub servo: RateReader,
    /// Of the simulation thread.
    pub simulation: RateReader,
    /// Of the picture thread.
    pub picture: RateReader,
}

/// What the picture reads.
#[derive(Debug)]
pub struct FrameSources {
    /// From the servo.
    pub records: Consumer<TickRecord>,
    /// From the simulation.
    pub status: Output<SimulationStatus>,
    /// From anybody.
    pub notices: Receiver<Notice>,
    /// From the threads.
    pub rates: RateReaders,
    /// Counters and failure.
    pub shared: Arc<Shared>,
}

/// The state of the picture thread.
#[derive(Debug)]
pub struct FrameCollector {
    sources: FrameSources,
    /// Every so many ticks one goes to the plot.
    thinning: u64,
    /// Whether device and servo have real-time priority.
    pub real_time: bool,
    latest: TickRecord,
    samples: VecDeque<Sample>,
    notices: VecDeque<Notice>,
    recording: Option<Recording>,
    /// Longest recording, in ticks.
    max_ticks: usize,
    lost_before_recording: u64,
    failure_shown: bool,
}

impl FrameCollector {
    /// A picture of a servo at `rate_hz`, whose probe begins at `start` [mm].
    #[must_use]
    pub fn new(sources: FrameSources, rate_hz: u32, start: DVec3) -> Self {
        Self {
            sources,
            thinning: u64::from(rate_hz.div_ceil(SAMPLES_PER_SECOND)),
            real_time: false,
            latest: TickRecord {
                device: start,
                hand: start,
                proxy: start,
                ..TickRecord::default()
            },
            samples: VecDeque::with_capacity(MAX_SAMPLES),
            notices: VecDeque::new(),
            recording: None,
            max_ticks: MAX_TICKS,
            lost_before_recording: 0,
            failure_shown: false,
        }
    }

    /// Takes all records and notices that have come.
    pub fn collect(&mut self) {
        while let Ok(record) = self.sources.records.pop() {
            self.take(record);
        }
        while let Ok(notice) = self.sources.notices.try_recv() {
            self.note(notice);
        }
        if !self.failure_shown
            && let Some(reason) = self.sources.shared.failure()
        {
            self.failure_shown = true;
            self.note(Notice::error(format!("The session has ended: {reason}")));
        }
    }

    /// The frame of now, with all that came since the frame before; `now_ns` is the time at
    /// which the threads' paces are read.
    pub fn frame(&mut self, now_ns: u64) -> Frame {
        self.collect();
        let status = *self.sources.status.read();
        let latest = self.latest;
        // a session that stopped or failed sends nothing
        let force = if self.sources.shared.stopping() {
            DVec3::ZERO
        } else {
            latest.sent_force
        };
        Frame {
            tick: latest.tick,
            time: latest.time,
            edit: status.edit,
            device: latest.device,
            hand: latest.hand,
            proxy: latest.proxy,
            contact_point: latest.contact_point,
            normal: latest.normal,
            force,
            contact: latest.contact,
            depth: latest.depth,
            touched: if latest.contact { status.touched } else { 0 },
            probe_radius: status.probe_radius,
            poses: status.poses.into_iter().flatten().collect(),
            grabbed: status.grabbed,
            clutched: status.clutched,
            device_origin: status.device_origin,
            pending: status.pending,
            can_undo: status.can_undo,
            can_redo: status.can_redo,
            step: status.step,
            steps_made: status.steps_made,
            segments_version: status.segments_version,
            voxels_version: status.voxels_version,
            tool: status.tool,
            needle: status.needle,
            matter: status.matter,
            undo_bytes: status.undo_bytes,
            undo_budget: status.undo_budget,
            rates: self.rates(now_ns),
            safety: self.safety(),
            recording: self.recording.as_ref().map(Recording::seconds),
            samples: self.samples.drain(..).collect(),
            notices: self.notices.drain(..).collect(),
        }
    }

    /// Limits the length of recordings [ticks], for tests.
    pub fn limit_recordings(&mut self, max_ticks: usize) {
        self.max_ticks = max_ticks;
    }

    /// Begins a new recording; one that runs is thrown away.
    pub fn start_recording(&mut self) {
        // what came before does not belong to it
        self.collect();
        self.recording = Some(Recording::default());
        self.lost_before_recording = self.lost_records();
    }

    /// Ends the recording and gives it; none where none runs.
    pub fn stop_recording(&mut self) -> Option<Recording> {
        self.collect();
        let lost = self.lost_records() - self.lost_before_recording;
        if self.recording.is_some() && lost > 0 {
            self.note(Notice::warning(format!(
                "{lost} ticks are missing in the recording: the machine was too busy."
            )));
        }
        self.recording.take()
    }

    fn take(&mut self, record: TickRecord) {
        self.latest = record;
        if record.tick.is_multiple_of(self.thinning) {
            if self.samples.len() == MAX_SAMPLES {
                self.samples.pop_front();
            }
            self.samples.push_back(Sample {
                time: record.time,
                force: record.sent_force,
            });
        }
        let Some(recording) = &mut self.recording else {
            return;
        };
        if recording.len() >= self.max_ticks {
            return;
        }
        let status = self.sources.status.read();
        recording.push(&record, if record.contact { status.touched } else { 0 });
        recording.note_tool(&status.tool);
        if recording.len() == self.max_ticks {
            self.note(Notice::warning(format!(
                "The recording is full after {} ticks; later ones are not recorded.",
                self.max_ticks
            )));
        }
    }

    fn note(&mut self, notice: Notice) {
        if self.notices.len() == MAX_NOTICES {
            self.notices.pop_front();
        }
        self.notices.push_back(notice);
    }

    /// The pace of each thread.
    #[must_use]
    pub fn rates(&self, now_ns: u64) -> Rates {
        let readers = &self.sources.rates;
        Rates {
            device: readers.device.read(now_ns),
            servo: readers.servo.read(now_ns),
            simulation: readers.simulation.read(now_ns),
            picture: readers.picture.read(now_ns),
            real_time: self.real_time,
        }
    }

    fn lost_records(&self) -> u64 {
        let counters = &self.sources.shared.counters;
        counters.lost_records.load(Ordering::Relaxed)
    }

    fn safety(&self) -> Safety {
        let counters = &self.sources.shared.counters;
        let stopping = self.sources.shared.stopping();
        Safety {
            clamped: counters.clamped.load(Ordering::Relaxed),
            slewed: counters.slewed.load(Ordering::Relaxed),
            not_finite: counters.not_finite.load(Ordering::Relaxed),
            ramped: counters.ramped.load(Ordering::Relaxed),
            waited: counters.waited.load(Ordering::Relaxed),
            eased: counters.eased.load(Ordering::Relaxed),
            damped: counters.damped.load(Ordering::Relaxed),
            watchdog: counters.watchdog.load(Ordering::Relaxed),
            violations: counters.violations.load(Ordering::Relaxed),
            force: if stopping {
                ForceState::Off
            } else {
                counters.force_state()
            },
            off: if stopping {
                Some(ForceOff::Stopped)
            } else {
                counters.off()
            },
        }
    }
}
