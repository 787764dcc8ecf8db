//! Journals that tests write and read.

use glam::{IVec3, UVec3};
use palpate_tools::journal::{Entry, JournalFile, JournalReader, Recovery, ScanHash, recover};
use palpate_volume::voxels::Voxels;

use super::place::Place;
use super::session::Session;
use super::{Dense, Random, oblique_grid, scan};

pub const HASH: ScanHash = ScanHash([7; 32]);

pub fn start(dimensions: UVec3) -> Voxels {
    let stored = |voxel: IVec3| (voxel.x * 31 + voxel.y * 5 - voxel.z * 7) as i16;
    let solid: [&(dyn Fn(IVec3) -> bool + Sync); 2] =
        [&|voxel| voxel.z > 3, &|voxel| voxel.x % 4 < 2];
    scan(oblique_grid(dimensions), stored, &solid)
}

/// The same scan without segments.
pub fn bare(dimensions: UVec3) -> Voxels {
    let voxels = start(dimensions);
    Voxels::new(*voxels.grid(), voxels.intensities().clone()).expect("its own grid")
}

/// A session of random steps, written to `place` and closed.
pub fn written(place: &Place, dimensions: UVec3, steps: usize, seed: u128) -> Session {
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
pub fn states(place: &Place, dimensions: UVec3) -> Vec<(u64, Dense, Recovery)> {
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

/// What a journal makes of the scan, which it must fit.
pub fn recovered(place: &Place, dimensions: UVec3) -> (Voxels, Recovery) {
    let mut voxels = start(dimensions);
    let found = recover(&place.0, HASH, &mut voxels).expect("a head");
    (voxels, found)
}
