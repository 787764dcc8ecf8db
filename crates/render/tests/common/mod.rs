//! Small scans, how they are drawn, and their pictures. Grid points times spacing are patient points.

use glam::{DMat3, DVec3, IVec3, UVec3, Vec3};
use palpate_render::appearance::{Appearance, Blend, ControlPoint, Lighting};
use palpate_render::camera::Camera;
use palpate_render::draw::{Request, draw};
use palpate_render::picture::{Ground, Picture};
use palpate_render::prepared::Prepared;
use palpate_render::scene::Scene;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::simd_dispatch::SimdLevel;
use palpate_volume::voxels::Voxels;

pub const ALL: [Blend; 8] = [
    Blend::Shaded,
    Blend::Composite,
    Blend::Absorption,
    Blend::Emission,
    Blend::Mip,
    Blend::MinIp,
    Blend::Average,
    Blend::Iso,
];

/// A colour that no light has.
pub const COLOUR: Vec3 = Vec3::new(0.8, 0.4, 0.2);

pub fn voxels_on(grid: Grid, value: impl Fn(IVec3) -> f64) -> Voxels {
    let values: Vec<i16> = grid
        .bounds()
        .voxels()
        .map(|voxel| value(voxel).round() as i16)
        .collect();
    let scan = Intensities::new(grid.dimensions(), values, 1.0, 0.0).unwrap();
    Voxels::new(grid, scan).unwrap()
}

pub fn grid(dimensions: UVec3, spacing: DVec3) -> Grid {
    Grid::new(dimensions, spacing, spacing / 2.0, DMat3::IDENTITY).unwrap()
}

/// A cube of voxels of 1 mm.
pub fn cube(size: u32, value: impl Fn(IVec3) -> f64) -> Voxels {
    voxels_on(grid(UVec3::splat(size), DVec3::ONE), value)
}

pub fn scene(voxels: &Voxels) -> Scene {
    Scene::new(voxels.clone()).unwrap()
}

/// A ball of 1000 that falls off by 60 for each mm, its surface of 500 at this radius about the middle.
pub fn ball(size: u32, radius: f64) -> Voxels {
    let middle = DVec3::splat(f64::from(size) / 2.0);
    cube(size, |voxel| {
        let away = (voxel.as_dvec3() + 0.5 - middle).length();
        (500.0 + 60.0 * (radius - away)).clamp(0.0, 1000.0)
    })
}

/// Extinction in proportion to the value, up to `full` at 1000; without the loss in homogeneous tissue.
pub fn appearance(blend: Blend, full: f32) -> Appearance {
    let point = |value, extinction| ControlPoint {
        value,
        colour: COLOUR,
        extinction,
    };
    Appearance {
        blend,
        density: 1.0,
        transfer: vec![point(0.0, 0.0), point(1000.0, full)],
        edge_gradient: 100.0,
        window: (1000.0, 500.0),
        iso_value: 500.0,
        iso_colour: COLOUR,
        tissue_from: 100.0,
        slab: None,
        lighting: Lighting {
            edges: 0.0,
            ..Lighting::default()
        },
        segments: vec![],
        surfaces: vec![],
        clip: vec![],
    }
}

/// Side by side rays of a square picture this many mm high, from `back`.
pub fn parallel(target: DVec3, back: DVec3, height: f64) -> Camera {
    let axis = if back.y.abs() > 0.9 {
        DVec3::Z
    } else {
        DVec3::Y
    };
    let right = axis.cross(back).normalize();
    Camera {
        target,
        distance: height,
        right,
        up: back.cross(right),
        back,
        field: 2.0 * 0.5_f64.atan(),
        parallel: Some(500.0),
        aside: 0.0,
    }
}

pub fn request(camera: Camera, size: u32) -> Request {
    Request {
        camera,
        size: (size, size),
        part: None,
        steps_per_voxel: 1.0,
        shift: (0.0, 0.0),
        noise: None,
        is_in_haste: false,
        level: SimdLevel::widest(),
    }
}

pub fn picture(scene: &Scene, appearance: &Appearance, request: &Request) -> Picture {
    let prepared = Prepared::new(scene, appearance.clone());
    draw(scene, &prepared, None, request, &|| false).unwrap()
}

/// One ray along the z axis of a scan from above, through this column of voxels.
pub fn one_ray(scene: &Scene, appearance: &Appearance, (x, y): (f64, f64)) -> Seen {
    let depth = f64::from(scene.grid().dimensions().z) * scene.grid().spacing().z;
    let camera = parallel(DVec3::new(x, y, depth), DVec3::Z, 1e-3);
    let picture = picture(scene, appearance, &request(camera, 1));
    Seen {
        colour: Vec3::from_slice(&picture.colours[0]),
        opacity: picture.colours[0][3],
        depth: f64::from(picture.depths[0]) - 500.0,
        segment: picture.segments[0],
    }
}

/// What a ray along z shows.
#[derive(Debug)]
pub struct Seen {
    pub colour: Vec3,
    pub opacity: f32,
    /// From the scan's upper face [mm].
    pub depth: f64,
    pub segment: u8,
}

/// The value at a place of the grid: trilinear between centres, constant beyond the outermost.
pub fn value_at(voxels: &Voxels, place: DVec3) -> f64 {
    let last = voxels.grid().dimensions().as_ivec3() - 1;
    let place = (place - 0.5).clamp(DVec3::ZERO, last.as_dvec3());
    let first = place.floor().as_ivec3();
    let share = place - first.as_dvec3();
    (0..8)
        .map(|i| {
            let corner = IVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let weights = DVec3::select(corner.cmpeq(IVec3::ONE), share, 1.0 - share);
            weights.element_product() * voxels.value((first + corner).min(last)).unwrap()
        })
        .sum()
}

/// What grey a pixel of a mode of grey is, 0 to 1 on the screen.
pub fn grey(linear: f32) -> f64 {
    let linear = f64::from(linear);
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

#[track_caller]
pub fn assert_near(found: impl Into<f64>, expected: impl Into<f64>, allowed: f64) {
    let (found, expected) = (found.into(), expected.into());
    assert!(
        (found - expected).abs() <= allowed,
        "{found} found; {expected} expected, to {allowed}"
    );
}

/// Mean difference of two pictures on the screen, and the fraction of values that differ by more than 8 [of 255].
pub fn difference(a: &Picture, b: &Picture) -> (f64, f64) {
    let black = Ground {
        centre: Vec3::ZERO,
        edge: Vec3::ZERO,
    };
    let [a, b] = [a, b].map(|it| it.to_screen(Some(black), false));
    let differences: Vec<f64> = a
        .as_flattened()
        .iter()
        .zip(b.as_flattened())
        .map(|(&a, &b)| f64::from(a.abs_diff(b)))
        .collect();
    let count = differences.len() as f64;
    let far = differences.iter().filter(|&&it| it > 8.0).count();
    (differences.iter().sum::<f64>() / count, far as f64 / count)
}
