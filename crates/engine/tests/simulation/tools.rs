//! Tools in the hand: what strokes change, that touch follows, and that they are one step.

use crate::common::*;
use glam::{DAffine3, DVec3, IVec3, UVec3};
use palpate_engine::error::SessionError;
use palpate_engine::scene::Properties;
use palpate_engine::touch::Settings;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::specific_energy::SpecificEnergy;
use palpate_volume::edit::SegmentId;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::VoxelsError;

const DIMENSIONS: UVec3 = UVec3::splat(40);
const BLOCK: SegmentId = SegmentId(1);

fn tool(kind: ToolKind, radius: f64, segments: &[SegmentId]) -> ToolSettings {
    ToolSettings::new(kind, radius, segments.to_vec())
}

/// A block below z = 20, an obstacle, and the probe above it.
fn rig() -> Rig {
    let mut rig = Rig::new(DIMENSIONS, DVec3::new(20.3, 20.4, 26.0));
    let block = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(40, 40, 20));
    let properties = Properties {
        range: Some((1.0, 2.0)),
        ..OBSTACLE
    };
    rig.simulation.add_segment(block, properties, true).unwrap();
    rig.pass(DVec3::new(20.3, 20.4, 26.0), 0.0);
    rig
}

fn mask(rig: &Rig, id: SegmentId) -> Vec<u8> {
    rig.simulation.voxels().segment(id).unwrap().mask()
}

#[test]
fn an_erasers_stroke_frees_its_way_and_is_one_step() {
    let mut rig = rig();
    let before = mask(&rig, BLOCK);
    let settings = tool(ToolKind::Eraser, 2.0, &[BLOCK]);
    rig.simulation.set_tool(Some(settings)).unwrap();
    rig.simulation.stroke(true).unwrap();
    // over the block, half a millimetre above it
    for step in 0..=40 {
        let x = 10.0 + 0.5 * f64::from(step);
        rig.pass(DVec3::new(x, 20.4, 20.5), 0.0);
    }
    rig.simulation.stroke(false).unwrap();

    let segment = rig.simulation.voxels().segment(BLOCK).unwrap();
    for x in 11..30 {
        assert!(!segment.contains(IVec3::new(x, 20, 19)), "{x}");
        assert!(segment.contains(IVec3::new(x, 20, 17)), "{x}");
    }
    let report = rig.simulation.tool_report();
    assert!(report.voxels > 60 && report.volume == report.voxels as f64);
    assert_eq!(rig.simulation.segments()[0].range, None);
    assert!(rig.simulation.undo_bytes().0 > 0);

    let after = mask(&rig, BLOCK);
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(mask(&rig, BLOCK), before);
    assert_eq!(rig.simulation.segments()[0].range, Some((1.0, 2.0)));
    assert!(rig.simulation.redo().unwrap());
    assert_eq!(mask(&rig, BLOCK), after);
    // the next step back is the segment itself
    rig.simulation.undo().unwrap();
    rig.simulation.undo().unwrap();
    assert!(rig.simulation.voxels().segment(BLOCK).is_none());
}

#[test]
fn a_drill_through_two_segments_leaves_the_locked_one_whole() {
    let mut rig = rig();
    // the far half of the block, one voxel below its face, and one below all of it
    let half = box_segment(DIMENSIONS, IVec3::new(20, 0, 0), IVec3::new(40, 40, 20));
    let half = rig.simulation.add_segment(half, OBSTACLE, true).unwrap();
    rig.simulation.set_locked(half, true).unwrap();
    let before = mask(&rig, half);
    let inside = IVec3::new(20, 20, 19);
    let stored = rig.simulation.voxels().stored(inside);
    let settings = tool(ToolKind::Drill, 3.0, &[BLOCK, half]);
    rig.simulation.set_tool(Some(settings)).unwrap();
    rig.simulation.stroke(true).unwrap();
    for _ in 0..60 {
        rig.pass(DVec3::new(20.0, 20.4, 18.0), 5.0);
    }
    rig.simulation.stroke(false).unwrap();
    let block = rig.simulation.voxels().segment(BLOCK).unwrap();
    assert!(!block.contains(IVec3::new(19, 20, 19)));
    // what both have stays in both, with its value
    assert!(block.contains(inside));
    assert_eq!(rig.simulation.voxels().stored(inside), stored);
    assert_eq!(mask(&rig, half), before);
    assert!(rig.simulation.tool_report().voxels > 0);
}

#[test]
fn what_is_locked_is_refused_until_it_is_unlocked() {
    let mut rig = rig();
    rig.simulation.set_locked(BLOCK, true).unwrap();
    let before = mask(&rig, BLOCK);
    let none = || box_segment(DIMENSIONS, IVec3::ZERO, IVec3::ZERO);
    let all = VoxelBox::new(IVec3::ZERO, IVec3::splat(9));
    let settings = tool(ToolKind::Eraser, 2.0, &[BLOCK]);
    rig.simulation.set_tool(Some(settings)).unwrap();
    let simulation = &mut rig.simulation;
    let refused = [
        simulation.stroke(true).err(),
        simulation.remove_segment(BLOCK).err(),
        simulation.replace_segment(BLOCK, none(), None).err(),
        simulation.fill_box(BLOCK, &all, false).err(),
        simulation.part_segment(BLOCK, (none(), none())).err(),
    ];
    for error in refused {
        assert!(matches!(error, Some(SessionError::Locked(1))), "{error:?}");
    }
    assert!(simulation.segments()[0].locked);
    simulation.set_locked(BLOCK, false).unwrap();
    simulation.fill_box(BLOCK, &all, false).unwrap();
    assert_ne!(mask(&rig, BLOCK), before);
}

#[test]
fn a_drill_that_presses_sinks_in_and_spends_what_it_says() {
    let mut rig = rig();
    let settings = tool(ToolKind::Drill, 2.0, &[BLOCK]);
    rig.simulation.set_tool(Some(settings)).unwrap();
    let press = DVec3::new(20.3, 20.4, 18.0);
    for _ in 0..20 {
        rig.pass(press, 5.0);
    }
    let surface = rig.pass(press, 5.0).proxy.z;
    assert!((surface - 20.0).abs() < 0.1, "{surface}");

    rig.simulation.stroke(true).unwrap();
    let mut deepest = surface;
    for step in 0..150 {
        // the hand follows, two millimetres into what is left
        let device = press.with_z(surface - 2.0 - 0.02 * f64::from(step));
        deepest = rig.pass(device, 5.0).proxy.z.min(deepest);
    }
    rig.simulation.stroke(false).unwrap();
    assert!(deepest < surface - 2.0, "sank to {deepest}");
    assert_eq!(rig.violations(), 0);

    let report = rig.simulation.tool_report();
    // stored 0 is water: 131 kg/m³ of bone's 1900
    let per_volume = 1300.0 * 131.0 / 1900.0;
    let stated = per_volume * report.volume;
    assert!(report.energy >= stated - 1e-6 && report.energy <= stated + per_volume + 1e-6);
    let segment = rig.simulation.voxels().segment(BLOCK).unwrap();
    assert_eq!(40 * 40 * 20 - segment.count(), report.voxels);
    assert!(report.voxels > 20, "{report:?}");
    let air = rig.simulation.voxels().stored(IVec3::new(20, 20, 19));
    assert_eq!(air, Some(-1000));

    // undone while the probe is in the hole: held until it is out
    rig.simulation.undo().unwrap();
    rig.pass(press.with_z(10.0), 0.0);
    assert_eq!(
        rig.simulation.voxels().segment(BLOCK).unwrap().count(),
        40 * 40 * 20
    );
    for _ in 0..100 {
        rig.pass(press.with_z(26.0), 0.0);
    }
    let after = rig.pass(press, 0.0);
    assert!((after.proxy.z - surface).abs() < 0.1, "{}", after.proxy);
    assert_eq!(rig.violations(), 0);
}

/// A hand that knocks and is drawn aside within each pass; what the device has sent is a share of it,
/// as while forces come up.
#[test]
fn a_drill_works_by_what_presses_in_every_tick_without_friction_and_not_while_forces_are_off() {
    for (sent, works) in [(0.1, true), (0.0, false)] {
        let mut rig = rig();
        let rough = Settings {
            friction_static: 0.8,
            friction_kinetic: 0.6,
            ..rig.simulation.settings()
        };
        rig.simulation.set_settings(rough).unwrap();
        let mut settings = tool(ToolKind::Drill, 2.0, &[BLOCK]);
        // no voxel goes, so that nothing but the hand changes the force
        settings.drill.specific_energy = SpecificEnergy::Everywhere(1e6);
        let work_per_newton = settings.drill.cutting_ratio * settings.drill.surface_speed * 1e-3;
        rig.simulation.set_tool(Some(settings)).unwrap();
        let press = DVec3::new(20.3, 20.4, 19.0);
        for _ in 0..100 {
            rig.pass(press, sent);
        }
        rig.simulation.stroke(true).unwrap();
        rig.pass(press, sent);
        let (mut expected, mut felt_aside) = (rig.simulation.tool_report().energy, 0.0);
        for pass in 0..60 {
            for tick in 0..10 {
                let deep = if tick == 9 {
                    0.2
                } else {
                    0.1 * f64::from(tick)
                };
                let aside = 0.02 * f64::from(10 * pass + tick);
                let device = press - DVec3::new(aside, 0.0, deep);
                let force = rig.tick_sent(device, sent).force;
                expected += if works {
                    work_per_newton * force.z
                } else {
                    0.0
                };
                felt_aside += force.x;
            }
            rig.simulation.step();
        }
        let energy = rig.simulation.tool_report().energy;
        // rounding of sums
        assert!(
            (energy - expected).abs() < 1e-6 * expected.max(1.0),
            "{energy} {expected}"
        );
        assert_eq!(energy > 100.0, works, "{energy}");
        assert!(felt_aside > 100.0, "{felt_aside}");
    }
}

#[test]
fn what_an_adder_fills_is_never_held_back() {
    let mut rig = rig();
    let settings = tool(ToolKind::Adder, 1.5, &[BLOCK]);
    rig.simulation.set_tool(Some(settings)).unwrap();
    rig.simulation.stroke(true).unwrap();
    let before = rig.simulation.voxels().segment(BLOCK).unwrap().count();
    let mut random = Random::new(4);
    let mut at = DVec3::new(10.0, 10.0, 30.0);
    for _ in 0..10 {
        let to = random.point(6.0, 34.0).with_z(random.between(24.0, 36.0));
        for _ in 0..25 {
            at = at.lerp(to, 0.1);
            rig.pass(at, 0.0);
            // a pass later touch has taken it in
            let status = *rig.status.read();
            assert!(status.pending <= 1, "{status:?}");
        }
    }
    rig.simulation.stroke(false).unwrap();
    let filled = rig.simulation.voxels().segment(BLOCK).unwrap().count() - before;
    assert!(filled > 100, "{filled}");
    assert_eq!(rig.violations(), 0);
    let warned = rig
        .notices
        .try_iter()
        .any(|notice| notice.text.contains("waits"));
    assert!(!warned, "a change was held back");
}

#[test]
fn a_change_in_the_middle_of_a_stroke_makes_two_steps_of_it() {
    let mut rig = rig();
    let settings = tool(ToolKind::Eraser, 2.0, &[BLOCK]);
    rig.simulation.set_tool(Some(settings)).unwrap();
    rig.simulation.stroke(true).unwrap();
    let mut states = vec![mask(&rig, BLOCK)];
    rig.pass(DVec3::new(12.0, 20.0, 20.5), 0.0);
    rig.pass(DVec3::new(12.5, 20.0, 20.5), 0.0);
    states.push(mask(&rig, BLOCK));
    let region = palpate_volume::voxel_box::VoxelBox::new(IVec3::splat(2), IVec3::splat(5));
    rig.simulation.fill_box(BLOCK, &region, false).unwrap();
    states.push(mask(&rig, BLOCK));
    for x in 14..20 {
        rig.pass(DVec3::new(f64::from(x), 20.0, 20.5), 0.0);
    }
    states.push(mask(&rig, BLOCK));
    assert!(states.windows(2).all(|pair| pair[0] != pair[1]));
    // undo while the tool is pressed; it presses on nothing more here
    for state in states.iter().rev().skip(1) {
        assert!(rig.simulation.undo().unwrap());
        assert_eq!(mask(&rig, BLOCK), *state);
    }
}

#[test]
fn a_moved_segment_is_worked_on_where_it_stands() {
    let mut rig = rig();
    let other = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(40, 40, 20));
    let other = rig
        .simulation
        .add_segment(other, Properties::default(), true)
        .unwrap();
    let up = DAffine3::from_translation(DVec3::new(0.0, 0.0, 12.0));
    rig.simulation.set_touchable(BLOCK, false).unwrap();
    rig.simulation.move_segment(BLOCK, up).unwrap();
    let settings = tool(ToolKind::Eraser, 2.0, &[BLOCK, other]);
    rig.simulation.set_tool(Some(settings)).unwrap();
    rig.simulation.stroke(true).unwrap();
    for _ in 0..3 {
        rig.pass(DVec3::new(20.5, 20.5, 30.5), 0.0);
    }
    let told = rig
        .notices
        .try_iter()
        .any(|notice| notice.text.starts_with("1 of the chosen"));
    assert!(told);
    rig.simulation.stroke(false).unwrap();
    // 30.5 in the scene is 18.5 in the block's own frame
    let block = rig.simulation.voxels().segment(BLOCK).unwrap();
    assert!(!block.contains(IVec3::new(20, 20, 18)) && block.contains(IVec3::new(20, 20, 15)));
    let count = rig.simulation.voxels().segment(other).unwrap().count();
    assert_eq!(count, 40 * 40 * 20);
}

#[test]
fn wrong_tools_are_refused_and_a_lost_segment_ends_the_stroke() {
    let mut rig = rig();
    assert!(matches!(
        rig.simulation.stroke(true),
        Err(SessionError::NoTool)
    ));
    let unknown = tool(ToolKind::Eraser, 2.0, &[SegmentId(9)]);
    let error = rig.simulation.set_tool(Some(unknown));
    assert!(matches!(
        error,
        Err(SessionError::Voxels(VoxelsError::UnknownSegment(9)))
    ));
    let huge = tool(ToolKind::Eraser, 1e9, &[BLOCK]);
    assert!(matches!(
        rig.simulation.set_tool(Some(huge)),
        Err(SessionError::Tool(_))
    ));

    let settings = tool(ToolKind::Eraser, 2.0, &[BLOCK]);
    rig.simulation.set_tool(Some(settings)).unwrap();
    rig.simulation.stroke(true).unwrap();
    rig.simulation.remove_segment(BLOCK).unwrap();
    rig.pass(DVec3::new(12.0, 20.0, 20.5), 0.0);
    let stops = |notice: &palpate_engine::notice::Notice| notice.text.contains("The tool stops");
    assert_eq!(rig.notices.try_iter().filter(stops).count(), 1);
    rig.pass(DVec3::new(12.0, 20.0, 20.5), 0.0);
    assert_eq!(rig.notices.try_iter().filter(stops).count(), 0);
    assert!(rig.simulation.undo().unwrap());
}

#[test]
fn a_placement_is_no_part_of_a_stroke() {
    let mut rig = rig();
    let settings = tool(ToolKind::Eraser, 2.0, &[BLOCK]);
    rig.simulation.set_tool(Some(settings)).unwrap();
    rig.simulation.stroke(true).unwrap();
    let start = DVec3::new(8.0, 20.5, 20.5);
    rig.pass(start, 0.0);
    let there = DVec3::new(32.0, 20.5, 20.5);
    rig.simulation.place(there, 0, true).unwrap();
    for _ in 0..3 {
        rig.pass(start, 0.0);
    }
    let segment = rig.simulation.voxels().segment(BLOCK).unwrap();
    let erased = |x| !segment.contains(IVec3::new(x, 20, 19));
    assert!(erased(8) && erased(32));
    assert!(
        (12..28).all(|x| !erased(x)),
        "the way of the jump was erased"
    );
}
