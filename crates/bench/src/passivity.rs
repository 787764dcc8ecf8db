//! Whether touch gives a hand energy: simulated devices that press, tap and slide.
//!
//! Each run is the engine's own device loop and servo at their rates, with a simulated device
//! between a wall and a hand that moves by a fixed plan. The work of the motors is measured at
//! the device itself. What its own friction eats is paid by whoever moves it, so a contact
//! gains what the motors gave in it beyond that; a passive wall gains nothing in any contact.
//!
//! Frames: scene and device [mm]; the device's origin is above the wall. N, N·mm, s.

mod devices;
mod motion;
mod watched;

pub use devices::{DEVICES, DeviceModel, device_named, device_names};
pub use motion::Motion;

use std::sync::{Arc, Mutex, PoisonError};

use glam::{DMat3, DVec3, UVec3};
use palpate_device::simulated::{SimulatedDevice, SimulatedSettings};
use palpate_engine::servo::{Channels, DeviceLoop, Mapping, ServoLoop, ServoStart, Shared};
use palpate_engine::touch::{Part, Settings, Threshold, TouchFeels, Touchable};
use palpate_haptics::force::SafetySettings;
use palpate_volume::bits::Bits;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;

use watched::{Watched, Watcher};

use crate::haptics::touched_point;
use crate::random::Random;

/// How far above the wall the device's origin is [mm].
const HEIGHT: f64 = 10.0;
/// A hand is out of the wall for at least this long at the end [s].
const END: f64 = 0.5;
/// Places on a solid that are looked at.
const PLACES: usize = 16;
/// Largest stiffness that settings take [N/mm].
const STIFFEST: f64 = 10.0;

/// A wall: something solid, and a place on its surface.
#[derive(Clone, Copy, Debug)]
pub struct Wall<'a> {
    /// Where it stands.
    pub grid: &'a Grid,
    /// Its voxels.
    pub solid: &'a Bits,
    /// What made them, by which it is felt then; else by its voxels.
    pub threshold: Option<&'a Threshold>,
    /// A point of its surface [mm].
    pub point: DVec3,
    /// Out of the wall there, of length 1.
    pub outward: DVec3,
}

impl<'a> Wall<'a> {
    /// What the servo touches.
    fn touchable(&self) -> Touchable {
        let part = Part {
            id: SegmentId(1),
            bits: self.solid.clone(),
            moved: None,
            threshold: self.threshold.cloned(),
            fractions: None,
            punctured: false,
            rigid: None,
        };
        Touchable::new(self.grid, vec![part], 0.0).expect("a point fits anywhere")
    }

    /// A place on a solid that is met from outside, of some the one on which a hand slides in
    /// contact the longest; none where there is no surface.
    #[must_use]
    pub fn on(
        grid: &'a Grid,
        (solid, threshold): (&'a Bits, Option<&'a Threshold>),
        seed: u64,
    ) -> Option<Self> {
        let mut random = Random(seed);
        let places = (0..PLACES).filter_map(|_| touched_point(grid, solid, &mut random));
        let walls = places.map(|touch| Self {
            grid,
            solid,
            threshold,
            point: touch.free,
            outward: (touch.free - touch.solid).normalize(),
        });
        let slide = Case::of(&SimulatedSettings::default(), 1000, Motion::Slide, 5.0);
        walls
            .map(|wall| (rub(&wall, &slide).contact_fraction, wall))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, wall)| wall)
    }
}

/// A flat wall of voxels of 1 mm, along the axes.
#[derive(Debug)]
pub struct FlatWall {
    grid: Grid,
    solid: Bits,
}

impl Default for FlatWall {
    fn default() -> Self {
        let dimensions = UVec3::new(48, 48, 32);
        let grid = Grid::new(dimensions, DVec3::ONE, DVec3::splat(0.5), DMat3::IDENTITY)
            .expect("voxels of 1 mm are a grid");
        let segment = Segment::from_fn(dimensions, |voxel| voxel.z < 16);
        Self {
            grid,
            solid: segment.occupancy().clone(),
        }
    }
}

impl FlatWall {
    /// Its middle.
    #[must_use]
    pub fn wall(&self) -> Wall<'_> {
        Wall {
            grid: &self.grid,
            solid: &self.solid,
            threshold: None,
            // no whole number of voxels from anything
            point: DVec3::new(24.3, 24.6, 16.0),
            outward: DVec3::Z,
        }
    }
}

/// One run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// The device and its hand.
    pub device: SimulatedSettings,
    /// Rate of the device [Hz].
    pub device_hz: u32,
    /// Rate of the servo [Hz].
    pub servo_hz: u32,
    /// How touch feels.
    pub settings: Settings,
    /// What the hand does.
    pub motion: Motion,
    /// How long [s].
    pub seconds: f64,
    /// Whether energy from nowhere is taken back.
    pub take_back: bool,
}

impl Case {
    /// A device at its default stiffness, servo and device at one rate [Hz].
    #[must_use]
    pub fn of(device: &SimulatedSettings, rate_hz: u32, motion: Motion, seconds: f64) -> Self {
        Self {
            device: *device,
            device_hz: rate_hz,
            servo_hz: rate_hz,
            settings: Settings::default().within(&device.limits),
            motion,
            seconds,
            take_back: true,
        }
    }
}

/// What came of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Net energy that the device gave to the hand [N·mm], its own friction paid; below zero
    /// where the hand gave.
    pub to_hand: f64,
    /// Largest gain of one contact, from entering to leaving [N·mm], the device's friction
    /// paid; below zero where each cost.
    pub of_one_contact: f64,
    /// Contacts.
    pub contacts: u32,
    /// Fraction of the time in contact.
    pub contact_fraction: f64,
    /// Largest force that acted [N].
    pub largest_force: f64,
    /// Largest change of that force from one tick of the device to the next [N].
    pub largest_step: f64,
    /// Ticks in which the passivity controller acted.
    pub damped: u64,
    /// Ticks in which the probe was found in a solid voxel.
    pub violations: u64,
}

impl Outcome {
    /// Whether nothing was gained: neither in any contact nor in all. An encoder cannot tell
    /// what happens within a mark, so that the energy of a mark is not counted as a gain.
    #[must_use]
    pub fn is_passive(&self, case: &Case) -> bool {
        let unseen = case.settings.stiffness * case.device.encoder_step.powi(2) + 1e-6;
        self.to_hand <= 0.0 && self.of_one_contact <= unseen
    }
}

/// Runs a case on a wall.
#[must_use]
pub fn rub(wall: &Wall<'_>, case: &Case) -> Outcome {
    let watcher = Arc::new(Mutex::new(Watcher::default()));
    let (mut device, mut servo, shared) = loops(wall, case, &watcher);

    // the device first, where both are due
    let [device_hz, servo_hz] = [case.device_hz, case.servo_hz].map(u64::from);
    let ticks = ((case.seconds + END) * f64::from(case.servo_hz)).round() as u64;
    let mut device_tick = 0;
    for tick in 0..ticks {
        while device_tick * servo_hz <= tick * device_hz {
            device.step(device_tick as f64 / device_hz as f64);
            device_tick += 1;
        }
        servo.step(tick as f64 / servo_hz as f64);
    }

    let watcher = watcher.lock().unwrap_or_else(PoisonError::into_inner);
    let counted =
        |counter: &std::sync::atomic::AtomicU64| counter.load(std::sync::atomic::Ordering::Relaxed);
    Outcome {
        damped: counted(&shared.counters.damped),
        violations: counted(&shared.counters.violations),
        ..watcher.outcome()
    }
}

/// The engine's loops around a device that a hand leads by a plan.
fn loops(
    wall: &Wall<'_>,
    case: &Case,
    watcher: &Arc<Mutex<Watcher>>,
) -> (DeviceLoop, ServoLoop, Arc<Shared>) {
    let start = case.motion.hand_at(0.0, case.seconds, wall.outward);
    let device = SimulatedDevice::new(case.device, start).expect("devices of the table are valid");
    let watched = Watched::new(device, *wall, case, watcher);
    let mapping = Mapping {
        offset: wall.point + wall.outward * HEIGHT,
        ..Mapping::IDENTITY
    };
    let probe = mapping.point_to_scene(start);

    let shared = Arc::new(Shared::default());
    let channels = Channels::new(probe);
    let safety = SafetySettings {
        take_back: case.take_back,
        ..SafetySettings::AT_ONCE
    };
    let dt = 1.0 / f64::from(case.device_hz);
    let device = DeviceLoop::new(
        Box::new(watched),
        channels.device,
        Arc::clone(&shared),
        dt,
        safety,
    );
    let start = ServoStart {
        grid: *wall.grid,
        touchable: wall.touchable(),
        mapping,
        probe,
        settings: case.settings,
        feels: TouchFeels::default(),
    };
    let servo = ServoLoop::new(start, channels.servo, Arc::clone(&shared));
    (device, servo, shared)
}

/// The largest stiffness [N/mm] at which all motions are passive on a wall without help of the
/// passivity controller, by bisection to 3 %; the stiffest that settings take where all are,
/// 0 where none is.
#[must_use]
pub fn largest_passive_stiffness(wall: &Wall<'_>, case: &Case) -> f64 {
    let passive = |stiffness: f64| {
        Motion::ALL.into_iter().all(|motion| {
            let case = Case {
                motion,
                take_back: false,
                settings: Settings {
                    stiffness,
                    ..case.settings
                },
                ..*case
            };
            rub(wall, &case).is_passive(&case)
        })
    };
    if passive(STIFFEST) {
        return STIFFEST;
    }
    let (mut below, mut above) = (STIFFEST / 512.0, STIFFEST);
    if !passive(below) {
        return 0.0;
    }
    // by ratios: stiffness is felt so
    while above > below * 1.03 {
        let middle = (below * above).sqrt();
        if passive(middle) {
            below = middle;
        } else {
            above = middle;
        }
    }
    below
}

/// What one device does on one wall at one rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// The default stiffness that the device bears [N/mm].
    pub stiffness: f64,
    /// Net energy given to the hand at it, the worst of the motions [N·mm].
    pub to_hand: f64,
    /// Largest gain of one contact at it, of all motions [N·mm].
    pub of_one_contact: f64,
    /// Largest force at it [N].
    pub largest_force: f64,
    /// Fraction of the time in contact, of all motions.
    pub contact_fraction: f64,
    /// Ticks in which the passivity controller acted.
    pub damped: u64,
    /// Ticks in which the probe was found in a solid voxel.
    pub violations: u64,
    /// The largest stiffness that is passive without the controller [N/mm].
    pub largest_stiffness: f64,
    /// The bound of sampling and delay for any hand [N/mm].
    pub bound: f64,
}

/// Rubs a wall for so many seconds, shared by the motions, and searches the largest passive
/// stiffness with motions of `search_seconds` each.
#[must_use]
pub fn report(
    wall: &Wall<'_>,
    device: &SimulatedSettings,
    rate_hz: u32,
    (seconds, search_seconds): (f64, f64),
) -> Report {
    let each = seconds / Motion::ALL.len() as f64;
    let outcomes = Motion::ALL.map(|motion| rub(wall, &Case::of(device, rate_hz, motion, each)));
    let largest = |of: fn(&Outcome) -> f64| outcomes.iter().map(of).fold(f64::MIN, f64::max);
    let case = Case::of(device, rate_hz, Motion::Press, search_seconds);
    Report {
        stiffness: case.settings.stiffness,
        to_hand: largest(|outcome| outcome.to_hand),
        of_one_contact: largest(|outcome| outcome.of_one_contact),
        largest_force: largest(|outcome| outcome.largest_force),
        contact_fraction: outcomes
            .iter()
            .map(|outcome| outcome.contact_fraction)
            .sum::<f64>()
            / outcomes.len() as f64,
        damped: outcomes.iter().map(|outcome| outcome.damped).sum(),
        violations: outcomes.iter().map(|outcome| outcome.violations).sum(),
        largest_stiffness: largest_passive_stiffness(wall, &case),
        bound: passive_bound(device, rate_hz),
    }
}

/// The stiffness [N/mm] below which a sampled wall with delay is passive for any hand: the
/// device's damping over half a tick and the delay.
///
/// Source: Hulin, Preusche, Hirzinger, "Stability boundary for haptic rendering", IROS 2008.
#[must_use]
pub fn passive_bound(device: &SimulatedSettings, device_hz: u32) -> f64 {
    let ticks = 0.5 + device.delay_ticks as f64;
    device.damping * f64::from(device_hz) / ticks
}
