//! Segments by threshold, by mask and by both, as solid bodies, in tissue, and left out.

use glam::{IVec3, Vec3};
use palpate_render::appearance::{Appearance, Blend, Shown, ShownSegment};
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use crate::common::{COLOUR, appearance, assert_near, cube, one_ray, scene};

const OWN: Vec3 = Vec3::new(0.1, 0.9, 0.3);
const MIDDLE: (f64, f64) = (8.2, 8.2);

/// Air above a layer of tissue of 600 whose uppermost voxels are those of z = 7.
fn layer() -> Voxels {
    cube(16, |voxel| if voxel.z < 8 { 600.0 } else { 0.0 })
}

fn with_segment(shown: Shown, range: Option<(f64, f64)>, is_edited: bool) -> Appearance {
    let mut look = appearance(Blend::Composite, 0.1);
    look.segments.push(ShownSegment {
        id: 1,
        range,
        is_edited,
        shown,
        colour: OWN,
        ambient: 1.0,
        specular: 1.0,
    });
    look
}

/// Threshold from 300 on, whose surface lies halfway between the voxels' middles.
const ABOVE: Option<(f64, f64)> = Some((300.0, 2000.0));

#[test]
fn a_solid_threshold_stands_where_interpolated_values_reach_it() {
    let scene = scene(&layer());
    let half = one_ray(&scene, &with_segment(Shown::Solid, ABOVE, false), MIDDLE);
    assert_near(half.depth, 8.0, 0.05);
    assert_eq!((half.opacity, half.segment), (1.0, 1));
    // a quarter of the way from 0 at 8.5 to 600 at 7.5
    let low = one_ray(
        &scene,
        &with_segment(Shown::Solid, Some((150.0, 2000.0)), false),
        MIDDLE,
    );
    assert_near(low.depth, 7.75, 0.05);
    // the others are not there
    let none = with_segment(Shown::Solid, Some((700.0, 2000.0)), false);
    assert!(one_ray(&scene, &none, MIDDLE).opacity < 0.5);
}

#[test]
fn tinted_tissue_keeps_its_extinction_and_hidden_tissue_is_left_out() {
    let scene = scene(&layer());
    let plain = one_ray(&scene, &appearance(Blend::Composite, 0.1), MIDDLE);
    assert_near((plain.colour / plain.opacity).distance(COLOUR), 0.0, 1e-2);
    let tinted = one_ray(&scene, &with_segment(Shown::Tinted, ABOVE, false), MIDDLE);
    assert_near(tinted.opacity, plain.opacity, 1e-3);
    assert!(
        (tinted.colour / tinted.opacity).distance(OWN) < 0.1,
        "{tinted:?}"
    );
    let hidden = one_ray(&scene, &with_segment(Shown::Hidden, ABOVE, false), MIDDLE);
    assert!(hidden.opacity < 0.02, "{hidden:?}");
}

/// The layer with a mask: voxels with z below 5.
fn masked() -> Voxels {
    let mut voxels = layer();
    let mask = Segment::from_fn(voxels.grid().dimensions(), |voxel| voxel.z < 5);
    let id = voxels.add_segment(mask).unwrap();
    assert_eq!(id.0, 1);
    voxels
}

#[test]
fn a_mask_stands_where_its_voxels_do() {
    let scene = scene(&masked());
    let solid = one_ray(&scene, &with_segment(Shown::Solid, None, false), MIDDLE);
    assert_near(solid.depth, 11.0, 0.05);
    assert_eq!(solid.segment, 1);
    let three = 1.0 - f64::exp(-0.06 * 3.0);
    let hidden = one_ray(&scene, &with_segment(Shown::Hidden, None, false), MIDDLE);
    assert_near(hidden.opacity, three, 0.03);
    let tinted = one_ray(&scene, &with_segment(Shown::Tinted, None, false), MIDDLE);
    let plain = one_ray(&scene, &appearance(Blend::Composite, 0.1), MIDDLE);
    assert_near(tinted.opacity, plain.opacity, 1e-3);
    assert!(tinted.colour.y > plain.colour.y + 0.02 && tinted.colour.x < plain.colour.x);
}

#[test]
fn a_mask_wholly_in_air_is_seen() {
    let mut voxels = cube(24, |_| 0.0);
    let mask = Segment::from_fn(voxels.grid().dimensions(), |voxel| {
        voxel == IVec3::splat(12)
    });
    voxels.add_segment(mask).unwrap();
    let solid = with_segment(Shown::Solid, None, false);
    let seen = one_ray(&scene(&voxels), &solid, (12.5, 12.5));
    assert_near(seen.depth, 11.0, 0.05);
}

#[test]
fn an_edited_threshold_is_where_its_voxels_are_and_smooth_elsewhere() {
    let mut voxels = layer();
    let threshold = voxels.threshold(300.0, 2000.0);
    let id = voxels.add_segment(threshold).unwrap();
    let hole = VoxelBox::new(IVec3::new(4, 4, 5), IVec3::new(12, 12, 8));
    let edit = voxels.label_edit(id, &hole, |_, _| false).unwrap();
    voxels.apply(edit).unwrap();
    let bump = VoxelBox::new(IVec3::new(0, 0, 8), IVec3::new(3, 3, 10));
    let edit = voxels.label_edit(id, &bump, |_, _| true).unwrap();
    voxels.apply(edit).unwrap();
    let scene = scene(&voxels);
    let edited = with_segment(Shown::Solid, ABOVE, true);
    assert_near(one_ray(&scene, &edited, MIDDLE).depth, 11.0, 0.05);
    assert_near(one_ray(&scene, &edited, (1.2, 1.2)).depth, 6.0, 0.05);
    assert_near(one_ray(&scene, &edited, (14.2, 14.2)).depth, 8.0, 0.05);
    // the threshold alone knows nothing of it
    let threshold = with_segment(Shown::Solid, ABOVE, false);
    assert_near(one_ray(&scene, &threshold, MIDDLE).depth, 8.0, 0.05);
}

#[test]
fn of_segments_in_one_another_the_first_wins() {
    let mut look = with_segment(Shown::Solid, Some((500.0, 2000.0)), false);
    let mut second = look.segments[0];
    (second.id, second.range, second.colour) = (2, ABOVE, COLOUR);
    look.segments.push(second);
    let scene = scene(&layer());
    // the second is met first, and is what is seen
    let seen = one_ray(&scene, &look, MIDDLE);
    assert_eq!(seen.segment, 2);
    look.segments.swap(0, 1);
    look.segments[1].range = ABOVE;
    assert_eq!(one_ray(&scene, &look, MIDDLE).segment, 2);
    look.segments.swap(0, 1);
    assert_eq!(one_ray(&scene, &look, MIDDLE).segment, 1);
}
