//! The lattice as a model: voxels in, contacts and displacements out.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};
use palpate_deform::material::{
    MaterialLaw, Materials, Region, SegmentMaterial, SolidSi, Treatment,
};
use palpate_deform::model::{
    Budget, DeformationModel, ModelAnswer, ModelEvent, ModelInput, ToolShape, ToolState,
};
use palpate_deform::registry::{ModelOptions, model_from_name};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

const LIVER: SolidSi = SolidSi {
    young: 1e6,
    poisson: 0.3,
    density: 1060.0,
    fracture_energy: f64::INFINITY,
    friction: 0.2,
    stiffening: 0.0,
};

/// A block that fills the lower half of a grid of about 36 mm along each axis, and its number.
fn body(spacing: DVec3) -> (Voxels, SegmentId, f64) {
    let dimensions = (36.0 / spacing).round().as_uvec3();
    let grid = Grid::new(dimensions, spacing, 0.5 * spacing, DMat3::IDENTITY).expect("a grid");
    let values: Arc<[i16]> = vec![0; grid.voxel_count()].into();
    let intensities = Intensities::new(dimensions, values, 1.0, 0.0).expect("intensities");
    let mut voxels = Voxels::new(grid, intensities).expect("one grid");
    let top = dimensions.z as i32 / 2;
    let segment = Segment::from_fn(dimensions, |voxel| voxel.z < top);
    let id = voxels.add_segment(segment).expect("a free number");
    (voxels, id, f64::from(top) * spacing.z)
}

fn made_of(id: SegmentId, solid: SolidSi, regions: Vec<(Region, Treatment)>) -> Materials {
    let law = MaterialLaw::constant(solid).expect("matter");
    Materials {
        segments: vec![SegmentMaterial {
            segment: id,
            law,
            regions,
        }],
    }
}

fn ball(place: DVec3, radius: f64) -> ToolState {
    ToolState {
        id: 7,
        shape: ToolShape::Ball(radius),
        position: place,
        orientation: DQuat::IDENTITY,
    }
}

fn advance(
    model: &mut dyn DeformationModel,
    voxels: &Voxels,
    materials: &Materials,
    tool: ToolState,
) -> ModelAnswer {
    advance_by(400, model, (voxels, materials), tool)
}

fn advance_by(
    iterations: u32,
    model: &mut dyn DeformationModel,
    (voxels, materials): (&Voxels, &Materials),
    tool: ToolState,
) -> ModelAnswer {
    let budget = Budget::iterations(iterations);
    model.advance(&ModelInput {
        voxels,
        materials,
        tools: &[tool],
        dt: 0.03,
        budget,
    })
}

fn force(answer: &ModelAnswer) -> DVec3 {
    answer.contacts[0]
        .contact
        .map_or(DVec3::ZERO, |contact| contact.force)
}

#[test]
fn a_pressed_body_pushes_back_as_stiffly_as_its_contact_says() {
    let (voxels, id, top) = body(DVec3::ONE);
    let materials = made_of(id, LIVER, Vec::new());
    let mut model =
        (model_from_name("lattice").expect("a known name").make)(&ModelOptions::default());
    let at = |depth: f64| ball(DVec3::new(18.0, 18.0, top + 3.0 - depth), 3.0);
    assert_eq!(
        force(&advance(&mut *model, &voxels, &materials, at(-1.0))),
        DVec3::ZERO
    );
    let answers = [0.8, 0.85].map(|depth| advance(&mut *model, &voxels, &materials, at(depth)));
    let [less, more] = answers.each_ref().map(force);
    assert!(
        less.z > 0.0 && more.z > less.z && more.x.abs() < 0.1 * more.z,
        "{less} {more}"
    );

    let stiffness = answers[0].contacts[0].contact.expect("contact").stiffness;
    let seen = -(more.z - less.z) / 0.05;
    let ratio = stiffness.z_axis.z / seen;
    assert!(
        (0.9..1.1).contains(&ratio),
        "told {} seen {seen}",
        stiffness.z_axis.z
    );
    let field = answers[1].displacement.as_ref().expect("a field");
    let deepest = field.moved.iter().map(|moved| moved.z).fold(0.0, f32::min);
    assert!(
        (-0.95..-0.3).contains(&deepest),
        "what voxels do not show of the dent: {deepest}"
    );
}

#[test]
fn flat_voxels_carry_the_same_force_as_cubes() {
    let press = |spacing: DVec3| {
        let (voxels, id, top) = body(spacing);
        let materials = made_of(id, LIVER, Vec::new());
        let settings = palpate_deform::lattice::LatticeSettings {
            spacing: Some(1.0),
            ..Default::default()
        };
        let mut model = palpate_deform::lattice::LatticeModel::new(settings);
        force(&advance(
            &mut model,
            &voxels,
            &materials,
            ball(DVec3::new(18.0, 18.0, top + 2.0), 3.0),
        ))
        .z
    };
    let (cubes, flat) = (press(DVec3::ONE), press(DVec3::new(0.6, 0.6, 3.0)));
    // the body is the same, and nodes stand in the same tissue but for rounding at the surface
    assert!((flat / cubes - 1.0).abs() < 0.02, "{cubes} {flat}");
}

#[test]
fn a_box_that_follows_a_sliding_tool_makes_no_step_in_the_force() {
    let (voxels, id, top) = body(DVec3::ONE);
    let materials = made_of(id, LIVER, Vec::new());
    let mut model =
        (model_from_name("lattice").expect("a known name").make)(&ModelOptions::default());
    let mut forces = Vec::new();
    for step in 0..90 {
        let aside = 0.1 * f64::from(step);
        let place = DVec3::new(14.0 + aside, 18.0, top + 2.0);
        forces.push(force(&advance(&mut *model, &voxels, &materials, ball(place, 3.0))).z);
    }
    let peak = forces.iter().copied().fold(0.0, f64::max);
    for pair in forces.windows(2) {
        assert!((pair[1] - pair[0]).abs() < 0.1 * peak, "{pair:?} of {peak}");
    }
}

#[test]
fn parts_can_be_rigid_or_as_if_they_were_not_there() {
    let (voxels, id, top) = body(DVec3::ONE);
    let press = |treatment| {
        let materials = made_of(id, LIVER, vec![(Region::Whole, treatment)]);
        let mut model =
            (model_from_name("lattice").expect("a known name").make)(&ModelOptions::default());
        let place = DVec3::new(18.0, 18.0, top + 2.7);
        force(&advance(&mut *model, &voxels, &materials, ball(place, 3.0))).z
    };
    let (gives, rigid) = (press(Treatment::Deformable), press(Treatment::Rigid));
    assert!(gives > 0.0 && rigid > 2.0 * gives, "{gives} {rigid}");
    assert_eq!(press(Treatment::Empty), 0.0);
}

#[test]
fn what_breaks_is_told_as_an_event_and_counted() {
    let (voxels, id, top) = body(DVec3::ONE);
    let materials = made_of(
        id,
        SolidSi {
            // breaks at a strain of 0.1 on 1 mm
            fracture_energy: 17.3,
            ..LIVER
        },
        Vec::new(),
    );
    let mut model =
        (model_from_name("lattice").expect("a known name").make)(&ModelOptions::default());
    let mut told = 0;
    let mut last = ModelAnswer::default();
    for step in 0..30 {
        let place = DVec3::new(18.0, 18.0, top + 2.0 - 0.1 * f64::from(step));
        last = advance(&mut *model, &voxels, &materials, ball(place, 2.0));
        for event in &last.events {
            if let ModelEvent::BondsBroken { count, work, .. } = event {
                assert!(*work > 0.0);
                told += u64::from(*count);
            }
        }
    }
    assert!(
        told > 0 && told == last.report.bonds_broken,
        "{:?}",
        last.report
    );
}

#[test]
fn tools_that_are_none_feel_nothing_and_harm_nothing() {
    let (voxels, id, top) = body(DVec3::ONE);
    let materials = made_of(id, LIVER, Vec::new());
    let mut model =
        (model_from_name("lattice").expect("a known name").make)(&ModelOptions::default());
    let good = ball(DVec3::new(18.0, 18.0, top + 2.5), 3.0);
    let before = force(&advance(&mut *model, &voxels, &materials, good));
    let absurd = [
        ball(DVec3::NAN, 3.0),
        ball(DVec3::splat(f64::INFINITY), 3.0),
        ball(good.position, f64::NAN),
        ball(good.position, -1.0),
        ball(good.position, 1e9),
        ToolState {
            orientation: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0),
            ..good
        },
    ];
    for tool in absurd {
        assert_eq!(
            force(&advance(&mut *model, &voxels, &materials, tool)),
            DVec3::ZERO
        );
    }
    let after = force(&advance(&mut *model, &voxels, &materials, good));
    // both are at rest to a thousandth
    assert!(
        (before - after).length() < 0.01 * before.length(),
        "{before} {after}"
    );
}

#[test]
fn particles_tell_once_that_poissons_ratio_is_their_lattices() {
    let (voxels, id, top) = body(DVec3::ONE);
    let told = |name: &str, poisson: f64| -> Vec<ModelEvent> {
        let materials = made_of(id, SolidSi { poisson, ..LIVER }, Vec::new());
        let known = model_from_name(name).expect("a known name");
        let mut model = (known.make)(&ModelOptions::default());
        let tool = ball(DVec3::new(18.0, 18.0, top + 2.5), 3.0);
        let mut events = Vec::new();
        for _ in 0..2 {
            events.extend(advance_by(2, &mut *model, (&voxels, &materials), tool).events);
            model.reset();
        }
        events.retain(|event| matches!(event, ModelEvent::PoissonClamped { .. }));
        events
    };
    for (name, own) in [("fcc-lj", 0.358), ("global-lj", 0.358), ("cuboid-lj", 0.0)] {
        let [ModelEvent::PoissonClamped { asked, used }] = told(name, 0.45)[..] else {
            panic!("{name}: {:?}", told(name, 0.45));
        };
        assert_eq!(asked, 0.45);
        assert!((used - own).abs() < 0.01, "{name}: {used}");
        assert_eq!(told(name, used), [], "{name} as it is");
    }
}

#[test]
fn an_ellipsoid_is_pushed_up_harder_where_it_is_flatter() {
    let (voxels, id, top) = body(DVec3::ONE);
    let materials = made_of(id, LIVER, Vec::new());
    let known = model_from_name("lattice").expect("a known name");
    let pushed = |shape: ToolShape, orientation: DQuat, height: f64| {
        let tool = ToolState {
            shape,
            orientation,
            ..ball(DVec3::new(18.0, 18.0, top + height - 1.0), 1.0)
        };
        let mut model = (known.make)(&ModelOptions::default());
        force(&advance(&mut *model, &voxels, &materials, tool))
    };
    let long = ToolShape::Ellipsoid(DVec3::new(5.0, 2.5, 2.5));
    let upright = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2);
    let (round, as_ball) = (
        pushed(
            ToolShape::Ellipsoid(DVec3::splat(2.5)),
            DQuat::IDENTITY,
            2.5,
        ),
        pushed(ToolShape::Ball(2.5), DQuat::IDENTITY, 2.5),
    );
    assert_eq!(round, as_ball, "an ellipsoid with equal axes is a ball");
    let flat = pushed(long, DQuat::IDENTITY, 2.5);
    let turned = pushed(long, DQuat::from_rotation_z(0.5), 2.5);
    let on_end = pushed(long, upright, 5.0);
    println!("ball {as_ball:.4}, flat {flat:.4}, turned {turned:.4}, upright {on_end:.4} N");
    for force in [flat, turned, on_end] {
        assert!(
            force.z > 0.0 && force.truncate().length() < 0.1 * force.z,
            "{force}"
        );
    }
    // Hertz: at one depth the force goes with the root of the radius of curvature below, which is
    // 2.5 mm for the ball, √(10 · 2.5) mm flat (or so), 1.25 mm upright
    let by_ball = |force: DVec3| force.z / as_ball.z;
    assert!((1.2..1.8).contains(&by_ball(flat)), "{}", by_ball(flat));
    assert!((by_ball(turned) / by_ball(flat) - 1.0).abs() < 0.1);
    assert!((0.4..0.8).contains(&by_ball(on_end)), "{}", by_ball(on_end));
}

#[test]
fn ratios_beyond_the_lattice_are_told_once_and_unknown_names_list_the_known() {
    let (voxels, id, top) = body(DVec3::ONE);
    let materials = made_of(
        id,
        SolidSi {
            poisson: 0.495,
            ..LIVER
        },
        Vec::new(),
    );
    let mut model =
        (model_from_name("lattice").expect("a known name").make)(&ModelOptions::default());
    let tool = ball(DVec3::new(18.0, 18.0, top + 2.5), 3.0);
    let clamped = ModelEvent::PoissonClamped {
        asked: 0.495,
        used: 0.49,
    };
    assert_eq!(
        advance(&mut *model, &voxels, &materials, tool).events,
        [clamped]
    );
    assert_eq!(advance(&mut *model, &voxels, &materials, tool).events, []);
    let error = model_from_name("jelly")
        .expect_err("no such model")
        .to_string();
    assert!(
        error.contains("jelly") && error.contains("lattice"),
        "{error}"
    );
}
