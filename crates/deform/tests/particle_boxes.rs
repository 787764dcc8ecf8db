//! The box of the thesis' local models: where it stands, what it holds, what its border does.

use crate::liver::{H, SIDE, TOP, advance, ball, force, picture, scan};
use glam::{DMat3, DVec3, IVec3};
use palpate_deform::model::{ModelEvent, ToolShape, ToolState};
use palpate_deform::particles::{LocalModel, LocalSettings};
use palpate_volume::voxel_box::VoxelBox;

#[test]
fn the_box_moves_with_the_tool_and_takes_nothing_more_from_memory() {
    let (mut voxels, materials) = scan(DVec3::splat(H));
    let untouched = picture(&voxels);
    let mut model = LocalModel::fcc_lj(LocalSettings {
        box_cells: 9,
        ..Default::default()
    });
    for step in 0..30 {
        let mut tool = ball(&voxels, 1.0);
        tool.position.x += H * (0.3 * f64::from(step) - 4.0);
        let answer = advance(&mut model, &mut voxels, &materials, &[tool], 20);
        assert!(force(&answer).is_finite());
        assert!(model.particle_count() <= 4 * 9 * 9 * 9);
    }
    // what the box has left is at rest again
    let far = VoxelBox::new(IVec3::ZERO, IVec3::new(11, SIDE, SIDE));
    let now = picture(&voxels);
    let index = |v: IVec3| voxels.grid().index(v);
    assert!(far.voxels().all(|v| now[index(v)] == untouched[index(v)]));
}

/// The box stands around the contact, not around the tool's centre, which is far away here.
#[test]
fn a_large_tool_is_felt_by_particles_that_give() {
    let (mut voxels, materials) = scan(DVec3::splat(H));
    let mut model = LocalModel::fcc_lj(LocalSettings {
        box_cells: 11,
        ..Default::default()
    });
    let mut pushed = Vec::new();
    for step in 0..=3 {
        let small = ball(&voxels, 0.1 * f64::from(step));
        let tool = ToolState {
            shape: ToolShape::Ball(6.0 * H),
            position: small.position + DVec3::Z * 4.0 * H,
            ..small
        };
        pushed.push(force(&advance(&mut model, &mut voxels, &materials, &[tool], 150)).z);
    }
    assert!(
        pushed.windows(2).all(|pair| pair[1] > pair[0]),
        "{pushed:?}"
    );
    let moved = model
        .particles()
        .filter(|(_, moved)| moved.length() > 0.02 * H)
        .count();
    assert!(moved > 50, "{moved} particles give way");
}

#[test]
fn voxels_of_other_shapes_carry_isotropic_particles() {
    let (mut voxels, materials) = scan(DVec3::new(H, H, 2.5 * H));
    let untouched = picture(&voxels);
    let mut model = LocalModel::fcc_lj(LocalSettings {
        box_cells: 11,
        ..Default::default()
    });
    let top = f64::from(TOP);
    let tool_at = |depth: f64| ToolState {
        position: {
            let place = DVec3::new(15.5, 15.5, top + (2.0 - depth) / 2.5);
            DMat3::from_diagonal(DVec3::new(H, H, 2.5 * H)) * (place - 0.5)
                + DVec3::new(5.0, -3.0, 11.0)
        },
        ..ball(&scan(DVec3::splat(H)).0, 0.0)
    };
    let mut pressed = DVec3::ZERO;
    for step in 0..=3 {
        let tool = tool_at(0.2 * f64::from(step));
        pressed = force(&advance(&mut model, &mut voxels, &materials, &[tool], 150));
    }
    assert!(pressed.z > 1e-3, "{pressed}");
    let tool = tool_at(0.6);
    let away = ToolState {
        position: tool.position + DVec3::Z * 8.0,
        ..tool
    };
    for _ in 0..3 {
        advance(&mut model, &mut voxels, &materials, &[away], 100);
    }
    assert!(picture(&voxels) == untouched);
}

/// A ball of 4 voxels in a box of 11, of which 7 give: a dent as wide as the box. Told by each
/// call of a model that was never called before, which cannot know it from what it felt.
#[test]
fn a_wide_dent_is_as_stiff_as_the_border_makes_it() {
    let pressed = |depth: f64| {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        let mut model = LocalModel::fcc_lj(LocalSettings {
            box_cells: 11,
            ..Default::default()
        });
        let small = ball(&voxels, depth);
        let tool = ToolState {
            shape: ToolShape::Ball(4.0 * H),
            position: small.position + DVec3::Z * 2.0 * H,
            ..small
        };
        let answer = advance(&mut model, &mut voxels, &materials, &[tool], 400);
        answer.contacts[0].contact.unwrap()
    };
    for depth in [0.3, 0.5, 0.7] {
        let [before, at, after] = [-0.05, 0.0, 0.05].map(|more| pressed(depth + more));
        let slope = (after.force.z - before.force.z) / (0.1 * H);
        let told = -at.stiffness.z_axis.z;
        println!("{depth} voxel deep: {slope:.4} N/mm, told {told:.4}");
        assert!((0.6..1.7).contains(&(told / slope)), "{told} {slope}");
    }
}

/// Pressed by two voxels, a crystal of Lennard-Jones slips; the force falls while it is pressed
/// deeper, and that is told.
#[test]
fn a_crystal_that_slips_tells_so() {
    let (mut voxels, materials) = scan(DVec3::splat(H));
    let mut model = LocalModel::fcc_lj(LocalSettings {
        box_cells: 11,
        ..Default::default()
    });
    let (mut last, mut falls, mut told) = (0.0, 0, Vec::new());
    for step in 0..=40 {
        let depth = 0.05 * f64::from(step);
        let tool = ball(&voxels, depth);
        let answer = advance(&mut model, &mut voxels, &materials, &[tool], 200);
        let slips = answer.events.iter().filter_map(|event| match event {
            ModelEvent::Slipped { count, place } => Some((depth, *count, *place)),
            _ => None,
        });
        let before = told.len();
        told.extend(slips);
        let now = force(&answer).z;
        println!("{depth:.2} {now:.5} {:?}", &told[before..]);
        if now < 0.9 * last {
            falls += 1;
            assert!(
                told.len() > before,
                "fell from {last} to {now} at {depth}, untold"
            );
        }
        last = now;
    }
    assert!(falls > 0, "it never slipped");
    // an elastic dent is no slip
    assert!(told.iter().all(|(depth, ..)| *depth > 0.4), "{told:?}");
    let contact = ball(&voxels, 1.0).position - DVec3::Z * 2.0 * H;
    assert!(
        told.iter()
            .all(|(.., place)| place.distance(contact) < 5.0 * H)
    );
}
