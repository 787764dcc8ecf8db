//! The thesis' contact models as printed: bounded and finite whatever they are given, and
//! wrong where their headers say so, on bodies where `exact` is right.

use crate::support::{Body, Random, SPACINGS, grid, noise};
use glam::{DVec3, IVec3, UVec3};
use palpate_haptics::contact::{Contact, ContactModel, Exact, Proxy};
use palpate_haptics::scene::TouchScene;
use palpate_haptics::thesis::{ThesisImproved, ThesisLimits, ThesisOriginal};
use palpate_volume::occupancy::Occupancy;

const NORMAL: ThesisLimits = ThesisLimits {
    max_path: 5.0,
    gap: 0.1,
};
const ORIGINAL: ThesisOriginal = ThesisOriginal { limits: NORMAL };
const IMPROVED: ThesisImproved = ThesisImproved { limits: NORMAL };

fn at(x: f64, y: f64, z: f64) -> Proxy {
    Proxy::at(DVec3::new(x, y, z)).expect("a finite point")
}

/// Moves of all lengths from anywhere, solid voxels included; counts those that end inside.
fn survive(model: &impl ContactModel, occupancy: &impl Occupancy, seed: u128) -> usize {
    let grid = grid(UVec3::splat(24), SPACINGS[1]);
    let mut random = Random::new(seed);
    let mut proxy = at(-2.0, 3.0, 4.0);
    let mut inside = 0;
    for _ in 0..5_000 {
        let device = random.point(-4.0, 28.0);
        let contact = model.advance(&TouchScene::of_world(occupancy, &grid), device, &mut proxy);
        assert!(proxy.point().is_finite());
        assert!(contact.visits <= model.visit_bound(), "{contact:?}");
        assert_eq!(contact.violation, occupancy.is_solid(proxy.voxel()));
        inside += usize::from(contact.violation);
    }
    inside
}

#[test]
fn on_random_noise_both_models_end_within_their_bound_and_say_when_they_are_inside() {
    let absurd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0, 1e300];
    let usual = [0.3, 5.0, 7.3, 10.0];
    let mut ever_inside = [0, 0];
    for (seed, share) in [0.0, 0.1, 0.5, 0.9, 1.0].into_iter().enumerate() {
        let solid = noise(24, share, seed as u128);
        for max_path in absurd.into_iter().chain(usual) {
            for gap in [f64::NAN, -1.0, 0.1, 1e300] {
                let limits = ThesisLimits { max_path, gap };
                let inside = [
                    survive(&ThesisOriginal { limits }, &solid, 1),
                    survive(&ThesisImproved { limits }, &solid, 1),
                ];
                if share == 0.0 {
                    assert_eq!(inside, [0, 0]);
                }
                ever_inside = std::array::from_fn(|model| ever_inside[model] + inside[model]);
            }
        }
    }
    println!("ticks that ended in a solid voxel: {ever_inside:?}");
    assert!(ever_inside.iter().all(|&count| count > 0));
}

fn absurd_input_changes_nothing(model: &impl ContactModel) {
    let solid = noise(8, 0.5, 1);
    let grid = grid(UVec3::splat(8), DVec3::ONE);
    let start = at(4.5, 4.5, 4.5);
    let mut proxy = start;
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e9] {
        for axis in DVec3::AXES {
            let device = DVec3::select(axis.cmpeq(DVec3::ONE), DVec3::splat(bad), DVec3::ONE);
            let contact = model.advance(&TouchScene::of_world(&solid, &grid), device, &mut proxy);
            assert_eq!(contact, Contact::default());
            assert_eq!(proxy, start);
        }
    }
    // the farthest points that are some, and steps that vanish when squared
    for far in [-1.6e7, 1.6e7, 1e-200, f64::MIN_POSITIVE] {
        for _ in 0..10 {
            model.advance(
                &TouchScene::of_world(&solid, &grid),
                DVec3::splat(far),
                &mut proxy,
            );
            assert!(proxy.point().is_finite());
        }
        proxy = at(0.0, 0.0, 0.0);
    }
}

#[test]
fn device_points_that_are_none_leave_the_proxy_where_it_is() {
    absurd_input_changes_nothing(&ORIGINAL);
    absurd_input_changes_nothing(&IMPROVED);
}

/// The device 3 voxels below a floor, wandering; the proxy stays in the lowest free layers.
fn stay_above_the_floor(model: &impl ContactModel) {
    let floor = Body(|voxel: IVec3| voxel.z < 10);
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    let mut random = Random::new(41);
    let mut proxy = at(30.2, 30.7, 14.0);
    let mut device = DVec3::new(30.2, 30.7, 7.0);
    for tick in 0..5_000 {
        device.x = (device.x + random.between(-0.3, 0.3)).clamp(1.0, 63.0);
        device.y = (device.y + random.between(-0.3, 0.3)).clamp(1.0, 63.0);
        let contact = model.advance(&TouchScene::of_world(&floor, &grid), device, &mut proxy);
        assert!(contact.touching && !contact.violation);
        if let Some(solid) = contact.stopped_by {
            assert!(solid.body == 0 && floor.is_solid(solid.voxel));
        }
        // w_max of 5 brings it down from 14 in the first tick, into the first layer
        let height = proxy.point().z - 10.0;
        assert!((0.0..1.0).contains(&height), "{tick}: {height}");
    }
}

#[test]
fn on_a_flat_floor_both_models_stop_at_the_surface() {
    stay_above_the_floor(&ORIGINAL);
    stay_above_the_floor(&IMPROVED);
}

/// Way of the proxy per tick, on average, once it has had time to rest; the device is still.
fn jitter(model: &impl ContactModel, solid: &impl Occupancy, device: DVec3) -> f64 {
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    let mut proxy = at(30.2, 30.7, 40.0);
    let mut way = 0.0;
    for tick in 0..300 {
        let before = proxy.point();
        model.advance(&TouchScene::of_world(solid, &grid), device, &mut proxy);
        if tick >= 100 {
            way += proxy.point().distance(before) / 200.0;
        }
    }
    way
}

/// By 0.51 voxels in the errata of the thesis.
#[test]
fn at_rest_on_a_flat_floor_thesis_improved_jitters_and_exact_does_not() {
    let floor = Body(|voxel: IVec3| voxel.z < 10);
    let mut random = Random::new(5);
    let mut sum = 0.0;
    for _ in 0..50 {
        let device = DVec3::new(30.0, 30.0, 2.0) + random.point(0.0, 1.0);
        sum += jitter(&IMPROVED, &floor, device);
        assert_eq!(jitter(&Exact::default(), &floor, device), 0.0);
    }
    let mean = sum / 50.0;
    println!("thesis-improved at rest on a floor: {mean:.2} voxels a tick");
    // 0.51 here too; the bounds leave room for other device points
    assert!((0.4..0.6).contains(&mean), "{mean}");
}

/// 4.8 voxels in the errata; here 4.98 for 21 of the 50 device points, the others rest.
#[test]
fn at_rest_on_a_stair_thesis_original_cycles_and_exact_does_not() {
    let stair = Body(|voxel: IVec3| voxel.x + voxel.z < 40);
    let mut random = Random::new(6);
    let mut sum = 0.0;
    for _ in 0..50 {
        let device = DVec3::new(15.0, 30.0, 15.0) + random.point(0.0, 1.0);
        let way = jitter(&ORIGINAL, &stair, device);
        sum += way / 50.0;
        assert_eq!(jitter(&Exact::default(), &stair, device), 0.0);
    }
    println!("thesis-original at rest on a stair: {sum:.2} voxels a tick");
    assert!(sum > 1.0, "{sum}");
}

/// Share of runs that get through the thinnest wall no face-connected path crosses: 150
/// frames of 0.3 to 1 voxel, the device wandering on the far side.
fn crossed(model: &impl ContactModel, normal: DVec3) -> f64 {
    const RUNS: u32 = 200;
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    let thickness = normal.abs().max_element();
    let offset = move |voxel: IVec3| normal.dot(voxel.as_dvec3()) / thickness;
    let wall = Body(move |voxel| (-0.5..0.5).contains(&offset(voxel)));
    let across = normal.normalize();
    let mut random = Random::new(11);
    let mut crossed = 0;
    for _ in 0..RUNS {
        let side = across.any_orthonormal_vector();
        let start = across * 3.0 + side * random.between(-9.0, 9.0);
        let mut proxy = Proxy::at(start).expect("a finite point");
        let mut device = start;
        let heading = (random.direction() * 0.8 - across).normalize();
        for _ in 0..150 {
            // down to 5 voxels behind the wall, then along it
            let along = heading - across * across.dot(heading);
            let deep = device.dot(across) < -5.0;
            device += if deep { along } else { heading } * random.between(0.3, 1.0);
            model.advance(&TouchScene::of_world(&wall, &grid), device, &mut proxy);
            if offset(proxy.voxel()) < 0.0 {
                crossed += 1;
                break;
            }
        }
    }
    f64::from(crossed) / f64::from(RUNS)
}

/// The fault that the errata of the thesis give as 98 to 100 % of runs.
#[test]
fn thin_diagonal_walls_hold_exact_always_and_the_thesis_models_seldom() {
    for normal in [
        DVec3::new(1.0, 1.0, 0.0),
        DVec3::ONE,
        DVec3::new(0.5, -0.7, 0.9),
    ] {
        let [exact, original, improved] = [
            crossed(&Exact::default(), normal),
            crossed(&ORIGINAL, normal),
            crossed(&IMPROVED, normal),
        ];
        println!("{normal}: exact {exact}, original {original}, improved {improved}");
        assert_eq!(exact, 0.0);
        assert!(original > 0.5 && improved > 0.5, "{original} {improved}");
    }
}
