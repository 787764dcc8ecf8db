//! The start of the proxy against a search of all voxels.

use crate::support::{Body, Random, SPACINGS, grid, noise, rotation};
use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_haptics::admission::{nearest_free, nearest_free_in};
use palpate_haptics::scene::{Object, ObjectPose, TouchScene};
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;

#[test]
fn a_free_point_is_its_own_place() {
    let solid = Body(|v: IVec3| v.z < 0);
    let grid = grid(UVec3::splat(8), DVec3::ONE);
    let point = DVec3::new(2.25, 3.5, 0.125);
    let proxy = nearest_free(&solid, &grid, point, 4).expect("free");
    assert_eq!(proxy.point(), point);
}

#[test]
fn no_free_voxel_is_nearer_than_the_one_found() {
    let mut random = Random::new(4);
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(24), spacing);
        for share in [0.6, 0.95, 0.995] {
            let solid = noise(24, share, 8);
            for _ in 0..100 {
                let point = random.point(0.0, 24.0);
                let found = nearest_free(&solid, &grid, point, 30).expect("outside is free");
                assert!(!solid.is_solid(found.voxel()));
                assert_eq!(found.point().floor().as_ivec3(), found.voxel());

                let distance = |at: DVec3| ((at - point) * spacing).length();
                let nearest_point =
                    |voxel: IVec3| point.clamp(voxel.as_dvec3(), voxel.as_dvec3() + 1.0);
                let best = VoxelBox::of_dimensions(UVec3::splat(24))
                    .dilate(1)
                    .voxels()
                    .filter(|&voxel| !solid.is_solid(voxel))
                    .map(|voxel| distance(nearest_point(voxel)))
                    .fold(f64::INFINITY, f64::min);
                // the skin inside the voxel, along three axes of up to 2.5 mm
                assert!(distance(found.point()) <= best + 1e-7);
            }
        }
    }
}

#[test]
fn nothing_is_found_where_all_is_solid_or_the_point_is_none() {
    let solid = Body(|_: IVec3| true);
    let grid = grid(UVec3::splat(8), DVec3::ONE);
    assert_eq!(nearest_free(&solid, &grid, DVec3::ONE, 6), None);
    assert_eq!(nearest_free(&solid, &grid, DVec3::ONE, -1), None);
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let point = DVec3::new(0.5, bad, 0.5);
        assert_eq!(nearest_free(&solid, &grid, point, 6), None);
    }
}

#[test]
fn among_objects_the_place_found_is_free_in_all_and_as_near_as_voxels_allow() {
    let solids = [noise(20, 0.7, 1), noise(20, 0.7, 2)];
    let world_grid = grid(UVec3::splat(20), DVec3::ONE);
    let own = grid(UVec3::splat(20), DVec3::splat(1.2));
    let mut random = Random::new(8);
    let turn = rotation(&mut random);
    let pose =
        DAffine3::from_mat3_translation(turn, DVec3::splat(10.0) - turn * DVec3::splat(12.0));
    let pose = ObjectPose::new(&own, &world_grid, pose).expect("rigid");
    let objects = [Object::new(solids[1].clone(), &own, own.bounds(), pose)];
    let scene = TouchScene {
        occupancy: &solids[0],
        grid: &world_grid,
        objects: &objects,
    };
    for _ in 0..40 {
        let point = random.point(0.0, 20.0);
        let found = nearest_free_in(&scene, point, 40).expect("outside is free");
        assert_eq!(scene.solid_at(found.point()), None);
        // no third of a voxel has a free middle that is nearer
        let distance = found.point().distance(point);
        let thirds = VoxelBox::of_dimensions(UVec3::splat(66)).voxels();
        let nearer = thirds
            .map(|third| (third.as_dvec3() + 0.5) / 3.0 - 1.0)
            // 1e-9: rounding of the same point, made in two ways
            .filter(|other| other.distance(point) < distance - 1e-9)
            .find(|&other| scene.solid_at(other).is_none());
        assert_eq!(nearer, None, "{point} {found:?}");
    }
    let full = [Body(|_: IVec3| true)];
    let scene = TouchScene::of_world(&full, &world_grid);
    assert_eq!(nearest_free_in(&scene, DVec3::ONE, 5), None);
    assert_eq!(nearest_free_in(&scene, DVec3::NAN, 5), None);
}
