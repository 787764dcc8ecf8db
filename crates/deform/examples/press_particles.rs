//! Presses a ball into a block of liver with the models of particles: depth, force, rest.
//!
//! `cargo run --release -p palpate-deform --example press_particles`
#![expect(clippy::print_stdout, reason = "a table is what this example is for")]
#![expect(
    clippy::unwrap_used,
    reason = "an example stops where its scan is refused"
)]

use glam::{DMat3, DQuat, DVec3, UVec3};
use palpate_deform::material::{Materials, SegmentMaterial, preset};
use palpate_deform::model::{Budget, DeformationModel, ModelInput, ToolShape, ToolState};
use palpate_deform::particles::{LocalModel, LocalSettings, Motion};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

const SIDE: u32 = 40;
const TOP: i32 = 24;
const H: f64 = 0.8;

fn main() {
    let iterations = std::env::args()
        .nth(1)
        .map_or(200, |given| given.parse().unwrap());
    let cells = std::env::args()
        .nth(2)
        .map_or(13, |given| given.parse().unwrap());
    let small = LocalSettings {
        box_cells: cells,
        ..LocalSettings::default()
    };
    let resting = LocalSettings {
        motion: Motion::Rest,
        ..small
    };
    press("fcc-lj", &mut LocalModel::fcc_lj(small), iterations);
    press(
        "fcc-lj at rest",
        &mut LocalModel::fcc_lj(resting),
        iterations,
    );
    press("cuboid-lj", &mut LocalModel::cuboid_lj(small), iterations);
}

fn press(name: &str, model: &mut dyn DeformationModel, iterations: u32) {
    let dimensions = UVec3::splat(SIDE);
    let grid = Grid::new(dimensions, DVec3::splat(H), DVec3::ZERO, DMat3::IDENTITY).unwrap();
    let values = vec![50; (SIDE * SIDE * SIDE) as usize];
    let mut voxels = Voxels::new(
        grid,
        Intensities::new(dimensions, values, 1.0, 0.0).unwrap(),
    )
    .unwrap();
    let segment = voxels
        .add_segment(Segment::from_fn(dimensions, |v| v.z < TOP))
        .unwrap();
    let law = preset("liver").unwrap().law().unwrap();
    let matter = SegmentMaterial {
        segment,
        law,
        regions: Vec::new(),
    };
    let materials = Materials {
        segments: vec![matter],
    };
    println!("{name}\ndepth [h]  force [mN]  stiffness [mN/mm]  steps  residual  voxels");
    let middle = f64::from(SIDE) / 2.0 + 0.5;
    for step in 0..=40 {
        let depth = -0.4 + 0.1 * f64::from(if step <= 25 { step } else { 50 - step });
        let place = DVec3::new(middle, middle, f64::from(TOP) - depth + 2.0);
        let tool = ToolState {
            id: 1,
            shape: ToolShape::Ball(2.0 * H),
            position: grid.patient_from_grid().transform_point3(place),
            orientation: DQuat::IDENTITY,
        };
        let budget = Budget::iterations(iterations);
        let answer = model.advance(&ModelInput {
            voxels: &voxels,
            materials: &materials,
            tools: &[tool],
            dt: 0.03,
            budget,
        });
        let changed = answer
            .edit
            .as_ref()
            .map_or(0, |edit| edit.dirty.voxel_count());
        if let Some(edit) = answer.edit {
            voxels.apply(edit).unwrap();
        }
        let contact = answer.contacts[0].contact;
        println!(
            "{depth:9.2}  {:10.3}  {:17.2}  {:5}  {:8.1e}  {changed:6}",
            contact.map_or(0.0, |contact| contact.force.z) * 1e3,
            contact.map_or(0.0, |contact| -contact.stiffness.z_axis.z) * 1e3,
            answer.report.iterations,
            answer.report.residual,
        );
    }
}
