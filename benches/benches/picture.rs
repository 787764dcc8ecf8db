//! Time of a picture of CThead at 806×696 on all cores: whole, a half and a third of the resolution, its light, and the
//! parts of a first picture and of one after a drill's edit.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use glam::{DMat3, DVec3, IVec3, Vec3};
use palpate_benches::scans::cthead;
use palpate_render::appearance::{Appearance, Blend, ControlPoint, Lighting, Shown, ShownSegment};
use palpate_render::camera::Camera;
use palpate_render::draw::{Request, draw};
use palpate_render::light_volume::LightVolume;
use palpate_render::prepared::Prepared;
use palpate_render::renderer::Renderer;
use palpate_render::scene::Scene;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::simd_dispatch::SimdLevel;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::Voxels;

/// Pixels across and down.
const SIZE: (u32, u32) = (806, 696);

/// Bone behind clear tissue; CThead's values are not HU.
fn appearance() -> Appearance {
    let point = |value, colour: [f32; 3], extinction| ControlPoint {
        value,
        colour: Vec3::from(colour),
        extinction,
    };
    Appearance {
        blend: Blend::Shaded,
        density: 1.0,
        transfer: vec![
            point(850.0, [0.7, 0.4, 0.3], 0.0),
            point(1050.0, [0.7, 0.3, 0.2], 0.02),
            point(1250.0, [0.9, 0.8, 0.7], 0.5),
            point(2000.0, [1.0, 1.0, 0.9], 3.0),
        ],
        edge_gradient: 60.0,
        window: (2000.0, 1000.0),
        iso_value: 1250.0,
        iso_colour: Vec3::splat(0.8),
        tissue_from: 700.0,
        slab: None,
        lighting: Lighting::default(),
        segments: Vec::new(),
        surfaces: Vec::new(),
        clip: Vec::new(),
    }
}

/// Values from which on there is bone, drilled as a segment.
const BONE: f64 = 1250.0;

/// The bone as a solid segment that was edited.
fn with_bone() -> Appearance {
    Appearance {
        segments: vec![ShownSegment {
            id: 1,
            range: Some((BONE, f64::MAX)),
            is_edited: true,
            shown: Shown::Solid,
            colour: Vec3::new(0.9, 0.8, 0.7),
            ambient: 1.0,
            specular: 1.0,
        }],
        ..appearance()
    }
}

/// A ball of 5 voxels drilled out of everything.
fn drilled(voxels: &Voxels, middle: IVec3) -> Voxels {
    let mut voxels = voxels.clone();
    let region = VoxelBox::new(middle - 6, middle + 6);
    let edit = voxels.voxel_edit(&region, |voxel, was| {
        if (voxel - middle).length_squared() > 25 {
            return was;
        }
        VoxelState {
            stored: 0,
            segments: Default::default(),
        }
    });
    voxels.apply(edit).expect("an edit of these voxels");
    voxels
}

/// What a first picture and one after an edit wait for, but for their rays.
fn parts(criterion: &mut Criterion, voxels: &Voxels, request: &Request) {
    let mut voxels = voxels.clone();
    let bone = voxels.threshold(BONE, f64::INFINITY);
    voxels
        .insert_segment(SegmentId(1), bone)
        .expect("a segment of this scan");
    let mut group = criterion.benchmark_group("parts of a picture of cthead");
    group.sample_size(10);
    group.bench_function("scene", |bencher| {
        bencher.iter(|| Scene::new(voxels.clone()).expect("a small scan"));
    });
    let scene = Scene::new(voxels.clone()).expect("a small scan");
    group.bench_function("prepared", |bencher| {
        bencher.iter(|| Prepared::new(black_box(&scene), with_bone()));
    });
    let first = drilled(&voxels, IVec3::new(150, 60, 50));
    let second = drilled(&first, IVec3::new(152, 62, 51));
    let one_ray = Request {
        size: (1, 1),
        is_in_haste: true,
        ..*request
    };
    let half = Request {
        size: (SIZE.0 / 2, SIZE.1 / 2),
        ..one_ray
    };
    for (name, request) in [("edit to one ray", one_ray), ("edit to a half", half)] {
        let drawn = || {
            let mut renderer = Renderer::new(first.clone()).expect("a small scan");
            renderer.set_appearance(with_bone());
            renderer.draw(&one_ray, 1, &|| false).expect("a look");
            renderer
        };
        group.bench_function(name, |bencher| {
            bencher.iter_batched_ref(
                drawn,
                |renderer| {
                    renderer.follow(second.clone());
                    renderer.draw(&request, 1, &|| false).expect("a look")
                },
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

fn pictures(criterion: &mut Criterion) {
    let Some(scan) = cthead() else {
        return;
    };
    let dimensions = scan.dimensions();
    let spacing = DVec3::new(1.0, 1.0, 2.0);
    let grid = Grid::new(dimensions, spacing, DVec3::ZERO, DMat3::IDENTITY).expect("a grid");
    let voxels = Voxels::new(grid, scan).expect("values of the grid");
    let scene = Scene::new(voxels.clone()).expect("a small scan");
    let prepared = Prepared::new(&scene, appearance());
    let back = DVec3::new(0.4, -0.9, 0.16).normalize();
    let right = DVec3::Z.cross(back).normalize();
    let camera = Camera {
        target: spacing * dimensions.as_dvec3() / 2.0,
        distance: 760.0,
        right,
        up: back.cross(right),
        back,
        field: 24_f64.to_radians(),
        parallel: None,
        aside: 0.0,
    };
    let request = Request {
        camera,
        size: SIZE,
        part: None,
        steps_per_voxel: 1.0,
        shift: (0.0, 0.0),
        noise: None,
        is_in_haste: false,
        level: SimdLevel::widest(),
    };
    let mut group = criterion.benchmark_group("picture of cthead");
    group.sample_size(10);
    for divisor in [1, 2, 3] {
        let request = Request {
            size: (SIZE.0 / divisor, SIZE.1 / divisor),
            is_in_haste: divisor > 1,
            ..request
        };
        group.bench_function(format!("1/{divisor}"), |bencher| {
            bencher.iter(|| draw(black_box(&scene), &prepared, None, &request, &|| false));
        });
    }
    group.bench_function("light, 128 cells", |bencher| {
        bencher
            .iter(|| LightVolume::new(black_box(&scene), &prepared, camera.lamp(), 128, &|| false));
    });
    group.finish();
    parts(criterion, &voxels, &request);
}

criterion_group!(benches, pictures);
criterion_main!(benches);
