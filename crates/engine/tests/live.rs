//! Sessions with real threads: that they run and answer. How fast is for the benchmark.
//!
//! A binary of its own: other tests beside them would take their threads the time.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::picture::Frame;
use palpate_engine::session::{Reference, Session, SessionConfig};
use palpate_volume::edit::SegmentId;

const DIMENSIONS: UVec3 = UVec3::splat(40);

fn live(rate_hz: u32) -> Session {
    let block = box_segment(DIMENSIONS, IVec3::new(5, 20, 5), IVec3::new(35, 35, 35));
    started(SessionConfig {
        real_time: true,
        rate_hz,
        ..offline(DIMENSIONS, block, simulated(), Reference::View)
    })
}

#[test]
fn all_four_threads_run_and_the_hand_feels_the_block() {
    for rate_hz in [1000, 4000] {
        let session = live(rate_hz);
        session.place(DVec3::new(20.0, 10.0, 20.0)).unwrap();
        session.hand(DVec3::new(20.0, 30.0, 20.0)).unwrap();
        let pressed = |frame: &Frame| frame.contact && frame.depth > 2.0;
        // which segment it is comes from another thread, a little later
        let frame = frame_where(&session, |frame| pressed(frame) && frame.touched == 1);
        assert!(frame.proxy.y < 20.0);
        // each thread begins when the machine lets it
        let frame = frame_where(&session, |frame| {
            let rates = &frame.rates;
            let slower = [&rates.device, &rates.simulation, &rates.picture];
            rates.servo.hz > 0.0 && slower.iter().all(|rate| rate.ticks > 0)
        });
        assert_eq!(frame.rates.servo.asked_hz, f64::from(rate_hz));
        assert_eq!(frame.safety.violations, 0);
    }
}

/// With or without the priority it runs; what is reported is what is so.
#[test]
fn the_outcome_of_the_real_time_priority_is_told() {
    let session = live(1000);
    let frame = session.frame();
    let warned = frame
        .notices
        .iter()
        .any(|notice| notice.text.contains("real-time"));
    assert_ne!(frame.rates.real_time, warned);
}

/// What a hand waits for comes before a page's work, and what nobody waits for after it.
#[cfg(target_os = "linux")]
#[test]
fn soft_tissue_comes_before_work_in_the_background() {
    let session = live(1000);
    frame_where(&session, |frame| frame.rates.simulation.ticks > 0);
    // SAFETY: a system call on numbers; 0 is the calling thread, which ends after it
    let is_allowed =
        std::thread::spawn(|| unsafe { libc::setpriority(libc::PRIO_PROCESS, 0, -5) == 0 });
    let preferred = if is_allowed.join().unwrap() { -5 } else { 0 };
    for (name, expected) in [
        ("palpate-deforma", preferred),
        ("palpate-simulat", preferred),
        ("palpate-fractio", 4),
    ] {
        // each thread begins when the machine lets it
        let began = std::time::Instant::now();
        while niceness_of(name).iter().any(|found| *found != expected) {
            assert!(
                began.elapsed().as_secs() < 60,
                "{name}: {:?}",
                niceness_of(name)
            );
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        assert!(!niceness_of(name).is_empty(), "{name}");
    }
}

/// Niceness of the threads of this process that have a name, as far as Linux keeps it.
#[cfg(target_os = "linux")]
fn niceness_of(name: &str) -> Vec<i32> {
    let threads = std::fs::read_dir("/proc/self/task").unwrap();
    let stats = threads.filter_map(|thread| {
        // one that has just ended is none
        std::fs::read_to_string(thread.unwrap().path().join("stat")).ok()
    });
    let of_name = stats.filter(|stat| stat.contains(&format!("({name})")));
    of_name
        .map(|stat| {
            // proc_pid_stat(5): niceness is the 19th field, the 17th after the name
            let (_, fields) = stat.rsplit_once(") ").unwrap();
            fields.split(' ').nth(16).unwrap().parse().unwrap()
        })
        .collect()
}

#[test]
fn edits_reach_touch_while_the_probe_presses() {
    let session = live(1000);
    session.place(DVec3::new(20.0, 10.0, 20.0)).unwrap();
    session.hand(DVec3::new(20.0, 30.0, 20.0)).unwrap();
    frame_where(&session, |frame| frame.contact && frame.proxy.y < 20.0);

    // a hole under the probe: it goes on to the hole's ground
    let id = SegmentId(1);
    let (low, high) = (IVec3::new(14, 20, 14), IVec3::new(26, 24, 26));
    session.fill_box(id, low, high, false).unwrap();
    frame_where(&session, |frame| frame.proxy.y > 23.0 && frame.contact);
    // the simulation tells of its edit when it has done it, the servo when it follows
    frame_where(&session, |frame| {
        frame.can_undo && !frame.can_redo && frame.edit == 2
    });

    // filled again, it is pushed out; then dug again
    assert!(session.undo().unwrap());
    frame_where(&session, |frame| frame.proxy.y < 20.0 && frame.pending == 0);
    assert!(session.redo().unwrap());
    frame_where(&session, |frame| frame.proxy.y > 23.0);
    assert_eq!(session.frame().safety.violations, 0);
}

/// Other threads may call at any time, all at once.
#[test]
fn commands_from_several_threads_are_all_answered() {
    let session = live(1000);
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let session = &session;
            scope.spawn(move || {
                let mut random = Random::new(thread);
                for _ in 0..30 {
                    session.hand(random.point(0.0, 40.0)).unwrap();
                    session.place(random.point(0.0, 15.0)).unwrap();
                    assert_eq!(session.segments().unwrap().len(), 1);
                    let _ = session.frame();
                }
            });
        }
    });
    assert!(session.is_running());
}

#[test]
fn a_recording_of_a_live_session_has_every_tick() {
    let session = live(1000);
    frame_where(&session, |frame| frame.tick > 50);
    session.start_recording().unwrap();
    frame_where(&session, |frame| frame.tick > 400);
    let recording = session.stop_recording().unwrap();
    let first = recording.tick[0];
    let expected: Vec<u64> = (first..first + recording.len() as u64).collect();
    assert_eq!(recording.tick, expected);
    assert!(recording.time.is_sorted());
}
