//! By the default model: what it dents, and what becomes of that.

use std::sync::mpsc;

use glam::DVec3;
use palpate_deform::material::preset;
use palpate_deform::registry::ModelOptions;
use palpate_engine::deformable::WakeUp;
use palpate_engine::touch::Settings;

use super::soft_block::{RADIUS, SOFT, TOP, go, lattice_rig, soft_voxels};
use crate::common::Rig;

#[test]
fn what_the_lattice_dents_comes_back_and_leaves_no_step_of_undo() {
    let mut rig = lattice_rig();
    let all = soft_voxels(&rig);
    assert!(rig.simulation.undo().unwrap(), "adding the segment");
    assert!(rig.simulation.redo().unwrap());
    // the ball reaches 3 mm below its middle
    go(&mut rig, 30.0, 23.5, 200);
    go(&mut rig, 23.5, 20.0, 900);
    let rest = go(&mut rig, 20.0, 20.0, 300);
    let moved = rig.simulation.deformation().report.moved_voxels;
    assert!(moved > 10 && soft_voxels(&rig) < all, "{moved} voxels");
    // the proxy came after the tool into the dent, and is in no voxel
    assert!(rest.proxy.z < TOP + RADIUS - 0.9, "{}", rest.proxy);
    assert!(rest.force.z > 0.0);

    go(&mut rig, 20.0, 30.0, 600);
    go(&mut rig, 30.0, 30.0, 200);
    assert_eq!(rig.simulation.deformation().report.moved_voxels, 0);
    assert_eq!(soft_voxels(&rig), all);
    assert_eq!(rig.violations(), 0);
    // the newest change is still the segment's
    assert!(rig.simulation.undo().unwrap());
    assert!(rig.simulation.voxels().segment(SOFT).is_none());
}

#[test]
fn a_model_that_is_changed_or_left_behind_gives_back_what_it_moved() {
    for name in [None, Some("fcc-lj")] {
        let mut rig = lattice_rig();
        let all = soft_voxels(&rig);
        go(&mut rig, 30.0, 19.0, 1200);
        assert!(soft_voxels(&rig) < all);
        rig.simulation
            .set_deformation(name, &ModelOptions::default(), false)
            .unwrap();
        assert_eq!(rig.simulation.deformation().model, name);
        go(&mut rig, 19.0, 30.0, 500);
        go(&mut rig, 30.0, 30.0, 300);
        assert_eq!(soft_voxels(&rig), all, "{name:?}");
    }
    // the probe is placed far away: nobody presses, and nothing soft is near
    let mut rig = lattice_rig();
    let all = soft_voxels(&rig);
    go(&mut rig, 30.0, 19.0, 1200);
    assert!(soft_voxels(&rig) < all);
    rig.simulation
        .place(DVec3::new(20.0, 20.0, 60.0), 1, false)
        .unwrap();
    for tick in 0..300 {
        rig.tick_at(DVec3::new(20.0, 20.0, 60.0));
        if tick % 10 == 0 {
            rig.simulation.step();
            rig.deformation.step();
        }
    }
    assert_eq!(soft_voxels(&rig), all);
}

/// Without any pass of the simulation, as between two of them.
#[test]
fn an_answer_that_rings_is_followed_by_the_next_question_at_once() {
    let mut rig = lattice_rig();
    let (notify, wake_up) = mpsc::channel();
    rig.deformation.set_wake_up(WakeUp::new(move || {
        notify.send(()).unwrap();
    }));
    go(&mut rig, 30.0, 19.0, 900);
    let rung = wake_up.try_iter().count() as u64;
    let before = rig.simulation.deformation().answers;
    assert!(rung >= before && rung > 20, "{rung} rang, {before} came");
    let mut rings = 0;
    for step in 0..20 {
        for _ in 0..10 {
            rig.tick_at(DVec3::new(20.2, 20.3, 19.0 - 0.05 * f64::from(step)));
        }
        rig.simulation.answer_came();
        rig.deformation.step();
        rings += wake_up.try_iter().count();
    }
    assert_eq!(rings, 20);
    assert!(rig.simulation.deformation().report.moved_voxels > 0);
    // one that is answered at once is taken, and the next question waits for a pass
    rig.simulation.answer_came();
    rig.deformation.step();
    rig.simulation.answer_came();
    let answers = rig.simulation.deformation().answers;
    rig.deformation.step();
    assert!(wake_up.try_recv().is_err());
    rig.simulation.step();
    rig.deformation.step();
    assert!(wake_up.try_recv().is_ok());
    assert_eq!(rig.simulation.deformation().answers, answers);
}

/// Between answers and over them, where nothing breaks or slips.
#[test]
fn pressing_slowly_makes_no_step_in_the_force_with_any_model() {
    for (name, depth) in [("lattice", 2.0), ("fcc-lj", 0.8), ("cuboid-lj", 0.8)] {
        let mut rig = lattice_rig();
        rig.simulation
            .set_deformation(Some(name), &ModelOptions::default(), false)
            .unwrap();
        let above = TOP + RADIUS + 0.1;
        go(&mut rig, 30.0, above, 200);
        let mut forces = Vec::new();
        for tick in 1..=1500 {
            let z = above - (depth + 0.1) * f64::from(tick) / 1500.0;
            forces.push(rig.tick_at(DVec3::new(20.2, 20.3, z)).force);
            if tick % 10 == 0 {
                rig.simulation.step();
                rig.deformation.step();
            }
        }
        let peak = forces
            .iter()
            .map(|force| force.length())
            .fold(0.0, f64::max);
        assert!(peak > 0.01, "{name}: {peak} N");
        for pair in forces.windows(2) {
            let step = pair[1].distance(pair[0]);
            assert!(step < 0.1 * peak, "{name}: {pair:?} of {peak}");
        }
    }
}

#[test]
fn a_point_in_a_dent_feels_the_matter_and_not_the_walls_of_its_voxels() {
    let mut rig = lattice_rig();
    let point = Settings {
        probe_radius: 0.0,
        ..rig.simulation.settings()
    };
    rig.simulation.set_settings(point).unwrap();
    go(&mut rig, 30.0, 18.5, 1500);
    let rest = go(&mut rig, 18.5, 18.5, 500);
    let now = rig.simulation.deformation();
    assert!(now.report.moved_voxels > 0);
    // both ends of two springs in a row
    assert!(now.force.z > 0.01, "{}", now.force);
    assert!(
        (rest.force - now.force).length() < 0.1 * now.force.z,
        "{} {}",
        rest.force,
        now.force
    );
}

#[test]
fn materials_and_models_that_a_person_chose_are_taken_back_by_undo_one_by_one() {
    let mut rig = lattice_rig();
    let gel = rig.simulation.material(SOFT);
    let fat = preset("fat").unwrap().law().ok();
    rig.simulation.set_material(SOFT, fat, true).unwrap();
    let name = Some("fcc-lj");
    let small = ModelOptions {
        edge: Some(9),
        binding: Some(0.5),
        walls: true,
        ..ModelOptions::default()
    };
    rig.simulation.set_deformation(name, &small, true).unwrap();
    // what is so already is no step
    rig.simulation.set_deformation(name, &small, true).unwrap();
    let chosen = |rig: &Rig| {
        let now = rig.simulation.deformation();
        (rig.simulation.material(SOFT), now.model, now.options)
    };
    let last = chosen(&rig);
    assert_eq!(last, (fat, name, small));

    let usual = ModelOptions::default();
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(chosen(&rig), (fat, Some("lattice"), usual));
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(chosen(&rig), (gel, Some("lattice"), usual));
    assert!(rig.simulation.redo().unwrap() && rig.simulation.redo().unwrap());
    assert_eq!(chosen(&rig), last);
    // what was set by itself is none of them: next is the segment
    for _ in 0..3 {
        assert!(rig.simulation.undo().unwrap());
    }
    assert!(rig.simulation.voxels().segment(SOFT).is_none());
}

#[test]
fn a_model_that_undo_brings_back_presses_as_before() {
    let mut rig = lattice_rig();
    let all = soft_voxels(&rig);
    rig.simulation
        .set_deformation(None, &ModelOptions::default(), true)
        .unwrap();
    go(&mut rig, 30.0, 20.0, 900);
    let hard = go(&mut rig, 20.0, 20.0, 300).force.z;
    assert_eq!(soft_voxels(&rig), all);
    assert!(rig.simulation.undo().unwrap());
    let soft = go(&mut rig, 20.0, 20.0, 500).force.z;
    assert!(soft > 0.0 && soft < 0.8 * hard, "{soft} {hard}");
    assert!(rig.simulation.deformation().report.moved_voxels > 0);
    go(&mut rig, 20.0, 30.0, 500);
    go(&mut rig, 30.0, 30.0, 300);
    assert_eq!(soft_voxels(&rig), all);
}
