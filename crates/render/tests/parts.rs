//! A part of a picture is what the whole one has there, and the part around edits has all that they changed.

use glam::{DVec3, IVec3, UVec2, Vec4};
use palpate_render::appearance::Blend;
use palpate_render::camera::Camera;
use palpate_render::draw::Request;
use palpate_render::part::Part;
use palpate_render::picture::Picture;
use palpate_render::renderer::Renderer;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::Voxels;

use crate::common::{ALL, appearance, ball, parallel, picture, request, scene};

const SIZE: u32 = 96;

fn views() -> Vec<Camera> {
    let backs = [
        DVec3::Z,
        DVec3::new(0.3, 0.4, 0.85),
        DVec3::new(-0.7, 0.2, -0.4),
    ];
    let side_by_side =
        backs.map(|back| parallel(DVec3::new(17.0, 15.0, 16.0), back.normalize(), 40.0));
    let in_perspective = side_by_side.map(|camera| Camera {
        parallel: None,
        aside: 0.04,
        ..camera
    });
    [side_by_side, in_perspective].concat()
}

fn block(voxels: &mut Voxels, at: [i32; 3], size: i32) {
    let at = IVec3::from(at);
    let edit = voxels.voxel_edit(&VoxelBox::new(at, at + size), |_, was| VoxelState {
        stored: 0,
        ..was
    });
    voxels.apply(edit).unwrap();
}

/// By how much pixels of a picture outside of a part differ from those of another picture at most.
fn most_outside(part: &Part, one: &Picture, other: &Picture) -> f32 {
    let end = part.first + part.size;
    let pixels = (0..one.size.1).flat_map(|row| (0..one.size.0).map(move |x| UVec2::new(x, row)));
    let outside = pixels.filter(|pixel| !(pixel.cmpge(part.first).all() && pixel.cmplt(end).all()));
    outside
        .map(|pixel| (pixel.x + pixel.y * one.size.0) as usize)
        .map(|i| {
            let [a, b] = [one, other].map(|it| Vec4::from(it.colours[i]));
            (a - b).abs().max_element()
        })
        .fold(0.0, f32::max)
}

#[test]
fn a_part_is_what_the_whole_picture_has_there() {
    let scene = scene(&ball(32, 11.0));
    let part = Part {
        first: UVec2::new(28, 40),
        size: UVec2::new(37, 21),
    };
    for (blend, camera) in ALL.into_iter().zip(views().into_iter().cycle()) {
        let whole = Request {
            noise: Some(0),
            ..request(camera, SIZE)
        };
        let look = appearance(blend, 0.5);
        let all = picture(&scene, &look, &whole);
        let some = picture(
            &scene,
            &look,
            &Request {
                part: Some(part),
                ..whole
            },
        );
        assert_eq!(some.size, (37, 21));
        for (i, colour) in (0..).zip(&some.colours) {
            let pixel = part.first + UVec2::new(i % 37, i / 37);
            let there = (pixel.x + pixel.y * SIZE) as usize;
            assert_eq!(*colour, all.colours[there], "{blend:?} {pixel}");
            assert_eq!(some.depths[i as usize], all.depths[there]);
        }
    }
}

#[test]
fn all_that_edits_changed_is_in_their_part() {
    for (blend, camera) in ALL.into_iter().cycle().zip(views().repeat(2)) {
        let mut look = appearance(blend, 0.5);
        // light of far around follows with the whole picture
        (look.lighting.occlusion, look.lighting.shadow) = (0.0, 0.0);
        let view = request(camera, SIZE);
        let mut voxels = ball(32, 11.0);
        let mut renderer = Renderer::new(voxels.clone()).unwrap();
        renderer.set_appearance(look);
        let before = renderer.draw(&view, 1, &|| false).unwrap().unwrap();
        let seen = renderer.state();
        for (at, size) in [([14, 14, 24], 3), ([18, 12, 22], 2)] {
            block(&mut voxels, at, size);
            renderer.follow(voxels.clone());
        }
        let part = renderer
            .part_edited_since(seen, &camera, view.size)
            .unwrap();
        let after = renderer.draw(&view, 1, &|| false).unwrap().unwrap();
        // where rays leap over what is empty they are followed in other steps
        let most = most_outside(&part, &before, &after);
        assert!(most < 2e-3, "{blend:?}: {most}");
        assert!(
            part.size.element_product() < SIZE * SIZE / 4 * 3,
            "{part:?}"
        );
        assert!(before != after);
    }
}

#[test]
fn where_more_may_look_different_there_is_no_part() {
    let mut voxels = ball(32, 11.0);
    let mut renderer = Renderer::new(voxels.clone()).unwrap();
    renderer.set_appearance(appearance(Blend::Shaded, 0.5));
    let camera = views()[0];
    let part = |renderer: &Renderer, since| renderer.part_edited_since(since, &camera, (64, 64));
    let first = renderer.state();
    // nothing was edited: the least part
    assert_eq!(part(&renderer, first).unwrap().size, UVec2::new(4, 8));
    block(&mut voxels, [14, 14, 24], 3);
    renderer.follow(voxels.clone());
    assert!(part(&renderer, first).is_some());
    assert_eq!(part(&renderer, first + 1000), None);
    // tissue went back to its voxels, which no edit tells
    let pressed = renderer.state();
    renderer.displace(&[]);
    assert_eq!(part(&renderer, first), None);
    assert_eq!(part(&renderer, pressed), None);
    // nor is a picture of another renderer one of this
    let other = Renderer::new(voxels.clone()).unwrap();
    assert_eq!(part(&renderer, other.state()), None);
    // an eye in the midst of what was edited
    let inside = Camera {
        target: DVec3::new(15.5, 15.5, 25.5),
        distance: 0.5,
        parallel: None,
        ..camera
    };
    let second = renderer.state();
    block(&mut voxels, [14, 14, 25], 3);
    renderer.follow(voxels);
    let whole = renderer.part_edited_since(second, &inside, (64, 64));
    assert_eq!(whole, Some(Part::whole((64, 64))));
}
