//! Matter that gives way under the probe, by a model that is simple enough to know the answer.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use std::sync::mpsc;

use common::{OBSTACLE, Rig, box_segment};
use glam::{DMat3, DVec3, IVec3, UVec3, Vec3};
use palpate_deform::material::{MaterialLaw, Region, SolidSi, Treatment, preset};
use palpate_deform::model::{
    DeformationModel, DisplacementField, ModelAnswer, ModelInput, ModelReport, ToolContact,
    ToolShape,
};
use palpate_engine::deformation_loop::Bell;
use palpate_engine::handover::TickRecord;
use palpate_engine::scene::Properties;
use palpate_engine::scene_news::SceneNews;
use palpate_engine::settings::Settings;
use palpate_engine::surfaces::DisplacedNow;
use palpate_volume::edit::SegmentId;
use palpate_volume::material::LocalContact;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

const SIZE: UVec3 = UVec3::new(40, 40, 40);
/// Upper end of the soft block, and of the bone in it [mm].
const TOP: f64 = 20.0;
const BONE_TOP: f64 = 10.0;
/// Of the model's floor [N/mm].
const STIFFNESS: f64 = 0.25;
const SOFT: SegmentId = SegmentId(1);
const STONE: SegmentId = SegmentId(2);

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
        let depth = TOP - tool.position.z;
        let law = LocalContact {
            position: tool.position,
            force: DVec3::Z * STIFFNESS * depth,
            stiffness: DMat3::from_diagonal(DVec3::Z * -STIFFNESS),
            validity: 5.0,
        };
        let all = input.voxels.grid().bounds();
        let is_in_tool = |voxel: IVec3| {
            let centre = voxel.as_dvec3() + 0.5;
            centre.distance(tool.position) <= radius + 0.5
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
            displacement: Some(dent()),
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

/// Half a voxel down, anywhere.
fn dent() -> DisplacementField {
    DisplacementField {
        origin: DVec3::splat(18.0),
        axes: DMat3::IDENTITY,
        spacing: 2.0,
        size: UVec3::splat(2),
        moved: vec![Vec3::Z * -0.5; 8],
    }
}

/// A soft block with bone in it, and the device above.
fn rig() -> Rig {
    let mut rig = Rig::new(SIZE, DVec3::new(20.0, 20.0, 30.0));
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

/// Goes on for so many ms with the device on a line, as a session does; gives the last tick.
fn go(rig: &mut Rig, from: f64, to: f64, ticks: u32) -> TickRecord {
    let mut last = TickRecord::default();
    for tick in 1..=ticks {
        let share = f64::from(tick) / f64::from(ticks);
        let z = from + share * (to - from);
        let before = last.force.length();
        last = rig.tick_at(DVec3::new(20.2, 20.3, z));
        let way = (to - from).abs() / f64::from(ticks);
        // the slope of the coupling, and the hand's way: no step
        assert!(last.force.length() - before <= way + 0.1 || tick == 1);
        if tick % 10 == 0 {
            rig.simulation.step();
            rig.deformation.step();
        }
    }
    last
}

fn soft_voxels(rig: &Rig) -> u64 {
    rig.simulation.voxels().segment(SOFT).unwrap().count()
}

#[test]
fn soft_matter_pushes_as_its_model_says_and_moves_out_of_the_way() {
    let mut rig = rig();
    let all = soft_voxels(&rig);
    go(&mut rig, 30.0, 20.5, 500);
    go(&mut rig, 20.5, 17.0, 1000);
    let rest = go(&mut rig, 17.0, 17.0, 1000);

    // two springs in a row, the coupling of 1 N/mm and the floor's
    let expected = 3.0 * STIFFNESS / (1.0 + STIFFNESS);
    assert!((rest.force.z - expected).abs() < 1e-6, "{}", rest.force);
    assert!(soft_voxels(&rig) < all);
    // the proxy came after, and is in no voxel
    assert!(rest.proxy.z < TOP - 1.0, "{}", rest.proxy);
    assert_eq!(rig.violations(), 0);

    // all of it is one step, and bone stays as it is
    go(&mut rig, 17.0, 30.0, 500);
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(soft_voxels(&rig), all);
    let now = rig.simulation.deformation();
    assert!(now.answers > 100 && now.model == Some("floor"));
}

#[test]
fn bone_under_soft_matter_is_as_hard_as_ever() {
    let mut rig = rig();
    go(&mut rig, 30.0, 8.0, 4000);
    let rest = go(&mut rig, 8.0, 8.0, 1000);
    // the coupling of 1 N/mm over the 2 mm below the bone, less what smoothing rounds
    assert!((rest.force.z - 2.0).abs() < 0.3, "{}", rest.force);
    assert!(rest.proxy.z >= BONE_TOP);
    let bone = rig.simulation.voxels().segment(SegmentId(2)).unwrap();
    assert_eq!(bone.count(), 40 * 40 * BONE_TOP as u64);
    assert_eq!(rig.violations(), 0);
}

#[test]
fn without_answers_soft_matter_becomes_as_hard_as_its_voxels() {
    let mut rig = rig();
    go(&mut rig, 30.0, 17.0, 2000);
    let soft = go(&mut rig, 17.0, 17.0, 500).force.z;
    // the model hangs: nobody steps it
    let mut last = TickRecord::default();
    for tick in 0..2000 {
        let before = last.force;
        last = rig.tick_at(DVec3::new(20.2, 20.3, 17.0));
        let grown = last.force.length() - before.length();
        assert!(grown < 0.1 || tick == 0, "{grown}");
    }
    // the coupling over all the way to where the voxels hold the proxy
    let hard = last.contact_point - last.device;
    assert!((last.force - hard).length() < 1e-9);
    assert!((hard.z - soft).abs() > 0.05, "{hard} {soft}");
    assert_eq!(rig.violations(), 0);
}

#[test]
fn what_others_change_while_the_model_thinks_is_kept() {
    let mut rig = rig();
    go(&mut rig, 30.0, 19.0, 2000);
    let low = IVec3::new(2, 2, 12);
    let hole = palpate_volume::voxel_box::VoxelBox::new(low, low + 4);
    for step in 0..50 {
        let solid = step % 2 == 1;
        // between job and answer
        rig.simulation.step();
        rig.simulation.fill_box(SOFT, &hole, solid).unwrap();
        rig.deformation.step();
        go(&mut rig, 19.0, 19.0, 10);
        let segment = rig.simulation.voxels().segment(SOFT).unwrap();
        assert_eq!(segment.contains(low), solid, "step {step}");
    }
}

#[test]
fn a_probe_that_is_placed_elsewhere_leaves_the_force_behind() {
    let mut rig = rig();
    go(&mut rig, 30.0, 17.0, 2000);
    let above = DVec3::new(20.2, 20.3, 30.0);
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
    assert_eq!(go(&mut rig, 30.0, 30.0, 100).force, DVec3::ZERO);
    assert!(rig.simulation.deformation().answers > 0);
}

#[test]
fn another_model_or_none_takes_the_place_at_once() {
    let mut rig = rig();
    go(&mut rig, 30.0, 18.0, 2000);
    rig.simulation.set_deformation_model(None);
    let rest = go(&mut rig, 18.0, 18.0, 1000);
    assert_eq!(rig.simulation.deformation().model, None);
    // hard again: the coupling over the whole depth
    assert!((rest.force.length() - rest.depth).abs() < 1e-9);
    assert!(
        rig.simulation
            .set_deformation(Some("jelly"), None, false)
            .is_err()
    );
}

#[test]
fn nothing_stands_beside_its_voxels_once_the_model_is_gone() {
    let mut rig = rig();
    go(&mut rig, 30.0, 18.0, 2000);
    assert_eq!(last_told(&rig).map(|told| told.is_some()), Some(true));
    // its answer is on the way
    rig.simulation.set_deformation_model(None);
    go(&mut rig, 18.0, 18.0, 100);
    assert_eq!(last_told(&rig), Some(None));
}

/// What the picture was told last of where matter stands beside its voxels.
fn last_told(rig: &Rig) -> Option<DisplacedNow> {
    fn displaced(news: SceneNews) -> Vec<DisplacedNow> {
        match news {
            SceneNews::Displaced(now) => vec![now],
            SceneNews::Together(several) => several.into_iter().flat_map(displaced).collect(),
            _ => Vec::new(),
        }
    }
    rig.news.try_iter().flat_map(displaced).last()
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
        go(rig, 18.0, 18.0, 50);
        let report = rig.simulation.deformation().report;
        (report.nodes, report.iterations)
    };
    go(&mut rig, 30.0, 18.0, 2000);
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

/// A soft block pressed by the default model.
fn lattice_rig() -> Rig {
    let mut rig = Rig::new(SIZE, DVec3::new(20.0, 20.0, 30.0));
    let soft = box_segment(SIZE, IVec3::ZERO, IVec3::new(40, 40, TOP as i32));
    rig.simulation.add_segment(soft, OBSTACLE, true).unwrap();
    let gel = SolidSi {
        young: 2e4,
        poisson: 0.45,
        density: 1050.0,
        breaking_strain: f64::INFINITY,
        friction: 0.0,
    };
    let law = MaterialLaw::constant(gel).unwrap();
    rig.simulation.set_material(SOFT, Some(law), false).unwrap();
    rig.simulation
        .set_deformation(Some("lattice"), None, false)
        .unwrap();
    let ball = Settings {
        probe_radius: 2.0,
        ..rig.simulation.settings()
    };
    rig.simulation.set_settings(ball).unwrap();
    rig
}

#[test]
fn what_the_lattice_dents_comes_back_and_leaves_no_step_of_undo() {
    let mut rig = lattice_rig();
    let all = soft_voxels(&rig);
    assert!(rig.simulation.undo().unwrap(), "adding the segment");
    assert!(rig.simulation.redo().unwrap());
    // the ball reaches 2 mm below its middle
    go(&mut rig, 30.0, 22.5, 200);
    go(&mut rig, 22.5, 19.0, 900);
    let rest = go(&mut rig, 19.0, 19.0, 300);
    let moved = rig.simulation.deformation().report.moved_voxels;
    assert!(moved > 10 && soft_voxels(&rig) < all, "{moved} voxels");
    // the proxy came after the tool into the dent, and is in no voxel
    assert!(rest.proxy.z < TOP + 2.0 - 0.9, "{}", rest.proxy);
    assert!(rest.force.z > 0.0);

    go(&mut rig, 19.0, 30.0, 600);
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
        rig.simulation.set_deformation(name, None, false).unwrap();
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
    let (ring, bell) = mpsc::channel();
    rig.deformation.set_bell(Bell::new(move || {
        ring.send(()).unwrap();
    }));
    go(&mut rig, 30.0, 19.0, 900);
    let rung = bell.try_iter().count() as u64;
    let before = rig.simulation.deformation().answers;
    assert!(rung >= before && rung > 20, "{rung} rang, {before} came");
    let mut rings = 0;
    for step in 0..20 {
        for _ in 0..10 {
            rig.tick_at(DVec3::new(20.2, 20.3, 19.0 - 0.05 * f64::from(step)));
        }
        rig.simulation.answer_came();
        rig.deformation.step();
        rings += bell.try_iter().count();
    }
    assert_eq!(rings, 20);
    assert!(rig.simulation.deformation().report.moved_voxels > 0);
    // one that is answered at once is taken, and the next question waits for a pass
    rig.simulation.answer_came();
    rig.deformation.step();
    rig.simulation.answer_came();
    let answers = rig.simulation.deformation().answers;
    rig.deformation.step();
    assert!(bell.try_recv().is_err());
    rig.simulation.step();
    rig.deformation.step();
    assert!(bell.try_recv().is_ok());
    assert_eq!(rig.simulation.deformation().answers, answers);
}

/// What a region makes rigid stops the probe also where no answer comes any more, and goes with the
/// segment that it is shared with.
#[test]
fn a_rigid_region_is_hard_whatever_the_model_says() {
    let deepest = |shared: bool, removed: bool| {
        let mut rig = lattice_rig();
        let stone = box_segment(SIZE, IVec3::ZERO, IVec3::new(40, 40, 17));
        rig.simulation
            .add_segment(stone, Properties::default(), true)
            .unwrap();
        let region = if shared {
            Region::Shared(STONE)
        } else {
            Region::Within(VoxelBox::new(IVec3::ZERO, IVec3::new(40, 40, 17)))
        };
        let regions = vec![(region, Treatment::Rigid)];
        rig.simulation.set_regions(SOFT, regions).unwrap();
        if removed {
            let none = Segment::from_fn(SIZE, |_| false);
            rig.simulation.replace_segment(STONE, none, None).unwrap();
        }
        rig.simulation
            .set_deformation_model(Some(("air", Box::new(Air))));
        let rest = go(&mut rig, 30.0, 15.0, 3000);
        assert_eq!(rig.violations(), 0);
        rest.force.z
    };
    // 2 mm above the stone the ball touches it: the spring is as long as it is led deeper
    for (shared, removed) in [(false, false), (true, false)] {
        let force = deepest(shared, removed);
        assert!(force > 1.0, "{force} N, {shared}");
    }
    assert_eq!(deepest(true, true), 0.0);
}

/// To this model all matter is air.
#[derive(Debug)]
struct Air;

impl DeformationModel for Air {
    fn advance(&mut self, input: &ModelInput<'_>) -> ModelAnswer {
        let nothing = |tool: &palpate_deform::model::ToolState| ToolContact {
            tool: tool.id,
            contact: Some(LocalContact {
                position: tool.position,
                force: DVec3::ZERO,
                stiffness: DMat3::ZERO,
                validity: 100.0,
            }),
        };
        ModelAnswer {
            contacts: input.tools.iter().map(nothing).collect(),
            ..ModelAnswer::default()
        }
    }

    fn reset(&mut self) {}
}

#[test]
fn regions_of_a_segment_can_be_rigid_or_as_if_they_were_not_there() {
    let force = |treatment| {
        let mut rig = lattice_rig();
        let region = Region::Within(VoxelBox::new(IVec3::ZERO, IVec3::new(40, 40, 18)));
        rig.simulation
            .set_regions(SOFT, vec![(region, treatment)])
            .unwrap();
        assert_eq!(rig.simulation.regions(SOFT), [(region, treatment)]);
        go(&mut rig, 30.0, 21.0, 1000);
        go(&mut rig, 21.0, 21.0, 300);
        rig.simulation.deformation().force.z
    };
    let [soft, rigid, empty] =
        [Treatment::Deformable, Treatment::Rigid, Treatment::Empty].map(force);
    // two layers over what is rigid, as a whole body, and as a skin over nothing
    assert!(
        rigid > 1.3 * soft && soft > 1.3 * empty && empty > 0.0,
        "{rigid} {soft} {empty}"
    );
    let mut rig = lattice_rig();
    let nobody = SegmentId(9);
    assert!(rig.simulation.set_regions(nobody, Vec::new()).is_err());
    let shared = vec![(Region::Shared(nobody), Treatment::Rigid)];
    assert!(rig.simulation.set_regions(SOFT, shared).is_err());
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
    rig.simulation.set_deformation(name, Some(9), true).unwrap();
    // what is so already is no step
    rig.simulation.set_deformation(name, Some(9), true).unwrap();
    let chosen = |rig: &Rig| {
        let now = rig.simulation.deformation();
        (rig.simulation.material(SOFT), now.model, now.edge)
    };
    let last = chosen(&rig);
    assert_eq!(last, (fat, name, Some(9)));

    assert!(rig.simulation.undo().unwrap());
    assert_eq!(chosen(&rig), (fat, Some("lattice"), None));
    assert!(rig.simulation.undo().unwrap());
    assert_eq!(chosen(&rig), (gel, Some("lattice"), None));
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
    rig.simulation.set_deformation(None, None, true).unwrap();
    go(&mut rig, 30.0, 19.0, 900);
    let hard = go(&mut rig, 19.0, 19.0, 300).force.z;
    assert_eq!(soft_voxels(&rig), all);
    assert!(rig.simulation.undo().unwrap());
    let soft = go(&mut rig, 19.0, 19.0, 500).force.z;
    assert!(soft > 0.0 && soft < 0.8 * hard, "{soft} {hard}");
    assert!(rig.simulation.deformation().report.moved_voxels > 0);
    go(&mut rig, 19.0, 30.0, 500);
    go(&mut rig, 30.0, 30.0, 300);
    assert_eq!(soft_voxels(&rig), all);
}
