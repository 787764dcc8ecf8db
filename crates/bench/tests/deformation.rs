//! Work in soft tissue breaks no promise, and the benchmarks of it count what happens.

use glam::{DMat3, DVec3, UVec3};
use palpate_bench::deformation::lattice::{FRAMES, Layers, frames};
use palpate_bench::deformation::session::{Plan, measure};
use palpate_bench::deformation::stress::{run, runs};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;

/// Pressing, drilling and needles in all kinds of worlds; other models and a million ticks by
/// `palpate bench stress --deform`.
#[test]
fn work_in_matter_that_gives_way_breaks_no_promise() {
    let count = 4;
    let report = runs("lattice", 3, 0..count, 6_000).unwrap();
    println!("{report:?}");
    assert_eq!(report.violation, None);
    assert!(report.ticks >= 6_000 * count);
    assert!(
        report.contacts as f64 >= 0.8 * report.ticks as f64,
        "{report:?}"
    );
    assert!(report.bits > 200 && report.edits > 10, "{report:?}");
    assert!(report.drilled > 10 && report.punctures >= 2, "{report:?}");
    assert!(report.answers > 100 && report.rests >= 1, "{report:?}");
    assert!(report.settled >= 1, "{report:?}");
}

/// There the hand rests 18 mm from a probe over which tissue has closed: the spring goes over to
/// what is hard for as long as that takes.
#[test]
fn a_hand_far_from_a_caught_probe_comes_to_rest() {
    let report = run("lattice", 5, 0, 2_400).unwrap();
    assert_eq!(report.violation, None);
    assert!(report.rests >= 1, "{report:?}");
}

/// There a drill that gripped has let go of a probe in closed tissue: what friction held comes
/// back.
#[test]
fn what_a_drill_has_gripped_is_let_go() {
    let report = run("lattice", 5, 17, 8_400).unwrap();
    assert_eq!(report.violation, None);
    assert!(report.drilled >= 1, "{report:?}");
}

/// There a needle is still in beside a probe in closed tissue: once its tissue has relaxed, nothing
/// changes by a bit.
#[test]
#[ignore = "takes long: make test-long"]
fn a_hand_at_rest_with_a_needle_that_is_caught_comes_to_rest() {
    let report = run("fcc-lj", 5, 5, 7_800).unwrap();
    assert_eq!(report.violation, None);
    assert!(report.rests >= 2, "{report:?}");
}

#[test]
fn a_run_is_made_again_by_its_number() {
    let one = run("lattice", 5, 1, 2_000).unwrap();
    assert_eq!(one, run("lattice", 5, 1, 2_000).unwrap());
    assert_ne!(one, run("lattice", 5, 2, 2_000).unwrap());
    assert!(runs("jelly", 5, 0..1, 100).is_err());
}

/// In step, ticks and answers are counts and not times.
#[test]
fn a_session_in_step_counts_ticks_and_answers() {
    let size = UVec3::splat(48);
    let grid = Grid::new(size, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY).unwrap();
    let ball = Segment::from_fn(size, |voxel| {
        (voxel.as_dvec3() + 0.5).distance(DVec3::splat(24.0)) < 16.0
    });
    let values = vec![0; size.as_usizevec3().element_product()];
    let scan = (grid, Intensities::new(size, values, 1.0, 0.0).unwrap());
    let plan = |model| Plan {
        scan: scan.clone(),
        segment: &ball,
        model,
        samples: 2,
        ticks_in_step: Some(300),
        seed: 1,
    };
    for (model, answers) in [(None, 0..=0), (Some("lattice"), 32..=34)] {
        let found = measure(&plan(model)).unwrap();
        assert_eq!(found.violations, 0);
        assert_eq!(found.samples.len(), 2);
        assert_eq!(found.nodes > 0, model.is_some());
        for sample in &found.samples {
            assert_eq!(sample.ticks, 300);
            assert!(sample.contacts >= 285, "{sample:?}");
            // each is taken in the next pass of the simulation, and asks for the one after it
            assert!(answers.contains(&sample.answers), "{sample:?}");
        }
    }
    assert_eq!(measure(&plan(None)).unwrap(), measure(&plan(None)).unwrap());
    let nothing = Segment::from_fn(size, |_| false);
    let empty = Plan {
        segment: &nothing,
        ..plan(None)
    };
    assert!(measure(&empty).is_err());
    assert!(measure(&plan(Some("jelly"))).is_err());
}

#[test]
fn more_iterations_bring_the_lattice_nearer_to_rest() {
    let soft_over_stiff = Layers {
        poisson: 0.25,
        soft: 3,
        ratio: 100.0,
    };
    let few = frames(11, soft_over_stiff, 10).unwrap();
    let many = frames(11, soft_over_stiff, 200).unwrap();
    assert_eq!(many.seconds.len(), FRAMES as usize);
    assert!(many.worst_exact <= 1e-6, "{many:?}");
    assert!(many.worst_error < 0.01 && few.worst_error > many.worst_error);
}
