//! The benchmark times what it says it times.

use crate::common::*;
use glam::{DVec3, UVec3};
use palpate_bench::haptics::{BenchError, Ground, TouchBench, Work, compare, free_rays, stroke};
use palpate_engine::touch::Model;
use palpate_haptics::ball::{BallShape, ball_limits};
use palpate_haptics::contact::Exact;
use palpate_haptics::smooth::Smoothing;
use palpate_volume::first_solid::first_solid;
use palpate_volume::occupancy::Occupancy;
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
    let stroke = stroke(&grid(DIMENSIONS), &ball, &Exact::default(), UPDATES, 1).unwrap();
    assert_eq!(stroke.device.len(), UPDATES);
    assert!(
        stroke.contact_fraction >= 0.95,
        "{}",
        stroke.contact_fraction
    );
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
fn rays_have_their_length_near_the_surface_and_meet_nothing() {
    let ball = ball();
    let grid = grid(DIMENSIONS);
    let stroke = stroke(&grid, &ball, &Exact::default(), UPDATES, 1).unwrap();
    for length in [1.0, 4.0, 10.0] {
        let rays = free_rays(&grid, &ball, &stroke, length, 1);
        assert!(rays.len() > UPDATES * 9 / 10, "{}", rays.len());
        for (start, end) in rays {
            // rounding of coordinates of some ten voxels
            assert!((start.distance(end) - length).abs() < 1e-12);
            assert!(first_solid(&ball, start, end).is_none());
            assert!((start.distance(DVec3::splat(32.0)) - 24.0).abs() < 5.0);
        }
    }
}

/// The ground of one ball.
fn ground() -> Ground {
    Ground::new(grid(DIMENSIONS), vec![ball().occupancy().clone()])
}

const DETECTION: Work = Work::Detection { length: 4.0 };
const UNSMOOTHED: Work = Work::Tick {
    smoothing: Smoothing::Off,
    friction: true,
};

#[test]
fn reports_say_what_was_done() {
    let bench = TouchBench::new(&ground(), 0.0, 2000, 3).unwrap();
    for work in [DETECTION, Work::Proxy, Work::TICK, UNSMOOTHED] {
        let report = bench.run(work, Model::Exact).unwrap();
        assert!(report.timing.per_second > 0.0);
        assert!(report.timing.median_ns <= report.timing.max_ns);
        assert!(report.mean_visits >= 1.0);
        let (share, step) = match work {
            Work::Detection { length } => (0.0..=0.0, length),
            Work::Proxy | Work::Tick { .. } => (0.95..=1.0, 0.2),
        };
        assert!(share.contains(&report.contact_fraction), "{report:?}");
        assert!((report.mean_step - step).abs() < 1e-9, "{report:?}");
    }
}

#[test]
fn what_cannot_be_touched_is_refused() {
    let nothing = Ground::new(
        grid(DIMENSIONS),
        vec![Segment::empty(DIMENSIONS).occupancy().clone()],
    );
    let refused = TouchBench::new(&nothing, 0.0, 10, 3).unwrap_err();
    assert_eq!(refused, BenchError::NoSurface);
    let refused = TouchBench::new(&ground(), 17.0, 10, 3).unwrap_err();
    assert!(matches!(refused, BenchError::Ball(_)), "{refused}");
    let bench = TouchBench::new(&ground(), 1.0, 10, 3).unwrap();
    let refused = bench.run(Work::Proxy, Model::ThesisImproved).unwrap_err();
    assert_eq!(refused, BenchError::PointsOnly("thesis-improved"));
}

#[test]
fn every_model_is_timed_on_the_same_path_under_its_own_name() {
    let bench = TouchBench::new(&ground(), 0.0, 2000, 3).unwrap();
    let reports = Model::ALL.map(|model| {
        assert_eq!(Model::named(model.name()), Some(model));
        bench.run(Work::Proxy, model).unwrap()
    });
    for report in &reports {
        assert_eq!(report.mean_step, reports[0].mean_step);
        // pressed into a ball, each of them is held up
        assert!(report.contact_fraction > 0.9, "{report:?}");
    }
    // each does work of its own
    assert!(reports[0].mean_visits != reports[2].mean_visits);
    assert_eq!(Model::named("thesis"), None);
    // and detects on rays that meet nothing
    for model in Model::ALL {
        let report = bench.run(DETECTION, model).unwrap();
        assert!(report.timing.count > 1800, "{report:?}");
    }
}

/// A ball is as deep as a point, measured from its own surface, and in contact as often.
#[test]
fn balls_press_and_slide_as_a_point_does() {
    let grid = grid(DIMENSIONS);
    let solid = ball();
    for radius in [1.0, 2.0, 5.0] {
        let bench = TouchBench::new(&ground(), radius, 5000, 3).unwrap();
        for work in [Work::Proxy, Work::TICK] {
            let report = bench.run(work, Model::Exact).unwrap();
            assert!(report.contact_fraction >= 0.95, "{radius}: {report:?}");
        }
        let shape = BallShape::new(radius, grid.spacing()).unwrap();
        let limits = ball_limits(&shape);
        let dilated = palpate_haptics::ball::Ball::new(shape);
        let cells = dilated.dilate(&solid);
        let path = stroke(&grid, &cells, &Exact { limits }, 5000, 3).unwrap();
        let depths = path.device.iter().zip(&path.probe);
        let mean = depths
            .map(|(device, probe)| device.distance(*probe))
            .sum::<f64>()
            / 5000.0;
        assert!((1.0..2.5).contains(&mean), "{radius}: {mean}");
        // its middle stays outside, a radius away, less than a cell more where a cell errs
        for probe in &path.probe {
            let away = probe.distance(DVec3::splat(32.0)) - 24.0;
            assert!(away > radius - 1.8, "{radius}: {away}");
        }
    }
}

#[test]
fn a_body_of_many_segments_is_timed_with_their_owners() {
    let whole = ball();
    let slices = (0..8).map(|slice| {
        let part = Segment::from_fn(DIMENSIONS, |voxel| {
            whole.is_solid(voxel) && voxel.x / 8 == slice
        });
        part.occupancy().clone()
    });
    let many = Ground::new(grid(DIMENSIONS), slices.collect());
    assert_eq!(many.parts().len(), 8);
    let [many, one] = [many, ground()].map(|ground| {
        let bench = TouchBench::new(&ground, 0.0, 2000, 3).unwrap();
        bench.run(Work::TICK, Model::Exact).unwrap()
    });
    // the union is the same body
    assert_eq!(many.contact_fraction, one.contact_fraction);
    assert_eq!(many.mean_visits, one.mean_visits);
}

#[test]
fn an_embedded_body_is_the_same_at_the_same_place() {
    let small = ground();
    let large = small.embedded(UVec3::new(130, 64, 201)).unwrap();
    let offset = glam::IVec3::new(33, 0, 68);
    let ball = ball();
    let parts = large.parts();
    let mut count = 0;
    for z in 0..201 {
        for y in 0..64 {
            for x in 0..130 {
                let voxel = glam::IVec3::new(x, y, z);
                let solid = parts[0].bits.is_solid(voxel);
                assert_eq!(solid, ball.is_solid(voxel - offset));
                count += u64::from(solid);
            }
        }
    }
    assert_eq!(count, ball.count());
    let point = DVec3::new(3.0, 4.0, 5.0);
    let [here, there] = [&small, &large].map(|ground| ground.grid.patient_from_grid());
    let moved = there.transform_point3(point + offset.as_dvec3());
    // rounding of coordinates of some hundred mm
    assert!(here.transform_point3(point).distance(moved) < 1e-9);

    let found = compare([&small, &large], Work::Proxy, [2000, 50], 3).unwrap();
    assert!(found.small_per_second > 0.0 && found.large_per_second > 0.0);
    assert!(found.contact_fraction >= 0.95);
    assert_eq!([found.small_cold.count, found.large_cold.count], [50, 50]);
}
