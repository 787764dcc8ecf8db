//! Segments that are moved while they are touched, balls, and feels, through a whole session.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use common::{OBSTACLE, Random, Rig, box_segment, sponge};
use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_engine::error::SessionError;
use palpate_engine::feel::Feel;
use palpate_engine::settings::Settings;
use palpate_haptics::smooth::Smoothing;

const DIMENSIONS: UVec3 = UVec3::splat(48);
const START: DVec3 = DVec3::new(24.5, 24.5, 40.5);

fn shifted(by: DVec3) -> DAffine3 {
    DAffine3::from_translation(by)
}

/// Ticks with the simulation between them, as a session has it; gives the last record.
fn ticks(rig: &mut Rig, count: u32, device: DVec3) -> palpate_engine::handover::TickRecord {
    let mut last = None;
    for tick in 0..count {
        last = Some(rig.tick_at(device));
        if tick % 10 == 0 {
            rig.simulation.step();
        }
        assert_eq!(rig.violations(), 0);
    }
    rig.simulation.step();
    last.expect("some ticks")
}

#[test]
fn a_segment_that_is_moved_into_the_probe_pushes_it() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::new(10, 10, 4), IVec3::new(38, 38, 20));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    ticks(&mut rig, 20, START);
    rig.simulation
        .move_segment(id, shifted(DVec3::Z * 26.0))
        .unwrap();
    let pushed = ticks(&mut rig, 100, START);
    // its upper side was at z = 20, and stands at 46 now
    assert!(pushed.proxy.z > 46.0 && pushed.proxy.z < 46.1, "{pushed:?}");
    assert!(pushed.contact && pushed.force.z > 0.0);
    assert_eq!(
        rig.simulation.segments()[0].pose,
        Some(shifted(DVec3::Z * 26.0))
    );
    assert_eq!(rig.status.read().touched, id.0);

    // taken back, it leaves the probe where the device is
    assert!(rig.simulation.undo().unwrap());
    let free = ticks(&mut rig, 200, START);
    assert!(!free.contact && free.proxy == START, "{free:?}");
    assert_eq!(free.force, DVec3::ZERO);
}

#[test]
fn moves_of_one_drag_are_taken_back_at_once() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::splat(4), IVec3::splat(9));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    for step in 1..20 {
        let pose = shifted(DVec3::X * f64::from(step));
        rig.simulation.move_segment(id, pose).unwrap();
    }
    assert!(rig.simulation.undo().unwrap());
    let pose = rig.simulation.segments()[0].pose;
    assert_eq!(pose, Some(DAffine3::IDENTITY));
    assert!(rig.simulation.redo().unwrap());
    let pose = rig.simulation.segments()[0].pose;
    assert_eq!(pose, Some(shifted(DVec3::X * 19.0)));
}

#[test]
fn a_probe_pinched_between_two_stops_the_moving_one_until_it_is_out() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let lid = box_segment(DIMENSIONS, IVec3::new(0, 0, 44), IVec3::new(48, 48, 48));
    let block = box_segment(DIMENSIONS, IVec3::new(10, 10, 4), IVec3::new(38, 38, 20));
    rig.simulation.add_segment(lid, OBSTACLE, true).unwrap();
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    ticks(&mut rig, 20, START);
    rig.simulation
        .move_segment(id, shifted(DVec3::Z * 26.0))
        .unwrap();
    let pinched = ticks(&mut rig, 200, START);
    assert!(
        pinched.proxy.z > 20.0 && pinched.proxy.z < 44.0,
        "{pinched:?}"
    );
    let state = rig.simulation.segments()[1];
    assert!(state.pending, "{state:?}");
    assert!(
        rig.notices
            .try_iter()
            .any(|notice| notice.text.contains("pinch"))
    );

    // out to the side: it goes on
    let aside = DVec3::new(-8.0, 24.5, 40.5);
    for share in 1..=400 {
        let device = START.lerp(aside, f64::from(share) / 400.0);
        ticks(&mut rig, 1, device);
    }
    ticks(&mut rig, 100, aside);
    assert!(!rig.simulation.segments()[1].pending);
}

#[test]
fn poses_that_are_not_rigid_are_refused() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::splat(4), IVec3::splat(9));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    let mirror = DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0));
    for pose in [
        DAffine3::from_scale(DVec3::splat(1.1)),
        DAffine3::from_mat3(mirror),
        shifted(DVec3::NAN),
        shifted(DVec3::X * 1e12),
    ] {
        let refused = rig.simulation.move_segment(id, pose).unwrap_err();
        assert!(matches!(refused, SessionError::Pose(_)), "{refused}");
    }
}

#[test]
fn the_radius_is_raised_only_as_far_as_the_ball_has_room() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let floor = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(48, 48, 20));
    rig.simulation.add_segment(floor, OBSTACLE, true).unwrap();
    let device = DVec3::new(24.5, 24.5, 18.5);
    let touching = ticks(&mut rig, 60, device);
    assert!((touching.proxy.z - 20.0).abs() < 1e-6);
    let ball = Settings {
        probe_radius: 3.0,
        ..Settings::default()
    };
    rig.simulation.set_settings(ball).unwrap();
    let raised = ticks(&mut rig, 100, device);
    // the middle of a ball of 3 voxels rests in the third cell above the floor
    assert!((raised.proxy.z - 23.0).abs() < 1e-6, "{raised:?}");
    // the smooth surface of the ball's middles is 3 mm above that of the floor
    assert!((raised.contact_point.z - 23.0).abs() < 0.1, "{raised:?}");

    let absurd = Settings {
        probe_radius: 19.0,
        ..Settings::default()
    };
    let refused = rig.simulation.set_settings(absurd).unwrap_err();
    assert!(matches!(refused, SessionError::Ball(_)), "{refused}");
}

#[test]
fn a_segment_with_a_stiffness_of_its_own_is_felt_so() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let floor = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(48, 48, 20));
    let id = rig.simulation.add_segment(floor, OBSTACLE, true).unwrap();
    let soft = Feel {
        stiffness: Some(0.25),
        ..Feel::default()
    };
    rig.simulation.set_feel(id, soft).unwrap();
    let device = DVec3::new(24.5, 24.5, 18.0);
    let pressed = ticks(&mut rig, 300, device);
    // the smooth surface of a flat floor is the floor, to 0.1 %
    assert!((pressed.force.z - 0.25 * 2.0).abs() < 0.01, "{pressed:?}");
    assert_eq!(rig.status.read().touched, id.0);
}

/// Guarantee 1 with everything at once: edits, moves, radii, switches, under a hand that presses.
#[test]
fn whatever_is_done_to_the_scene_the_probe_is_never_inside() {
    let mut random = Random::new(11);
    let mut rig = Rig::new(DIMENSIONS, DVec3::new(24.5, 24.5, 60.0));
    let parts = [1, 2, 3].map(|seed| sponge(DIMENSIONS, seed, 12));
    let ids = parts.map(|part| rig.simulation.add_segment(part, OBSTACLE, false).unwrap());
    let mut device = DVec3::new(24.5, 24.5, 60.0);
    for round in 0..600 {
        let id = ids[random.below(3) as usize];
        match random.below(7) {
            0 => {
                let turn = DMat3::from_rotation_z(random.between(-0.5, 0.5));
                let by = random.point(-4.0, 4.0);
                let pose = DAffine3::from_mat3_translation(turn, by);
                rig.simulation.move_segment(id, pose).unwrap();
            }
            1 => {
                let settings = Settings {
                    probe_radius: random.between(0.0, 3.0),
                    smoothing: Smoothing::ALL[random.below(3) as usize],
                    friction_static: 0.3,
                    friction_kinetic: 0.2,
                    ..Settings::default()
                };
                rig.simulation.set_settings(settings).unwrap();
            }
            2 => {
                let touchable = random.below(3) > 0;
                rig.simulation.set_touchable(id, touchable).unwrap();
            }
            3 => {
                rig.simulation.undo().unwrap();
            }
            _ => {
                let region = random.voxel_box(DIMENSIONS, 12);
                let region = region.intersect(&palpate_volume::voxel_box::VoxelBox::new(
                    IVec3::ZERO,
                    DIMENSIONS.as_ivec3(),
                ));
                let solid = random.below(2) == 0;
                rig.simulation.fill_box(id, &region, solid).unwrap();
            }
        }
        for _ in 0..8 {
            device = device.lerp(random.point(0.0, 48.0), 0.05);
            let record = rig.tick_at(device);
            assert!(record.force.is_finite() && record.proxy.is_finite());
            assert_eq!(rig.violations(), 0, "round {round}");
        }
        rig.simulation.step();
    }
}
