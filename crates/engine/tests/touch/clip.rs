//! What a clip cuts away is not felt nor changed, and what comes back leaves the probe free.

use crate::common::*;
use crate::deformable::soft_block::{go, lattice_rig};
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::session::Reference;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_volume::clip::{Clip, Plane};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::splat(40);
const BLOCK: SegmentId = SegmentId(1);
/// Upper end of the block [mm].
const TOP: f64 = 20.0;
const ABOVE: DVec3 = DVec3::new(20.3, 20.4, 26.0);

/// A block below its top, and the probe above it.
fn rig() -> Rig {
    let mut rig = Rig::new(DIMENSIONS, ABOVE);
    let block = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(40, 40, TOP as i32));
    rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    rig.ticks(ARRIVED, ABOVE);
    rig
}

/// Cuts away what is higher [mm].
fn below(height: f64) -> Clip {
    let plane = Plane {
        normal: DVec3::Z,
        offset: height,
    };
    Clip::new(vec![plane]).unwrap()
}

/// Goes straight down to a height; gives where the proxy stands then.
fn sink(rig: &mut Rig, height: f64) -> DVec3 {
    let steps = 200;
    for step in 0..=steps {
        let share = f64::from(step) / f64::from(steps);
        let z = ABOVE.z + share * (height - ABOVE.z);
        rig.ticks(1, ABOVE.with_z(z));
    }
    rig.ticks(SETTLED, ABOVE.with_z(height)).proxy
}

#[test]
fn what_is_cut_away_is_passed_freely_and_the_cut_is_felt_where_it_is_seen() {
    let mut rig = rig();
    let (before, edits) = (rig.simulation.voxels().clone(), rig.simulation.undo_bytes());
    rig.simulation.set_clip(below(15.0));
    rig.ticks(ARRIVED, ABOVE);
    for (height, reached) in [(16.0, 16.0), (12.0, 15.0)] {
        let proxy = sink(&mut rig, height);
        assert!((proxy.z - reached).abs() < BEFORE_FACE, "{proxy}");
    }
    // a plane through the middles of voxels leaves these
    rig.simulation.set_clip(below(13.5));
    let deeper = rig.ticks(SETTLED, ABOVE.with_z(12.0));
    assert!(
        (deeper.proxy.z - 14.0).abs() < BEFORE_FACE,
        "{}",
        deeper.proxy
    );
    rig.simulation.set_clip(Clip::default());
    rig.ticks(SETTLED, ABOVE);
    let proxy = sink(&mut rig, 12.0);
    assert!((proxy.z - TOP).abs() < BEFORE_FACE, "{proxy}");

    // the scan and its segments know nothing of it
    let now = rig.simulation.voxels();
    assert_eq!(now.edit_number(), before.edit_number());
    let masks = [now, &before].map(|voxels| voxels.segment(BLOCK).unwrap().mask());
    assert_eq!(masks[0], masks[1]);
    assert_eq!(rig.simulation.undo_bytes(), edits);
}

#[test]
fn to_cut_away_what_is_pressed_ends_the_contact_and_to_bring_it_back_leaves_no_step_in_the_force() {
    let mut rig = rig();
    sink(&mut rig, 17.0);
    let pressed = rig.ticks(1, ABOVE.with_z(17.0));
    assert!(pressed.contact && pressed.force.z > 0.5, "{pressed:?}");
    rig.simulation.set_clip(below(15.0));
    let free = rig.ticks(SETTLED, ABOVE.with_z(17.0));
    assert!(!free.contact && free.force == DVec3::ZERO, "{free:?}");
    assert!((free.proxy.z - 17.0).abs() < BEFORE_FACE);

    // 3 mm in what comes back it is pushed out, and the force rises by a tenth of a voxel a tick
    rig.simulation.set_clip(Clip::default());
    let mut before = 0.0;
    for _ in 0..60 {
        let record = rig.ticks(1, ABOVE.with_z(17.0));
        assert!(record.depth - before <= 0.1 + 1e-9, "{record:?}");
        before = record.depth;
    }
    assert!((before - 3.0).abs() < 1e-6, "{before}");
}

#[test]
fn what_would_bury_the_probe_waits_until_it_has_left() {
    let mut rig = rig();
    rig.simulation.set_clip(below(2.0));
    sink(&mut rig, 6.0);
    rig.simulation.set_clip(Clip::default());
    let inside = rig.ticks(SETTLED, ABOVE.with_z(6.0));
    assert!(!inside.contact && rig.status.read().pending == 1);
    // it goes out through what is to be solid; then that is
    rig.ticks(ARRIVED, ABOVE);
    rig.simulation.step();
    assert_eq!(rig.status.read().pending, 0);
    assert!((sink(&mut rig, 6.0).z - TOP).abs() < BEFORE_FACE);
}

#[test]
fn a_moved_segment_is_cut_where_it_stands_and_edits_are_cut_too() {
    let mut rig = rig();
    rig.simulation.set_clip(below(15.0));
    // from below the plane the block comes up through it
    for (by, reached) in [(-10.0, 10.0), (-3.0, 15.0), (4.0, 15.0)] {
        rig.ticks(SETTLED, ABOVE);
        let pose = shifted(DVec3::Z * by);
        rig.simulation.move_segment(BLOCK, pose).unwrap();
        rig.ticks(SETTLED, ABOVE);
        let proxy = sink(&mut rig, 8.0);
        assert!((proxy.z - reached).abs() < 1e-3, "{by} {proxy}");
    }
    let mut rig = self::rig();
    rig.simulation.set_clip(below(25.0));
    let tower = VoxelBox::new(IVec3::new(18, 18, 20), IVec3::new(23, 23, 36));
    rig.ticks(ARRIVED, ABOVE.with_z(37.0));
    rig.simulation.fill_box(BLOCK, &tower, true).unwrap();
    rig.ticks(ARRIVED, ABOVE.with_z(37.0));
    let proxy = sink(&mut rig, 22.0);
    assert!((proxy.z - 25.0).abs() < BEFORE_FACE, "{proxy}");
    let segment = rig.simulation.voxels().segment(BLOCK).unwrap();
    assert!(segment.contains(IVec3::new(20, 20, 35)));
}

#[test]
fn tools_leave_what_is_cut_away_as_it_is() {
    for kind in [ToolKind::Drill, ToolKind::Eraser, ToolKind::Adder] {
        let mut rig = rig();
        rig.simulation.set_clip(below(15.0));
        let whole = rig.simulation.voxels().clone();
        if kind == ToolKind::Adder {
            // it fills at once what is no obstacle
            rig.simulation.set_touchable(BLOCK, false).unwrap();
            let hole = VoxelBox::new(IVec3::splat(14), IVec3::new(27, 27, 20));
            rig.simulation.fill_box(BLOCK, &hole, false).unwrap();
        }
        let holed = rig.simulation.voxels().clone();
        let tool = ToolSettings::new(kind, 3.0, vec![BLOCK]);
        rig.simulation.set_tool(Some(tool)).unwrap();
        rig.simulation.stroke(true).unwrap();
        // a drill is pressed against what is there
        let z = if kind == ToolKind::Drill { 10.0 } else { 14.0 };
        for _ in 0..40 {
            rig.pass(ABOVE.with_z(z), 5.0);
        }
        rig.simulation.stroke(false).unwrap();
        let now = rig.simulation.voxels();
        let has = |voxels: &palpate_volume::voxels::Voxels, voxel| {
            voxels.segment(BLOCK).unwrap().contains(voxel)
        };
        let mut changed = 0;
        for voxel in whole.grid().bounds().voxels() {
            let is_other = has(now, voxel) != has(&holed, voxel);
            assert!(!is_other || voxel.z < 15, "{kind:?} {voxel}");
            assert!(voxel.z < 15 || now.stored(voxel) == whole.stored(voxel));
            changed += u32::from(is_other);
        }
        assert!(changed > 20, "{kind:?} {changed}");
        assert_eq!(rig.violations(), 0);
    }
}

#[test]
fn soft_tissue_gives_way_at_the_cut_and_not_before() {
    let mut rig = lattice_rig();
    rig.simulation.set_clip(below(14.0));
    // the ball has 3 mm, and the block had its top at 20 mm
    let before = go(&mut rig, 30.0, 17.6, 2000);
    assert_eq!(before.force, DVec3::ZERO);
    assert_eq!(rig.simulation.deformation().force, DVec3::ZERO);
    go(&mut rig, 17.6, 16.0, 500);
    let pressed = go(&mut rig, 16.0, 16.0, 300);
    assert!(rig.simulation.deformation().force.z > 0.01 && pressed.force.z > 0.01);
    assert_eq!(rig.violations(), 0);
}

#[test]
fn a_hand_that_presses_comes_down_on_the_cut() {
    let dimensions = UVec3::splat(70);
    let centre = DVec3::splat(35.0);
    let ball = Segment::from_fn(dimensions, |voxel| {
        (voxel.as_dvec3() + 0.5).distance(centre) < 20.0
    });
    let session = started(offline(dimensions, ball, simulated(), Reference::View));
    let front = Plane {
        normal: -DVec3::Y,
        offset: -30.0,
    };
    session.set_clip(vec![front]).unwrap();
    session
        .press(DVec3::new(35.0, -300.0, 35.0), DVec3::Y, 1.0)
        .unwrap();
    session.run(2.0).unwrap();
    let frame = session.frame();
    assert!(
        frame.contact && (frame.proxy.y - 30.0).abs() < 0.1,
        "{}",
        frame.proxy
    );
    assert!((frame.force.length() - 1.0).abs() < 0.1, "{}", frame.force);
    session.set_clip(Vec::new()).unwrap();
    session.lift().unwrap();
    session.run(0.5).unwrap();
    session
        .press(DVec3::new(35.0, -300.0, 35.0), DVec3::Y, 1.0)
        .unwrap();
    session.run(3.0).unwrap();
    let proxy = session.frame().proxy;
    assert!((proxy.y - 15.0).abs() < 0.6, "{proxy}");
    assert_eq!(session.clip().unwrap(), Vec::new());
    let slanted = Plane {
        normal: DVec3::ONE,
        offset: 0.0,
    };
    assert!(session.set_clip(vec![slanted]).is_err());
}
