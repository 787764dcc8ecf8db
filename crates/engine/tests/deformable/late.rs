//! Answers that come late, or before tissue is at rest: the force at a still hand.

use glam::DVec3;

use super::soft_block::{RADIUS, TOP, lattice_rig};
use crate::common::Rig;

/// Steps of the device and what follows each of them [mm, ticks].
const STEP: f64 = 0.5;
const AFTER_STEP: u32 = 30;

/// One tick; the simulation has a pass each 10, and the model answers each so many.
fn tick(rig: &mut Rig, ticks: &mut u32, z: f64, each: u32) -> f64 {
    let force = rig.tick_at(DVec3::new(20.2, 20.3, z)).force;
    *ticks += 1;
    if ticks.is_multiple_of(10) {
        rig.simulation.step();
    }
    if ticks.is_multiple_of(each) {
        rig.deformation.step();
    }
    force.length()
}

/// Presses by steps, and gives the force at each tick of so many seconds after the last of them.
fn pressed(rig: &mut Rig, depth: f64, (each, seconds): (u32, u32)) -> Vec<f64> {
    let (above, mut ticks) = (TOP + RADIUS, 0);
    for _ in 0..400 {
        tick(rig, &mut ticks, above + 0.3, each);
    }
    let mut z = above;
    while z > above - depth + 1e-9 {
        z -= STEP;
        for _ in 0..AFTER_STEP {
            tick(rig, &mut ticks, z, each);
        }
    }
    (0..1000 * seconds)
        .map(|_| tick(rig, &mut ticks, z, each))
        .collect()
}

/// How far the forces are apart, as a share of the last.
fn spread(forces: &[f64]) -> f64 {
    let most = forces.iter().copied().fold(0.0, f64::max);
    let least = forces.iter().copied().fold(f64::INFINITY, f64::min);
    (most - least) / forces.last().unwrap()
}

#[test]
fn the_force_at_a_still_hand_is_constant_however_late_answers_come() {
    let depth = 5.0;
    let prompt = pressed(&mut lattice_rig(), depth, (10, 2));
    let at_rest = *prompt.last().unwrap();
    assert!(at_rest > 0.05, "{at_rest} N");
    assert!(spread(&prompt[500..]) < 0.01, "{}", spread(&prompt[500..]));
    for (each, settled) in [(50, 1000_usize), (130, 1500), (200, 3000)] {
        let mut rig = lattice_rig();
        let forces = pressed(&mut rig, depth, (each, 6));
        let late = spread(&forces[settled..]);
        assert!(late < 0.01, "each {each} ms: {late}");
        let end = *forces.last().unwrap();
        // a coarser way to the same rest
        assert!((end / at_rest - 1.0).abs() < 0.05, "{end} of {at_rest} N");
        // up to there, and never down from more
        let most = forces.iter().copied().fold(0.0, f64::max);
        assert!(most < 1.05 * end, "each {each} ms: {most} of {end} N");
        assert_eq!(rig.violations(), 0);
    }
}

#[test]
fn answers_that_are_not_at_rest_are_passed_over_and_the_force_comes_to_the_same() {
    let at_rest = *pressed(&mut lattice_rig(), 4.0, (10, 2)).last().unwrap();
    let mut rig = lattice_rig();
    rig.deformation.set_iterations(14);
    let forces = pressed(&mut rig, 4.0, (30, 6));
    let now = rig.simulation.deformation();
    assert!(!now.report.settling && now.answers > 100, "{now:?}");
    let late = spread(&forces[1500..]);
    assert!(late < 0.01, "{late}");
    let end = forces.last().unwrap();
    assert!((end / at_rest - 1.0).abs() < 0.05, "{end} of {at_rest} N");
}

/// The hand is deep in tissue before the first answer comes: it is led in from where nothing presses.
#[test]
fn a_hand_that_is_in_at_once_comes_to_the_force_of_one_that_went_slowly() {
    let slowly = *pressed(&mut lattice_rig(), 6.0, (10, 2)).last().unwrap();
    let mut rig = lattice_rig();
    let (above, mut ticks) = (TOP + RADIUS, 0);
    for _ in 0..400 {
        tick(&mut rig, &mut ticks, above + 0.3, 30);
    }
    let forces: Vec<_> = (0..4000)
        .map(|_| tick(&mut rig, &mut ticks, above - 6.0, 30))
        .collect();
    let end = forces.last().unwrap();
    assert!((end / slowly - 1.0).abs() < 0.05, "{end} of {slowly} N");
    assert!(spread(&forces[2000..]) < 0.01);
    assert_eq!(rig.simulation.deformation().report.bonds_broken, 0);
}
