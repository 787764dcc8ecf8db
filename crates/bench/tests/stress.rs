//! Random moves break no promise of `exact`, and those of the thesis' models at once.

use crate::length::by_length;
use glam::{DMat3, DVec3, UVec3};
use palpate_bench::stress::{Guarantee, Source, Terrain, run, runs};
use palpate_engine::touch::Model;
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;

/// All kinds of runs: bare, with edits, with objects, with objects that move; in bumpy matter.
#[test]
fn no_random_move_breaks_a_promise() {
    let size = UVec3::splat(80);
    let bumps = Segment::from_fn(size, |voxel| {
        let waves = (voxel.as_dvec3() * 0.35).to_array().map(f64::sin);
        (waves.iter().sum::<f64>()).abs() < 0.35
    });
    let spacing = DVec3::new(0.6, 0.6, 1.5);
    let grid = Grid::new(size, spacing, DVec3::ZERO, DMat3::IDENTITY).unwrap();
    let bone = Source {
        grid: &grid,
        bits: bumps.occupancy(),
    };
    // each kind of change has its turn among 80 runs
    let count = by_length(80, 320);
    let report = runs(11, 0..count, Model::Exact, Some(bone));
    assert_eq!(report.violation, None);
    assert!(report.moves >= 3_750 * count, "{report:?}");
    assert!(report.contacts >= report.moves / 4, "{report:?}");
    assert!(report.edits >= 60 * count, "{report:?}");
}

/// What their errata say of them: they cross thin walls and enter solid voxels.
#[test]
fn the_models_of_the_thesis_are_found_out_at_once() {
    for model in [Model::ThesisOriginal, Model::ThesisImproved] {
        let report = runs(1, 0..4, model, None);
        let found = report.violation.unwrap();
        assert!(matches!(found.plan.terrain, Terrain::Walls { .. }));
        assert!(
            matches!(
                found.violation.guarantee,
                Guarantee::StaysOut | Guarantee::CrossesNoWall
            ),
            "{found:?}"
        );
    }
}

#[test]
fn a_violation_is_found_again_by_its_run_alone() {
    let found = runs(5, 0..6, Model::ThesisImproved, None)
        .violation
        .unwrap();
    let again = run(5, found.run, Model::ThesisImproved, None);
    assert_eq!(again.violation, Some(found));
    let other = run(6, 0, Model::ThesisImproved, None);
    assert_ne!(other.violation, again.violation);
}
