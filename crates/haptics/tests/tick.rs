//! One tick, from scene to force.

use crate::support::{Body, Press, Random, noise, press, press_smooth};
use glam::{DMat3, DVec3, IVec3, UVec3};
use palpate_haptics::admission::nearest_free;
use palpate_haptics::contact::{ContactModel, Exact};
use palpate_haptics::force::{Coupling, ForceLimits, Safety};
use palpate_haptics::scene::TouchScene;
use palpate_haptics::tick::{TickCache, TickOutput, TickState};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;

const SIZE: u32 = 32;

/// A grid that is turned, far from zero and not cubic: frames cannot be mixed up unseen.
fn turned_grid() -> Grid {
    let turn = DMat3::from_rotation_z(0.7) * DMat3::from_rotation_x(-0.4);
    Grid::new(
        UVec3::splat(SIZE),
        DVec3::new(0.7, 0.9, 2.5),
        DVec3::new(-120.0, 45.0, 800.0),
        turn,
    )
    .expect("a valid grid")
}

fn input(device_in_scene: DVec3, stiffness: f64) -> Press {
    Press {
        device_in_scene,
        velocity_in_scene: DVec3::ZERO,
        coupling: Coupling {
            stiffness,
            damping: 0.0,
        },
    }
}

fn start(occupancy: &impl Occupancy, grid: &Grid) -> TickState {
    let proxy = nearest_free(occupancy, grid, DVec3::splat(16.0), 40).expect("a free voxel");
    TickState::new(proxy)
}

#[test]
fn on_a_turned_floor_the_force_is_its_normal_times_stiffness_and_depth() {
    let grid = turned_grid();
    let floor = Body(|v: IVec3| v.z < 10);
    let scene = TouchScene::of_world(&floor, &grid);
    let mut state = start(&floor, &grid);
    let scene_from_grid = grid.patient_from_grid();
    let normal = scene_from_grid.transform_vector3(DVec3::Z).normalize();
    let surface = scene_from_grid.transform_point3(DVec3::new(15.3, 16.2, 10.0));

    for depth in [0.5, 2.0, 7.5] {
        let device = surface - normal * depth;
        // a new contact grows by a tenth of a voxel per tick
        let mut step = || press(&scene, &Exact::default(), &input(device, 1.5), &mut state);
        let output = (0..120).map(|_| step()).last().expect("120 ticks");
        // a skin of 1e-8 voxels of 2.5 mm and the rounding of a scene 1 m from zero
        assert!(
            (output.force - normal * 1.5 * depth).length() < 1e-7,
            "{output:?}"
        );
        assert!((output.depth - depth).abs() < 1e-7);
        assert!((output.proxy_in_scene - surface).length() < 1e-7);
        assert!(output.contact && !output.violation);
    }

    // back out: nothing is left of it
    let device = surface + normal;
    let output = press(&scene, &Exact::default(), &input(device, 1.5), &mut state);
    assert_eq!(
        (output.force, output.contact, output.depth),
        (DVec3::ZERO, false, 0.0)
    );
    assert!((output.proxy_in_scene - device).length() < 1e-9);
}

/// Guarantees 1, 3, 5 and 6 through the door, with good and absurd input mixed.
#[test]
fn any_input_gives_a_force_that_never_pulls_and_leaves_the_probe_outside() {
    let grid = turned_grid();
    let solid = noise(SIZE, 0.35, 7);
    let scene = TouchScene::of_world(&solid, &grid);
    let model = Exact::default();
    let limits = ForceLimits::default();
    let mut safety = Safety::new(limits);
    let mut state = start(&solid, &grid);
    let mut random = Random::new(77);
    let absurd = [
        f64::NAN,
        f64::INFINITY,
        1e300,
        -1e300,
        1e12,
        f64::MIN_POSITIVE,
    ];
    let mut device = state.proxy.point();
    let mut contacts = 0;
    for _ in 0..200_000 {
        device += random.direction() * 10.0 * random.between(0.0, 1.0).powi(2);
        device = device.clamp(DVec3::splat(-1.0), DVec3::splat(30.0));
        let mut input = Press {
            device_in_scene: grid.patient_from_grid().transform_point3(device),
            velocity_in_scene: random.direction() * random.between(0.0, 2000.0),
            coupling: Coupling {
                stiffness: random.between(0.0, 20.0),
                damping: random.between(0.0, 0.1),
            },
        };
        let bad = absurd[random.below(absurd.len())];
        match random.below(12) {
            0 => input.device_in_scene[random.below(3)] = bad,
            1 => input.velocity_in_scene[random.below(3)] = bad,
            2 => input.coupling.stiffness = bad,
            3 => input.coupling.damping = bad,
            _ => {}
        }

        let output = press(&scene, &model, &input, &mut state);
        assert!(!output.violation && !solid.is_solid(state.proxy.voxel()));
        assert!(output.visits <= model.visit_bound());
        assert!(output.force.is_finite() && output.proxy_in_scene.is_finite());
        assert!(output.contact || output.force == DVec3::ZERO);
        let sent = safety.limit(output.force, 0.001);
        assert!(sent.is_finite() && sent.length() <= limits.max_force * (1.0 + 1e-15));
        if output.contact {
            contacts += 1;
            // along the spring and outward; compared as directions, so that 1e300 N does not
            // overflow; rounding of places 1 m from zero turns a micrometre by 1e-7
            let outward = output.contact_point_in_scene - input.device_in_scene;
            if outward.length() > 1e-3 && output.force != DVec3::ZERO {
                let direction = output.force / output.force.abs().max_element();
                let cosine = direction.normalize().dot(outward.normalize());
                assert!(cosine > 1.0 - 1e-6, "{output:?}");
            }
        }
    }
    assert!(contacts > 40_000, "{contacts}");
}

#[test]
fn input_that_is_no_place_sends_no_force_and_moves_nothing() {
    let grid = turned_grid();
    let floor = Body(|v: IVec3| v.z < 10);
    let scene = TouchScene::of_world(&floor, &grid);
    let mut state = start(&floor, &grid);
    let deep = grid
        .patient_from_grid()
        .transform_point3(DVec3::new(15.0, 15.0, 8.0));
    press(&scene, &Exact::default(), &input(deep, 1.0), &mut state);
    let held = state;
    for bad in [f64::NAN, f64::NEG_INFINITY, 1e300] {
        let place = DVec3::new(bad, 0.0, 0.0);
        let output = press(&scene, &Exact::default(), &input(place, 1.0), &mut state);
        assert_eq!((output.force, output.contact), (DVec3::ZERO, false));
        assert_eq!(state.proxy, held.proxy);
    }
}

#[test]
fn a_probe_found_inside_is_reported_without_any_force() {
    let grid = turned_grid();
    let empty = Body(|_: IVec3| false);
    let full = Body(|_: IVec3| true);
    let mut state = start(&empty, &grid);
    let scene = TouchScene::of_world(&full, &grid);
    let output = press(
        &scene,
        &Exact::default(),
        &input(DVec3::ZERO, 1.0),
        &mut state,
    );
    assert!(output.violation && !output.contact);
    assert_eq!(output.force, DVec3::ZERO);
}

/// Guarantee 4, as the device gets it: place and force, to the bit.
#[test]
fn with_all_at_rest_place_and_force_stay_to_the_bit() {
    let grid = turned_grid();
    let solid = noise(SIZE, 0.3, 9);
    let scene = TouchScene::of_world(&solid, &grid);
    let mut state = start(&solid, &grid);
    let mut random = Random::new(3);
    for _ in 0..200 {
        let device = grid
            .patient_from_grid()
            .transform_point3(random.point(0.0, f64::from(SIZE)));
        let mut step = || press(&scene, &Exact::default(), &input(device, 1.0), &mut state);
        // the stated number of ticks, see tests/exact.rs
        let rested = (0..16).map(|_| step()).last().expect("16 ticks");
        let bits = |output: &TickOutput| {
            [output.proxy_in_scene, output.force].map(|v| v.to_array().map(f64::to_bits))
        };
        for _ in 0..50 {
            assert_eq!(bits(&step()), bits(&rested));
        }
    }
}

/// A surface of which nothing solid is found yet must not be felt all at once when it is found.
#[test]
fn the_force_of_noise_changes_by_little_more_than_the_hand_moves() {
    let grid = turned_grid();
    let solid = noise(SIZE, 0.5, 7);
    let scene = TouchScene::of_world(&solid, &grid);
    let h = grid.smallest_spacing();
    let stiffness = 2.0;
    let mut state = start(&solid, &grid);
    let mut cache = TickCache::default();
    let mut random = Random::new(5);
    let mut device = state.proxy.point();
    let mut last = DVec3::ZERO;
    for _ in 0..50_000 {
        let way = random.direction() * random.between(0.0, 0.5);
        device = (device + way).clamp(DVec3::splat(1.0), DVec3::splat(31.0));
        let device_in_scene = grid.patient_from_grid().transform_point3(device);
        let before = state.device.unwrap_or(device);

        let input = input(device_in_scene, stiffness);
        let output = press_smooth(&scene, &input, &mut state, &mut cache);

        // what would pull the hand in, now that the probe is elsewhere, falls at once
        let after = state.device.expect("a place that is one");
        let out = grid
            .patient_from_grid()
            .transform_vector3(state.proxy.point() - after);
        let pull = last.dot(out).min(0.0) / out.length_squared().max(f64::MIN_POSITIVE);
        let moved = ((after - before) * grid.spacing()).length();
        let changed = (output.force - (last - out * pull)).length() / stiffness;
        // rounding of a scene 1 m from zero
        assert!(
            changed <= moved + 0.1 * h + 1e-9,
            "{changed} mm in {moved} mm after {last} N: {output:?}"
        );
        last = output.force;
    }
}
