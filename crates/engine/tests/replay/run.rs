//! What was recorded is computed again bit for bit, whatever happened meanwhile.

use crate::common::recorder::*;
use crate::common::*;
use crate::length::by_length;
use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_engine::replay::{
    Recording, ReplayEnd, ReplayError, Tape, TapeColumns, TapeCommand, TapeError, replay,
};
use palpate_engine::touch::Settings;

const DIMENSIONS: UVec3 = UVec3::splat(48);

/// Edits, roots, undo, toggles, placements, views, settings, hand targets, missing readings;
/// changes that are held back, and more of them than the servo keeps.
#[test]
fn under_random_changes_every_tick_is_replayed_bit_for_bit() {
    for seed in 0..by_length(1, 6) {
        let session = recorded(seed, 10_000, 10);
        let outcome = replayed(&session);
        assert_equal(&outcome);
        assert_eq!(outcome.first_row + outcome.ticks.len(), 10_000);
        // also from what a file holds: of the scan, only what was read
        let columns = TapeColumns::from(&session.1);
        let read = Tape::try_from(&columns).unwrap();
        assert_equal(&replay(&session.0, &read).unwrap());
        assert!(!columns.values.index.is_empty());
        // the test means something
        let contacts = session.0.contact.iter().filter(|touches| **touches).count();
        assert!(contacts > 1_000, "{contacts}");
        assert!(session.1.entries.len() > 1_000);
    }
}

/// The simulation frees nothing for seconds, so that the servo has no room to replace bricks:
/// when it goes on is an input like any other.
#[test]
fn a_servo_that_waited_for_room_is_replayed_too() {
    let mut recorder = Recorder::new(3);
    recorder.begin();
    recorder.run(2, 1);
    for tick in 0..12_000 {
        let region = recorder.random.voxel_box(DIMENSIONS, 12);
        let id = recorder.ids[0];
        let simulation = &mut recorder.rig.simulation;
        simulation.fill_box(id, &region, tick % 2 == 0).unwrap();
        recorder.tick();
    }
    recorder.run(8_000, 10);
    let session = recorder.finish();
    let without_room = session.0.has_room.iter().filter(|room| !**room).count();
    assert!(without_room > 1_000, "{without_room}");
    assert_equal(&replayed(&session));
}

#[test]
fn replaying_twice_gives_the_same_hash_and_another_session_another() {
    let session = recorded(1, 3_000, 10);
    let hash = replayed(&session).replayed_hash;
    assert_eq!(replayed(&session).replayed_hash, hash);
    assert_ne!(replayed(&recorded(2, 3_000, 10)).replayed_hash, hash);
}

/// Any of the inputs, changed in its last bit in the midst of a contact, is noticed.
#[test]
fn a_flipped_bit_in_an_input_makes_the_replay_differ() {
    let (recording, tape) = recorded(4, 4_000, 10);
    let outcome = replay(&recording, &tape).unwrap();
    let touching = |row: &usize| {
        let before = row - 1;
        recording.contact[*row] && recording.read_at[*row] > recording.read_at[before]
    };
    let row = (2_000..recording.len()).find(touching).unwrap();
    let flip = |number: &mut f64| *number = f64::from_bits(number.to_bits() ^ (1 << 20));
    type Change<'a> = (&'a str, Box<dyn Fn(&mut Recording)>);
    let changes: [Change<'_>; 3] = [
        (
            "position",
            Box::new(move |recording| flip(&mut recording.position_in_device[row].x)),
        ),
        (
            "reading",
            Box::new(move |recording| recording.reading[row] = 0),
        ),
        (
            "age",
            Box::new(move |recording| recording.read_at[row] -= 1.0),
        ),
    ];
    for (name, change) in changes {
        let mut changed = recording.clone();
        change(&mut changed);
        let other = replay(&changed, &tape).unwrap();
        let difference = other.first_difference.expect(name);
        assert_eq!(difference.tick, recording.tick[row], "{name}");
        assert!(difference.force > 0.0 || difference.proxy > 0.0, "{name}");
        assert_ne!(other.replayed_hash, outcome.replayed_hash, "{name}");
        assert_eq!(other.recorded_hash, outcome.recorded_hash, "{name}");
    }

    // so is one in a command
    let mut other = tape.clone();
    for entry in &mut other.entries {
        match &mut entry.command {
            TapeCommand::Settings(settings) => flip(&mut settings.stiffness),
            TapeCommand::Feel(_, feel) => feel.stiffness.iter_mut().for_each(flip),
            _ => {}
        }
    }
    assert!(!replay(&recording, &other).unwrap().is_equal());
}

#[test]
fn a_changed_outcome_is_found_at_its_tick() {
    let (mut recording, tape) = recorded(5, 1_000, 10);
    recording.proxy[700].y += 1e-12;
    let outcome = replay(&recording, &tape).unwrap();
    assert_eq!(outcome.different, 1);
    let difference = outcome.first_difference.unwrap();
    assert_eq!(difference.tick, recording.tick[700]);
    assert!(difference.proxy < 1e-11 && difference.force == 0.0);

    // a zero of the other sign is another number
    let (mut recording, tape) = recorded(5, 1_000, 10);
    let free = recording.contact.iter().position(|touches| !touches);
    let row = free.unwrap().max(tape.state.tick as usize);
    recording.force[row].x = -recording.force[row].x;
    assert_eq!(replay(&recording, &tape).unwrap().different, 1);
}

/// Ticks that were lost end the replay, and say how many they are.
#[test]
fn a_gap_ends_the_replay() {
    let (recording, tape) = recorded(6, 1_000, 10);
    let mut with_gap = Recording::default();
    for row in (0..400).chain(410..recording.len()) {
        copy_row(&recording, row, &mut with_gap);
    }
    let outcome = replay(&with_gap, &tape).unwrap();
    assert!(outcome.is_equal());
    let end = ReplayEnd::Lost {
        after: recording.tick[399],
        count: 10,
    };
    assert_eq!(outcome.end, end);
    assert_eq!(outcome.first_row + outcome.ticks.len(), 400);

    // and where the beginning is among them nothing can be replayed
    let mut without_beginning = Recording::default();
    for row in 400..recording.len() {
        copy_row(&recording, row, &mut without_beginning);
    }
    let tick = tape.state.tick;
    assert_eq!(
        replay(&without_beginning, &tape).unwrap_err(),
        ReplayError::NoBeginning { tick }
    );
}

fn copy_row(from: &Recording, row: usize, to: &mut Recording) {
    use palpate_engine::servo::TickRecord;
    let record = TickRecord {
        tick: from.tick[row],
        time: from.time[row],
        device: from.device[row],
        hand: from.hand[row],
        proxy: from.proxy[row],
        force: from.force[row],
        sent_force: from.sent_force[row],
        contact: from.contact[row],
        inputs: from.inputs(row),
        command: from.command[row],
        ..TickRecord::default()
    };
    to.push(&record, from.touched[row]);
}

#[test]
fn commands_that_no_servo_could_have_obeyed_are_refused() {
    let (recording, tape) = recorded(7, 300, 10);
    for (row, command) in [(100, 0), (100, recording.command[100] + 1_000)] {
        let mut changed = recording.clone();
        changed.command[row] = command;
        let refused = replay(&changed, &tape).unwrap_err();
        assert!(
            matches!(refused, ReplayError::Commands { tick, .. } if tick == recording.tick[row]),
            "{refused}"
        );
    }
}

/// A tape that is full ends before the first command that is missing.
#[test]
fn changes_beyond_the_memory_end_the_replay() {
    let mut recorder = Recorder::new(8);
    let tape = recorder.rig.simulation.tape();
    tape.lock().unwrap().limit(100_000);
    recorder.begin();
    recorder.run(5_000, 10);
    let notices: Vec<_> = recorder.rig.notices.try_iter().collect();
    assert!(notices.iter().any(|notice| notice.text.contains("room")));
    let (recording, tape) = recorder.finish();
    assert!(tape.is_full && !tape.entries.is_empty());
    let outcome = replay(&recording, &tape).unwrap();
    assert!(outcome.is_equal());
    let last = outcome.first_row + outcome.ticks.len() - 1;
    assert!(last < recording.len() - 1);
    let after = recording.tick[last];
    assert_eq!(outcome.end, ReplayEnd::Commands { after });
}

/// While a change waits for the probe there is no beginning; it comes when the change is followed.
#[test]
fn a_recording_begins_once_nothing_is_held_back() {
    let middle = DVec3::splat(24.5);
    let mut rig = Rig::new(DIMENSIONS, middle);
    rig.tick_at(middle);
    let block = box_segment(DIMENSIONS, IVec3::splat(4), IVec3::splat(44));
    rig.simulation.add_segment(block, OBSTACLE, true).unwrap();
    rig.tick_at(middle);
    rig.simulation.step();
    rig.simulation.begin_tape();
    let said: Vec<_> = rig.notices.try_iter().map(|notice| notice.text).collect();
    assert!(
        said.iter().any(|text| text.contains("recording")),
        "{said:?}"
    );

    let mut recording = Recording::default();
    for tick in 0..60 {
        let record = rig.tick_at(middle - DVec3::X * f64::from(tick).min(30.0));
        recording.push(&record, 0);
        rig.simulation.step();
    }
    let pressed = middle;
    for _ in 0..20 {
        recording.push(&rig.tick_at(pressed), 0);
    }
    let tape = rig.simulation.tape().lock().unwrap().finish().unwrap();
    let outcome = replay(&recording, &tape).unwrap();
    assert_equal(&outcome);
    // 20 mm to the face of the block, of which the change pushes the probe the last 7
    assert!(outcome.first_row >= 13, "{}", outcome.first_row);
    assert!(outcome.ticks.contact.iter().any(|touches| *touches));
}

/// A second recording begins anew; what belonged to the first is not in its way.
#[test]
fn a_recording_can_be_begun_again_and_again() {
    let mut recorder = Recorder::new(9);
    for _ in 0..5 {
        recorder.begin();
        recorder.begin();
        recorder.run(300, 7);
        recorder.recording = Recording::default();
        recorder.begin();
        recorder.run(500, 7);
        let tape = recorder.rig.simulation.tape();
        let tape = tape.lock().unwrap().finish().unwrap();
        assert_equal(&replay(&recorder.recording, &tape).unwrap());
    }
}

/// What touch remembers of a contact (where it sticks, where the force came from, what the surface
/// felt like) is in the recording's first state; what the servo only keeps at hand is not needed.
#[test]
fn a_recording_can_begin_in_the_midst_of_a_contact() {
    let mut rig = Rig::new(DIMENSIONS, DVec3::new(20.0, 10.0, 20.0));
    let block = box_segment(DIMENSIONS, IVec3::new(5, 20, 5), IVec3::new(43, 35, 43));
    rig.simulation.add_segment(block, OBSTACLE, false).unwrap();
    let rough = Settings {
        friction_static: 0.6,
        friction_kinetic: 0.4,
        ..Settings::default()
    };
    rig.simulation.set_settings(rough).unwrap();
    // presses, then slides on in a curve
    let device = |tick: u32| {
        let (across, deep) = (0.01 * f64::from(tick), (0.01 * f64::from(tick)).min(3.0));
        DVec3::new(14.0 + across, 19.0 + deep, 22.0 + across.sin())
    };
    for tick in 0..600 {
        rig.tick_at(device(tick));
        if tick % 10 == 0 {
            rig.simulation.step();
        }
    }
    rig.simulation.begin_tape();
    let mut recording = Recording::default();
    for tick in 600..1_800 {
        recording.push(&rig.tick_at(device(tick)), 0);
    }
    assert!(recording.contact.iter().all(|touches| *touches));
    let tape = rig.simulation.tape().lock().unwrap().finish().unwrap();
    assert_equal(&replay(&recording, &tape).unwrap());

    // a state that has forgotten the contact is another one
    let mut other = tape;
    other.state.touch.forget_contact();
    assert!(!replay(&recording, &other).unwrap().is_equal());
}

/// A segment that was moved before the recording is made no obstacle, moved, and made one again:
/// the servo takes its pose from the tape.
#[test]
fn a_segment_moved_before_the_recording_and_while_it_is_no_obstacle_is_replayed() {
    let start = DVec3::new(24.5, 24.5, 44.0);
    let mut rig = Rig::new(DIMENSIONS, start);
    let block = box_segment(DIMENSIONS, IVec3::new(10, 10, 4), IVec3::new(38, 38, 20));
    let id = rig.simulation.add_segment(block, OBSTACLE, false).unwrap();
    let raised = |by: f64| DAffine3::from_translation(DVec3::Z * by);
    rig.simulation.move_segment(id, raised(10.0)).unwrap();
    for _ in 0..60 {
        rig.tick_at(start);
        rig.simulation.step();
    }
    rig.simulation.begin_tape();
    let mut recording = Recording::default();
    let mut rests = Vec::new();
    let stands = [
        (10.0, None),
        (14.0, Some(14.0)),
        (15.0, None),
        (4.0, Some(4.0)),
    ];
    for (at, pose) in stands {
        rig.simulation.set_touchable(id, false).unwrap();
        if let Some(to) = pose {
            rig.simulation.move_segment(id, raised(to)).unwrap();
        }
        rig.simulation.set_touchable(id, true).unwrap();
        // in the midst of a move it is replaced as a whole
        let goes_on = f64::from(u8::from(pose.is_some()));
        if pose.is_some() {
            rig.simulation.move_segment(id, raised(at + 1.0)).unwrap();
        }
        for tick in 0..200 {
            if tick == 5 {
                rig.simulation.set_touchable(id, true).unwrap();
                let block = box_segment(DIMENSIONS, IVec3::new(9, 9, 4), IVec3::new(39, 39, 20));
                rig.simulation.replace_segment(id, block, None).unwrap();
            }
            let down = f64::from(tick).min(100.0) / 100.0;
            let device = start.lerp(DVec3::new(24.5, 24.5, 18.0 + at), down);
            recording.push(&rig.tick_at(device), 0);
            rig.simulation.step();
        }
        rests.push(recording.proxy.last().unwrap().z - 20.0 - at - goes_on);
        for _ in 0..50 {
            recording.push(&rig.tick_at(start), 0);
        }
    }
    // each time the probe rested on it where it stood; 1e-6: it stands 1e-8 before a face
    assert!(rests.iter().all(|above| above.abs() < 1e-6), "{rests:?}");

    let tape = rig.simulation.tape().lock().unwrap().finish().unwrap();
    assert_equal(&replay(&recording, &tape).unwrap());
    let read = Tape::try_from(&TapeColumns::from(&tape)).unwrap();
    assert_equal(&replay(&recording, &read).unwrap());

    // the poses of the tape matter, and those that are none are refused
    let with_poses = |pose: DAffine3| {
        let mut other = tape.clone();
        for entry in &mut other.entries {
            if let TapeCommand::Root { parts, .. } = &mut entry.command {
                let moved = parts.iter_mut().filter_map(|part| part.moved.as_mut());
                moved.for_each(|moved| moved.2 = pose);
            }
        }
        other
    };
    let other = with_poses(raised(-3.0));
    assert!(!replay(&recording, &other).unwrap().is_equal());
    let sheared = DAffine3::from_scale(DVec3::new(1.0, 1.0, 1.1));
    let refused = Tape::try_from(&TapeColumns::from(&with_poses(sheared))).unwrap_err();
    assert!(matches!(refused, TapeError::Pose(_)), "{refused}");
}
