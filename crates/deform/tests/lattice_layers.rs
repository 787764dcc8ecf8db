//! Skin over fat: a thin layer that is far stiffer than what is under it, pressed by a ball.

use glam::{DMat3, DQuat, DVec3, IVec3, UVec3};
use palpate_deform::lattice::{LatticeModel, LatticeSettings};
use palpate_deform::material::{MaterialLaw, Materials, SegmentMaterial, preset};
use palpate_deform::model::{
    Budget, DeformationModel, ModelAnswer, ModelInput, ToolShape, ToolState,
};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

/// Upper face of the skin [mm]; voxels and nodes are 2 mm apart.
const TOP: f64 = 36.0;
const SPACING: f64 = 2.0;
const RADIUS: f64 = 4.0;
/// Way of the ball between two answers [mm].
const STEP: f64 = 0.25;

fn law(name: &str) -> MaterialLaw {
    let law = preset(name).and_then(|preset| preset.law());
    law.expect("a preset of the list")
}

/// A block of fat with some layers of skin on it, and what they are made of.
fn body(skin: i32) -> (Voxels, Materials) {
    let size = UVec3::splat(26);
    let spacing = DVec3::splat(SPACING);
    let grid = Grid::new(size, spacing, 0.5 * spacing, DMat3::IDENTITY).expect("a grid");
    let values = vec![0; grid.voxel_count()];
    let intensities = Intensities::new(size, values, 1.0, 0.0).expect("intensities");
    let mut voxels = Voxels::new(grid, intensities).expect("one grid");
    let top = (TOP / SPACING) as i32;
    let mut add = |solid: &(dyn Fn(IVec3) -> bool + Sync)| {
        let segment = Segment::from_fn(size, solid);
        voxels.add_segment(segment).expect("a free number")
    };
    let layers = [
        (add(&|voxel| voxel.z < top - skin), "fat"),
        (add(&|voxel| (top - skin..top).contains(&voxel.z)), "skin"),
    ];
    let matter = |(segment, name): (_, &str)| SegmentMaterial {
        segment,
        law: law(name),
        regions: Vec::new(),
    };
    let materials = Materials {
        segments: layers.map(matter).to_vec(),
    };
    (voxels, materials)
}

/// Answers while a ball is pressed in, one for each step of its way, and some `more` where it stands.
fn pressed(skin: i32, depth: f64, more: i32) -> Vec<ModelAnswer> {
    let (mut voxels, materials) = body(skin);
    let mut model = LatticeModel::new(LatticeSettings::default());
    let steps = (depth / STEP).round() as i32;
    let press = |step: i32| {
        let deep = STEP * f64::from(step.min(steps));
        let tool = ToolState {
            id: 0,
            shape: ToolShape::Ball(RADIUS),
            position: DVec3::new(26.2, 26.3, TOP + RADIUS - deep),
            orientation: DQuat::IDENTITY,
        };
        let answer = model.advance(&ModelInput {
            voxels: &voxels,
            materials: &materials,
            tools: &[tool],
            dt: 0.03,
            budget: Budget::iterations(80),
        });
        if let Some(edit) = answer.edit.clone() {
            voxels.apply(edit).expect("of these voxels");
        }
        answer
    };
    (0..=steps + more).map(press).collect()
}

/// The force on the ball, and how stiff its contact is told to be along it.
fn felt(answer: &ModelAnswer) -> [f64; 2] {
    let law = answer.contacts[0].contact;
    law.map_or([0.0; 2], |law| [law.force.z, -law.stiffness.z_axis.z])
}

#[test]
fn thin_skin_over_fat_goes_on_pushing_back() {
    for skin in [1, 2, 3] {
        let answers = pressed(skin, 5.0, 4);
        let (way, rest) = answers.split_at(answers.len() - 4);
        let forces: Vec<_> = way.iter().map(|answer| felt(answer)[0]).collect();
        println!("{skin} layers: {forces:.3?}");
        // the first of it is far from rest
        let grows = forces[2..].windows(2).all(|pair| pair[1] > pair[0]);
        assert!(grows && forces[2] > 0.0, "{skin} layers: {forces:?}");
        let broken = rest.iter().map(|answer| answer.report.bonds_broken).max();
        assert_eq!(broken, Some(0));

        // as far at rest as it comes the force is hardly another one
        let [force, stiffness] = felt(&rest[3]);
        let last = forces[forces.len() - 1];
        assert!(
            (last - force).abs() < 0.03 * force,
            "{skin} layers: {last} {force}"
        );
        // and the contact is as stiff as the last of the way was, not as a skin that nothing moves
        let slope = (last - forces[forces.len() - 5]) / (4.0 * STEP);
        assert!(
            (0.3 * slope..=2.0 * slope).contains(&stiffness),
            "{skin} layers: {stiffness} N/mm told, {slope} N/mm felt"
        );
    }
}
