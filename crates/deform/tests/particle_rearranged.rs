//! Particles that a tool has pushed aside stay there: thesis 5.28.3.

use crate::liver::{H, TOP, advance, ball, scan};
use glam::{DVec3, IVec3};
use palpate_deform::material::Materials;
use palpate_deform::model::{DeformationModel, ModelAnswer};
use palpate_deform::particles::{FadedLaw, LocalModel, LocalSettings};
use palpate_volume::edit::SegmentId;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

const TISSUE: SegmentId = SegmentId(1);

fn rearranging() -> LocalModel<FadedLaw> {
    LocalModel::fcc_lj(LocalSettings {
        box_cells: 15,
        rearranges: true,
        ..LocalSettings::default()
    })
}

fn held(voxels: &Voxels) -> Vec<IVec3> {
    let segment = voxels.segment(TISSUE).expect("the scan has one");
    let all = VoxelBox::of_dimensions(segment.dimensions());
    all.voxels()
        .filter(|voxel| segment.contains(*voxel))
        .collect()
}

/// Presses a ball so deep [voxels] and takes it away again, until all is at rest; the last answer.
fn press(
    model: &mut LocalModel<FadedLaw>,
    voxels: &mut Voxels,
    materials: &Materials,
    deepest: i32,
) -> ModelAnswer {
    let all = held(voxels).len();
    for step in (0..=5 * deepest).chain((-10..5 * deepest).rev()) {
        let tool = ball(voxels, 0.2 * f64::from(step));
        advance(model, voxels, materials, &[tool], 60);
        // the box follows once, and takes nothing with it; what is squeezed for a moment comes back
        let now = held(voxels).len();
        assert!(
            now <= all && now + 30 > all,
            "{now} of {all} at step {step}"
        );
    }
    let away = ball(voxels, -8.0);
    let mut answer = ModelAnswer::default();
    for _ in 0..40 {
        answer = advance(model, voxels, materials, &[away], 60);
        if !answer.report.comes_back() {
            break;
        }
    }
    answer
}

#[test]
fn what_a_tool_has_pressed_in_stands_at_the_rim_of_its_hole() {
    let (mut voxels, materials) = scan(DVec3::splat(H));
    let before = held(&voxels);
    let mut model = rearranging();
    let answer = press(&mut model, &mut voxels, &materials, 4);
    let after = held(&voxels);
    assert_eq!(after.len(), before.len());
    let gone: Vec<_> = before
        .iter()
        .filter(|voxel| !after.contains(voxel))
        .collect();
    let come: Vec<_> = after
        .iter()
        .filter(|voxel| !before.contains(voxel))
        .collect();
    // a ball of two voxels four deep takes the place of some forty
    assert!(gone.len() > 25 && gone.len() < 60, "{gone:?}");
    // all of it stands on the surface around the hole
    let beside = |voxel: &&&IVec3| {
        let aside = (voxel.truncate().as_dvec2() - 15.0).length();
        voxel.z >= TOP && aside > 2.0 && aside < 7.0
    };
    assert!(
        come.iter().filter(beside).count() * 10 >= come.len() * 9,
        "{come:?}"
    );
    assert!(gone.iter().any(|voxel| voxel.z <= TOP - 3));
    // nothing comes back, and what is told to stay is what is there
    assert_eq!(answer.report.moved_voxels, answer.report.plastic_voxels);
}

#[test]
fn a_light_touch_is_elastic_and_leaves_nothing() {
    let (mut voxels, materials) = scan(DVec3::splat(H));
    let before = held(&voxels);
    let mut model = rearranging();
    for depth in [0.0, 0.4, 0.8, 0.4, 0.0, -1.0] {
        let tool = ball(&voxels, depth);
        advance(&mut model, &mut voxels, &materials, &[tool], 200);
    }
    assert!(held(&voxels) == before);
}

#[test]
fn a_reset_leaves_what_was_rearranged_as_it_is() {
    let (mut voxels, materials) = scan(DVec3::splat(H));
    let mut model = rearranging();
    press(&mut model, &mut voxels, &materials, 3);
    let rearranged = held(&voxels);
    model.reset();
    let away = ball(&voxels, -8.0);
    for _ in 0..3 {
        advance(&mut model, &mut voxels, &materials, &[away], 60);
    }
    assert!(held(&voxels) == rearranged);
}
