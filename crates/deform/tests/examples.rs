//! The example of `docs/extend/adding-a-model.md` does what the page says.

#[path = "../examples/simple_model.rs"]
mod simple_model;

use crate::model_support::{Bench, LIVER, RADIUS, TOP};
use glam::DVec3;
use simple_model::Springs;

#[test]
fn the_example_of_a_model_pushes_by_its_springs_and_moves_nothing() {
    simple_model::main();
    let mut bench = Bench::with(LIVER, DVec3::ONE, Box::new(Springs));
    let untouched = bench.picture();
    let tool = |depth: f64| DVec3::new(18.5, 18.5, TOP + RADIUS - depth);
    assert!(bench.advance(tool(-1.0)).contacts[0].contact.is_none());
    let [less, more] = [1.0, 1.01].map(|depth| {
        let contact = bench.advance(tool(depth)).contacts[0].contact;
        contact.expect("contact")
    });
    assert!(less.force.z > 0.0 && less.force.truncate().length() < 1e-9);
    let seen = (more.force.z - less.force.z) / 0.01;
    let told = -less.stiffness.z_axis.z;
    // springs turn as the ball moves, which its stiffness leaves out
    assert!((told / seen - 1.0).abs() < 0.2, "{told} {seen}");
    assert_eq!(bench.changed(&untouched), 0);
    assert!(bench.advance(DVec3::NAN).contacts[0].contact.is_none());
}
