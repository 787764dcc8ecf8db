//! Gaps between bodies whose distance is known.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec3, UVec3};
use palpate_engine::scene::{
    Gap, GapBodies, GapBody, IncrementalSurface, Measured, SegmentVoxels, gap_surface_options,
};
use palpate_surface::{Patch, PatchId};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;

const SPACING: DVec3 = DVec3::new(0.7, 0.8, 1.1);
const MIDDLE: DVec3 = DVec3::new(30.0, 31.0, 29.0);
/// What the gap of smooth bodies is right to: a third of the largest voxel edge, since stairs of
/// voxels are left on both smoothed surfaces, and the minimum looks for the highest [mm].
const TOLERANCE: f64 = 0.37;
/// What the mean is right to: stairs of the one cancel out, but from far away all of it goes to the
/// same pole of the other [mm].
const MEAN_TOLERANCE: f64 = 0.25;

fn grid() -> Grid {
    Grid::new(
        UVec3::new(90, 80, 60),
        SPACING,
        DVec3::ZERO,
        DMat3::IDENTITY,
    )
    .unwrap()
}

/// A scan whose values nothing asks for.
fn scan() -> Intensities {
    let values = vec![0; grid().voxel_count()];
    Intensities::new(grid().dimensions(), values, 1.0, 0.0).unwrap()
}

/// A segment that no threshold made and nobody draws.
fn measured(id: u8, segment: &Segment) -> Measured {
    Measured {
        id: SegmentId(id),
        segment: segment.clone(),
        voxels: SegmentVoxels {
            grid: grid(),
            bits: segment.occupancy().clone(),
            made_by: None,
        },
        drawn: None,
    }
}

fn body_of(segment: &Segment) -> Arc<GapBody> {
    let [body] = GapBodies::default().ready([measured(1, segment)], &grid(), &scan());
    body
}

/// Where a voxel's middle is in a ball [mm].
fn ball(radius: f64) -> Arc<GapBody> {
    let grid = grid();
    let to_scene = grid.patient_from_grid();
    body_of(&Segment::from_fn(grid.dimensions(), |voxel| {
        to_scene
            .transform_point3(voxel.as_dvec3() + 0.5)
            .distance(MIDDLE)
            <= radius
    }))
}

/// From a ball that is moved by a rigid motion about its middle to one that is not.
fn gap(from: &Arc<GapBody>, to: &Arc<GapBody>, turn: DQuat, by: DVec3) -> Gap {
    let pose = DAffine3::from_translation(MIDDLE + by)
        * DAffine3::from_quat(turn)
        * DAffine3::from_translation(-MIDDLE);
    from.gap_to(to, &pose).expect("balls are not empty")
}

/// Mean distance of the points of a sphere of radius r from a ball of radius s whose middle is d
/// away, apart: the mean of |x| over the sphere is d + r² / (3 d), less s.
fn mean_of_spheres(r: f64, s: f64, d: f64) -> f64 {
    d + r * r / (3.0 * d) - s
}

#[test]
fn spheres_apart_have_the_analytic_minimum_and_mean() {
    let (small, large) = (ball(8.0), ball(14.0));
    for (step, distance) in [(0, 22.6), (1, 24.0), (2, 30.0), (3, 60.0), (4, 200.0)] {
        let turn = DQuat::from_scaled_axis(DVec3::new(0.4, 1.1, -0.7) * f64::from(step));
        let way = turn * DVec3::new(0.48, -0.6, 0.64) * distance;
        for (from, to, r, s) in [(&small, &large, 8.0, 14.0), (&large, &small, 14.0, 8.0)] {
            let found = gap(from, to, turn, way);
            let minimum = distance - r - s;
            assert!(
                (found.minimum - minimum).abs() < TOLERANCE,
                "{distance}: {found:?}"
            );
            let mean = mean_of_spheres(r, s, distance);
            assert!(
                (found.mean - mean).abs() < MEAN_TOLERANCE,
                "{distance}: {found:?}, not {mean}"
            );
            assert_eq!(found.overlap, 0.0);
        }
    }
}

#[test]
fn spheres_that_overlap_have_no_gap_and_the_volume_of_their_lens() {
    let (r, s, d) = (8.0, 14.0, 17.0_f64);
    let found = gap(
        &ball(r),
        &ball(s),
        DQuat::from_rotation_x(0.8),
        DVec3::Y * d,
    );
    // Weisstein, "Sphere-Sphere Intersection", MathWorld
    let lens = std::f64::consts::PI
        * (s + r - d).powi(2)
        * (d * d + 2.0 * d * (r + s) - 3.0 * (r - s).powi(2))
        / (12.0 * d);
    assert_eq!(found.minimum, 0.0);
    // voxels of 0.6 mm³ at the border of some 700 mm³ of lens, to both sides
    assert!(
        (found.overlap / lens - 1.0).abs() < 0.05,
        "{found:?}, not {lens}"
    );
}

#[test]
fn a_body_in_another_one_overlaps_by_all_of_itself() {
    let found = gap(&ball(5.0), &ball(14.0), DQuat::IDENTITY, DVec3::ZERO);
    let voxels = SPACING.element_product();
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 125.0;
    assert!((found.overlap / volume - 1.0).abs() < 0.03, "{found:?}");
    assert!(
        (found.overlap / voxels)
            .fract()
            .min(1.0 - (found.overlap / voxels).fract())
            < 1e-6
    );
    assert_eq!((found.minimum, found.mean), (0.0, 0.0));
}

#[test]
fn what_is_empty_has_no_gap() {
    let grid = grid();
    let empty = Segment::from_fn(grid.dimensions(), |_| false);
    let empty = body_of(&empty);
    assert_eq!(empty.gap_to(&ball(5.0), &DAffine3::IDENTITY), None);
    assert_eq!(ball(5.0).gap_to(&empty, &DAffine3::IDENTITY), None);
}

/// A body over several blocks, with a hole that an edit may have made.
fn block(edited: bool) -> Segment {
    Segment::from_fn(grid().dimensions(), |voxel| {
        let solid = voxel.min_element() >= 4 && (voxel - 50).max_element() < 0;
        let hole = edited && (voxel - 8).length_squared() < 20;
        solid && !hole
    })
}

fn patches_of(surface: &IncrementalSurface) -> BTreeMap<PatchId, Arc<Patch>> {
    let patches = surface.surface().patches();
    patches.map(|(id, patch)| (id, Arc::clone(patch))).collect()
}

/// How many patches are the very same, and that all are equal to those made from nothing.
fn shared(one: &BTreeMap<PatchId, Arc<Patch>>, other: &BTreeMap<PatchId, Arc<Patch>>) -> usize {
    let same = |(id, patch): &(&PatchId, &Arc<Patch>)| {
        other
            .get(*id)
            .is_some_and(|other| Arc::ptr_eq(patch, other))
    };
    one.iter().filter(same).count()
}

#[test]
fn the_surface_of_a_measured_segment_is_kept_and_follows_edits_by_their_boxes() {
    let (grid, scan) = (grid(), scan());
    let mut bodies = GapBodies::default();
    let [first, _] = bodies.ready(
        [measured(1, &block(false)), measured(2, &block(true))],
        &grid,
        &scan,
    );
    let before = patches_of(bodies.surface(SegmentId(1)).unwrap());
    assert!(before.len() >= 4);

    // nothing changed: nothing is made
    let [again] = bodies.ready([measured(1, &block(false))], &grid, &scan);
    assert!(Arc::ptr_eq(&first, &again));
    // and what is measured no more is forgotten
    assert!(bodies.surface(SegmentId(2)).is_none());

    let [_] = bodies.ready([measured(1, &block(true))], &grid, &scan);
    let after = patches_of(bodies.surface(SegmentId(1)).unwrap());
    assert!(shared(&before, &after) > 0 && shared(&before, &after) < before.len());
    let mut fresh = GapBodies::default();
    fresh.ready([measured(1, &block(true))], &grid, &scan);
    assert!(after == patches_of(fresh.surface(SegmentId(1)).unwrap()));
}

#[test]
fn a_surface_that_is_drawn_is_measured_as_it_is() {
    let (grid, scan) = (grid(), scan());
    let mut one = measured(1, &block(true));
    let mut drawn = IncrementalSurface::new(gap_surface_options(), one.voxels.clone()).unwrap();
    drawn.follow(&scan);
    let patches = patches_of(&drawn);
    one.drawn = Some(drawn);

    let mut bodies = GapBodies::default();
    bodies.ready([one], &grid, &scan);
    let kept = patches_of(bodies.surface(SegmentId(1)).unwrap());
    assert_eq!(shared(&patches, &kept), patches.len());
}
