//! Random strokes of all tools, undone and redone, beside a list of states.

use crate::support::session::Session;
use crate::support::{Dense, Random, oblique_grid, scan};
use glam::UVec3;
use palpate_tools::stroke::{Stroke, bytes_of};
use palpate_volume::edit::{Edit, EditKind};

#[test]
fn undo_and_redo_of_random_steps_are_those_of_a_list_of_states() {
    for seed in 0..12 {
        let mut random = Random::new(seed);
        let grid = oblique_grid(UVec3::new(26, 23, 17));
        let stored = |voxel: glam::IVec3| (voxel.x * 31 + voxel.z * 7) as i16;
        let voxels = scan(
            grid,
            stored,
            &[&|voxel| voxel.z > 5, &|voxel| voxel.x % 4 < 2],
        );
        let mut session = Session::new(voxels, None);
        // the naive journal: every state in full, and which one is shown
        let mut states = vec![Dense::of(&session.voxels)];
        let mut shown = 0;

        for _ in 0..120 {
            match random.integer(0, 4) {
                0 => {
                    let undone = session.undo();
                    assert_eq!(undone, shown > 0);
                    shown -= usize::from(undone);
                }
                1 => {
                    let redone = session.redo();
                    assert_eq!(redone, shown + 1 < states.len());
                    shown += usize::from(redone);
                }
                _ => {
                    if session.random_stroke(&mut random) {
                        states.truncate(shown + 1);
                        states.push(Dense::of(&session.voxels));
                        shown += 1;
                    }
                }
            }
            assert_eq!(Dense::of(&session.voxels), states[shown], "seed {seed}");
            assert_eq!(session.undo.can_undo(), shown > 0);
            assert_eq!(session.undo.can_redo(), shown + 1 < states.len());
        }
        while session.undo() {}
        assert_eq!(Dense::of(&session.voxels), states[0]);
        assert!(states.len() > 10, "{} states", states.len());
    }
}

#[test]
fn the_box_of_a_strokes_inverse_holds_all_that_differs() {
    let mut random = Random::new(77);
    let grid = oblique_grid(UVec3::new(26, 23, 17));
    let voxels = scan(grid, |_| 900, &[&|voxel| voxel.z > 3]);
    let mut session = Session::new(voxels, None);
    for _ in 0..30 {
        let before = Dense::of(&session.voxels);
        if !session.random_stroke(&mut random) {
            continue;
        }
        let after = Dense::of(&session.voxels);
        let Some(crate::support::session::Change::Edit(inverse)) = session.undo.newest() else {
            panic!("a stroke is undone by an edit");
        };
        for (place, voxel) in grid.bounds().voxels().enumerate() {
            let differs = before.stored[place] != after.stored[place]
                || before
                    .masks
                    .iter()
                    .any(|(id, mask)| mask[place] != after.masks[id][place]);
            assert!(
                !differs || inverse.dirty.contains(voxel),
                "{voxel} {:?}",
                inverse.dirty
            );
        }
        assert!(bytes_of(inverse) > 0);
    }
}

#[test]
fn an_empty_stroke_is_told_and_a_matter_edit_makes_a_matter_stroke() {
    let mut stroke = Stroke::default();
    stroke.add(Edit::empty(EditKind::Label));
    assert!(stroke.is_empty());
    assert_eq!(stroke.clone().into_inverse().kind, EditKind::Label);

    let grid = oblique_grid(UVec3::splat(9));
    let mut voxels = scan(grid, |_| 900, &[&crate::support::everywhere]);
    let edit = voxels.voxel_edit(&grid.bounds(), |voxel, mut was| {
        was.stored = voxel.x as i16;
        was
    });
    stroke.add(voxels.apply(edit).expect("it fits"));
    let inverse = stroke.into_inverse();
    assert_eq!((inverse.kind, inverse.segments.len()), (EditKind::Voxel, 0));
    assert_eq!(inverse.dirty, grid.bounds());
}
