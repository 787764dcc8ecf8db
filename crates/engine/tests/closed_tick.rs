//! The servo's tick neither allocates nor frees, whatever it is told in it.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use common::*;
use glam::{DMat3, DVec3, UVec3};
use palpate_engine::handover::HandTarget;
use palpate_engine::settings::Settings;

/// Ends the test program at the first allocation where none is allowed.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

const DIMENSIONS: UVec3 = UVec3::splat(48);

/// Edits, roots, undo, placements, views, settings and hand targets, some of them held, some
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

fn change_something(
    rig: &mut Rig,
    ids: &[palpate_volume::edit::SegmentId; 2],
    random: &mut Random,
) {
    let id = ids[random.below(2) as usize];
    let simulation = &mut rig.simulation;
    match random.below(60) {
        0 if random.below(2) == 0 => rig.set_threshold(id, (random.between(50.0, 700.0), 2000.0)),
        0 => {
            let other = sponge(DIMENSIONS, random.below(99), 2 + random.below(9));
            simulation.replace_segment(id, other, None).unwrap();
        }
        1..=9 => {
            let solid = random.below(2) == 0;
            let region = random.voxel_box(DIMENSIONS, 40);
            simulation.fill_box(id, &region, solid).unwrap();
        }
        10..=14 => _ = simulation.undo().unwrap(),
        15 => _ = simulation.redo().unwrap(),
        16 => simulation.set_touchable(id, random.below(2) == 0).unwrap(),
        17 => _ = simulation.place(random.point(0.0, 48.0), 0, false),
        18 => simulation.turn(DMat3::IDENTITY),
        19 => {
            let settings = Settings {
                stiffness: random.between(0.1, 2.0),
                ..Settings::default()
            };
            simulation.set_settings(settings).unwrap();
        }
        20 => rig.hand.write(HandTarget {
            point: random.point(0.0, 48.0),
            number: 1,
        }),
        // a recording that begins asks the servo for its state
        21 => simulation.begin_tape(),
        _ => {}
    }
}
