//! Painting by touch: segments change hands under the probe, and touch does not notice.

use crate::common::recorder::assert_equal;
use crate::common::*;
use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_engine::error::SessionError;
use palpate_engine::replay::replay;
use palpate_engine::servo::TickRecord;
use palpate_engine::session::{Reference, SessionConfig};
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::painter::PaintSettings;
use palpate_volume::edit::SegmentId;

const DIMENSIONS: UVec3 = UVec3::splat(40);
const BLOCK: SegmentId = SegmentId(1);
const PAINTED: SegmentId = SegmentId(2);
const TOP: f64 = 20.0;

fn painter(radius: f64, paint: PaintSettings) -> ToolSettings {
    ToolSettings {
        paint,
        ..ToolSettings::new(ToolKind::Painter, radius, vec![PAINTED, BLOCK])
    }
}

/// A block below `TOP`, and an obstacle without voxels to paint with.
fn rig() -> Rig {
    let start = DVec3::new(10.3, 20.4, TOP + 3.0);
    let mut rig = Rig::new(DIMENSIONS, start);
    let block = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(40, 40, 20));
    let none = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::ZERO);
    for segment in [block, none] {
        rig.simulation.add_segment(segment, OBSTACLE, true).unwrap();
    }
    rig.ticks(ARRIVED, start);
    rig
}

/// Presses two millimetres into the block and rubs along it; a pass of the simulation each 10 ticks.
fn rub(rig: &mut Rig) -> Vec<TickRecord> {
    let mut records = Vec::new();
    for step in 0..60_u32 {
        let device = DVec3::new(10.3 + 0.3 * f64::from(step), 20.4, TOP - 2.0);
        for _ in 0..10 {
            records.push(rig.tick_at(device));
        }
        rig.simulation.step();
        assert!(rig.status.read().pending <= 1);
    }
    records
}

fn masks(rig: &Rig) -> [Vec<u8>; 2] {
    [BLOCK, PAINTED].map(|id| rig.simulation.voxels().segment(id).unwrap().mask())
}

fn count(mask: &[u8]) -> usize {
    mask.iter().filter(|solid| **solid != 0).count()
}

#[test]
fn touch_is_the_same_to_the_bit_with_paint_and_without() {
    let mut plain = rig();
    let expected = rub(&mut plain);
    let depth = Some(1.6);
    for (depth, overlaps) in [(None, false), (None, true), (depth, false)] {
        let mut rig = rig();
        let before = masks(&rig);
        let paint = PaintSettings { depth, overlaps };
        rig.simulation.set_tool(Some(painter(2.6, paint))).unwrap();
        rig.simulation.stroke(true).unwrap();
        let felt = rub(&mut rig);
        rig.simulation.stroke(false).unwrap();
        assert_eq!(rig.violations(), 0);
        assert!(felt.iter().any(|record| record.contact));
        for (felt, expected) in felt.iter().zip(&expected) {
            let of = |record: &TickRecord| (record.proxy, record.contact_point, record.force);
            assert_eq!(of(felt), of(expected), "tick {}", felt.tick);
        }
        let waits = |notice: &palpate_engine::notice::Notice| notice.text.contains("waits");
        assert!(!rig.notices.try_iter().any(|notice| waits(&notice)));

        let [block, painted] = masks(&rig);
        let gained = count(&painted);
        assert!(gained > 60, "{gained}");
        assert_eq!(rig.simulation.tool_report().voxels, gained as u64);
        for (place, was) in before[0].iter().enumerate() {
            assert_eq!(*was, block[place] | painted[place]);
            assert!(overlaps || block[place] & painted[place] == 0);
        }
        let deepest = (0..20).find(|z| painted[z * 1600 + 20 * 40 + 20] != 0);
        assert_eq!(deepest, Some(if depth.is_some() { 18 } else { 17 }));

        // the stroke is one step
        assert!(rig.simulation.undo().unwrap());
        assert_eq!(masks(&rig), before);
        assert!(rig.simulation.redo().unwrap());
        assert_eq!(masks(&rig), [block, painted]);
    }
}

#[test]
fn what_stands_elsewhere_is_not_painted_and_that_is_said() {
    let mut rig = rig();
    let up = DAffine3::from_translation(DVec3::new(0.0, 0.0, -4.0));
    rig.simulation.move_segment(BLOCK, up).unwrap();
    let settings = painter(2.0, PaintSettings::default());
    rig.simulation.set_tool(Some(settings)).unwrap();
    let refused = rig.simulation.stroke(true);
    assert!(
        matches!(refused, Err(SessionError::NothingToPaint)),
        "{refused:?}"
    );
}

#[test]
fn a_session_that_paints_is_replayed() {
    let path: Vec<[f64; 4]> = (0..40)
        .map(|step| {
            let depth = if step % 4 == 0 { 15.0 } else { 23.0 };
            [
                0.1 * f64::from(step),
                10.0 + 0.6 * f64::from(step),
                depth,
                20.0,
            ]
        })
        .collect();
    let block = box_segment(DIMENSIONS, IVec3::new(5, 20, 5), IVec3::new(39, 35, 39));
    let session = started(SessionConfig {
        rate_hz: 1000,
        ..offline(DIMENSIONS, block, scripted(&path), Reference::Scene)
    });
    let none = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::ZERO);
    let painted = session.add_segment(none, OBSTACLE, false).unwrap();
    assert_eq!(painted, PAINTED);
    let settings = painter(3.0, PaintSettings::default());
    session.set_tool(Some(settings)).unwrap();
    session.start_recording().unwrap();
    for step in 0..12 {
        session.stroke(step % 3 != 2).unwrap();
        session.run(0.25).unwrap();
        if step % 5 == 4 {
            session.undo().unwrap();
        }
    }
    assert!(session.segment(PAINTED).unwrap().count() > 50);
    let (recording, tape) = session.finish_recording().unwrap();
    let tape = tape.unwrap();
    assert_equal(&replay(&recording, &tape).unwrap());
    assert!(recording.contact.iter().any(|touches| *touches));
    assert!(recording.tool_volume.last().unwrap() > &0.0);
    // it was painted while it was recorded
    assert!(tape.entries.len() > 20, "{}", tape.entries.len());
}
