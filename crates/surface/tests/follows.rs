//! Patches meet to the bit, and follow edits as if made afresh.

use std::collections::{BTreeMap, HashMap};

use crate::support::{
    assert_closed, ball, bits_where, cubes, noise, settings, surface, turned_slices,
    vertices_of_patches,
};
use glam::{DVec3, IVec3, UVec3};
use palpate_surface::{Limits, PatchChange, PatchId, SegmentSurface, SmoothingMode};
use palpate_surface::{SurfaceSettings, VoxelSource};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::intensities::Intensities;
use palpate_volume::overlay::Overlay;
use palpate_volume::segment::Segment;
use palpate_volume::threshold::threshold;
use palpate_volume::voxel_box::VoxelBox;

/// Blobs and noise over several blocks.
fn body(dimensions: UVec3) -> Bits {
    let coarse = noise(UVec3::splat(32), 3, 0.4);
    let fine = noise(dimensions, 4, 0.03);
    bits_where(dimensions, |voxel| {
        coarse.is_solid(voxel / 7) != fine.is_solid(voxel)
    })
}

/// Sets the voxels of a ball.
fn edited(bits: &mut Bits, centre: IVec3, radius: i32, solid: bool) -> VoxelBox {
    let dirty = crate::support::around(centre, radius, bits.dimensions());
    for index in bits.bricks().indices_in(&dirty) {
        let mut brick = bits
            .bricks()
            .get(index)
            .map_or(BitBrick::EMPTY, |brick| **brick);
        for voxel in bits.bricks().box_of(index).intersect(&dirty).voxels() {
            if (voxel - centre).length_squared() <= radius * radius {
                brick.set(voxel, solid);
            }
        }
        bits.swap(&mut BrickSwap {
            index,
            brick: brick.shared(),
        });
    }
    dirty
}

#[test]
fn patches_have_the_same_vertices_and_normals_at_their_borders_to_the_bit() {
    let dimensions = UVec3::new(70, 66, 97);
    for bits in [
        body(dimensions),
        ball(dimensions, DVec3::new(33.0, 31.0, 48.0), 28.0),
    ] {
        for smoothing in [0, 1, 3, 12] {
            for step in [1, 2] {
                let settings = SurfaceSettings {
                    step,
                    ..settings(smoothing)
                };
                let surface = surface(&turned_slices(dimensions), &bits, settings);
                assert!(surface.patches().len() > 1);
                let mut shared = 0;
                for normals in vertices_of_patches(&surface).into_values() {
                    shared += normals.len() - 1;
                    assert!(normals.iter().all(|normal| *normal == normals[0]));
                }
                assert!(shared > 10);
                // were positions not equal to the bit, they would not join
                assert_closed(&palpate_surface::mesh::joined(&surface));
            }
        }
    }
}

#[test]
fn patches_smoothed_alone_do_not_meet() {
    let dimensions = UVec3::splat(64);
    let bits = ball(dimensions, DVec3::splat(32.3), 28.0);
    let local = SurfaceSettings {
        mode: SmoothingMode::Local,
        ..settings(4)
    };
    let surface = surface(&cubes(dimensions), &bits, local);
    let mut edges = HashMap::new();
    for [a, b, c] in palpate_surface::mesh::joined(&surface).triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from.min(to), from.max(to))).or_insert(0) += 1;
        }
    }
    assert!(edges.values().any(|&triangles| triangles == 1));
    // yet each stays as near to the voxels as those smoothed together
    assert!(
        (surface.volume() / (4.0 / 3.0 * std::f64::consts::PI * 28f64.powi(3)) - 1.0).abs() < 0.01
    );
}

#[test]
fn after_each_random_edit_all_patches_are_those_of_a_fresh_extraction() {
    let dimensions = UVec3::new(75, 64, 66);
    let grid = turned_slices(dimensions);
    let mut random = oorandom::Rand64::new(11);
    for settings in [
        settings(0),
        settings(3),
        SurfaceSettings {
            step: 2,
            ..settings(2)
        },
        SurfaceSettings {
            step: 4,
            ..settings(1)
        },
        SurfaceSettings {
            mode: SmoothingMode::Local,
            ..settings(3)
        },
        SurfaceSettings {
            most_vertices: Some(3000),
            ..settings(2)
        },
    ] {
        let mut bits = body(dimensions);
        let mut surface = surface(&grid, &bits, settings);
        let mut shown = shown_of(&surface);
        for edit in 0..12 {
            let centre = IVec3::from_array(
                dimensions
                    .as_ivec3()
                    .to_array()
                    .map(|n| random.rand_range(0..n as u64) as i32),
            );
            let dirty = edited(
                &mut bits,
                centre,
                random.rand_range(0..9) as i32,
                edit % 3 == 0,
            );
            let changes = surface.update(&VoxelSource::of_bits(&bits), &dirty);
            apply(&mut shown, changes);

            let fresh = shown_of(&crate::support::surface(&grid, &bits, settings));
            assert_eq!(
                shown.keys().collect::<Vec<_>>(),
                fresh.keys().collect::<Vec<_>>()
            );
            for (id, patch) in &fresh {
                assert!(
                    shown[id] == *patch,
                    "patch {id:?} after edit {edit} of {settings:?}"
                );
            }
            assert_eq!(shown, shown_of(&surface));
        }
    }
}

#[test]
fn a_single_voxel_at_any_distance_from_a_border_changes_all_patches_that_it_can() {
    let dimensions = UVec3::new(64, 14, 14);
    let grid = cubes(dimensions);
    for smoothing in [0, 1, 2, 4] {
        let mut bits = noise(dimensions, 6, 0.5);
        let mut surface = surface(&grid, &bits, settings(smoothing));
        let mut reached = [0, 0];
        // the border of the two blocks is at sample 32
        for x in 20..45 {
            let voxel = IVec3::new(x, 7, 7);
            let solid = !bits.is_solid(voxel);
            let dirty = edited(&mut bits, voxel, 0, solid);
            let changes = surface.update(&VoxelSource::of_bits(&bits), &dirty);
            let fresh = crate::support::surface(&grid, &bits, settings(smoothing));
            assert!(shown_of(&surface) == shown_of(&fresh), "{smoothing} {x}");
            for change in changes {
                reached[usize::from(change.id.block[0])] += 1;
            }
        }
        // twelve on the own side; beyond it and on it up to the margin, which nothing exceeds
        let margin = usize::from(smoothing) + 2;
        assert!(
            reached[0] <= 13 + margin && reached[1] <= 13 + margin,
            "{reached:?}"
        );
        if smoothing > 0 {
            assert_eq!(reached, [13 + margin, 12 + margin + 1], "{smoothing}");
        }
    }
}

#[test]
fn edited_intensities_move_the_surface_as_a_fresh_extraction_has_it() {
    let dimensions = UVec3::new(50, 40, 45);
    let grid = turned_slices(dimensions);
    let mut random = oorandom::Rand64::new(5);
    let count = grid.voxel_count();
    let values: Vec<i16> = (0..count)
        .map(|_| random.rand_range(0..2000) as i16)
        .collect();
    let scan = Intensities::new(dimensions, values, 1.0, -1000.0).unwrap();
    let low = 200.0;
    let segment = threshold(&scan, None, low, f64::INFINITY);
    for (smoothing, step) in [(0, 1), (2, 1), (1, 2)] {
        let limits = Some(Limits {
            low,
            high: f64::INFINITY,
        });
        let settings = SurfaceSettings {
            limits,
            step,
            ..settings(smoothing)
        };
        let mut overlay = Overlay::empty(dimensions);
        let all = |overlay: &Overlay| {
            let mut surface = SegmentSurface::new(&grid, settings).unwrap();
            surface.update(&source(&segment, &scan, overlay), &grid.bounds());
            surface
        };
        let mut surface = all(&overlay);
        for _ in 0..5 {
            // one brick of other values, under the same bits
            let index = random.rand_range(0..overlay.bricks().len() as u64) as u32;
            let mut brick = overlay.brick(&scan, index);
            let dirty = overlay.bricks().box_of(index).intersect(&grid.bounds());
            for voxel in dirty.voxels() {
                brick.set(voxel, random.rand_range(0..2000) as i16);
            }
            let brick = Some(brick.into());
            overlay.swap(&mut BrickSwap { index, brick });

            let changes = surface.update(&source(&segment, &scan, &overlay), &dirty);
            assert!(!changes.is_empty());
            assert!(shown_of(&surface) == shown_of(&all(&overlay)));
        }
    }
}

/// Edits of a mask leave the scan's values as they are: where a bit is not what the value says,
/// the surface follows the bit as if there were no values.
#[test]
fn where_bits_were_edited_a_surface_from_intensities_follows_the_bits() {
    let dimensions = UVec3::splat(48);
    let grid = cubes(dimensions);
    let low = 300.0;
    // a slope of values from -1000 to 2000 along x: the threshold is passed at x = 20.8
    let values: Vec<i16> = VoxelBox::of_dimensions(dimensions)
        .voxels()
        .map(|voxel| (-1000.0 + 62.5 * (f64::from(voxel.x) + 0.5)) as i16)
        .collect();
    let scan = Intensities::new(dimensions, values, 1.0, 0.0).unwrap();
    let segment = threshold(&scan, None, low, f64::INFINITY);
    let overlay = Overlay::empty(dimensions);
    let limits = Some(Limits {
        low,
        high: f64::INFINITY,
    });
    for degree in [0, 3] {
        let of_values = SurfaceSettings {
            limits,
            ..settings(degree)
        };
        let mut bits = segment.occupancy().clone();
        let mut surface = SegmentSurface::new(&grid, of_values).unwrap();
        surface.update(&source_of(&bits, &scan, &overlay), &grid.bounds());
        // a hole within the body, and an island far outside of it
        for (x, solid) in [(36, false), (9, true)] {
            let dirty = edited(&mut bits, IVec3::new(x, 24, 24), 6, solid);
            surface.update(&source_of(&bits, &scan, &overlay), &dirty);
        }

        let plain = crate::support::mesh(&grid, &bits, settings(degree));
        let mesh = palpate_surface::mesh::joined(&surface);
        assert_eq!(mesh.triangles, plain.triangles);
        for (vertex, of_bits) in mesh.vertices.iter().zip(&plain.vertices) {
            let x = f64::from(vertex[0]);
            let apart = (0..3)
                .map(|axis| f64::from((vertex[axis] - of_bits[axis]).abs()))
                .fold(0.0, f64::max);
            if (18.0..24.0).contains(&x) {
                // the plane is where the values pass the threshold; 0.02 is the tenth of a
                // stored unit that a value is rounded by, and the nearest to a voxel's middle
                let inner = (4.0..44.0).contains(&vertex[1]) && (4.0..44.0).contains(&vertex[2]);
                assert!(!inner || (x - 20.8).abs() < 0.03, "{x}");
            } else {
                // smoothing of bits makes a little more room for chords: 0.15 / r
                let tolerance = if degree == 0 { 1e-6 } else { 0.1 };
                assert!(apart <= tolerance, "{vertex:?} {of_bits:?}");
            }
        }
    }
}

fn source<'a>(
    segment: &'a Segment,
    scan: &'a Intensities,
    overlay: &'a Overlay,
) -> VoxelSource<'a> {
    source_of(segment.occupancy(), scan, overlay)
}

fn source_of<'a>(bits: &'a Bits, scan: &'a Intensities, overlay: &'a Overlay) -> VoxelSource<'a> {
    VoxelSource {
        bits,
        values: Some((scan, Some(overlay))),
    }
}

type Shown = BTreeMap<PatchId, palpate_surface::Patch>;

fn shown_of(surface: &SegmentSurface) -> Shown {
    surface
        .patches()
        .map(|(id, patch)| (id, (**patch).clone()))
        .collect()
}

fn apply(shown: &mut Shown, changes: Vec<PatchChange>) {
    for change in changes {
        match change.patch {
            Some(patch) => _ = shown.insert(change.id, (*patch).clone()),
            None => assert!(shown.remove(&change.id).is_some(), "dropped twice"),
        }
    }
}

#[test]
fn a_surface_that_is_all_erased_is_dropped_and_its_bounds_follow() {
    let dimensions = UVec3::splat(80);
    let mut bits = ball(dimensions, DVec3::splat(20.0), 9.0);
    let far = edited(&mut bits, IVec3::splat(65), 6, true);
    let mut surface = surface(&cubes(dimensions), &bits, settings(3));
    assert!(surface.bounds().unwrap().max.x > 70.0);

    let dirty = edited(&mut bits, IVec3::splat(65), 6, false);
    assert_eq!(dirty, far);
    let changes = surface.update(&VoxelSource::of_bits(&bits), &dirty);
    assert!(!changes.is_empty() && changes.iter().all(|change| change.patch.is_none()));
    assert!(surface.bounds().unwrap().max.x < 30.0);

    let everything = VoxelBox::of_dimensions(dimensions);
    surface.update(&VoxelSource::of_bits(&Bits::empty(dimensions)), &everything);
    assert_eq!((surface.patches().len(), surface.bounds()), (0, None));
}

#[test]
fn an_update_without_a_change_gives_nothing() {
    let dimensions = UVec3::splat(60);
    let bits = body(dimensions);
    let mut surface = surface(&cubes(dimensions), &bits, settings(3));
    let source = VoxelSource::of_bits(&bits);
    for dirty in [VoxelBox::EMPTY, VoxelBox::of_dimensions(dimensions)] {
        assert!(surface.update(&source, &dirty).is_empty());
    }
    let outside = VoxelBox::new(IVec3::splat(-90), IVec3::splat(-80));
    assert!(surface.update(&source, &outside).is_empty());
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let dimensions = UVec3::splat(90);
    let bits = body(dimensions);
    let on_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| shown_of(&surface(&turned_slices(dimensions), &bits, settings(3))))
    };
    assert_eq!(on_threads(1), on_threads(4));
}

#[test]
fn dense_blocks_are_parted_and_the_surface_is_the_same() {
    let dimensions = UVec3::splat(70);
    let bits = body(dimensions);
    let grid = cubes(dimensions);
    let whole = surface(&grid, &bits, settings(3));
    let parted = surface(
        &grid,
        &bits,
        SurfaceSettings {
            most_vertices: Some(2000),
            ..settings(3)
        },
    );
    assert!(parted.patches().len() > whole.patches().len());
    assert!(parted.patches().any(|(id, _)| id.part > 0));
    assert_closed(&palpate_surface::mesh::joined(&parted));
    let keys = |surface: &SegmentSurface| {
        let mut keys: Vec<_> = vertices_of_patches(surface).into_keys().collect();
        keys.sort_unstable();
        keys
    };
    assert_eq!(keys(&whole), keys(&parted));
}

/// What an edit sends anew is finer where the segment is dense.
#[test]
fn an_edit_in_a_dense_block_changes_the_octants_that_it_reaches() {
    let dimensions = UVec3::splat(32);
    let grid = cubes(dimensions);
    let mut bits = noise(dimensions, 9, 0.5);
    let settings = SurfaceSettings {
        most_vertices: Some(2000),
        ..settings(1)
    };
    let mut surface = surface(&grid, &bits, settings);
    assert_eq!(surface.patches().len(), 8);
    // the margin is 3: from 6 voxels of the middle on an edit of one voxel reaches one octant
    let voxel = IVec3::splat(10);
    let solid = !bits.is_solid(voxel);
    let dirty = edited(&mut bits, voxel, 0, solid);
    let changes = surface.update(&VoxelSource::of_bits(&bits), &dirty);
    assert_eq!(changes.len(), 1);
    assert_eq!(changes[0].id.part, 1);

    // a block that is dense no more is one patch again
    let mut dropped = 0;
    for x in 0..4 {
        let dirty = edited(&mut bits, IVec3::new(8 * x + 4, 16, 16), 30, false);
        let changes = surface.update(&VoxelSource::of_bits(&bits), &dirty);
        dropped += changes
            .iter()
            .filter(|change| change.patch.is_none())
            .count();
        let fresh = crate::support::surface(&grid, &bits, settings);
        assert!(shown_of(&surface) == shown_of(&fresh));
    }
    assert!(dropped >= 8, "{dropped}");
}

#[test]
fn settings_that_make_no_surface_are_refused_with_what_is_allowed() {
    let refused = |settings: SurfaceSettings| {
        let grid = cubes(UVec3::splat(4));
        SegmentSurface::new(&grid, settings)
            .unwrap_err()
            .to_string()
    };
    let step = refused(SurfaceSettings {
        step: 3,
        ..settings(0)
    });
    assert!(step.contains("1, 2 or 4"), "{step}");
    let degree = refused(settings(13));
    assert!(degree.contains("0 to 12"), "{degree}");
    let limits = Limits {
        low: 5.0,
        high: f64::NAN,
    };
    let limits = refused(SurfaceSettings {
        limits: Some(limits),
        ..settings(0)
    });
    assert!(limits.contains("allowed"), "{limits}");
}
