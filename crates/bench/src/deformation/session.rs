//! How often the servo comes around when it does not wait, and how often a model of deformation
//! answers beside it: the thesis' tables 5.1 to 5.4.
//!
//! The device is led over the surface, pressing, while the segment deforms. The servo ticks
//! without a pause in the thread that calls, the simulation 100 times a second and the model as
//! fast as it can in threads of their own, as in a session. In step, all three take turns on one
//! thread, and the clock is that of the ticks: then the same ticks give the same counts.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

use glam::DVec3;
use palpate_deform::material::{MaterialLaw, preset};
use palpate_deform::registry::ModelOptions;
use palpate_engine::deformable::WakeUp;
use palpate_engine::error::SessionError;
use palpate_engine::simulation::Simulation;
use palpate_engine::threads::{Pacer, SIMULATION_HZ, clock};
use palpate_engine::touch::{Settings, Touchable};
use palpate_haptics::contact::Exact;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;

use super::rig::Rig;
use crate::haptics::{BenchError, Ground, STEP, Stroke, stroke};

/// The hand's way [mm/s]: slow stroking.
const SPEED: f64 = 20.0;
/// What is touched.
const SEGMENT: SegmentId = SegmentId(1);
/// What it is made of.
const MATERIAL: &str = "thesis-soft-tissue";
/// Before the first sample: so long at least, and with a model until it has answered, but never
/// longer than the second [s]. The device waits at the start of its way.
const WARM_UP: [f64; 2] = [0.5, 60.0];
/// How long the model waits for a job before it looks whether the end has come.
const PATIENCE: Duration = Duration::from_millis(20);

/// Passes of the simulation for an answer where all takes turns: 33 in a second.
const PASSES: u64 = 3;

/// Why nothing could be measured.
#[derive(Debug, thiserror::Error)]
pub enum SessionBenchError {
    /// Nothing to touch.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// The session refuses something.
    #[error(transparent)]
    Session(#[from] SessionError),
}

/// What is touched, and with which model it deforms.
#[derive(Debug)]
pub struct Plan<'a> {
    /// Where the scan stands, and its values.
    pub scan: (Grid, Intensities),
    /// What is touched.
    pub segment: &'a Segment,
    /// Name of the model; none for rigid segments.
    pub model: Option<&'a str>,
    /// Samples of one second.
    pub samples: u32,
    /// Ticks of a second where all takes turns; none to run free.
    pub ticks_in_step: Option<u32>,
    /// Another seed makes another way.
    pub seed: u64,
}

/// What a second gave.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Ticks of the servo.
    pub ticks: u64,
    /// Of these, in contact.
    pub contacts: u64,
    /// Answers of the model.
    pub answers: u64,
    /// How long it was [s].
    pub seconds: f64,
}

/// What came out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// One for each second.
    pub samples: Vec<Sample>,
    /// Nodes or particles of the last answer.
    pub nodes: u32,
    /// Iterations of the last answer.
    pub iterations: u32,
    /// Ticks in which the probe was in a solid voxel.
    pub violations: u64,
}

/// Measures.
///
/// # Errors
/// Where there is nothing to touch, or no such model.
pub fn measure(plan: &Plan<'_>) -> Result<Found, SessionBenchError> {
    let way = way_over(plan)?;
    let (grid, intensities) = plan.scan.clone();
    let mut rig = Rig::new(
        (grid, intensities),
        vec![plan.segment.clone()],
        way.start,
        Settings::default(),
        plan.ticks_in_step.is_some(),
    )?;
    if let Some(model) = plan.model {
        rig.simulation.set_material(SEGMENT, Some(law()), false)?;
        rig.simulation
            .set_deformation(Some(model), &ModelOptions::default(), false)?;
    }
    let led = Led {
        way: way.device,
        speed: SPEED / (STEP * grid.smallest_spacing()),
    };
    Ok(match plan.ticks_in_step {
        Some(ticks) => in_step(rig, &led, plan.samples, ticks),
        None => running_free(rig, &led, plan),
    })
}

fn law() -> MaterialLaw {
    let law = preset(MATERIAL).and_then(|preset| preset.law());
    law.expect("a preset of the list")
}

/// A way of the device that lasts for all samples.
fn way_over(plan: &Plan<'_>) -> Result<Stroke, BenchError> {
    let grid = plan.scan.0;
    let ground = Ground::new(grid, vec![plan.segment.occupancy().clone()]);
    let touchable = Touchable::new(&grid, ground.parts(), 0.0)?;
    let exact = Exact {
        limits: touchable.limits(),
    };
    let length = SPEED * (f64::from(plan.samples) + 1.0);
    let count = (length / (STEP * grid.smallest_spacing())).ceil() as usize + 2;
    stroke(&grid, &touchable.world, &exact, count, plan.seed).ok_or(BenchError::NoSurface)
}

/// A device that goes along a way at a steady speed.
struct Led {
    way: Vec<DVec3>,
    /// Places of the way in a second.
    speed: f64,
}

impl Led {
    fn at(&self, time: f64) -> DVec3 {
        let place = (time * self.speed).clamp(0.0, (self.way.len() - 1) as f64);
        let before = (place.floor() as usize).min(self.way.len() - 2);
        self.way[before].lerp(self.way[before + 1], place - before as f64)
    }
}

/// All takes turns, so many ticks for each second.
fn in_step(mut rig: Rig, led: &Led, samples: u32, ticks_in_second: u32) -> Found {
    let pass_every = u64::from((ticks_in_second / SIMULATION_HZ).max(1));
    let mut found = Found::default();
    let (mut tick, mut answers) = (0_u64, 0);
    for _ in 0..samples {
        let mut sample = Sample {
            seconds: 1.0,
            ..Sample::default()
        };
        for _ in 0..ticks_in_second {
            let now = tick as f64 / f64::from(ticks_in_second);
            let record = rig.servo.tick_at(led.at(now), now);
            sample.contacts += u64::from(record.contact);
            sample.ticks += 1;
            tick += 1;
            if tick.is_multiple_of(pass_every) {
                rig.simulation.step();
            }
            if tick.is_multiple_of(PASSES * pass_every) {
                rig.deformation.step();
            }
        }
        let all = rig.simulation.deformation().answers;
        sample.answers = all - std::mem::replace(&mut answers, all);
        found.samples.push(sample);
    }
    found.finish(&rig.simulation, rig.servo.violations())
}

/// What the threads tell one another.
#[derive(Default)]
struct Gauge {
    answers: AtomicU64,
    over: AtomicBool,
}

fn running_free(mut rig: Rig, led: &Led, plan: &Plan<'_>) -> Found {
    let gauge = Gauge::default();
    let mut found = Found::default();
    let Rig {
        servo,
        simulation,
        deformation,
        ..
    } = &mut rig;
    std::thread::scope(|scope| {
        let (notify, wake_up) = mpsc::channel();
        deformation.set_wake_up(WakeUp::new(move || {
            // after the end nobody hears it
            let _ = notify.send(());
        }));
        scope.spawn(|| run_simulation(simulation, wake_up, &gauge));
        scope.spawn(|| {
            let mut more = true;
            while more && !gauge.over.load(Relaxed) {
                more = deformation.wait(PATIENCE);
            }
        });
        // a panic here must not leave the others waiting
        let _over = OverAtEnd(&gauge);
        let clock = Instant::now();
        let now = || clock.elapsed().as_secs_f64();
        let [least, most] = WARM_UP;
        let is_warm = || plan.model.is_none() || gauge.answers.load(Relaxed) > 0;
        while now() < least || (now() < most && !is_warm()) {
            servo.tick_at(led.at(0.0), now());
        }
        let begun = now();
        for number in 1..=plan.samples {
            let mut sample = Sample::default();
            let (from, answers) = (now(), gauge.answers.load(Relaxed));
            let mut at = from;
            while at < begun + f64::from(number) {
                let record = servo.tick_at(led.at(at - begun), at);
                sample.contacts += u64::from(record.contact);
                sample.ticks += 1;
                at = now();
            }
            sample.seconds = at - from;
            sample.answers = gauge.answers.load(Relaxed) - answers;
            found.samples.push(sample);
        }
    });
    let violations = rig.servo.violations();
    found.finish(&rig.simulation, violations)
}

/// The end has come when this goes.
struct OverAtEnd<'a>(&'a Gauge);

impl Drop for OverAtEnd<'_> {
    fn drop(&mut self) {
        self.0.over.store(true, Relaxed);
    }
}

/// As in a session: a pass 100 times a second, and an answer as soon as it comes.
fn run_simulation(simulation: &mut Simulation, wake_up: Receiver<()>, gauge: &Gauge) {
    let mut pacer = Pacer::new(SIMULATION_HZ, clock::now_ns());
    while !gauge.over.load(Relaxed) {
        let rest = pacer.due_ns().saturating_sub(clock::now_ns());
        if rest == 0 {
            pacer.wait();
            simulation.step();
        } else if wake_up.recv_timeout(Duration::from_nanos(rest)).is_ok() {
            simulation.answer_came();
        }
        let answers = simulation.deformation().answers;
        gauge.answers.store(answers, Relaxed);
    }
}

impl Found {
    fn finish(mut self, simulation: &Simulation, violations: u64) -> Self {
        let report = simulation.deformation().report;
        (self.nodes, self.iterations) = (report.nodes, report.iterations);
        self.violations = violations;
        self
    }
}
