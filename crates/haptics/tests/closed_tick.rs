//! The servo tick is closed: a counting allocator sees nothing, whatever is touched.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use crate::support::{Press, Random, SPACINGS, grid, noise, rub};
use glam::{DAffine3, DMat3, DVec3, UVec3};
use palpate_haptics::admission::{
    Admission, PoseStep, admit, admit_scene, nearest_free, step_pose,
};
use palpate_haptics::ball::{Ball, BallShape, MAX_BODIES, ProbeSolid, admit_radius};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::force::{
    Coupling, ForceLimits, FrictionState, Holders, LocalForce, Passivity, Safety, SafetySettings,
    Surface, SurfaceBlend, Uniform,
};
use palpate_haptics::scene::{Object, ObjectPose, TouchScene};
use palpate_haptics::thesis::{ThesisImproved, ThesisOriginal};
use palpate_haptics::tick::{TickCache, TickState};
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

thread_local! {
    /// Calls of the allocator by this thread.
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

/// The system's allocator, with every call of it counted.
struct Counting;

// SAFETY: all work is passed on to the system's allocator unchanged; the counter is a plain
// number of the thread, needs no allocation and cannot unwind.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        CALLS.set(CALLS.get() + 1);
        // SAFETY: the caller's promises are passed on
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        CALLS.set(CALLS.get() + 1);
        // SAFETY: the caller's promises are passed on
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        CALLS.set(CALLS.get() + 1);
        // SAFETY: the caller's promises are passed on
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Calls of the allocator while `work` runs.
fn allocator_calls(work: impl FnOnce()) -> u64 {
    let before = CALLS.get();
    work();
    CALLS.get() - before
}

#[test]
fn the_counter_counts() {
    let calls = allocator_calls(|| drop(std::hint::black_box(vec![1_u8; 100])));
    assert_eq!(calls, 2);
}

/// 300 000 ticks of anything, with a change of the voxels admitted, pushed or held between
/// every two, over one segment and over a union of two.
#[test]
fn ticks_admissions_and_safety_never_call_the_allocator() {
    let scenes = [0.1, 0.4].map(|share| [noise(32, share, 1), noise(32, share, 2)]);
    let mut outcomes = [0; 3];
    for (spacing, parts) in SPACINGS.into_iter().zip(&scenes) {
        let grid = grid(UVec3::splat(32), spacing);
        let union = [parts[0].occupancy(), parts[1].occupancy()];
        let proxy = nearest_free(&union, &grid, DVec3::splat(16.0), 9).expect("free");
        let mut state = TickState::new(proxy);
        let mut cache = TickCache::default();
        let mut epoch = 1;
        let mut safety = Safety::new(ForceLimits::default());
        let mut random = Random::new(5);
        let mut both = true;

        let calls = allocator_calls(|| {
            for _ in 0..150_000 {
                let mut device = random.point(-5.0, 37.0) * spacing;
                if random.below(20) == 0 {
                    device.x = [f64::NAN, 1e300, 1e7][random.below(3)];
                }
                let input = Press {
                    device_in_scene: device,
                    velocity_in_scene: random.direction() * 300.0,
                    coupling: Coupling::default(),
                };
                let one = [union[0]];
                let occupancy: &[_] = if both { &union } else { &one };
                let scene = TouchScene::of_world(&occupancy, &grid);
                let output = rub(&scene, &input, &mut state, (&mut cache, epoch));
                assert!(!output.violation);
                safety.limit(output.force, 0.001);

                epoch += 1;
                // the second segment is switched off and, where the probe allows, on
                let other: &[_] = if both { &one } else { &union };
                let admission = admit(occupancy, other, &grid, &mut state.proxy);
                both ^= admission != Admission::Held;
                outcomes[match admission {
                    Admission::Free => 0,
                    Admission::Pushed { .. } => 1,
                    Admission::Held => 2,
                }] += 1;
            }
        });
        assert_eq!(calls, 0);
    }
    assert!(outcomes[0] > 0 && outcomes[1] > 0, "{outcomes:?}");
}

#[test]
fn the_thesis_models_never_call_the_allocator() {
    let solid = noise(32, 0.3, 1);
    let grid = grid(UVec3::splat(32), SPACINGS[0]);
    let mut proxies = [nearest_free(&solid, &grid, DVec3::splat(16.0), 9).expect("free"); 2];
    let scene = TouchScene::of_world(&solid, &grid);
    let mut random = Random::new(5);
    let calls = allocator_calls(|| {
        for _ in 0..20_000 {
            let device = random.point(-5.0, 37.0);
            ThesisOriginal::default().advance(&scene, device, &mut proxies[0]);
            ThesisImproved::default().advance(&scene, device, &mut proxies[1]);
        }
    });
    assert_eq!(calls, 0);
}

/// A ball among two sets of voxels, one of them a part of the other, that take turns.
#[test]
fn the_ball_never_calls_the_allocator() {
    let [few, more] = [0.002, 0.004].map(|share| noise(48, share, 3).occupancy().clone());
    let union = [few.clone(), more];
    for (spacing, radius) in [(SPACINGS[0], 5.0), (SPACINGS[1], 0.7), (SPACINGS[0], 11.0)] {
        let grid = grid(UVec3::splat(48), spacing);
        let ball = || Ball::new(BallShape::new(radius, spacing).expect("within the window"));
        let inner = [few.clone(), few.clone()];
        let mut probe = ProbeSolid::new(inner, radius, spacing).expect("within the window");
        let mut other = Some(union.clone());
        let whole = VoxelBox::of_dimensions(UVec3::splat(48));
        let mut spare = ball();
        let mut spares: [Ball; MAX_BODIES] = std::array::from_fn(|_| ball());
        let proxy = nearest_free(&probe, &grid, DVec3::splat(24.0), 40).expect("free");
        let mut state = TickState::new(proxy);
        let mut cache = TickCache::default();
        let mut epoch = 1;
        let mut random = Random::new(5);
        let calls = allocator_calls(|| {
            for _ in 0..2000 {
                let input = Press {
                    device_in_scene: random.point(-5.0, 53.0) * spacing,
                    velocity_in_scene: DVec3::ZERO,
                    coupling: Coupling::default(),
                };
                let scene = TouchScene::of_world(&probe, &grid);
                assert!(!rub(&scene, &input, &mut state, (&mut cache, epoch)).violation);
                probe.solid_near(state.proxy.voxel() + 1);

                epoch += 1;
                // the other voxels, where the probe allows
                let Some(new) = other.take() else { return };
                let changed = probe.among(&new, &mut spare);
                let admission = admit(&probe, &changed, &grid, &mut state.proxy);
                other = Some(if admission == Admission::Held {
                    new
                } else {
                    probe.change(&whole, |voxels| std::mem::replace(voxels, new))
                });

                // and another radius
                let next = probe.shape().toward(random.between(0.0, radius));
                let scene = TouchScene::of_world(&probe, &grid);
                let admission = admit_radius(&scene, next, &mut spares, &mut state.proxy);
                if admission != Ok(Admission::Held) {
                    assert!(probe.set_radius(next).is_ok());
                }
            }
        });
        assert_eq!(calls, 0);
    }
}

#[test]
fn friction_surfaces_and_the_device_s_side_never_call_the_allocator() {
    let solid = noise(32, 0.3, 1);
    let grid = grid(UVec3::splat(32), SPACINGS[0]);
    let scene = TouchScene::of_world(&solid, &grid);
    let surface = Surface {
        stiffness: 1.0,
        friction_static: 0.4,
        friction_kinetic: 0.2,
    };
    let mut proxy = nearest_free(&solid, &grid, DVec3::splat(16.0), 9).expect("free");
    let mut friction = FrictionState::default();
    let mut blend = SurfaceBlend::default();
    let mut contacts = 0;
    let mut passivity = Passivity::default();
    let mut safety = Safety::starting(ForceLimits::default(), SafetySettings::default());
    let mut random = Random::new(5);
    let calls = allocator_calls(|| {
        for _ in 0..50_000 {
            let device = random.point(-5.0, 37.0);
            let target = surface.friction().target(device, 1.0, &mut friction);
            let contact = Exact::default().advance(&scene, target, &mut proxy);
            let point = contact.touching.then(|| proxy.point());
            friction.remember(&surface.friction(), target, point);
            let holders = Holders::of_contact(&scene, proxy.point(), target, contact.stopped_by);
            blend.follow(holders.mixed(&Uniform(surface)), 0.1, 1.0, 1.0);
            let law = LocalForce {
                device,
                spring: proxy.point() - device,
                normal: (proxy.point() - device).normalize_or_zero(),
                coupling: Coupling::default(),
                ..LocalForce::NONE
            };
            passivity.observe(law.held, device, 0.0, law.energy_at(device, 10.0));
            let force = passivity.control(law.force_at(device, target), device, 0.001);
            safety.limit(force, 0.001);
            contacts += u32::from(contact.touching);
        }
    });
    assert_eq!(calls, 0);
    assert!(contacts > 1000, "{contacts}");
}

/// The same among objects that move, come and go.
#[test]
fn ticks_pose_steps_and_admissions_among_objects_never_call_the_allocator() {
    let size = UVec3::splat(16);
    let solids: Vec<Segment> = (0..4).map(|seed| noise(16, 0.2, seed)).collect();
    let grids = SPACINGS.map(|spacing| grid(size, spacing));
    let mut random = Random::new(5);
    let pose = |random: &mut Random, turn: f64| {
        let rotation = DMat3::from_axis_angle(random.direction(), turn);
        let middle = DVec3::splat(8.0) * SPACINGS[1];
        let pose = DAffine3::from_mat3_translation(rotation, middle - rotation * middle);
        ObjectPose::new(&grids[1], &grids[0], pose).expect("rigid")
    };
    let mut objects: [Object<&Segment>; 3] = std::array::from_fn(|i| {
        let pose = pose(&mut random, i as f64);
        Object::new(&solids[i + 1], &grids[1], grids[1].bounds(), pose)
    });
    let world = &solids[0];
    let proxy = Proxy::at(DVec3::splat(-2.0)).expect("a finite point");
    let mut state = TickState::new(proxy);
    let (mut cache, mut epoch) = (TickCache::default(), 1);
    let mut outcomes = [0; 3];
    let calls = allocator_calls(|| {
        for _ in 0..10_000 {
            let scene = TouchScene {
                occupancy: &world,
                grid: &grids[0],
                objects: &objects,
            };
            let input = Press {
                device_in_scene: random.point(-2.0, 18.0),
                velocity_in_scene: DVec3::ZERO,
                coupling: Coupling::default(),
            };
            assert!(!rub(&scene, &input, &mut state, (&mut cache, epoch)).violation);
            epoch += 1;
            let fewer = TouchScene {
                objects: &objects[..2],
                ..scene
            };
            let before = state.proxy;
            if admit_scene(&fewer, &scene, &mut state.proxy) != Admission::Free {
                state.proxy = before;
            }
            let turn = random.between(0.0, 1.0);
            let next = pose(&mut random, turn);
            let step = step_pose(&scene, 0, &next, &mut state.proxy);
            outcomes[step as usize] += 1;
            if step != PoseStep::Held {
                objects[0].set_pose(next);
            }
        }
    });
    assert_eq!(calls, 0);
    assert!(outcomes.iter().all(|&count| count > 0), "{outcomes:?}");
}
