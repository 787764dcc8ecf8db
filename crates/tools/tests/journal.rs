//! The journal on disk: recovered to the bit, gone on with, refused where it is another's.

use std::fs;

use crate::support::journal::{HASH, bare, recovered, start, written};
use crate::support::place::Place;
use crate::support::session::Session;
use crate::support::{Dense, Random, oblique_grid};
use glam::{DAffine3, DVec3, UVec3};
use palpate_tools::journal::{
    Action, Entry, Facts, JournalError, JournalFile, JournalReader, ScanHash, recover,
};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

#[test]
fn a_random_session_is_recovered_to_the_bit() {
    let dimensions = UVec3::new(26, 23, 17);
    for seed in 0..8 {
        let place = Place::new(&format!("random-{seed}"));
        let session = written(&place, dimensions, 60, seed);
        let (voxels, found) = recovered(&place, dimensions);
        assert!(
            Dense::of(&voxels) == Dense::of(&session.voxels),
            "seed {seed}"
        );
        assert_eq!(
            (found.steps, found.ignored_bytes, found.step_is_open),
            (60, 0, false)
        );
        assert_eq!(
            found.valid_bytes,
            fs::metadata(&place.0).expect("a file").len()
        );

        // the overlay has just the same bricks, so that nothing differs inside either
        let bricks = |voxels: &Voxels| {
            let entries = voxels.overlay().bricks().entries();
            entries.iter().map(Option::is_some).collect::<Vec<_>>()
        };
        assert_eq!(bricks(&voxels), bricks(&session.voxels));
        for (id, segment) in session.voxels.segments() {
            let recovered = voxels.segment(id).expect("it was there");
            assert_eq!(recovered.count(), segment.count());
            assert_eq!(recovered.bounding_box(), segment.bounding_box());
        }
    }
}

#[test]
fn moves_facts_and_segments_with_a_grid_of_their_own_come_back_to_the_bit() {
    let dimensions = UVec3::new(9, 8, 10);
    let place = Place::new("facts");
    let voxels = start(dimensions);
    let own = oblique_grid(UVec3::new(11, 3, 5));
    let segment = Segment::from_fn(own.dimensions(), |voxel| voxel.x > 3).on_grid(own);
    let facts = Facts {
        touchable: true,
        range: Some((-0.25, f64::INFINITY)),
        made_by: None,
        feel: [Some(0.3), None, Some(0.1)],
        pose: Some(DAffine3::from_rotation_x(0.7)),
        locked: true,
    };
    let pose = DAffine3::from_translation(DVec3::new(0.1, -2.0, 1e-9));
    let mut file = JournalFile::create(&place.0, HASH, &voxels).expect("a new file");
    file.put(Action::Do, SegmentId(9), &segment);
    file.facts(SegmentId(9), facts);
    file.end_step();
    file.moved(Action::Do, SegmentId(9), pose, false);
    file.end_step();
    file.moved(Action::Do, SegmentId(9), pose, true);
    file.together(2);
    file.moved(Action::Undo, SegmentId(9), pose, false);
    file.moved(Action::Undo, SegmentId(9), pose, false);
    drop(file);

    let mut reader = JournalReader::open(&place.0, HASH, &voxels).expect("a journal");
    let mut seen = Vec::new();
    while let Some(entry) = reader.next(&voxels).expect("whole records") {
        match entry {
            Entry::Put(Action::Do, id, put) => {
                assert_eq!((id, put.own_grid()), (SegmentId(9), Some(&own)));
                assert_eq!(put.mask(), segment.mask());
            }
            Entry::Facts(id, read) => assert_eq!((id, read), (SegmentId(9), facts)),
            Entry::Move {
                action,
                pose: read,
                goes_on,
                ..
            } => {
                assert_eq!(read, pose);
                seen.push((action, goes_on));
            }
            Entry::Together(count) => assert_eq!(count, 2),
            _ => {}
        }
    }
    let (undo, done) = (Action::Undo, Action::Do);
    assert_eq!(
        seen,
        [(done, false), (done, true), (undo, false), (undo, false)]
    );
    // put, the move with what goes on with it, and both that were undone together
    assert_eq!(reader.recovery().steps, 3);
}

#[test]
fn a_recovered_journal_goes_on_where_it_was_cut() {
    let dimensions = UVec3::new(26, 23, 17);
    let place = Place::new("resume");
    written(&place, dimensions, 10, 5);
    let length = fs::metadata(&place.0).expect("a file").len();
    let file = fs::File::options()
        .write(true)
        .open(&place.0)
        .expect("a file");
    file.set_len(length - 3).expect("shorter");

    let (voxels, found) = recovered(&place, dimensions);
    assert!(found.ignored_bytes > 0);
    let file = JournalFile::resume(&place.0, &found, &voxels).expect("it goes on");
    let mut session = Session::new(voxels, Some(file));
    let mut random = Random::new(6);
    while !session.random_step(&mut random) {}
    session.file = None;

    let (again, found) = recovered(&place, dimensions);
    assert_eq!((found.ignored_bytes, found.step_is_open), (0, false));
    assert!(Dense::of(&again) == Dense::of(&session.voxels));
}

#[test]
fn notes_and_ends_of_steps_come_back_in_their_place() {
    let dimensions = UVec3::new(9, 8, 10);
    let place = Place::new("notes");
    let mut voxels = start(dimensions);
    let mut file = JournalFile::create(&place.0, HASH, &voxels).expect("a new file");
    file.note(b"names".to_vec());
    let all = voxels.grid().bounds();
    let edit = voxels
        .label_edit(SegmentId(1), &all, |_, was| !was)
        .expect("it exists");
    let inverse = voxels.apply(edit).expect("it fits");
    file.edit(Action::Do, &inverse, &voxels);
    file.end_step();
    let redo = voxels.apply(inverse).expect("it fits");
    file.edit(Action::Undo, &redo, &voxels);
    drop(file);

    let mut voxels = bare(dimensions);
    let mut reader = JournalReader::open(&place.0, HASH, &voxels).expect("a journal");
    for id in [1, 2].map(SegmentId) {
        let there = reader.next(&voxels).expect("whole");
        let Some(Entry::Put(Action::Start, put, segment)) = there else {
            panic!("{there:?} is no segment that was there");
        };
        assert_eq!(put, id);
        voxels.insert_segment(id, segment).expect("its grid");
    }
    let note = reader.next(&voxels).expect("whole");
    assert!(matches!(note, Some(Entry::Note(bytes)) if bytes == b"names"));
    let Some(Entry::Edit(Action::Do, edit)) = reader.next(&voxels).expect("whole") else {
        panic!("an edit was done");
    };
    assert_eq!(edit.dirty, all);
    voxels.apply(edit).expect("it fits");
    assert!(matches!(reader.next(&voxels), Ok(Some(Entry::StepEnd))));
    assert!(matches!(
        reader.next(&voxels),
        Ok(Some(Entry::Edit(Action::Undo, _)))
    ));
    assert!(matches!(reader.next(&voxels), Ok(None)));
}

#[test]
fn a_journal_of_another_scan_is_refused() {
    let dimensions = UVec3::new(9, 8, 10);
    let place = Place::new("other");
    written(&place, dimensions, 6, 8);

    let mut voxels = start(dimensions);
    let other_hash = recover(&place.0, ScanHash([8; 32]), &mut voxels);
    assert!(matches!(other_hash, Err(JournalError::OtherScan { .. })));
    let mut larger = start(UVec3::new(9, 8, 11));
    let other_size = recover(&place.0, HASH, &mut larger);
    assert!(matches!(other_size, Err(JournalError::OtherScan { .. })));

    fs::write(
        &place.0,
        b"a letter, and nothing else, but long enough to be a head: really",
    )
    .expect("room");
    let letter = recover(&place.0, HASH, &mut voxels);
    assert!(matches!(letter, Err(JournalError::NoJournal(_))));
    let nowhere = recover(&Place::new("nowhere").0, HASH, &mut voxels);
    assert!(matches!(nowhere, Err(JournalError::Disk { .. })));
}

#[test]
fn a_journal_begun_late_holds_what_was_there_and_needs_the_scan_alone() {
    let dimensions = UVec3::new(26, 23, 17);
    let place = Place::new("late");
    let mut session = Session::new(start(dimensions), None);
    let mut random = Random::new(21);
    for _ in 0..40 {
        session.random_step(&mut random);
    }
    assert!(!session.voxels.overlay().bricks().is_empty());
    let file = JournalFile::create(&place.0, HASH, &session.voxels).expect("a new file");
    session.file = Some(file);
    for _ in 0..20 {
        session.random_step(&mut random);
    }
    session.file = None;

    for mut voxels in [bare(dimensions), start(dimensions)] {
        recover(&place.0, HASH, &mut voxels).expect("whole");
        assert!(Dense::of(&voxels) == Dense::of(&session.voxels));
    }
}

#[test]
fn a_file_in_use_or_there_already_is_left_alone() {
    let place = Place::new("use");
    let voxels = start(UVec3::new(9, 8, 10));
    let file = JournalFile::create(&place.0, HASH, &voxels).expect("a new file");
    let second = JournalFile::create(&place.0, HASH, &voxels);
    assert!(matches!(second, Err(JournalError::Exists(_))));
    let mut same = voxels.clone();
    let found = recover(&place.0, HASH, &mut same).expect("a head");
    let second = JournalFile::resume(&place.0, &found, &voxels);
    assert!(matches!(second, Err(JournalError::InUse(_))));
    drop(file);
    JournalFile::resume(&place.0, &found, &voxels).expect("free again");
}
