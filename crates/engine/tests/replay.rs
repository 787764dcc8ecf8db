//! What was recorded is computed again bit for bit, whatever happened meanwhile.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use common::*;
use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_engine::feel::Feel;
use palpate_engine::handover::HandTarget;
use palpate_engine::recording::Recording;
use palpate_engine::replay::{ReplayEnd, ReplayError, Replayed, replay};
use palpate_engine::servo_state::ServoState;
use palpate_engine::session::Session;
use palpate_engine::session_config::{Reference, SessionConfig};
use palpate_engine::settings::Settings;
use palpate_engine::tape::{Tape, TapeCommand};
use palpate_engine::tape_columns::{BUILD, TapeColumns, TapeError};
use palpate_haptics::smooth::Smoothing;
use palpate_volume::edit::SegmentId;

const DIMENSIONS: UVec3 = UVec3::splat(48);

/// Servo and simulation under random changes, and what of it was recorded.
struct Recorder {
    rig: Rig,
    ids: [SegmentId; 2],
    device: DVec3,
    random: Random,
    recording: Recording,
}

impl Recorder {
    fn new(seed: u128) -> Self {
        let start = DVec3::splat(-5.0);
        let mut rig = Rig::of_scan(waves(DIMENSIONS), start);
        let ids = [3, 8].map(|one_in| {
            let segment = sponge(DIMENSIONS, one_in, one_in);
            rig.simulation
                .add_segment(segment, OBSTACLE, false)
                .unwrap()
        });
        rig.tick_at(start);
        rig.tick_at(start);
        Self {
            rig,
            ids,
            device: start,
            random: Random::new(seed),
            recording: Recording::default(),
        }
    }

    /// Ticks with random changes; the simulation takes its pass every `pass` ticks.
    fn run(&mut self, ticks: u32, pass: u32) {
        for tick in 0..ticks {
            self.change_something();
            if tick % pass == 0 {
                self.rig.simulation.step();
                // shares of masks come now and then
                if self.random.below(40) == 0 {
                    self.rig.shares.step();
                }
            }
            self.tick();
        }
    }

    fn tick(&mut self) {
        let reach = if self.random.below(20) == 0 {
            12.0
        } else {
            0.7
        };
        self.device += self.random.point(-reach, reach);
        self.device = self.device.clamp(DVec3::splat(-4.0), DVec3::splat(52.0));
        // now and then the device was not read
        let record = if self.random.below(15) == 0 {
            self.rig.now += 1e-3 * self.random.share();
            self.rig.servo.step(self.rig.now);
            self.rig.records.pop().unwrap()
        } else {
            self.rig.tick_at(self.device)
        };
        self.recording.push(&record, 0);
    }

    fn change_something(&mut self) {
        let Self { rig, random, .. } = self;
        let id = self.ids[random.below(2) as usize];
        let simulation = &mut rig.simulation;
        match random.below(60) {
            0 if random.below(2) == 0 => {
                let low = random.between(50.0, 700.0);
                rig.set_threshold(id, (low, low + random.between(100.0, 2000.0)));
            }
            0 => {
                let other = sponge(DIMENSIONS, random.below(99), 2 + random.below(9));
                simulation.replace_segment(id, other, None).unwrap();
            }
            1..=9 => {
                let solid = random.below(2) == 0;
                let region = random.voxel_box(DIMENSIONS, 40);
                simulation.fill_box(id, &region, solid).unwrap();
            }
            10..=14 => _ = simulation.undo().unwrap(),
            15 => _ = simulation.redo().unwrap(),
            16 => simulation.set_touchable(id, random.below(2) == 0).unwrap(),
            17 => _ = simulation.place(random.point(0.0, 48.0), 0, random.below(2) == 0),
            18 => {
                let angle = random.between(-3.0, 3.0);
                simulation.turn(DMat3::from_rotation_z(angle));
            }
            19 => {
                let friction = random.between(0.0, 0.8);
                let radius = random.between(-2.0, 2.0).max(0.0);
                let settings = Settings {
                    stiffness: random.between(0.1, 0.9),
                    damping: random.between(0.0, 0.01),
                    friction_static: friction,
                    friction_kinetic: friction * random.share(),
                    smoothing: Smoothing::ALL[random.below(3) as usize],
                    probe_radius: radius,
                    ..Settings::default()
                };
                simulation.set_settings(settings).unwrap();
            }
            20 => {
                let feel = Feel {
                    stiffness: Some(random.between(0.1, 0.9)),
                    friction_static: Some(random.share()),
                    friction_kinetic: Some(0.0),
                };
                simulation.set_feel(id, feel).unwrap();
            }
            22 => {
                let turn = DMat3::from_rotation_z(random.between(-0.4, 0.4));
                let pose = DAffine3::from_mat3_translation(turn, random.point(-4.0, 4.0));
                simulation.move_segment(id, pose).unwrap();
            }
            21 => rig.hand.write(HandTarget {
                point: random.point(0.0, 48.0),
                number: random.below(5),
            }),
            _ => {}
        }
    }

    fn begin(&mut self) {
        self.rig.simulation.begin_tape();
    }

    fn finish(self) -> (Recording, Tape) {
        let tape = self.rig.simulation.tape();
        let tape = tape.lock().unwrap().finish().unwrap();
        (self.recording, tape)
    }
}

fn recorded(seed: u128, ticks: u32, pass: u32) -> (Recording, Tape) {
    let mut recorder = Recorder::new(seed);
    recorder.begin();
    recorder.run(ticks, pass);
    recorder.finish()
}

fn replayed((recording, tape): &(Recording, Tape)) -> Replayed {
    replay(recording, tape).unwrap()
}

fn assert_equal(replayed: &Replayed) {
    assert_eq!(replayed.first_difference, None);
    assert!(replayed.is_equal());
    assert_eq!(replayed.recorded_hash, replayed.replayed_hash);
    assert_eq!(replayed.end, ReplayEnd::Whole);
}

/// Edits, roots, undo, toggles, placements, views, settings, hand targets, missing readings;
/// changes that are held back, and more of them than the servo keeps.
#[test]
fn under_random_changes_every_tick_is_replayed_bit_for_bit() {
    for seed in 0..6 {
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
    use palpate_engine::handover::TickRecord;
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

#[test]
fn a_tape_goes_through_columns_and_is_replayed_all_the_same() {
    let (recording, tape) = recorded(10, 3_000, 10);
    let columns = TapeColumns::from(&tape);
    let read = Tape::try_from(&columns).unwrap();
    assert_eq!(read.state, tape.state);
    assert_eq!(read.grid, tape.grid);
    assert_equal(&replay(&recording, &read).unwrap());
    assert_eq!(TapeColumns::from(&read), columns);
}

/// Numbers survive to the bit, those that are none included.
#[test]
fn a_state_goes_through_columns_to_the_bit() {
    let (_, mut tape) = recorded(11, 30, 10);
    tape.state.hand = DVec3::new(-0.0, 5e-324, 1.0 + f64::EPSILON);
    tape.state.mapping.offset = DVec3::new(f64::NAN, f64::INFINITY, -1e300);
    tape.state.tick = u64::MAX;
    let read = Tape::try_from(&TapeColumns::from(&tape)).unwrap();
    let bits = |state: &ServoState| {
        let numbers = [state.hand, state.mapping.offset].map(|vector| vector.to_array());
        numbers.map(|numbers| numbers.map(f64::to_bits))
    };
    assert_eq!(bits(&read.state), bits(&tape.state));
    assert_eq!(read.state.tick, u64::MAX);
}

#[test]
fn columns_that_are_no_tape_are_refused() {
    let (_, tape) = recorded(12, 2_000, 10);
    let good = TapeColumns::from(&tape);
    let refused = |change: fn(&mut TapeColumns)| {
        let mut columns = good.clone();
        change(&mut columns);
        Tape::try_from(&columns).unwrap_err()
    };
    let cut = refused(|columns| columns.start.truncate(40));
    assert!(matches!(cut, TapeError::Start(_)), "{cut}");
    let other = refused(|columns| columns.commands[0] = 0xc1);
    assert!(matches!(other, TapeError::Command { number: 0, .. }));

    let lengths: [fn(&mut TapeColumns); 6] = [
        |columns| _ = columns.values.stored.pop(),
        |columns| _ = columns.brick_ends.pop(),
        |columns| *columns.brick_ends.last_mut().unwrap() += 1,
        |columns| columns.command_ends[0] = u64::MAX,
        |columns| _ = columns.solid.words.pop(),
        |columns| _ = columns.commands.pop(),
    ];
    for change in lengths {
        assert_eq!(refused(change), TapeError::Lengths);
    }
    let bricks: [fn(&mut TapeColumns); 4] = [
        |columns| *columns.values.index.last_mut().unwrap() = u32::MAX,
        |columns| columns.values.index[1] = columns.values.index[0],
        |columns| *columns.solid.index.last_mut().unwrap() = u32::MAX,
        |columns| columns.solid.index[1] = columns.solid.index[0],
    ];
    for change in bricks {
        assert_eq!(refused(change), TapeError::Bricks);
    }
}

#[test]
fn bricks_beyond_the_border_and_scans_that_fill_all_memory_are_refused() {
    let mut rig = Rig::new(UVec3::new(20, 9, 12), DVec3::splat(-5.0));
    rig.simulation.begin_tape();
    rig.tick_at(DVec3::splat(-5.0));
    let mut tape = rig.simulation.tape().lock().unwrap().finish().unwrap();
    let mut columns = TapeColumns::from(&tape);
    // the third brick along x has four voxels inside
    columns.solid.segment.push(1);
    columns.solid.index.push(2);
    columns.solid.words.push([0x0f; 8]);
    assert!(Tape::try_from(&columns).is_ok());
    columns.solid.words[0][3] = 0x1f;
    assert_eq!(Tape::try_from(&columns).unwrap_err(), TapeError::Outside);

    tape.parts.clear();
    tape.grid = grid(UVec3::new(8_000, 8_000, 8_000));
    let refused = Tape::try_from(&TapeColumns::from(&tape)).unwrap_err();
    assert!(matches!(refused, TapeError::TooLarge { .. }), "{refused}");
}

#[test]
fn the_build_has_a_name() {
    assert_eq!(BUILD.len(), 16);
    assert!(u64::from_str_radix(BUILD, 16).unwrap() != 0);
}
