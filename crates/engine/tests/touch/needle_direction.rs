//! A needle in a session whose direction is set: what is felt, told and replayed.

use glam::DVec3;
use palpate_haptics::needle::events::EventKind::Punctured;

use super::needle::{ABOVE, Hand};

#[test]
fn a_needle_goes_in_along_the_direction_that_is_set_and_is_withdrawn_along_it() {
    let mut hand = Hand::new();
    let direction = DVec3::new(0.6, 0.0, -1.0);
    hand.rig
        .simulation
        .set_needle_direction(Some(direction))
        .unwrap();
    hand.go(ABOVE.with_z(72.0), 20.0);
    let place = hand.rig.simulation.needle_report().place.unwrap();
    assert!(
        (place.direction - direction.normalize()).length() < 1e-12,
        "{place:?}"
    );
    // it was touched below the hand
    assert!(place.entry.distance(ABOVE.with_z(80.0)) < 0.1, "{place:?}");
    hand.go(place.entry + place.direction * 25.0, 20.0);
    let deeper = hand.rig.simulation.needle_report().place.unwrap();
    assert!(deeper.depth > 15.0 && deeper.direction == place.direction);
    assert!(hand.rig.simulation.withdraw_needle(0).unwrap());
    hand.rest(40);
    assert!(hand.rig.simulation.needle_report().place.is_none());
    assert_eq!(hand.rig.violations(), 0);
}

#[test]
fn a_push_too_far_off_the_direction_never_goes_in_and_never_jumps() {
    let mut hand = Hand::new();
    hand.rig
        .simulation
        .set_needle_direction(Some(DVec3::new(1.0, 0.0, -0.2)))
        .unwrap();
    let mut force = 0.0;
    for record in hand.go(ABOVE.with_z(60.0), 40.0) {
        assert!(record.force.length() - force <= 0.04 + 0.02 + 1e-9);
        force = record.force.length();
        assert!(record.proxy.z >= 80.0, "{record:?}");
    }
    let report = hand.rig.simulation.needle_report();
    assert!(report.place.is_none() && report.events.is_empty());
    assert!(force > 5.0, "{force}");
}

#[test]
fn a_recording_with_directions_is_computed_again_bit_for_bit() {
    for set_before in [false, true] {
        let mut hand = Hand::new();
        let aim = |hand: &mut Hand, direction| {
            hand.rig
                .simulation
                .set_needle_direction(Some(direction))
                .unwrap();
        };
        let first = DVec3::new(0.2, 0.3, -2.0);
        if set_before {
            aim(&mut hand, first);
        }
        hand.rest(30);
        hand.record();
        if !set_before {
            aim(&mut hand, first);
        }
        hand.go(DVec3::new(22.0, 19.0, 50.0), 60.0);
        aim(&mut hand, DVec3::new(-0.5, 0.0, -1.0));
        hand.go(ABOVE, 60.0);
        hand.rest(50);
        hand.go(DVec3::new(18.0, 20.0, 50.0), 60.0);
        hand.expect_equal_replay();
        let events = hand.rig.simulation.needle_report().events;
        let in_skin = events
            .iter()
            .filter(|event| (event.kind, event.segment) == (Punctured, 1));
        assert_eq!(in_skin.count(), 2);
        let direction = hand.rig.servo.needle().insertion().unwrap().line.direction;
        assert!(direction.x < -0.4, "{direction}");
    }
}

#[test]
fn what_is_no_direction_is_refused_and_none_follows_the_push() {
    let mut hand = Hand::new();
    for nonsense in [DVec3::ZERO, DVec3::new(f64::NAN, 0.0, 1.0), DVec3::INFINITY] {
        let error = hand
            .rig
            .simulation
            .set_needle_direction(Some(nonsense))
            .unwrap_err();
        assert!(error.to_string().contains("direction"), "{error}");
    }
    hand.rig
        .simulation
        .set_needle_direction(Some(DVec3::X))
        .unwrap();
    hand.rig.simulation.set_needle_direction(None).unwrap();
    hand.go(ABOVE.with_z(70.0), 20.0);
    let place = hand.rig.simulation.needle_report().place.unwrap();
    assert!(place.direction.z < -0.99, "{place:?}");
}
