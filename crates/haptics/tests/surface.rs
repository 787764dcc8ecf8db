//! Surfaces mix by squared direction cosines and blend by the way of the hand.

use crate::support::{Body, Random};
use glam::{DAffine3, DVec3, IVec3};
use palpate_haptics::force::{
    Feel, Friction, Holders, MAX_STIFFNESS, Surface, SurfaceBlend, SurfaceError, Surfaces, Uniform,
};
use palpate_haptics::scene::{Object, ObjectPose, Solid, TouchScene};
use palpate_volume::voxel_box::VoxelBox;

const BONE: Surface = Surface {
    stiffness: 2.0,
    friction_static: 0.4,
    friction_kinetic: 0.2,
};
const LIVER: Surface = Surface {
    stiffness: 0.2,
    friction_static: 0.8,
    friction_kinetic: 0.6,
};

/// Bone below z = 0 in the world; every other body is liver.
struct Abdomen;
impl Surfaces for Abdomen {
    fn surface_of(&self, solid: Solid) -> Surface {
        if solid.body == 0 && solid.voxel.z < 0 {
            BONE
        } else {
            LIVER
        }
    }
}

fn solid(body: u8, z: i32) -> Solid {
    Solid {
        body,
        voxel: IVec3::new(0, 0, z),
    }
}

fn feel(surface: &Surface) -> Feel {
    Feel {
        stiffness: surface.stiffness,
        friction: surface.friction(),
    }
}

#[test]
fn a_single_holder_is_felt_as_it_is_whatever_its_weight() {
    for weight in [1.0, 0.3, 1e-9] {
        let mut holders = Holders::default();
        holders.add(solid(0, -1), weight);
        assert_eq!(holders.mixed(&Abdomen), Some(feel(&BONE)));
    }
    assert_eq!(Holders::default().mixed(&Abdomen), None);
    assert!(Holders::default().is_empty());
}

/// In a corner of bone (floor) and liver (wall) each gives its part of the force.
#[test]
fn in_a_corner_the_stiffness_along_the_force_is_that_of_two_springs() {
    let corner = Body(|v: IVec3| v.z < 0 || v.x < 0);
    let point = DVec3::new(1e-8, 0.5, 1e-8);
    for angle in [0.2, 0.7, 1.3_f64] {
        let pull = DVec3::new(-angle.cos(), 0.0, -angle.sin()) * 3.0;
        let mut holders = Holders::default();
        holders.add_faces(0, &corner, point, pull);
        assert_eq!(holders.solids().count(), 2);
        let mixed = holders.mixed(&Abdomen).expect("a contact");

        // two springs along the faces' normals, stretched by the pull
        let force = DVec3::new(LIVER.stiffness * pull.x, 0.0, BONE.stiffness * pull.z);
        let along = force.dot(pull.normalize()) / pull.length();
        // rounding of a few products
        assert!((mixed.stiffness - along).abs() < 1e-12);
        let bone = angle.sin().powi(2);
        let stick = bone * 0.4 + (1.0 - bone) * 0.8;
        assert!((mixed.friction.stick - stick).abs() < 1e-12);
        assert!(mixed.friction.check().is_ok());
    }
}

#[test]
fn faces_that_the_probe_does_not_stand_on_or_is_not_pulled_to_do_not_count() {
    let room = Body(|v: IVec3| v.min_element() < 0 || v.max_element() > 0);
    let held = |point: DVec3, pull: DVec3| {
        let mut holders = Holders::default();
        holders.add_faces(0, &room, point, pull);
        holders
            .solids()
            .map(|(solid, _)| solid.voxel)
            .collect::<Vec<_>>()
    };
    let corner = DVec3::new(1e-8, 0.5, 1.0 - 1e-8);
    assert_eq!(held(corner, DVec3::NEG_X), [IVec3::NEG_X]);
    assert_eq!(held(corner, DVec3::Z), [IVec3::Z]);
    assert_eq!(held(corner, DVec3::X), []);
    assert_eq!(held(corner, DVec3::Y), []);
    assert_eq!(held(corner, DVec3::ZERO), []);
    assert_eq!(held(DVec3::splat(f64::NAN), DVec3::X), []);
    assert_eq!(held(corner, DVec3::new(f64::NAN, f64::NAN, 1.0)), []);
    assert_eq!(held(DVec3::splat(1e300), DVec3::ONE), []);
}

#[test]
fn a_contact_is_held_by_the_faces_it_stands_on_and_by_the_object_that_stopped_it() {
    let floor = Body(|v: IVec3| v.z < 0);
    let grid = crate::support::grid(glam::UVec3::splat(8), DVec3::ONE);
    let scene = TouchScene::of_world(&floor, &grid);
    let [on_floor, above] = [1e-8, 0.4].map(|z| DVec3::new(0.5, 0.5, z));
    let target = DVec3::new(1.5, 0.5, 1e-8 - 1.0);
    let held = |point, stopped_by| {
        let holders = Holders::of_contact(&scene, point, target, stopped_by);
        holders
            .solids()
            .map(|(solid, weight)| (solid.body, weight))
            .collect::<Vec<_>>()
    };
    // pulled at 45°: the floor bears half of the square, the object beside it the rest
    assert_eq!(held(on_floor, Some(solid(0, -1))), [(0, 0.5)]);
    assert_eq!(held(on_floor, Some(solid(2, 5))), [(0, 0.5), (2, 0.5)]);
    assert_eq!(held(above, Some(solid(2, 5))), [(2, 1.0)]);
    // an edge, where no face is stood on
    assert_eq!(held(above, Some(solid(0, 5))), [(0, 1.0)]);
    assert_eq!(held(above, None), []);
}

/// A floor of four voxels.
fn is_floor(voxel: IVec3) -> bool {
    voxel.abs().max_element() <= 8 && (-4..0).contains(&voxel.z)
}

#[test]
fn two_objects_that_hold_the_probe_between_them_are_felt_by_equal_shares() {
    let nothing: fn(IVec3) -> bool = |_| false;
    let floor: fn(IVec3) -> bool = is_floor;
    let grid = crate::support::grid(glam::UVec3::splat(8), DVec3::ONE);
    let corner = grid.patient_from_grid().transform_point3(DVec3::ZERO);
    // turned by 45° to either side, they are a valley along x
    let objects = [1.0, -1.0].map(|side: f64| {
        let turn = DAffine3::from_rotation_x(side * std::f64::consts::FRAC_PI_4);
        let about = DAffine3::from_translation(corner);
        let pose = ObjectPose::new(&grid, &grid, about * turn * about.inverse());
        let bounds = VoxelBox::new(IVec3::splat(-8), IVec3::splat(9));
        Object::new(Body(floor), &grid, bounds, pose.expect("a rotation"))
    });
    let scene = TouchScene {
        occupancy: &Body(nothing),
        grid: &grid,
        objects: &objects,
    };
    let point = DVec3::new(0.5, 0.0, 1e-7);
    let weights = |stopped_by| {
        let target = point - DVec3::Z;
        let holders = Holders::of_contact(&scene, point, target, stopped_by);
        holders.solids().fold([0.0; 3], |mut sum, (solid, weight)| {
            sum[usize::from(solid.body)] += weight;
            sum
        })
    };
    // whichever was met last
    for last in [solid(1, -1), solid(2, -1)] {
        let [of_world, first, second] = weights(Some(last));
        assert!(of_world == 0.0 && (first - 0.5).abs() < 1e-9 && (second - 0.5).abs() < 1e-9);
    }
}

#[test]
fn of_more_than_three_holders_the_weightiest_stay() {
    let mut holders = Holders::default();
    for (number, weight) in [0.1, 0.5, 0.2, f64::NAN, 0.4, -1.0, 0.3]
        .into_iter()
        .enumerate()
    {
        holders.add(solid(number as u8, 0), weight);
    }
    let mut bodies: Vec<u8> = holders.solids().map(|(solid, _)| solid.body).collect();
    bodies.sort_unstable();
    assert_eq!(bodies, [1, 4, 6]);
}

#[test]
fn a_border_is_crossed_in_one_voxel_length_of_way() {
    let h = 0.7;
    let mut blend = SurfaceBlend::default();
    assert_eq!(
        blend.follow(Some(feel(&LIVER)), 0.0, 0.1, h),
        Some(feel(&LIVER))
    );
    let mut way = 0.0;
    let mut last = LIVER.stiffness;
    while blend.feel() != Some(feel(&BONE)) {
        way += 0.05;
        let now = blend
            .follow(Some(feel(&BONE)), 0.05, 0.1, h)
            .expect("contact");
        assert!(now.stiffness > last || now.stiffness == BONE.stiffness);
        last = now.stiffness;
        assert!(way < 2.0, "never");
    }
    // one step of 0.05 mm
    assert!((h - 0.1..=h + 0.05).contains(&way), "{way}");
}

#[test]
fn a_hand_at_rest_feels_the_same_to_the_bit_whatever_is_beneath_it() {
    let mut blend = SurfaceBlend::default();
    blend.follow(Some(feel(&LIVER)), 0.3, 1.0, 1.0);
    blend.follow(Some(feel(&BONE)), 0.3, 1.0, 1.0);
    let held = blend;
    for wanted in [&BONE, &LIVER, &BONE] {
        for way in [0.0, -1.0, f64::NAN] {
            blend.follow(Some(feel(wanted)), way, 1.0, 1.0);
            assert_eq!(blend, held);
        }
    }
}

#[test]
fn a_surface_that_is_set_anew_comes_to_a_hand_at_rest_within_a_quarter_second_and_stays() {
    let mut blend = SurfaceBlend::default();
    blend.follow(Some(feel(&LIVER)), 0.3, 1.0, 1.0);
    blend.note_new_settings();
    let mut last = LIVER.stiffness;
    for tick in 1..=256 {
        let now = blend
            .follow(Some(feel(&BONE)), 0.0, 1.0, 1.0)
            .expect("contact");
        // a step of the 256, and rounding of their sum
        assert!(
            now.stiffness - last <= BONE.stiffness / 256.0 + 1e-12,
            "{tick}"
        );
        last = now.stiffness;
    }
    assert_eq!(blend.feel(), Some(feel(&BONE)));

    // once there, crossing to another segment is by the way again
    blend.follow(Some(feel(&LIVER)), 0.0, 1.0, 1.0);
    assert_eq!(blend.feel(), Some(feel(&BONE)));
}

#[test]
fn without_contact_all_is_forgotten_and_a_new_one_begins_as_it_is() {
    let mut blend = SurfaceBlend::default();
    blend.follow(Some(feel(&BONE)), 0.1, 0.0, 1.0);
    assert_eq!(blend.follow(None, 0.1, 0.0, 1.0), None);
    assert_eq!(
        blend.follow(Some(feel(&LIVER)), 0.0, 0.0, 1.0),
        Some(feel(&LIVER))
    );
}

/// With the way, the spring itself and the blend together stay below what touch promises.
#[test]
fn the_force_steps_no_further_than_by_four_thirds_of_the_way() {
    let h = 1.0;
    let mut random = Random::new(21);
    let mut blend = SurfaceBlend::default();
    let mut depth = 1.0_f64;
    blend.follow(Some(feel(&BONE)), 0.0, depth, h);
    let mut force = BONE.stiffness * depth;
    for _ in 0..200_000 {
        let way = random.between(0.0, 0.3);
        let pressed = random.between(-way, way);
        depth = (depth + pressed).clamp(0.0, 8.0);
        let wanted = if random.below(20) < 10 { BONE } else { LIVER };
        let now = blend
            .follow(Some(feel(&wanted)), way, depth, h)
            .expect("contact");
        let next = now.stiffness * depth;
        let bound = BONE.stiffness * way * 4.0 / 3.0;
        // rounding of forces of some 10 N
        assert!(
            (next - force).abs() <= bound + 1e-12,
            "{next} {force} {bound}"
        );
        force = next;
    }
}

#[test]
fn figures_that_are_none_are_refused_by_name() {
    assert_eq!(BONE.check(), Ok(()));
    assert_eq!(LIVER.check(), Ok(()));
    assert_eq!(Uniform(BONE).surface_of(solid(3, 9)), BONE);
    for bad in [f64::NAN, -1.0, MAX_STIFFNESS * 1.01, f64::INFINITY] {
        let surface = Surface {
            stiffness: bad,
            ..BONE
        };
        assert!(matches!(surface.check(), Err(SurfaceError::Stiffness(_))));
    }
    for bad in [f64::NAN, 0.5] {
        let surface = Surface {
            friction_kinetic: bad,
            ..BONE
        };
        assert!(matches!(surface.check(), Err(SurfaceError::Friction(_))));
    }
    assert_eq!(Friction::NONE.check(), Ok(()));
}
