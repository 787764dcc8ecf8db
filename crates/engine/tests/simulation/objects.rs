//! Segments in the hand, and segments that are parted, through servo and simulation.

use crate::common::{OBSTACLE, Random, Rig, box_segment, sponge};
use glam::{DAffine3, DQuat, DVec3, IVec3, UVec3};
use palpate_engine::error::SessionError;
use palpate_engine::scene::Plane;
use palpate_engine::simulation::surface_voxels;
use palpate_volume::edit::SegmentId;

const DIMENSIONS: UVec3 = UVec3::splat(48);
const START: DVec3 = DVec3::new(24.5, 24.5, 30.5);
/// Ticks after which everything that was told has arrived, passes of the simulation among them.
const ARRIVED: u32 = 40;
/// Coordinates of some ten mm, added up over a few hundred passes.
const ROUNDING: f64 = 1e-9;

/// Ticks with the simulation between them, as a session has it.
fn ticks(rig: &mut Rig, count: u32, device: DVec3) {
    for tick in 0..count {
        rig.tick_at(device);
        if tick % 10 == 0 {
            rig.simulation.step();
        }
        assert_eq!(rig.violations(), 0);
    }
    rig.simulation.step();
}

/// A way of the device, slowly enough for the probe to be with it in every pass.
fn travel(rig: &mut Rig, from: DVec3, to: DVec3) {
    for share in 1..=20 {
        ticks(rig, 10, from.lerp(to, f64::from(share) / 20.0));
    }
    ticks(rig, ARRIVED, to);
}

fn pose_of(rig: &Rig, id: SegmentId) -> DAffine3 {
    let segments = rig.simulation.segments();
    let segment = segments.iter().find(|segment| segment.id == id).unwrap();
    segment.pose.unwrap_or_default()
}

#[test]
fn a_segment_in_the_hand_follows_the_probe_and_lets_it_through() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::new(16, 16, 8), IVec3::new(32, 32, 24));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    ticks(&mut rig, ARRIVED, START);

    rig.simulation.grab(Some(id), false).unwrap();
    ticks(&mut rig, ARRIVED, START);
    assert_eq!(rig.status.read().grabbed, id.0);
    assert_eq!(pose_of(&rig, id), DAffine3::IDENTITY, "nothing has moved");
    // through where it was: it goes along instead of stopping the probe
    let to = DVec3::new(20.0, 30.5, 12.5);
    travel(&mut rig, START, to);
    let moved = pose_of(&rig, id);
    assert!(moved.translation.distance(to - START) < ROUNDING, "{moved}");
    let shown = rig.status.read().poses[0];
    assert_eq!(shown, Some((id.0, moved)));

    // let go, it stops the probe again where it stands now
    rig.simulation.grab(None, false).unwrap();
    ticks(&mut rig, ARRIVED, to);
    let below = to - DVec3::Z * 10.0;
    travel(&mut rig, to, below);
    let probe = rig.tick_at(below).proxy;
    // its upper side was at 24, the probe was 6.5 above it and still is
    assert!((probe.z - (to.z - 6.5)).abs() < 1e-6, "{probe}");

    // the whole way is one step back
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(pose_of(&rig, id), DAffine3::IDENTITY);
}

#[test]
fn the_probe_in_a_segment_that_is_let_go_keeps_it_pending_until_it_is_out() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::new(8, 8, 8), IVec3::new(40, 40, 24));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    rig.simulation.grab(Some(id), false).unwrap();
    rig.simulation.grab(None, false).unwrap();
    rig.simulation.grab(Some(id), false).unwrap();
    ticks(&mut rig, ARRIVED, START);
    // moved over the probe by its own number, while it is no obstacle
    rig.simulation.move_segment(id, DAffine3::IDENTITY).unwrap();
    rig.simulation.set_touchable(id, false).unwrap();
    ticks(&mut rig, ARRIVED, START);
    let inside = DVec3::new(24.5, 24.5, 16.5);
    travel(&mut rig, START, inside);
    rig.simulation.grab(Some(id), false).unwrap();
    rig.simulation.set_touchable(id, true).unwrap();
    ticks(&mut rig, ARRIVED, inside);
    rig.simulation.grab(None, false).unwrap();
    ticks(&mut rig, ARRIVED, inside);
    assert!(rig.simulation.segments()[0].pending);
    travel(&mut rig, inside, START);
    assert!(!rig.simulation.segments()[0].pending);
}

#[test]
fn keys_turn_a_segment_in_the_hand_about_the_probe() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::new(16, 16, 8), IVec3::new(32, 32, 24));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    rig.simulation.grab(Some(id), false).unwrap();
    ticks(&mut rig, ARRIVED, START);
    rig.simulation.turn_grabbed(DVec3::Z * 0.25);
    rig.simulation.turn_grabbed(DVec3::Z * 0.25);
    ticks(&mut rig, ARRIVED, START);
    let wanted = DAffine3::from_translation(START)
        * DAffine3::from_quat(DQuat::from_rotation_z(0.5))
        * DAffine3::from_translation(-START);
    let pose = pose_of(&rig, id);
    assert!(pose.abs_diff_eq(wanted, ROUNDING), "{pose}");
}

#[test]
fn a_turn_that_is_no_number_moves_nothing() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::new(16, 16, 8), IVec3::new(32, 32, 24));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    rig.simulation.grab(Some(id), false).unwrap();
    rig.simulation.turn_grabbed(DVec3::NAN);
    ticks(&mut rig, ARRIVED, START);
    assert_eq!(pose_of(&rig, id), DAffine3::IDENTITY);
}

#[test]
fn a_colliding_segment_in_the_hand_stops_at_another_one() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::new(20, 20, 16), IVec3::new(28, 28, 24));
    // a probe beside the floor that the block comes down on
    let floor = box_segment(DIMENSIONS, IVec3::new(0, 0, 4), IVec3::new(29, 48, 8));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    rig.simulation.add_segment(floor, OBSTACLE, true).unwrap();
    let start = DVec3::new(34.5, 24.5, 20.5);
    travel(&mut rig, START, start);
    rig.simulation.grab(Some(id), true).unwrap();
    ticks(&mut rig, ARRIVED, start);
    let deep = start - DVec3::Z * 14.0;
    travel(&mut rig, start, deep);
    // its lowest voxels' middles at 16.5 stay above the floor's upper side at 8
    let down = pose_of(&rig, id).translation;
    assert!(down.z >= -8.5 && down.z < -7.0, "{down}");
    // along the floor it slides, and up again it comes with the hand
    let aside = deep + DVec3::Y * 5.0;
    travel(&mut rig, deep, aside);
    let slid = pose_of(&rig, id).translation;
    assert!((slid.y - 5.0).abs() < ROUNDING && slid.z < -7.0, "{slid}");
    travel(&mut rig, aside, start);
    assert!(pose_of(&rig, id).translation.length() < ROUNDING);
}

#[test]
fn two_that_overlap_can_be_parted() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let block = box_segment(DIMENSIONS, IVec3::new(10, 10, 10), IVec3::new(20, 20, 20));
    let other = box_segment(DIMENSIONS, IVec3::new(14, 10, 10), IVec3::new(24, 20, 20));
    let id = rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    rig.simulation.add_segment(other, OBSTACLE, true).unwrap();
    ticks(&mut rig, ARRIVED, START);
    rig.simulation.grab(Some(id), true).unwrap();
    ticks(&mut rig, ARRIVED, START);
    let away = START - DVec3::X * 12.0;
    travel(&mut rig, START, away);
    let moved = pose_of(&rig, id).translation;
    assert!(moved.distance(away - START) < ROUNDING, "{moved}");
}

#[test]
fn a_cut_parts_the_voxels_and_is_one_step_back() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let whole = sponge(DIMENSIONS, 7, 3);
    let voxels = whole.count();
    let id = rig
        .simulation
        .add_segment(whole.clone(), OBSTACLE, true)
        .unwrap();
    let grid = *rig.simulation.voxels().grid();
    let mut random = Random::new(5);
    let mut direction = || DVec3::from_array(std::array::from_fn(|_| random.between(-1.0, 1.0)));
    let plane = Plane::in_scan(DVec3::splat(24.0), direction(), &DAffine3::IDENTITY).unwrap();
    let parts = plane.part(&whole, &grid);
    let new = rig.simulation.part_segment(id, parts).unwrap();
    let segments = rig.simulation.segments();
    let counts: Vec<u64> = segments.iter().map(|segment| segment.voxels).collect();
    assert_eq!(counts.iter().sum::<u64>(), voxels);
    assert!(counts.iter().all(|count| *count > voxels / 4), "{counts:?}");
    let held = |id| rig.simulation.voxels().segment(id).unwrap().clone();
    for voxel in whole.bounding_box().unwrap().voxels() {
        let offset = voxel.as_dvec3() + 0.5 - plane.point;
        let before = offset.dot(plane.normal);
        // a middle on the plane, to rounding, may be on either side
        if whole.contains(voxel) && before.abs() > ROUNDING {
            assert_eq!(held(new).contains(voxel), before > 0.0, "{voxel}");
            assert_eq!(held(id).contains(voxel), before < 0.0, "{voxel}");
        }
    }
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(rig.simulation.segments().len(), 1);
    assert_eq!(rig.simulation.segments()[0].voxels, voxels);
    assert!(rig.simulation.redo().unwrap());
    assert_eq!(rig.simulation.segments().len(), 2);
}

#[test]
fn a_cut_of_a_moved_segment_parts_it_where_it_stands() {
    let pose = DAffine3::from_translation(DVec3::X * 100.0)
        * DAffine3::from_quat(DQuat::from_rotation_z(1.0));
    let point = DVec3::new(112.0, 3.0, 4.0);
    let plane = Plane::in_scan(point, DVec3::Y * 1e-200, &pose).unwrap();
    assert!(pose.transform_point3(plane.point).distance(point) < ROUNDING);
    assert!(pose.transform_vector3(plane.normal).distance(DVec3::Y) < ROUNDING);
    for normal in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
        assert!(Plane::in_scan(point, normal, &pose).is_none(), "{normal}");
    }
}

#[test]
fn what_is_not_there_cannot_be_grabbed() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let refused = rig.simulation.grab(Some(SegmentId(9)), false);
    assert!(matches!(refused, Err(SessionError::Voxels(_))));
    // letting go of nothing is nothing
    rig.simulation.grab(None, false).unwrap();
}

#[test]
fn surface_voxels_are_those_with_a_free_neighbour() {
    let segment = sponge(UVec3::new(20, 17, 9), 3, 2);
    let free = |voxel: IVec3| !segment.contains(voxel);
    let mut expected: Vec<[i32; 3]> = segment
        .bounding_box()
        .unwrap()
        .voxels()
        .filter(|voxel| segment.contains(*voxel))
        .filter(|voxel| {
            [IVec3::X, IVec3::Y, IVec3::Z]
                .into_iter()
                .any(|side| free(voxel + side) || free(voxel - side))
        })
        .map(|voxel| voxel.to_array())
        .collect();
    let mut found: Vec<[i32; 3]> = surface_voxels(segment.occupancy())
        .into_iter()
        .map(|voxel| voxel.to_array())
        .collect();
    expected.sort_unstable();
    found.sort_unstable();
    assert_eq!(found, expected);
}
