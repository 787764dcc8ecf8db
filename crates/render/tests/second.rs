//! A second scan is seen through the first, and beside it.

use std::sync::Arc;

use glam::{DAffine3, DVec3, UVec3, Vec3};
use palpate_render::appearance::{Appearance, Blend, Plane, ShownSurface};
use palpate_render::displaced::Displacements;
use palpate_render::picture::Picture;
use palpate_render::scene::Scene;
use palpate_render::second::{SecondAppearance, SecondScan, Tint, Turns};
use palpate_render::surfaces::{SegmentSurface, Triangles};
use palpate_volume::voxels::Voxels;

use crate::common::{
    ALL, appearance, assert_near, ball, cube, difference, grey, one_ray, parallel, picture,
    request, scene,
};

/// As a first scan looks, at full opacity.
fn as_first(look: &Appearance) -> SecondAppearance {
    SecondAppearance {
        density: look.density,
        transfer: look.transfer.clone(),
        edge_gradient: look.edge_gradient,
        window: look.window,
        iso_value: look.iso_value,
        iso_colour: look.iso_colour,
        tissue_from: look.tissue_from,
        tint: Tint::Grey,
        opacity: 1.0,
        turns: Turns::Together,
    }
}

/// A scan with a second one, whose points are those of the first moved by so much.
fn fused(
    first: &Voxels,
    second: &Voxels,
    moved: DVec3,
    look: SecondAppearance,
    blend: Blend,
) -> Scene {
    let mut scene = scene(first);
    let place = DAffine3::from_translation(moved);
    let scan = SecondScan::new(second.clone(), place).unwrap();
    scene.show_second(Some((Arc::new(scan), look)), blend);
    scene
}

/// Two triangles across all of a scan of 32 mm.
#[derive(Debug)]
struct Square {
    positions: [[f32; 3]; 4],
}

impl Triangles for Square {
    fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    fn normals(&self) -> &[[f32; 3]] {
        &[[0.0, 0.0, 1.0]; 4]
    }

    fn corners(&self) -> &[[u32; 3]] {
        &[[0, 1, 2], [0, 2, 3]]
    }
}

fn square_at(z: f32) -> SegmentSurface {
    let positions = [
        [0.0, 0.0, z],
        [32.0, 0.0, z],
        [32.0, 32.0, z],
        [0.0, 32.0, z],
    ];
    SegmentSurface {
        id: 1,
        origin: DVec3::ZERO,
        pose: DAffine3::IDENTITY,
        patches: vec![Arc::new(Square { positions })],
    }
}

fn oblique() -> DVec3 {
    DVec3::new(0.3, 0.4, 0.85).normalize()
}

#[test]
fn a_scan_through_itself_is_twice_as_dense() {
    let scan = ball(32, 9.0);
    let view = request(parallel(DVec3::splat(16.0), oblique(), 40.0), 48);
    for blend in [
        Blend::Shaded,
        Blend::Composite,
        Blend::Absorption,
        Blend::Emission,
    ] {
        let mut look = appearance(blend, 0.02);
        look.lighting.edges = 0.9;
        let both = fused(&scan, &scan, DVec3::ZERO, as_first(&look), blend);
        let drawn = picture(&both, &look, &view);
        look.density = 2.0;
        let (mean, far) = difference(&drawn, &picture(&scene(&scan), &look, &view));
        // values between two samples count, or one in the middle
        assert!(mean < 0.3 && far < 0.01, "{blend:?}: {mean} {far}");
    }
}

#[test]
fn a_second_scan_alone_is_seen_where_it_lies_also_beside_the_first() {
    // its ball lies 12 mm toward lower x, half outside of the first scan, which is empty
    let empty = cube(32, |_| 0.0);
    let scan = ball(32, 9.0);
    let view = request(parallel(DVec3::splat(16.0), oblique(), 60.0), 64);
    let mut moved = view;
    moved.camera.target.x += 12.0;
    for blend in ALL {
        let mut look = appearance(blend, 0.3);
        // MinIP and average count from its tissue on
        look.tissue_from = 600.0;
        let beside = fused(
            &empty,
            &scan,
            DVec3::new(12.0, 0.0, 0.0),
            as_first(&look),
            blend,
        );
        let (mean, far) = difference(
            &picture(&beside, &look, &view),
            &picture(&scene(&scan), &look, &moved),
        );
        assert!(mean < 0.5 && far < 0.02, "{blend:?}: {mean} {far}");
    }
}

#[test]
fn colours_of_its_window_lie_over_the_grey_of_the_first() {
    let first = cube(16, |voxel| if voxel.z < 8 { 400.0 } else { 0.0 });
    let second = cube(16, |voxel| if voxel.z > 8 { 700.0 } else { 0.0 });
    let look = appearance(Blend::Mip, 1.0);
    let shown = |tint, opacity| {
        let other = SecondAppearance {
            tint,
            opacity,
            ..as_first(&look)
        };
        let both = fused(&first, &second, DVec3::ZERO, other, Blend::Mip);
        let seen = one_ray(&both, &look, (8.5, 8.5)).colour;
        [seen.x, seen.y, seen.z].map(grey)
    };
    let near = |found: [f64; 3], expected: [f64; 3]| {
        for (found, expected) in found.into_iter().zip(expected) {
            assert_near(found, expected, 2e-3);
        }
    };
    near(shown(Tint::Grey, 0.0), [0.4; 3]);
    near(shown(Tint::Grey, 0.5), [0.55; 3]);
    let warm = [1.0, 1.8 * 0.7 - 0.5, 2.6 * 0.7 - 1.6];
    near(shown(Tint::Warm, 1.0), warm);
    near(shown(Tint::Cool, 1.0), [warm[2], warm[1], warm[0]]);
    near(
        shown(Tint::Warm, 0.25),
        warm.map(|channel| 0.75 * 0.4 + 0.25 * channel),
    );
}

#[test]
fn its_iso_surface_is_seen_through_as_its_opacity_says() {
    // a larger ball around a smaller one
    let (inner, outer) = (ball(32, 6.0), ball(32, 12.0));
    let look = appearance(Blend::Iso, 1.0);
    let seen = |opacity| {
        let other = SecondAppearance {
            opacity,
            iso_colour: Vec3::new(0.2, 0.3, 0.9),
            ..as_first(&look)
        };
        let both = fused(&inner, &outer, DVec3::ZERO, other, Blend::Iso);
        one_ray(&both, &look, (16.5, 16.5))
    };
    let (none, half, all) = (seen(0.0), seen(0.5), seen(1.0));
    let mean = 0.5 * (none.colour + all.colour);
    assert_near(half.colour.distance(mean), 0.0, 1e-4);
    assert_near(none.depth, 10.0, 0.1);
    assert_near(seen(0.6).depth, 4.0, 0.1);
    assert_eq!([none, half, all].map(|it| it.opacity), [1.0; 3]);
    // behind the first nothing of it is seen
    let around = fused(&outer, &inner, DVec3::ZERO, as_first(&look), Blend::Iso);
    assert_near(one_ray(&around, &look, (16.5, 16.5)).depth, 4.0, 0.1);
}

#[test]
fn without_a_second_scan_all_is_as_before() {
    let scan = ball(32, 9.0);
    let view = request(parallel(DVec3::splat(16.0), oblique(), 40.0), 32);
    for blend in ALL {
        let look = appearance(blend, 0.3);
        let mut both = fused(&scan, &scan, DVec3::ONE, as_first(&look), blend);
        let drawn = picture(&both, &look, &view);
        both.show_second(None, blend);
        let alone = picture(&scene(&scan), &look, &view);
        assert!(picture(&both, &look, &view) == alone, "{blend:?}");
        assert!(drawn != alone, "{blend:?}");
    }
}

#[test]
fn planes_and_slabs_cut_it_also_beside_the_first() {
    let empty = cube(32, |_| 0.0);
    let scan = ball(32, 9.0);
    let view = request(parallel(DVec3::splat(16.0), oblique(), 60.0), 48);
    let aside = DVec3::new(12.0, 0.0, 0.0);
    for blend in [Blend::Shaded, Blend::Mip, Blend::Iso] {
        let mut look = appearance(blend, 0.3);
        let whole = fused(&empty, &scan, aside, as_first(&look), blend);
        let uncut = picture(&whole, &look, &view);
        // its middle stands at 4 mm: half of the ball is left
        look.clip = vec![Plane {
            normal: DVec3::X,
            offset: 4.0,
        }];
        let cut = picture(&whole, &look, &view);
        let seen = |it: &Picture| it.colours.iter().filter(|each| each[3] > 0.1).count() as f64;
        let share = seen(&cut) / seen(&uncut);
        assert!((0.4..0.75).contains(&share), "{blend:?}: {share}");

        // as the ball alone is cut
        let mut moved = view;
        moved.camera.target.x += 12.0;
        look.clip[0].offset += 12.0;
        let alone = picture(&scene(&scan), &look, &moved);
        let (mean, far) = difference(&cut, &alone);
        assert!(mean < 0.5 && far < 0.02, "{blend:?}: {mean} {far}");
    }
}

#[test]
fn surfaces_stand_in_it_too() {
    // an opaque square before the middle of its ball, and one behind all of it
    let (empty, scan) = (cube(32, |_| 0.0), ball(32, 9.0));
    let look = |blend| {
        let mut look = appearance(blend, 0.3);
        look.surfaces = vec![ShownSurface {
            id: 1,
            colour: Vec3::X,
            opacity: 1.0,
            is_wireframe: false,
            ambient: 1.0,
            specular: 1.0,
        }];
        look
    };
    for blend in [Blend::Shaded, Blend::Iso] {
        let look = look(blend);
        let seen = |depth: f32| {
            let mut both = fused(&empty, &scan, DVec3::ZERO, as_first(&look), blend);
            both.set_surfaces(vec![square_at(32.0 - depth)]);
            one_ray(&both, &look, (16.5, 16.5))
        };
        let (before, behind) = (seen(4.0), seen(28.0));
        assert_near(before.depth, 4.0, 0.1);
        assert!(behind.depth > 6.0 && behind.depth < 12.0, "{blend:?}");
        assert!(before.colour.x > 4.0 * before.colour.y, "{blend:?}");
        assert!(behind.colour.x < 2.5 * behind.colour.y, "{blend:?}");
    }
}

#[test]
fn displaced_tissue_is_that_of_the_first() {
    let (empty, scan) = (cube(32, |_| 0.0), ball(32, 9.0));
    let view = request(parallel(DVec3::splat(16.0), oblique(), 40.0), 32);
    for blend in [Blend::Shaded, Blend::Mip] {
        let look = appearance(blend, 0.3);
        let mut both = fused(&empty, &scan, DVec3::ZERO, as_first(&look), blend);
        let still = picture(&both, &look, &view);
        both.displace(&[Displacements {
            origin: DVec3::splat(-20.0),
            step: DVec3::splat(72.0),
            size: UVec3::splat(2),
            moved: &[Vec3::new(4.0, 0.0, 0.0); 8],
        }]);
        let (mean, far) = difference(&picture(&both, &look, &view), &still);
        assert!(mean < 0.01 && far == 0.0, "{blend:?}: {mean} {far}");
    }
}

/// By turns, in a mode.
fn by_turns(first: &Voxels, second: &Voxels, look: &Appearance, turns: Turns) -> Scene {
    let other = SecondAppearance {
        turns,
        ..as_first(look)
    };
    fused(first, second, DVec3::ZERO, other, look.blend)
}

#[test]
fn in_its_turn_the_second_scan_is_seen_as_if_alone() {
    let (first, second) = (ball(32, 12.0), ball(32, 7.0));
    let view = request(parallel(DVec3::splat(16.0), oblique(), 60.0), 64);
    for blend in ALL {
        let mut look = appearance(blend, 0.3);
        look.tissue_from = 600.0;
        let turn = by_turns(&first, &second, &look, Turns::Second);
        let alone = picture(&scene(&second), &look, &view);
        let (mean, far) = difference(&picture(&turn, &look, &view), &alone);
        assert!(mean < 0.5 && far < 0.02, "{blend:?}: {mean} {far}");
    }
}

#[test]
fn cells_larger_than_both_scans_show_the_first_alone() {
    let (first, second) = (ball(32, 12.0), ball(32, 7.0));
    // of modes with one value for each ray, squares meet in the middle of the view: this one is in the first
    let corner = parallel(DVec3::new(-40.0, -40.0, 16.0), DVec3::Z, 200.0);
    let view = request(corner, 96);
    for blend in ALL {
        let mut look = appearance(blend, 0.3);
        look.tissue_from = 600.0;
        let cells = by_turns(&first, &second, &look, Turns::Cells(500.0));
        let alone = picture(&scene(&first), &look, &view);
        let (mean, far) = difference(&picture(&cells, &look, &view), &alone);
        assert!(mean < 0.3 && far < 0.01, "{blend:?}: {mean} {far}");
    }
}

#[test]
fn cells_are_cut_flat_by_their_sides() {
    // of four cells along a ray from above every other one is that of the second scan, which is empty
    let full = cube(32, |voxel| 600.0 + 10.0 * f64::from(voxel.x));
    let empty = cube(32, |_| 0.0);
    let look = appearance(Blend::Iso, 1.0);
    let mut view = request(parallel(DVec3::splat(16.0), DVec3::Z, 32.0), 32);
    view.is_in_haste = true;
    let seen = |scene: &Scene, column: usize| {
        let drawn = picture(scene, &look, &view);
        let pixel = column + 32 * 27;
        let colour = Vec3::from_slice(&drawn.colours[pixel]);
        (f64::from(drawn.depths[pixel]), colour)
    };
    let (top, whole) = seen(&scene(&full), 12);
    let there = [
        (by_turns(&full, &empty, &look, Turns::Cells(8.0)), [12, 4]),
        (by_turns(&empty, &full, &look, Turns::Cells(8.0)), [4, 12]),
    ];
    for (cells, [high, low]) in there {
        assert_near(seen(&cells, high).0, top, 0.1);
        let (depth, colour) = seen(&cells, low);
        assert_near(depth, top + 8.0, 0.1);
        // lit as the face of the scan's box is, though values rise aside and do not end there
        assert_near(f64::from(colour.distance(whole)), 0.0, 0.02);
    }
}

#[test]
fn a_ray_of_one_value_has_it_from_the_scan_of_its_square() {
    let (first, second) = (cube(32, |_| 300.0), cube(32, |_| 700.0));
    let look = appearance(Blend::Mip, 1.0);
    let cells = by_turns(&first, &second, &look, Turns::Cells(4.0));
    let view = request(parallel(DVec3::splat(16.0), DVec3::Z, 32.0), 32);
    let drawn = picture(&cells, &look, &view);
    for (pixel, colour) in drawn.colours.iter().enumerate() {
        // four squares to the left of the middle and four above it
        let (column, row) = (pixel % 32, pixel / 32);
        let is_odd = (column / 4 + (31 - row) / 4) % 2 == 1;
        let wanted = if is_odd { 0.7 } else { 0.3 };
        assert_near(grey(colour[0]), wanted, 2e-3);
    }
}
