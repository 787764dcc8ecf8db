//! Every tick of a stretch of time, by columns.
//!
//! Points in scene mm (LPS), forces in N in scene axes, times in s since the session's start;
//! the columns that end in `_in_device` have the device's own frame. What came out of each tick
//! stands beside what it was given, so that the ticks can be computed again (`replay.rs`).

use glam::{DQuat, DVec3};

use crate::scene::ToolStatus;
use crate::servo::{HandTarget, TickInputs, TickRecord};

/// Longest recording, in ticks: an hour at 1 kHz, some 1 GB.
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
    /// The segment that was touched, as the picture knew it; 0 where there was none.
    pub touched: Vec<u8>,
    /// Volume that the tool has changed since it was pressed last, as the picture knew it [mm³].
    pub tool_volume: Vec<f64>,
    /// Time that it was at work [s].
    pub tool_time: Vec<f64>,
    /// Its power on what it removes; 0 where it is not pressed [N·mm/s].
    pub tool_load: Vec<f64>,
    /// Number of the last command executed, in the tick or before it.
    pub command: Vec<u64>,
    /// Number of the device's reading.
    pub reading: Vec<u64>,
    /// When it was read.
    pub read_at: Vec<f64>,
    /// Where the device was.
    pub position_in_device: Vec<DVec3>,
    /// Its velocity [mm/s].
    pub velocity_in_device: Vec<DVec3>,
    /// `device_from_handle`.
    pub orientation: Vec<DQuat>,
    /// Pressed buttons, one bit each.
    pub buttons: Vec<u32>,
    /// Where the person last wanted the hand to be.
    pub hand_target: Vec<DVec3>,
    /// Number of that target.
    pub hand_number: Vec<u64>,
    /// Whether what is replaced could be given back.
    pub has_room: Vec<bool>,
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

    /// Whether all columns are of the same length.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        let vectors = [
            &self.device,
            &self.hand,
            &self.proxy,
            &self.force,
            &self.sent_force,
            &self.position_in_device,
            &self.velocity_in_device,
            &self.hand_target,
        ];
        let others = [
            self.time.len(),
            self.contact.len(),
            self.touched.len(),
            self.tool_volume.len(),
            self.tool_time.len(),
            self.tool_load.len(),
            self.command.len(),
            self.reading.len(),
            self.read_at.len(),
            self.orientation.len(),
            self.buttons.len(),
            self.hand_number.len(),
            self.has_room.len(),
        ];
        vectors
            .map(Vec::len)
            .into_iter()
            .chain(others)
            .all(|length| length == self.len())
    }

    /// From the first tick to the last [s].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// What a tick was given.
    #[must_use]
    pub fn inputs(&self, row: usize) -> TickInputs {
        TickInputs {
            time: self.time[row],
            reading: self.reading[row],
            read_at: self.read_at[row],
            position_in_device: self.position_in_device[row],
            velocity_in_device: self.velocity_in_device[row],
            orientation: self.orientation[row],
            buttons: self.buttons[row],
            hand: HandTarget {
                point: self.hand_target[row],
                number: self.hand_number[row],
            },
            has_room: self.has_room[row],
        }
    }

    /// Appends a tick in which a segment was touched, or 0.
    pub fn push(&mut self, record: &TickRecord, touched: u8) {
        self.tick.push(record.tick);
        self.time.push(record.time);
        self.device.push(record.device);
        self.hand.push(record.hand);
        self.proxy.push(record.proxy);
        self.force.push(record.force);
        self.sent_force.push(record.sent_force);
        self.contact.push(record.contact);
        self.touched.push(touched);
        self.tool_volume.push(0.0);
        self.tool_time.push(0.0);
        self.tool_load.push(0.0);
        self.command.push(record.command);
        let inputs = &record.inputs;
        self.reading.push(inputs.reading);
        self.read_at.push(inputs.read_at);
        self.position_in_device.push(inputs.position_in_device);
        self.velocity_in_device.push(inputs.velocity_in_device);
        self.orientation.push(inputs.orientation);
        self.buttons.push(inputs.buttons);
        self.hand_target.push(inputs.hand.point);
        self.hand_number.push(inputs.hand.number);
        self.has_room.push(inputs.has_room);
    }

    /// Notes what the tool had done by the last tick.
    pub fn note_tool(&mut self, tool: &ToolStatus) {
        let load = if tool.on { tool.report.load } else { 0.0 };
        let noted = [
            (&mut self.tool_volume, tool.report.volume),
            (&mut self.tool_time, tool.report.time),
            (&mut self.tool_load, load),
        ];
        for (column, number) in noted {
            if let Some(last) = column.last_mut() {
                *last = number;
            }
        }
    }
}
