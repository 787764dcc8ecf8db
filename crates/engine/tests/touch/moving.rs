//! Segments that are moved while they are touched, balls, and feels, through a whole session.

use std::sync::Arc;

use crate::common::*;
use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_engine::error::SessionError;
use palpate_engine::servo::{Channels, Mapping, ServoCommand, ServoLoop, ServoStart, Shared};
use palpate_engine::touch::{MovedPart, Part, Settings, TouchFeel, TouchFeels, Touchable};
use palpate_haptics::smooth::Smoothing;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::splat(48);
const START: DVec3 = DVec3::new(24.5, 24.5, 40.5);

#[test]
fn a_segment_that_is_moved_into_the_probe_pushes_it() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::new(10, 10, 4), IVec3::new(38, 38, 20));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    rig.ticks(ARRIVED, START);
    rig.simulation
        .move_segment(id, shifted(DVec3::Z * 26.0))
        .unwrap();
    let pushed = rig.ticks(SETTLED, START);
    // its upper side was at z = 20, and stands at 46 now
    assert!((pushed.proxy.z - 46.0).abs() < BEFORE_FACE, "{pushed:?}");
    assert!(pushed.contact && pushed.force.z > 0.0);
    assert_eq!(
        rig.simulation.segments()[0].pose,
        Some(shifted(DVec3::Z * 26.0))
    );
    assert_eq!(rig.status.read().touched, id.0);

    // taken back, it leaves the probe where the device is
    assert!(rig.simulation.undo().unwrap());
    let free = rig.ticks(SETTLED, START);
    assert!(!free.contact && free.proxy == START, "{free:?}");
    assert_eq!(free.force, DVec3::ZERO);
}

#[test]
fn poses_are_told_where_they_change_and_at_no_other_tick() {
    let part = Part {
        id: SegmentId(3),
        bits: floor_block().occupancy().clone(),
        moved: Some(MovedPart {
            own_grid: None,
            bounds: VoxelBox::of_dimensions(DIMENSIONS),
            pose: shifted(DVec3::X),
        }),
        threshold: None,
        fractions: None,
        punctured: false,
        rigid: None,
    };
    let Channels {
        servo, simulation, ..
    } = Channels::new(START);
    let start = ServoStart {
        grid: grid(DIMENSIONS),
        touchable: Touchable::new(&grid(DIMENSIONS), vec![part], 0.0).unwrap(),
        mapping: Mapping::IDENTITY,
        probe: START,
        settings: Settings::default(),
        feels: TouchFeels::default(),
    };
    let mut servo = ServoLoop::new(start, servo, Arc::new(Shared::default()));
    let (mut poses, mut inbox) = (simulation.poses, simulation.inbox);
    let mut told = |ticks: u32, servo: &mut ServoLoop| {
        let updates = (0..ticks).filter(|_| {
            servo.step(0.0);
            poses.update()
        });
        (updates.count(), poses.output_buffer()[0])
    };
    let [here, there] = [DVec3::X, DVec3::X * 3.0].map(|by| Some((3, shifted(by))));

    assert_eq!(
        told(1, &mut servo),
        (1, here),
        "where it stands at the start"
    );
    assert_eq!(told(50, &mut servo), (0, here), "at rest");
    let command = ServoCommand::Pose(SegmentId(3), shifted(DVec3::X * 3.0));
    inbox.push(command).unwrap();
    let (updates, last) = told(100, &mut servo);
    assert_eq!(last, there);
    // a step each tick, and at least so many of them that it does not jump
    assert!((10..100).contains(&updates), "{updates}");
    assert_eq!(told(50, &mut servo), (0, there), "at rest again");
}

#[test]
fn moves_of_one_drag_are_taken_back_at_once() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::splat(4), IVec3::splat(9));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    for step in 1..20 {
        let pose = shifted(DVec3::X * f64::from(step));
        rig.simulation.drag_segment(id, pose).unwrap();
    }
    rig.simulation
        .move_segment(id, shifted(DVec3::X * 20.0))
        .unwrap();
    assert!(rig.simulation.undo().unwrap());
    let pose = rig.simulation.segments()[0].pose;
    assert_eq!(pose, Some(DAffine3::IDENTITY));
    assert!(rig.simulation.redo().unwrap());
    let pose = rig.simulation.segments()[0].pose;
    assert_eq!(pose, Some(shifted(DVec3::X * 20.0)));
}

/// Two drags of one segment with nothing between them but that it was let go.
#[test]
fn each_drag_of_a_segment_is_a_step_of_its_own() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::splat(4), IVec3::splat(9));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    let pose_of = |rig: &Rig| rig.simulation.segments()[0].pose.unwrap();
    for end in [10.0, 20.0, 30.0] {
        for back in [5.0, 3.0, 1.0] {
            let pose = shifted(DVec3::X * (end - back));
            rig.simulation.drag_segment(id, pose).unwrap();
        }
        rig.simulation
            .move_segment(id, shifted(DVec3::X * end))
            .unwrap();
    }
    for end in [20.0, 10.0, 0.0] {
        assert!(rig.simulation.undo().unwrap());
        assert_eq!(pose_of(&rig), shifted(DVec3::X * end));
    }
    // an undo in the middle of a drag ends it
    rig.simulation
        .drag_segment(id, shifted(DVec3::X * 4.0))
        .unwrap();
    assert!(rig.simulation.undo().unwrap());
    rig.simulation
        .drag_segment(id, shifted(DVec3::X * 7.0))
        .unwrap();
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(pose_of(&rig), shifted(DVec3::ZERO));
}

#[test]
fn a_probe_pinched_between_two_stops_the_moving_one_until_it_is_out() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let lid = box_segment(DIMENSIONS, IVec3::new(0, 0, 44), IVec3::new(48, 48, 48));
    let block = box_segment(DIMENSIONS, IVec3::new(10, 10, 4), IVec3::new(38, 38, 20));
    rig.simulation.add_segment(lid, OBSTACLE, true).unwrap();
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    rig.ticks(ARRIVED, START);
    rig.simulation
        .move_segment(id, shifted(DVec3::Z * 26.0))
        .unwrap();
    let pinched = rig.ticks(SETTLED, START);
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
        rig.ticks(1, device);
    }
    rig.ticks(SETTLED, aside);
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
fn a_segment_with_a_stiffness_of_its_own_is_felt_so() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let floor = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(48, 48, 20));
    let id = rig.simulation.add_segment(floor, OBSTACLE, true).unwrap();
    let soft = TouchFeel {
        stiffness: Some(0.25),
        ..TouchFeel::default()
    };
    rig.simulation.set_feel(id, soft).unwrap();
    let device = DVec3::new(24.5, 24.5, 18.0);
    // a feel that is set anew comes to a hand at rest within 256 ticks
    let pressed = rig.ticks(3 * SETTLED, device);
    // the smooth surface of a flat floor is the floor, to 0.1 %
    assert!((pressed.force.z - 0.25 * 2.0).abs() < 0.01, "{pressed:?}");
    assert_eq!(rig.status.read().touched, id.0);
}

/// A block, a floor for a probe above it, at another place.
const MOVE: DVec3 = DVec3::new(0.0, 0.0, 14.0);

/// Where the probe rests on the block of these tests, whose upper side is at z = 20 in the scan.
fn resting(rig: &mut Rig, on: f64) -> f64 {
    rig.ticks(SETTLED, START);
    let pressed = rig.ticks(SETTLED, DVec3::new(START.x, START.y, on - 2.0));
    assert!(pressed.contact, "{pressed:?}");
    pressed.proxy.z
}

fn floor_block() -> Segment {
    box_segment(DIMENSIONS, IVec3::new(10, 10, 4), IVec3::new(38, 38, 20))
}

/// More segments are moved and removed, one after the other, than can be moved at once.
#[test]
fn segments_that_are_gone_leave_their_place_to_others_that_are_moved() {
    let mut rig = Rig::new(DIMENSIONS, START);
    for round in 0..20 {
        let id = rig.simulation.add_segment(floor_block(), OBSTACLE, true);
        let id = id.unwrap();
        rig.simulation.move_segment(id, shifted(MOVE)).unwrap();
        let rests = resting(&mut rig, 34.0);
        assert!((rests - 34.0).abs() < BEFORE_FACE, "round {round}: {rests}");
        rig.ticks(ARRIVED, START);
        rig.simulation.remove_segment(id).unwrap();
    }
}

#[test]
fn a_segment_that_is_moved_while_it_is_no_obstacle_stands_there_once_it_is_one() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let id = rig
        .simulation
        .add_segment(floor_block(), OBSTACLE, true)
        .unwrap();
    assert!((resting(&mut rig, 20.0) - 20.0).abs() < BEFORE_FACE);

    // its first move
    rig.ticks(ARRIVED, START);
    rig.simulation.set_touchable(id, false).unwrap();
    rig.simulation.move_segment(id, shifted(MOVE)).unwrap();
    rig.simulation.set_touchable(id, true).unwrap();
    assert!((resting(&mut rig, 34.0) - 34.0).abs() < BEFORE_FACE);

    // a further one, with ticks between
    rig.ticks(ARRIVED, START);
    rig.simulation.set_touchable(id, false).unwrap();
    rig.ticks(ARRIVED, START);
    rig.simulation
        .move_segment(id, shifted(MOVE * 0.5))
        .unwrap();
    rig.ticks(ARRIVED, START);
    rig.simulation.set_touchable(id, true).unwrap();
    assert!((resting(&mut rig, 27.0) - 27.0).abs() < BEFORE_FACE);

    // none, but it is made an obstacle anew
    rig.ticks(ARRIVED, START);
    for touchable in [false, true] {
        rig.simulation.set_touchable(id, touchable).unwrap();
        rig.ticks(ARRIVED, START);
    }
    assert!((resting(&mut rig, 27.0) - 27.0).abs() < BEFORE_FACE);
}

/// Removed and brought back by undo it stands where it was moved to.
#[test]
fn a_moved_segment_that_undo_brings_back_stands_where_it_stood() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let id = rig
        .simulation
        .add_segment(floor_block(), OBSTACLE, true)
        .unwrap();
    rig.simulation.move_segment(id, shifted(MOVE)).unwrap();
    rig.ticks(SETTLED, START);
    rig.simulation.remove_segment(id).unwrap();
    let free = rig.ticks(SETTLED, DVec3::new(START.x, START.y, 18.0));
    assert!(!free.contact);
    rig.ticks(SETTLED, START);
    assert!(rig.simulation.undo().unwrap());
    assert!((resting(&mut rig, 34.0) - 34.0).abs() < BEFORE_FACE);
}

/// A segment that waits for the probe can be led away from it, and then it comes.
#[test]
fn a_moved_segment_that_is_held_back_can_be_led_away() {
    let inside = DVec3::new(24.5, 24.5, 26.5);
    let mut rig = Rig::new(DIMENSIONS, START);
    let id = rig
        .simulation
        .add_segment(floor_block(), OBSTACLE, true)
        .unwrap();
    rig.simulation.move_segment(id, shifted(MOVE)).unwrap();
    rig.ticks(SETTLED, START);
    rig.simulation.set_touchable(id, false).unwrap();
    rig.ticks(SETTLED, inside);
    rig.simulation.set_touchable(id, true).unwrap();
    let buried = rig.ticks(SETTLED, inside);
    assert!(!buried.contact && rig.simulation.segments()[0].pending);

    rig.simulation
        .move_segment(id, shifted(DVec3::X * 40.0))
        .unwrap();
    let free = rig.ticks(SETTLED, inside);
    assert!(!free.contact && !rig.simulation.segments()[0].pending);
    // it is where it was led to: x from 50 on
    let aside = DVec3::new(49.0, 24.5, 10.0);
    rig.ticks(SETTLED, aside);
    let pressed = rig.ticks(SETTLED, aside + DVec3::X * 3.0);
    assert!((pressed.proxy.x - 50.0).abs() < BEFORE_FACE, "{pressed:?}");
}

/// A segment that is moved for the first time leaves from where the scan has it.
#[test]
fn the_first_move_of_a_segment_pushes_the_probe_step_by_step() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = floor_block();
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    let near = DVec3::new(START.x, START.y, 20.5);
    rig.ticks(ARRIVED, near);
    rig.simulation
        .move_segment(id, shifted(DVec3::Z * 26.0))
        .unwrap();
    let mut before = near.z;
    for _ in 0..40 {
        let at = rig.tick_at(near).proxy.z;
        // 26 mm in no less than 17 ticks
        assert!(
            at - before < 26.0 / 17.0 + BEFORE_FACE,
            "from {before} to {at}"
        );
        before = at;
    }
    assert!((before - 46.0).abs() < BEFORE_FACE, "{before}");
}

/// Undo takes moves back to the scan, and then brings a moved segment back: all that stand
/// elsewhere are touched there, and are never more than can be.
#[test]
fn no_more_segments_are_moved_than_can_be_touched_also_not_by_undo() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let add = |rig: &mut Rig| {
        rig.simulation
            .add_segment(floor_block(), OBSTACLE, true)
            .unwrap()
    };
    let ids: Vec<_> = (0..17).map(|_| add(&mut rig)).collect();
    for (id, shift) in ids.iter().zip(1..17) {
        let pose = shifted(DVec3::X * 0.1 * f64::from(shift));
        rig.simulation.move_segment(*id, pose).unwrap();
    }
    rig.simulation.move_segment(ids[0], shifted(MOVE)).unwrap();
    let refused = rig.simulation.move_segment(ids[16], shifted(MOVE));
    assert!(matches!(refused, Err(SessionError::TooManyMoved)));

    rig.simulation.remove_segment(ids[0]).unwrap();
    rig.simulation.move_segment(ids[16], shifted(MOVE)).unwrap();
    let newest = add(&mut rig);
    let refused = rig.simulation.move_segment(newest, shifted(MOVE));
    assert!(matches!(refused, Err(SessionError::TooManyMoved)));
    // the segment just added, the move, the removal
    for _ in 0..3 {
        assert!(rig.simulation.undo().unwrap());
    }
    let segments = rig.simulation.segments();
    let bodies = segments.iter().filter(|segment| segment.pose.is_some());
    assert_eq!(bodies.count(), 16);
    assert!((resting(&mut rig, 34.0) - 34.0).abs() < BEFORE_FACE);
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
