//! Surfaces are closed, whatever the bits.

use crate::support::{
    assert_closed, ball, bits_where, cubes, euler_characteristic, mesh, noise, settings, surface,
    turned_slices,
};
use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_surface::cell_table::{cell_table, middle_of};
use palpate_surface::{SmoothingMode, SurfaceSettings};
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;

#[test]
fn no_case_draws_a_diagonal_on_a_face_of_the_cell() {
    for (case, cell) in cell_table().iter().enumerate() {
        let mut edges = std::collections::HashSet::new();
        for &[a, b, c] in &cell.triangles {
            edges.extend([(a, b), (b, c), (c, a)]);
        }
        for &(a, b) in &edges {
            // an inner diagonal has a triangle on both sides
            if edges.contains(&(b, a)) {
                let [from, to] = [a, b].map(|edge| middle_of(usize::from(edge)));
                let on_face = (0..3).any(|axis| from[axis] == to[axis] && from[axis] != 1);
                assert!(!on_face, "case {case}: {a} {b}");
            }
        }
    }
}

#[test]
fn every_crossed_edge_of_a_cell_has_a_triangle_and_no_other_has() {
    for (case, cell) in cell_table().iter().enumerate() {
        for edge in 0..12 {
            let ends = (0..8usize).filter(|corner| {
                let place = [corner & 1, corner >> 1 & 1, corner >> 2].map(|n| 2 * n as u32);
                let middle = middle_of(edge);
                (0..3).all(|axis| middle[axis].abs_diff(place[axis]) <= 1)
                    && (0..3).filter(|&axis| middle[axis] != place[axis]).count() == 1
            });
            let ends: Vec<_> = ends.map(|corner| case >> corner & 1).collect();
            assert_eq!(ends.len(), 2);
            let used = cell
                .triangles
                .iter()
                .flatten()
                .any(|&used| usize::from(used) == edge);
            assert_eq!(used, ends[0] != ends[1], "case {case}, edge {edge}");
        }
    }
}

#[test]
fn random_bits_give_closed_surfaces_with_every_step_and_degree() {
    let dimensions = UVec3::new(41, 37, 70);
    for (seed, share) in [(1, 0.02), (2, 0.3), (3, 0.5), (4, 0.8), (5, 0.98)] {
        let bits = noise(dimensions, seed, share);
        for step in [1, 2, 4] {
            for smoothing in [0, 1, 4] {
                let settings = SurfaceSettings {
                    step,
                    ..settings(smoothing)
                };
                let mesh = mesh(&turned_slices(dimensions), &bits, settings);
                assert!(step > 1 || !mesh.is_empty());
                assert_closed(&mesh);
            }
        }
    }
}

#[test]
fn without_smoothing_the_mode_makes_no_difference_and_seams_are_closed() {
    let dimensions = UVec3::new(70, 40, 33);
    let bits = noise(dimensions, 9, 0.4);
    let local = SurfaceSettings {
        mode: SmoothingMode::Local,
        ..settings(0)
    };
    let mesh_of = |settings| mesh(&cubes(dimensions), &bits, settings);
    assert_closed(&mesh_of(local));
    assert_eq!(mesh_of(local), mesh_of(settings(0)));
}

#[test]
fn nothing_solid_has_no_surface() {
    let dimensions = UVec3::new(64, 8, 9);
    let surface = surface(&cubes(dimensions), &Bits::empty(dimensions), settings(3));
    assert_eq!(surface.patches().len(), 0);
    assert_eq!(surface.bounds(), None);
    assert_eq!((surface.area(), surface.volume()), (0.0, 0.0));
}

#[test]
fn a_full_volume_is_closed_on_its_border() {
    for dimensions in [
        UVec3::splat(1),
        UVec3::new(64, 32, 96),
        UVec3::new(33, 31, 100),
    ] {
        let bits = bits_where(dimensions, |_| true);
        let surface = surface(&cubes(dimensions), &bits, settings(0));
        let mesh = palpate_surface::mesh::joined(&surface);
        assert_closed(&mesh);
        assert_eq!(euler_characteristic(&mesh), 2);
        // positions are counted from the corner of the grid: the surface lies on its border
        let bounds = surface.bounds().unwrap();
        assert_eq!(bounds.min.as_dvec3(), DVec3::ZERO);
        assert_eq!(bounds.max.as_dvec3(), dimensions.as_dvec3());
    }
}

#[test]
fn one_voxel_is_an_octahedron_around_its_middle() {
    let dimensions = UVec3::splat(5);
    let bits = bits_where(dimensions, |voxel| voxel == IVec3::new(4, 0, 2));
    let mesh = mesh(&cubes(dimensions), &bits, settings(0));
    assert_closed(&mesh);
    assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (6, 8));
    // an octahedron of radius 0.5 has a volume of 4/3 · 0.125
    assert!(
        (mesh.volume() - 1.0 / 6.0).abs() < 1e-6,
        "{}",
        mesh.volume()
    );
    for (position, normal) in mesh.vertices.iter().zip(&mesh.normals) {
        let outward = DVec3::from_array(position.map(f64::from)) - DVec3::new(4.5, 0.5, 2.5);
        let normal = DVec3::from_array(normal.map(f64::from));
        assert!(
            (outward * 2.0 - normal).length() < 1e-6,
            "{outward} {normal}"
        );
    }
}

#[test]
fn balls_rings_and_hollow_balls_have_their_euler_characteristic() {
    let dimensions = UVec3::splat(50);
    let middle = DVec3::splat(25.0);
    let ring = |voxel: IVec3| {
        let from = voxel.as_dvec3() + 0.5 - middle;
        (from.truncate().length() - 15.0).hypot(from.z) <= 5.0
    };
    let shell = |voxel: IVec3| {
        let distance = (voxel.as_dvec3() + 0.5).distance(middle);
        (10.0..=14.0).contains(&distance)
    };
    let bodies = [
        (ball(dimensions, middle, 17.3), 2),
        (bits_where(dimensions, ring), 0),
        (bits_where(dimensions, shell), 4),
    ];
    for smoothing in [0, 3] {
        for (bits, expected) in &bodies {
            let mesh = mesh(&turned_slices(dimensions), bits, settings(smoothing));
            assert_closed(&mesh);
            assert_eq!(euler_characteristic(&mesh), *expected);
        }
    }
}

#[test]
fn voxels_that_share_an_edge_are_one_body_and_those_that_share_a_corner_are_two() {
    let dimensions = UVec3::splat(4);
    for (second, expected) in [(IVec3::new(2, 2, 1), 2), (IVec3::new(2, 2, 2), 4)] {
        let bits = bits_where(dimensions, |voxel| voxel == IVec3::ONE || voxel == second);
        let mesh = mesh(&cubes(dimensions), &bits, settings(0));
        assert_closed(&mesh);
        assert_eq!(euler_characteristic(&mesh), expected);
    }
}

#[test]
fn triangles_turn_toward_free_space_in_left_handed_grids_too() {
    let dimensions = UVec3::splat(20);
    let bits = ball(dimensions, DVec3::splat(10.0), 7.0);
    let mirror = DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0));
    let mirrored = Grid::new(dimensions, DVec3::ONE, DVec3::ZERO, mirror).unwrap();
    for grid in [cubes(dimensions), mirrored] {
        for smoothing in [0, 3] {
            let mesh = mesh(&grid, &bits, settings(smoothing));
            assert!(mesh.volume() > 1000.0, "{}", mesh.volume());
            for triangle in &mesh.triangles {
                let [a, b, c] =
                    triangle.map(|i| DVec3::from_array(mesh.vertices[i as usize].map(f64::from)));
                let face = (b - a).cross(c - a);
                for vertex in triangle {
                    let normal = DVec3::from_array(mesh.normals[*vertex as usize].map(f64::from));
                    assert!((normal.length() - 1.0).abs() < 1e-5);
                    assert!(face.dot(normal) >= -1e-6, "{face} {normal}");
                }
            }
        }
    }
}
