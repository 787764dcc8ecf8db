//! A device that is computed: a mass that a hand pulls and motors push.
//!
//! With it the mouse feels the wall through what it sees: the mouse moves the hand's
//! target, the hand pulls the mass there like a damped spring, and the force feedback
//! stops the mass at the bone while the target goes deeper. It has what makes real
//! devices hard to keep stable: inertia, encoder steps and delay.
//!
//! Frame: device; mm, s, N, kg. Newton's law reads a [mm/s²] = 1000 F / m.
//! Time stepping is the implicit midpoint rule, which keeps the energy balance of the
//! damped spring exactly and is stable at any step; the motors hold their force between
//! two ticks, as real amplifiers do.
//! Source: Hairer, Lubich, Wanner, "Geometric Numerical Integration" (2006), II.1.

use crate::output_delay::{MAX_DELAY_TICKS, OutputDelay};
use crate::velocity_estimate::VelocityEstimate;
use crate::{DeviceLimits, DeviceState, HapticDevice, Work, saturated};
use glam::DVec3;

/// Longest step of the integration [s]; a tick is cut into equal parts below it.
const LONGEST_STEP: f64 = 125e-6;
/// Longest time that one reading advances [s]: a stalled thread does not replay its gap.
const LONGEST_TICK: f64 = 0.05;

/// What a simulated device is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedSettings {
    /// Moving mass of arm and hand [kg], > 0.
    pub mass: f64,
    /// The device's own viscous friction [N·s/mm], >= 0.
    pub damping: f64,
    /// The device's own dry friction [N], >= 0.
    pub friction: f64,
    /// Spring between hand target and device [N/mm], >= 0.
    pub hand_stiffness: f64,
    /// Damping of the hand [N·s/mm], >= 0.
    pub hand_damping: f64,
    /// Step of the encoders [mm]; 0 is exact.
    pub encoder_step: f64,
    /// Ticks between sending a force and its action, at most [`MAX_DELAY_TICKS`].
    pub delay_ticks: usize,
    /// Time constant of the velocity estimate [s], >= 0.
    pub velocity_time: f64,
    /// What the device says it can bear; forces saturate at `max_force`.
    pub limits: DeviceLimits,
}

impl Default for SimulatedSettings {
    /// A desktop device in a relaxed hand; the reasons stand beside the figures.
    fn default() -> Self {
        let mass = 0.1;
        // as of a Touch (4 N per m/s): above K (T/2 + t_d) = 0.0015 of the default wall
        let damping = 0.004;
        // well below the default coupling of 1 N/mm: a quarter of the hand's way into a
        // wall is seen as depth, three quarters as the hand's own give
        let hand_stiffness = 0.3;
        Self {
            mass,
            damping,
            friction: 0.0,
            hand_stiffness,
            // critical: 2 sqrt(k m), k in N/m and the result per mm
            hand_damping: 2.0 * (1000.0 * hand_stiffness * mass).sqrt() / 1000.0,
            // between two encoder marks a pressing device hunts for ever, and the plot of its
            // force shows it; a mouse has no such marks
            encoder_step: 0.0,
            delay_ticks: 1,
            velocity_time: 0.005,
            limits: DeviceLimits {
                // a mouse easily pulls 30 mm into a bone: at the 3.3 N of a Touch the
                // force would end after 14 mm, at 10 N (between a Desktop and an omega) it
                // grows over 43 mm. No motor grows warm here.
                max_force: 10.0,
                max_continuous_force: 10.0,
                damping,
                // three quarters of damping / (T/2 + t_d) at 1 kHz and one tick of delay:
                // tapping gains nothing up to here, and does so at the whole of it
                max_stiffness: 2.0,
                // further than any scan is long
                workspace_radius: 2000.0,
            },
        }
    }
}

/// Why a simulated device cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// A quantity is outside what is physical.
    #[error("simulated device: {name} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// Name of the setting.
        name: &'static str,
        /// The value given.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The device cannot stand there.
    #[error("simulated device: position is {0} mm; allowed: finite coordinates")]
    Position(DVec3),
}

impl SimulatedSettings {
    /// Checks each quantity; the error names the first that is not allowed.
    pub fn check(&self) -> Result<(), SettingsError> {
        const POSITIVE: &str = "finite, > 0";
        const NOT_NEGATIVE: &str = "finite, >= 0";
        let limits = &self.limits;
        let positive = [
            ("mass [kg]", self.mass),
            ("max_force [N]", limits.max_force),
            ("max_continuous_force [N]", limits.max_continuous_force),
            ("max_stiffness [N/mm]", limits.max_stiffness),
            ("workspace_radius [mm]", limits.workspace_radius),
        ];
        let not_negative = [
            ("damping [N·s/mm]", self.damping),
            ("friction [N]", self.friction),
            ("hand_stiffness [N/mm]", self.hand_stiffness),
            ("hand_damping [N·s/mm]", self.hand_damping),
            ("encoder_step [mm]", self.encoder_step),
            ("velocity_time [s]", self.velocity_time),
        ];
        let wrong = |name, value, allowed| {
            Err(SettingsError::OutOfRange {
                name,
                value,
                allowed,
            })
        };
        for (name, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return wrong(name, value, POSITIVE);
            }
        }
        for (name, value) in not_negative {
            if !(value.is_finite() && value >= 0.0) {
                return wrong(name, value, NOT_NEGATIVE);
            }
        }
        if self.delay_ticks > MAX_DELAY_TICKS {
            return wrong("delay_ticks", self.delay_ticks as f64, "0..=32");
        }
        Ok(())
    }
}

/// The device: settings, hand and the moving mass.
#[derive(Clone, Debug)]
pub struct SimulatedDevice {
    settings: SimulatedSettings,
    hand: Option<DVec3>,
    position: DVec3,
    velocity: DVec3,
    sent: DVec3,
    delay: OutputDelay,
    estimate: VelocityEstimate,
    work: Work,
    state: DeviceState,
}

impl SimulatedDevice {
    /// A device at rest at `position` [mm], with no hand on it.
    ///
    /// # Errors
    /// [`SettingsError`] where a setting is not physical or the position not finite.
    pub fn new(settings: SimulatedSettings, position: DVec3) -> Result<Self, SettingsError> {
        settings.check()?;
        if !position.is_finite() {
            return Err(SettingsError::Position(position));
        }
        let position = saturated(position, settings.limits.workspace_radius);
        let seen = quantised(position, settings.encoder_step);
        Ok(Self {
            settings,
            hand: None,
            position,
            velocity: DVec3::ZERO,
            sent: DVec3::ZERO,
            delay: OutputDelay::new(settings.delay_ticks),
            estimate: VelocityEstimate::new(seen, settings.velocity_time),
            work: Work::default(),
            state: DeviceState {
                position: seen,
                ..DeviceState::default()
            },
        })
    }

    /// Settings of the device.
    pub fn settings(&self) -> &SimulatedSettings {
        &self.settings
    }

    /// Work since the start, by who did it.
    pub fn work(&self) -> Work {
        self.work
    }

    /// The true position [mm], before the encoders.
    pub fn true_position(&self) -> DVec3 {
        self.position
    }

    /// The true velocity [mm/s].
    pub fn true_velocity(&self) -> DVec3 {
        self.velocity
    }

    /// Kinetic energy of the mass [N·mm].
    pub fn kinetic_energy(&self) -> f64 {
        0.5 * self.settings.mass * self.velocity.length_squared() / 1000.0
    }

    /// One midpoint step of `dt` [s] under a held `force` [N].
    fn step(&mut self, force: DVec3, dt: f64) {
        let s = &self.settings;
        let inertia = s.mass / 1000.0; // N·s²/mm
        let (pull, stiffness, hand_damping) = match self.hand {
            Some(hand) => (
                (hand - self.position) * s.hand_stiffness,
                s.hand_stiffness,
                s.hand_damping,
            ),
            None => (DVec3::ZERO, 0.0, 0.0),
        };

        // velocity in the middle of the step, solved for the terms that depend on it
        let half = 0.5 * dt / inertia;
        let resistance = s.damping + hand_damping + 0.5 * dt * stiffness;
        let pushed = self.velocity + half * (force + pull);
        let held = half * s.friction;
        let before = self.kinetic_energy();
        if pushed.length() <= held {
            // dry friction holds it, and eats what motion there was
            self.velocity = DVec3::ZERO;
            self.work.lost += before;
            return;
        }
        let slowed = pushed - pushed.clamp_length(held, held);
        let middle = slowed / (1.0 + half * resistance);

        // the balance of energy is exact for these quantities
        let travelled = middle * dt;
        self.position += travelled;
        self.velocity = 2.0 * middle - self.velocity;
        let by_feedback = force.dot(travelled);
        let lost = self.settings.damping * middle.dot(travelled)
            + self.settings.friction * travelled.length();
        self.work.by_feedback += by_feedback;
        self.work.lost += lost;
        self.work.to_hand += by_feedback - lost - (self.kinetic_energy() - before);
    }

    /// The end stop: a mass at the rim of the workspace loses its outward motion.
    fn stop_at_the_rim(&mut self) {
        let radius = self.settings.limits.workspace_radius;
        if self.position.length_squared() > radius * radius {
            self.position = self.position.clamp_length_max(radius);
            let outward = self.position / radius;
            let before = self.kinetic_energy();
            self.velocity -= outward * self.velocity.dot(outward).max(0.0);
            self.work.lost += before - self.kinetic_energy();
        }
    }
}

impl HapticDevice for SimulatedDevice {
    fn name(&self) -> &'static str {
        "simulated"
    }

    fn limits(&self) -> DeviceLimits {
        DeviceLimits {
            damping: self.settings.damping,
            ..self.settings.limits
        }
    }

    fn read(&mut self, dt: f64) -> DeviceState {
        if !(dt > 0.0 && dt.is_finite()) {
            return self.state;
        }

        // the force on its way the longest acts during this tick
        let dt = dt.min(LONGEST_TICK);
        let force = self.delay.pass(self.sent);
        let parts = (dt / LONGEST_STEP).ceil().max(1.0);
        for _ in 0..parts as usize {
            self.step(force, dt / parts);
            self.stop_at_the_rim();
        }

        // what the encoders and the driver make of it
        let position = quantised(self.position, self.settings.encoder_step);
        self.state.velocity = self.estimate.update(position, dt);
        self.state.position = position;
        self.state.force = force;
        self.state.time += dt;
        self.state
    }

    fn write(&mut self, force: DVec3, _torque: DVec3) {
        self.sent = saturated(force, self.settings.limits.max_force);
    }

    fn hand_stiffness(&self) -> Option<f64> {
        Some(self.settings.hand_stiffness).filter(|stiffness| *stiffness > 0.0)
    }

    fn set_hand(&mut self, hand: Option<DVec3>) {
        let radius = self.settings.limits.workspace_radius;
        match hand {
            None => self.hand = None,
            // a target that is no point leaves the hand where it was
            Some(target) if !target.is_finite() => {}
            Some(target) => self.hand = Some(saturated(target, radius)),
        }
    }
}

/// The nearest encoder mark on each axis [mm].
fn quantised(position: DVec3, step: f64) -> DVec3 {
    if step > 0.0 {
        (position / step).round() * step
    } else {
        position
    }
}
