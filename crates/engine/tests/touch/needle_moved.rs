//! A needle in segments that were moved: met where they stand, and while they move.

use glam::{DAffine3, DMat3, DVec3};
use palpate_engine::servo::TickRecord;
use palpate_haptics::needle::events::EventKind::{self, Punctured, Stopped, Withdrawn};
use palpate_volume::edit::SegmentId;
use palpate_volume::tissue::Tissue;

use super::needle::{ABOVE, Hand};

const SKIN: SegmentId = SegmentId(1);
const FAT: SegmentId = SegmentId(2);
const LIVER: SegmentId = SegmentId(3);
const BONE: SegmentId = SegmentId(4);

fn moved(poses: &[(SegmentId, DAffine3)]) -> Hand {
    let mut hand = Hand::new();
    for (id, pose) in poses {
        hand.rig.simulation.move_segment(*id, *pose).unwrap();
    }
    // segments go by small steps
    hand.rest(300);
    hand
}

/// Down to the bone and out again.
fn through(hand: &mut Hand) -> Vec<TickRecord> {
    let mut way = hand.go(ABOVE.with_z(24.0), 20.0);
    way.extend(hand.go(ABOVE, 20.0));
    hand.rest(40);
    way
}

fn events(hand: &Hand) -> Vec<(EventKind, u8)> {
    let report = hand.rig.simulation.needle_report();
    let events = report.events.iter();
    events.map(|event| (event.kind, event.segment)).collect()
}

/// A turn about the hand's way.
fn turned(degrees: f64) -> DAffine3 {
    let there = DAffine3::from_translation(ABOVE);
    there * DAffine3::from_mat3(DMat3::from_rotation_z(degrees.to_radians())) * there.inverse()
}

#[test]
fn layers_that_were_turned_about_the_needle_are_met_as_they_were() {
    let mut still = Hand::new();
    still.rest(300);
    let before = through(&mut still);
    let mut hand = moved(&[SKIN, FAT, LIVER, BONE].map(|id| (id, turned(20.0))));
    let after = through(&mut hand);
    assert_eq!(events(&hand), events(&still));
    let expected = [
        (Punctured, 1),
        (Punctured, 2),
        (Punctured, 3),
        (Stopped, 4),
        (Withdrawn, 0),
    ];
    assert_eq!(events(&hand), expected);
    let mut apart = 0;
    for (one, other) in before.iter().zip(&after) {
        apart += i32::from((one.force - other.force).length() > 0.02);
        assert!(other.proxy.z >= 30.0 - 1e-9, "{other:?}");
    }
    // some ticks around each puncture
    assert!(apart < 60, "{apart} of {}", before.len());
    assert_eq!(hand.rig.violations(), 0);
}

#[test]
fn a_moved_layer_is_met_where_it_stands_and_no_obstacle_until_the_needle_is_out() {
    // the fat is under the liver's place, which is lifted into the fat's
    let up = DAffine3::from_translation(DVec3::new(0.0, 0.0, 14.0));
    let mut hand = moved(&[
        (LIVER, up),
        (FAT, DAffine3::from_translation(DVec3::Z * -32.0)),
    ]);
    hand.go(ABOVE.with_z(60.0), 20.0);
    let report = hand.rig.simulation.needle_report();
    assert_eq!(report.punctured, [SKIN, LIVER]);
    let liver = report
        .events
        .iter()
        .find(|event| event.segment == 3)
        .unwrap();
    assert!((liver.depth - 4.0).abs() < 0.2, "{liver:?}");
    let proxy = hand.rest(20).proxy;
    assert!(proxy.z < 70.0, "the probe went in with the tip: {proxy}");
    hand.go(ABOVE, 40.0);
    hand.rest(40);
    assert!(hand.rig.simulation.needle_report().punctured.is_empty());
    hand.rig.simulation.stroke(false).unwrap();
    let pressed = hand.go(ABOVE.with_z(72.0), 40.0);
    assert!(pressed.last().unwrap().proxy.z >= 80.0);
    assert_eq!(hand.rig.violations(), 0);
}

#[test]
fn where_a_moved_segment_overlaps_another_the_last_one_counts_and_both_are_punctured() {
    // the skin beside the fat's lower half, in the liver's number's shadow
    let mut hand = moved(&[(SKIN, DAffine3::from_translation(DVec3::Z * -12.0))]);
    hand.go(ABOVE.with_z(63.0), 20.0);
    let report = hand.rig.simulation.needle_report();
    assert_eq!(report.punctured, [SKIN, FAT]);
    let kinds: Vec<_> = events(&hand);
    // first the fat alone, then fat and skin, of which fat is the last, then the fat alone again
    assert_eq!(kinds[0], (Punctured, 2));
    assert!(kinds.contains(&(Punctured, 2)), "{kinds:?}");
    assert!(report.forces.cutting <= Tissue::FAT.cutting + 1e-9);
}

#[test]
fn bone_that_was_moved_before_the_tip_stops_it() {
    let mut hand = moved(&[(BONE, DAffine3::from_translation(DVec3::Z * 25.0))]);
    let way = hand.go(ABOVE.with_z(40.0), 20.0);
    assert_eq!(events(&hand).last(), Some(&(Stopped, 4)));
    for record in way {
        assert!(record.proxy.z >= 55.0 - 1e-9, "{record:?}");
    }
}

/// Moved away from around the needle, back, and turned: no force jumps up, and all is replayed.
#[test]
fn a_segment_that_moves_while_the_needle_is_in_it_never_makes_the_force_jump() {
    let mut hand = moved(&[SKIN, LIVER].map(|id| (id, turned(10.0))));
    hand.go(ABOVE.with_z(44.0), 20.0);
    let in_liver = hand.rest(100);
    let friction = hand.rig.simulation.needle_report().forces.friction;
    hand.record();
    let mut force = in_liver.force.length();
    let poses = [
        DAffine3::from_translation(DVec3::X * 60.0),
        turned(10.0),
        DAffine3::from_translation(DVec3::Z * 8.0),
        turned(-30.0),
    ];
    let mut lowest = f64::INFINITY;
    for (number, pose) in poses.into_iter().enumerate() {
        hand.rig.simulation.move_segment(LIVER, pose).unwrap();
        for tick in 0..400_i32 {
            let deeper = f64::from(100 - (tick % 200 - 100).abs()) * 1e-3;
            let record = hand.go(ABOVE.with_z(44.0 - deeper), 1e3).pop().unwrap();
            // the hand goes to and fro by 0.001 mm in a tick
            let grown = record.force.length() - force;
            assert!(grown <= 0.001 + 0.02 + 1e-9, "{grown}");
            force = record.force.length();
        }
        if number == 0 {
            lowest = hand.rig.simulation.needle_report().forces.friction;
        }
    }
    assert!(lowest < 0.8 * friction, "{lowest} of {friction}");
    hand.expect_equal_replay();
    assert_eq!(hand.rig.violations(), 0);
}
