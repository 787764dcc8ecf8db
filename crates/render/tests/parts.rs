//! A part of a picture is what the whole one has there, and the part around edits has all that they changed.

use std::sync::Arc;

use glam::{DAffine3, DVec3, IVec3, UVec2, UVec3, Vec3, Vec4};
use palpate_render::appearance::{Blend, ShownSurface};
use palpate_render::camera::Camera;
use palpate_render::displaced::Displacements;
use palpate_render::draw::Request;
use palpate_render::part::Part;
use palpate_render::picture::Picture;
use palpate_render::renderer::Renderer;
use palpate_render::surfaces::{SegmentSurface, Triangles};
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

/// Whether the part since a state has all that a change altered, beside a picture before it, and is smaller than this
/// share of the picture; and the picture after it.
fn check_part(
    renderer: &mut Renderer,
    (before, seen): (&Picture, u64),
    (view, share): (&Request, f64),
) -> Picture {
    let part = renderer.part_edited_since(seen, &view.camera, view.size);
    let part = part.expect("what has changed is known");
    let after = renderer.draw(view, 1, &|| false).unwrap().unwrap();
    // where rays leap over what is empty they are followed in other steps
    let most = most_outside(&part, before, &after);
    assert!(most < 2e-3, "{most}");
    let pixels = f64::from(part.size.element_product());
    assert!(pixels < share * f64::from(SIZE * SIZE), "{part:?}");
    after
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
        let after = check_part(&mut renderer, (&before, seen), (&view, 0.75));
        assert!(before != after, "{blend:?}");
    }
}

/// Tissue that a ball has pressed in around a place, so far [mm].
fn dent(renderer: &mut Renderer, at: DVec3, deep: f32) {
    let size = UVec3::splat(7);
    let nodes = (0..size.element_product()).map(|n| UVec3::new(n % 7, n / 7 % 7, n / 49));
    let moved: Vec<_> = nodes
        .map(|node| {
            let inside = node.cmpgt(UVec3::ZERO).all() && node.cmplt(size - 1).all();
            Vec3::NEG_Z * if inside { deep } else { 0.0 }
        })
        .collect();
    renderer.displace(&[Displacements {
        origin: at - 3.0,
        step: DVec3::ONE,
        size,
        moved: &moved,
    }]);
}

#[test]
fn all_that_displacements_changed_is_in_their_part() {
    let mut others = 0;
    for (blend, camera) in ALL.into_iter().zip(views().into_iter().cycle()) {
        let mut look = appearance(blend, 0.5);
        (look.lighting.occlusion, look.lighting.shadow) = (0.0, 0.0);
        let view = request(camera, SIZE);
        let mut renderer = Renderer::new(ball(32, 11.0)).unwrap();
        renderer.set_appearance(look);
        let still = renderer.draw(&view, 1, &|| false).unwrap().unwrap();
        let at = DVec3::new(16.0, 16.0, 26.0);
        let mut before = still;
        // pressed, deeper, at another place, and let go
        for (at, deep) in [(at, 1.0), (at, 1.8), (at - DVec3::X * 4.0, 1.2), (at, 0.0)] {
            let seen = renderer.state();
            dent(&mut renderer, at, deep);
            let after = check_part(&mut renderer, (&before, seen), (&view, 0.75));
            others += u32::from(before != after);
            before = after;
        }
    }
    // what is largest or least on a ray may lie deeper
    assert!(others > 16, "{others} of 32");
}

#[test]
fn nodes_that_stand_where_they_stood_make_the_part_no_larger() {
    let mut renderer = Renderer::new(ball(32, 11.0)).unwrap();
    renderer.set_appearance(appearance(Blend::Shaded, 0.5));
    let camera = views()[0];
    let size = UVec3::splat(30);
    let place = |x: u32, y: u32, z: u32| (x + 30 * (y + 30 * z)) as usize;
    let mut moved = vec![Vec3::X; size.element_product() as usize];
    let tell = |renderer: &mut Renderer, moved: &[Vec3]| {
        let (origin, step) = (DVec3::ONE, DVec3::ONE);
        renderer.displace(&[Displacements {
            origin,
            step,
            size,
            moved,
        }]);
    };
    tell(&mut renderer, &moved);
    let seen = renderer.state();
    let part = |renderer: &Renderer| renderer.part_edited_since(seen, &camera, (64, 64)).unwrap();
    tell(&mut renderer, &moved);
    assert_eq!(part(&renderer).size, UVec2::new(4, 8));
    moved[place(15, 15, 15)] = Vec3::Y;
    tell(&mut renderer, &moved);
    let size = part(&renderer).size;
    assert!(size.max_element() > 8 && size.max_element() < 32, "{size}");
}

/// Two triangles, one square for each place, across the view of the first camera.
fn surface(places: &[[f32; 2]]) -> SegmentSurface {
    SegmentSurface {
        id: 7,
        origin: DVec3::ZERO,
        pose: DAffine3::IDENTITY,
        patches: places.iter().map(|&at| square(at)).collect(),
    }
}

#[derive(Debug)]
struct Square([[f32; 3]; 4]);

impl Triangles for Square {
    fn positions(&self) -> &[[f32; 3]] {
        &self.0
    }

    fn normals(&self) -> &[[f32; 3]] {
        &[[0.0, 0.0, 1.0]; 4]
    }

    fn corners(&self) -> &[[u32; 3]] {
        &[[0, 1, 2], [0, 2, 3]]
    }
}

fn square([x, y]: [f32; 2]) -> Arc<dyn Triangles> {
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    Arc::new(Square(corners.map(|[dx, dy]| [x + dx, y + dy, 29.0])))
}

#[test]
fn triangles_that_are_others_are_in_their_part_and_shared_ones_are_not() {
    let mut others = 0;
    let mut look = appearance(Blend::Shaded, 0.5);
    (look.lighting.occlusion, look.lighting.shadow) = (0.0, 0.0);
    look.surfaces = vec![ShownSurface {
        id: 7,
        colour: Vec3::X,
        opacity: 1.0,
        ambient: 0.3,
        specular: 1.0,
        is_wireframe: false,
    }];
    for camera in views() {
        let view = request(camera, SIZE);
        let mut renderer = Renderer::new(ball(32, 11.0)).unwrap();
        renderer.set_appearance(look.clone());
        let first = surface(&[[4.0, 4.0], [24.0, 20.0]]);
        renderer.set_surfaces(vec![first.clone()]);
        let before = renderer.draw(&view, 1, &|| false).unwrap().unwrap();
        let seen = renderer.state();
        renderer.set_surfaces(vec![first.clone()]);
        assert_eq!(renderer.state(), seen, "nothing is another");
        let mut second = first.clone();
        second.patches[1] = square([22.0, 22.0]);
        renderer.set_surfaces(vec![second]);
        let after = check_part(&mut renderer, (&before, seen), (&view, 0.5));
        others += u32::from(before != after);
    }
    // in some views the ball lies before them
    assert!(others >= 4, "{others} of 6");
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
    // a surface has come
    let bare = renderer.state();
    renderer.set_surfaces(vec![surface(&[[9.0, 9.0]])]);
    assert_eq!(part(&renderer, first), None);
    assert_eq!(part(&renderer, bare), None);
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
