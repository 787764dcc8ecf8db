//! By a model that is simple enough to know the answer.

use glam::{DMat3, DVec3, IVec3, UVec3, Vec3};
use palpate_deform::material::preset;
use palpate_deform::model::{
    DeformationModel, DisplacementField, ModelAnswer, ModelInput, ModelReport, ToolContact,
    ToolShape,
};
use palpate_deform::registry::ModelOptions;
use palpate_engine::deformable::ForceSource;
use palpate_engine::picture::{SceneUpdate, ShownDisplacements};
use palpate_engine::servo::TickRecord;
use palpate_volume::edit::SegmentId;
use palpate_volume::material::LocalContact;
use palpate_volume::voxel_box::VoxelBox;

use super::soft_block::{SIZE, SOFT, TOP, go, soft_voxels};
use crate::common::{OBSTACLE, Rig, box_segment};

/// Upper end of the bone in the soft block [mm].
const BONE_TOP: f64 = 10.0;
/// Of the ball that a point is in soft tissue [mm].
const RADIUS: f64 = 3.0;
/// Of the model's floor [N/mm].
const STIFFNESS: f64 = 0.25;

/// A floor that pushes by its depth under the tool, and of which what the tool is in vanishes.
#[derive(Debug, Default)]
struct Floor {
    resets: u32,
}

impl DeformationModel for Floor {
    fn advance(&mut self, input: &ModelInput<'_>) -> ModelAnswer {
        let tool = input.tools[0];
        let ToolShape::Ball(radius) = tool.shape else {
            panic!("the probe is a ball");
        };
        let depth = TOP + radius - tool.position.z;
        let law = LocalContact {
            position: tool.position,
            force: DVec3::Z * STIFFNESS * depth,
            stiffness: DMat3::from_diagonal(DVec3::Z * -STIFFNESS),
            validity: 5.0,
        };
        let all = input.voxels.grid().bounds();
        let is_in_tool = |voxel: IVec3| {
            let centre = voxel.as_dvec3() + 0.5;
            centre.distance(tool.position) <= radius + 1.5
        };
        let edit = input
            .voxels
            .label_edit(SOFT, &all, |voxel, solid| solid && !is_in_tool(voxel));
        ModelAnswer {
            edit: edit.ok().filter(|edit| depth > 0.0 && !edit.is_empty()),
            contacts: vec![ToolContact {
                tool: tool.id,
                contact: (depth > 0.0).then_some(law),
            }],
            // always: the picture never has it from anything else
            displacement: Some(field(DVec3::splat(18.0), -0.5)),
            behind: Some(field(DVec3::splat(10.0), -30.0)),
            report: ModelReport {
                iterations: self.resets,
                nodes: input.materials.segments.len() as u32,
                ..ModelReport::default()
            },
            ..ModelAnswer::default()
        }
    }

    fn reset(&mut self) {
        self.resets += 1;
    }
}

/// Nodes that have gone up by so much [mm].
fn field(origin: DVec3, up: f32) -> DisplacementField {
    DisplacementField {
        origin,
        axes: DMat3::IDENTITY,
        spacing: 2.0,
        size: UVec3::splat(2),
        moved: vec![Vec3::Z * up; 8],
    }
}

/// A soft block with bone in it, and the device above.
fn rig() -> Rig {
    let mut rig = Rig::new(SIZE, DVec3::new(20.0, 20.0, 30.0 + RADIUS));
    let soft = box_segment(SIZE, IVec3::ZERO, IVec3::new(40, 40, TOP as i32));
    let bone = box_segment(SIZE, IVec3::ZERO, IVec3::new(40, 40, BONE_TOP as i32));
    for segment in [soft, bone] {
        rig.simulation.add_segment(segment, OBSTACLE, true).unwrap();
    }
    let fat = preset("fat").unwrap().law().unwrap();
    rig.simulation.set_material(SOFT, Some(fat), false).unwrap();
    rig.simulation
        .set_deformation_model(Some(("floor", Box::new(Floor::default()))));
    rig
}

/// Goes on for so many ms with the ball's lowest point on a line; gives the last tick.
fn press(rig: &mut Rig, from: f64, to: f64, ticks: u32) -> TickRecord {
    go(rig, from + RADIUS, to + RADIUS, ticks)
}

#[test]
fn soft_matter_pushes_as_its_model_says_and_moves_out_of_the_way() {
    let mut rig = rig();
    let all = soft_voxels(&rig);
    press(&mut rig, 30.0, 20.5, 500);
    press(&mut rig, 20.5, 17.0, 1000);
    let rest = press(&mut rig, 17.0, 17.0, 1000);

    // two springs in a row, the coupling of 1 N/mm and the floor's
    let expected = 3.0 * STIFFNESS / (1.0 + STIFFNESS);
    assert!((rest.force.z - expected).abs() < 1e-6, "{}", rest.force);
    assert!(soft_voxels(&rig) < all);
    // the proxy came after, and is in no voxel
    assert!(rest.proxy.z < TOP + RADIUS - 1.0, "{}", rest.proxy);
    assert_eq!(rig.violations(), 0);

    // all of it is one step, and bone stays as it is
    press(&mut rig, 17.0, 30.0, 500);
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(soft_voxels(&rig), all);
    let now = rig.simulation.deformation();
    assert!(now.answers > 100 && now.model == Some("floor"));
}

/// The thesis' own force (5.23): of a border that is rigid until the voxels have moved.
#[test]
fn the_voxels_alone_can_be_felt_until_matter_has_moved_them() {
    let mut rig = rig();
    rig.simulation.set_force_source(ForceSource::Voxels);
    let all = soft_voxels(&rig);
    press(&mut rig, 30.0, 20.5, 500);
    let mut felt = 0;
    for step in 0..100 {
        let from = 20.5 - 0.035 * f64::from(step);
        let now = press(&mut rig, from, from - 0.035, 10);
        // nothing but the coupling to where voxels hold the probe
        assert!((now.force.length() - now.depth).abs() < 1e-6);
        felt += u32::from(now.force != DVec3::ZERO);
    }
    let rest = press(&mut rig, 17.0, 17.0, 1000);
    assert!(felt > 5, "{felt} forces");
    assert_eq!(rest.force, DVec3::ZERO);
    assert!(soft_voxels(&rig) < all);
    assert_eq!(rig.violations(), 0);
    // the tissue itself is felt as soon as it is chosen
    rig.simulation.set_force_source(ForceSource::Matter);
    let soft = press(&mut rig, 17.0, 17.0, 1000);
    let expected = 3.0 * STIFFNESS / (1.0 + STIFFNESS);
    assert!((soft.force.z - expected).abs() < 1e-6, "{}", soft.force);
    assert_eq!(rig.simulation.deformation().source, ForceSource::Matter);
}

#[test]
fn bone_under_soft_matter_is_as_hard_as_ever() {
    let mut rig = rig();
    press(&mut rig, 30.0, 8.0, 4000);
    let rest = press(&mut rig, 8.0, 8.0, 1000);
    // the coupling of 1 N/mm over the 2 mm below the bone, and what the cells of a ball are too wide
    assert!((rest.force.z - 2.0).abs() < 0.5, "{}", rest.force);
    assert!(rest.proxy.z >= BONE_TOP + RADIUS);
    let bone = rig.simulation.voxels().segment(SegmentId(2)).unwrap();
    assert_eq!(bone.count(), 40 * 40 * BONE_TOP as u64);
    assert_eq!(rig.violations(), 0);
}

#[test]
fn without_answers_a_hand_at_rest_feels_the_same_and_one_that_goes_on_comes_to_hard_voxels() {
    let mut rig = rig();
    press(&mut rig, 30.0, 17.0, 2000);
    let soft = press(&mut rig, 17.0, 17.0, 500).force;
    // the model hangs: nobody steps it
    let mut last = TickRecord::default();
    for _ in 0..3000 {
        last = rig.tick_at(DVec3::new(20.2, 20.3, 17.0 + RADIUS));
        assert!((last.force - soft).length() < 1e-9, "{} {soft}", last.force);
    }
    // aside, farther than the law is held
    for tick in 0..4000 {
        let before = last.force;
        let x = (20.2 - 0.01 * f64::from(tick)).max(5.0);
        last = rig.tick_at(DVec3::new(x, 20.3, 17.0 + RADIUS));
        let grown = last.force.length() - before.length();
        assert!(grown < 0.1, "{grown}");
    }
    // the coupling over all the way to where the voxels hold the proxy
    let hard = last.contact_point - last.device;
    assert!((last.force - hard).length() < 1e-9);
    assert!(hard.z > 2.0 && soft.z < 1.0, "{hard} {soft}");
    assert_eq!(rig.violations(), 0);
}

#[test]
fn what_others_change_while_the_model_thinks_is_kept() {
    let mut rig = rig();
    press(&mut rig, 30.0, 19.0, 2000);
    let low = IVec3::new(2, 2, 12);
    let hole = VoxelBox::new(low, low + 4);
    for step in 0..50 {
        let solid = step % 2 == 1;
        // between job and answer
        rig.simulation.step();
        rig.simulation.fill_box(SOFT, &hole, solid).unwrap();
        rig.deformation.step();
        press(&mut rig, 19.0, 19.0, 10);
        let segment = rig.simulation.voxels().segment(SOFT).unwrap();
        assert_eq!(segment.contains(low), solid, "step {step}");
    }
}

#[test]
fn a_probe_that_is_placed_elsewhere_leaves_the_force_behind() {
    let mut rig = rig();
    press(&mut rig, 30.0, 17.0, 2000);
    let above = DVec3::new(20.2, 20.3, 30.0 + RADIUS);
    rig.simulation.place(above, 1, false).unwrap();
    for _ in 0..3 {
        let tick = rig.tick_at(above);
        assert_eq!(tick.force, DVec3::ZERO);
    }
}

#[test]
fn nothing_is_asked_before_the_servo_has_told_where_the_tool_is() {
    let mut rig = rig();
    for _ in 0..5 {
        rig.simulation.step();
        rig.deformation.step();
    }
    assert_eq!(rig.simulation.deformation().answers, 0);
    assert_eq!(press(&mut rig, 30.0, 30.0, 100).force, DVec3::ZERO);
    assert!(rig.simulation.deformation().answers > 0);
}

#[test]
fn another_model_or_none_takes_the_place_at_once() {
    let mut rig = rig();
    press(&mut rig, 30.0, 18.0, 2000);
    rig.simulation.set_deformation_model(None);
    let rest = press(&mut rig, 18.0, 18.0, 1000);
    assert_eq!(rig.simulation.deformation().model, None);
    // hard again: the coupling over the whole depth
    assert!((rest.force.length() - rest.depth).abs() < 1e-9);
    assert!(
        rig.simulation
            .set_deformation(Some("jelly"), &ModelOptions::default(), false)
            .is_err()
    );
}

#[test]
fn nothing_stands_beside_its_voxels_once_the_model_is_gone() {
    let mut rig = rig();
    press(&mut rig, 30.0, 18.0, 2000);
    // what is pressed, and the body behind as far as it is shown
    let told = last_told(&rig).unwrap();
    let moved: Vec<_> = told.iter().map(|nodes| nodes.moved[0].z).collect();
    assert_eq!(moved, [-0.5, -20.0]);
    // its answer is on the way
    rig.simulation.set_deformation_model(None);
    press(&mut rig, 18.0, 18.0, 100);
    assert_eq!(last_told(&rig), Some(Vec::new()));
}

/// What the picture was told last of where tissue stands beside its voxels.
fn last_told(rig: &Rig) -> Option<ShownDisplacements> {
    fn displacements(updates: SceneUpdate) -> Vec<ShownDisplacements> {
        match updates {
            SceneUpdate::Displacements(now) => vec![now],
            SceneUpdate::Together(several) => several.into_iter().flat_map(displacements).collect(),
            _ => Vec::new(),
        }
    }
    rig.updates.try_iter().flat_map(displacements).last()
}

#[test]
fn a_material_goes_and_comes_back_with_its_segment() {
    let mut rig = rig();
    let fat = rig.simulation.material(SOFT);
    assert!(fat.is_some());
    rig.simulation.remove_segment(SOFT).unwrap();
    assert_eq!(rig.simulation.material(SOFT), None);
    assert!(rig.simulation.set_material(SOFT, fat, false).is_err());
    rig.simulation.undo().unwrap();
    assert_eq!(rig.simulation.material(SOFT), fat);
}

#[test]
fn a_model_is_told_of_other_obstacles_and_other_materials() {
    let mut rig = rig();
    let seen = |rig: &mut Rig| {
        press(rig, 18.0, 18.0, 50);
        let report = rig.simulation.deformation().report;
        (report.nodes, report.iterations)
    };
    press(&mut rig, 30.0, 18.0, 2000);
    let (segments, resets) = seen(&mut rig);
    assert_eq!(segments, 2);
    rig.simulation.set_touchable(SegmentId(2), false).unwrap();
    assert_eq!(seen(&mut rig), (1, resets));
    let liver = preset("liver").unwrap().law().unwrap();
    rig.simulation
        .set_material(SOFT, Some(liver), false)
        .unwrap();
    assert_eq!(seen(&mut rig), (1, resets + 1));
}
