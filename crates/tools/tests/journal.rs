//! The journal on disk: recovered to the bit, cut anywhere, damaged, on full and slow disks.

mod support;

use std::fs;
use std::io;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_tools::journal_entry::{Action, Entry, Facts, ScanHash};
use palpate_tools::journal_error::JournalError;
use palpate_tools::journal_file::{JournalFile, Storage};
use palpate_tools::journal_reader::{JournalReader, Recovery, recover};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;
use support::session::{Change, Session};
use support::{Dense, Random, oblique_grid, scan};

const HASH: ScanHash = ScanHash([7; 32]);

/// A path that nothing is at, in the system's own folder for such; removed at the end.
struct Place(PathBuf);

impl Place {
    fn new(name: &str) -> Self {
        let file = format!("palpate-{name}-{}.journal", std::process::id());
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

fn start(dimensions: UVec3) -> Voxels {
    let stored = |voxel: IVec3| (voxel.x * 31 + voxel.y * 5 - voxel.z * 7) as i16;
    let solid: [&(dyn Fn(IVec3) -> bool + Sync); 2] =
        [&|voxel| voxel.z > 3, &|voxel| voxel.x % 4 < 2];
    scan(oblique_grid(dimensions), stored, &solid)
}

/// The same scan without segments.
fn bare(dimensions: UVec3) -> Voxels {
    let voxels = start(dimensions);
    Voxels::new(*voxels.grid(), voxels.intensities().clone()).expect("its own grid")
}

/// A session of random steps, written to `place` and closed.
fn written(place: &Place, dimensions: UVec3, steps: usize, seed: u128) -> Session {
    let voxels = start(dimensions);
    let file = JournalFile::create(&place.0, HASH, &voxels).expect("a new file");
    let mut session = Session::new(voxels, Some(file));
    let mut random = Random::new(seed);
    let mut done = 0;
    while done < steps {
        done += usize::from(session.random_step(&mut random));
    }
    let mut file = session.file.take().expect("it was there");
    assert_eq!(file.take_problem(), None);
    drop(file);
    session
}

/// The state after each record, by where it ends.
fn states(place: &Place, dimensions: UVec3) -> Vec<(u64, Dense, Recovery)> {
    let mut voxels = bare(dimensions);
    let mut reader = JournalReader::open(&place.0, HASH, &voxels).expect("a journal");
    let mut states = vec![(
        reader.recovery().valid_bytes,
        Dense::of(&voxels),
        reader.recovery(),
    )];
    while let Some(entry) = reader.next(&voxels).expect("whole records") {
        match entry {
            Entry::Edit(_, edit) => drop(voxels.apply(edit).expect("it fits")),
            Entry::Put(_, id, segment) => {
                drop(voxels.insert_segment(id, segment).expect("it fits"));
            }
            Entry::Remove(_, id) => drop(voxels.remove_segment(id).expect("it exists")),
            Entry::Move { .. }
            | Entry::Facts(..)
            | Entry::Together(_)
            | Entry::Note(_)
            | Entry::StepEnd => {}
        }
        states.push((
            reader.recovery().valid_bytes,
            Dense::of(&voxels),
            reader.recovery(),
        ));
    }
    states
}

#[test]
fn a_random_session_is_recovered_to_the_bit() {
    let dimensions = UVec3::new(26, 23, 17);
    for seed in 0..8 {
        let place = Place::new(&format!("random-{seed}"));
        let session = written(&place, dimensions, 60, seed);
        let mut voxels = start(dimensions);
        let found = recover(&place.0, HASH, &mut voxels).expect("whole");
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
fn cut_at_any_byte_it_gives_the_state_after_the_last_whole_record() {
    let dimensions = UVec3::new(9, 8, 10);
    let place = Place::new("cut");
    written(&place, dimensions, 12, 3);
    let (whole, states) = (
        fs::read(&place.0).expect("a file"),
        states(&place, dimensions),
    );
    assert!(
        states.len() > 15 && whole.len() > 1000,
        "{} {}",
        states.len(),
        whole.len()
    );

    let cut = Place::new("cut-off");
    for length in 0..=whole.len() {
        fs::write(&cut.0, &whole[..length]).expect("room");
        let mut voxels = start(dimensions);
        let found = recover(&cut.0, HASH, &mut voxels);
        let last = states.iter().rfind(|(end, ..)| *end <= length as u64);
        let Some((end, state, recovery)) = last else {
            assert!(matches!(found, Err(JournalError::NoJournal(_))), "{length}");
            continue;
        };
        let found = found.expect("a head");
        assert!(Dense::of(&voxels) == *state, "cut at {length}");
        assert_eq!((found.valid_bytes, found.steps), (*end, recovery.steps));
        assert_eq!(found.ignored_bytes, length as u64 - end);
    }
}

#[test]
fn a_changed_byte_ends_it_at_its_record_and_zeros_at_the_end_are_passed_over() {
    let dimensions = UVec3::new(9, 8, 10);
    let place = Place::new("flip");
    written(&place, dimensions, 6, 4);
    let (whole, states) = (
        fs::read(&place.0).expect("a file"),
        states(&place, dimensions),
    );
    let damaged = Place::new("flipped");
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        fs::write(&damaged.0, &bytes).expect("room");
        let mut voxels = start(dimensions);
        let found = recover(&damaged.0, HASH, &mut voxels);
        match states.iter().rfind(|(end, ..)| *end <= at as u64) {
            None => assert!(matches!(found, Err(JournalError::NoJournal(_))), "{at}"),
            Some((end, state, _)) => {
                assert_eq!(found.expect("a head").valid_bytes, *end, "{at}");
                assert!(Dense::of(&voxels) == *state, "{at}");
            }
        }
    }

    // what a file system may leave of a write that never came
    let mut bytes = whole.clone();
    bytes.extend([0; 100]);
    fs::write(&damaged.0, &bytes).expect("room");
    let mut voxels = start(dimensions);
    let found = recover(&damaged.0, HASH, &mut voxels).expect("a head");
    assert_eq!(
        (found.valid_bytes, found.ignored_bytes),
        (whole.len() as u64, 100)
    );
}

/// The records of a journal, one by one: kind and bytes.
fn records(whole: &[u8]) -> Vec<(u8, Vec<u8>)> {
    let mut left = &whole[60..];
    let mut records = Vec::new();
    while let Some((length, rest)) = left.split_first_chunk::<4>() {
        let end = 4 + u32::from_le_bytes(*length) as usize;
        records.push((rest[4], rest[5..end].to_vec()));
        left = &rest[end..];
    }
    records
}

/// A journal of these records whose checksums are all right.
fn journal_of(head: &[u8], records: &[(u8, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = head.to_vec();
    let mut checksum = crc32fast::hash(&head[..56]);
    for (kind, body) in records {
        let mut hasher = crc32fast::Hasher::new_with_initial(checksum);
        hasher.update(&[*kind]);
        hasher.update(body);
        checksum = hasher.finalize();
        bytes.extend((body.len() as u32 + 1).to_le_bytes());
        bytes.extend(checksum.to_le_bytes());
        bytes.push(*kind);
        bytes.extend(body);
    }
    bytes
}

/// The same head for another version, with its own checksum.
fn head_of_version(head: &[u8], version: u32) -> Vec<u8> {
    let mut head = head.to_vec();
    head[8..12].copy_from_slice(&version.to_le_bytes());
    let checksum = crc32fast::hash(&head[..56]);
    head[56..].copy_from_slice(&checksum.to_le_bytes());
    head
}

/// Version 1 had these records already: edits, segments, notes and ends of steps.
#[test]
fn a_journal_of_version_1_is_read_and_gone_on_with_and_unknown_versions_are_refused() {
    let dimensions = UVec3::new(9, 8, 10);
    let place = Place::new("version");
    let session = written(&place, dimensions, 12, 21);
    let whole = fs::read(&place.0).expect("a file");
    let records = records(&whole);
    assert!(records.iter().all(|(kind, _)| *kind <= 5));
    let of_version = |version| journal_of(&head_of_version(&whole[..60], version), &records);

    fs::write(&place.0, of_version(1)).expect("room");
    let mut voxels = start(dimensions);
    let found = recover(&place.0, HASH, &mut voxels).expect("whole");
    assert_eq!((found.steps, found.ignored_bytes), (12, 0));
    assert!(Dense::of(&voxels) == Dense::of(&session.voxels));
    let mut file = JournalFile::resume(&place.0, &found, &voxels).expect("its end");
    file.facts(SegmentId(1), Facts::default());
    drop(file);
    let found = recover(&place.0, HASH, &mut voxels).expect("whole");
    assert_eq!((found.steps, found.ignored_bytes), (12, 0));

    for version in [0, 3, 1 << 30] {
        fs::write(&place.0, of_version(version)).expect("room");
        let refused = recover(&place.0, HASH, &mut voxels).expect_err("unknown");
        let told = format!("journal of version {version} given; allowed: 1 to 2");
        assert_eq!(refused.to_string(), told);
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
fn whole_records_that_lie_are_refused_without_harm() {
    let dimensions = UVec3::new(9, 8, 10);
    let place = Place::new("lie");
    written(&place, dimensions, 12, 11);
    let whole = fs::read(&place.0).expect("a file");
    let records = records(&whole);
    assert_eq!(journal_of(&whole[..60], &records), whole);

    let mut random = Random::new(12);
    let (mut refused, mut taken) = (0, 0);
    for _ in 0..3000 {
        let mut lying = records.clone();
        let which = random.integer(0, lying.len() as i64) as usize;
        let (kind, body) = &mut lying[which];
        let is_packed = *kind <= 2;
        let mut raw = if is_packed {
            lz4_flex::block::decompress_size_prepended(body).expect("packed")
        } else {
            body.clone()
        };
        for _ in 0..random.integer(1, 4) {
            if raw.is_empty() || random.chance(0.1) {
                raw.push(random.integer(0, 256) as u8);
            } else if random.chance(0.1) {
                raw.pop();
            } else {
                // most fields stand in front
                let end = if random.chance(0.5) {
                    raw.len().min(20)
                } else {
                    raw.len()
                };
                let at = random.integer(0, end as i64) as usize;
                raw[at] = random.integer(0, 256) as u8;
            }
        }
        if random.chance(0.1) {
            *kind = random.integer(0, 256) as u8;
        }
        *body = if is_packed {
            lz4_flex::block::compress_prepend_size(&raw)
        } else {
            raw
        };
        if random.chance(0.1) && body.len() > 4 {
            // a size that it does not have
            body[3] = 0x7f;
        }

        fs::write(&place.0, journal_of(&whole[..60], &lying)).expect("room");
        let mut voxels = start(dimensions);
        let before = Dense::of(&voxels);
        if recover(&place.0, HASH, &mut voxels).is_err() {
            refused += 1;
            assert!(Dense::of(&voxels) == before);
        } else {
            taken += 1;
            // bits beyond the border would be counted
            for (_, segment) in voxels.segments() {
                let solid = segment.mask().iter().filter(|&&byte| byte != 0).count();
                assert_eq!(segment.count(), solid as u64);
            }
        }
    }
    assert!(
        refused > 500 && taken > 10,
        "{refused} refused, {taken} taken"
    );
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

    let mut voxels = start(dimensions);
    let found = recover(&place.0, HASH, &mut voxels).expect("a head");
    assert!(found.ignored_bytes > 0);
    let file = JournalFile::resume(&place.0, &found, &voxels).expect("it goes on");
    let mut session = Session::new(voxels, Some(file));
    let mut random = Random::new(6);
    while !session.random_step(&mut random) {}
    session.file = None;

    let mut again = start(dimensions);
    let found = recover(&place.0, HASH, &mut again).expect("whole");
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

/// A disk with so much room.
struct Small {
    written: Arc<Mutex<Vec<u8>>>,
    room: usize,
}

impl Write for Small {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut written = self.written.lock().expect("no panic");
        let taken = bytes.len().min(self.room - written.len());
        written.extend(&bytes[..taken]);
        if taken == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Storage for Small {
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Waits for what another thread tells; a minute is for a machine that does much else.
fn wait_for<T>(mut asked: impl FnMut() -> Option<T>) -> T {
    let until = Instant::now() + Duration::from_secs(60);
    loop {
        if let Some(found) = asked() {
            return found;
        }
        assert!(Instant::now() < until, "waited in vain");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_full_disk_is_told_of_once_and_the_session_goes_on() {
    let dimensions = UVec3::new(26, 23, 17);
    let voxels = start(dimensions);
    let written = Arc::new(Mutex::new(Vec::new()));
    let disk = Small {
        written: Arc::clone(&written),
        room: 4000,
    };
    let file = JournalFile::begin(disk, HASH, &voxels).expect("room for the head");
    let mut session = Session::new(voxels, Some(file));
    let mut random = Random::new(9);
    let problem = wait_for(|| {
        session.random_step(&mut random);
        session.file.as_mut().expect("it is there").take_problem()
    });
    assert!(problem.contains("cannot be written"), "{problem}");
    for _ in 0..20 {
        session.random_step(&mut random);
        assert_eq!(
            session.file.as_mut().expect("it is there").take_problem(),
            None
        );
    }
    drop(session);

    let place = Place::new("full");
    fs::write(&place.0, &*written.lock().expect("no panic")).expect("room");
    let mut voxels = start(dimensions);
    let found = recover(&place.0, HASH, &mut voxels).expect("a head");
    assert!(found.steps > 0 && found.valid_bytes <= 4000, "{found:?}");
}

/// A disk that takes nothing more until it is told to.
struct Stuck {
    go_on: Receiver<()>,
    head: bool,
}

impl Write for Stuck {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.head {
            self.head = false;
        } else {
            // an end of waiting, too, when the test is over
            let _ = self.go_on.recv();
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Storage for Stuck {
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_disk_that_hangs_never_makes_the_session_wait_and_is_told_of_once() {
    let voxels = start(UVec3::new(9, 8, 10));
    let (release, go_on) = channel();
    let disk = Stuck { go_on, head: true };
    let mut file = JournalFile::begin(disk, HASH, &voxels).expect("a head");
    // were one of them to wait for the disk, it would wait for ever
    for _ in 0..5000 {
        file.end_step();
    }
    let problem = file.take_problem().expect("it is told");
    assert!(problem.contains("too slow"), "{problem}");
    assert_eq!(file.take_problem(), None);
    file.end_step();
    drop(release);
}

/// Where a child process is to write, if this is one.
const CHILD: &str = "PALPATE_JOURNAL_CHILD";
const CHILD_DIMENSIONS: UVec3 = UVec3::new(64, 64, 64);

/// Frees one voxel after the other until somebody ends the process; a test only by name.
#[test]
fn a_child_writes_until_it_is_killed() {
    let Some(path) = std::env::var_os(CHILD) else {
        return;
    };
    let voxels = start(CHILD_DIMENSIONS);
    let file = JournalFile::create(&PathBuf::from(path), HASH, &voxels).expect("a new file");
    let mut session = Session::new(voxels, Some(file));
    for voxel in session.voxels.grid().bounds().voxels() {
        let here = VoxelBox::of_voxel(voxel);
        let edit = session
            .voxels
            .label_edit(SegmentId(1), &here, |_, was| !was)
            .expect("it exists");
        session.change(Change::Edit(edit));
        std::thread::sleep(Duration::from_micros(100));
    }
}

#[test]
fn a_killed_process_loses_nothing_that_it_has_written() {
    let place = Place::new("killed");
    let mut child = Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "a_child_writes_until_it_is_killed"])
        .env(CHILD, &place.0)
        .stdout(Stdio::null())
        .spawn()
        .expect("a child");
    let length = || fs::metadata(&place.0).map_or(0, |file| file.len());
    let seen = wait_for(|| (length() > 20_000).then(length));
    child.kill().expect("it runs");
    child.wait().expect("it ends");

    let mut voxels = start(CHILD_DIMENSIONS);
    let before = start(CHILD_DIMENSIONS);
    let found = recover(&place.0, HASH, &mut voxels).expect("a head");
    // at most the record that was being written is not whole
    assert!(
        found.valid_bytes + 200 > seen && found.ignored_bytes < 200,
        "{found:?}"
    );
    let edits = found.steps + usize::from(found.step_is_open);
    for (place, voxel) in voxels.grid().bounds().voxels().enumerate() {
        let [was, is] = [&before, &voxels].map(|voxels| {
            voxels
                .segment(SegmentId(1))
                .expect("it exists")
                .contains(voxel)
        });
        assert_eq!(was != is, place < edits, "{place} of {edits}");
    }
}
