//! Tissue that stands beside its voxels is seen where it stands.

use glam::{DVec3, UVec3, Vec3};
use palpate_render::appearance::{Blend, Shown, ShownSegment};
use palpate_render::displaced::Displacements;
use palpate_render::scene::Scene;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

use crate::common::{
    ALL, COLOUR, appearance, assert_near, ball, cube, difference, one_ray, parallel, picture,
    request, scene,
};

/// All tissue of a cube of 1 mm voxels moved by as much, also beyond its faces.
fn moved(voxels: &Voxels, moved: Vec3) -> Scene {
    let size = f64::from(voxels.grid().dimensions().x);
    with_nodes(
        voxels,
        DVec3::splat(-20.0),
        DVec3::splat(size + 40.0),
        moved,
    )
}

/// Eight nodes at the corners of a box, which all move by as much; they reach half a step farther.
fn with_nodes(voxels: &Voxels, origin: DVec3, step: DVec3, moved: Vec3) -> Scene {
    let mut scene = scene(voxels);
    scene.displace(&[Displacements {
        origin,
        step,
        size: UVec3::splat(2),
        moved: &[moved; 8],
    }]);
    scene
}

/// A ball beside the middle, far from the faces.
fn ball_at(size: u32, radius: f64, aside: DVec3) -> Voxels {
    let middle = DVec3::splat(f64::from(size) / 2.0) + aside;
    cube(size, |voxel| {
        let away = (voxel.as_dvec3() + 0.5 - middle).length();
        (500.0 + 60.0 * (radius - away)).clamp(0.0, 1000.0)
    })
}

#[test]
fn tissue_that_has_all_moved_by_voxels_looks_as_a_scan_whose_voxels_have() {
    let still = ball(56, 8.0);
    let aside = Vec3::new(3.0, -2.0, 9.0);
    let displaced = moved(&still, aside);
    let shifted = scene(&ball_at(56, 8.0, aside.as_dvec3()));
    let back = DVec3::new(0.3, 0.4, 0.85).normalize();
    let view = request(parallel(DVec3::splat(28.0), back, 56.0), 48);
    for blend in ALL {
        let mut look = appearance(blend, 0.5);
        // air has no extinction, also where its bricks are not leapt over
        look.transfer[0].value = 10.0;
        let drawn = picture(&displaced, &look, &view);
        let (mean, far) = difference(&drawn, &picture(&shifted, &look, &view));
        assert!(mean < 0.02 && far == 0.0, "{blend:?}: {mean} {far}");
        let (mean, _) = difference(&drawn, &picture(&scene(&still), &look, &view));
        assert!(mean > 1.0, "{blend:?}: {mean}");
    }
}

#[test]
fn a_surface_goes_along_by_parts_of_a_voxel() {
    let look = appearance(Blend::Iso, 1.0);
    let still = ball(32, 11.0);
    let depth = |scene: &Scene| one_ray(scene, &look, (16.5, 16.5)).depth;
    let before = depth(&scene(&still));
    for up in [0.3, -0.3, 0.7, 2.4] {
        let after = depth(&moved(&still, Vec3::new(0.0, 0.0, up)));
        assert_near(before - after, up, 0.05);
    }
    // nothing is displaced any more
    let mut back = moved(&still, Vec3::Z);
    back.displace(&[]);
    assert_eq!(depth(&back), before);
}

#[test]
fn tissue_is_seen_in_bricks_that_its_voxels_leave_empty() {
    // voxels of the second brick from below alone, which go up by one and a half
    let plate = cube(48, |voxel| {
        if (8..16).contains(&voxel.z) {
            1000.0
        } else {
            0.0
        }
    });
    let displaced = moved(&plate, Vec3::new(0.0, 0.0, 12.0));
    for blend in [Blend::Iso, Blend::Mip, Blend::Composite] {
        let look = appearance(blend, 5.0);
        let seen = one_ray(&displaced, &look, (24.5, 24.5));
        assert_near(seen.opacity, 1.0, 0.05);
        if blend != Blend::Mip {
            assert_near(seen.depth, 48.0 - 28.0, 1.0);
        }
    }
}

#[test]
fn beside_the_nodes_all_stays_as_it_is() {
    let still = ball(32, 11.0);
    // the box reaches from 0 to 12 along x
    let displaced = with_nodes(
        &still,
        DVec3::new(3.0, -20.0, -20.0),
        DVec3::new(6.0, 72.0, 72.0),
        Vec3::new(0.0, 0.0, 2.0),
    );
    for blend in ALL {
        let look = appearance(blend, 0.5);
        let [after, before] = [&displaced, &scene(&still)].map(|it| {
            [6.5, 11.5, 14.5, 20.5].map(|x| {
                let seen = one_ray(it, &look, (x, 17.5));
                (seen.colour, seen.opacity, seen.depth)
            })
        });
        // along the ray, that changes no sum and no extreme
        if blend.draws_solids() {
            assert_ne!(after[0], before[0], "{blend:?}");
        }
        assert_eq!(after[2..], before[2..], "{blend:?}");
    }
}

#[test]
fn voxels_of_a_segment_go_along() {
    let mut voxels = cube(16, |_| 0.0);
    let slab = Segment::from_fn(UVec3::splat(16), |voxel| voxel.z < 8);
    voxels.insert_segment(SegmentId(3), slab).unwrap();
    let mut look = appearance(Blend::Shaded, 0.1);
    look.segments.push(ShownSegment {
        id: 3,
        range: None,
        is_edited: false,
        shown: Shown::Solid,
        colour: COLOUR,
        ambient: 1.0,
        specular: 1.0,
    });
    let still = one_ray(&scene(&voxels), &look, (8.2, 8.2));
    let seen = one_ray(
        &moved(&voxels, Vec3::new(0.0, 0.0, 2.25)),
        &look,
        (8.2, 8.2),
    );
    assert_eq!((still.segment, seen.segment), (3, 3));
    assert_near(still.depth - seen.depth, 2.25, 0.05);
    assert_near(seen.colour.distance(still.colour), 0.0, 1e-3);
}

#[test]
fn nodes_that_are_no_numbers_move_nothing() {
    let still = ball(32, 11.0);
    let view = request(parallel(DVec3::splat(16.0), DVec3::Z, 40.0), 16);
    let look = appearance(Blend::Shaded, 0.5);
    let displaced = moved(&still, Vec3::new(f32::NAN, 1.0, f32::INFINITY));
    let (mean, _) = difference(
        &picture(&displaced, &look, &view),
        &picture(&scene(&still), &look, &view),
    );
    assert!(mean < 0.02, "{mean}");
    // and an edit leaves what is displaced
    let mut edited = moved(&still, Vec3::Z);
    edited.follow(still.clone());
    assert_ne!(
        one_ray(&edited, &look, (16.5, 16.5)).depth,
        one_ray(&scene(&still), &look, (16.5, 16.5)).depth
    );
}
