//! Tissue that yields stays as it was pressed: under the box, behind it, and when it comes back.

use crate::length::by_length;
use crate::model_support::{Bench, LIVER, RADIUS, TOP};
use glam::{DVec3, IVec3};
use palpate_deform::lattice::{InelasticSettings, LatticeModel, LatticeSettings};
use palpate_deform::model::ModelAnswer;
use palpate_volume::voxel_box::VoxelBox;

/// Tool on the surface, between voxels.
fn above(x: f64) -> DVec3 {
    DVec3::new(x, 18.3, TOP + RADIUS)
}

fn bench(yield_strain: Option<f64>) -> Bench {
    let settings = LatticeSettings {
        inelastic: InelasticSettings {
            yield_strain,
            prony: None,
        },
        ..LatticeSettings::default()
    };
    Bench::with(LIVER, DVec3::ONE, Box::new(LatticeModel::new(settings)))
}

/// Brings the tool from one place to another in steps of a quarter of a millimetre.
fn way(bench: &mut Bench, from: DVec3, to: DVec3) -> ModelAnswer {
    let steps = ((to - from).length() / 0.25).ceil() as u32;
    let mut last = ModelAnswer::default();
    for step in 1..=steps {
        let share = f64::from(step) / f64::from(steps);
        last = bench.advance(from.lerp(to, share));
    }
    last
}

/// How high voxels are solid over a place.
fn height(bench: &Bench, x: i32) -> i32 {
    let solid = |z: &i32| bench.is_solid(IVec3::new(x, 18, *z));
    (0..36).rev().find(solid).map_or(0, |z| z + 1)
}

/// Over the whole length of the block.
fn heights(bench: &Bench) -> Vec<i32> {
    (0..36).map(|x| height(bench, x)).collect()
}

const LEFT: f64 = 9.2;
const RIGHT: f64 = 27.0;
const DEEP: DVec3 = DVec3::new(0.0, 0.0, -3.0);
const CLEAR: DVec3 = DVec3::new(0.0, 0.0, 1.5);

#[test]
fn a_dent_stays_as_deep_as_the_yield_strain_leaves_it() {
    let dents = [None, Some(0.1), Some(0.02)].map(|strain| {
        let mut bench = bench(strain);
        let whole = bench.picture();
        way(&mut bench, above(LEFT), above(LEFT) + DEEP);
        let lifted = way(&mut bench, above(LEFT) + DEEP, above(LEFT) + CLEAR);
        assert!(!lifted.report.comes_back(), "{strain:?}");
        assert_eq!(lifted.report.moved_voxels, bench.changed(&whole));
        lifted.report.plastic_voxels
    });
    assert_eq!(dents[0], 0, "elastic matter comes back");
    assert!(dents[1] > 20 && dents[2] > 2 * dents[1], "{dents:?}");
}

#[test]
fn a_dent_is_the_same_when_the_box_has_left_and_when_it_comes_back() {
    let mut bench = bench(Some(0.05));
    way(&mut bench, above(LEFT), above(LEFT) + DEEP);
    way(&mut bench, above(LEFT) + DEEP, above(LEFT) + CLEAR);
    let dented = bench.picture();
    for _ in 0..2 {
        way(&mut bench, above(LEFT) + CLEAR, above(RIGHT) + CLEAR);
        // the middle of the dent is beyond the box now
        assert_eq!(bench.changed(&dented), 0);
        // and at once far beyond the scan
        bench.advance(above(RIGHT) + DVec3::new(200.0, 0.0, 0.0));
        assert_eq!(bench.changed(&dented), 0);
        way(&mut bench, above(RIGHT) + CLEAR, above(LEFT) + CLEAR);
        assert_eq!(bench.changed(&dented), 0);
    }
}

#[test]
fn a_dent_is_the_same_after_matter_elsewhere_was_pressed_and_came_back() {
    let mut bench = bench(Some(0.02));
    way(&mut bench, above(LEFT), above(LEFT) + DEEP);
    way(&mut bench, above(LEFT) + DEEP, above(LEFT + 6.0) + DEEP);
    way(
        &mut bench,
        above(LEFT + 6.0) + DEEP,
        above(LEFT + 6.0) + CLEAR,
    );
    let dented = bench.picture();
    way(
        &mut bench,
        above(LEFT + 6.0) + CLEAR,
        above(RIGHT + 5.0) + CLEAR,
    );
    // so little that nothing yields
    let touched = way(
        &mut bench,
        above(RIGHT + 5.0),
        above(RIGHT + 5.0) + DEEP / 20.0,
    );
    assert!(touched.contacts[0].contact.is_some());
    way(&mut bench, above(RIGHT + 5.0), above(RIGHT + 5.0) + CLEAR);
    way(&mut bench, above(RIGHT + 5.0) + CLEAR, above(LEFT) + CLEAR);
    assert_eq!(bench.changed(&dented), 0);
}

#[test]
fn a_groove_stays_behind_a_tool_that_slides() {
    let mut bench = bench(Some(0.02));
    way(&mut bench, above(LEFT), above(LEFT) + DEEP);
    way(&mut bench, above(LEFT) + DEEP, above(RIGHT) + DEEP);
    way(&mut bench, above(RIGHT) + DEEP, above(RIGHT) + CLEAR);
    let groove = heights(&bench);
    let inside = &groove[LEFT as usize..=RIGHT as usize];
    assert!(inside.iter().all(|&top| top <= 17), "{groove:?}");
    // nowhere does it swell
    assert!(groove.iter().all(|&top| top <= 18), "{groove:?}");
    assert!(groove[..4].iter().all(|&top| top == 18), "{groove:?}");

    // it does not come back bit by bit as the box goes over it
    way(&mut bench, above(RIGHT) + CLEAR, above(LEFT) + CLEAR);
    let before = bench.picture();
    for _ in 0..by_length(1, 3) {
        way(&mut bench, above(LEFT) + CLEAR, above(RIGHT) + CLEAR);
        way(&mut bench, above(RIGHT) + CLEAR, above(LEFT) + CLEAR);
    }
    assert_eq!(bench.changed(&before), 0, "{:?}", heights(&bench));
}

#[test]
fn what_yielded_stays_after_a_reset_and_elastic_dents_come_back() {
    let mut bench = bench(Some(0.05));
    let whole = bench.picture();
    way(&mut bench, above(LEFT), above(LEFT) + DEEP);
    way(&mut bench, above(LEFT) + DEEP, above(LEFT) + CLEAR);
    way(&mut bench, above(LEFT) + CLEAR, above(RIGHT) + CLEAR);
    let dented = bench.picture();
    let dent = bench.changed(&whole);
    // a shallow press, elastic but for a little
    way(&mut bench, above(RIGHT), above(RIGHT) + DEEP / 3.0);
    assert!(bench.changed(&dented) > 0);
    bench.model.reset();
    for _ in 0..3 {
        bench.advance(above(RIGHT) + CLEAR);
    }
    assert_eq!(bench.changed(&dented), 0);
    assert!(dent > 20, "{dent}");
    // what stays is the body now: nothing of it is the model's any more
    let report = bench.advance(above(LEFT) + CLEAR).report;
    assert_eq!((report.moved_voxels, report.plastic_voxels), (0, 0));
}

#[test]
fn a_dent_is_met_where_it_is_and_matter_beside_it_as_before() {
    let mut bench = bench(Some(0.02));
    let force = |answer: &ModelAnswer| {
        let contact = answer.contacts[0].contact;
        contact.map_or(0.0, |contact| contact.force.z)
    };
    let touch = DVec3::new(0.0, 0.0, -0.6);
    let first = force(&way(&mut bench, above(LEFT), above(LEFT) + touch));
    way(&mut bench, above(LEFT), above(LEFT) + DEEP);
    way(&mut bench, above(LEFT) + DEEP, above(LEFT) + CLEAR);
    let again = force(&way(&mut bench, above(LEFT), above(LEFT) + touch));
    assert!(again < 0.1 * first, "{first} then {again}");
    way(&mut bench, above(LEFT) + CLEAR, above(RIGHT) + CLEAR);
    let aside = force(&way(&mut bench, above(RIGHT), above(RIGHT) + touch));
    assert!((aside / first - 1.0).abs() < 0.15, "{first} and {aside}");
}

#[test]
fn a_cut_in_a_dent_that_the_box_has_left_stays_a_cut() {
    let mut bench = bench(Some(0.02));
    way(&mut bench, above(LEFT), above(LEFT) + DEEP);
    way(&mut bench, above(LEFT) + DEEP, above(LEFT) + CLEAR);
    way(&mut bench, above(LEFT) + CLEAR, above(RIGHT) + CLEAR);
    let dented = bench.picture();
    let cut = VoxelBox::new(IVec3::new(8, 17, 14), IVec3::new(11, 20, 16));
    bench.cut(&cut);
    let after = bench.picture();
    let taken = bench.changed(&dented);
    assert!(taken > 0);
    for _ in 0..3 {
        bench.advance(above(RIGHT) + CLEAR);
    }
    assert_eq!(bench.changed(&after), 0);
    way(&mut bench, above(RIGHT) + CLEAR, above(LEFT) + CLEAR);
    // what was pressed flat below it springs up a little
    let filled = cut.voxels().filter(|voxel| bench.is_solid(*voxel)).count();
    assert!(filled <= 3, "{filled} of {taken}");
    // no more is missing than was cut
    let missing = i64::from(bench.changed(&dented)) - i64::from(taken);
    assert!(missing.abs() <= 8, "{missing} more voxels");
}
