//! Sessions that are stepped: what is felt, and that it is the same every time.

use crate::common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::notice::NoticeLevel;
use palpate_engine::session::{Reference, Session, SessionConfig};
use palpate_engine::touch::Settings;
use palpate_volume::edit::SegmentId;

const DIMENSIONS: UVec3 = UVec3::new(60, 50, 40);

/// A block whose front face is the plane y = 20 mm.
fn block() -> palpate_volume::segment::Segment {
    box_segment(DIMENSIONS, IVec3::new(10, 20, 5), IVec3::new(50, 45, 35))
}

/// Goes 5 mm into the block within half a second, rests, and comes back.
fn press_and_retreat() -> SessionConfig {
    let path = [
        [0.0, 30.0, 15.0, 20.0],
        [0.5, 30.0, 25.0, 20.0],
        [1.0, 30.0, 25.0, 20.0],
        [1.5, 30.0, 15.0, 20.0],
    ];
    offline(DIMENSIONS, block(), scripted(&path), Reference::Scene)
}

fn recorded(session: &Session, seconds: f64) -> palpate_engine::replay::Recording {
    session.start_recording().unwrap();
    session.run(seconds).unwrap();
    session.stop_recording().unwrap()
}

#[test]
fn pressing_a_block_gives_stiffness_times_depth_and_retreat_gives_nothing() {
    let session = started(press_and_retreat());
    session.run(0.9).unwrap();
    let frame = session.frame();
    assert!(frame.contact);
    assert_eq!(frame.touched, 1);
    // the probe stays at the face, 1e-8 voxels before it
    assert!((frame.depth - 5.0).abs() < 1e-6, "{}", frame.depth);
    assert!((frame.proxy - DVec3::new(30.0, 20.0, 20.0)).length() < 1e-6);
    let expected = DVec3::new(0.0, -5.0 * Settings::default().stiffness, 0.0);
    assert!((frame.force - expected).length() < 1e-6, "{}", frame.force);

    session.run(0.7).unwrap();
    let frame = session.frame();
    assert!(!frame.contact);
    assert_eq!(
        (frame.force, frame.depth, frame.touched),
        (DVec3::ZERO, 0.0, 0)
    );
    assert_eq!(frame.safety.violations, 0);
}

/// At rest nothing moves by a bit: the whole half second gives one force.
#[test]
fn at_rest_probe_and_force_are_constant_to_the_bit() {
    let session = started(press_and_retreat());
    session.run(0.55).unwrap();
    let rest = recorded(&session, 0.4);
    assert_eq!(rest.len(), 400);
    assert!(rest.proxy.iter().all(|proxy| *proxy == rest.proxy[0]));
    assert!(rest.force.iter().all(|force| *force == rest.force[0]));
}

/// Commands, edits and a simulated hand included.
#[test]
fn two_runs_of_the_same_session_are_equal_to_the_bit() {
    let run = || {
        let session = started(offline(DIMENSIONS, block(), simulated(), Reference::View));
        session.start_recording().unwrap();
        session.place(DVec3::new(30.0, 15.0, 20.0)).unwrap();
        session.view(DVec3::X, DVec3::new(0.0, 0.2, 1.0)).unwrap();
        session.hand(DVec3::new(33.0, 28.0, 22.0)).unwrap();
        session.run(0.5).unwrap();
        let id = SegmentId(1);
        let (low, high) = (IVec3::new(28, 20, 16), IVec3::new(38, 24, 27));
        session.fill_box(id, low, high, false).unwrap();
        session.run(0.5).unwrap();
        session.undo().unwrap();
        session.hand(DVec3::new(20.0, 30.0, 10.0)).unwrap();
        session.run(0.5).unwrap();
        (session.stop_recording().unwrap(), session.frame())
    };
    let (first, second) = (run(), run());
    assert!(first == second);
    assert_eq!(first.0.len(), 1500);
    assert!(first.0.contact.iter().any(|contact| *contact));
}

#[test]
fn the_hand_presses_the_simulated_device_against_the_block() {
    let session = started(offline(DIMENSIONS, block(), simulated(), Reference::View));
    session.place(DVec3::new(30.0, 10.0, 20.0)).unwrap();
    session.hand(DVec3::new(30.0, 40.0, 20.0)).unwrap();
    session.run(2.0).unwrap();
    let frame = session.frame();
    // hand and wall are springs in a row: 0.3 N/mm · (20 − d) = 1 N/mm · d at d = 4.6 mm;
    // what is left of the motion after 2 s moves it a little
    assert!(frame.contact);
    assert!(
        (frame.depth - 20.0 * 0.3 / 1.3).abs() < 0.1,
        "{}",
        frame.depth
    );
    // the force last sent is one reading behind
    let expected = frame.depth * Settings::default().stiffness;
    assert!((frame.force.length() - expected).abs() < 0.07 * expected);
}

#[test]
fn placing_brings_probe_device_and_hand_and_begins_without_force() {
    let session = started(offline(DIMENSIONS, block(), simulated(), Reference::View));
    session.hand(DVec3::new(30.0, 60.0, 20.0)).unwrap();
    session.run(0.5).unwrap();
    let point = DVec3::new(5.0, 30.0, 20.0);
    assert_eq!(session.place(point).unwrap(), point);
    session.start_recording().unwrap();
    session.run(0.001).unwrap();
    let first = session.stop_recording().unwrap();
    assert_eq!(first.force[0], DVec3::ZERO);
    for placed in [first.device[0], first.proxy[0], first.hand[0]] {
        // rounding of the mapping
        assert!(placed.distance(point) < 1e-9, "{placed}");
    }
    // the hand holds it there, though it was pulled elsewhere before
    session.run(1.0).unwrap();
    let frame = session.frame();
    assert!(frame.device.distance(point) < 0.2, "{}", frame.device);
    assert!(frame.notices.is_empty(), "{:?}", frame.notices);
}

#[test]
fn placing_inside_the_block_goes_to_its_nearest_free_voxel_and_says_so() {
    let session = started(offline(DIMENSIONS, block(), simulated(), Reference::View));
    let placed = session.place(DVec3::new(30.2, 23.0, 20.2)).unwrap();
    assert!(
        placed.distance(DVec3::new(30.5, 19.5, 20.5)) < 1e-9,
        "{placed}"
    );
    session.run(0.1).unwrap();
    let frame = session.frame();
    assert!(frame.proxy.y < 20.0);
    assert!(!frame.contact);
    assert_eq!(frame.notices.len(), 1);
    assert_eq!(frame.notices[0].level, NoticeLevel::Info);
}

#[test]
fn a_start_inside_the_block_begins_in_its_nearest_free_voxel_and_says_so() {
    let config = SessionConfig {
        start: Some(DVec3::new(12.0, 30.0, 20.0)),
        ..offline(DIMENSIONS, block(), simulated(), Reference::View)
    };
    let session = started(config);
    session.run(0.1).unwrap();
    let frame = session.frame();
    assert!((frame.proxy.x - 9.5).abs() < 0.1, "{}", frame.proxy);
    assert!(
        frame.notices[0].text.contains("2.6 mm"),
        "{:?}",
        frame.notices
    );
    assert_eq!(frame.safety.violations, 0);
}

#[test]
fn by_default_the_probe_begins_in_front_of_the_scan() {
    let session = started(offline(DIMENSIONS, block(), simulated(), Reference::View));
    session.run(0.05).unwrap();
    let frame = session.frame();
    assert!(frame.proxy.distance(DVec3::new(30.0, -20.0, 20.0)) < 0.1);
}

/// After turning the view by a quarter the device's right is the scene's up.
#[test]
fn the_device_moves_along_the_axes_of_the_view() {
    let path = [
        [0.0, 0.0, 0.0, 0.0],
        [0.1, 0.0, 0.0, 0.0],
        [0.2, 3.0, 0.0, 0.0],
    ];
    let session = started(offline(
        DIMENSIONS,
        block(),
        scripted(&path),
        Reference::View,
    ));
    session.run(0.05).unwrap();
    let before = session.frame().device;
    session.view(DVec3::Z, DVec3::NEG_X).unwrap();
    session.run(0.05).unwrap();
    let turned = session.frame().device;
    assert!(turned.distance(before) < 1e-9, "turning moved the device");
    session.run(0.2).unwrap();
    let moved = session.frame().device - before;
    assert!(moved.distance(DVec3::new(0.0, 0.0, 3.0)) < 1e-9, "{moved}");
}

#[test]
fn settings_come_to_a_resting_hand_as_far_as_the_device_bears_them() {
    let session = started(press_and_retreat());
    session.run(0.55).unwrap();
    let softer = Settings {
        stiffness: 0.4,
        ..Settings::default()
    };
    assert_eq!(session.set_settings(softer).unwrap(), softer);
    // a stiffness that is set anew is there after a quarter of a second
    session.run(0.3).unwrap();
    assert!((session.frame().force.length() - 2.0).abs() < 1e-6);

    // a force limit below what the spring wants cuts it, and counts
    let weaker = Settings {
        force_limit: 1.5,
        ..softer
    };
    session.set_settings(weaker).unwrap();
    session.run(0.05).unwrap();
    let frame = session.frame();
    assert!((frame.force.length() - 1.5).abs() < 1e-9);
    assert!(frame.safety.clamped > 0);

    let stiffer = Settings {
        stiffness: 10.0,
        ..softer
    };
    let held = session.set_settings(stiffer).unwrap();
    assert_eq!(held.stiffness, limits().max_stiffness);
    assert_eq!(session.frame().notices[0].level, NoticeLevel::Warning);
}

#[test]
fn at_4_khz_the_same_press_gives_the_same_force() {
    let config = SessionConfig {
        rate_hz: 4000,
        ..press_and_retreat()
    };
    let session = started(config);
    session.start_recording().unwrap();
    session.run(0.9).unwrap();
    assert_eq!(session.stop_recording().unwrap().len(), 3600);
    let frame = session.frame();
    assert!((frame.force.y + 5.0).abs() < 1e-6, "{}", frame.force);
    assert_eq!(frame.rates.servo.asked_hz, 4000.0);
    assert_eq!(frame.rates.servo.hz, 4000.0);
}

/// At most 250 a second reach the plot, however many ticks there are.
#[test]
fn samples_are_thinned_and_come_once() {
    for rate_hz in [1000, 4000] {
        let config = SessionConfig {
            rate_hz,
            ..press_and_retreat()
        };
        let session = started(config);
        session.run(1.0).unwrap();
        assert_eq!(session.frame().samples.len(), 250);
        assert!(session.frame().samples.is_empty());
    }
}

#[test]
fn what_is_not_allowed_is_refused_and_nothing_changes() {
    let session = started(press_and_retreat());
    let far = DVec3::new(0.0, 1e9, 0.0);
    for point in [DVec3::NAN, DVec3::INFINITY, far] {
        assert!(session.hand(point).is_err());
        assert!(session.place(point).is_err());
    }
    let id = SegmentId(1);
    assert!(
        session
            .fill_box(SegmentId(9), IVec3::ZERO, IVec3::ONE, true)
            .is_err()
    );
    assert!(session.fill_box(id, IVec3::ONE, IVec3::ONE, true).is_err());
    let outside = IVec3::splat(500);
    assert!(session.fill_box(id, outside, outside + 5, true).is_err());
    assert!(session.remove_segment(SegmentId(7)).is_err());
    assert!(session.run(f64::NAN).is_err());
    assert!(session.run(-1.0).is_err());
    let other_grid = box_segment(UVec3::splat(8), IVec3::ZERO, IVec3::ONE);
    assert!(session.add_segment(other_grid, OBSTACLE, true).is_err());
    assert_eq!(session.frame().edit, 1);

    for bad in [
        SessionConfig {
            rate_hz: 100,
            ..press_and_retreat()
        },
        SessionConfig {
            start: Some(DVec3::NAN),
            ..press_and_retreat()
        },
    ] {
        assert!(Session::start(bad).is_err());
    }
}

#[test]
fn a_stopped_session_refuses_commands_but_gives_its_recording_and_last_frame() {
    let session = started(press_and_retreat());
    session.start_recording().unwrap();
    session.run(0.8).unwrap();
    session.stop();
    session.stop();
    assert!(session.run(0.1).is_err());
    assert!(session.hand(DVec3::ZERO).is_err());
    assert!(session.undo().is_err());
    assert_eq!(session.frame().force, DVec3::ZERO);
    assert_eq!(session.stop_recording().unwrap().len(), 800);
}
