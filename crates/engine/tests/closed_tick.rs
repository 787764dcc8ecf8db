//! The servo's tick neither allocates nor frees, whatever it is told in it.
//!
//! A binary of its own: its allocator ends the whole process.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use common::changes::change_something;
use common::*;
use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_volume::edit::SegmentId;
use palpate_volume::tissue::Tissue;

/// Ends the test program at the first allocation where none is allowed.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

const DIMENSIONS: UVec3 = UVec3::splat(48);

/// Edits, roots, undo, moves, radii, placements, views, settings and hand targets, some of them held, some
/// more than the servo keeps; the ticks alone are watched.
#[test]
fn no_tick_allocates_or_frees() {
    let mut random = Random::new(5);
    let mut rig = Rig::of_scan(waves(DIMENSIONS), DVec3::splat(-5.0));
    let ids = [3, 8].map(|one_in| {
        rig.simulation
            .add_segment(sponge(DIMENSIONS, one_in, one_in), OBSTACLE, false)
            .unwrap()
    });
    let mut device = DVec3::splat(-5.0);
    let (mut pending, mut contacts) = (0_u32, 0_u32);
    for tick in 0..20_000_u64 {
        change_something(&mut rig, &ids, &mut random);
        // a recording that begins asks the servo for its state
        if tick % 60 == 0 {
            rig.simulation.begin_tape();
        }
        // the simulation frees what comes back now and then only, so that rings fill up
        if tick % 50 == 0 {
            rig.simulation.step();
            pending += u32::from(rig.status.read().pending > 0);
        }
        device = (device + random.point(-1.0, 1.0)).clamp(DVec3::splat(-4.0), DVec3::splat(52.0));
        rig.read_at(device);
        let (now, servo) = (rig.now, &mut rig.servo);
        assert_no_alloc(|| servo.step(now));
        rig.now += 1e-3;
        contacts += u32::from(rig.records.pop().unwrap().contact);
    }
    assert_eq!(rig.violations(), 0);
    // the test means something
    assert!(pending > 20, "{pending}");
    assert!(contacts > 2_000, "{contacts}");
}

/// 10⁵ moves of up to 50 voxels with a needle, through skin and liver around bone and a sponge of
/// bone; the ticks alone are watched for allocations, every one for where the probe is.
#[test]
fn a_needle_neither_allocates_nor_comes_into_what_it_has_not_punctured() {
    push_a_needle_at_random(11, false, false);
}

/// The same with directions that are set, and taken back, as it goes.
#[test]
fn nor_does_a_needle_whose_direction_is_set() {
    push_a_needle_at_random(12, true, false);
}

/// The same in skin and liver that were moved, and are moved on around the needle.
#[test]
fn nor_does_a_needle_in_segments_that_move() {
    push_a_needle_at_random(13, true, true);
}

fn push_a_needle_at_random(seed: u128, is_aimed: bool, moves: bool) {
    let mut random = Random::new(seed);
    let start = DVec3::splat(-5.0);
    let mut rig = Rig::new(DIMENSIONS, start);
    let skin = box_segment(DIMENSIONS, IVec3::splat(4), IVec3::splat(44));
    let liver = box_segment(DIMENSIONS, IVec3::splat(6), IVec3::splat(42));
    let bone = box_segment(DIMENSIONS, IVec3::splat(14), IVec3::splat(34));
    let add = |rig: &mut Rig, segment| rig.simulation.add_segment(segment, OBSTACLE, false);
    // the skin has all within it, as a threshold has
    for segment in [skin, liver, bone, sponge(DIMENSIONS, 5, 150)] {
        add(&mut rig, segment).unwrap();
    }
    let needle = ToolSettings {
        tissues: vec![Tissue::SKIN, Tissue::LIVER],
        ..ToolSettings::new(ToolKind::Needle, 0.5, vec![SegmentId(1), SegmentId(2)])
    };
    rig.simulation.set_tool(Some(needle)).unwrap();
    rig.simulation.stroke(true).unwrap();

    let (mut device, mut way) = (start, DVec3::ZERO);
    let (mut inside, mut withdrawn) = (0_u32, 0_u32);
    let (mut was_in, mut force) = (false, 0.0);
    for tick in 0..100_000_u64 {
        if tick % 10 == 0 {
            rig.simulation.step();
        }
        if tick % 300 == 0 {
            way = random.point(-0.15, 0.15);
            if moves && tick % 1500 == 0 {
                let id = SegmentId(1 + random.below(2) as u8);
                let pose = DAffine3::from_axis_angle(DVec3::Z, random.point(-0.3, 0.3).x);
                let pose = DAffine3::from_translation(random.point(-3.0, 3.0)) * pose;
                rig.simulation.move_segment(id, pose).unwrap();
            }
            if is_aimed {
                // mostly near the way of the hand, so that it goes in
                let direction = way + random.point(-0.15, 0.15);
                let set = (random.below(4) > 0).then_some(direction);
                rig.simulation.set_needle_direction(set).unwrap();
            }
        }
        let before = device;
        device += match random.below(400) {
            0 => random.point(-50.0, 50.0),
            _ => way + random.point(-0.02, 0.02),
        };
        device = device.clamp(DVec3::splat(-6.0), DVec3::splat(54.0));
        rig.read_at(device);
        let (now, servo) = (rig.now, &mut rig.servo);
        assert_no_alloc(|| servo.step(now));
        rig.now += 1e-3;
        let record = rig.records.pop().unwrap();
        assert!(record.force.is_finite());
        // 1 N/mm over the hand's way and a fiftieth of a voxel
        let grown = record.force.length() - force;
        assert!(
            grown <= device.distance(before) + 0.02 + 1e-9,
            "{tick} {grown}"
        );
        force = record.force.length();

        let voxel = record.proxy.floor().as_ivec3();
        assert!(!rig.servo.solid().is_solid(voxel), "{tick} {voxel}");
        for hard in [3, 4].map(SegmentId) {
            let segment = rig.simulation.voxels().segment(hard).unwrap();
            assert!(!segment.contains(voxel), "{tick} {voxel}");
        }
        let is_in = rig.servo.needle().insertion().is_some();
        inside += u32::from(is_in);
        withdrawn += u32::from(was_in && !is_in);
        was_in = is_in;
    }
    assert_eq!(rig.violations(), 0);
    // the test means something
    let events = rig.simulation.needle_report().events;
    let of = |id: u8| events.iter().filter(|event| event.segment == id).count();
    // along a direction fewer pushes go in
    let least = if is_aimed { 10 } else { 20 };
    assert!(of(2) > least, "{}", of(2));
    if !is_aimed {
        assert!(of(3) + of(4) > least, "{} {}", of(3), of(4));
    }
    assert!(inside > 20_000, "{inside}");
    assert!(withdrawn as usize > least, "{withdrawn}");
}
