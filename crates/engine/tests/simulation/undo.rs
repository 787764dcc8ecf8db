//! Undo and redo bring back voxels, thresholds and segments, bit for bit.

use crate::common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::scene::Properties;
use palpate_engine::session::{Reference, Session, SessionConfig};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;

const DIMENSIONS: UVec3 = UVec3::splat(32);

fn session() -> Session {
    let block = box_segment(DIMENSIONS, IVec3::splat(8), IVec3::splat(24));
    started(offline(DIMENSIONS, block, simulated(), Reference::View))
}

/// Every segment's number, voxels, touchability and threshold.
type Snapshot = Vec<(u8, Vec<u8>, bool, Option<(f64, f64)>)>;

fn snapshot(session: &Session) -> Snapshot {
    let states = session.segments().unwrap();
    states
        .iter()
        .map(|state| {
            let mask = session.segment(state.id).unwrap().mask();
            (state.id.0, mask, state.touchable, state.range)
        })
        .collect()
}

fn threshold(range: (f64, f64)) -> Properties {
    Properties {
        touchable: true,
        range: Some(range),
        ..Properties::default()
    }
}

#[test]
fn every_kind_of_change_is_taken_back_and_done_again() {
    let session = session();
    let mut states = vec![snapshot(&session)];
    let note = |states: &mut Vec<Snapshot>| states.push(snapshot(&session));

    let id = session
        .add_segment(sponge(DIMENSIONS, 1, 4), threshold((1.0, 2.0)), true)
        .unwrap();
    note(&mut states);
    let other = sponge(DIMENSIONS, 2, 3);
    session
        .replace_segment(id, other, Some((5.0, 6.0)))
        .unwrap();
    note(&mut states);
    session
        .fill_box(id, IVec3::splat(3), IVec3::splat(20), true)
        .unwrap();
    note(&mut states);
    session.remove_segment(SegmentId(1)).unwrap();
    note(&mut states);
    let third = session
        .add_segment(Segment::empty(DIMENSIONS), OBSTACLE, true)
        .unwrap();
    // the number of the removed segment is kept for its return
    assert_eq!(third, SegmentId(3));
    note(&mut states);

    // an edited threshold is none any more
    assert_eq!(states[2][1].3, Some((5.0, 6.0)));
    assert_eq!(states[3][1].3, None);

    for _ in 0..3 {
        for state in states.iter().rev().skip(1) {
            assert!(session.undo().unwrap());
            assert!(snapshot(&session) == *state);
        }
        assert!(!session.undo().unwrap());
        for state in states.iter().skip(1) {
            assert!(session.redo().unwrap());
            assert!(snapshot(&session) == *state);
        }
        assert!(!session.redo().unwrap());
    }
}

#[test]
fn a_new_change_forgets_what_was_undone() {
    let session = session();
    let id = SegmentId(1);
    let fill = |at: i32| {
        let (low, high) = (IVec3::splat(at), IVec3::splat(at + 2));
        session.fill_box(id, low, high, true).unwrap();
    };
    fill(1);
    session.undo().unwrap();
    session.run(0.02).unwrap();
    assert!(session.frame().can_redo);
    fill(4);
    let frame = session.frame();
    assert!(frame.can_undo && !frame.can_redo);
    assert!(!session.redo().unwrap());
}

#[test]
fn a_frame_tells_how_many_steps_were_made_and_not_taken_back() {
    let session = session();
    let first = session.frame();
    let told = || {
        let frame = session.frame();
        (frame.step - first.step, frame.steps_made - first.steps_made)
    };
    let fill = |at: i32| {
        let (low, high) = (IVec3::splat(at), IVec3::splat(at + 2));
        session.fill_box(SegmentId(1), low, high, true).unwrap();
        session.run(0.02).unwrap();
    };
    fill(1);
    fill(4);
    assert_eq!(told(), (2, 2));
    session.undo().unwrap();
    session.run(0.02).unwrap();
    assert_eq!(told(), (1, 2));
    // another step in the place of one that was taken back is told too
    fill(7);
    assert_eq!(told(), (2, 3));
}

#[test]
fn what_changes_nothing_is_not_noted() {
    let session = session();
    let id = SegmentId(1);
    let before = session.frame();
    session
        .fill_box(id, IVec3::splat(10), IVec3::splat(20), true)
        .unwrap();
    session.set_touchable(id, true).unwrap();
    let after = session.frame();
    assert!(!after.can_undo);
    assert_eq!(after.edit, before.edit);
    assert_eq!(after.segments_version, before.segments_version);
}

#[test]
fn versions_rise_with_every_change_undo_included() {
    let session = session();
    let mut last = session.frame();
    let id = SegmentId(1);
    let steps: [&dyn Fn(); 3] = [
        &|| {
            session
                .fill_box(id, IVec3::ZERO, IVec3::splat(3), true)
                .unwrap()
        },
        &|| assert!(session.undo().unwrap()),
        &|| assert!(session.redo().unwrap()),
    ];
    for step in steps {
        step();
        let frame = session.frame();
        assert!(frame.segments_version > last.segments_version);
        assert!(frame.edit > last.edit);
        last = frame;
    }
}

/// Touch follows undo: the hole is solid again, then a hole again.
#[test]
fn touch_follows_undo_and_redo() {
    let session = session();
    let (low, high) = (IVec3::new(10, 8, 10), IVec3::new(22, 12, 22));
    session.fill_box(SegmentId(1), low, high, false).unwrap();
    let ground = || {
        session.place(DVec3::new(16.0, 2.0, 16.0)).unwrap();
        session.hand(DVec3::new(16.0, 18.0, 16.0)).unwrap();
        session.run(1.0).unwrap();
        let y = session.frame().proxy.y;
        session.place(DVec3::new(16.0, 2.0, 16.0)).unwrap();
        session.run(0.01).unwrap();
        y
    };
    // the probe stays 1e-8 voxels before the face
    assert!((ground() - 12.0).abs() < 1e-6);
    session.undo().unwrap();
    assert!((ground() - 8.0).abs() < 1e-6);
    session.redo().unwrap();
    assert!((ground() - 12.0).abs() < 1e-6);
}

/// Large edits and thresholds are built outside the simulation; other edits may come in between.
#[test]
fn large_changes_among_small_ones_lose_nothing() {
    let dimensions = UVec3::splat(128);
    let empty = Segment::empty(dimensions);
    let config = SessionConfig {
        real_time: true,
        ..offline(dimensions, empty, simulated(), Reference::View)
    };
    let session = started(config);
    let id = SegmentId(1);
    std::thread::scope(|scope| {
        // single voxels of the lowest layer
        scope.spawn(|| {
            for at in 0..100 {
                let low = IVec3::new(at, 0, 0);
                session.fill_box(id, low, low + 1, true).unwrap();
            }
        });
        // all other layers, over and over
        for turn in 0..5 {
            let (low, high) = (IVec3::new(0, 0, 1), IVec3::splat(128));
            session.fill_box(id, low, high, turn % 2 == 0).unwrap();
        }
    });
    let layer = u64::from(dimensions.x * dimensions.y);
    assert_eq!(session.segment(id).unwrap().count(), 127 * layer + 100);

    // every value of the scan is 0
    let voxels = 128 * layer;
    let all = session.threshold(None, (-1.0, 1.0)).unwrap();
    assert_eq!(session.segment(all).unwrap().count(), voxels);
    assert_eq!(session.threshold(Some(all), (1.0, 2.0)).unwrap(), all);
    let state = session.segments().unwrap()[1];
    assert_eq!((state.voxels, state.range), (0, Some((1.0, 2.0))));
    assert!(session.undo().unwrap());
    assert_eq!(session.segment(all).unwrap().count(), voxels);
    assert!(session.threshold(None, (2.0, 1.0)).is_err());
    assert!(session.threshold(Some(SegmentId(9)), (0.0, 1.0)).is_err());
}
