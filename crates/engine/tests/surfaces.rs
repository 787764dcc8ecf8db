//! Surfaces and voxels that are told to the picture follow every change of the scene.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use std::collections::BTreeMap;
use std::sync::Arc;

use common::*;
use glam::{IVec3, UVec3};
use palpate_engine::packed_patch::PackedPatch;
use palpate_engine::session::Session;
use palpate_engine::session_config::Reference;
use palpate_engine::surfaces::PictureChange;
use palpate_surface::{PatchId, SurfaceSettings};
use palpate_volume::edit::SegmentId;
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
        .show_surface(ID, Some(SurfaceSettings::default()))
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
        .show_surface(ID, Some(SurfaceSettings::default()))
        .unwrap();
    session.run(0.05).unwrap();
    // the first call begins to watch
    assert!(session.picture_changes().is_empty());
    assert!(!session.whole_surfaces().surfaces.is_empty());
}

#[test]
fn settings_that_make_no_surface_and_segments_that_are_none_are_refused() {
    let session = session();
    let coarse = SurfaceSettings {
        step: 3,
        ..SurfaceSettings::default()
    };
    let refused = session.show_surface(ID, Some(coarse)).unwrap_err();
    assert!(
        refused.to_string().contains("allowed: 1, 2 or 4"),
        "{refused}"
    );
    let refused = session.show_surface(SegmentId(9), None).unwrap_err();
    assert!(refused.to_string().contains("segment 9 given"), "{refused}");
}
