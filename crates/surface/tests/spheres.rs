//! Smoothed spheres keep their area and volume, and what is thin its thickness.

use std::f64::consts::PI;

use crate::support::{ball, bits_where, cubes, mesh, settings, surface, turned_slices};
use glam::{DVec3, IVec3, UVec3};
use palpate_surface::{SurfaceSettings, VoxelSource};
use palpate_volume::segment::Segment;

/// Shares by which the smoothed surface of a ball differs from the sphere in area and volume,
/// and by which the ball's voxels do in volume.
fn errors_of_ball(radius: f64, offset: DVec3, degree: u8) -> [f64; 3] {
    let dimensions = UVec3::splat(2 * radius as u32 + 8);
    let centre = dimensions.as_dvec3() / 2.0 + offset;
    let bits = ball(dimensions, centre, radius);
    let surface = surface(&cubes(dimensions), &bits, settings(degree));
    let voxels = Segment::from_bits(bits).count() as f64;
    let (area, volume) = (4.0 * PI * radius.powi(2), 4.0 / 3.0 * PI * radius.powi(3));
    let told = [
        surface.area() / area,
        surface.volume() / volume,
        voxels / volume,
    ];
    told.map(|share| share - 1.0)
}

fn random_offsets(seed: u128) -> impl Iterator<Item = DVec3> {
    let mut random = oorandom::Rand64::new(seed);
    std::iter::repeat_with(move || DVec3::from_array([(); 3].map(|()| random.rand_float() - 0.5)))
}

fn default_degree() -> u8 {
    SurfaceSettings::default().smoothing
}

#[test]
fn a_sphere_of_20_voxels_is_true_within_1_percent_wherever_it_stands() {
    for offset in random_offsets(1).take(20) {
        let [area, volume, _] = errors_of_ball(20.0, offset, default_degree());
        assert!(
            area.abs() < 0.01 && volume.abs() < 0.01,
            "{offset}: {area} {volume}"
        );
    }
}

#[test]
fn a_sphere_of_5_voxels_is_true_within_3_percent() {
    let [area, volume, _] = errors_of_ball(5.0, DVec3::splat(0.5), default_degree());
    assert!(area.abs() < 0.03 && volume.abs() < 0.03, "{area} {volume}");

    // elsewhere the voxels have up to 5 % more or less than the ball: no surface of them can
    // know, but it has what they have, and the mean is that of the ball
    let told: Vec<_> = random_offsets(2)
        .take(40)
        .map(|offset| errors_of_ball(5.0, offset, default_degree()))
        .collect();
    for [area, volume, voxels] in &told {
        assert!(
            area.abs() < 0.03 && (volume - voxels).abs() < 0.01,
            "{area} {volume} {voxels}"
        );
    }
    let mean = |kind: usize| told.iter().map(|errors| errors[kind]).sum::<f64>() / 40.0;
    assert!(
        mean(0).abs() < 0.01 && mean(1).abs() < 0.01,
        "{} {}",
        mean(0),
        mean(1)
    );
}

#[test]
fn no_degree_makes_spheres_shrink() {
    for degree in 1..=12 {
        let [area, volume, _] = errors_of_ball(20.0, DVec3::new(0.1, -0.3, 0.2), degree);
        // the first degree leaves a part of the stairs
        assert!(
            area.abs() < 0.025 && volume.abs() < 0.01,
            "{degree}: {area} {volume}"
        );
    }
}

#[test]
fn smoothing_takes_the_stairs_of_a_slope_away() {
    let dimensions = UVec3::splat(64);
    let normal = DVec3::new(0.21, 0.34, 1.0).normalize();
    let bits = bits_where(dimensions, |voxel| {
        (voxel.as_dvec3() + 0.5 - 32.0).dot(normal) < 0.0
    });
    let largest = |degree: u8| {
        let mesh = mesh(&cubes(dimensions), &bits, settings(degree));
        let distances = mesh.vertices.iter().filter_map(|vertex| {
            let point = DVec3::from_array(vertex.map(f64::from)) - 32.0;
            // the border of the grid is no part of the slope
            (point.abs().max_element() < 20.0).then(|| point.dot(normal).abs())
        });
        distances.fold(0.0, f64::max)
    };
    let largest = [0, 1, 3, 8].map(largest);
    assert!(largest.is_sorted_by(|a, b| a > b), "{largest:?}");
    // in the middle of an edge a vertex is up to half a voxel off, along the normal
    assert!(
        largest[0] > 0.4 && largest[2] < 0.2 && largest[3] < 0.08,
        "{largest:?}"
    );
}

#[test]
fn walls_gaps_and_rods_of_one_voxel_stay() {
    let dimensions = UVec3::splat(40);
    let is_inside =
        |voxel: IVec3| voxel.cmpgt(IVec3::splat(5)).all() && voxel.cmplt(IVec3::splat(34)).all();
    for degree in [1, 3, 8] {
        for thickness in 1..=3 {
            let wall = bits_where(dimensions, |voxel| {
                is_inside(voxel) && (20..20 + thickness).contains(&voxel.x)
            });
            let solid = f64::from(thickness) * 28.0 * 28.0;
            let volume = surface(&cubes(dimensions), &wall, settings(degree)).volume();
            // a vertex has a way of 0.1 voxels on a wall of one, of 0.2 on one of two; rims are round
            assert!(
                (0.7..1.3).contains(&(volume / solid)),
                "{degree} {thickness}: {}",
                volume / solid
            );

            let gap = bits_where(dimensions, |voxel| {
                is_inside(voxel) && !(20..20 + thickness).contains(&voxel.x)
            });
            let (mesh, whole) = (
                mesh(&cubes(dimensions), &gap, settings(degree)),
                28.0 * 28.0 * 28.0,
            );
            let missing = (whole - mesh.volume()) / solid;
            assert!(
                (0.7..1.5).contains(&missing),
                "{degree} {thickness}: {missing}"
            );
        }
        let rod = bits_where(dimensions, |voxel| {
            is_inside(voxel) && voxel.x == 20 && voxel.y == 20
        });
        let volume = surface(&cubes(dimensions), &rod, settings(degree)).volume();
        // unsmoothed, a rod is a square turned by 45°, half a voxel in section
        assert!(
            (0.25..0.75).contains(&(volume / 28.0)),
            "{degree}: {}",
            volume / 28.0
        );
    }
}

#[test]
fn no_vertex_leaves_its_edge_and_normals_are_units_on_random_bits() {
    let dimensions = UVec3::splat(30);
    let bits = crate::support::noise(dimensions, 5, 0.5);
    let plain = mesh(&cubes(dimensions), &bits, settings(0));
    for degree in [1, 5, 12] {
        let smooth = mesh(&cubes(dimensions), &bits, settings(degree));
        assert_eq!(plain.triangles, smooth.triangles);
        for ((a, b), normal) in plain
            .vertices
            .iter()
            .zip(&smooth.vertices)
            .zip(&smooth.normals)
        {
            let moved = DVec3::from_array(a.map(f64::from)) - DVec3::from_array(b.map(f64::from));
            let axes = moved
                .to_array()
                .iter()
                .filter(|along| **along != 0.0)
                .count();
            assert!(axes <= 1 && moved.length() < 0.5, "{moved}");
            let length = DVec3::from_array(normal.map(f64::from)).length();
            assert!((length - 1.0).abs() < 1e-5, "{length}");
        }
    }
}

#[test]
fn thick_slices_keep_the_volume_of_a_ball_too() {
    let grid = turned_slices(UVec3::new(60, 52, 20));
    let centre = grid.bounds().max.as_dvec3() / 2.0;
    let bits = bits_where(grid.dimensions(), |voxel| {
        ((voxel.as_dvec3() + 0.5 - centre) * grid.spacing()).length() < 17.0
    });
    let surface = surface(&grid, &bits, settings(default_degree()));
    let volume = surface.volume() / (4.0 / 3.0 * PI * 17f64.powi(3));
    let area = surface.area() / (4.0 * PI * 17f64.powi(2));
    // slices of 2.5 mm are stairs that a blur of 1 mm leaves
    assert!(
        (volume - 1.0).abs() < 0.02 && (area - 1.0).abs() < 0.08,
        "{volume} {area}"
    );
}

#[test]
fn limits_place_the_surface_where_the_intensities_pass_them() {
    use palpate_surface::Limits;
    use palpate_volume::intensities::Intensities;
    use palpate_volume::threshold::threshold;
    let dimensions = UVec3::splat(48);
    let centre = DVec3::new(24.2, 23.9, 24.4);
    // 100 per voxel of distance from a sphere of 15 voxels
    let values = palpate_volume::voxel_box::VoxelBox::of_dimensions(dimensions).voxels();
    let values: Vec<i16> = values
        .map(|voxel| (100.0 * (15.0 - (voxel.as_dvec3() + 0.5).distance(centre))) as i16)
        .collect();
    let scan = Intensities::new(dimensions, values, 2.0, 30.0).unwrap();
    let segment = threshold(&scan, None, 30.0, f64::INFINITY);
    let limits = Limits {
        low: 30.0,
        high: f64::INFINITY,
    };
    for degree in [0, 2] {
        let settings = SurfaceSettings {
            limits: Some(limits),
            ..settings(degree)
        };
        let grid = cubes(dimensions);
        let mut surface = palpate_surface::SegmentSurface::new(&grid, settings).unwrap();
        let source = VoxelSource {
            bits: segment.occupancy(),
            values: Some((&scan, None)),
        };
        surface.update(&source, &grid.bounds());
        for (_, patch) in surface.patches() {
            for (vertex, normal) in patch.vertices.iter().zip(&patch.normals) {
                let from = DVec3::from_array(vertex.map(f64::from)) - centre;
                // linear between voxels, up to 1/(8 · 15) voxels off, 0.02 at the ends, and
                // smoothed vertices stand out by 0.01, since triangles lie inside by as much
                assert!((from.length() - 15.0).abs() < 0.05, "{}", from.length());
                let normal = DVec3::from_array(normal.map(f64::from));
                assert!(normal.dot(from.normalize()) > 0.995);
            }
        }
    }
}

/// A ball as a scan has it: bone in soft tissue, each voxel by the share of bone in it, and a
/// threshold nearer to the tissue than to the bone.
#[test]
fn unequal_contrasts_on_both_sides_do_not_move_a_surface_from_intensities() {
    use palpate_surface::Limits;
    use palpate_volume::intensities::Intensities;
    use palpate_volume::threshold::threshold;
    let dimensions = UVec3::splat(32);
    let grid = cubes(dimensions);
    let mut random = oorandom::Rand64::new(23);
    for (radius, tolerance) in [(5.0, 0.03), (11.0, 0.01)] {
        for _ in 0..10 {
            let centre = 16.0 + DVec3::from_array([0; 3].map(|_| random.rand_float()));
            let values: Vec<i16> = palpate_volume::voxel_box::VoxelBox::of_dimensions(dimensions)
                .voxels()
                .map(|voxel| {
                    let inside = radius - (voxel.as_dvec3() + 0.5).distance(centre);
                    // bone of 1000 in tissue of 40, blurred by a voxel to each side
                    (40.0 + 960.0 * (0.5 + 0.5 * inside).clamp(0.0, 1.0)) as i16
                })
                .collect();
            let scan = Intensities::new(dimensions, values, 1.0, 0.0).unwrap();
            let limits = Limits {
                low: 520.0,
                high: f64::INFINITY,
            };
            let segment = threshold(&scan, None, limits.low, limits.high);
            let of = |degree: u8, limits: Option<Limits>| {
                let settings = SurfaceSettings {
                    limits,
                    ..settings(degree)
                };
                let mut surface = palpate_surface::SegmentSurface::new(&grid, settings).unwrap();
                let source = VoxelSource {
                    bits: segment.occupancy(),
                    values: Some((&scan, None)),
                };
                surface.update(&source, &grid.bounds());
                let volume = surface.volume() / (4.0 / 3.0 * PI * f64::powi(radius, 3));
                let area = surface.area() / (4.0 * PI * radius * radius);
                (volume - 1.0, area - 1.0)
            };
            for degree in [1, 3, 6, 12] {
                let (volume, area) = of(degree, Some(limits));
                assert!(
                    volume.abs() < tolerance && area.abs() < tolerance,
                    "r {radius}, degree {degree}: {volume} {area}"
                );
            }
            // without smoothing triangles lie inside by their chords, and edges are edges
            let (volume, area) = of(0, Some(limits));
            assert!(volume.abs() < 0.05 && area.abs() < 0.04, "{volume} {area}");
            // while the voxels as they are have stairs
            assert!(of(0, None).1 > 0.05);
        }
    }
}
