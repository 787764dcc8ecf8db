//! A session that its owner steps: the same loops, one after the other, at a fixed step.
//!
//! Two runs of the same session are equal to the bit: nothing here knows a clock.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};

use crate::picture::FrameCollector;
use crate::servo::Shared;
use crate::session::live::{Loops, Paces, message_of};
use crate::simulation::Simulation;
use crate::threads::{PICTURE_HZ, SIMULATION_HZ, TickStart};

/// The loops and how far they are.
pub struct Offline {
    loops: Loops,
    shared: Arc<Shared>,
    device_hz: u64,
    rate_hz: u64,
    device_tick: u64,
    tick: u64,
}

impl Offline {
    /// Loops at tick 0.
    #[must_use]
    pub fn new(loops: Loops, shared: Arc<Shared>, paces: Paces) -> Self {
        Self {
            loops,
            shared,
            device_hz: u64::from(paces.device_hz),
            rate_hz: u64::from(paces.servo_hz),
            device_tick: 0,
            tick: 0,
        }
    }

    /// The simulation.
    pub fn simulation(&mut self) -> &mut Simulation {
        &mut self.loops.simulation.work
    }

    /// The session's time [ns].
    #[must_use]
    pub fn now_ns(&self) -> u64 {
        self.tick * 1_000_000_000 / self.rate_hz
    }

    /// Steps for `seconds`; a panic takes the force away and ends the session.
    pub fn run(&mut self, seconds: f64) {
        let ticks = (seconds * self.rate_hz as f64).round() as u64;
        let steps = || (0..ticks).for_each(|_| self.step());
        if let Err(panic) = catch_unwind(AssertUnwindSafe(steps)) {
            self.loops.device.work.release();
            self.shared
                .fail(format!("a loop failed: {}", message_of(&*panic)));
        }
    }

    /// Ends the session.
    pub fn stop(&mut self) {
        self.shared.stop();
        self.loops.device.work.release();
        // where threads end, what they hold goes with them
        self.simulation().end_journal();
    }

    /// One tick of the servo and of all that is due before it.
    fn step(&mut self) {
        // the device first, where both are due
        while self.device_tick * self.rate_hz <= self.tick * self.device_hz {
            self.step_device();
        }
        let now = self.tick as f64 / self.rate_hz as f64;
        let start = in_time(self.tick, self.rate_hz);
        let Loops {
            servo,
            simulation,
            picture,
            surfaces,
            deformation,
            fractions,
            ..
        } = &mut self.loops;
        servo.meter.count(start);
        servo.work.step(now);
        self.tick += 1;
        if self
            .tick
            .is_multiple_of(self.rate_hz / u64::from(SIMULATION_HZ))
        {
            simulation.meter.count(start);
            simulation.work.step();
            deformation.step();
            fractions.step();
        }
        if self
            .tick
            .is_multiple_of(self.rate_hz / u64::from(PICTURE_HZ))
        {
            picture.meter.count(start);
            lock(&picture.work).collect();
            surfaces.step();
        }
    }

    /// One tick of the device.
    fn step_device(&mut self) {
        let device = &mut self.loops.device;
        let start = in_time(self.device_tick, self.device_hz);
        device.meter.count(start);
        device
            .work
            .step(self.device_tick as f64 / self.device_hz as f64);
        self.device_tick += 1;
    }
}

/// A tick of a loop that is never late.
fn in_time(tick: u64, rate_hz: u64) -> TickStart {
    TickStart {
        began_ns: tick * 1_000_000_000 / rate_hz,
        late_ns: 0,
        skipped: 0,
    }
}

/// A picture is whole even where a thread failed while it held the lock.
fn lock(picture: &Mutex<FrameCollector>) -> std::sync::MutexGuard<'_, FrameCollector> {
    picture.lock().unwrap_or_else(PoisonError::into_inner)
}
