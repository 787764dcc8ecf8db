//! A hand that presses with the mouse: it comes onto what is under the pointer, pushes with what is
//! asked for, slides, crosses gaps, and lifts.

use crate::common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::picture::Frame;
use palpate_engine::replay::Recording;
use palpate_engine::scene::Properties;
use palpate_engine::session::{Reference, Session, SessionConfig};
use palpate_engine::touch::Settings;
use palpate_volume::segment::Segment;

const DIMENSIONS: UVec3 = UVec3::splat(70);
const CENTRE: DVec3 = DVec3::splat(35.0);
const RADIUS: f64 = 20.0;
/// The pointer's ray comes from the front, along +y.
const EYE: DVec3 = DVec3::new(35.0, -300.0, 35.0);

fn ball() -> Segment {
    Segment::from_fn(DIMENSIONS, |voxel| {
        (voxel.as_dvec3() + 0.5).distance(CENTRE) < RADIUS
    })
}

/// One plate 10 mm behind the other, beside it.
fn plates() -> Segment {
    Segment::from_fn(DIMENSIONS, |voxel| {
        let front = if voxel.x < 35 { 20 } else { 30 };
        (front..front + 6).contains(&voxel.y)
    })
}

fn session_of(segment: Segment) -> Session {
    started(offline(DIMENSIONS, segment, simulated(), Reference::View))
}

/// Presses at a place of the front for a while.
fn press(session: &Session, x: f64, z: f64, pressure: f64, seconds: f64) -> Frame {
    let origin = EYE.with_x(x).with_z(z);
    session.press(origin, DVec3::Y, pressure).unwrap();
    session.run(seconds).unwrap();
    session.frame()
}

/// A block with its front at y = 20 mm that was moved 8 mm to the front.
fn moved_block() -> SessionConfig {
    let low = IVec3::new(10, 20, 10);
    let block = box_segment(DIMENSIONS, low, IVec3::new(60, 50, 60));
    let moved = Properties {
        pose: Some(shifted(DVec3::Y * -8.0)),
        ..OBSTACLE
    };
    let config = offline(DIMENSIONS, block.clone(), simulated(), Reference::View);
    SessionConfig {
        segments: vec![(block, moved)],
        ..config
    }
}

fn largest_force(recording: &Recording) -> f64 {
    recording
        .force
        .iter()
        .map(|force| force.length())
        .fold(0.0, f64::max)
}

fn assert_safe(session: &Session) {
    let frame = session.frame();
    assert_eq!(frame.safety.violations, 0);
    assert_eq!(frame.safety.watchdog, 0);
    assert_eq!(session.failure(), None);
}

#[test]
fn a_press_comes_onto_the_surface_under_the_pointer_with_the_force_that_is_asked_for() {
    for pressure in [0.1, 1.0, 5.0] {
        let session = session_of(ball());
        session.start_recording().unwrap();
        let frame = press(&session, 40.0, 35.0, pressure, 3.0);
        let recording = session.stop_recording().unwrap();
        assert!(frame.contact);
        let force = frame.force.length();
        assert!((force / pressure - 1.0).abs() < 0.1, "{force} {pressure}");
        assert!(largest_force(&recording) < 1.2 * pressure);
        // the ball's surface under the pointer
        let surface = CENTRE + DVec3::new(5.0, -(RADIUS * RADIUS - 25.0).sqrt(), 0.0);
        assert!(frame.proxy.distance(surface) < 1.5, "{}", frame.proxy);
        assert_safe(&session);
    }
}

#[test]
fn a_slow_slide_stays_under_the_pointer() {
    let session = session_of(ball());
    press(&session, 25.0, 35.0, 1.0, 2.0);
    session.start_recording().unwrap();
    // 20 mm/s across the ball
    for step in 0..100 {
        let x = 25.0 + 0.2 * f64::from(step);
        let frame = press(&session, x, 35.0, 1.0, 0.01);
        let surface = CENTRE.y - (RADIUS * RADIUS - (x - CENTRE.x).powi(2)).sqrt();
        let off = frame.proxy - DVec3::new(x, surface, 35.0);
        assert!(off.length() < 2.0, "{off} at {x}");
        assert!(frame.contact, "{x}");
    }
    let recording = session.stop_recording().unwrap();
    assert!(largest_force(&recording) < 1.3);
    assert_safe(&session);
}

#[test]
fn at_an_edge_it_lifts_crosses_and_lands_without_a_jump_of_the_force() {
    for (from, to) in [(25.0, 45.0), (45.0, 25.0)] {
        let session = session_of(plates());
        let first = press(&session, from, 35.0, 1.0, 2.0);
        assert!(first.contact);
        session.start_recording().unwrap();
        let last = press(&session, to, 35.0, 1.0, 2.5);
        let recording = session.stop_recording().unwrap();
        assert!((last.force.length() - 1.0).abs() < 0.1, "{}", last.force);
        assert!((last.proxy.x - to).abs() < 1.0, "{}", last.proxy);
        let depth = if to < 35.0 { 20.0 } else { 30.0 };
        assert!((last.proxy.y - depth).abs() < 0.1, "{}", last.proxy);
        assert!(largest_force(&recording) < 1.2);
        assert!(recording.contact.iter().any(|contact| !contact));
        // it went there: no probe is placed elsewhere while it presses, a slide goes a voxel or two
        let steps = recording.proxy.windows(2);
        let longest = steps
            .map(|pair| pair[0].distance(pair[1]))
            .fold(0.0, f64::max);
        assert!(longest < 2.0, "{longest}");
        assert_safe(&session);
    }
}

#[test]
fn a_lifted_hand_leaves_no_force() {
    let session = session_of(ball());
    press(&session, 35.0, 35.0, 2.0, 2.0);
    session.lift().unwrap();
    session.run(0.5).unwrap();
    let frame = session.frame();
    assert!(!frame.contact);
    assert_eq!(frame.force, DVec3::ZERO);
    assert!(frame.proxy.y < CENTRE.y - RADIUS - 2.0, "{}", frame.proxy);
    assert_safe(&session);
}

#[test]
fn the_wheel_changes_the_force_while_it_presses() {
    let session = session_of(ball());
    press(&session, 35.0, 35.0, 1.0, 2.0);
    for pressure in [3.0, 0.5] {
        let force = press(&session, 35.0, 35.0, pressure, 1.0).force.length();
        assert!((force / pressure - 1.0).abs() < 0.1, "{force} {pressure}");
    }
}

#[test]
fn beside_everything_a_press_waits_before_it_and_comes_down_again() {
    let session = session_of(ball());
    press(&session, 35.0, 35.0, 1.0, 2.0);
    let beside = press(&session, 65.0, 35.0, 1.0, 1.5);
    assert!(!beside.contact);
    assert!((beside.proxy.x - 65.0).abs() < 1.0, "{}", beside.proxy);
    let again = press(&session, 35.0, 35.0, 1.0, 2.5);
    assert!((again.force.length() - 1.0).abs() < 0.1, "{}", again.force);
    assert_safe(&session);
}

#[test]
fn a_ball_at_another_gain_presses_alike() {
    let config = offline(DIMENSIONS, ball(), simulated(), Reference::View);
    let settings = Settings {
        probe_radius: 3.0,
        gain: 2.0,
        ..config.settings
    };
    let session = started(SessionConfig { settings, ..config });
    let frame = press(&session, 35.0, 35.0, 1.0, 3.0);
    assert!((frame.force.length() - 1.0).abs() < 0.1, "{}", frame.force);
    assert!(
        (frame.proxy.y - (CENTRE.y - RADIUS - 3.0)).abs() < 1.0,
        "{}",
        frame.proxy
    );
    assert_safe(&session);
}

#[test]
fn what_was_moved_is_pressed_where_it_stands() {
    let session = started(moved_block());
    let frame = press(&session, 35.0, 35.0, 1.0, 3.0);
    assert!((frame.proxy.y - 12.0).abs() < 0.1, "{}", frame.proxy);
    assert!((frame.force.length() - 1.0).abs() < 0.1, "{}", frame.force);
}

#[test]
fn a_pointer_that_jumps_about_a_sponge_breaks_no_guarantee_and_leaves_no_force() {
    let dimensions = UVec3::splat(30);
    let full = sponge(dimensions, 3, 3);
    let session = started(offline(dimensions, full, simulated(), Reference::View));
    let mut random = Random::new(11);
    for _ in 0..8 {
        let at = random.point(2.0, 28.0);
        let frame = press(&session, at.x, at.z, 1.0, 0.25);
        // what stands beside its way may stop it for a moment
        assert!(frame.force.length() < 3.0, "{}", frame.force);
    }
    session.lift().unwrap();
    session.run(1.0).unwrap();
    // it may have come to rest in a hole, where it touches a wall without being pulled to it
    assert!(
        session.frame().force.length() < 0.02,
        "{}",
        session.frame().force
    );
    assert_safe(&session);
}

#[test]
fn a_press_on_nothing_moves_nothing() {
    let session = session_of(ball());
    let before = session.frame();
    let after = press(&session, 68.0, 68.0, 1.0, 0.5);
    assert_eq!(after.hand, before.hand);
}

#[test]
fn a_hand_that_is_led_elsewhere_ends_the_press() {
    let session = session_of(ball());
    press(&session, 35.0, 35.0, 1.0, 2.0);
    let free = DVec3::new(35.0, 5.0, 35.0);
    session.hand(free).unwrap();
    session.run(1.0).unwrap();
    let frame = session.frame();
    assert_eq!(frame.hand, free);
    assert!(!frame.contact);
    // and what is placed stays there
    press(&session, 35.0, 35.0, 1.0, 2.0);
    session.place(free).unwrap();
    session.run(1.0).unwrap();
    assert!(session.frame().proxy.distance(free) < 0.1);
}

#[test]
fn a_recorded_press_is_the_same_to_the_bit() {
    let run = || {
        let session = session_of(plates());
        session.start_recording().unwrap();
        press(&session, 25.0, 35.0, 1.0, 1.0);
        press(&session, 45.0, 35.0, 1.0, 1.0);
        session.lift().unwrap();
        session.run(0.2).unwrap();
        session.stop_recording().unwrap()
    };
    assert!(run() == run());
}

#[test]
fn what_is_no_ray_and_no_force_is_refused() {
    let session = session_of(ball());
    assert!(session.press(EYE, DVec3::ZERO, 1.0).is_err());
    assert!(session.press(DVec3::NAN, DVec3::Y, 1.0).is_err());
    for pressure in [0.0, -1.0, 5.1, f64::NAN] {
        assert!(session.press(EYE, DVec3::Y, pressure).is_err());
    }
    let path = [[0.0, 1.0, 1.0, 1.0], [1.0, 1.0, 1.0, 1.0]];
    let led = started(offline(
        DIMENSIONS,
        ball(),
        scripted(&path),
        Reference::Scene,
    ));
    assert!(led.press(EYE, DVec3::Y, 1.0).is_err());
}
