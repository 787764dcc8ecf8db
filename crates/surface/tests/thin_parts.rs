//! What is thin keeps its volume, wherever it stands, and what cannot is told.

use crate::support::{
    assert_closed, ball, bits_where, cubes, euler_characteristic, noise, turned_slices,
};
use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_surface::kept::{KeptSurface, kept_surface};
use palpate_surface::mesh::joined;
use palpate_surface::{SegmentSurface, SurfaceSettings, VoxelSource};
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;

fn settings(smoothing: u8) -> SurfaceSettings {
    SurfaceSettings {
        smoothing,
        ..SurfaceSettings::default()
    }
}

fn kept(grid: &Grid, bits: &Bits, smoothing: u8) -> KeptSurface {
    kept_surface(grid, &VoxelSource::of_bits(bits), settings(smoothing)).unwrap()
}

type IsSolid = fn(IVec3) -> bool;

/// The same without a look at what is thin.
fn plain(grid: &Grid, bits: &Bits, smoothing: u8) -> palpate_surface::Patch {
    let mut surface = SegmentSurface::new(grid, settings(smoothing)).unwrap();
    surface.update(&VoxelSource::of_bits(bits), &grid.bounds());
    joined(&surface)
}

#[test]
fn voxels_lines_and_sheets_keep_their_volume() {
    let dimensions = UVec3::new(40, 18, 22);
    let mirror = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
    let mirrored = Grid::new(dimensions, DVec3::splat(0.5), DVec3::ONE, mirror).unwrap();
    let bodies: [(&str, IsSolid); 6] = [
        ("voxel", |v| v == IVec3::new(5, 6, 7)),
        ("line", |v| (v.y, v.z) == (6, 7) && (4..30).contains(&v.x)),
        ("diagonal", |v| {
            v.x == v.y && v.z == 7 && (2..16).contains(&v.x)
        }),
        ("sheet", |v| {
            v.z == 7 && (4..30).contains(&v.x) && (3..15).contains(&v.y)
        }),
        ("rod of two", |v| {
            (3..5).contains(&v.y) && (3..5).contains(&v.z) && (4..30).contains(&v.x)
        }),
        ("at the border", |v| (v.y, v.z) == (0, 0)),
    ];
    for (name, is_solid) in bodies {
        let bits = bits_where(dimensions, is_solid);
        for grid in [cubes(dimensions), turned_slices(dimensions), mirrored] {
            for smoothing in [1, 3, 8] {
                let kept = kept(&grid, &bits, smoothing);
                assert_closed(&kept.mesh);
                let share = kept.mesh.volume() / kept.voxel_volume;
                assert!((share - 1.0).abs() < 0.01, "{name}, {smoothing}: {share}");
                let [part] = kept.thin_parts[..] else {
                    panic!("{name}: {} parts", kept.thin_parts.len());
                };
                // what is told of parts is what the mesh has
                assert!(
                    (part.kept / kept.mesh.volume() - 1.0).abs() < 1e-4,
                    "{part:?}"
                );
                assert_eq!(part.expected, part.voxel_volume);
            }
        }
    }
}

#[test]
fn of_random_bits_the_parts_tell_what_the_mesh_has() {
    let dimensions = UVec3::new(41, 19, 26);
    for (seed, share) in [(1, 0.02), (2, 0.15), (3, 0.4)] {
        let bits = noise(dimensions, seed, share);
        let grid = turned_slices(dimensions);
        let (kept, plain) = (kept(&grid, &bits, 3), plain(&grid, &bits, 3));
        assert_closed(&kept.mesh);
        assert_eq!(kept.mesh.triangles, plain.triangles);
        assert_eq!(kept.bodies, kept.voxel_bodies);
        let told: f64 = kept.thin_parts.iter().map(|part| part.kept).sum();
        if share < 0.1 {
            // all of it is thin
            assert!((told / kept.mesh.volume() - 1.0).abs() < 1e-4);
            assert!((told / kept.voxel_volume - 1.0).abs() < 0.01);
        }
    }
}

#[test]
fn a_plate_between_blocks_keeps_its_volume_and_the_blocks_stay_as_they_are() {
    let dimensions = UVec3::new(60, 24, 24);
    let grid = cubes(dimensions);
    let in_blocks = |v: IVec3| {
        (2..22).contains(&v.y)
            && (2..22).contains(&v.z)
            && ((2..20).contains(&v.x) || (40..58).contains(&v.x))
    };
    let in_plate = |v: IVec3| v.z == 12 && (4..20).contains(&v.y) && (2..58).contains(&v.x);
    let bits = bits_where(dimensions, |v| in_blocks(v) || in_plate(v));
    let (kept, plain) = (kept(&grid, &bits, 3), plain(&grid, &bits, 3));
    let [part] = kept.thin_parts[..] else {
        panic!("{} parts", kept.thin_parts.len());
    };
    // a row beside each block is relief
    assert_eq!(part.voxel_volume, 18.0 * 16.0);
    assert!((part.kept / part.expected - 1.0).abs() < 1e-4, "{part:?}");
    assert!(
        (20.0..40.0).contains(&part.place.x) && part.place.z == 12.5,
        "{part:?}"
    );
    for (before, after) in plain.vertices.iter().zip(&kept.mesh.vertices) {
        let is_block = !(20.4..39.6).contains(&f64::from(before[0]));
        assert!(!is_block || before == after, "{before:?} {after:?}");
    }
}

#[test]
fn what_is_thick_and_its_relief_stay_as_they_are() {
    let dimensions = UVec3::splat(44);
    let centre = DVec3::splat(22.5);
    // with a voxel that stands out at each pole
    let bits = ball(dimensions, centre, 16.0);
    let grid = cubes(dimensions);
    let kept = kept(&grid, &bits, 3);
    assert_eq!(kept.thin_parts, []);
    assert_eq!(kept.mesh, plain(&grid, &bits, 3));
    assert_eq!(euler_characteristic(&kept.mesh), 2);
}

#[test]
fn a_step_that_leaves_out_a_thin_part_tells_where() {
    let dimensions = UVec3::splat(32);
    let bits = bits_where(dimensions, |v| {
        (v.as_dvec3() + 0.5 - 12.0).length() < 8.0
            || (v.y, v.z) == (12, 12) && (12..30).contains(&v.x)
    });
    let settings = SurfaceSettings {
        step: 2,
        ..settings(3)
    };
    let kept = kept_surface(&cubes(dimensions), &VoxelSource::of_bits(&bits), settings).unwrap();
    assert_eq!((kept.bodies, kept.voxel_bodies), (1, 1));
    let [part] = kept.thin_parts[..] else {
        panic!("{} parts", kept.thin_parts.len());
    };
    assert!(part.expected >= 8.0 && part.kept == 0.0, "{part:?}");
    assert!(
        (21.0..30.0).contains(&part.place.x) && part.place.y == 12.5,
        "{part:?}"
    );
}

/// Tubes as a scan has them: each voxel by the share of it that the tube takes.
mod partial_volume {
    use super::*;
    use palpate_surface::Limits;
    use palpate_volume::intensities::Intensities;
    use palpate_volume::threshold::threshold;
    use palpate_volume::voxel_box::VoxelBox;
    use std::f64::consts::PI;

    /// Share of a voxel within a tube along a direction through a point, by 8³ samples.
    fn share(voxel: IVec3, through: DVec3, along: DVec3, radius: f64, ends: [f64; 2]) -> f64 {
        let inside = VoxelBox::of_dimensions(UVec3::splat(8))
            .voxels()
            .filter(|&sample| {
                let from = voxel.as_dvec3() + (sample.as_dvec3() + 0.5) / 8.0 - through;
                let way = from.dot(along);
                (ends[0]..ends[1]).contains(&way) && (from - way * along).length() <= radius
            });
        inside.count() as f64 / 512.0
    }

    #[test]
    fn vessels_of_under_two_voxels_keep_their_volume() {
        let dimensions = UVec3::new(28, 13, 13);
        let grid = cubes(dimensions);
        let mut random = oorandom::Rand64::new(12);
        for round in 0..24 {
            let radius = [0.7, 0.8, 0.95][round % 3];
            let off = DVec3::from_array([(); 3].map(|()| random.rand_float() - 0.5));
            let along = if round < 12 {
                DVec3::X
            } else {
                (DVec3::X + 0.3 * off).normalize()
            };
            let through = dimensions.as_dvec3() / 2.0 + off;
            let values: Vec<i16> = VoxelBox::of_dimensions(dimensions)
                .voxels()
                .map(|voxel| {
                    let noise = 40.0 * (random.rand_float() - 0.5);
                    let share = share(voxel, through, along, radius, [-9.0, 9.0]);
                    (1000.0 * share + noise).round() as i16
                })
                .collect();
            let scan = Intensities::new(dimensions, values, 1.0, 0.0).unwrap();
            let segment = threshold(&scan, None, 500.0, f64::INFINITY);
            let voxels = VoxelSource {
                bits: segment.occupancy(),
                values: Some((&scan, None)),
            };
            let limits = Some(Limits {
                low: 500.0,
                high: f64::INFINITY,
            });
            let settings = SurfaceSettings {
                limits,
                ..settings(3)
            };
            let kept = kept_surface(&grid, &voxels, settings).unwrap();
            let truth = PI * radius * radius * 18.0;
            let [expected, held] = [kept.expected_volume(), kept.mesh.volume()].map(|v| v / truth);
            // noise of 2 % of the contrast moves the estimate by as much; edges are no longer than
            // they are
            assert!(
                (expected - 1.0).abs() < 0.04,
                "{radius} {along}: {expected}"
            );
            assert!((held - 1.0).abs() < 0.05, "{radius} {along}: {held}");
        }
    }
}
