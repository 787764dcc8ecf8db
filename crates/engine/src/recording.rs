//! Every tick of a stretch of time, by columns.
//!
//! Points in scene mm (LPS), forces in N in scene axes, times in s since the session's start.

use glam::DVec3;

use crate::handover::TickRecord;

/// Longest recording, in ticks: an hour at 1 kHz, some 500 MB.
pub const MAX_TICKS: usize = 3_600_000;

/// A recording, one row per tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Number of the tick; a gap means that records were lost.
    pub tick: Vec<u64>,
    /// Time of the tick [s].
    pub time: Vec<f64>,
    /// Where the device was.
    pub device: Vec<DVec3>,
    /// Where the hand pulled it to.
    pub hand: Vec<DVec3>,
    /// Where the probe was.
    pub proxy: Vec<DVec3>,
    /// The force of the contact, before the safety stage.
    pub force: Vec<DVec3>,
    /// The force that was last sent to the device when the tick began.
    pub sent_force: Vec<DVec3>,
    /// Whether an obstacle held the probe back.
    pub contact: Vec<bool>,
}

impl Recording {
    /// Number of ticks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tick.len()
    }

    /// Whether no tick was recorded.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tick.is_empty()
    }

    /// Appends a tick; false where the recording is full.
    pub fn push(&mut self, record: &TickRecord) -> bool {
        if self.len() >= MAX_TICKS {
            return false;
        }
        self.tick.push(record.tick);
        self.time.push(record.time);
        self.device.push(record.device);
        self.hand.push(record.hand);
        self.proxy.push(record.proxy);
        self.force.push(record.force);
        self.sent_force.push(record.sent_force);
        self.contact.push(record.contact);
        true
    }
}
