//! A session's journal on disk: what a crash leaves is done again, undo included.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use std::fs;
use std::path::PathBuf;

use common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_tools::drill::DrillSettings;
use palpate_tools::journal_entry::ScanHash;
use palpate_tools::tool::{ToolKind, ToolSettings};
use palpate_volume::edit::SegmentId;
use palpate_volume::matter::SegmentSet;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::splat(32);
const HASH: ScanHash = ScanHash([3; 32]);
const BLOCK: SegmentId = SegmentId(1);

/// A path that nothing is at; removed at the end.
struct Place(PathBuf);

impl Place {
    fn new(name: &str) -> Self {
        let file = format!("palpate-engine-{name}-{}.journal", std::process::id());
        let place = Self(std::env::temp_dir().join(file));
        let _ = fs::remove_file(&place.0);
        place
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

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
        .set_tool(Some(ToolSettings {
            kind: ToolKind::Eraser,
            radius: 2.0,
            segments: vec![BLOCK],
            drill: DrillSettings::default(),
            tissues: Vec::new(),
            spared: SegmentSet::EMPTY,
        }))
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
