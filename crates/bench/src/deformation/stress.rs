//! Pressing, drilling and needle work in soft tissue, with the guarantees of touch
//! checked at every tick: for `palpate bench stress --deform`.
//!
//! Device, servo, simulation and model take turns on one thread: a thousand ticks, a hundred
//! passes and 33 answers in a second of the session. A run has a block of its own and ends after
//! so many ticks; seed and number make it again. The hand goes where the surface is: it feels its
//! way down until it presses as deep as it wants to, now and then into the bone under it all.

#[cfg(test)]
mod faulty_models;

use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use palpate_deform::registry::{MODELS, ModelOptions};
use palpate_device::{DeviceLimits, DeviceState, HapticDevice};
use palpate_engine::error::SessionError;
use palpate_engine::servo::{DeviceLoop, TickRecord};
use palpate_haptics::force::SafetySettings;
use palpate_haptics::soft_contact;
use rayon::prelude::*;

use super::monitor::{DT, Monitor, Observation};
use super::rig::{LIMITS, Rig};
use super::world::{BARE, BONE, BONE_ID, SKIN_ID, SOFT_ID, TOP, WIDTH, World, drill, needle};
use crate::random::Random;
use crate::stress::{Guarantee, Violation, hold};

/// Ticks between two passes of the simulation, and between two answers of the model.
const PASS: u64 = 10;
const ANSWER: u64 = 30;
/// Speeds of the hand [mm/s]: at work, and from place to place.
const SPEED: f64 = 20.0;
const FAST: f64 = 200.0;
/// How far from the sides it works [mm].
const MARGIN: f64 = 6.0;
/// Ticks at rest after which nothing may change, beside those in which the spring's end goes over
/// from an answer that has become too old, and ticks for which it is looked at.
const REST: u32 = 1000;
/// Ticks within which the tissue around a needle that is in has relaxed besides: by a time constant
/// of up to 2.9 s with the coupling's give, from a millimetre to what counts as none.
const RELAXED: u32 = 30_000;
const STILL: u32 = 8;
/// Passes within which touch follows everything, with the probe out of the way.
const SETTLED: u32 = 20;

/// What came of some runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Ticks that were made and checked.
    pub ticks: u64,
    /// Of these, in contact, or with a needle in.
    pub contacts: u64,
    /// Voxels around the probe that became solid or free.
    pub bits: u64,
    /// Edits of model and drill.
    pub edits: u64,
    /// Answers of the model.
    pub answers: u64,
    /// Ticks with the device deeper than a voxel in bone.
    pub in_bone: u64,
    /// Voxels that were drilled.
    pub drilled: u64,
    /// Layers that a needle punctured.
    pub punctures: u64,
    /// Rests that came to stand still to the bit.
    pub rests: u64,
    /// How often nothing was pending after a job, and touch had every voxel.
    pub settled: u64,
    /// The violation in the run of the lowest number.
    pub violation: Option<Found>,
}

/// A violation and where it was.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Number of the run.
    pub run: u64,
    /// Ticks before it.
    pub tick: u64,
    /// What was broken.
    pub violation: Violation,
}

/// Runs with these numbers, so many ticks each at least, on all threads of the pool.
///
/// # Errors
/// Where there is no such model.
pub fn runs(
    model: &str,
    seed: u64,
    numbers: Range<u64>,
    ticks: u64,
) -> Result<Report, SessionError> {
    numbers
        .into_par_iter()
        .map(|number| run(model, seed, number, ticks))
        .try_reduce(Report::default, |one, other| Ok(one.and(other)))
}

/// The run of a number, up to its first violation.
///
/// # Errors
/// Where there is no such model.
pub fn run(model: &str, seed: u64, number: u64, ticks: u64) -> Result<Report, SessionError> {
    let mut random = Random::of_stream(seed, number);
    let world = World::new(number, &mut random);
    let rig = world.rig(model, &options(model, number))?;
    let mut run = Run::new(&world, rig, random);
    let violation = run.work(ticks).err().map(|violation| Found {
        run: number,
        tick: run.tick,
        violation,
    });
    Ok(Report {
        ticks: run.tick,
        bits: run.monitor.bits,
        in_bone: run.monitor.in_bone,
        answers: run.rig.simulation.deformation().answers,
        violation,
        ..run.report
    })
}

/// Options of the run of a number: every second one has what its model offers besides.
fn options(model: &str, number: u64) -> ModelOptions {
    let offers = MODELS.iter().find(|known| known.name == model);
    let besides = number % 2 == 1;
    ModelOptions {
        whole_segment: besides && offers.is_some_and(|known| known.offers.whole_segment),
        rearranges: besides && offers.is_some_and(|known| known.offers.rearranges),
        ..ModelOptions::default()
    }
}

/// A device that is led, and keeps what was sent to it.
#[derive(Clone, Copy, Debug, Default)]
struct Led {
    position: DVec3,
    sent: DVec3,
}

struct LedDevice(Arc<Mutex<Led>>);

impl HapticDevice for LedDevice {
    fn name(&self) -> &'static str {
        "led"
    }

    fn limits(&self) -> DeviceLimits {
        LIMITS
    }

    fn read(&mut self, _dt: f64) -> DeviceState {
        DeviceState {
            position: lock(&self.0).position,
            ..DeviceState::default()
        }
    }

    fn write(&mut self, force: DVec3, _torque: DVec3) {
        lock(&self.0).sent = force;
    }
}

fn lock(led: &Mutex<Led>) -> std::sync::MutexGuard<'_, Led> {
    led.lock().unwrap_or_else(PoisonError::into_inner)
}

struct Run {
    rig: Rig,
    device: DeviceLoop,
    led: Arc<Mutex<Led>>,
    monitor: Monitor,
    random: Random,
    /// Where the hand has the device.
    hand: DVec3,
    last: TickRecord,
    tick: u64,
    /// Whether simulation and model stand still.
    frozen: bool,
    /// Whether a drill was in the hand, and touch has not followed all of it yet.
    drill: bool,
    edit_number: u64,
    /// Changes that touch did not follow at the last look.
    pending: usize,
    report: Report,
}

impl Run {
    fn new(world: &World, mut rig: Rig, random: Random) -> Self {
        let hand = DVec3::new(0.5 * WIDTH, 0.5 * WIDTH, TOP + 4.0);
        let led = Arc::new(Mutex::new(Led {
            position: hand,
            sent: DVec3::ZERO,
        }));
        let channels = rig.servo.take_device().expect("nobody has taken it");
        let shared = Arc::clone(&rig.servo.shared);
        let device = Box::new(LedDevice(Arc::clone(&led)));
        Self {
            monitor: Monitor::new(world, rig.servo.servo.solid()),
            device: DeviceLoop::new(device, channels, shared, DT, SafetySettings::AT_ONCE),
            edit_number: rig.simulation.voxels().edit_number(),
            rig,
            led,
            random,
            hand,
            last: TickRecord::default(),
            tick: 0,
            frozen: false,
            drill: false,
            pending: 0,
            report: Report::default(),
        }
    }

    /// One job after the other.
    fn work(&mut self, ticks: u64) -> Result<(), Violation> {
        self.wait(2 * PASS as u32)?;
        while self.tick < ticks {
            self.press()?;
            self.rest()?;
            self.press_through()?;
            self.drill()?;
            self.needle()?;
        }
        Ok(())
    }

    /// Presses at a place and slides to another one.
    fn press(&mut self) -> Result<(), Violation> {
        let depth = 1.0 + 4.0 * self.random.share();
        let [from, to] = [self.place(), self.place()];
        self.come_down(from, depth)?;
        self.go(to.with_z(self.hand.z), SPEED)?;
        self.come_out()
    }

    /// Presses through all that is soft into the bone under it.
    fn press_through(&mut self) -> Result<(), Violation> {
        let place = self.place();
        self.come_down(place.with_x(place.x.max(BARE + MARGIN)), 0.0)?;
        let deep = 2.0 + 3.0 * self.random.share();
        self.go(self.hand.with_z(BONE - deep), SPEED)?;
        self.wait(2 * PASS as u32)?;
        self.come_out()
    }

    /// Presses on the bare bone, drills and sinks in.
    fn drill(&mut self) -> Result<(), Violation> {
        let place = self.place();
        self.come_down(place.with_x(BARE - MARGIN), 6.0)?;
        self.drill = true;
        self.ask(|simulation| {
            simulation.set_tool(Some(drill()))?;
            simulation.stroke(true)
        });
        let deep = 2.0 + 4.0 * self.random.share();
        self.go(self.hand - DVec3::Z * deep, 0.2 * SPEED)?;
        self.report.drilled += self.rig.simulation.tool_report().voxels;
        self.ask(|simulation| simulation.stroke(false));
        self.come_out()
    }

    /// Drives a needle down to the bone, and out again.
    fn needle(&mut self) -> Result<(), Violation> {
        let place = self.place();
        self.come_down(place.with_x(place.x.max(BARE + MARGIN)), 0.2)?;
        self.ask(|simulation| {
            simulation.set_tool(Some(needle()))?;
            simulation.stroke(true)
        });
        let above = self.hand;
        self.go(above - DVec3::Z * 16.0, SPEED)?;
        self.wait(100)?;
        self.go(above + DVec3::Z * 3.0, 2.0 * SPEED)?;
        self.wait(2 * PASS as u32)?;
        let events = self.rig.simulation.needle_report().events;
        let punctured = palpate_haptics::needle::events::EventKind::Punctured;
        let punctures = events
            .iter()
            .filter(|event| event.kind == punctured)
            .count();
        self.report.punctures += punctures as u64;
        self.ask(|simulation| simulation.stroke(false));
        self.come_out()
    }

    /// Guarantee 4: hand, simulation and model stand still, and soon nothing changes by a bit.
    fn rest(&mut self) -> Result<(), Violation> {
        let place = self.place();
        self.come_down(place, 3.0)?;
        self.frozen = true;
        // long where tissue has closed over the probe and the hand has gone on
        let spacing = self.rig.simulation.voxels().grid().spacing().min_element();
        let way = self.last.proxy.distance(self.hand) / spacing;
        let relaxing = if self.has_needle() { RELAXED } else { 0 };
        self.wait(REST + relaxing + (way / soft_contact::STEP).ceil() as u32)?;
        let before = self.last;
        for _ in 0..STILL {
            self.tick_at(self.hand)?;
            let now = self.last;
            let same = (now.proxy, now.force, now.contact_point)
                == (before.proxy, before.force, before.contact_point);
            hold(same, Guarantee::ComesToRest, || {
                format!("{} N, then {} N", before.force, now.force)
            })?;
        }
        self.frozen = false;
        self.report.rests += 1;
        self.come_out()
    }

    /// Whether a needle is in.
    fn has_needle(&self) -> bool {
        self.rig.servo.servo.needle().insertion().is_some()
    }

    /// Over to a place, down to the surface, and so much deeper [mm].
    fn come_down(&mut self, place: DVec3, depth: f64) -> Result<(), Violation> {
        self.go(place.with_z(self.hand.z), FAST)?;
        // the bottom is bone
        while !self.last.contact && self.hand.z > 0.0 {
            self.tick_at(self.hand - DVec3::Z * (FAST * DT))?;
        }
        self.go(self.hand - DVec3::Z * depth, SPEED)
    }

    /// Out of all tissue; then touch must have followed every change, unless tissue has closed over
    /// the probe, which keeps what cannot be admitted pending.
    fn come_out(&mut self) -> Result<(), Violation> {
        self.go(self.hand.with_z(TOP + 3.0), FAST)?;
        for _ in 0..SETTLED {
            self.wait(PASS as u32)?;
            self.pending = self.rig.status.read().pending;
            if self.pending == 0 {
                break;
            }
        }
        if self.pending > 0 {
            return Ok(());
        }
        self.report.settled += 1;
        self.changes_arrived()?;
        if std::mem::take(&mut self.drill) {
            self.monitor.bone_was_drilled(self.rig.servo.servo.solid());
        }
        Ok(())
    }

    /// Guarantee 7.
    fn changes_arrived(&self) -> Result<(), Violation> {
        let voxels = self.rig.simulation.voxels();
        // what a needle that is still in has punctured is no obstacle
        let punctured = self.rig.simulation.needle_report().punctured;
        let segments = [SKIN_ID, SOFT_ID, BONE_ID]
            .into_iter()
            .filter(|id| !punctured.contains(id))
            .filter_map(|id| voxels.segment(id));
        let segments: Vec<_> = segments.collect();
        let wanted = |voxel| segments.iter().any(|segment| segment.contains(voxel));
        let solid = self.rig.servo.servo.solid();
        let all = voxels.grid().bounds().voxels();
        let others: Vec<_> = all
            .filter(|voxel| solid.is_solid(*voxel) != wanted(*voxel))
            .collect();
        hold(others.is_empty(), Guarantee::ChangesArrive, || {
            format!(
                "{} voxels are not as the simulation has them, the first {}",
                others.len(),
                others[0]
            )
        })
    }

    /// Anywhere over the block.
    fn place(&mut self) -> DVec3 {
        let [low, high] = [MARGIN, WIDTH - MARGIN].map(DVec3::splat);
        self.random.in_box(low, high).with_z(0.0)
    }

    fn ask(
        &mut self,
        question: impl FnOnce(&mut palpate_engine::simulation::Simulation) -> Result<(), SessionError>,
    ) {
        question(&mut self.rig.simulation).expect("tools fit their world");
    }

    /// Straight to a point at a speed [mm/s].
    fn go(&mut self, to: DVec3, speed: f64) -> Result<(), Violation> {
        let from = self.hand;
        let ticks = (from.distance(to) / (speed * DT)).ceil() as u32;
        (1..=ticks)
            .try_for_each(|tick| self.tick_at(from.lerp(to, f64::from(tick) / f64::from(ticks))))
    }

    fn wait(&mut self, ticks: u32) -> Result<(), Violation> {
        (0..ticks).try_for_each(|_| self.tick_at(self.hand))
    }

    /// One tick of all loops with the device at a point, and the checker.
    fn tick_at(&mut self, hand: DVec3) -> Result<(), Violation> {
        let now = self.tick as f64 * DT;
        self.hand = hand;
        lock(&self.led).position = hand;
        self.device.step(now);
        self.last = self.rig.servo.tick(now);
        self.tick += 1;
        if self.tick.is_multiple_of(PASS) && !self.frozen {
            self.rig.simulation.step();
            let number = self.rig.simulation.voxels().edit_number();
            let last = std::mem::replace(&mut self.edit_number, number);
            self.report.edits += u64::from(number != last);
        }
        if self.tick.is_multiple_of(ANSWER) && !self.frozen {
            self.rig.deformation.step();
        }
        let needle = self.has_needle();
        self.report.contacts += u64::from(self.last.contact || needle);
        self.monitor.after_tick(&Observation {
            record: &self.last,
            solid: self.rig.servo.servo.solid(),
            sent: lock(&self.led).sent,
            needle,
            gripped: self.rig.servo.servo.is_held_by_friction(),
            drill: self.drill,
        })
    }
}

impl Report {
    /// Two reports as one; the violation of the lower run counts.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let [a, b] = [self.violation, other.violation];
        Self {
            ticks: self.ticks + other.ticks,
            contacts: self.contacts + other.contacts,
            bits: self.bits + other.bits,
            edits: self.edits + other.edits,
            answers: self.answers + other.answers,
            in_bone: self.in_bone + other.in_bone,
            drilled: self.drilled + other.drilled,
            punctures: self.punctures + other.punctures,
            rests: self.rests + other.rests,
            settled: self.settled + other.settled,
            violation: [a, b].into_iter().flatten().min_by_key(|found| found.run),
        }
    }
}
