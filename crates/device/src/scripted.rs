//! A device that follows a written path, whatever is pushed: for tests and measurements.
//!
//! Frame: device; mm, s, N. Between two samples the position is linear in time; before
//! the first and after the last it stays.

use crate::{DeviceLimits, DeviceState, HapticDevice, saturated};
use glam::DVec3;

/// A position at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSample {
    /// Time since the device was opened [s].
    pub time: f64,
    /// End point [mm].
    pub position: DVec3,
}

/// Why a path cannot be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PathError {
    /// There is nothing to follow.
    #[error("scripted path: no samples given; allowed: at least one")]
    Empty,
    /// A sample is not a time and a point.
    #[error("scripted path: sample {index} is not finite; allowed: finite time and position")]
    NotFinite {
        /// Which sample.
        index: usize,
    },
    /// Time does not rise.
    #[error(
        "scripted path: sample {index} is at {time} s, not after {before} s; allowed: rising times"
    )]
    NotRising {
        /// Which sample.
        index: usize,
        /// Time of the sample [s].
        time: f64,
        /// Time of the sample before it [s].
        before: f64,
    },
}

/// The device: a path and where on it it is.
#[derive(Clone, Debug)]
pub struct ScriptedDevice {
    samples: Vec<PathSample>,
    limits: DeviceLimits,
    /// Index of the first sample that is later than now.
    ahead: usize,
    time: f64,
    force: DVec3,
}

impl ScriptedDevice {
    /// A device at the start of the path, at time 0.
    ///
    /// # Errors
    /// [`PathError`] where the path is empty, not finite, or its times do not rise.
    pub fn new(samples: Vec<PathSample>, limits: DeviceLimits) -> Result<Self, PathError> {
        if samples.is_empty() {
            return Err(PathError::Empty);
        }
        for (index, sample) in samples.iter().enumerate() {
            if !(sample.time.is_finite() && sample.position.is_finite()) {
                return Err(PathError::NotFinite { index });
            }
        }
        for (index, pair) in samples.windows(2).enumerate() {
            if pair[1].time <= pair[0].time {
                return Err(PathError::NotRising {
                    index: index + 1,
                    time: pair[1].time,
                    before: pair[0].time,
                });
            }
        }
        Ok(Self {
            samples,
            limits,
            ahead: 0,
            time: 0.0,
            force: DVec3::ZERO,
        })
    }

    /// Time of the last sample [s].
    pub fn duration(&self) -> f64 {
        self.samples.last().map_or(0.0, |sample| sample.time)
    }

    /// Position [mm] and velocity [mm/s] on the path now.
    fn on_path(&mut self) -> (DVec3, DVec3) {
        // time only rises, so the search goes on where it stopped
        while let Some(sample) = self.samples.get(self.ahead)
            && sample.time <= self.time
        {
            self.ahead += 1;
        }
        let before = self.ahead.checked_sub(1).and_then(|i| self.samples.get(i));
        match (before, self.samples.get(self.ahead)) {
            (Some(a), Some(b)) => {
                let velocity = (b.position - a.position) / (b.time - a.time);
                (a.position + velocity * (self.time - a.time), velocity)
            }
            (Some(end), None) | (None, Some(end)) => (end.position, DVec3::ZERO),
            (None, None) => (DVec3::ZERO, DVec3::ZERO),
        }
    }
}

impl HapticDevice for ScriptedDevice {
    fn name(&self) -> &'static str {
        "scripted"
    }

    fn limits(&self) -> DeviceLimits {
        self.limits
    }

    fn read(&mut self, dt: f64) -> DeviceState {
        if dt > 0.0 && dt.is_finite() {
            self.time += dt;
        }
        let (position, velocity) = self.on_path();
        DeviceState {
            position,
            velocity,
            force: self.force,
            time: self.time,
            ..DeviceState::default()
        }
    }

    fn write(&mut self, force: DVec3, _torque: DVec3) {
        self.force = saturated(force, self.limits.max_force);
    }
}
