//! Objects that move past, push and pinch the probe, and motions cut into steps.

use crate::support::{Body, Components, Random, SPACINGS, grid, noise, rotation};
use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::admission::{PoseMotion, PoseStep, step_pose};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::scene::{Object, ObjectPose, PoseError, TouchScene};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

type AnyBody<'a> = &'a dyn Occupancy;

/// A pose that turns an object of a grid about its middle, which comes to a point [mm].
fn turned(own: &Grid, rotation: DMat3, middle_in_scene: DVec3) -> DAffine3 {
    let middle = own.dimensions().as_dvec3() * 0.5 * own.spacing();
    DAffine3::from_mat3_translation(rotation, middle_in_scene - rotation * middle)
}

fn made<'a>(body: AnyBody<'a>, own: &Grid, world: &Grid, pose: DAffine3) -> Object<AnyBody<'a>> {
    let pose = ObjectPose::new(own, world, pose).expect("a rigid pose");
    Object::new(body, own, own.bounds(), pose)
}

/// A floor, and a plate above it that comes down: first it takes the probe along, then it is
/// held, one voxel's thickness at most before it would touch the floor.
#[test]
fn a_plate_pushes_the_probe_down_to_the_floor_and_is_stopped_there() {
    let floor = Body(|v: IVec3| v.z < 4);
    let plate = Body(|v: IVec3| v.z == 8 && VoxelBox::of_dimensions(UVec3::splat(16)).contains(v));
    let world: AnyBody = &floor;
    for about_z in [0.0, 0.3] {
        let world_grid = grid(UVec3::splat(32), DVec3::ONE);
        let own = grid(UVec3::splat(16), DVec3::splat(0.9));
        let turn = DMat3::from_rotation_z(about_z);
        let pose = |height: f64| turned(&own, turn, DVec3::new(16.0, 16.0, height));
        let mut height = 16.0;
        let mut objects = [made(&plate, &own, &world_grid, pose(height))];
        let mut proxy = Proxy::at(DVec3::new(16.2, 16.3, 14.0)).expect("a finite point");
        let mut counts = [0; 3];
        for _ in 0..400 {
            let scene = TouchScene {
                occupancy: &world,
                grid: &world_grid,
                objects: &objects,
            };
            let next = ObjectPose::new(&own, &world_grid, pose(height - 0.05)).expect("rigid");
            let before = proxy;
            let step = step_pose(&scene, 0, &next, &mut proxy);
            counts[step as usize] += 1;
            match step {
                PoseStep::Free => assert_eq!(proxy, before),
                PoseStep::Pushed => assert!(proxy.point().z < before.point().z),
                PoseStep::Held => assert_eq!(proxy, before),
            }
            if step == PoseStep::Held {
                break;
            }
            height -= 0.05;
            objects[0].set_pose(next);
        }
        // 14 to the plate's lower face near 16.4 - 0.05 n, then down 10 to the floor
        assert!(counts[0] > 20 && counts[1] > 100, "{counts:?}");
        assert_eq!(counts[2], 1, "never held at {about_z}: {counts:?}");
        assert!((4.0..4.1).contains(&proxy.point().z), "{proxy:?}");
    }
}

/// A tilted plate that comes down over a probe on the floor shoves it aside, along the floor.
#[test]
fn a_wedge_shoves_the_probe_along_the_floor() {
    let floor = Body(|v: IVec3| v.z < 4);
    let cube = Body(|v: IVec3| VoxelBox::of_dimensions(UVec3::splat(16)).contains(v));
    let world: AnyBody = &floor;
    let world_grid = grid(UVec3::splat(64), DVec3::ONE);
    let own = grid(UVec3::splat(16), DVec3::splat(0.9));
    // standing on an edge: its lower faces rise at 45° from y = 30
    let turn = DMat3::from_rotation_x(std::f64::consts::FRAC_PI_4);
    let pose = |height: f64| turned(&own, turn, DVec3::new(32.0, 30.0, height));
    let mut height = 18.0;
    let mut objects = [made(&cube, &own, &world_grid, pose(height))];
    let mut proxy = Proxy::at(DVec3::new(32.3, 30.2, 4.05)).expect("a finite point");
    let mut pushed = 0;
    while height > 12.5 {
        let scene = TouchScene {
            occupancy: &world,
            grid: &world_grid,
            objects: &objects,
        };
        let next = ObjectPose::new(&own, &world_grid, pose(height - 0.02)).expect("rigid");
        let step = step_pose(&scene, 0, &next, &mut proxy);
        assert_ne!(step, PoseStep::Held, "{proxy:?} {height}");
        pushed += usize::from(step == PoseStep::Pushed);
        height -= 0.02;
        objects[0].set_pose(next);
        assert!(objects[0].solid_at(proxy.point()).is_none());
        assert!(proxy.point().z >= 4.0);
    }
    assert!(pushed > 50, "{pushed}");
    // the edge is at 12.5 - 0.9 * 8 * sqrt 2 = 2.3, the face 4.05 high 1.7 beside it
    assert!(proxy.point().y > 31.7 && proxy.point().z < 6.0, "{proxy:?}");
}

/// Three bodies of random voxels, one of which drifts and turns at random, while the probe is
/// led about: nothing ever finds it inside, and no wall of any body is ever crossed.
#[test]
fn no_step_of_a_pose_puts_the_probe_inside_or_across_a_wall() {
    const SIZE: u32 = 14;
    let size = UVec3::splat(SIZE);
    let mut counts = [0; 3];
    for (seed, share) in [0.03, 0.1, 0.25].into_iter().enumerate() {
        for spacing in SPACINGS {
            let mut random = Random::new(seed as u128);
            let world_grid = grid(size, spacing);
            let bodies: Vec<Segment> = (0..3).map(|i| noise(SIZE, share, 7 * i + 1)).collect();
            let grids = [DVec3::splat(0.9), SPACINGS[1]].map(|spacing| grid(size, spacing));
            let middle = DVec3::splat(7.0) * spacing;
            let parts: Vec<_> = bodies
                .iter()
                .map(|body| Components::of(body, size))
                .collect();
            let poses = [(); 2].map(|()| rotation(&mut random));
            let mut objects: Vec<Object<AnyBody>> = (0..2)
                .map(|i| {
                    let pose = turned(&grids[i], poses[i], middle);
                    made(&bodies[i + 1], &grids[i], &world_grid, pose)
                })
                .collect();
            let world: AnyBody = &bodies[0];
            let (mut proxy, mut turn, mut place) = (None, poses[0], middle);
            let mut home = Vec::new();
            for step in 0..12_000 {
                let scene = TouchScene {
                    occupancy: &world,
                    grid: &world_grid,
                    objects: &objects,
                };
                // a new start now and then
                let start = (0..200)
                    .map(|_| random.point(-1.0, 15.0))
                    .find(|&point| scene.solid_at(point).is_none());
                if step % 200 == 0 {
                    proxy = start.and_then(Proxy::at);
                }
                let Some(proxy) = proxy.as_mut() else {
                    continue;
                };
                let labels = |objects: &[Object<AnyBody>], proxy: &Proxy| {
                    let own = |i: usize| objects[i].pose().voxel_at(proxy.point());
                    let voxels = [proxy.voxel(), own(0), own(1)];
                    let labels = voxels.iter().zip(&parts).map(|(&v, part)| part.label(v));
                    labels.collect::<Vec<u32>>()
                };
                if step % 200 == 0 {
                    home = labels(&objects, proxy);
                }

                // the object takes a step, small or large
                let way = random.direction() * random.between(0.0, 0.5);
                let by = random.between(0.0, 0.05);
                let next_turn = DMat3::from_axis_angle(random.direction(), by) * turn;
                let next_place = (place + way).clamp(middle - 4.0, middle + 4.0);
                let pose = turned(&grids[0], next_turn, next_place);
                let pose = ObjectPose::new(&grids[0], &world_grid, pose).expect("rigid");
                let before = *proxy;
                let outcome = step_pose(&scene, 0, &pose, proxy);
                counts[outcome as usize] += 1;
                if outcome != PoseStep::Pushed {
                    assert_eq!(*proxy, before);
                }
                if outcome != PoseStep::Held {
                    objects[0].set_pose(pose);
                    (turn, place) = (next_turn, next_place);
                }
                let scene = TouchScene {
                    occupancy: &world,
                    grid: &world_grid,
                    objects: &objects,
                };
                assert_eq!(scene.solid_at(proxy.point()), None, "{outcome:?}");
                assert_eq!(labels(&objects, proxy), home, "{outcome:?}");

                // and the probe one of its own
                let device = proxy.point() + random.direction() * random.between(0.0, 3.0);
                let device = device.clamp(DVec3::ZERO, DVec3::splat(14.0));
                let contact = Exact::default().advance(&scene, device, proxy);
                assert!(!contact.violation);
                assert_eq!(labels(&objects, proxy), home);
            }
        }
    }
    println!("free, pushed, held: {counts:?}");
    assert!(counts[1] > 1000 && counts[2] > 30, "{counts:?}");
}

#[test]
fn steps_of_objects_that_are_not_there_and_of_a_probe_inside_are_held() {
    let full = Body(|v: IVec3| VoxelBox::of_dimensions(UVec3::splat(8)).contains(v));
    let empty = Segment::empty(UVec3::splat(8));
    let world: AnyBody = &empty;
    let grid = grid(UVec3::splat(8), DVec3::ONE);
    let objects = [made(&full, &grid, &grid, DAffine3::IDENTITY)];
    let scene = TouchScene {
        occupancy: &world,
        grid: &grid,
        objects: &objects,
    };
    let nudge = DAffine3::from_translation(DVec3::splat(0.1));
    let next = ObjectPose::new(&grid, &grid, nudge).expect("rigid");
    let start = Proxy::at(DVec3::splat(4.5)).expect("a finite point");
    let mut proxy = start;
    for index in [0, 1, 40, usize::MAX] {
        assert_eq!(step_pose(&scene, index, &next, &mut proxy), PoseStep::Held);
        assert_eq!(proxy, start);
    }
}

/// Every point of the object stays within half a voxel of the chord of each step, and the last
/// pose is the target to the bit.
#[test]
fn a_motion_ends_at_its_target_and_its_arcs_stay_near_their_chords() {
    let own = Grid::new(
        UVec3::new(200, 100, 50),
        DVec3::new(0.7, 0.7, 2.5),
        DVec3::new(30.0, -20.0, 100.0),
        DMat3::from_rotation_z(0.3),
    )
    .expect("a grid");
    let mut random = Random::new(9);
    for run in 0..200 {
        let pose = |random: &mut Random| {
            DAffine3::from_mat3_translation(rotation(random), random.point(-100.0, 100.0))
        };
        let (from, target) = (pose(&mut random), pose(&mut random));
        let ticks = [1, 10, 500][run % 3];
        let mut motion = PoseMotion::new(&own, own.bounds(), from, target, ticks).expect("rigid");
        assert!(
            motion.ticks() >= ticks && motion.ticks() < 600,
            "{}",
            motion.ticks()
        );
        let mut last = from;
        let mut steps = 0;
        while !motion.is_done() {
            let next = motion.next_pose();
            assert!(ObjectPose::new(&own, &own, next).is_ok(), "{next}");
            // half of the step's rotation, against half of its chord
            let turn = next.matrix3 * last.matrix3.transpose();
            let angle = (0.5 * (turn.x_axis.x + turn.y_axis.y + turn.z_axis.z - 1.0))
                .clamp(-1.0, 1.0)
                .acos();
            let size = own.dimensions().as_dvec3() * own.spacing();
            let rise = 0.5 * size.length() * (1.0 - (0.5 * angle).cos());
            assert!(rise <= 0.35 * (1.0 + 1e-6), "{rise}");
            motion.advance();
            (last, steps) = (next, steps + 1);
        }
        assert_eq!(steps, motion.ticks());
        assert_eq!((last, motion.next_pose()), (target, target));
    }
}

#[test]
fn motions_to_poses_that_are_none_are_refused() {
    let own = grid(UVec3::splat(8), DVec3::ONE);
    let good = DAffine3::IDENTITY;
    for bad in [
        DAffine3::from_scale(DVec3::splat(1.01)),
        DAffine3::from_translation(DVec3::NAN),
        DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0)),
    ] {
        for (from, target) in [(good, bad), (bad, good)] {
            let refused: Result<PoseMotion, PoseError> =
                PoseMotion::new(&own, own.bounds(), from, target, 5);
            assert!(refused.is_err());
        }
    }
    let still = PoseMotion::new(&own, VoxelBox::EMPTY, good, good, 0).expect("no way is one");
    assert_eq!(still.ticks(), 1);
}
