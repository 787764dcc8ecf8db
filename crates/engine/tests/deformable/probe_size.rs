//! The ball that a small probe is in soft tissue.

use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_deform::registry::ModelOptions;
use palpate_engine::touch::Settings;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;

use super::soft_block::{RADIUS, SOFT, TOP, lattice_rig};
use crate::common::{OBSTACLE, Rig, box_segment};

const FREE: DVec3 = DVec3::new(20.0, 20.0, TOP + 8.0);
/// Voxels of a plate [mm], in which a ball of 2 mm has room, but none of 3 mm.
const FINE: f64 = 0.125;
const MOST: f64 = 16.0 * FINE;

/// A soft block and a point for a probe.
fn rig() -> Rig {
    let mut rig = lattice_rig();
    let point = Settings {
        probe_radius: 0.0,
        ..rig.simulation.settings()
    };
    rig.simulation.set_settings(point).unwrap();
    rig
}

/// The probe's radius once all is followed [mm].
fn radius(rig: &mut Rig) -> f64 {
    for _ in 0..3 {
        rig.ticks(30, FREE);
        rig.simulation.step();
    }
    rig.status.read().probe_radius
}

/// In voxels much finer than those of the scan, above the block.
fn plate() -> Segment {
    let dimensions = UVec3::new(16, 16, 8);
    let corner = DVec3::new(5.0, 5.0, 30.0);
    let grid = Grid::new(dimensions, DVec3::splat(FINE), corner, DMat3::IDENTITY).unwrap();
    box_segment(dimensions, IVec3::splat(2), IVec3::new(14, 14, 6)).on_grid(grid)
}

fn switch(rig: &mut Rig, model: Option<&'static str>) {
    rig.simulation
        .set_deformation(model, &ModelOptions::default(), false)
        .unwrap();
}

#[test]
fn a_point_is_a_fingertip_while_a_model_is_on() {
    let mut rig = rig();
    assert_eq!(radius(&mut rig), RADIUS);
    switch(&mut rig, None);
    assert_eq!(radius(&mut rig), 0.0);
    assert_eq!(rig.violations(), 0);
}

#[test]
fn the_ball_is_no_larger_than_the_finest_segment_lets_touch_follow() {
    let mut rig = rig();
    assert_eq!(radius(&mut rig), RADIUS);
    rig.simulation.add_segment(plate(), OBSTACLE, true).unwrap();
    assert_eq!(radius(&mut rig), MOST);
    // also where undo and redo take it away and bring it back
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(radius(&mut rig), RADIUS);
    assert!(rig.simulation.redo().unwrap());
    assert_eq!(radius(&mut rig), MOST);
    // and where the model comes after it
    switch(&mut rig, None);
    assert_eq!(radius(&mut rig), 0.0);
    switch(&mut rig, Some("lattice"));
    assert_eq!(radius(&mut rig), MOST);
    assert_eq!(rig.violations(), 0);
}

#[test]
fn a_tool_has_its_own_size_at_work_and_a_drill_also_before() {
    let mut rig = rig();
    let tool = |kind| Some(ToolSettings::new(kind, 1.0, vec![SOFT]));
    rig.simulation.set_tool(tool(ToolKind::Eraser)).unwrap();
    assert_eq!(radius(&mut rig), RADIUS);
    rig.simulation.stroke(true).unwrap();
    assert_eq!(radius(&mut rig), 0.0);
    rig.simulation.stroke(false).unwrap();
    assert_eq!(radius(&mut rig), RADIUS);
    rig.simulation.set_tool(tool(ToolKind::Drill)).unwrap();
    assert_eq!(radius(&mut rig), 0.0);
    rig.simulation.set_tool(None).unwrap();
    assert_eq!(radius(&mut rig), RADIUS);
}
