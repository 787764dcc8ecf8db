//! The thesis' local models as models: pressing, giving back, edits of others, absurd input.
#![expect(clippy::unwrap_used, reason = "a test stops where its scan is refused")]

use glam::{DMat3, DQuat, DVec3, IVec3, UVec3};
use palpate_deform::material::{MaterialLaw, Materials, Part, SegmentMatter, Treatment, preset};
use palpate_deform::model::{
    Budget, DeformationModel, ModelAnswer, ModelInput, ToolShape, ToolState, model_from_name,
};
use palpate_deform::particles::{LocalModel, LocalSettings, Motion};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

const SIDE: i32 = 30;
/// The matter fills z < TOP.
const TOP: i32 = 18;
const H: f64 = 0.8;

/// A block of liver with its own texture, air above.
fn scan(spacing: DVec3) -> (Voxels, Materials) {
    let dimensions = UVec3::splat(SIDE as u32);
    let solid = |voxel: IVec3| voxel.z < TOP;
    let texture = |voxel: IVec3| {
        if solid(voxel) {
            40 + ((voxel.x * 7 + voxel.y * 3 + voxel.z) % 23) as i16
        } else {
            -1000
        }
    };
    let values: Vec<i16> = VoxelBox::of_dimensions(dimensions)
        .voxels()
        .map(texture)
        .collect();
    let grid = Grid::new(
        dimensions,
        spacing,
        DVec3::new(5.0, -3.0, 11.0),
        DMat3::IDENTITY,
    )
    .unwrap();
    let intensities = Intensities::new(dimensions, values, 1.0, 0.0).unwrap();
    let mut voxels = Voxels::new(grid, intensities).unwrap();
    let segment = voxels
        .add_segment(Segment::from_fn(dimensions, solid))
        .unwrap();
    let law = preset("liver").unwrap().law().unwrap();
    let matter = SegmentMatter {
        segment,
        law,
        treatments: Vec::new(),
    };
    (
        voxels,
        Materials {
            segments: vec![matter],
        },
    )
}

/// A ball over the middle of the block, its lowest point so deep below the surface [voxels].
fn ball(voxels: &Voxels, depth: f64) -> ToolState {
    let radius = 2.0 * H;
    let middle = f64::from(SIDE / 2) + 0.5;
    let height = f64::from(TOP) - depth + 2.0;
    let place = DVec3::new(middle, middle, height);
    ToolState {
        id: 7,
        shape: ToolShape::Ball(radius),
        position: voxels.grid().patient_from_grid().transform_point3(place),
        orientation: DQuat::IDENTITY,
    }
}

fn models() -> Vec<(&'static str, Box<dyn DeformationModel>)> {
    let small = LocalSettings {
        box_cells: 11,
        ..LocalSettings::default()
    };
    let resting = LocalSettings {
        motion: Motion::Rest,
        ..small
    };
    vec![
        ("fcc-lj", Box::new(LocalModel::fcc_lj(small))),
        ("fcc-lj at rest", Box::new(LocalModel::fcc_lj(resting))),
        ("cuboid-lj", Box::new(LocalModel::cuboid_lj(small))),
    ]
}

/// One call, its edit applied.
fn advance(
    model: &mut dyn DeformationModel,
    voxels: &mut Voxels,
    materials: &Materials,
    tools: &[ToolState],
    iterations: u32,
) -> ModelAnswer {
    let budget = Budget::iterations(iterations);
    let answer = model.advance(&ModelInput {
        voxels,
        materials,
        tools,
        dt: 0.03,
        budget,
    });
    if let Some(edit) = answer.edit.clone() {
        voxels.apply(edit).unwrap();
    }
    answer
}

fn force(answer: &ModelAnswer) -> DVec3 {
    answer.contacts[0]
        .contact
        .map_or(DVec3::ZERO, |contact| contact.force)
}

/// All voxels: stored value and whether solid.
fn picture(voxels: &Voxels) -> Vec<(i16, bool)> {
    let segment = voxels.segment(SegmentId(1)).unwrap();
    let bounds = voxels.grid().bounds();
    bounds
        .voxels()
        .map(|v| (voxels.stored(v).unwrap(), segment.contains(v)))
        .collect()
}

#[test]
fn the_models_stand_under_their_names() {
    for name in ["fcc-lj", "cuboid-lj"] {
        assert!(model_from_name(name).is_ok(), "{name}");
    }
}

#[test]
fn a_pressed_block_pushes_back_harder_the_deeper_the_tool() {
    for (name, mut model) in models() {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        let (mut last, mut told) = (0.0, 0.0);
        for step in 0..=6 {
            let tool = ball(&voxels, -0.1 + 0.1 * f64::from(step));
            let answer = advance(&mut *model, &mut voxels, &materials, &[tool], 200);
            let force = force(&answer);
            if step == 0 {
                // particles' shells end half a link above their centres, 0.1 voxel over the face
                assert!(force.length() < 1e-9, "{name}: touched in the air");
            }
            assert!(
                force.z >= last,
                "{name}: weaker at step {step}: {} {last}",
                force.z
            );
            // along the normal: the block is symmetric, the lattice not quite
            assert!(
                force.truncate().length() <= 0.1 * force.z + 1e-9,
                "{name}: {force}"
            );
            if step == 6 {
                // the stiffness that the servo is told, against the step that follows
                let ratio = (force.z - last) / (told * 0.1 * H);
                assert!(
                    ratio > 0.4 && ratio < 2.5,
                    "{name}: stiffness off by {ratio}"
                );
            }
            let contact = answer.contacts[0].contact;
            told = contact.map_or(0.0, |contact| -contact.stiffness.z_axis.z);
            last = force.z;
        }
        // Hertz for 5.5 kPa and nu 0.36, a ball of 1.6 mm 0.48 mm deep: 4/3 E* sqrt(R d³) =
        // 3.5 mN; particles are as large as the dent, so only the order of it
        println!("{name}: {:.2} mN half a voxel deep", last * 1e3);
        assert!(last > 1.5e-3 && last < 10e-3, "{name}: {last} N");
    }
}

#[test]
fn matter_that_nobody_touches_shows_no_displacement() {
    for (name, mut model) in models() {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        let tool = ball(&voxels, -0.5);
        let answer = advance(&mut *model, &mut voxels, &materials, &[tool], 300);
        assert!(
            answer.edit.is_none() && answer.displacement.is_none(),
            "{name}"
        );
        let tool = ball(&voxels, 0.5);
        let answer = advance(&mut *model, &mut voxels, &materials, &[tool], 300);
        let field = answer.displacement.unwrap();
        // a dent of half a voxel, shown as that before any voxel has changed
        let deepest = field.moved.iter().map(|moved| -moved.z).fold(0.0, f32::max);
        let deepest = f64::from(deepest) / H;
        assert!(deepest > 0.3 && deepest < 0.8, "{name}: {deepest} voxels");
    }
}

#[test]
fn what_was_pressed_comes_back_when_the_tool_leaves_to_the_bit() {
    for (name, mut model) in models() {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        let untouched = picture(&voxels);
        let mut changed = 0;
        for step in 0..=8 {
            let tool = ball(&voxels, 0.2 * f64::from(step));
            advance(&mut *model, &mut voxels, &materials, &[tool], 100);
            let differ = |(a, b): &(&(i16, bool), &(i16, bool))| a != b;
            changed = picture(&voxels)
                .iter()
                .zip(&untouched)
                .filter(differ)
                .count();
        }
        assert!(changed > 4, "{name}: pressing changed {changed} voxels");
        // voxels that matter left read air, and are in no segment
        let empty = picture(&voxels)
            .iter()
            .zip(&untouched)
            .filter(|(now, then)| then.1 && !now.1)
            .count();
        assert!(empty > 0, "{name}: nothing gave way");

        // the tool goes up, matter follows, then the tool leaves
        let away = ball(&voxels, -8.0);
        for _ in 0..3 {
            advance(&mut *model, &mut voxels, &materials, &[away], 100);
        }
        let left = picture(&voxels)
            .iter()
            .zip(&untouched)
            .filter(|(a, b)| a != b)
            .count();
        assert_eq!(left, 0, "{name}: {left} voxels did not come back");
    }
}

#[test]
fn the_scans_own_values_are_never_overwritten_and_undo_restores_all() {
    let (mut voxels, materials) = scan(DVec3::splat(H));
    let (untouched, own) = (picture(&voxels), voxels.intensities().values().clone());
    let mut model = LocalModel::fcc_lj(LocalSettings {
        box_cells: 11,
        ..Default::default()
    });
    let mut inverses = Vec::new();
    for step in 0..=8 {
        let tools = [ball(&voxels, 0.2 * f64::from(step))];
        let budget = Budget::iterations(60);
        let input = ModelInput {
            voxels: &voxels,
            materials: &materials,
            tools: &tools,
            dt: 0.03,
            budget,
        };
        if let Some(edit) = model.advance(&input).edit {
            inverses.push(voxels.apply(edit).unwrap());
        }
    }
    assert!(!inverses.is_empty());
    assert_eq!(voxels.intensities().values(), &own);
    while let Some(inverse) = inverses.pop() {
        voxels.apply(inverse).unwrap();
    }
    assert!(picture(&voxels) == untouched);
}

#[test]
fn the_same_calls_give_the_same_answers_to_the_bit() {
    for index in 0..models().len() {
        let run = || {
            let (mut voxels, materials) = scan(DVec3::splat(H));
            let mut model = models().swap_remove(index).1;
            let mut answers = Vec::new();
            for step in 0..=4 {
                let tool = ball(&voxels, 0.3 * f64::from(step));
                let answer = advance(&mut *model, &mut voxels, &materials, &[tool], 40);
                answers.push((answer.contacts, answer.displacement, answer.report));
            }
            (answers, picture(&voxels))
        };
        assert!(run() == run());
    }
}

#[test]
fn matter_that_a_drill_takes_away_does_not_come_back() {
    for (name, mut model) in models() {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        for step in 0..=5 {
            let tool = ball(&voxels, 0.2 * f64::from(step));
            advance(&mut *model, &mut voxels, &materials, &[tool], 60);
        }
        // a hole beside the tool, made by somebody else
        let hole = VoxelBox::new(IVec3::new(17, 13, TOP - 2), IVec3::new(19, 17, TOP));
        let empty = palpate_volume::matter::Matter {
            stored: -1000,
            segments: Default::default(),
        };
        let edit = voxels.matter_edit(&hole, |_, _| empty);
        voxels.apply(edit).unwrap();
        let away = ball(&voxels, -8.0);
        for _ in 0..3 {
            advance(&mut *model, &mut voxels, &materials, &[away], 100);
        }
        let segment = voxels.segment(SegmentId(1)).unwrap();
        let back = hole.voxels().filter(|v| segment.contains(*v)).count();
        assert!(
            back == 0,
            "{name}: {back} of 16 drilled voxels are solid again"
        );
        assert!(
            segment.contains(IVec3::new(15, 15, TOP - 1)),
            "{name}: matter under the tool is lost"
        );
    }
}

#[test]
fn rigid_parts_stay_where_they_are_and_empty_ones_are_not_there() {
    let press = |treatment: Treatment| {
        let (mut voxels, mut materials) = scan(DVec3::splat(H));
        materials.segments[0].treatments = vec![(Part::Whole, treatment)];
        let mut model = LocalModel::fcc_lj(LocalSettings {
            box_cells: 11,
            ..Default::default()
        });
        let tool = ball(&voxels, 1.0);
        let answer = advance(&mut model, &mut voxels, &materials, &[tool], 100);
        (
            force(&answer).z,
            answer.edit.is_some(),
            model.particle_count(),
        )
    };
    let (rigid, rigid_edit, _) = press(Treatment::Rigid);
    let (soft, _, _) = press(Treatment::Deformable);
    assert!(rigid > 3.0 * soft && !rigid_edit, "{rigid} {soft}");
    assert_eq!(press(Treatment::Empty), (0.0, false, 0));
}

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

#[test]
fn absurd_tools_and_settings_give_no_force_and_no_panic() {
    let absurd = [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e300];
    for (name, mut model) in models() {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        for value in absurd {
            let good = ball(&voxels, 1.0);
            let tools = [
                ToolState {
                    position: DVec3::splat(value),
                    ..good
                },
                ToolState {
                    shape: ToolShape::Ball(value),
                    ..good
                },
                ToolState {
                    shape: ToolShape::Ellipsoid(DVec3::new(1.0, value, 1.0)),
                    ..good
                },
                ToolState {
                    orientation: DQuat::from_xyzw(value, 0.0, 0.0, 0.0),
                    ..good
                },
            ];
            for tool in tools {
                let answer = advance(&mut *model, &mut voxels, &materials, &[tool], 20);
                assert_eq!(answer.contacts.len(), 1);
                assert!(force(&answer).is_finite(), "{name}: {tool:?}");
            }
        }
        // a tool deep inside matter at once
        let deep = ball(&voxels, 6.0);
        let answer = advance(&mut *model, &mut voxels, &materials, &[deep], 200);
        assert!(force(&answer).is_finite(), "{name}");
        let empty = advance(&mut *model, &mut voxels, &materials, &[], 20);
        assert!(empty.contacts.is_empty(), "{name}");
    }
    let mad = LocalSettings {
        box_cells: i32::MAX,
        border_cells: -4,
        motion: Motion::ScaledTime {
            step_share: f64::NAN,
            friction: Some(f64::NAN),
        },
        binding: f64::NAN,
        layers: 0,
        ..Default::default()
    };
    let model = LocalModel::fcc_lj(mad);
    assert_eq!(model.settings().box_cells, 41);
    assert_eq!(model.settings().layers, 1);
    let cuboid = LocalModel::cuboid_lj(LocalSettings {
        motion: Motion::Rest,
        ..Default::default()
    });
    assert!(
        matches!(cuboid.settings().motion, Motion::ScaledTime { .. }),
        "FIRE needs an energy"
    );
}

#[test]
fn binding_walls_and_layers_do_what_they_say() {
    let press = |settings: LocalSettings| {
        let (mut voxels, materials) = scan(DVec3::splat(H));
        let mut model = LocalModel::fcc_lj(LocalSettings {
            box_cells: 11,
            ..settings
        });
        let mut z = 0.0;
        for step in 0..=4 {
            let tool = ball(&voxels, 0.1 * f64::from(step));
            z = force(&advance(&mut model, &mut voxels, &materials, &[tool], 300)).z;
        }
        let highest = model
            .particles()
            .map(|(place, _)| place.z)
            .fold(0.0, f64::max);
        (z, highest)
    };
    let free = press(LocalSettings::default());
    let bound = press(LocalSettings {
        binding: 1.0,
        ..Default::default()
    });
    assert!(
        bound.0 > 1.2 * free.0,
        "springs to initial positions make it stiffer: {bound:?} {free:?}"
    );
    let walled = press(LocalSettings {
        walls: true,
        ..Default::default()
    });
    assert!(
        walled.1 <= H * f64::from(TOP),
        "bulged through a wall: {walled:?}"
    );
    let layered = press(LocalSettings {
        layers: 3,
        ..Default::default()
    });
    // the last layer is the whole box: the same rest, reached on another way
    assert!(
        (layered.0 / free.0 - 1.0).abs() < 0.05,
        "{layered:?} {free:?}"
    );
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

#[test]
fn laws_by_intensity_make_denser_bone_stiffer() {
    let press = |hounsfield: i16| {
        let dimensions = UVec3::splat(SIDE as u32);
        let bounds = VoxelBox::of_dimensions(dimensions);
        let values: Vec<i16> = bounds.voxels().map(|_| hounsfield).collect();
        let grid = Grid::new(dimensions, DVec3::splat(H), DVec3::ZERO, DMat3::IDENTITY).unwrap();
        let intensities = Intensities::new(dimensions, values, 1.0, 0.0).unwrap();
        let mut voxels = Voxels::new(grid, intensities).unwrap();
        let segment = Segment::from_fn(dimensions, |voxel| voxel.z < TOP);
        let segment = voxels.add_segment(segment).unwrap();
        let law: MaterialLaw = preset("thesis-bone").unwrap().law().unwrap();
        let materials = Materials {
            segments: vec![SegmentMatter {
                segment,
                law,
                treatments: Vec::new(),
            }],
        };
        let mut model = LocalModel::fcc_lj(LocalSettings {
            box_cells: 9,
            ..Default::default()
        });
        let tool = ball(&voxels, 0.05);
        force(&advance(&mut model, &mut voxels, &materials, &[tool], 400)).z
    };
    let (low, high) = (press(700), press(3000));
    // E goes from 5 to 21 GPa over the interval; all else is the same
    assert!((high / low - 4.2).abs() < 0.05, "{low} {high}");
}
