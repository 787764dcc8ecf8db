//! The thesis' global prototype: coarse particles through a whole segment.

use glam::{DMat3, DQuat, DVec3, UVec3};
use palpate_deform::material::{Materials, SegmentMaterial, preset};
use palpate_deform::model::{
    Budget, DeformationModel, ModelAnswer, ModelInput, ToolShape, ToolState,
};
use palpate_deform::particles::{GlobalModel, GlobalSettings};
use palpate_deform::registry::model_from_name;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

const H: f64 = 1.0;
const TOP: i32 = 24;

/// A block of liver with air around, its middle at (20, 20) voxels.
fn scan() -> (Voxels, Materials) {
    block(UVec3::splat(40))
}

fn block(dimensions: UVec3) -> (Voxels, Materials) {
    let grid = Grid::new(
        dimensions,
        DVec3::splat(H),
        DVec3::splat(0.5),
        DMat3::IDENTITY,
    );
    let values = (0..dimensions.element_product()).map(|i| (i % 37) as i16);
    let intensities = Intensities::new(dimensions, values.collect::<Vec<i16>>(), 1.0, 0.0)
        .expect("one value per voxel");
    let mut voxels = Voxels::new(grid.expect("a grid"), intensities).expect("the same grid");
    let end = dimensions.as_ivec3() - 6;
    let solid = |v: glam::IVec3| v.min_element() >= 6 && v.x < end.x && v.y < end.y && v.z < TOP;
    let segment = voxels
        .add_segment(Segment::from_fn(dimensions, solid))
        .expect("its grid");
    let law = preset("liver")
        .and_then(|preset| preset.law())
        .expect("liver is a preset");
    (
        voxels,
        Materials {
            segments: vec![SegmentMaterial {
                segment,
                law,
                regions: Vec::new(),
            }],
        },
    )
}

fn ball(depth: f64) -> ToolState {
    ToolState {
        id: 1,
        shape: ToolShape::Ball(6.0 * H),
        position: DVec3::new(20.0, 20.0, f64::from(TOP) + 6.0 - depth) * H,
        orientation: DQuat::IDENTITY,
    }
}

fn advance(
    model: &mut GlobalModel,
    voxels: &mut Voxels,
    materials: &Materials,
    tool: ToolState,
    iterations: u32,
) -> ModelAnswer {
    let budget = Budget::iterations(iterations);
    let tools = [tool];
    let answer = model.advance(&ModelInput {
        voxels,
        materials,
        tools: &tools,
        dt: 0.03,
        budget,
    });
    if let Some(edit) = answer.edit.clone() {
        voxels.apply(edit).expect("an edit of these voxels");
    }
    answer
}

fn picture(voxels: &Voxels) -> Vec<(Option<i16>, bool)> {
    let segment = voxels.segment(SegmentId(1)).expect("there is one segment");
    let bounds = voxels.grid().bounds();
    bounds
        .voxels()
        .map(|v| (voxels.stored(v), segment.contains(v)))
        .collect()
}

fn force(answer: &ModelAnswer) -> DVec3 {
    answer.contacts[0]
        .contact
        .map_or(DVec3::ZERO, |contact| contact.force)
}

#[test]
fn pressing_moves_voxels_far_from_the_tool_and_leaves_no_holes() {
    let (mut voxels, materials) = scan();
    let untouched = picture(&voxels);
    let mut model = GlobalModel::global_lj(GlobalSettings {
        max_particles: 1000,
        ..Default::default()
    });
    let mut pushed = DVec3::ZERO;
    for step in 0..=8 {
        pushed = force(&advance(
            &mut model,
            &mut voxels,
            &materials,
            ball(0.25 * f64::from(step)),
            200,
        ));
    }
    assert!(
        model.particles().count() > 300,
        "{}",
        model.particles().count()
    );
    assert!(pushed.z > 0.0, "{pushed}");
    let pressed = picture(&voxels);
    let emptied = pressed
        .iter()
        .zip(&untouched)
        .filter(|(now, then)| then.1 && !now.1)
        .count();
    assert!(emptied > 20, "{emptied} voxels gave way");
    // no hole: what is empty below the old surface is open to the air above
    let segment = voxels.segment(SegmentId(1)).expect("there is one segment");
    let column = |x: i32, y: i32| (8..TOP).map(move |z| glam::IVec3::new(x, y, z));
    for x in 12..28 {
        for y in 12..28 {
            let solid: Vec<bool> = column(x, y).map(|v| segment.contains(v)).collect();
            let changes = solid.windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert!(changes <= 1, "a hole in column {x} {y}");
        }
    }

    // the tool leaves, springs and links bring all back
    for _ in 0..20 {
        advance(&mut model, &mut voxels, &materials, ball(-20.0), 300);
    }
    let left = picture(&voxels)
        .iter()
        .zip(&untouched)
        .filter(|(a, b)| a != b)
        .count();
    assert_eq!(left, 0, "{left} voxels did not come back");
}

#[test]
fn the_same_calls_give_the_same_answers_and_absurd_tools_no_force() {
    assert!(model_from_name("global-lj").is_ok());
    let run = || {
        let (mut voxels, materials) = scan();
        let settings = GlobalSettings {
            max_particles: 400,
            ..Default::default()
        };
        let mut model = GlobalModel::global_lj(settings);
        let mut told = Vec::new();
        for tool in [
            ball(1.0),
            ToolState {
                position: DVec3::NAN,
                ..ball(1.0)
            },
            ToolState {
                shape: ToolShape::Ball(f64::INFINITY),
                ..ball(1.0)
            },
            ball(20.0),
            ball(2.0),
        ] {
            let answer = advance(&mut model, &mut voxels, &materials, tool, 40);
            assert!(force(&answer).is_finite());
            told.push((answer.contacts, answer.report));
        }
        assert!(told[1].0[0].contact.is_none() && told[2].0[0].contact.is_none());
        (told, picture(&voxels))
    };
    assert!(run() == run());
}

#[test]
fn a_scan_without_matter_gives_nothing() {
    let (mut voxels, _) = scan();
    let mut model = GlobalModel::global_lj(GlobalSettings::default());
    let answer = advance(
        &mut model,
        &mut voxels,
        &Materials::default(),
        ball(1.0),
        10,
    );
    assert!(answer.edit.is_none() && answer.contacts[0].contact.is_none());
}

#[test]
fn a_reset_gives_back_all_that_was_moved_before_anything_else() {
    let (mut voxels, materials) = scan();
    let untouched = picture(&voxels);
    let mut model = GlobalModel::global_lj(GlobalSettings {
        max_particles: 1000,
        ..Default::default()
    });
    let mut moved = 0;
    for step in 0..=8 {
        let tool = ball(0.25 * f64::from(step));
        let answer = advance(&mut model, &mut voxels, &materials, tool, 200);
        moved = answer.report.moved_voxels;
    }
    assert!(moved > 20 && picture(&voxels) != untouched, "{moved}");
    model.reset();
    while moved > 0 {
        let answer = advance(&mut model, &mut voxels, &materials, ball(2.0), 200);
        assert!(answer.report.moved_voxels < moved || answer.edit.is_some());
        moved = answer.report.moved_voxels;
    }
    assert!(picture(&voxels) == untouched);
}

#[test]
fn of_a_large_body_voxels_follow_near_the_first_tool_alone() {
    let (mut voxels, materials) = block(UVec3::new(300, 40, 40));
    let untouched = picture(&voxels);
    let mut model = GlobalModel::global_lj(GlobalSettings::default());
    let pressing = |id, x: f64| ToolState {
        id,
        position: DVec3::new(x, 20.0, f64::from(TOP) + 3.0),
        ..ball(0.0)
    };
    let answer = model.advance(&ModelInput {
        voxels: &voxels,
        materials: &materials,
        tools: &[pressing(1, 40.0), pressing(2, 260.0)],
        dt: 0.03,
        budget: Budget::iterations(400),
    });
    let felt = |which: usize| answer.contacts[which].contact.expect("pressed").force.z;
    assert!(felt(0) > 0.0 && felt(1) > 0.0);
    let field = answer.displacement.expect("a dent");
    let end = field.origin.x + field.spacing * f64::from(field.size.x - 1);
    assert!(field.origin.x < 40.0 && end < 90.0, "to {end} mm");
    let edit = answer.edit.expect("a dent");
    voxels.apply(edit).expect("an edit of these voxels");
    let now = picture(&voxels);
    let differs = |place: &usize| now[*place] != untouched[*place];
    let changed: Vec<_> = (0..now.len()).filter(differs).collect();
    assert!(changed.len() > 20 && changed.iter().all(|place| place % 300 < 90));
}

#[test]
fn a_tip_finer_than_the_particles_are_apart_is_felt_anywhere() {
    for aside in [0.0, 0.7, 1.4, 2.1] {
        let (mut voxels, materials) = scan();
        let mut model = GlobalModel::global_lj(GlobalSettings {
            max_particles: 400,
            ..Default::default()
        });
        let mut most = 0.0_f64;
        for step in 0..=12 {
            let depth = 0.5 * f64::from(step);
            let tip = ToolState {
                shape: ToolShape::Ball(0.2),
                position: DVec3::new(20.0 + aside, 20.0 - 0.5 * aside, f64::from(TOP) - depth),
                ..ball(0.0)
            };
            let answer = advance(&mut model, &mut voxels, &materials, tip, 100);
            most = most.max(force(&answer).z);
        }
        assert!(most > 0.0, "{aside} mm aside");
    }
}

/// Thin walls never come to rest by themselves; without a tool they must stay, all the same.
#[test]
fn matter_that_nobody_touches_stays_where_it_is() {
    let size = UVec3::splat(48);
    let (voxels, mut materials) = block(size);
    let grid = *voxels.grid();
    let mut voxels = Voxels::new(grid, voxels.intensities().clone()).expect("the same grid");
    let shell = |v: glam::IVec3| {
        let far = (v.as_dvec3() + 0.5).distance(DVec3::splat(24.0));
        (14.0..18.0).contains(&far)
    };
    let segment = voxels.add_segment(Segment::from_fn(size, shell));
    materials.segments[0].segment = segment.expect("its grid");
    let mut model = GlobalModel::global_lj(GlobalSettings::default());
    let away = ToolState {
        position: DVec3::new(24.0, 24.0, 47.0),
        shape: ToolShape::Ball(2.0),
        ..ball(0.0)
    };
    for _ in 0..5 {
        let answer = advance(&mut model, &mut voxels, &materials, away, 80);
        assert_eq!(answer.report.moved_voxels, 0);
        assert_eq!(force(&answer), DVec3::ZERO);
    }
    let farthest = model.particles().map(|(_, moved)| moved.length());
    let farthest = farthest.fold(0.0, f64::max);
    assert!(
        model.particles().count() > 1000 && farthest < 1e-6,
        "{farthest} mm"
    );
    // pressed, it moves there alone
    let pressed = ToolState {
        position: DVec3::new(24.0, 24.0, 42.0),
        ..away
    };
    let pushed = advance(&mut model, &mut voxels, &materials, pressed, 80);
    assert!(force(&pushed).z > 0.0);
    let far = model.particles().filter(|(place, _)| place.z < 20.0);
    let far = far.map(|(_, moved)| moved.length()).fold(0.0, f64::max);
    assert!(far < 0.1, "{far} mm");
}
