//! How deep a ball may press before tissue slips around it.

use glam::DVec3;
use palpate_deform::model::Budget;

use crate::model_support::{Bench, LIVER, TOP, answer_to_ball};

/// Force of a ball of a radius [mm] that is pressed in to a depth [mm], by half a voxel at a time.
fn force_at(bench: &mut Bench, radius: f64, depth: f64) -> f64 {
    let place = DVec3::new(18.0, 18.0, TOP + radius - depth);
    let (model, budget) = (bench.model.as_mut(), Budget::iterations(300));
    let ball = (place, radius);
    let answer = answer_to_ball(model, &mut bench.voxels, &bench.materials, ball, budget);
    answer.contacts[0].contact.map_or(0.0, |c| c.force.z)
}

#[test]
fn a_ball_of_two_spacings_is_pushed_back_the_more_the_deeper_it_is() {
    let mut bench = Bench::new(LIVER);
    let mut last = 0.0;
    for half in 1..=16 {
        let force = force_at(&mut bench, 2.0, 0.5 * f64::from(half));
        assert!(
            force > last,
            "{force} N after {last} N, {half} half voxels deep"
        );
        last = force;
    }
}
