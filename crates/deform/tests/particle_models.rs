//! The thesis' local models as models: pressing, giving back, edits of others.

use crate::liver::{H, TOP, advance, ball, force, models, picture, scan};
use glam::{DVec3, IVec3};
use palpate_deform::model::{Budget, DeformationModel, ModelInput};
use palpate_deform::particles::{LocalModel, LocalSettings};
use palpate_deform::registry::model_from_name;
use palpate_volume::edit::SegmentId;
use palpate_volume::voxel_box::VoxelBox;

#[test]
fn the_models_stand_under_their_names() {
    for name in ["fcc-lj", "cuboid-lj"] {
        assert!(model_from_name(name).is_ok(), "{name}");
    }
}

#[test]
fn a_pressed_block_pushes_back_harder_the_deeper_the_tool() {
    for (name, mut model) in models() {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        let (mut last, mut told) = (0.0, 0.0);
        for step in 0..=6 {
            let tool = ball(&voxels, -0.1 + 0.1 * f64::from(step));
            let answer = advance(&mut *model, &mut voxels, &materials, &[tool], 200);
            let force = force(&answer);
            if step == 0 {
                // particles' shells end half a link above their centres, 0.1 voxel over the face
                assert!(force.length() < 1e-9, "{name}: touched in the air");
            }
            assert!(
                force.z >= last,
                "{name}: weaker at step {step}: {} {last}",
                force.z
            );
            // along the normal: the block is symmetric, the lattice not quite
            assert!(
                force.truncate().length() <= 0.1 * force.z + 1e-9,
                "{name}: {force}"
            );
            if step == 6 {
                // the stiffness that the servo is told, against the step that follows
                let ratio = (force.z - last) / (told * 0.1 * H);
                assert!(
                    ratio > 0.4 && ratio < 2.5,
                    "{name}: stiffness off by {ratio}"
                );
            }
            let contact = answer.contacts[0].contact;
            told = contact.map_or(0.0, |contact| -contact.stiffness.z_axis.z);
            last = force.z;
        }
        // Hertz for 5.5 kPa and nu 0.36, a ball of 1.6 mm 0.48 mm deep: 4/3 E* sqrt(R d³) =
        // 3.5 mN; particles are as large as the dent, so only the order of it
        println!("{name}: {:.2} mN half a voxel deep", last * 1e3);
        assert!(last > 1.5e-3 && last < 10e-3, "{name}: {last} N");
    }
}

#[test]
fn matter_that_nobody_touches_shows_no_displacement() {
    for (name, mut model) in models() {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        let tool = ball(&voxels, -0.5);
        let answer = advance(&mut *model, &mut voxels, &materials, &[tool], 300);
        assert!(
            answer.edit.is_none() && answer.displacement.is_none(),
            "{name}"
        );
        let tool = ball(&voxels, 0.5);
        let answer = advance(&mut *model, &mut voxels, &materials, &[tool], 300);
        let field = answer.displacement.unwrap();
        // a dent of half a voxel, shown as that before any voxel has changed
        let deepest = field.moved.iter().map(|moved| -moved.z).fold(0.0, f32::max);
        let deepest = f64::from(deepest) / H;
        assert!(deepest > 0.3 && deepest < 0.8, "{name}: {deepest} voxels");
    }
}

#[test]
fn what_was_pressed_comes_back_when_the_tool_leaves_to_the_bit() {
    for (name, mut model) in models() {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        let untouched = picture(&voxels);
        let mut changed = 0;
        for step in 0..=8 {
            let tool = ball(&voxels, 0.2 * f64::from(step));
            advance(&mut *model, &mut voxels, &materials, &[tool], 100);
            let differ = |(a, b): &(&(i16, bool), &(i16, bool))| a != b;
            changed = picture(&voxels)
                .iter()
                .zip(&untouched)
                .filter(differ)
                .count();
        }
        assert!(changed > 4, "{name}: pressing changed {changed} voxels");
        // voxels that tissue left read air, and are in no segment
        let empty = picture(&voxels)
            .iter()
            .zip(&untouched)
            .filter(|(now, then)| then.1 && !now.1)
            .count();
        assert!(empty > 0, "{name}: nothing gave way");

        // the tool goes up, tissue follows, then the tool leaves
        let away = ball(&voxels, -8.0);
        for _ in 0..3 {
            advance(&mut *model, &mut voxels, &materials, &[away], 100);
        }
        let left = picture(&voxels)
            .iter()
            .zip(&untouched)
            .filter(|(a, b)| a != b)
            .count();
        assert_eq!(left, 0, "{name}: {left} voxels did not come back");
    }
}

#[test]
fn the_scans_own_values_are_never_overwritten_and_undo_restores_all() {
    let (mut voxels, materials) = scan(DVec3::splat(H));
    let (untouched, own) = (picture(&voxels), voxels.intensities().values().clone());
    let mut model = LocalModel::fcc_lj(LocalSettings {
        box_cells: 11,
        ..Default::default()
    });
    let mut inverses = Vec::new();
    for step in 0..=8 {
        let tools = [ball(&voxels, 0.2 * f64::from(step))];
        let budget = Budget::iterations(60);
        let input = ModelInput {
            voxels: &voxels,
            materials: &materials,
            tools: &tools,
            dt: 0.03,
            budget,
        };
        if let Some(edit) = model.advance(&input).edit {
            inverses.push(voxels.apply(edit).unwrap());
        }
    }
    assert!(!inverses.is_empty());
    assert_eq!(voxels.intensities().values(), &own);
    while let Some(inverse) = inverses.pop() {
        voxels.apply(inverse).unwrap();
    }
    assert!(picture(&voxels) == untouched);
}

#[test]
fn the_same_calls_give_the_same_answers_to_the_bit() {
    for index in 0..models().len() {
        let run = || {
            let (mut voxels, materials) = scan(DVec3::splat(H));
            let mut model = models().swap_remove(index).1;
            let mut answers = Vec::new();
            for step in 0..=4 {
                let tool = ball(&voxels, 0.3 * f64::from(step));
                let answer = advance(&mut *model, &mut voxels, &materials, &[tool], 40);
                answers.push((answer.contacts, answer.displacement, answer.report));
            }
            (answers, picture(&voxels))
        };
        assert!(run() == run());
    }
}

#[test]
fn matter_that_a_drill_takes_away_does_not_come_back() {
    for (name, mut model) in models() {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        for step in 0..=5 {
            let tool = ball(&voxels, 0.2 * f64::from(step));
            advance(&mut *model, &mut voxels, &materials, &[tool], 60);
        }
        // a hole beside the tool, made by somebody else
        let hole = VoxelBox::new(IVec3::new(17, 13, TOP - 2), IVec3::new(19, 17, TOP));
        let empty = palpate_volume::voxel_state::VoxelState {
            stored: -1000,
            segments: Default::default(),
        };
        let edit = voxels.voxel_edit(&hole, |_, _| empty);
        voxels.apply(edit).unwrap();
        let away = ball(&voxels, -8.0);
        for _ in 0..3 {
            advance(&mut *model, &mut voxels, &materials, &[away], 100);
        }
        let segment = voxels.segment(SegmentId(1)).unwrap();
        let back = hole.voxels().filter(|v| segment.contains(*v)).count();
        assert!(
            back == 0,
            "{name}: {back} of 16 drilled voxels are solid again"
        );
        assert!(
            segment.contains(IVec3::new(15, 15, TOP - 1)),
            "{name}: matter under the tool is lost"
        );
    }
}
