//! Surfaces and voxels that are told to the picture follow every change of the scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::picture::{PackedPatch, PictureChange};
use palpate_engine::scene::{Properties, SurfaceOptions, SurfaceSource};
use palpate_engine::session::{Reference, Session, SessionConfig};
use palpate_surface::PatchId;
use palpate_volume::edit::SegmentId;
use palpate_volume::intensities::Intensities;
use palpate_volume::threshold::threshold;
use palpate_volume::voxel_box::VoxelBox;

const DIMENSIONS: UVec3 = UVec3::splat(48);
const ID: SegmentId = SegmentId(1);

fn session() -> Session {
    let block = box_segment(DIMENSIONS, IVec3::splat(8), IVec3::splat(40));
    started(offline(DIMENSIONS, block, simulated(), Reference::View))
}

type Patches = BTreeMap<PatchId, Arc<PackedPatch>>;

/// What a page holds that was told these changes.
fn follow(patches: &mut Patches, changes: &[PictureChange]) {
    for change in changes.iter().filter_map(|change| change.surfaces.get(&ID)) {
        if change.whole {
            patches.clear();
        }
        change.dropped.iter().for_each(|id| {
            patches.remove(id).unwrap();
        });
        patches.extend(change.patches.iter().cloned());
    }
}

/// Lets the loops see what was asked for; gives what they tell.
fn told(session: &Session) -> Vec<PictureChange> {
    session.run(0.05).unwrap();
    session.picture_changes()
}

fn shown(session: &Session, patches: &mut Patches) {
    assert!(session.picture_changes().is_empty());
    session
        .show_surface(ID, Some(SurfaceOptions::default()))
        .unwrap();
    follow(patches, &told(session));
    assert!(!patches.is_empty());
}

#[test]
fn a_page_that_follows_edits_undo_and_bulk_changes_holds_what_a_new_page_is_told() {
    let session = session();
    let mut patches = Patches::new();
    shown(&session, &mut patches);

    let low = IVec3::splat(3);
    let changes: [&dyn Fn(); 5] = [
        &|| session.fill_box(ID, low, low + 9, true).unwrap(),
        &|| session.fill_box(ID, low + 2, low + 30, false).unwrap(),
        &|| assert!(session.undo().unwrap()),
        &|| {
            session
                .replace_segment(ID, sponge(DIMENSIONS, 7, 3), None)
                .unwrap()
        },
        &|| assert!(session.undo().unwrap()),
    ];
    for change in changes {
        let before = patches.clone();
        change();
        follow(&mut patches, &told(&session));
        assert!(patches != before);
        let mut anew = Patches::new();
        follow(&mut anew, &[session.whole_surfaces()]);
        assert!(patches == anew);
    }
}

#[test]
fn a_surface_that_is_shown_no_more_is_dropped_and_a_removed_segment_has_none() {
    let session = session();
    let mut patches = Patches::new();
    shown(&session, &mut patches);
    session.show_surface(ID, None).unwrap();
    follow(&mut patches, &told(&session));
    assert!(patches.is_empty());

    shown(&session, &mut patches);
    session.remove_segment(ID).unwrap();
    follow(&mut patches, &told(&session));
    assert!(patches.is_empty());
    assert!(session.whole_surfaces().surfaces.is_empty());

    // undo brings it back as it was shown
    assert!(session.undo().unwrap());
    follow(&mut patches, &told(&session));
    assert!(!patches.is_empty());
}

#[test]
fn an_edit_tells_the_labels_of_its_box_and_a_bulk_change_asks_for_all_anew() {
    let session = session();
    assert!(session.picture_changes().is_empty());
    session.set_labelled(vec![ID]).unwrap();
    let (low, high) = (IVec3::new(2, 3, 4), IVec3::new(7, 5, 6));
    // whatever was there, the edit reaches from corner to corner
    session.fill_box(ID, low, high, false).unwrap();
    let _ = told(&session);
    let version = session.frame().voxels_version;

    session.fill_box(ID, low, high, true).unwrap();
    let changes = told(&session);
    let [change] = &changes[..] else {
        panic!("{changes:?}");
    };
    let [voxels] = &change.voxels[..] else {
        panic!("{change:?}");
    };
    assert_eq!(change.edit, session.frame().edit);
    assert_eq!(voxels.region, VoxelBox::new(low, high));
    assert_eq!(voxels.labels, Some(vec![1; 5 * 2 * 2]));
    assert_eq!(voxels.stored, None);
    assert_eq!(session.frame().voxels_version, version);

    session
        .replace_segment(ID, sponge(DIMENSIONS, 7, 3), None)
        .unwrap();
    assert!(told(&session).is_empty());
    assert_eq!(session.frame().voxels_version, version + 1);
}

#[test]
fn nothing_is_kept_for_a_picture_that_nobody_looks_at() {
    let session = session();
    session
        .show_surface(ID, Some(SurfaceOptions::default()))
        .unwrap();
    session.run(0.05).unwrap();
    // the first call begins to watch
    assert!(session.picture_changes().is_empty());
    assert!(!session.whole_surfaces().surfaces.is_empty());
}

#[test]
fn settings_that_make_no_surface_and_segments_that_are_none_are_refused() {
    let session = session();
    let coarse = SurfaceOptions::new(3, 3, SurfaceSource::default());
    let refused = session.show_surface(ID, Some(coarse)).unwrap_err();
    assert!(
        refused.to_string().contains("allowed: 1, 2 or 4"),
        "{refused}"
    );
    let refused = session.show_surface(SegmentId(9), None).unwrap_err();
    assert!(refused.to_string().contains("segment 9 given"), "{refused}");
}

/// A scan whose values fall from the middle of a ball outward, 100 a voxel, 0 at 15 voxels.
fn ball_scan() -> Intensities {
    let values: Vec<i16> = VoxelBox::of_dimensions(DIMENSIONS)
        .voxels()
        .map(|voxel| {
            let distance = (voxel.as_dvec3() + 0.5).distance(DVec3::splat(24.2));
            (100.0 * (15.0 - distance)) as i16
        })
        .collect();
    Intensities::new(DIMENSIONS, values, 1.0, 0.0).unwrap()
}

const RANGE: (f64, f64) = (0.0, 3000.0);

/// A session whose segment a threshold on that scan made.
fn session_of_threshold() -> Session {
    let segment = threshold(&ball_scan(), None, RANGE.0, RANGE.1);
    let config = offline(DIMENSIONS, segment.clone(), simulated(), Reference::View);
    started(SessionConfig {
        intensities: ball_scan(),
        segments: vec![(segment, Properties::of_threshold(true, Some(RANGE)))],
        ..config
    })
}

/// Bytes of all positions, by patch.
fn positions(session: &Session) -> BTreeMap<PatchId, Arc<PackedPatch>> {
    let whole = session.whole_surfaces();
    whole.surfaces[&ID].patches.iter().cloned().collect()
}

/// The surface as it is made from nothing.
fn afresh(session: &Session, source: SurfaceSource) -> Patches {
    let options = SurfaceOptions::new(2, 1, source);
    session.show_surface(ID, Some(options)).unwrap();
    session.run(0.05).unwrap();
    positions(session)
}

#[test]
fn a_surface_from_intensities_follows_threshold_edits_and_undo_as_a_fresh_one() {
    let session = session_of_threshold();
    let first = afresh(&session, SurfaceSource::Intensities);
    let of_bits = afresh(&session, SurfaceSource::Bits);
    assert!(first != of_bits);
    assert!(first == afresh(&session, SurfaceSource::Intensities));

    let (low, high) = (IVec3::new(20, 20, 8), IVec3::new(28, 28, 20));
    let changes: [&dyn Fn(); 5] = [
        // by a tenth of a voxel: hardly a bit is another one, but all vertices are
        &|| _ = session.threshold(Some(ID), (10.0, 3000.0)).unwrap(),
        &|| session.fill_box(ID, low, high, false).unwrap(),
        &|| session.fill_box(ID, low - 16, low, true).unwrap(),
        &|| assert!(session.undo().unwrap()),
        &|| {
            let mask = sponge(DIMENSIONS, 7, 3);
            session.replace_segment(ID, mask, None).unwrap();
        },
    ];
    let mut before = first.clone();
    for change in changes {
        change();
        session.run(0.05).unwrap();
        let followed = positions(&session);
        assert!(followed != before);
        before = followed;
        assert!(before == afresh(&session, SurfaceSource::Intensities));
    }
    // a mask has no values of its own
    assert!(before == afresh(&session, SurfaceSource::Bits));

    while session.undo().unwrap() {}
    session.run(0.05).unwrap();
    let _ = afresh(&session, SurfaceSource::Intensities);
    assert!(positions(&session) == first);
}

#[test]
fn surfaces_that_follow_every_fourth_frame_tell_the_same_in_fewer_changes() {
    let edits = 16;
    let told_at = |every: u32| {
        let session = session();
        let mut patches = Patches::new();
        shown(&session, &mut patches);
        session.follow_edits(every);
        let mut changes = Vec::new();
        for edit in 0..edits {
            let low = IVec3::splat(8 + edit);
            session.fill_box(ID, low, low + 4, false).unwrap();
            // a frame of the picture
            session.run(1.0 / 60.0).unwrap();
            changes.extend(session.picture_changes());
        }
        session.run(0.1).unwrap();
        changes.extend(session.picture_changes());
        follow(&mut patches, &changes);
        assert_eq!(changes.last().unwrap().edit, session.frame().edit);
        (changes.len(), patches)
    };
    let (each, followed) = told_at(1);
    let (fourth, same) = told_at(4);
    // ticks and frames do not divide: one frame may hold two edits, and one none
    assert!(each >= 14 && (4..=5).contains(&fourth), "{each}, {fourth}");
    assert!(followed == same);
}
