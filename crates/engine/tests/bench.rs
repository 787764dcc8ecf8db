//! The benchmark times what it says it times.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use common::*;
use glam::{DVec3, UVec3};
use palpate_engine::bench::{Model, Work, free_rays, run, stroke};
use palpate_volume::first_solid::first_solid;
use palpate_volume::segment::Segment;

const DIMENSIONS: UVec3 = UVec3::splat(64);
const UPDATES: usize = 20_000;

fn ball() -> Segment {
    Segment::from_fn(DIMENSIONS, |voxel| {
        (voxel.as_dvec3() + 0.5).distance(DVec3::splat(32.0)) < 24.0
    })
}

/// Steps of 0.2 voxels, no point twice, in contact nearly always.
#[test]
fn a_stroke_presses_and_slides_and_repeats_nothing() {
    let ball = ball();
    let stroke = stroke(&grid(DIMENSIONS), ball.occupancy(), UPDATES, 1).unwrap();
    assert_eq!(stroke.device.len(), UPDATES);
    assert!(stroke.contact_share >= 0.95, "{}", stroke.contact_share);
    for pair in stroke.device.windows(2) {
        // rounding of coordinates of some ten mm
        assert!((pair[0].distance(pair[1]) - 0.2).abs() < 1e-12);
    }
    let mut points: Vec<[u64; 3]> = stroke
        .device
        .iter()
        .map(|point| point.to_array().map(f64::to_bits))
        .collect();
    points.sort_unstable();
    points.dedup();
    assert_eq!(points.len(), UPDATES);
    // it presses: on average a voxel deep or more, and stays near the surface
    let depths = stroke.device.iter().zip(&stroke.probe);
    let mean = depths
        .map(|(device, probe)| device.distance(*probe))
        .sum::<f64>()
        / UPDATES as f64;
    assert!((1.0..2.5).contains(&mean), "{mean}");
}

#[test]
fn rays_are_four_voxels_long_near_the_surface_and_meet_nothing() {
    let ball = ball();
    let grid = grid(DIMENSIONS);
    let stroke = stroke(&grid, ball.occupancy(), UPDATES, 1).unwrap();
    let rays = free_rays(&grid, ball.occupancy(), &stroke, 1);
    assert!(rays.len() > UPDATES * 9 / 10, "{}", rays.len());
    for (start, end) in rays {
        assert!((start.distance(end) - 4.0).abs() < 1e-12);
        assert!(first_solid(&ball, start, end).is_none());
        assert!((start.distance(DVec3::splat(32.0)) - 24.0).abs() < 5.0);
    }
}

#[test]
fn reports_say_what_was_done() {
    let ball = ball();
    let grid = grid(DIMENSIONS);
    for work in [Work::Detection, Work::Proxy, Work::Tick] {
        let report = run(&grid, ball.occupancy(), work, Model::Exact, 2000, 3).unwrap();
        assert!(report.timing.per_second > 0.0);
        assert!(report.timing.median_ns <= report.timing.max_ns);
        assert!(report.mean_visits >= 1.0);
        let (share, step) = match work {
            Work::Detection => (0.0..=0.0, 4.0),
            Work::Proxy | Work::Tick => (0.95..=1.0, 0.2),
        };
        assert!(share.contains(&report.contact_share), "{report:?}");
        assert!((report.mean_step - step).abs() < 1e-9, "{report:?}");
    }
    let nothing = Segment::empty(DIMENSIONS);
    assert!(run(&grid, nothing.occupancy(), Work::Proxy, Model::Exact, 10, 3).is_none());
}

#[test]
fn every_model_is_timed_on_the_same_path_under_its_own_name() {
    let ball = ball();
    let grid = grid(DIMENSIONS);
    let reports = Model::ALL.map(|model| {
        assert_eq!(Model::named(model.name()), Some(model));
        run(&grid, ball.occupancy(), Work::Proxy, model, 2000, 3).unwrap()
    });
    for report in &reports {
        assert_eq!(report.mean_step, reports[0].mean_step);
        // pressed into a ball, each of them is held up
        assert!(report.contact_share > 0.9, "{report:?}");
    }
    // each does work of its own
    assert!(reports[0].mean_visits != reports[2].mean_visits);
    assert_eq!(Model::named("thesis"), None);
}
