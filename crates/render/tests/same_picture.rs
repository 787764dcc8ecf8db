//! What may change only the speed changes no picture.

use glam::{DVec3, IVec3};
use palpate_render::appearance::{Appearance, Blend, Plane, Shown, ShownSegment};
use palpate_render::draw::draw;
use palpate_render::light_volume::LightVolume;
use palpate_render::prepared::Prepared;
use palpate_volume::segment::Segment;
use palpate_volume::simd_dispatch::SimdLevel;
use palpate_volume::voxels::Voxels;

use crate::common::{ALL, appearance, ball, parallel, picture, request, scene};

fn segment(id: u8, range: Option<(f64, f64)>, shown: Shown) -> ShownSegment {
    ShownSegment {
        id,
        range,
        is_edited: range.is_some(),
        shown,
        colour: glam::Vec3::new(0.2, 0.5, 0.9),
        ambient: 0.9,
        specular: 0.5,
    }
}

/// With a solid threshold that was edited, a tinted mask, and a plane that cuts.
fn rich() -> (Voxels, Vec<ShownSegment>) {
    let mut voxels = ball(40, 12.0);
    let bone = voxels.threshold(800.0, 2000.0);
    let id = voxels.add_segment(bone).unwrap();
    let all = voxels.grid().bounds();
    let hole = |voxel: IVec3, was: bool| was && voxel.x > 16;
    let edit = voxels.label_edit(id, &all, hole).unwrap();
    voxels.apply(edit).unwrap();
    let mask = Segment::from_fn(voxels.grid().dimensions(), |voxel| voxel.z > 22);
    voxels.add_segment(mask).unwrap();
    let shown = vec![
        segment(1, Some((800.0, 2000.0)), Shown::Solid),
        segment(2, None, Shown::Tinted),
    ];
    (voxels, shown)
}

fn look(blend: Blend, segments: &[ShownSegment]) -> Appearance {
    Appearance {
        segments: segments.to_vec(),
        clip: vec![Plane {
            normal: DVec3::X,
            offset: 24.0,
        }],
        ..appearance(blend, 0.6)
    }
}

#[test]
fn all_instruction_sets_give_the_same_bits() {
    let (voxels, segments) = rich();
    let scene = scene(&voxels);
    let back = DVec3::new(0.5, -0.6, 0.6).normalize();
    let mut view = request(parallel(DVec3::splat(20.0), back, 40.0), 45);
    view.noise = Some(3);
    for blend in ALL {
        let prepared = Prepared::new(&scene, look(blend, &segments));
        let light = LightVolume::new(&scene, &prepared, view.camera.lamp(), 24, &|| false);
        let drawn = [SimdLevel::Plain, SimdLevel::widest()].map(|level| {
            view.level = level;
            draw(&scene, &prepared, light.as_ref(), &view, &|| false).unwrap()
        });
        let bits = |i: usize| {
            let colours = drawn[i].colours.as_flattened().iter();
            let depths = drawn[i].depths.iter();
            colours
                .chain(depths)
                .map(|it| it.to_bits())
                .collect::<Vec<_>>()
        };
        assert!(bits(0) == bits(1), "{blend:?}");
        assert_eq!(drawn[0].segments, drawn[1].segments);
        assert!(drawn[0].colours.iter().any(|it| it[3] > 0.1), "{blend:?}");
    }
}

#[test]
fn skipping_empty_space_changes_no_pixel() {
    let before = ball(64, 9.0);
    // one voxel of a segment in the middle of every brick of air keeps it from being skipped
    let is_air = |brick: IVec3| {
        let place = (8 * brick).as_dvec3() + 4.0;
        place.distance(DVec3::splat(32.0)) > 30.0
    };
    let mask = Segment::from_fn(before.grid().dimensions(), |voxel| {
        voxel & 7 == IVec3::splat(4) && is_air(voxel >> 3_i32)
    });
    assert!(mask.count() > 100);
    let mut filled = before.clone();
    filled.add_segment(mask).unwrap();
    let (skipped, whole) = (scene(&before), scene(&filled));
    let back = DVec3::new(0.5, -0.6, 0.6).normalize();
    let view = request(parallel(DVec3::splat(32.0), back, 70.0), 64);
    for blend in [
        Blend::Shaded,
        Blend::Composite,
        Blend::Absorption,
        Blend::Emission,
        Blend::Mip,
    ] {
        let mut look = appearance(blend, 0.4);
        // air lies farther below tissue than a row of the table, over which extinction is smoothed
        look.transfer[0].value = 100.0;
        let mut unskipped = look.clone();
        unskipped.segments.push(segment(1, None, Shown::Tinted));
        let one = picture(&skipped, &look, &view);
        let other = picture(&whole, &unskipped, &view);
        let pairs = one
            .colours
            .as_flattened()
            .iter()
            .zip(other.colours.as_flattened());
        let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // places of samples differ by rounding; after opaque tissue, where steps are quarters, by up to a quarter
        let has_quarters = matches!(blend, Blend::Shaded | Blend::Composite);
        let allowed = if has_quarters { 0.01 } else { 2e-3 };
        assert!(most < allowed, "{blend:?}: {most}");
    }
}

#[test]
fn drawing_stops_when_told() {
    let scene = scene(&ball(16, 5.0));
    let prepared = Prepared::new(&scene, appearance(Blend::Shaded, 1.0));
    let view = request(parallel(DVec3::splat(8.0), DVec3::Z, 20.0), 32);
    assert!(draw(&scene, &prepared, None, &view, &|| true).is_none());
}
