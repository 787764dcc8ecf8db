//! A session's journal on disk: what a crash leaves is done again, undo included.

use std::fs;

use crate::common::*;
use crate::place::Place;
use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_engine::scene::Plane;
use palpate_engine::simulation::SegmentState;
use palpate_engine::touch::TouchFeel;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::journal::ScanHash;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::splat(32);
const HASH: ScanHash = ScanHash([3; 32]);
const BLOCK: SegmentId = SegmentId(1);

/// A block, the probe above it.
fn rig() -> Rig {
    let mut rig = Rig::new(DIMENSIONS, DVec3::new(16.0, 16.0, 26.0));
    let block = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(32, 32, 20));
    rig.simulation.add_segment(block, OBSTACLE, false).unwrap();
    rig
}

fn masks(rig: &Rig) -> Vec<(SegmentId, Vec<u8>)> {
    let voxels = rig.simulation.voxels();
    voxels
        .segments()
        .map(|(id, segment)| (id, segment.mask()))
        .collect()
}

fn stroke(rig: &mut Rig, from: DVec3, to: DVec3) {
    rig.simulation
        .set_tool(Some(ToolSettings::new(ToolKind::Eraser, 2.0, vec![BLOCK])))
        .unwrap();
    rig.simulation.stroke(true).unwrap();
    for step in 0..=10 {
        rig.tick_at(from.lerp(to, f64::from(step) / 10.0));
        rig.simulation.step();
    }
    rig.simulation.stroke(false).unwrap();
}

#[test]
fn after_a_crash_voxels_and_steps_are_those_of_before() {
    let place = Place::new("steps");
    let mut rig = rig_with_journal(&place);
    let mut states = vec![masks(&rig)];
    stroke(
        &mut rig,
        DVec3::new(5.0, 10.0, 20.5),
        DVec3::new(25.0, 10.0, 20.5),
    );
    states.push(masks(&rig));
    let other = rig
        .simulation
        .add_segment(sponge(DIMENSIONS, 1, 3), OBSTACLE, true)
        .unwrap();
    states.push(masks(&rig));
    let region = VoxelBox::new(IVec3::splat(1), IVec3::splat(9));
    rig.simulation.fill_box(other, &region, true).unwrap();
    states.push(masks(&rig));
    rig.simulation
        .replace_segment(other, sponge(DIMENSIONS, 2, 5), None)
        .unwrap();
    states.push(masks(&rig));
    rig.simulation.remove_segment(BLOCK).unwrap();
    rig.simulation.note_in_journal(b"colour".to_vec());
    for _ in 0..3 {
        rig.simulation.undo().unwrap();
    }
    rig.simulation.redo().unwrap();
    assert!(masks(&rig) == states[3]);
    drop(rig);

    let mut rig = rig_of_scan();
    let recovered = rig.simulation.recover_journal(&place.0, HASH).unwrap();
    assert_eq!((recovered.steps, recovered.ignored_bytes), (9, 0));
    assert_eq!(recovered.notes, [b"colour".to_vec()]);
    assert!(masks(&rig) == states[3]);
    // forward, then all the way back, as before the crash
    assert!(rig.simulation.redo().unwrap());
    assert!(masks(&rig) == states[4]);
    for state in states.iter().rev().skip(1) {
        assert!(rig.simulation.undo().unwrap());
        assert!(masks(&rig) == *state);
    }
    assert!(!rig.simulation.undo().unwrap());
    // and the journal went on
    let now = masks(&rig);
    drop(rig);
    let mut again = rig_of_scan();
    again.simulation.recover_journal(&place.0, HASH).unwrap();
    assert!(masks(&again) == now);
}

fn rig_with_journal(place: &Place) -> Rig {
    let mut rig = rig();
    rig.simulation.begin_journal(&place.0, HASH).unwrap();
    rig
}

/// The next start: the scan, and no segments.
fn rig_of_scan() -> Rig {
    Rig::new(DIMENSIONS, DVec3::new(16.0, 16.0, 26.0))
}

#[test]
fn a_stroke_that_was_not_finished_comes_back_as_a_step() {
    let place = Place::new("open");
    let mut rig = rig_with_journal(&place);
    let before = masks(&rig);
    stroke(
        &mut rig,
        DVec3::new(5.0, 10.0, 20.5),
        DVec3::new(25.0, 10.0, 20.5),
    );
    let after = masks(&rig);
    drop(rig);
    // the end of the step was not written yet: a length, a checksum and a kind
    let bytes = fs::read(&place.0).unwrap();
    fs::write(&place.0, &bytes[..bytes.len() - 9]).unwrap();

    let mut rig = rig_of_scan();
    let recovered = rig.simulation.recover_journal(&place.0, HASH).unwrap();
    assert_eq!((recovered.steps, recovered.ignored_bytes), (1, 0));
    assert!(masks(&rig) == after);
    assert!(rig.simulation.undo().unwrap());
    assert!(masks(&rig) == before);
}

#[test]
fn what_is_there_is_kept_in_a_file_while_the_journal_goes_on() {
    let [journal, kept] = [Place::new("goes_on"), Place::new("kept")];
    let mut rig = rig_with_journal(&journal);
    let ends = [DVec3::new(5.0, 10.0, 20.5), DVec3::new(25.0, 10.0, 20.5)];
    stroke(&mut rig, ends[0], ends[1]);
    let then = masks(&rig);
    rig.simulation.keep_state(&kept.0, HASH).unwrap();
    let error = rig.simulation.keep_state(&kept.0, HASH);
    assert!(error.unwrap_err().to_string().contains("exists already"));
    stroke(&mut rig, ends[0] + 6.0 * DVec3::Y, ends[1] + 6.0 * DVec3::Y);
    let later = masks(&rig);
    assert!(later != then);
    drop(rig);

    let mut rig = rig_of_scan();
    let recovered = rig.simulation.recover_journal(&kept.0, HASH).unwrap();
    assert_eq!((recovered.steps, recovered.ignored_bytes), (0, 0));
    assert!(masks(&rig) == then);
    assert!(!rig.simulation.undo().unwrap());
    let mut rig = rig_of_scan();
    let recovered = rig.simulation.recover_journal(&journal.0, HASH).unwrap();
    assert_eq!((recovered.steps, recovered.ignored_bytes), (2, 0));
    assert!(masks(&rig) == later);
}

#[test]
fn the_journal_of_another_scan_changes_nothing() {
    let place = Place::new("other");
    drop(rig_with_journal(&place));
    let mut rig = rig_of_scan();
    let error = rig.simulation.recover_journal(&place.0, ScanHash([4; 32]));
    assert!(error.unwrap_err().to_string().contains("another scan"));
    assert!(masks(&rig).is_empty());
    let error = rig.simulation.begin_journal(&place.0, HASH);
    assert!(error.unwrap_err().to_string().contains("exists already"));
}

/// What is known of all segments: numbers, voxels, touchability, ranges, feel, poses, grids.
fn states(rig: &Rig) -> Vec<String> {
    let states = rig.simulation.segments().into_iter();
    states
        .map(|state| {
            let SegmentState {
                id,
                voxels,
                touchable,
                range,
                feel,
                pose,
                own_grid,
                ..
            } = state;
            // where nothing was moved yet there is no pose
            let pose = pose.unwrap_or_default();
            format!("{id:?} {voxels} {touchable} {range:?} {feel:?} {pose:?} {own_grid:?}")
        })
        .collect()
}

#[test]
fn poses_feel_and_what_can_be_touched_come_back_with_their_steps() {
    let place = Place::new("objects");
    let mut rig = rig_with_journal(&place);
    let feel = TouchFeel {
        stiffness: Some(0.4),
        friction_static: Some(0.3),
        friction_kinetic: Some(0.2),
    };
    let spacing = DVec3::splat(0.25);
    let own = Grid::new(
        UVec3::splat(12),
        spacing,
        DVec3::splat(8.0),
        DMat3::IDENTITY,
    )
    .unwrap();
    let plate = Segment::from_fn(own.dimensions(), |voxel| voxel.z < 4).on_grid(own);
    let plate = rig.simulation.add_segment(plate, OBSTACLE, true).unwrap();
    let mut steps = vec![states(&rig)];
    rig.simulation.set_feel(BLOCK, feel).unwrap();
    steps[0] = states(&rig);
    // two drags, a hand, a threshold and its removal
    for end in [4.0, 9.0] {
        rig.simulation
            .drag_segment(BLOCK, shifted(DVec3::X * (end - 1.0)))
            .unwrap();
        rig.simulation
            .move_segment(BLOCK, shifted(DVec3::X * end))
            .unwrap();
        steps.push(states(&rig));
    }
    let above = DVec3::new(16.0, 16.0, 26.0);
    rig.tick_at(above);
    rig.simulation.step();
    rig.simulation.grab(Some(plate), false).unwrap();
    for step in 0..40 {
        rig.tick_at(above + DVec3::Z * 0.1 * f64::from(step));
        rig.simulation.step();
    }
    rig.simulation.grab(None, false).unwrap();
    steps.push(states(&rig));
    rig.simulation.remove_segment(plate).unwrap();
    steps.push(states(&rig));
    assert!(steps.windows(2).all(|pair| pair[0] != pair[1]));
    rig.simulation.undo().unwrap();
    drop(rig);

    let mut rig = rig_of_scan();
    let recovered = rig.simulation.recover_journal(&place.0, HASH).unwrap();
    // four and the plate, and one undo
    assert_eq!((recovered.steps, recovered.ignored_bytes), (6, 0));
    assert_eq!(states(&rig), steps[3]);
    assert!(rig.simulation.redo().unwrap());
    assert_eq!(states(&rig), steps[4]);
    for state in steps.iter().rev().skip(1) {
        assert!(rig.simulation.undo().unwrap());
        assert_eq!(states(&rig), *state);
    }
    // touch follows: the block stands where undo has brought it
    for _ in 0..200 {
        rig.tick_at(DVec3::new(2.0, 16.0, 26.0));
        rig.simulation.step();
    }
    let pressed = (0..200).map(|_| rig.tick_at(DVec3::new(2.0, 16.0, 18.0)));
    let pressed = pressed.last().unwrap();
    assert!((pressed.proxy.z - 20.0).abs() < 1e-4, "{pressed:?}");
}

#[test]
fn a_cut_comes_back_as_one_step_or_not_at_all() {
    let place = Place::new("cut");
    let mut rig = rig_with_journal(&place);
    let whole = states(&rig);
    let cut = |rig: &mut Rig| {
        let plane = Plane::in_scan(DVec3::splat(12.0), DVec3::X, &DAffine3::IDENTITY).unwrap();
        let voxels = rig.simulation.voxels();
        let parts = plane.part(voxels.segment(BLOCK).unwrap(), voxels.grid());
        rig.simulation.part_segment(BLOCK, parts).unwrap();
    };
    cut(&mut rig);
    let parted = states(&rig);
    rig.simulation.undo().unwrap();
    rig.simulation.redo().unwrap();
    rig.simulation.undo().unwrap();
    assert_eq!(states(&rig), whole);
    drop(rig);
    let bytes = fs::read(&place.0).unwrap();

    // wherever the file ends, both parts are there or neither
    let mut seen = [0, 0];
    for length in (0..=bytes.len()).rev().step_by(7) {
        fs::write(&place.0, &bytes[..length]).unwrap();
        let mut rig = rig_of_scan();
        let Ok(recovered) = rig.simulation.recover_journal(&place.0, HASH) else {
            // not even the head is there
            assert!(length < 60, "{length}");
            continue;
        };
        let now = states(&rig);
        if now.is_empty() || now == states(&rig_of_scan()) {
            continue;
        }
        let is_parted = now.len() == 2;
        assert!(now.len() == 2 || rig.simulation.segments()[0].voxels == 32 * 32 * 20);
        seen[usize::from(is_parted)] += 1;
        if length == bytes.len() {
            assert_eq!(recovered.steps, 4);
            assert_eq!(now, whole);
            assert!(rig.simulation.redo().unwrap());
            assert_eq!(states(&rig), parted);
            assert!(rig.simulation.undo().unwrap());
            assert!(!rig.simulation.undo().unwrap());
        }
        // and the journal goes on from there, also where half of a step was left out
        drop(rig);
        let mut again = rig_of_scan();
        again.simulation.recover_journal(&place.0, HASH).unwrap();
        assert_eq!(states(&again), now, "{length}");
    }
    assert!(seen.iter().all(|count| *count > 3), "{seen:?}");
}

#[test]
fn what_was_locked_is_locked_after_a_crash() {
    let place = Place::new("locked");
    let mut rig = rig_with_journal(&place);
    let locked = |rig: &Rig| rig.simulation.segments()[0].locked;
    rig.simulation.set_locked(BLOCK, true).unwrap();
    drop(rig);
    let mut rig = rig_of_scan();
    rig.simulation.recover_journal(&place.0, HASH).unwrap();
    assert!(locked(&rig));
    rig.simulation.set_locked(BLOCK, false).unwrap();
    drop(rig);
    let mut rig = rig_of_scan();
    rig.simulation.recover_journal(&place.0, HASH).unwrap();
    assert!(!locked(&rig));
}
