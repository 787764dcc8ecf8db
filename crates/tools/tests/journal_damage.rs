//! Journals that were cut, changed, or lie; and those of other versions.

use std::fs;

use crate::support::journal::{HASH, recovered, start, states, written};
use crate::support::place::Place;
use crate::support::{Dense, Random};
use glam::UVec3;
use palpate_tools::journal::{Facts, JournalError, JournalFile, recover};
use palpate_volume::edit::SegmentId;

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
    let (_, found) = recovered(&damaged, dimensions);
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
    let (mut voxels, found) = recovered(&place, dimensions);
    assert_eq!((found.steps, found.ignored_bytes), (12, 0));
    assert!(Dense::of(&voxels) == Dense::of(&session.voxels));
    let mut file = JournalFile::resume(&place.0, &found, &voxels).expect("its end");
    file.facts(SegmentId(1), Facts::default());
    drop(file);
    let found = recover(&place.0, HASH, &mut voxels).expect("whole");
    assert_eq!((found.steps, found.ignored_bytes), (12, 0));

    for version in [0, 4, 1 << 30] {
        fs::write(&place.0, of_version(version)).expect("room");
        let refused = recover(&place.0, HASH, &mut voxels).expect_err("unknown");
        let told = format!("journal of version {version} given; allowed: 1 to 3");
        assert_eq!(refused.to_string(), told);
    }
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
