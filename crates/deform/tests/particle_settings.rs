//! What the thesis' local models are told: treatments, settings, laws, and absurd input.

use crate::liver::{H, SIDE, TOP, advance, ball, force, models, picture, scan};
use glam::{DMat3, DQuat, DVec3, UVec3};
use palpate_deform::material::{
    MaterialLaw, Materials, Region, SegmentMaterial, Treatment, preset,
};
use palpate_deform::model::{ToolShape, ToolState};
use palpate_deform::particles::calibration::{LatticeKind, LatticeScale};
use palpate_deform::particles::{LocalModel, LocalSettings, Motion};
use palpate_deform::registry::{Calibration, ModelOptions, model_from_name};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

#[test]
fn rigid_parts_stay_where_they_are_and_empty_ones_are_not_there() {
    let press = |treatment: Treatment| {
        let (mut voxels, mut materials) = scan(DVec3::splat(H));
        materials.segments[0].regions = vec![(Region::Whole, treatment)];
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
        // a tool deep inside tissue at once
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

/// Nothing but these layers, calibration and motion.
fn chosen(
    layers: Option<u32>,
    calibration: Option<Calibration>,
    motion: Option<Motion>,
) -> ModelOptions {
    ModelOptions {
        layers,
        calibration,
        motion,
        ..ModelOptions::default()
    }
}

#[test]
fn layers_calibrations_and_motions_are_refused_where_a_model_has_none() {
    let refused = |name: &str, options: &ModelOptions| {
        let model = model_from_name(name).unwrap().with(options);
        model.unwrap_err().to_string()
    };
    let layers = |count| chosen(Some(count), None, None);
    let waves = chosen(None, Some(Calibration::WaveSpeed), None);
    let resting = chosen(None, None, Some(Motion::Rest));
    for (name, option, options) in [
        ("lattice", "layers", layers(1)),
        ("global-lj", "layers", layers(2)),
        ("lattice", "calibration", waves),
        ("lattice", "motion", resting),
        ("global-lj", "motion", resting),
        // its law has no energy to be at rest in
        ("cuboid-lj", "motion", resting),
    ] {
        let none = "allowed: none, this model has no such option";
        assert_eq!(
            refused(name, &options),
            format!("{option} given for {name}; {none}")
        );
    }
    for count in [0, 9] {
        assert_eq!(
            refused("fcc-lj", &layers(count)),
            format!("layers of {count} given for fcc-lj; allowed: 1 to 8")
        );
    }
}

/// As in a session: so many iterations for an answer, and the tool stays for some answers.
#[test]
fn layers_calibrations_and_motions_of_a_session_do_what_they_say() {
    let press = |name: &str, options: ModelOptions| {
        let edge = model_from_name(name).unwrap().offers.boxes.map(|_| 11);
        let options = ModelOptions { edge, ..options };
        let mut model = model_from_name(name).unwrap().with(&options).unwrap();
        let (mut voxels, materials) = scan(DVec3::splat(H));
        let before = picture(&voxels);
        let mut answers = |depth: f64, count: u32| {
            let tool = ball(&voxels, depth);
            let answers =
                (0..count).map(|_| advance(&mut *model, &mut voxels, &materials, &[tool], 80));
            answers.last().map_or(0.0, |answer| force(&answer).z)
        };
        // deeper, the crystal slips, and each way to rest may end in another one
        for step in 0..6 {
            answers(0.1 * f64::from(step), 1);
        }
        let pressed = answers(0.6, 10);
        answers(-6.0, 40);
        assert!(picture(&voxels) == before, "{name}: {options:?}");
        pressed
    };
    let nothing = chosen(None, None, None);
    let usual = press("fcc-lj", nothing);
    // what is usual can be said, and is the same to the bit
    let said = chosen(Some(1), Some(Calibration::Young), Some(Motion::SCALED_TIME));
    assert_eq!(press("fcc-lj", said), usual);

    // the same rest, reached on other ways
    for options in [
        chosen(Some(3), None, None),
        chosen(None, None, Some(Motion::Rest)),
        chosen(Some(3), None, Some(Motion::Rest)),
    ] {
        let other = press("fcc-lj", options);
        assert!(other != usual, "{options:?}");
        // what is left of unbalanced force, a ten-thousandth of this at each of many particles
        assert!(
            (other / usual - 1.0).abs() < 0.002,
            "{options:?}: {other} {usual}"
        );
    }
    // all forces go with D: 2.36 times the usual for liver on FCC
    let liver = preset("liver").unwrap().law().unwrap().at(0.0);
    let waves = chosen(None, Some(Calibration::WaveSpeed), None);
    for (name, kind) in [
        ("fcc-lj", LatticeKind::Fcc),
        ("cuboid-lj", LatticeKind::Cuboid),
        ("global-lj", LatticeKind::Fcc),
    ] {
        let depth = |by| LatticeScale::new(kind, H).depth(&liver, by);
        let stiffer = depth(Calibration::WaveSpeed) / depth(Calibration::Young);
        let ratio = press(name, waves) / press(name, nothing);
        assert!(
            stiffer > 1.5 && (ratio / stiffer - 1.0).abs() < 1e-3,
            "{name}: {ratio} {stiffer}"
        );
    }
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
            segments: vec![SegmentMaterial {
                segment,
                law,
                regions: Vec::new(),
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
