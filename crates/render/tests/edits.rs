//! What an edit puts over the scan's values is seen, and seen as in a scene made anew.

use glam::{DVec3, IVec3, UVec3, Vec3};
use palpate_render::appearance::{Appearance, Blend, Shown, ShownSegment};
use palpate_render::picture::Picture;
use palpate_render::renderer::Renderer;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::Voxels;

use crate::common::{
    ALL, appearance, assert_near, ball, one_ray, parallel, picture, request, scene,
};

/// Drills a channel into a ball, and puts a block where air was.
fn edited(mut voxels: Voxels) -> Voxels {
    let channel = VoxelBox::new(IVec3::new(14, 14, 8), IVec3::new(19, 19, 32));
    let edit = voxels.voxel_edit(&channel, |_, was| VoxelState { stored: 0, ..was });
    voxels.apply(edit).unwrap();
    let block = VoxelBox::new(IVec3::splat(1), IVec3::splat(5));
    let edit = voxels.voxel_edit(&block, |_, was| VoxelState { stored: 900, ..was });
    voxels.apply(edit).unwrap();
    voxels
}

#[test]
fn an_edit_is_seen_and_equals_a_scene_made_anew() {
    let before = ball(32, 11.0);
    let after = edited(before.clone());
    let mut followed = scene(&before);
    followed.follow(after.clone());
    let anew = scene(&after);
    let back = DVec3::new(0.3, 0.4, 0.85).normalize();
    let view = request(parallel(DVec3::splat(16.0), back, 40.0), 48);
    for blend in ALL {
        let look = appearance(blend, 0.5);
        let drawn = picture(&followed, &look, &view);
        assert!(drawn == picture(&anew, &look, &view), "{blend:?}");
        assert!(drawn != picture(&scene(&before), &look, &view), "{blend:?}");
    }
    // and an edit taken back
    followed.follow(before.clone());
    let look = appearance(Blend::Shaded, 0.5);
    assert!(picture(&followed, &look, &view) == picture(&scene(&before), &look, &view));
}

#[test]
fn depth_follows_a_drilled_channel_and_an_added_block() {
    let look = appearance(Blend::Iso, 1.0);
    let before = ball(32, 11.0);
    let after = scene(&edited(before.clone()));
    assert_near(
        one_ray(&scene(&before), &look, (16.5, 16.5)).depth,
        5.0,
        0.2,
    );
    // its floor lies between 0 in the channel's last voxel and 650 in the one below
    let floor = 24.5 - 150.0 / 650.0;
    assert_near(one_ray(&after, &look, (16.5, 16.5)).depth, floor, 0.05);
    assert_near(one_ray(&after, &look, (3.0, 3.0)).depth, 27.0, 0.2);
}

/// A ball whose bone is a threshold that was edited, and a slab of voxels in it that no value tells of.
fn with_segments() -> Voxels {
    let mut voxels = ball(40, 14.0);
    let bone = voxels.threshold(600.0, f64::INFINITY);
    let slab = Segment::from_fn(UVec3::splat(40), |voxel| (9..17).contains(&voxel.x));
    voxels.insert_segment(SegmentId(1), bone).unwrap();
    voxels.insert_segment(SegmentId(2), slab).unwrap();
    voxels
}

fn look_of_segments(slab: Shown) -> Appearance {
    let segment = |id, range, shown| ShownSegment {
        id,
        range,
        is_edited: range.is_some(),
        shown,
        colour: Vec3::new(0.2, 0.3, 0.9),
        ambient: 1.0,
        specular: 1.0,
    };
    let mut look = appearance(Blend::Shaded, 0.05);
    look.transfer[0].value = 300.0;
    look.segments = vec![
        segment(1, Some((600.0, 2000.0)), Shown::Solid),
        segment(2, None, slab),
    ];
    look
}

/// In haste, with no light of a picture before.
fn drawn(renderer: &mut Renderer) -> Picture {
    let back = DVec3::new(-0.5, 0.4, 0.75).normalize();
    let mut view = request(parallel(DVec3::splat(20.0), back, 48.0), 64);
    view.is_in_haste = true;
    renderer.draw(&view, 1, &|| false).unwrap().unwrap()
}

#[test]
fn a_renderer_that_follows_edits_and_looks_draws_as_one_made_anew() {
    let mut voxels = with_segments();
    let mut followed = Renderer::new(voxels.clone()).unwrap();
    let mut look = look_of_segments(Shown::Tinted);
    followed.set_appearance(look.clone());
    let mut pictures = vec![drawn(&mut followed)];
    for step in 0..6 {
        match step {
            // drilled through both, voxels added where there were none, and all of one taken away
            0 | 1 => {
                let hole = IVec3::new(10 + 8 * step, 18, 12);
                let channel = VoxelBox::new(hole, hole + IVec3::new(5, 6, 28));
                let edit = voxels.voxel_edit(&channel, |_, _| VoxelState {
                    stored: 0,
                    segments: Default::default(),
                });
                voxels.apply(edit).unwrap();
            }
            2 => {
                let block = VoxelBox::new(IVec3::new(17, 22, 26), IVec3::new(24, 32, 38));
                let edit = voxels.label_edit(SegmentId(2), &block, |_, _| true);
                voxels.apply(edit.unwrap()).unwrap();
            }
            3 => look = look_of_segments(Shown::Hidden),
            4 => look.transfer[0].value = 500.0,
            _ => {
                voxels.remove_segment(SegmentId(2)).unwrap();
            }
        }
        followed.follow(voxels.clone());
        followed.set_appearance(look.clone());
        let picture = drawn(&mut followed);
        let mut anew = Renderer::new(voxels.clone()).unwrap();
        anew.set_appearance(look.clone());
        assert!(picture == drawn(&mut anew), "after step {step}");
        assert!(Some(&picture) != pictures.last(), "step {step} is seen");
        pictures.push(picture);
    }
}
