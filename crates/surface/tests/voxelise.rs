//! Meshes become the voxels whose middles they enclose.

use crate::support::{ball, cubes, mesh, noise, settings};
use glam::{DVec3, IVec3, UVec3};
use palpate_surface::voxelise::{Filling, MeshError, voxelise};
use palpate_volume::bits::Bits;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

fn points(mesh: &palpate_surface::Patch) -> Vec<DVec3> {
    let vertices = mesh.vertices.iter();
    vertices
        .map(|vertex| DVec3::from_array(vertex.map(f64::from)))
        .collect()
}

fn count(bits: &Bits) -> u64 {
    Segment::from_bits(bits.clone()).count()
}

#[test]
fn the_surface_of_any_bits_gives_the_same_bits_again() {
    let dimensions = UVec3::new(40, 33, 36);
    for (seed, share) in [(1, 0.1), (2, 0.5), (3, 0.9)] {
        let bits = noise(dimensions, seed, share);
        for smoothing in [0, 3] {
            let mesh = mesh(&cubes(dimensions), &bits, settings(smoothing));
            let again =
                voxelise(dimensions, &points(&mesh), &mesh.triangles, Filling::Solid).unwrap();
            assert!(again.difference(&bits).is_empty());
        }
    }
}

#[test]
fn a_box_whose_edges_run_through_middles_of_voxels_is_as_large_as_it_is() {
    // every line through the middles of a column meets edges and corners
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    let vertices: Vec<_> = (0..8).map(|i| corner(i) * 4.0 + 2.5).collect();
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles: Vec<[u32; 3]> = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    let dimensions = UVec3::splat(10);
    let bits = voxelise(dimensions, &vertices, &triangles, Filling::Solid).unwrap();
    // each border goes to one side: 4 voxels along each axis
    assert_eq!(count(&bits), 64);

    let turned: Vec<_> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let inside_out = voxelise(dimensions, &vertices, &turned, Filling::Solid).unwrap();
    assert_eq!(count(&inside_out), 64);
}

#[test]
fn bodies_that_overlap_are_joined() {
    let dimensions = UVec3::splat(32);
    let [a, b] = [13.0, 19.0].map(|x| ball(dimensions, DVec3::new(x, 16.0, 16.0), 8.0));
    let [first, second] = [&a, &b].map(|bits| mesh(&cubes(dimensions), bits, settings(0)));
    let mut vertices = points(&first);
    let offset = vertices.len() as u32;
    vertices.extend(points(&second));
    let moved = second.triangles.iter().map(|t| t.map(|v| v + offset));
    let triangles: Vec<_> = first.triangles.iter().copied().chain(moved).collect();
    let bits = voxelise(dimensions, &vertices, &triangles, Filling::Solid).unwrap();
    for voxel in VoxelBox::of_dimensions(dimensions).voxels() {
        assert_eq!(bits.is_solid(voxel), a.is_solid(voxel) || b.is_solid(voxel));
    }
}

#[test]
fn a_shell_holds_every_voxel_of_random_points_of_its_triangles_and_none_far_away() {
    let dimensions = UVec3::splat(20);
    let mut random = oorandom::Rand64::new(4);
    for _ in 0..50 {
        let corners =
            [(); 3].map(|()| DVec3::from_array([(); 3].map(|()| 1.0 + 18.0 * random.rand_float())));
        let bits = voxelise(dimensions, &corners, &[[0, 1, 2]], Filling::Shell).unwrap();
        for _ in 0..200 {
            let (u, v) = (random.rand_float(), random.rand_float());
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            let point = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
            assert!(bits.is_solid(point.floor().as_ivec3()), "{point}");
        }
        let normal = (corners[1] - corners[0])
            .cross(corners[2] - corners[0])
            .normalize();
        for voxel in VoxelBox::of_dimensions(dimensions).voxels() {
            let distance = (voxel.as_dvec3() + 0.5 - corners[0]).dot(normal).abs();
            // from its middle to a corner
            assert!(!bits.is_solid(voxel) || distance <= 0.75f64.sqrt() + 1e-9);
        }
    }
}

#[test]
fn what_lies_beyond_the_grid_is_cut() {
    let large = ball(UVec3::splat(40), DVec3::splat(20.0), 15.0);
    let mesh = mesh(&cubes(UVec3::splat(40)), &large, settings(0));
    for offset in [DVec3::splat(-20.0), DVec3::new(-10.0, 5.0, -30.0)] {
        let moved: Vec<_> = points(&mesh).iter().map(|point| *point + offset).collect();
        let bits = voxelise(UVec3::splat(20), &moved, &mesh.triangles, Filling::Solid).unwrap();
        let shift = offset.as_ivec3();
        for voxel in VoxelBox::of_dimensions(UVec3::splat(20)).voxels() {
            assert_eq!(
                bits.is_solid(voxel),
                large.is_solid(voxel - shift),
                "{voxel}"
            );
        }
    }
    let nothing = voxelise(UVec3::splat(4), &[], &[], Filling::Solid).unwrap();
    assert!(!nothing.is_solid(IVec3::ZERO));
}

#[test]
fn meshes_that_lie_are_refused() {
    let make = |vertices: &[DVec3], triangles: &[[u32; 3]]| {
        voxelise(UVec3::splat(4), vertices, triangles, Filling::Shell).unwrap_err()
    };
    let three = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let error = make(&three, &[[0, 1, 2], [0, 1, 3]]);
    assert!(matches!(
        error,
        MeshError::Vertex {
            triangle: 1,
            vertex: 3,
            last: 2
        }
    ));
    for bad in [f64::NAN, f64::INFINITY, 1e30] {
        let error = make(&[DVec3::ZERO, DVec3::splat(bad)], &[]);
        assert!(
            matches!(error, MeshError::Point { vertex: 1, .. }),
            "{error}"
        );
    }
}
