//! A probe that sticks to a segment which is moved or turned under it.

use crate::common::*;
use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_engine::touch::Settings;
use palpate_volume::segment::Segment;

const DIMENSIONS: UVec3 = UVec3::splat(48);
const START: DVec3 = DVec3::new(24.5, 24.5, 40.5);

fn floor_block() -> Segment {
    box_segment(DIMENSIONS, IVec3::new(10, 10, 4), IVec3::new(38, 38, 20))
}

/// Presses the probe on a block that is moved and turned under it; gives where it was and is.
fn dragged(friction: f64, pose: DAffine3) -> [DVec3; 2] {
    let mut rig = Rig::new(DIMENSIONS, START);
    let id = rig
        .simulation
        .add_segment(floor_block(), OBSTACLE, true)
        .unwrap();
    rig.simulation
        .set_settings(Settings {
            friction_static: friction,
            friction_kinetic: friction,
            ..Settings::default()
        })
        .unwrap();
    // a body of its own, so that the way there can be told from the way of the union
    rig.simulation
        .move_segment(id, shifted(DVec3::Z * 0.25))
        .unwrap();
    rig.ticks(SETTLED, START);
    let pressing = DVec3::new(26.3, 25.1, 17.25);
    for step in 0..=100 {
        let above = pressing.with_z(22.0);
        rig.ticks(1, above.lerp(pressing, f64::from(step) / 100.0));
    }
    let before = rig.ticks(SETTLED, pressing);
    assert!(before.contact && rig.status.read().touched == id.0);
    let pose = pose * shifted(DVec3::Z * 0.25);
    rig.simulation.move_segment(id, pose).unwrap();
    let after = rig.ticks(SETTLED, pressing);
    assert!(after.contact);
    [before.proxy, after.proxy]
}

#[test]
fn a_segment_that_is_moved_aside_takes_along_a_probe_that_sticks_to_it() {
    let aside = DVec3::new(1.6, -0.8, 0.0);
    // 3 mm deep and a coefficient of 1 hold 3 mm aside
    let [before, after] = dragged(1.0, shifted(aside));
    // on a plane the anchor goes with the body exactly; 0.02 is what its skin and the smooth
    // surface of voxels leave
    assert!((after - before - aside).length() < 0.02, "{before} {after}");

    // without friction it slides under the probe
    let [before, after] = dragged(0.0, shifted(aside));
    assert!((after - before).length() < BEFORE_FACE, "{before} {after}");

    // too far for the cone: 3 mm deep and 0.2 hold some 0.6 mm
    let [before, after] = dragged(0.2, shifted(aside));
    let way = (after - before).length();
    assert!(way > 0.4 && way < 0.8, "{way}");
}

#[test]
fn a_segment_that_turns_takes_along_a_probe_that_sticks_to_it() {
    let middle = DVec3::new(20.0, 22.0, 0.0);
    let turn = DAffine3::from_translation(middle)
        * DAffine3::from_rotation_z(0.25)
        * DAffine3::from_translation(-middle);
    let [before, after] = dragged(1.0, turn);
    let wanted = turn.transform_point3(before);
    assert!(wanted.distance(before) > 1.5);
    // as above
    assert!(after.distance(wanted) < 0.02, "{after} {wanted}");
}
