//! Whole sessions, offline and live, are computed again bit for bit.

use crate::common::recorder::*;
use crate::common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::replay::replay;
use palpate_engine::session::{Reference, Session, SessionConfig};
use palpate_volume::edit::SegmentId;

const DIMENSIONS: UVec3 = UVec3::splat(48);

/// Goes back and forth in the front of a block.
fn offline_session(rate_hz: u32) -> Session {
    let path: Vec<[f64; 4]> = (0..40)
        .map(|step| {
            let depth = if step % 2 == 0 { 15.0 } else { 26.0 };
            let across = 10.0 + 0.6 * f64::from(step);
            [0.1 * f64::from(step), across, depth, 20.0]
        })
        .collect();
    let block = box_segment(DIMENSIONS, IVec3::new(5, 20, 5), IVec3::new(43, 35, 43));
    started(SessionConfig {
        rate_hz,
        ..offline(DIMENSIONS, block, scripted(&path), Reference::Scene)
    })
}

#[test]
fn an_offline_session_with_edits_undo_and_thresholds_is_replayed() {
    for rate_hz in [1000, 4000] {
        let session = offline_session(rate_hz);
        session.start_recording().unwrap();
        let id = SegmentId(1);
        for step in 0..30 {
            session.run(0.033).unwrap();
            let low = IVec3::new(8 + step, 19, 14);
            session
                .fill_box(id, low, low + IVec3::new(6, 5, 12), step % 3 == 0)
                .unwrap();
            match step % 7 {
                3 => _ = session.undo().unwrap(),
                5 => _ = session.redo().unwrap(),
                6 => session.set_touchable(id, step % 2 == 0).unwrap(),
                // all values are 0: everything, then nothing
                4 => _ = session.threshold(None, (0.0, 0.0)).map(|_| session.undo()),
                _ => {}
            }
        }
        let (recording, tape) = session.finish_recording().unwrap();
        let tape = tape.unwrap();
        let outcome = replay(&recording, &tape).unwrap();
        assert_equal(&outcome);
        // the state is told at the end of the first tick
        assert_eq!(outcome.first_row, 1);
        assert_eq!(outcome.ticks.tick[..], recording.tick[1..]);
        assert!(recording.contact.iter().any(|touches| *touches));

        let mut other = tape;
        other.parts.clear();
        assert!(!replay(&recording, &other).unwrap().is_equal());
    }
}

#[test]
fn a_live_session_edited_thirty_times_a_second_is_replayed() {
    let block = box_segment(DIMENSIONS, IVec3::new(5, 20, 5), IVec3::new(43, 35, 43));
    let session = started(SessionConfig {
        real_time: true,
        ..offline(DIMENSIONS, block, simulated(), Reference::View)
    });
    session.place(DVec3::new(20.0, 10.0, 20.0)).unwrap();
    session.start_recording().unwrap();
    session.hand(DVec3::new(20.0, 32.0, 20.0)).unwrap();
    frame_where(&session, |frame| frame.contact);
    let id = SegmentId(1);
    for step in 0..45 {
        let swing = 10.0 * (0.4 * f64::from(step)).sin();
        session
            .hand(DVec3::new(20.0 + swing, 32.0, 20.0 - 0.3 * swing))
            .unwrap();
        let low = IVec3::new(10 + step % 20, 20, 14);
        session
            .fill_box(id, low, low + IVec3::new(8, 5, 12), step % 2 == 1)
            .unwrap();
        if step % 5 == 0 {
            session.undo().unwrap();
        }
        if step == 20 {
            session.view(DVec3::X, DVec3::new(0.0, 0.3, 1.0)).unwrap();
            session.place(DVec3::new(24.0, 12.0, 22.0)).unwrap();
        }
        // thirty a second where the servo keeps its pace
        let_tick(&session, 33);
    }
    let (recording, tape) = session.finish_recording().unwrap();
    let tape = tape.unwrap();
    let outcome = replay(&recording, &tape).unwrap();
    assert_equal(&outcome);
    // the replay holds what happened: edits, and contact with them
    assert!(tape.entries.len() > 45);
    assert!(recording.contact.iter().any(|touches| *touches));
    assert!(outcome.ticks.len() > 45 * 33, "{}", outcome.ticks.len());
}

/// The tape survives the session: what was recorded is not lost when the session stops.
#[test]
fn a_recording_can_be_taken_after_the_session_has_stopped() {
    let session = offline_session(1000);
    session.start_recording().unwrap();
    session.run(0.5).unwrap();
    session.stop();
    let (recording, tape) = session.finish_recording().unwrap();
    assert_eq!(recording.len(), 500);
    assert_equal(&replay(&recording, &tape.unwrap()).unwrap());
    assert!(session.finish_recording().is_none());
}

// --- files --------------------------------------------------------------------------------
