//! The voxels as they are: closed, of their volume, with the bodies that touch finds.

use crate::support::{assert_closed, ball, bits_where, cubes, noise, turned_slices};
use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_surface::kept::kept_surface;
use palpate_surface::mesh_bodies::{body_count, shell_volumes};
use palpate_surface::voxel_faces::voxel_faces;
use palpate_surface::{SurfaceSettings, VoxelSource};
use palpate_volume::bodies::Bodies;
use palpate_volume::grid::Grid;

#[test]
fn one_voxel_is_a_cube_of_its_volume() {
    let dimensions = UVec3::splat(5);
    let bits = bits_where(dimensions, |voxel| voxel == IVec3::new(4, 0, 2));
    let mesh = voxel_faces(&cubes(dimensions), &bits).mesh;
    assert_closed(&mesh);
    assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (8, 12));
    assert_eq!((mesh.volume(), mesh.area()), (1.0, 6.0));
    for (vertex, normal) in mesh.vertices.iter().zip(&mesh.normals) {
        let [vertex, normal] = [vertex, normal].map(|v| DVec3::from_array(v.map(f64::from)));
        let outward = (vertex - DVec3::new(4.5, 0.5, 2.5)).normalize();
        assert!((outward - normal).length() < 1e-6, "{outward} {normal}");
    }
}

#[test]
fn random_bits_give_closed_meshes_of_their_volume_and_bodies() {
    let dimensions = UVec3::new(41, 17, 26);
    for (seed, share) in [(1, 0.02), (2, 0.2), (3, 0.5), (4, 0.8), (5, 1.0)] {
        let bits = noise(dimensions, seed, share);
        for grid in [cubes(dimensions), turned_slices(dimensions)] {
            let faces = voxel_faces(&grid, &bits);
            assert_closed(&faces.mesh);
            let bodies = Bodies::of(&bits);
            let volume = bodies.voxel_count() as f64 * grid.spacing().element_product();
            // positions are of single precision
            let off = faces.mesh.volume() / volume - 1.0;
            assert!(off.abs() < 1e-5, "{share}: {off}");
            assert_eq!(body_count(&faces.mesh), bodies.count(), "{share}");
            assert_eq!(faces.touching_edges == 0, share == 1.0);
        }
    }
}

#[test]
fn every_bit_pattern_of_eight_voxels_is_closed() {
    let dimensions = UVec3::splat(2);
    for pattern in 1..256 {
        let bits = bits_where(dimensions, |v| {
            pattern >> (v.x + 2 * v.y + 4 * v.z) & 1 != 0
        });
        let mesh = voxel_faces(&cubes(dimensions), &bits).mesh;
        assert_closed(&mesh);
        assert_eq!(body_count(&mesh), Bodies::of(&bits).count(), "{pattern:b}");
    }
}

#[test]
fn a_cavity_is_a_shell_and_no_body() {
    let dimensions = UVec3::splat(5);
    let bits = bits_where(dimensions, |voxel| voxel != IVec3::splat(2));
    let mesh = voxel_faces(&cubes(dimensions), &bits).mesh;
    let volumes = shell_volumes(&mesh).into_iter();
    let told: Vec<_> = volumes.zip([125.0, -1.0]).collect();
    assert!(
        told.len() == 2 && told.iter().all(|(a, b)| (a - b).abs() < 1e-9),
        "{told:?}"
    );
    assert_eq!(body_count(&mesh), 1);
}

#[test]
fn faces_look_outward_in_left_handed_grids_too() {
    let dimensions = UVec3::splat(3);
    let mirror = DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0));
    let grid = Grid::new(dimensions, DVec3::ONE, DVec3::ZERO, mirror).unwrap();
    let bits = bits_where(dimensions, |voxel| voxel.x < 2);
    assert_eq!(voxel_faces(&grid, &bits).mesh.volume(), 18.0);
}

#[test]
fn smoothed_surfaces_have_the_bodies_of_their_voxels_and_coarse_ones_tell_theirs() {
    let dimensions = UVec3::new(24, 12, 12);
    // two blocks joined by a bridge of one voxel
    let bits = bits_where(dimensions, |v| {
        let in_block = (2..10).contains(&v.y) && (2..10).contains(&v.z);
        in_block && ((2..10).contains(&v.x) || (14..22).contains(&v.x))
            || (v.y, v.z) == (5, 5) && (2..22).contains(&v.x)
    });
    let of = |step, smoothing| {
        let settings = SurfaceSettings {
            step,
            smoothing,
            ..SurfaceSettings::default()
        };
        kept_surface(&cubes(dimensions), &VoxelSource::of_bits(&bits), settings).unwrap()
    };
    for (step, smoothing, expected) in [(1, 0, 1), (1, 3, 1), (2, 3, 2), (2, 0, 2)] {
        let kept = of(step, smoothing);
        assert_eq!(
            (kept.voxel_bodies, kept.bodies),
            (1, expected),
            "{step} {smoothing}"
        );
        assert_eq!(kept.voxel_volume, 1028.0);
    }
    assert!((of(1, 0).mesh.volume() - 1028.0).abs() < 1e-6);
}

#[test]
fn balls_are_one_body_far_from_zero_too() {
    let dimensions = UVec3::splat(40);
    let bits = ball(dimensions, DVec3::splat(20.0), 15.0);
    let grid = turned_slices(dimensions);
    let kept = kept_surface(
        &grid,
        &VoxelSource::of_bits(&bits),
        SurfaceSettings::default(),
    );
    let kept = kept.unwrap();
    assert_eq!((kept.voxel_bodies, kept.bodies), (1, 1));
    assert!((kept.mesh.volume() / kept.voxel_volume - 1.0).abs() < 0.02);
}
