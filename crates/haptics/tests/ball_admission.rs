//! Voxels and radii that change while a ball touches.

use crate::support::{
    Body, Random, SPACINGS, advance, distance_to_solid, grid, hard, noise, probe_solid,
};
use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_haptics::admission::{Admission, admit, nearest_free};
use palpate_haptics::ball::{Ball, BallShape, MAX_BODIES, MAX_REACH, ProbeSolid, admit_radius};
use palpate_haptics::contact::Proxy;
use palpate_haptics::scene::{Object, ObjectPose, TouchScene};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

#[test]
fn an_edit_is_felt_at_the_next_update() {
    let spacing = DVec3::ONE;
    let grid = grid(UVec3::splat(64), spacing);
    let floor = |hole: bool| {
        Segment::from_fn(UVec3::splat(64), move |v| {
            let in_hole = (v - 32).truncate().abs().max_element() <= 5;
            v.z < 30 && !(hole && in_hole && v.z >= 20)
        })
    };
    let changed = VoxelBox::new(IVec3::new(27, 27, 20), IVec3::new(38, 38, 30));
    let mut probe = probe_solid(floor(false), 2.0, spacing);
    let mut proxy = Proxy::at(DVec3::new(32.5, 32.5, 40.0)).expect("finite");
    let device = DVec3::new(32.5, 32.5, 21.0);
    assert!(advance(&probe, &grid, device, &mut proxy).touching);
    assert_eq!(proxy.voxel().z, 32);

    // the hole is cleared: at once the ball falls to its floor
    probe.change(&changed, |voxels| *voxels = floor(true));
    advance(&probe, &grid, device, &mut proxy);
    assert_eq!(proxy.voxel().z, 22);

    // it is filled again: the ball is in the way, and is pushed no further than 7 voxels
    let filled = floor(false);
    let mut spare = hard(0.0, spacing);
    let new = probe.among(&filled, &mut spare);
    assert_eq!(admit(&probe, &new, &grid, &mut proxy), Admission::Held);

    // out of the hole it is in nobody's way
    advance(&probe, &grid, device.with_z(31.0), &mut proxy);
    let new = probe.among(&filled, &mut spare);
    let voxel = IVec3::new(32, 32, 32);
    let admission = admit(&probe, &new, &grid, &mut proxy);
    assert_eq!(admission, Admission::Pushed { voxel });
    probe.change(&changed, |voxels| *voxels = filled);
    advance(&probe, &grid, device, &mut proxy);
    assert_eq!(proxy.voxel().z, 32);
}

fn spares(spacing: DVec3) -> [Ball; MAX_BODIES] {
    std::array::from_fn(|_| hard(0.0, spacing))
}

/// Takes a step toward a radius [mm] where it is admitted.
fn step_toward<O: Occupancy>(
    radius: f64,
    probe: &mut ProbeSolid<O>,
    grid: &Grid,
    (spares, proxy): (&mut [Ball; MAX_BODIES], &mut Proxy),
) -> Admission {
    let next = probe.shape().toward(radius);
    let scene = TouchScene::of_world(&*probe, grid);
    let admission = admit_radius(&scene, next, spares, proxy).expect("within the window");
    if admission != Admission::Held {
        probe.set_radius(next).expect("within the window");
    }
    admission
}

/// From a point on a floor up to the largest radius, and below a ceiling as far as it goes.
#[test]
fn a_radius_is_raised_step_by_step_as_far_as_there_is_room() {
    for spacing in SPACINGS {
        for ceiling in [1000, 31] {
            let grid = grid(UVec3::splat(64), spacing);
            let body = Body(move |v: IVec3| v.z < 20 || v.z >= ceiling);
            let mut probe = probe_solid(body, 0.0, spacing);
            let mut spares = spares(spacing);
            let mut proxy = Proxy::at(DVec3::splat(20.5)).expect("finite");
            let target = BallShape::largest_radius(spacing);
            let mut admission = Admission::Free;
            for _ in 0..MAX_REACH {
                admission = step_toward(target, &mut probe, &grid, (&mut spares, &mut proxy));
                assert!(!probe.is_solid(proxy.voxel()));
            }
            let shape = *probe.shape();
            // eleven voxels between floor and ceiling: one cell, and the reach on either side
            let room = if ceiling == 31 { 5.0 * spacing.z } else { 1e9 };
            let missing = room.min(target) - shape.radius_mm();
            // rounding of a sum of 16 lengths
            assert!((-1e-9..=spacing.min_element()).contains(&missing));
            assert_eq!(admission == Admission::Held, room < target);
            // smaller is always admitted, at once
            let admission = step_toward(0.0, &mut probe, &grid, (&mut spares, &mut proxy));
            assert_eq!(admission, Admission::Free);
            assert_eq!(probe.shape().radius_mm(), 0.0);
        }
    }
}

/// A ball that grows is asked for in the grid of each body, and pushed by objects too.
#[test]
fn an_object_pushes_a_ball_that_grows_and_holds_it_where_there_is_no_room() {
    let spacing = DVec3::ONE;
    let grid = grid(UVec3::splat(64), spacing);
    let slab = |low, high| Body(move |v: IVec3| (low..high).contains(&v.z));
    let mut world = probe_solid(slab(-100, 20), 0.0, spacing);
    let shifted = DAffine3::from_translation(DVec3::Z * 2.0);
    let pose = ObjectPose::new(&grid, &grid, shifted).expect("rigid");
    // as an object, a ceiling from z = 31 on: eleven voxels are between
    let lid = probe_solid(slab(29, 40), 0.0, spacing);
    let bounds = VoxelBox::new(IVec3::new(-64, -64, 29), IVec3::new(128, 128, 40));
    let mut objects = [Object::new(lid, &grid, bounds, pose)];
    let mut spares = spares(spacing);
    let mut proxy = Proxy::at(DVec3::new(20.5, 20.5, 29.5)).expect("finite");
    for radius in 1..=8 {
        let radius = f64::from(radius);
        let scene = TouchScene {
            occupancy: &world,
            grid: &grid,
            objects: &objects,
        };
        let admission = admit_radius(&scene, radius, &mut spares, &mut proxy).expect("fits");
        // a ball of 5 has one cell in the middle
        assert_eq!(admission == Admission::Held, radius > 5.0, "{radius}");
        if admission != Admission::Held {
            world.set_radius(radius).expect("fits");
            objects[0].set_radius(radius).expect("fits");
        }
        assert!(objects[0].solid_at(proxy.point()).is_none() && !world.is_solid(proxy.voxel()));
    }
    assert_eq!(proxy.voxel().z, 25);
    assert_eq!(objects[0].bounds().min.z, 29 - 5);
    // a radius beyond the window is an error, and changes nothing
    let scene = TouchScene {
        occupancy: &world,
        grid: &grid,
        objects: &objects,
    };
    assert!(admit_radius(&scene, 17.0, &mut spares, &mut proxy).is_err());
    assert!(objects[0].set_radius(f64::NAN).is_err());
    assert_eq!(objects[0].bounds().min.z, 29 - 5);
}

/// Boxes filled and cleared around a ball that moves, while its radius changes as well: it never
/// overlaps a voxel, and what is kept never differs from what is computed anew.
#[test]
fn edits_and_radii_never_make_the_ball_overlap_a_voxel() {
    const SIZE: u32 = 32;
    let mut counts = [0; 3];
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(SIZE), spacing);
        let mut random = Random::new(3);
        let mut probe = probe_solid(noise(SIZE, 0.004, 1), 2.0, spacing);
        let mut spare = hard(0.0, spacing);
        let mut spares = spares(spacing);
        let mut proxy = nearest_free(&probe, &grid, DVec3::splat(16.0), 15).expect("free");
        for _ in 0..3000 {
            let device = proxy.point() + random.direction() * random.between(0.0, 6.0);
            let device = device.clamp(DVec3::splat(2.0), DVec3::splat(30.0));
            advance(&probe, &grid, device, &mut proxy);

            // a box near the ball
            let size = [1, 2, 3, 5, 17][random.below(5)];
            let middle = (proxy.point() + random.point(-4.0, 4.0)).floor().as_ivec3();
            let changed = VoxelBox::new(middle - size / 2, middle - size / 2 + size);
            let fill = random.below(3) == 0;
            let old = probe.inner();
            let new = Segment::from_fn(old.dimensions(), |voxel| {
                if changed.contains(voxel) {
                    fill
                } else {
                    old.is_solid(voxel)
                }
            });
            let admission = admit(&probe, &probe.among(&new, &mut spare), &grid, &mut proxy);
            counts[match admission {
                Admission::Free => 0,
                Admission::Pushed { .. } => 1,
                Admission::Held => 2,
            }] += 1;
            if admission != Admission::Held {
                probe.change(&changed, |voxels| *voxels = new);
            }

            // another radius, up to 4 h
            let radius = random.between(0.0, 4.0) * spacing.min_element();
            step_toward(radius, &mut probe, &grid, (&mut spares, &mut proxy));

            let distance = distance_to_solid(probe.inner(), spacing, proxy.point(), 6);
            // rounding of lengths of some 10 mm
            assert!(distance >= probe.shape().radius_mm() - 1e-9);
            let anew = Ball::new(*probe.shape());
            let block = proxy.voxel() - 4;
            assert_eq!(probe.block(block), anew.dilate(probe.inner()).block(block));
        }
    }
    // the test means something only if all three happen
    assert!(counts.iter().all(|&count| count > 20), "{counts:?}");
}
