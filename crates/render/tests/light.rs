//! The light through a scan against what light does: nothing in emptiness, Beer and Lambert behind a slab, half of the
//! sky in a corner. Scans of 48³ voxels of 1 mm, cells of 1.5 mm.

use glam::{DAffine3, DVec3, IVec3, UVec3, Vec3};
use palpate_render::appearance::{Appearance, Blend, Plane, Shown, ShownSegment, ShownSurface};
use palpate_render::draw::draw;
use palpate_render::light_volume::LightVolume;
use palpate_render::prepared::Prepared;
use palpate_render::scene::Scene;
use palpate_render::surfaces::SegmentSurface;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxel_state::VoxelState;
use palpate_volume::voxels::Voxels;

use crate::common::{appearance, assert_near, cube, parallel, request, scene};

const SIZE: u32 = 48;
const EDGE: f64 = 1.5;
const LAMP: DVec3 = DVec3::new(-0.3, 0.35, 0.89);

fn filled(low: [i32; 3], high: [i32; 3]) -> VoxelBox {
    VoxelBox::new(IVec3::from(low), IVec3::from(high))
}

fn slab() -> VoxelBox {
    filled([0, 0, 32], [48, 48, 38])
}

/// Dense tissue of 1000 in boxes, air elsewhere.
fn scan(dense: &[VoxelBox]) -> Voxels {
    cube(SIZE, |voxel| {
        let is_dense = dense.iter().any(|region| region.contains(voxel));
        if is_dense { 1000.0 } else { 0.0 }
    })
}

/// No light is lost within homogeneous tissue; values from 300 to 700 are a step of extinction.
fn look(blend: Blend, extinction: f32) -> Appearance {
    let mut look = appearance(blend, extinction);
    look.transfer[0].value = 499.0;
    look.transfer[1].value = 501.0;
    look
}

fn light_of(scene: &Scene, look: &Appearance) -> (Prepared, LightVolume) {
    let prepared = Prepared::new(scene, look.clone());
    let light = LightVolume::new(scene, &prepared, LAMP, SIZE, &|| false).unwrap();
    (prepared, light)
}

/// Sky and lamp at a point [mm].
fn at(light: &LightVolume, point: [f64; 3]) -> (f32, f32) {
    light.at_cell((DVec3::from(point) / EDGE).floor().as_ivec3())
}

fn all(light: &LightVolume) -> Vec<(f32, f32)> {
    let cells = VoxelBox::new(IVec3::ZERO, light.counts());
    cells.voxels().map(|cell| light.at_cell(cell)).collect()
}

#[test]
fn through_emptiness_all_of_the_light_comes_everywhere() {
    let (_, light) = light_of(&scene(&scan(&[])), &look(Blend::Shaded, 1.0));
    assert_eq!(light.counts(), IVec3::splat(32));
    assert!(all(&light).iter().all(|&light| light == (1.0, 1.0)));
}

#[test]
fn a_slab_shades_what_is_below_it_by_beer_and_lambert_and_nothing_above_it() {
    let (_, light) = light_of(&scene(&scan(&[slab()])), &look(Blend::Shaded, 0.08));
    let lamp = LAMP.normalize();
    let expected = f64::exp(-0.08 * 6.0 / lamp.z);
    // from here the lamp is seen through the slab and not past it; farther below nothing would look it up
    for start in [[30.0, 30.0, 20.0], [24.0, 24.0, 26.0], [40.0, 20.0, 18.0]] {
        let leaves = DVec3::from(start) + lamp * (38.0 - start[2]) / lamp.z;
        assert!(leaves.min_element() > 0.0 && leaves.max_element() < 48.0);
        assert_near(at(&light, start).1, expected, 0.02);
    }
    assert_eq!(at(&light, [24.0, 24.0, 44.0]).1, 1.0);
}

#[test]
fn before_an_opaque_wall_the_sky_is_whole_in_a_corner_half_and_within_nothing() {
    let wall = filled([0, 0, 0], [48, 48, 12]);
    let other = filled([0, 0, 0], [12, 48, 48]);
    let (_, flat) = light_of(&scene(&scan(&[wall])), &look(Blend::Shaded, 9.0));
    let (_, corner) = light_of(&scene(&scan(&[wall, other])), &look(Blend::Shaded, 9.0));
    // two cells away, where a surface looks its light up
    assert!(at(&flat, [24.0, 24.0, 14.9]).0 > 0.9);
    let in_corner = at(&corner, [14.9, 24.0, 14.9]).0;
    assert!((0.45..0.75).contains(&in_corner), "{in_corner}");
    assert!(at(&flat, [24.0, 24.0, 3.0]).0 < 0.02);
}

#[test]
fn an_edit_lets_light_in_again_and_equals_light_made_anew() {
    let before = scan(&[slab(), filled([8, 8, 4], [20, 20, 16])]);
    let mut scene = scene(&before);
    let look = look(Blend::Shaded, 9.0);
    let (_, whole) = light_of(&scene, &look);
    assert!(at(&whole, [30.0, 30.0, 20.0]).1 < 0.02);
    let mut voxels = before.clone();
    for (region, stored) in [
        (filled([20, 6, 30], [48, 40, 40]), 0),
        (filled([36, 36, 6], [41, 44, 9]), 1000),
    ] {
        let edit = voxels.voxel_edit(&region, |_, was| VoxelState { stored, ..was });
        let changed = edit.dirty;
        voxels.apply(edit).unwrap();
        let (_, stale) = light_of(&scene, &look);
        scene.follow(voxels.clone());
        let prepared = Prepared::new(&scene, look.clone());
        let followed = stale
            .follow(&scene, &prepared, &changed, &|| false)
            .unwrap();
        let (_, anew) = light_of(&scene, &look);
        assert!(all(&followed) != all(&stale));
        assert!(all(&followed) == all(&anew));
    }
    let (_, opened) = light_of(&scene, &look);
    assert!(at(&opened, [33.0, 18.0, 24.0]).1 > 0.98);
}

#[test]
fn another_lamp_is_that_of_light_made_anew() {
    let scene = scene(&scan(&[slab(), filled([8, 8, 4], [20, 20, 16])]));
    let look = look(Blend::Shaded, 0.3);
    let (prepared, light) = light_of(&scene, &look);
    let lamp = DVec3::new(0.8, 0.1, -0.3);
    let turned = light.turn_lamp(&scene, &prepared, lamp, &|| false).unwrap();
    let anew = LightVolume::new(&scene, &prepared, lamp, SIZE, &|| false).unwrap();
    assert!(all(&turned) == all(&anew));
    assert!(all(&turned) != all(&light));
}

#[test]
fn what_is_cut_away_shades_nothing_and_what_the_value_encloses_shades_in_the_mode_of_the_iso_surface()
 {
    let scene = scene(&scan(&[slab()]));
    let mut cut = look(Blend::Shaded, 9.0);
    cut.clip.push(Plane {
        normal: DVec3::Z,
        offset: 30.0,
    });
    let (_, light) = light_of(&scene, &cut);
    assert!(all(&light).iter().all(|light| light.1 == 1.0));
    let (_, iso) = light_of(&scene, &look(Blend::Iso, 0.001));
    assert!(at(&iso, [30.0, 30.0, 20.0]).1 < 0.02);
}

#[test]
fn a_floor_in_the_shadow_is_darker_and_none_of_it_is_seen_where_it_is_not_asked_for() {
    let floor = filled([0, 0, 0], [48, 48, 8]);
    let roof = filled([14, 14, 30], [34, 34, 36]);
    let scene = scene(&scan(&[floor, roof]));
    let mut look = look(Blend::Iso, 1.0);
    let camera = parallel(
        DVec3::new(24.0, 24.0, 20.0),
        DVec3::new(0.0, -0.8, 0.6),
        60.0,
    );
    let drawn = |look: &Appearance, is_lit: bool| {
        let prepared = Prepared::new(&scene, look.clone());
        let light = LightVolume::new(&scene, &prepared, camera.lamp(), SIZE, &|| false);
        let light = light.as_ref().filter(|_| is_lit);
        draw(&scene, &prepared, light, &request(camera, 48), &|| false).unwrap()
    };
    let (plain, lit) = (drawn(&look, false), drawn(&look, true));
    let darker = plain.colours.iter().zip(&lit.colours);
    let darker = darker
        .filter(|(plain, lit)| lit[0] < 0.7 * plain[0])
        .count();
    assert!(darker > 50, "{darker} pixels lie in the shadow");
    look.lighting.occlusion = 0.0;
    look.lighting.shadow = 0.0;
    assert!(drawn(&look, true) == drawn(&look, false));
}

#[test]
fn work_that_is_no_longer_wanted_gives_nothing() {
    let scene = scene(&scan(&[slab()]));
    let (prepared, light) = light_of(&scene, &look(Blend::Shaded, 1.0));
    assert!(LightVolume::new(&scene, &prepared, LAMP, SIZE, &|| true).is_none());
    assert!(
        light
            .turn_lamp(&scene, &prepared, DVec3::X, &|| true)
            .is_none()
    );
    assert!(light.follow(&scene, &prepared, &slab(), &|| true).is_none());
}

#[test]
fn a_surface_keeps_off_as_much_light_as_it_hides_over_10_mm_of_its_segment() {
    let inside = slab();
    // of no extinction in the scan itself: only the surface keeps off light
    let mut voxels = scan(&[inside]);
    let segment = Segment::from_fn(UVec3::splat(SIZE), |voxel| inside.contains(voxel));
    voxels.insert_segment(SegmentId(3), segment).unwrap();
    let surface = SegmentSurface {
        id: 3,
        origin: DVec3::ZERO,
        pose: DAffine3::IDENTITY,
        patches: Vec::new(),
    };
    let lamp = LAMP.normalize();
    let below = [30.0, 30.0, 26.0];
    let light_by = |opacity: f32, surfaces: Vec<SegmentSurface>, range: Option<(f64, f64)>| {
        let mut scene = scene(&voxels);
        scene.set_surfaces(surfaces);
        let mut look = look(Blend::Shaded, 0.0);
        look.segments.push(ShownSegment {
            id: 3,
            range,
            is_edited: false,
            shown: Shown::Hidden,
            colour: Vec3::ONE,
            ambient: 1.0,
            specular: 1.0,
        });
        look.surfaces.push(ShownSurface {
            id: 3,
            colour: Vec3::ONE,
            opacity,
            is_wireframe: false,
            ambient: 1.0,
            specular: 1.0,
        });
        at(&light_of(&scene, &look).1, below).1
    };
    let through = 6.0 / lamp.z / 10.0;
    // told by its voxels, and by its values in bricks in which nothing else is drawn
    for range in [None, Some((500.0, 1500.0))] {
        let half = light_by(0.5, vec![surface.clone()], range);
        assert_near(half, 0.5_f64.powf(through), 0.02);
        assert!(light_by(1.0, vec![surface.clone()], range) < 0.02);
    }
    // one that was moved shades where it stands, which nobody works out
    let moved = SegmentSurface {
        pose: DAffine3::from_translation(DVec3::X),
        ..surface
    };
    assert_eq!(light_by(1.0, vec![moved], None), 1.0);
    assert_eq!(light_by(1.0, Vec::new(), None), 1.0);
}
