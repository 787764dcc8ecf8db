//! Zero force whenever something goes wrong: a late servo, a panic, a stop.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;

use crate::common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_device::HapticDevice;
use palpate_engine::error::SessionError;
use palpate_engine::notice::NoticeLevel;
use palpate_engine::servo::{
    Channels, DeviceLoop, ForceCommand, ForceState, Shared, WATCHDOG_SECS,
};
use palpate_engine::session::{Reference, Session, SessionConfig};
use palpate_haptics::force::{ForceOff, LocalForce, SafetySettings};

const DIMENSIONS: UVec3 = UVec3::splat(40);

/// A device loop with bare ends; the probe notes what it is sent.
struct Bench {
    device: DeviceLoop,
    forces: triple_buffer::Input<ForceCommand>,
    shared: Arc<Shared>,
    seen: Seen,
}

impl Bench {
    /// Forces at once.
    fn new() -> Self {
        Self::starting(SafetySettings::AT_ONCE)
    }

    fn starting(safety: SafetySettings) -> Self {
        let seen = Seen::default();
        let shared = Arc::new(Shared::default());
        let channels = Channels::new(DVec3::ZERO);
        let probe = Box::new(Probe::at(DVec3::ZERO, &seen));
        Self {
            device: DeviceLoop::new(probe, channels.device, Arc::clone(&shared), 1e-3, safety),
            forces: channels.servo.forces,
            shared,
            seen,
        }
    }

    /// The servo wants a force at this time.
    fn want(&mut self, force: DVec3, time: f64) {
        self.forces.write(ForceCommand {
            time,
            tick: 1,
            law: LocalForce::held(force),
            hand_in_device: DVec3::ZERO,
            max_force: 5.0,
        });
    }

    fn watchdog(&self) -> u64 {
        let counter = &self.shared.counters.watchdog;
        counter.load(Ordering::Relaxed)
    }
}

#[test]
fn before_the_servo_has_spoken_nothing_is_sent_and_no_watchdog_counts() {
    let mut bench = Bench::new();
    for tick in 0..100 {
        bench.device.step(f64::from(tick) * 1e-3);
    }
    assert_eq!(bench.seen.forces(), vec![DVec3::ZERO; 100]);
    assert_eq!(bench.watchdog(), 0);
}

#[test]
fn a_force_older_than_the_watchdog_allows_is_taken_away_and_counted_once() {
    let mut bench = Bench::new();
    let wanted = DVec3::new(0.0, 0.5, 0.0);
    bench.want(wanted, 0.0);
    // sent at 0 to 10 ms, not after; 1e-6 keeps clear of rounding
    for tick in 0..30 {
        bench.device.step(f64::from(tick) * 1e-3 - 1e-6);
    }
    let allowed = (WATCHDOG_SECS * 1000.0) as usize;
    let forces = bench.seen.forces();
    assert!(forces[..=allowed].iter().all(|force| *force == wanted));
    assert!(
        forces[allowed + 1..]
            .iter()
            .all(|force| *force == DVec3::ZERO)
    );
    assert_eq!(bench.watchdog(), 1);

    // the servo is back: so is the force, and the next gap counts again
    bench.want(wanted, 0.030);
    bench.device.step(0.031);
    assert_eq!(bench.seen.last(), wanted);
    bench.device.step(0.050);
    assert_eq!(bench.watchdog(), 2);
}

#[test]
fn what_is_sent_is_finite_within_the_limit_and_counted() {
    let mut bench = Bench::new();
    for (tick, force) in [
        DVec3::new(f64::NAN, 0.0, 0.0),
        DVec3::splat(f64::INFINITY),
        DVec3::new(0.0, 1e6, 0.0),
    ]
    .into_iter()
    .enumerate()
    {
        let now = tick as f64 * 1e-3;
        bench.want(force, now);
        bench.device.step(now);
    }
    assert!(
        bench
            .seen
            .forces()
            .iter()
            .all(|force| force.length() <= 5.0)
    );
    let counters = &bench.shared.counters;
    assert_eq!(counters.not_finite.load(Ordering::Relaxed), 2);
    assert_eq!(counters.clamped.load(Ordering::Relaxed), 1);
}

#[test]
fn dropping_the_loop_sends_zero() {
    let mut bench = Bench::new();
    bench.want(DVec3::X, 0.0);
    bench.device.step(0.0);
    assert_eq!(bench.seen.last(), DVec3::X);
    let seen = bench.seen.clone();
    drop(bench);
    assert_eq!(seen.last(), DVec3::ZERO);
}

/// A live session with the device pressing 2 mm into a block.
fn pressing(device: impl HapticDevice + 'static) -> Session {
    let block = box_segment(DIMENSIONS, IVec3::new(5, 20, 5), IVec3::new(35, 35, 35));
    let config = SessionConfig {
        real_time: true,
        // the hand stands in the block from the start
        safety: Some(SafetySettings::AT_ONCE),
        start: Some(DVec3::new(20.0, 15.0, 20.0)),
        ..offline(DIMENSIONS, block, Box::new(device), Reference::Scene)
    };
    started(config)
}

const PRESSED: DVec3 = DVec3::new(20.0, 22.0, 20.0);

#[test]
fn stopping_sends_zero() {
    let seen = Seen::default();
    let session = pressing(Probe::at(PRESSED, &seen));
    wait_until("force", || seen.last().length() > 1.9);
    session.stop();
    wait_until("zero", || seen.last() == DVec3::ZERO);
    assert_eq!(session.frame().force, DVec3::ZERO);
    assert!(matches!(
        session.hand(DVec3::ZERO),
        Err(SessionError::Stopped)
    ));
}

#[test]
fn dropping_a_session_sends_zero() {
    let seen = Seen::default();
    let session = pressing(Probe::at(PRESSED, &seen));
    wait_until("force", || seen.last().length() > 1.9);
    drop(session);
    wait_until("zero", || seen.last() == DVec3::ZERO);
}

#[test]
fn a_panic_of_the_driver_sends_zero_and_ends_the_session_with_its_reason() {
    let seen = Seen::default();
    let mut probe = Probe::at(PRESSED, &seen);
    let sent = seen.clone();
    probe.on_read = Box::new(move |_| assert!(sent.last().length() < 1.9, "cable pulled"));
    let session = pressing(probe);
    wait_until("end", || !session.is_running());
    wait_until("zero", || seen.last() == DVec3::ZERO);
    assert!(seen.forces().iter().any(|force| force.length() > 1.9));
    assert!(session.failure().unwrap().contains("cable pulled"));

    // the page can still show why, and every command says it
    let frame = session.frame();
    assert_eq!(frame.force, DVec3::ZERO);
    assert!(frame.safety.watchdog > 0);
    let notice = frame.notices.last().unwrap();
    assert_eq!(notice.level, NoticeLevel::Error);
    assert!(notice.text.contains("cable pulled"), "{}", notice.text);
    let error = session.place(DVec3::ZERO).unwrap_err();
    assert!(matches!(error, SessionError::Failed(_)), "{error}");
}

/// A driver that panics at reading and again when zero is sent must not end the program.
#[test]
fn a_driver_that_panics_at_every_call_ends_the_session_only() {
    let mut probe = Probe::at(PRESSED, &Seen::default());
    probe.on_read = Box::new(|number| assert!(number < 50, "broken at reading"));
    probe.on_write = Box::new(|number| assert!(number < 50, "broken at writing"));
    let session = pressing(probe);
    wait_until("end", || !session.is_running());
    session.stop();
    assert!(session.failure().unwrap().contains("broken"));
}

/// The device thread hangs in the driver: stop does not wait for it, and says so.
#[test]
fn a_driver_that_hangs_does_not_keep_stop_from_returning() {
    let (release, go_on) = channel::<()>();
    let mut probe = Probe::at(PRESSED, &Seen::default());
    probe.on_read = Box::new(move |number| {
        if number > 20 {
            let _ = go_on.recv();
        }
    });
    let session = pressing(probe);
    wait_until("hanging", || session.frame().rates.device.ticks > 20);
    // were it to wait for the driver, it would wait for ever
    session.stop();
    drop(release);
    let frame = session.frame();
    assert_eq!(frame.notices.last().unwrap().level, NoticeLevel::Error);
}

/// While the driver hangs its last reading is too old to compute a force from.
#[test]
fn a_device_that_is_not_read_any_more_feels_no_contact() {
    let seen = Seen::default();
    let (release, go_on) = channel::<()>();
    let hangs = Arc::new(AtomicBool::new(false));
    let hanging = Arc::clone(&hangs);
    let mut probe = Probe::at(PRESSED, &seen);
    probe.on_read = Box::new(move |_| {
        if hanging.load(Ordering::Relaxed) {
            let _ = go_on.recv();
        }
    });
    let session = pressing(probe);
    wait_until("contact", || session.frame().contact);
    hangs.store(true, Ordering::Relaxed);
    wait_until("no contact", || !session.frame().contact);
    hangs.store(false, Ordering::Relaxed);
    drop(release);
    wait_until("contact again", || session.frame().contact);
}

#[test]
fn a_panic_in_an_offline_session_sends_zero_too() {
    let seen = Seen::default();
    let mut probe = Probe::at(PRESSED, &seen);
    probe.on_read = Box::new(|number| assert!(number < 100, "cable pulled"));
    let block = box_segment(DIMENSIONS, IVec3::new(5, 20, 5), IVec3::new(35, 35, 35));
    let config = SessionConfig {
        start: Some(DVec3::new(20.0, 15.0, 20.0)),
        ..offline(DIMENSIONS, block, Box::new(probe), Reference::Scene)
    };
    let session = started(config);
    let error = session.run(1.0).unwrap_err();
    assert!(error.to_string().contains("cable pulled"), "{error}");
    assert_eq!(seen.last(), DVec3::ZERO);
    assert!(seen.forces().iter().any(|force| force.length() > 1.9));
}

/// What the page shows of the force, tick by tick.
#[test]
fn at_the_start_the_force_waits_ramps_and_is_on_and_each_is_counted() {
    let mut bench = Bench::starting(SafetySettings {
        ramp_secs: 0.1,
        ..SafetySettings::default()
    });
    let counters = Arc::clone(&bench.shared);
    let state = || counters.counters.force_state();
    bench.device.step(0.0);
    assert_eq!(state(), ForceState::Waiting);
    assert_eq!(counters.counters.off(), Some(ForceOff::NotStarted));

    // the hand stands in an obstacle
    let wanted = DVec3::Y * 2.0;
    for tick in 1..50 {
        bench.want(wanted, f64::from(tick) * 1e-3);
        bench.device.step(f64::from(tick) * 1e-3);
        assert_eq!(
            (bench.seen.last(), state()),
            (DVec3::ZERO, ForceState::Waiting)
        );
    }
    // it comes out, and goes in again
    bench.want(DVec3::ZERO, 0.050);
    bench.device.step(0.050);
    for tick in 51..150 {
        bench.want(wanted, f64::from(tick) * 1e-3);
        bench.device.step(f64::from(tick) * 1e-3);
        // what is told is how the next force will be
        assert_eq!(state() == ForceState::Ramping, tick < 149, "{tick}");
        let share = f64::from(tick - 50) / 100.0;
        // rounding of sums of the step
        assert!((bench.seen.last().y - 2.0 * share).abs() < 1e-9);
    }
    bench.want(wanted, 0.151);
    bench.device.step(0.151);
    assert_eq!((bench.seen.last(), state()), (wanted, ForceState::On));
    assert_eq!(counters.counters.off(), None);

    let count = |counter: &std::sync::atomic::AtomicU64| counter.load(Ordering::Relaxed);
    let counters = &counters.counters;
    assert_eq!((count(&counters.waited), count(&counters.ramped)), (49, 99));
    // late: off, whatever stood before
    bench.device.step(0.2);
    assert_eq!(counters.force_state(), ForceState::Off);
    assert_eq!(bench.device.off(), Some(ForceOff::ServoLate));
    assert_eq!(counters.off(), Some(ForceOff::ServoLate));
}

#[test]
fn sessions_in_real_time_ramp_their_forces_and_stepped_ones_begin_at_once() {
    let block = box_segment(DIMENSIONS, IVec3::new(5, 20, 5), IVec3::new(35, 35, 35));
    let mut config = offline(DIMENSIONS, block, simulated(), Reference::View);
    assert_eq!(config.safety(), SafetySettings::AT_ONCE);
    config.real_time = true;
    assert_eq!(config.safety(), SafetySettings::default());
    assert_eq!(config.device_rate_hz(), config.rate_hz);
    config.device_rate_hz = Some(100);
    assert!(matches!(
        Session::start(config),
        Err(SessionError::Rate(100))
    ));
}

/// Two sessions of the same hand, the device read four times as often as the servo runs.
#[test]
fn a_stepped_session_with_unequal_rates_is_equal_to_the_bit() {
    let records = [(); 2].map(|()| {
        let block = box_segment(DIMENSIONS, IVec3::new(5, 20, 5), IVec3::new(35, 35, 35));
        let config = SessionConfig {
            device_rate_hz: Some(4000),
            start: Some(DVec3::new(20.0, 15.0, 20.0)),
            ..offline(DIMENSIONS, block, simulated(), Reference::View)
        };
        let session = started(config);
        session.start_recording().unwrap();
        session.hand(DVec3::new(22.0, 24.0, 20.0)).unwrap();
        session.run(0.5).unwrap();
        let recording = session.stop_recording().unwrap();
        assert!(recording.contact.iter().any(|contact| *contact));
        assert_eq!(
            session.rates().device.ticks,
            4 * session.rates().servo.ticks - 3
        );
        recording
    });
    assert_eq!(records[0], records[1]);
}
