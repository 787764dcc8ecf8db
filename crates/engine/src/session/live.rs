//! The threads of a session that runs in real time.
//!
//! device and servo at their rates, half a tick of the faster one apart, so that each finds what
//! the other made half a tick ago; simulation at 100 Hz, picture at 60 Hz; surfaces and
//! deformation as fast as they can. A panic in any of them takes the
//! force away and ends the session; the reason is kept.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::deformable::{DeformationLoop, WakeUp};
use crate::error::SessionError;
use crate::picture::{FrameCollector, SurfaceLoop};
use crate::scene::FractionLoop;
use crate::servo::{DeviceLoop, ServoLoop, Shared};
use crate::simulation::Simulation;
use crate::threads::priority::{self};
use crate::threads::{PICTURE_HZ, Pacer, Priority, RateMeter, SIMULATION_HZ, clock};

/// From the start of the threads to their first tick [ns].
const HEAD_START_NS: u64 = 20_000_000;
/// How often the device's thread is looked after, a millisecond apart, until it ends; a driver that
/// hangs is left behind. Looks are counted and not time: on a machine that stood still, nothing
/// hangs.
const STOP_LOOKS: u32 = 800;
/// The same for the other threads, which may finish a surface, or wait for the disk to keep a
/// journal.
const STOP_LOOKS_AT_OURS: u32 = 30_000;
/// Longest wait for the outcome of the priorities, which threads tell first of all. A machine that
/// is late with its threads has not refused anything.
const START_PATIENCE: Duration = Duration::from_secs(10);

/// Something to do in the simulation thread.
pub type Question = Box<dyn FnOnce(&mut Simulation) + Send>;

/// A loop at a rate of its own, and what counts its ticks.
pub struct Metered<T> {
    /// The loop.
    pub work: T,
    /// Its meter.
    pub meter: RateMeter,
}

impl<T> Metered<T> {
    /// A loop with its meter.
    pub fn new(work: T, meter: RateMeter) -> Self {
        Self { work, meter }
    }
}

/// What the threads run.
pub struct Loops {
    /// The device.
    pub device: Metered<DeviceLoop>,
    /// The servo.
    pub servo: Metered<ServoLoop>,
    /// The simulation.
    pub simulation: Metered<Simulation>,
    /// The picture.
    pub picture: Metered<Arc<Mutex<FrameCollector>>>,
    /// The surfaces.
    pub surfaces: SurfaceLoop,
    /// The deformation.
    pub deformation: DeformationLoop,
    /// The occupancy fractions of masks.
    pub fractions: FractionLoop,
}

/// How fast the two real-time loops run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Paces {
    /// Rate of the device [Hz].
    pub device_hz: u32,
    /// Rate of the servo [Hz].
    pub servo_hz: u32,
}

/// The running threads.
#[derive(Debug)]
pub struct Live {
    questions: Mutex<Sender<Question>>,
    threads: Mutex<Vec<(&'static str, JoinHandle<()>)>>,
    shared: Arc<Shared>,
}

/// What every thread needs.
#[derive(Clone)]
struct Context {
    shared: Arc<Shared>,
    start_ns: u64,
    paces: Paces,
    outcomes: Sender<Result<(), String>>,
}

impl Live {
    /// Starts the threads; gives them and the system's reason where it refused the real-time
    /// priority.
    ///
    /// # Errors
    /// Where the system refuses a thread; none runs then.
    pub fn start(
        loops: Loops,
        shared: Arc<Shared>,
        paces: Paces,
    ) -> Result<(Self, Result<(), String>), SessionError> {
        let (questions, inbox) = mpsc::channel::<Question>();
        let answers = questions.clone();
        let (outcomes, results) = mpsc::channel();
        let context = Context {
            shared: Arc::clone(&shared),
            start_ns: clock::now_ns() + HEAD_START_NS,
            paces,
            outcomes,
        };
        let live = Self {
            questions: Mutex::new(questions),
            threads: Mutex::new(Vec::with_capacity(7)),
            shared,
        };
        let Loops {
            device,
            servo,
            simulation,
            picture,
            mut surfaces,
            mut deformation,
            fractions,
        } = loops;

        let [for_device, for_servo, for_simulation, for_picture] =
            std::array::from_fn(|_| context.clone());
        drop(context);
        live.spawn("device", move || run_device(device, &for_device))?;
        live.spawn("servo", move || run_servo(servo, &for_servo))?;
        live.spawn("simulation", move || {
            run_simulation(simulation, &inbox, &for_simulation);
        })?;
        live.spawn("picture", move || run_picture(picture, &for_picture))?;
        let shared = Arc::clone(&live.shared);
        live.spawn("surface", move || run_surfaces(&mut surfaces, &shared))?;
        // an answer does not wait for the next pass; after the end nobody hears it
        deformation.set_wake_up(WakeUp::new(move || {
            let _ = answers.send(Box::new(Simulation::answer_came));
        }));
        let shared = Arc::clone(&live.shared);
        live.spawn("deformation", move || {
            priority::share_cores(priority::PREFERRED);
            while !shared.stopping() && deformation.wait(PATIENCE) {}
        })?;
        let shared = Arc::clone(&live.shared);
        live.spawn("fractions", move || {
            priority::share_cores(priority::BACKGROUND);
            while !shared.stopping() && fractions.wait(PATIENCE) {}
        })?;

        let granted = outcome_of_both(&results);
        Ok((live, granted))
    }

    /// Has the simulation thread do something; false where it runs no more.
    pub fn ask(&self, question: Question) -> bool {
        let questions = self
            .questions
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        questions.send(question).is_ok()
    }

    /// Ends all threads; gives the names of those that did not end in time.
    pub fn stop(&self) -> Vec<&'static str> {
        self.shared.stop();
        // a question wakes the simulation; one that runs no more needs no waking
        self.ask(Box::new(|_| {}));

        let mut looks = 0;
        let mut threads = self.threads.lock().unwrap_or_else(PoisonError::into_inner);
        let mut hanging = Vec::new();
        for (name, thread) in threads.drain(..) {
            let most = if name == "device" {
                STOP_LOOKS
            } else {
                STOP_LOOKS_AT_OURS
            };
            while !thread.is_finished() && looks < most {
                std::thread::sleep(Duration::from_millis(1));
                looks += 1;
            }
            if thread.is_finished() {
                // a panic was caught and reported where it happened
                let _ = thread.join();
            } else {
                hanging.push(name);
            }
        }
        hanging
    }

    fn spawn(
        &self,
        name: &'static str,
        body: impl FnOnce() + Send + 'static,
    ) -> Result<(), SessionError> {
        let shared = Arc::clone(&self.shared);
        let thread = std::thread::Builder::new()
            .name(format!("palpate-{name}"))
            .spawn(move || {
                if let Err(panic) = catch_unwind(AssertUnwindSafe(body)) {
                    shared.fail(format!("the {name} thread failed: {}", message_of(&*panic)));
                }
            })
            .map_err(|reason| {
                self.shared.stop();
                SessionError::Thread {
                    thread: name,
                    reason,
                }
            })?;
        self.threads
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push((name, thread));
        Ok(())
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.stop();
    }
}

/// The text of a panic.
#[must_use]
pub fn message_of(panic: &(dyn std::any::Any + Send)) -> String {
    panic
        .downcast_ref::<&str>()
        .map(ToString::to_string)
        .or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no reason was given".into())
}

/// Both real-time threads tell their outcome; one that is silent was refused.
fn outcome_of_both(results: &Receiver<Result<(), String>>) -> Result<(), String> {
    for _ in 0..2 {
        results
            .recv_timeout(START_PATIENCE)
            .unwrap_or_else(|_| Err("the thread does not answer".into()))?;
    }
    Ok(())
}

impl Context {
    /// Asks for the priority and tells the outcome.
    fn prepare(&self, priority: Priority) {
        let outcome = priority::make_real_time(priority);
        if outcome.is_err() {
            priority::make_sleeps_exact();
        }
        // the starter may have lost patience
        let _ = self.outcomes.send(outcome);
    }

    /// Runs ticks until the session stops; `tick` is given the time [s].
    fn run(&self, mut pacer: Pacer, mut meter: RateMeter, mut tick: impl FnMut(f64)) {
        while !self.shared.stopping() {
            let start = pacer.wait();
            meter.count(start);
            tick(self.seconds(start.began_ns));
        }
    }

    /// Time since the session's time zero [s].
    fn seconds(&self, now_ns: u64) -> f64 {
        now_ns.saturating_sub(self.start_ns) as f64 * 1e-9
    }
}

fn run_device(device: Metered<DeviceLoop>, context: &Context) {
    let Metered {
        work: mut device,
        meter,
    } = device;
    context.prepare(priority::DEVICE);
    let pacer = Pacer::new(context.paces.device_hz, context.start_ns);
    // `device` sends zero force when it is dropped, also when a tick panics
    context.run(pacer, meter, |now| device.step(now));
}

fn run_servo(servo: Metered<ServoLoop>, context: &Context) {
    let Metered {
        work: mut servo,
        meter,
    } = servo;
    context.prepare(priority::SERVO);
    let Paces {
        device_hz,
        servo_hz,
    } = context.paces;
    let half_a_tick = 500_000_000 / u64::from(device_hz.max(servo_hz));
    let pacer = Pacer::new(servo_hz, context.start_ns + half_a_tick);
    context.run(pacer, meter, |now| servo.step(now));
}

fn run_simulation(simulation: Metered<Simulation>, inbox: &Receiver<Question>, context: &Context) {
    let Metered {
        work: mut simulation,
        mut meter,
    } = simulation;
    priority::share_cores(priority::PREFERRED);
    let mut pacer = Pacer::new(SIMULATION_HZ, context.start_ns);
    while !context.shared.stopping() {
        let rest = pacer.due_ns().saturating_sub(clock::now_ns());
        if rest == 0 {
            meter.count(pacer.wait());
            simulation.step();
            continue;
        }
        // until the next tick is due, do what is asked for
        match inbox.recv_timeout(Duration::from_nanos(rest)) {
            Ok(question) => question(&mut simulation),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Surfaces and deformation see the end of the session after so long, where nothing changes.
const PATIENCE: Duration = Duration::from_millis(100);

fn run_surfaces(surfaces: &mut SurfaceLoop, shared: &Shared) {
    while !shared.stopping() && surfaces.wait(PATIENCE) {}
}

fn run_picture(picture: Metered<Arc<Mutex<FrameCollector>>>, context: &Context) {
    let Metered {
        work: picture,
        meter,
    } = picture;
    let pacer = Pacer::new(PICTURE_HZ, context.start_ns);
    context.run(pacer, meter, |_| {
        picture
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .collect();
    });
}
