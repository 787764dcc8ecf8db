//! Surfaces of triangles in a picture, against what can be reckoned by hand.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, UVec3, Vec3};
use palpate_render::appearance::{Appearance, Blend, Lighting, Plane, ShownSurface};
use palpate_render::camera::Camera;
use palpate_render::displaced::Displacements;
use palpate_render::draw::Request;
use palpate_render::picture::Picture;
use palpate_render::scene::Scene;
use palpate_render::surfaces::{SegmentSurface, Triangles};

use crate::common::{
    ALL, appearance, assert_near, cube, difference, parallel, picture, request, scene,
};

/// Voxels along each edge of the scans here, of 1 mm.
const SIZE: u32 = 24;
const MIDDLE: DVec3 = DVec3::splat(12.0);

#[derive(Clone, Debug, Default)]
struct Mesh {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    corners: Vec<[u32; 3]>,
}

impl Triangles for Mesh {
    fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    fn normals(&self) -> &[[f32; 3]] {
        &self.normals
    }

    fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }
}

impl Mesh {
    /// A parallelogram of two triangles.
    fn add(&mut self, corner: DVec3, (a, b): (DVec3, DVec3)) {
        let first = self.positions.len() as u32;
        let normal = a.cross(b).normalize().as_vec3().to_array();
        for place in [corner, corner + a, corner + a + b, corner + b] {
            self.positions.push(place.as_vec3().to_array());
            self.normals.push(normal);
        }
        self.corners.push([first, first + 1, first + 2]);
        self.corners.push([first, first + 2, first + 3]);
    }

    fn square(corner: DVec3, a: DVec3, b: DVec3) -> Self {
        let mut mesh = Self::default();
        mesh.add(corner, (a, b));
        mesh
    }

    /// A box about the scan's middle with edges of this length [mm].
    fn cube(edge: f64) -> Self {
        let mut mesh = Self::default();
        let low = MIDDLE - edge / 2.0;
        let high = MIDDLE + edge / 2.0;
        let axes = DMat3::from_diagonal(DVec3::splat(edge));
        for axis in 0..3 {
            let (a, b) = (axes.col((axis + 1) % 3), axes.col((axis + 2) % 3));
            mesh.add(low, (b, a));
            mesh.add(high, (-b, -a));
        }
        mesh
    }

    fn moved(&self, pose: DAffine3) -> Self {
        let point = |it: &[f32; 3]| pose.transform_point3(Vec3::from(*it).as_dvec3());
        let vector = |it: &[f32; 3]| pose.transform_vector3(Vec3::from(*it).as_dvec3());
        let arrays = |it: DVec3| it.as_vec3().to_array();
        Self {
            positions: self.positions.iter().map(|it| arrays(point(it))).collect(),
            normals: self.normals.iter().map(|it| arrays(vector(it))).collect(),
            corners: self.corners.clone(),
        }
    }

    fn surface(self, id: u8) -> SegmentSurface {
        SegmentSurface {
            id,
            origin: DVec3::ZERO,
            pose: DAffine3::IDENTITY,
            patches: vec![Arc::new(self)],
        }
    }
}

fn shown(id: u8, opacity: f32) -> ShownSurface {
    ShownSurface {
        id,
        colour: [Vec3::X, Vec3::Y, Vec3::Z][usize::from(id % 3)],
        opacity,
        is_wireframe: false,
        ambient: 1.0,
        specular: 0.0,
    }
}

/// A scan of one value with surfaces in it, and how both look: extinction of 0.2 for each mm at 1000.
fn with(value: f64, surfaces: &[(Mesh, ShownSurface)]) -> (Scene, Appearance) {
    let mut scene = scene(&cube(SIZE, |_| value));
    let meshes = surfaces.iter();
    scene.set_surfaces(
        meshes
            .map(|(mesh, shown)| mesh.clone().surface(shown.id))
            .collect(),
    );
    let look = Appearance {
        surfaces: surfaces.iter().map(|(_, shown)| *shown).collect(),
        // tissue in its own colour, and light that is the same everywhere
        ..appearance(Blend::Composite, 0.2)
    };
    (scene, look)
}

fn ahead(size: u32) -> Request {
    request(parallel(MIDDLE, DVec3::Z, 30.0), size)
}

fn colour_at(picture: &Picture, (column, row): (u32, u32)) -> Vec3 {
    Vec3::from_slice(&picture.colours[(column + row * picture.size.0) as usize])
}

/// Depths at which a ray comes into a box about the middle, if it does.
fn depth_of_box(edge: f64, from: DVec3, per_depth: DVec3) -> Option<f64> {
    let a = (MIDDLE - edge / 2.0 - from) / per_depth;
    let b = (MIDDLE + edge / 2.0 - from) / per_depth;
    let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
    (enter < leave).then_some(enter)
}

/// From the eye to a pixel: where its ray begins, and its way for each mm of depth.
fn ray_of(camera: &Camera, size: u32, (column, row): (u32, u32)) -> (DVec3, DVec3) {
    let part = |pixel: u32| (f64::from(pixel) + 0.5) * 2.0 / f64::from(size) - 1.0;
    let half = (camera.field / 2.0).tan() * camera.parallel.map_or(1.0, |_| camera.distance);
    let aside = half * (part(column) * camera.right - part(row) * camera.up);
    let forward = -camera.back - camera.aside * camera.right;
    match camera.parallel {
        Some(_) => (camera.eye() + aside, forward),
        None => (camera.eye(), forward + aside),
    }
}

#[test]
fn a_box_has_the_silhouette_the_depths_and_the_segment_of_a_box() {
    let edge = 9.0;
    let (scene, look) = with(0.0, &[(Mesh::cube(edge), shown(7, 1.0))]);
    let back = DVec3::new(0.5, -0.7, 0.4).normalize();
    let side = parallel(MIDDLE, back, 24.0);
    let perspective = Camera {
        parallel: None,
        distance: 60.0,
        field: 0.4,
        ..side
    };
    let eye = Camera {
        aside: 0.05,
        ..perspective
    };
    let oblique = Camera {
        aside: -0.1,
        ..side
    };
    for camera in [side, perspective, eye, oblique] {
        let size = 61;
        let found = picture(&scene, &look, &request(camera, size));
        let mut misses = 0;
        for pixel in 0..size * size {
            let (from, way) = ray_of(&camera, size, (pixel % size, pixel / size));
            let expected = depth_of_box(edge, from, way);
            let depth = f64::from(found.depths[pixel as usize]);
            let segment = found.segments[pixel as usize];
            match expected {
                Some(expected) if depth.is_finite() => {
                    assert_near(depth, expected, 0.02);
                    assert_eq!(segment, 7);
                    assert_near(found.colours[pixel as usize][3], 1.0, 1e-6);
                }
                None if depth.is_infinite() => assert_eq!(segment, 0),
                _ => misses += 1,
            }
        }
        // corners are rounded to 1/256 pixel: a few middles on the silhouette fall to its other side
        assert!(misses <= 3, "{misses} pixels of {camera:?}");
    }
}

#[test]
fn tissue_before_a_surface_veils_it_and_tissue_behind_it_is_not_seen() {
    for depth in [4.0, 10.0] {
        let corner = DVec3::new(-2.0, -2.0, f64::from(SIZE) - depth);
        let square = Mesh::square(corner, 28.0 * DVec3::X, 28.0 * DVec3::Y);
        let alone = with(0.0, &[(square.clone(), shown(3, 1.0))]);
        let veiled = with(500.0, &[(square, shown(3, 1.0))]);
        let tissue = with(500.0, &[]);
        let [alone, veiled, tissue] =
            [alone, veiled, tissue].map(|(scene, look)| picture(&scene, &look, &ahead(9)));

        // a surface is drawn an edge of a voxel before it
        let clear = (-0.1 * (depth - 1.0)).exp();
        let veil = colour_at(&tissue, (4, 4)) / tissue.colours[40][3] * (1.0 - clear) as f32;
        let expected = veil + colour_at(&alone, (4, 4)) * clear as f32;
        assert!(colour_at(&veiled, (4, 4)).abs_diff_eq(expected, 2e-3));
        assert_near(veiled.colours[40][3], 1.0, 1e-5);
        assert_eq!(veiled.segments[40] == 3, clear > 0.5);
    }
}

#[test]
fn of_two_layers_the_nearer_one_is_before_the_other_from_either_side() {
    let layer = |z: f64| {
        let corner = DVec3::new(2.0, 2.0, z);
        Mesh::square(corner, 20.0 * DVec3::X, 20.0 * DVec3::Y)
    };
    let red = (layer(8.0), shown(3, 0.6));
    let green = (layer(16.0), shown(4, 0.6));
    // how bright each is alone, in its own colour
    let [red_alone, green_alone] = [&red, &green].map(|layer| {
        let (scene, look) = with(0.0, std::slice::from_ref(layer));
        colour_at(&picture(&scene, &look, &ahead(15)), (7, 7)).max_element()
    });
    for surfaces in [[red.clone(), green.clone()], [green.clone(), red.clone()]] {
        let (scene, look) = with(0.0, &surfaces);
        for (back, near) in [(DVec3::Z, 1), (-DVec3::Z, 0)] {
            let found = picture(&scene, &look, &request(parallel(MIDDLE, back, 30.0), 15));
            let seen = colour_at(&found, (7, 7));
            let passing = [[1.0, 0.4], [0.4, 1.0]][near];
            if near == 1 {
                // the lamp stands on the side from which they were seen alone
                assert_near(seen.x, passing[0] * red_alone, 1e-3);
                assert_near(seen.y, passing[1] * green_alone, 1e-3);
            }
            assert!(seen[near] > 1.5 * seen[1 - near]);
            assert_near(found.colours[7 + 7 * 15][3], 0.84, 1e-5);
            assert_eq!(found.segments[7 + 7 * 15], 3 + near as u8);
        }
    }
}

#[test]
fn tissue_between_two_layers_is_before_one_and_behind_the_other() {
    let layer = |z: f64| {
        let corner = DVec3::new(-2.0, -2.0, z);
        Mesh::square(corner, 28.0 * DVec3::X, 28.0 * DVec3::Y)
    };
    // tissue lies from 6 to 18 mm along the ray, layers before and behind it
    let value = |z: i32| if (6..18).contains(&z) { 1000.0 } else { 0.0 };
    let mut scene = scene(&cube(SIZE, |voxel| value(voxel.z)));
    let surfaces = [shown(3, 0.5), shown(4, 1.0)];
    scene.set_surfaces(vec![layer(22.0).surface(3), layer(2.0).surface(4)]);
    let mut look = appearance(Blend::Composite, 0.2);
    let tissue = picture(&scene, &look, &ahead(9)).colours[40];
    look.surfaces = surfaces.to_vec();
    let both = picture(&scene, &look, &ahead(9));
    let light = |shown: ShownSurface| {
        let look = Appearance {
            transfer: appearance(Blend::Composite, 0.0).transfer,
            surfaces: vec![ShownSurface {
                opacity: 1.0,
                ..shown
            }],
            ..look.clone()
        };
        colour_at(&picture(&scene, &look, &ahead(9)), (4, 4))
    };
    let seen = 0.5 * light(surfaces[0])
        + 0.5 * (Vec3::from_slice(&tissue) + (1.0 - tissue[3]) * light(surfaces[1]));
    assert!(colour_at(&both, (4, 4)).abs_diff_eq(seen, 1e-3));
}

#[test]
fn each_pixel_between_two_triangles_is_one_of_both() {
    let turn = DMat3::from_rotation_z(0.37);
    let (a, b) = (turn * (14.0 * DVec3::X), turn * (14.0 * DVec3::Y));
    let square = Mesh::square(MIDDLE - (a + b) / 2.0, a, b);
    let (scene, look) = with(0.0, &[(square, shown(3, 0.3))]);
    for size in [40, 57, 64] {
        let found = picture(&scene, &look, &ahead(size));
        let opacities = found.colours.iter().map(|colour| colour[3]);
        let drawn: Vec<f32> = opacities.filter(|&it| it > 0.0).collect();
        assert!(drawn.iter().all(|it| (it - 0.3).abs() < 1e-5));
        let area = drawn.len() as f64 * (30.0 / f64::from(size)).powi(2);
        assert_near(area, 196.0, 10.0);
    }
}

#[test]
fn a_moved_segment_looks_as_the_same_triangles_elsewhere() {
    let turn = DMat3::from_rotation_y(0.6) * DMat3::from_rotation_x(-0.4);
    let pose = DAffine3::from_mat3_translation(turn, DVec3::new(3.0, -5.0, 4.0));
    let (mut scene, look) = with(200.0, &[(Mesh::cube(8.0), shown(5, 1.0))]);
    let mut surface = Mesh::cube(8.0).surface(5);
    surface.pose = pose;
    scene.set_surfaces(vec![surface]);
    let moved = picture(&scene, &look, &ahead(50));
    scene.set_surfaces(vec![Mesh::cube(8.0).moved(pose).surface(5)]);
    let elsewhere = picture(&scene, &look, &ahead(50));
    scene.set_surfaces(vec![Mesh::cube(8.0).surface(5)]);
    let unmoved = picture(&scene, &look, &ahead(50));
    let off = |one: &Picture, other: &Picture| {
        let pairs = one.colours.iter().zip(&other.colours);
        let far = pairs.filter(|&(a, b)| Vec3::from_slice(a).distance(Vec3::from_slice(b)) > 1e-3);
        far.count()
    };
    // single pixels on the silhouette, by rounding
    assert!(off(&moved, &elsewhere) <= 3);
    assert!(off(&moved, &unmoved) > 50);
}

#[test]
fn in_every_mode_a_surface_outside_of_the_scan_is_seen() {
    let corner = DVec3::new(4.0, 4.0, 40.0);
    let square = Mesh::square(corner, 16.0 * DVec3::X, 16.0 * DVec3::Y);
    for blend in ALL {
        let (scene, look) = with(800.0, &[(square.clone(), shown(6, 1.0))]);
        let look = Appearance { blend, ..look };
        let found = picture(&scene, &look, &ahead(9));
        assert_near(found.depths[40], 500.0 - 28.0, 1e-2);
        assert_eq!(found.segments[40], 6, "{blend:?}");
        assert!(colour_at(&found, (4, 4)).x > 0.1, "{blend:?}");
    }
}

#[test]
fn a_clip_plane_cuts_a_surface_and_its_face_closes_it_where_the_scan_has_the_segment() {
    let mesh = Mesh::cube(10.0);
    let (mut scene, mut look) = with(0.0, &[(mesh.clone(), shown(9, 1.0))]);
    look.clip = vec![Plane {
        normal: DVec3::Z,
        offset: 12.0,
    }];
    // no voxels are known: hollow, its lower face is seen
    let hollow = picture(&scene, &look, &ahead(9));
    assert_near(hollow.depths[40], 505.0, 1e-2);

    let inside = |voxel: glam::IVec3| (voxel.as_dvec3() + 0.5 - MIDDLE).abs().max_element() < 5.0;
    let mut voxels = cube(SIZE, |_| 0.0);
    let segment = palpate_volume::segment::Segment::from_fn(glam::UVec3::splat(SIZE), inside);
    voxels
        .insert_segment(palpate_volume::edit::SegmentId(9), segment)
        .unwrap();
    scene = crate::common::scene(&voxels);
    scene.set_surfaces(vec![mesh.clone().surface(9)]);
    let closed = picture(&scene, &look, &ahead(9));
    assert_near(closed.depths[40], 500.0, 1e-2);

    // one that can be seen through has the face before the rest
    look.surfaces[0].opacity = 0.5;
    let through = picture(&scene, &look, &ahead(9));
    assert_near(through.colours[40][3], 0.75, 1e-4);

    // moved aside it is cut where it stands
    let mut moved = mesh.surface(9);
    moved.pose = DAffine3::from_translation(DVec3::new(0.0, 0.0, 3.0));
    scene.set_surfaces(vec![moved]);
    look.surfaces[0].opacity = 1.0;
    let moved = picture(&scene, &look, &ahead(9));
    assert_near(moved.depths[40], 500.0, 1e-2);
}

#[test]
fn a_wireframe_is_the_sides_of_its_triangles() {
    let corner = DVec3::new(2.0, 2.0, 12.0);
    let square = Mesh::square(corner, 20.0 * DVec3::X, 20.0 * DVec3::Y);
    let wire = ShownSurface {
        is_wireframe: true,
        ..shown(3, 1.0)
    };
    let (scene, look) = with(0.0, &[(square, wire)]);
    let size = 120;
    let found = picture(&scene, &look, &ahead(size));
    let is_drawn = |column: u32, row: u32| found.colours[(column + row * size) as usize][3] > 0.5;
    // 80 pixels along each side, and a diagonal
    let drawn = (0..size * size).filter(|i| is_drawn(i % size, i / size));
    assert_near(drawn.count() as f64, 5.0 * 80.0, 6.0);
    assert!(is_drawn(60, 20) || is_drawn(60, 19));
    assert!(!is_drawn(60, 40));

    let half = Appearance {
        surfaces: vec![ShownSurface {
            opacity: 0.5,
            ..wire
        }],
        ..look
    };
    // a side that two triangles share is drawn once
    let found = picture(&scene, &half, &ahead(size));
    let most = found.colours.iter().map(|colour| colour[3]);
    let doubled = most.filter(|&it| it > 0.51).count();
    assert!(doubled <= 8, "{doubled} pixels");
}

#[test]
fn what_stands_close_darkens_a_surface_of_voxels_as_a_body_of_them() {
    // the bottom of a groove of a threshold, drawn as a body and as its triangles
    let value = |z: i32, x: i32| {
        if z < 8 || (x - 12).abs() > 2 {
            1000.0
        } else {
            0.0
        }
    };
    let voxels = cube(SIZE, |voxel| value(voxel.z, voxel.x));
    let corner = DVec3::new(10.0, 0.0, 8.0);
    let square = Mesh::square(corner, 5.0 * DVec3::X, 24.0 * DVec3::Y);
    let mut scene = scene(&voxels);
    scene.set_surfaces(vec![square.surface(3)]);
    let light = Lighting {
        occlusion: 0.0,
        shadow: 0.0,
        ..Lighting::default()
    };
    let mut look = Appearance {
        lighting: light,
        surfaces: vec![shown(3, 1.0)],
        segments: vec![palpate_render::appearance::ShownSegment {
            id: 3,
            range: Some((500.0, 2000.0)),
            is_edited: false,
            shown: palpate_render::appearance::Shown::Hidden,
            colour: Vec3::X,
            ambient: 1.0,
            specular: 0.0,
        }],
        ..appearance(Blend::Shaded, 0.0)
    };
    let camera = parallel(DVec3::new(12.5, 12.0, 12.0), DVec3::Z, 1.0);
    let surface = picture(&scene, &look, &request(camera, 1));
    look.surfaces.clear();
    look.segments[0].shown = palpate_render::appearance::Shown::Solid;
    let body = picture(&scene, &look, &request(camera, 1));
    let haste = Request {
        is_in_haste: true,
        ..request(camera, 1)
    };
    let open = picture(&scene, &look, &haste);
    assert_near(
        colour_at(&surface, (0, 0)).x,
        colour_at(&body, (0, 0)).x,
        0.03,
    );
    assert!(colour_at(&open, (0, 0)).x > colour_at(&body, (0, 0)).x + 0.06);
}

/// Displaces all tissue of a scan by what it is at eight corners far beyond it, linear between.
fn displace(scene: &mut Scene, of: impl Fn(DVec3) -> DVec3) {
    let (origin, step) = (DVec3::splat(-20.0), DVec3::splat(64.0));
    let nodes = (0..8).map(|i| UVec3::new(i & 1, i >> 1 & 1, i >> 2).as_dvec3());
    let moved: Vec<Vec3> = nodes
        .map(|node| of(origin + step * node).as_vec3())
        .collect();
    scene.displace(&[Displacements {
        origin,
        step,
        size: UVec3::splat(2),
        moved: &moved,
    }]);
}

fn lit(mut look: Appearance) -> Appearance {
    look.blend = Blend::Shaded;
    look.lighting = Lighting::default();
    look
}

#[test]
fn surfaces_stand_where_their_tissue_does_and_their_normals_turn_with_it() {
    let back = DVec3::new(0.3, 0.4, 0.85).normalize();
    let view = request(parallel(MIDDLE, back, 30.0), 64);
    let bent = |at: DVec3| DVec3::new(0.0, 0.0, 0.5 * (at.x - 12.0) - 2.0);
    let stood = |at: DVec3| at + bent(at);
    let corner = DVec3::new(4.0, 5.0, 12.0);
    let (a, b) = (DVec3::X * 12.0, DVec3::Y * 9.0);
    let expected = Mesh::square(
        stood(corner),
        stood(corner + a) - stood(corner),
        stood(corner + b) - stood(corner),
    );
    for opacity in [1.0, 0.5] {
        let (mut scene, look) = with(0.0, &[(Mesh::square(corner, a, b), shown(7, opacity))]);
        let look = lit(look);
        let still = picture(&scene, &look, &view);
        displace(&mut scene, bent);
        let found = picture(&scene, &look, &view);
        let (reference, _) = with(0.0, &[(expected.clone(), shown(7, opacity))]);
        let (mean, far) = difference(&found, &picture(&reference, &look, &view));
        assert!(mean < 0.05 && far < 0.002, "{mean} {far}");
        assert!(difference(&found, &still).0 > 0.5);
    }
}

#[test]
fn only_what_stands_where_the_scan_has_it_is_displaced() {
    let view = ahead(48);
    let aside = DAffine3::from_translation(DVec3::new(2.0, 0.0, 0.0));
    let (mut scene, look) = with(0.0, &[]);
    let look = Appearance {
        surfaces: vec![shown(7, 1.0)],
        ..look
    };
    let posed = SegmentSurface {
        pose: aside,
        ..Mesh::cube(8.0).surface(7)
    };
    scene.set_surfaces(vec![posed]);
    let before = picture(&scene, &look, &view);
    displace(&mut scene, |_| DVec3::new(0.0, 4.0, 0.0));
    assert!(picture(&scene, &look, &view) == before);
    scene.set_surfaces(vec![Mesh::cube(8.0).surface(7)]);
    let up = picture(&scene, &look, &view);
    let (reference, _) = with(
        0.0,
        &[(
            Mesh::cube(8.0).moved(DAffine3::from_translation(DVec3::new(0.0, 4.0, 0.0))),
            shown(7, 1.0),
        )],
    );
    let (mean, far) = difference(&up, &picture(&reference, &look, &view));
    assert!(mean < 0.05 && far < 0.002, "{mean} {far}");
}
