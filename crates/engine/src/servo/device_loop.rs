//! One tick of the device: read where it is, follow the contact there, send what is safe.
//!
//! The servo hands over the contact as a law, not as a force: it is evaluated here, at the
//! device's rate and with its newest position, so that device and servo can run at different
//! rates. The last word on every force is here as well: the passivity controller, the watchdog,
//! the safety stage, and zero when the session ends, whoever ends it. Frame: device; mm, N, s.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;
use palpate_device::{DeviceLimits, DeviceState, HapticDevice};
use palpate_haptics::force::{ForceLimits, ForceOff, Passivity, Safety, SafetySettings};

use crate::servo::channels::{DeviceChannels, ForceCommand};
use crate::servo::force_state::ForceState;
use crate::servo::guarantee_watch::is_safe;
use crate::servo::inputs::DeviceSample;
use crate::servo::shared::Shared;

/// A force older than this is not sent [s].
pub const WATCHDOG_SECS: f64 = 0.010;

/// The device with all that its thread owns.
pub struct DeviceLoop {
    device: Box<dyn HapticDevice>,
    limits: DeviceLimits,
    channels: DeviceChannels,
    passivity: Passivity,
    take_back: bool,
    safety: Safety,
    shared: Arc<Shared>,
    dt: f64,
    readings: u64,
    /// Where it was read last [mm].
    position: DVec3,
    /// Whether the watchdog holds the force at zero now.
    tripped: bool,
}

impl DeviceLoop {
    /// A device that is read every `dt` [s] and whose forces begin as the settings say; none is
    /// held above the device's own continuous force for long.
    #[must_use]
    pub fn new(
        device: Box<dyn HapticDevice>,
        channels: DeviceChannels,
        shared: Arc<Shared>,
        dt: f64,
        safety: SafetySettings,
    ) -> Self {
        let limits = device.limits();
        let safety = SafetySettings {
            continuous_force: safety.continuous_force.min(limits.max_continuous_force),
            ..safety
        };
        Self {
            device,
            limits,
            channels,
            passivity: Passivity::default(),
            take_back: safety.take_back,
            safety: Safety::starting(ForceLimits::default(), safety),
            shared,
            dt,
            readings: 0,
            position: DVec3::ZERO,
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
        let last = self.safety.sent();
        let force = self.safe_force(&command, &state, now);
        if !is_safe(force, last, &self.limits_of(&command), self.dt) {
            self.shared.counters.violations.fetch_add(1, Relaxed);
        }
        self.device.write(force, DVec3::ZERO);
        if command.tick > 0 {
            self.device.set_hand(Some(command.hand_in_device));
        }
        self.position = state.position;
        self.report();
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

    /// Why no force is sent now, and how much is known of it; none while forces are on.
    #[must_use]
    pub fn off(&self) -> Option<ForceOff> {
        self.safety.off()
    }

    /// The newest law's force within all limits; zero where it is too old or nobody vouches
    /// for it.
    fn safe_force(&mut self, command: &ForceCommand, state: &DeviceState, now: f64) -> DVec3 {
        // before the first command there is nothing to send, and nothing to take away
        if command.tick == 0 {
            return self.nothing(ForceOff::NotStarted);
        }
        if self.shared.stopping() {
            return self.nothing(ForceOff::Stopped);
        }
        let stale = now - command.time > WATCHDOG_SECS;
        if stale && !self.tripped {
            self.shared.counters.watchdog.fetch_add(1, Relaxed);
        }
        self.tripped = stale;
        if stale {
            return self.nothing(ForceOff::ServoLate);
        }
        self.safety.set_limits(self.limits_of(command));
        let passive = self.passive_force(command, state);
        self.safety.limit(passive, self.dt)
    }

    /// What a person and the device allow.
    fn limits_of(&self, command: &ForceCommand) -> ForceLimits {
        ForceLimits {
            max_force: command.max_force.min(self.limits.max_force),
            ..ForceLimits::default()
        }
    }

    /// The law's force where the device is now, without energy from nowhere.
    fn passive_force(&mut self, command: &ForceCommand, state: &DeviceState) -> DVec3 {
        let moved = state.position - self.position;
        let law = &command.law;
        // friction against the mean velocity of the tick is the least it can have eaten
        let eaten = self.limits.damping * moved.length_squared() / self.dt;
        let stored = law.energy_at(state.position, self.safety.largest()) * self.safety.share();
        self.passivity.observe(state.force, moved, eaten, stored);
        let wanted = law.force_at(state.position, state.velocity);
        if self.take_back {
            self.passivity.control(wanted, moved, self.dt)
        } else {
            wanted
        }
    }

    fn nothing(&mut self, cause: ForceOff) -> DVec3 {
        self.passivity.forget();
        self.safety.release(cause, self.dt)
    }

    /// Tells the counters and the state of the force.
    fn report(&self) {
        let counted = self.safety.counters();
        let counters = &self.shared.counters;
        for (counter, count) in [
            (&counters.clamped, counted.clamped),
            (&counters.slewed, counted.slewed),
            (&counters.not_finite, counted.not_finite),
            (&counters.ramped, counted.ramped),
            (&counters.waited, counted.waited),
            (&counters.eased, counted.eased),
            (&counters.damped, self.passivity.acted()),
        ] {
            counter.store(count, Relaxed);
        }
        counters.set_force_state(self.force_state());
        counters.set_off(self.safety.off());
    }

    fn force_state(&self) -> ForceState {
        match self.safety.off() {
            Some(ForceOff::NotStarted | ForceOff::Waiting) => ForceState::Waiting,
            Some(ForceOff::ServoLate | ForceOff::Stopped | ForceOff::NotFinite) => ForceState::Off,
            None if self.safety.share() < 1.0 => ForceState::Ramping,
            None if self.safety.eases() => ForceState::Easing,
            None => ForceState::On,
        }
    }
}

impl Drop for DeviceLoop {
    fn drop(&mut self) {
        self.release();
    }
}
