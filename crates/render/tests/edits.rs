//! What an edit puts over the scan's values is seen, and seen as in a scene made anew.

use glam::{DVec3, IVec3};
use palpate_render::appearance::Blend;
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
