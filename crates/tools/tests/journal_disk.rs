//! Journals on disks that are full or hang, and of processes that are killed.

use std::fs;
use std::io;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::support::Random;
use crate::support::journal::{HASH, recovered, start};
use crate::support::place::Place;
use crate::support::session::{Change, Session};
use glam::UVec3;
use palpate_tools::journal::{JournalFile, Storage};
use palpate_volume::edit::SegmentId;
use palpate_volume::voxel_box::VoxelBox;

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
    let (_, found) = recovered(&place, dimensions);
    assert!(found.steps > 0 && found.valid_bytes <= 4000, "{found:?}");
}

/// A disk whose driver panics at the first record.
struct Broken {
    head: bool,
}

impl Write for Broken {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        assert!(self.head, "the driver is broken");
        self.head = false;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Storage for Broken {
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_writer_that_panics_is_told_of_once_also_if_nothing_changes_any_more() {
    let voxels = start(UVec3::new(26, 23, 17));
    let broken = Broken { head: true };
    let mut file = JournalFile::begin(broken, HASH, &voxels).expect("room for the head");
    file.note(b"name".to_vec());
    let problem = wait_for(|| file.take_problem());
    assert!(problem.contains("has failed"), "{problem}");
    file.note(b"another".to_vec());
    assert_eq!(file.take_problem(), None);
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
        .args(["--exact", "journal_disk::a_child_writes_until_it_is_killed"])
        .env(CHILD, &place.0)
        .stdout(Stdio::null())
        .spawn()
        .expect("a child");
    let length = || fs::metadata(&place.0).map_or(0, |file| file.len());
    let seen = wait_for(|| (length() > 20_000).then(length));
    child.kill().expect("it runs");
    child.wait().expect("it ends");

    let before = start(CHILD_DIMENSIONS);
    let (voxels, found) = recovered(&place, CHILD_DIMENSIONS);
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
