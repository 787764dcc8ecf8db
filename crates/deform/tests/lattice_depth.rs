//! How deep a ball may press before tissue slips around it.

use glam::{DQuat, DVec3};
use palpate_deform::model::{Budget, ModelInput, ToolShape, ToolState};

use crate::model_support::{Bench, LIVER, TOP};

/// Force of a ball of a radius [mm] that is pressed in to a depth [mm], by half a voxel at a time.
fn force_at(bench: &mut Bench, radius: f64, depth: f64) -> f64 {
    let tool = ToolState {
        id: 1,
        shape: ToolShape::Ball(radius),
        position: DVec3::new(18.0, 18.0, TOP + radius - depth),
        orientation: DQuat::IDENTITY,
    };
    let answer = bench.model.advance(&ModelInput {
        voxels: &bench.voxels,
        materials: &bench.materials,
        tools: &[tool],
        dt: 0.03,
        budget: Budget::iterations(300),
    });
    if let Some(edit) = answer.edit.clone() {
        bench.voxels.apply(edit).expect("of this scan");
    }
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
