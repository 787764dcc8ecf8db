//! One tick of the device: read where it is, send the newest force that is safe.
//!
//! The last word on every force is here: the watchdog, the safety stage, and zero when the
//! session ends, whoever ends it. Frame: device; mm, N, s.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;
use palpate_device::{DeviceLimits, HapticDevice};
use palpate_haptics::safety::{ForceLimits, ForceOff, Safety};

use crate::handover::{DeviceChannels, DeviceSample, ForceCommand};
use crate::shared::Shared;

/// A force older than this is not sent [s].
pub const WATCHDOG_SECS: f64 = 0.010;

/// The device with all that its thread owns.
pub struct DeviceLoop {
    device: Box<dyn HapticDevice>,
    limits: DeviceLimits,
    channels: DeviceChannels,
    safety: Safety,
    shared: Arc<Shared>,
    dt: f64,
    readings: u64,
    /// Whether the watchdog holds the force at zero now.
    tripped: bool,
}

impl DeviceLoop {
    /// A device that is read every `dt` [s].
    #[must_use]
    pub fn new(
        device: Box<dyn HapticDevice>,
        channels: DeviceChannels,
        shared: Arc<Shared>,
        dt: f64,
    ) -> Self {
        let limits = device.limits();
        Self {
            device,
            limits,
            channels,
            safety: Safety::default(),
            shared,
            dt,
            readings: 0,
            tripped: false,
        }
    }

    /// One tick at `now` [s].
    pub fn step(&mut self, now: f64) {
        let state = self.device.read(self.dt);
        self.readings += 1;
        self.channels.samples.write(DeviceSample {
            number: self.readings,
            time: now,
            state,
            sent_in_device: self.safety.sent(),
        });

        let command = *self.channels.forces.read();
        let force = self.safe_force(&command, now);
        self.device.write(force, DVec3::ZERO);
        if command.tick > 0 {
            self.device.set_hand(Some(command.hand_in_device));
        }
        self.count();
    }

    /// Sends zero force. A driver that fails even at that is left alone: there is nothing
    /// more that can be done.
    pub fn release(&mut self) {
        self.safety.release(ForceOff::Stopped, 0.0);
        let device = &mut self.device;
        let _ = catch_unwind(AssertUnwindSafe(|| {
            device.write(DVec3::ZERO, DVec3::ZERO);
        }));
    }

    /// The newest force within all limits; zero where it is too old or nobody vouches for it.
    fn safe_force(&mut self, command: &ForceCommand, now: f64) -> DVec3 {
        // before the first command there is nothing to send, and nothing to take away
        if command.tick == 0 || self.shared.stopping() {
            return self.safety.release(ForceOff::NotStarted, self.dt);
        }
        let stale = now - command.time > WATCHDOG_SECS;
        if stale && !self.tripped {
            self.shared.counters.watchdog.fetch_add(1, Relaxed);
        }
        self.tripped = stale;
        if stale {
            return self.safety.release(ForceOff::ServoLate, self.dt);
        }
        self.safety.set_limits(ForceLimits {
            max_force: command.max_force.min(self.limits.max_force),
            ..ForceLimits::default()
        });
        self.safety.limit(command.force_in_device, self.dt)
    }

    fn count(&self) {
        let counted = self.safety.counters();
        let counters = &self.shared.counters;
        counters.clamped.store(counted.clamped, Relaxed);
        counters.slewed.store(counted.slewed, Relaxed);
        counters.not_finite.store(counted.not_finite, Relaxed);
    }
}

impl Drop for DeviceLoop {
    fn drop(&mut self) {
        self.release();
    }
}
