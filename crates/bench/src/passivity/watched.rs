//! A simulated device whose hand follows a plan, and what is seen of it from outside.
//!
//! Frame: device; mm, N, N·mm, s.

use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use palpate_device::simulated::SimulatedDevice;
use palpate_device::{DeviceLimits, DeviceState, HapticDevice, Work};

use super::{Case, Motion, Outcome, Wall};

/// Ticks without force after which nothing of a contact is on its way any more.
const QUIET: u32 = 8;

/// The device.
pub struct Watched {
    device: SimulatedDevice,
    motion: Motion,
    seconds: f64,
    outward: DVec3,
    time: f64,
    watcher: Arc<Mutex<Watcher>>,
}

impl Watched {
    /// A device in front of a wall.
    pub fn new(
        device: SimulatedDevice,
        wall: Wall<'_>,
        case: &Case,
        watcher: &Arc<Mutex<Watcher>>,
    ) -> Self {
        Self {
            device,
            motion: case.motion,
            seconds: case.seconds,
            outward: wall.outward,
            time: 0.0,
            watcher: Arc::clone(watcher),
        }
    }
}

impl HapticDevice for Watched {
    fn name(&self) -> &'static str {
        "watched"
    }

    fn limits(&self) -> DeviceLimits {
        self.device.limits()
    }

    fn read(&mut self, dt: f64) -> DeviceState {
        self.time += dt;
        let hand = self.motion.hand_at(self.time, self.seconds, self.outward);
        self.device.set_hand(Some(hand));
        let state = self.device.read(dt);
        self.watcher
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .look(state.force, self.device.work());
        state
    }

    fn write(&mut self, force: DVec3, torque: DVec3) {
        self.device.write(force, torque);
    }
}

/// What is seen.
#[derive(Clone, Copy, Debug)]
pub struct Watcher {
    ticks: u64,
    contact_ticks: u64,
    /// Ticks without force since the last one with.
    quiet: u32,
    /// What the motors had given beyond friction when the contact that lasts began.
    entered: Option<f64>,
    /// The same, one tick ago.
    gained: f64,
    force: DVec3,
    outcome: Outcome,
}

impl Default for Watcher {
    fn default() -> Self {
        Self {
            ticks: 0,
            contact_ticks: 0,
            quiet: QUIET,
            entered: None,
            gained: 0.0,
            force: DVec3::ZERO,
            outcome: Outcome {
                of_one_contact: f64::NEG_INFINITY,
                ..Outcome::default()
            },
        }
    }
}

impl Watcher {
    /// One tick with the force that acted in it and all work since the start.
    fn look(&mut self, force: DVec3, work: Work) {
        let outcome = &mut self.outcome;
        outcome.largest_force = outcome.largest_force.max(force.length());
        outcome.largest_step = outcome.largest_step.max(force.distance(self.force));
        outcome.to_hand = work.to_hand;
        self.force = force;

        // a contact ends once no force of it is on its way any more
        let gained = work.by_feedback - work.lost;
        self.quiet = if force == DVec3::ZERO {
            self.quiet.saturating_add(1)
        } else {
            0
        };
        if self.quiet == 0 {
            self.entered.get_or_insert(self.gained);
        } else if self.quiet >= QUIET
            && let Some(before) = self.entered.take()
        {
            outcome.contacts += 1;
            outcome.of_one_contact = outcome.of_one_contact.max(gained - before);
        }
        self.contact_ticks += u64::from(self.quiet == 0);
        self.ticks += 1;
        self.gained = gained;
    }

    /// All that was seen.
    pub fn outcome(&self) -> Outcome {
        Outcome {
            contact_fraction: self.contact_ticks as f64 / self.ticks.max(1) as f64,
            ..self.outcome
        }
    }
}
