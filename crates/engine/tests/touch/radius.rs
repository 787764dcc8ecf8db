//! The probe's radius: raised as far as there is room, and held back nowhere else.

use crate::common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::error::SessionError;
use palpate_engine::touch::Settings;

const DIMENSIONS: UVec3 = UVec3::splat(48);
const START: DVec3 = DVec3::new(24.5, 24.5, 40.5);

#[test]
fn the_radius_is_raised_only_as_far_as_the_ball_has_room() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let floor = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(48, 48, 20));
    rig.simulation.add_segment(floor, OBSTACLE, true).unwrap();
    let device = DVec3::new(24.5, 24.5, 18.5);
    let touching = rig.ticks(SETTLED, device);
    assert!((touching.proxy.z - 20.0).abs() < BEFORE_FACE);
    let ball = Settings {
        probe_radius: 3.0,
        ..Settings::default()
    };
    rig.simulation.set_settings(ball).unwrap();
    let raised = rig.ticks(SETTLED, device);
    // the middle of a ball of 3 voxels rests in the third cell above the floor
    assert!((raised.proxy.z - 23.0).abs() < BEFORE_FACE, "{raised:?}");
    // the smooth surface of the ball's middles is 3 mm above that of the floor
    // on a plane to within the blur's table, 0.1 % of a voxel and some
    assert!((raised.contact_point.z - 23.0).abs() < 0.01, "{raised:?}");

    let absurd = Settings {
        probe_radius: 19.0,
        ..Settings::default()
    };
    let refused = rig.simulation.set_settings(absurd).unwrap_err();
    assert!(matches!(refused, SessionError::Ball(_)), "{refused}");
}

fn with_radius(probe_radius: f64) -> Settings {
    Settings {
        probe_radius,
        ..Settings::default()
    }
}

/// A push reaches over seven voxels; the radius grows by one per tick, so that it needs no more.
#[test]
fn a_radius_far_larger_than_a_push_is_reached_in_contact() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let floor = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(48, 48, 20));
    rig.simulation.add_segment(floor, OBSTACLE, true).unwrap();
    let device = DVec3::new(24.5, 24.5, 19.0);
    rig.ticks(SETTLED, device);
    rig.simulation.set_settings(with_radius(14.5)).unwrap();
    let mut before = 20.0;
    // fifteen steps, and one tick in which the settings arrive
    for _ in 0..16 {
        let record = rig.tick_at(device);
        // one cell at a time
        assert!(record.proxy.z - before < 1.0 + BEFORE_FACE, "{record:?}");
        before = record.proxy.z;
    }
    // 15 cells of 1 mm hold a ball of 14.5 mm
    assert!((before - 35.0).abs() < BEFORE_FACE, "{before}");
    rig.simulation.step();
    assert_eq!(rig.status.read().probe_radius, 14.5);

    // smaller at once
    rig.simulation.set_settings(with_radius(0.0)).unwrap();
    let smaller = rig.ticks(ARRIVED, device);
    assert!((smaller.proxy.z - 20.0).abs() < BEFORE_FACE, "{smaller:?}");
    assert_eq!(rig.status.read().probe_radius, 0.0);
}

/// Where there is no room the ball stays as large as there is; nothing else waits for it, and
/// it goes on once it is out.
#[test]
fn a_radius_that_has_no_room_holds_nothing_else_back_and_comes_where_there_is_room() {
    let mut rig = Rig::new(DIMENSIONS, DVec3::new(-12.0, 24.5, 25.5));
    let floor = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(48, 48, 20));
    let lid = box_segment(DIMENSIONS, IVec3::new(0, 0, 31), IVec3::splat(48));
    rig.simulation.add_segment(floor, OBSTACLE, true).unwrap();
    let lid = rig.simulation.add_segment(lid, OBSTACLE, true).unwrap();
    let between = DVec3::new(24.5, 24.5, 25.5);
    for share in 0..=100 {
        let way = DVec3::new(-12.0, 24.5, 25.5).lerp(between, f64::from(share) / 100.0);
        rig.ticks(1, way);
    }
    rig.simulation.set_settings(with_radius(9.0)).unwrap();
    rig.ticks(SETTLED, between);
    // eleven voxels: one cell, and five on either side
    assert_eq!(rig.status.read().probe_radius, 5.0);

    // bulk changes and moves come in meanwhile
    let block = box_segment(DIMENSIONS, IVec3::new(40, 40, 40), IVec3::splat(44));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    rig.ticks(ARRIVED, between);
    rig.simulation.move_segment(id, shifted(DVec3::X)).unwrap();
    rig.ticks(ARRIVED, between);
    assert_eq!(rig.status.read().pending, 0);
    assert_eq!(rig.status.read().probe_radius, 5.0);

    // with the lid gone there is room
    rig.simulation.remove_segment(lid).unwrap();
    let grown = rig.ticks(SETTLED, between);
    assert_eq!(rig.status.read().probe_radius, 9.0);
    assert!((grown.proxy.z - 29.0).abs() < BEFORE_FACE, "{grown:?}");
}
