//! Friction, surfaces and the contact model `exact`, composed as a tick composes them.

use crate::support::{Body, Random, SPACINGS, grid, noise};
use glam::{DVec3, IVec3, UVec3};
use palpate_haptics::contact::{ContactModel, Exact, Proxy};
use palpate_haptics::force::{Friction, FrictionState, Holders, Surface, SurfaceBlend, Surfaces};
use palpate_haptics::scene::{Solid, TouchScene};
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;

/// Bone where x < 32, and a softer, rougher tissue beyond.
struct Halves;
impl Surfaces for Halves {
    fn surface_of(&self, solid: Solid) -> Surface {
        let bone = solid.voxel.x < 32;
        Surface {
            stiffness: if bone { 1.0 } else { 0.2 },
            friction_static: if bone { 0.3 } else { 0.6 },
            friction_kinetic: if bone { 0.2 } else { 0.5 },
        }
    }
}

/// What changes from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    proxy: Proxy,
    friction: FrictionState,
    blend: SurfaceBlend,
    device: DVec3,
}

struct Hand<'a, O> {
    solid: &'a O,
    grid: Grid,
    state: State,
    force: DVec3,
}

impl<'a, O: Occupancy> Hand<'a, O> {
    fn new(solid: &'a O, spacing: DVec3, start: DVec3) -> Self {
        Self {
            solid,
            grid: grid(UVec3::splat(64), spacing),
            state: State {
                proxy: Proxy::at(start / spacing).expect("a point"),
                friction: FrictionState::default(),
                blend: SurfaceBlend::default(),
                device: start,
            },
            force: DVec3::ZERO,
        }
    }

    /// One tick with the device at a place [mm from the corner of the grid]; gives the work on
    /// the hand [N·mm], by the rule that is exact for springs.
    fn to(&mut self, device: DVec3) -> f64 {
        let spacing = self.grid.spacing();
        let h = self.grid.smallest_spacing();
        let scene = TouchScene::of_world(self.solid, &self.grid);
        let state = &mut self.state;

        // to where friction holds the probe, or past it where nothing is in the way there
        let friction = state
            .blend
            .feel()
            .map_or(Friction::NONE, |feel| feel.friction);
        let mut target = friction.target(device, h, &mut state.friction);
        let mut advance =
            |to: DVec3| Exact::default().advance(&scene, to / spacing, &mut state.proxy);
        let mut contact = advance(target);
        if !contact.touching && target != device {
            state.friction.forget();
            target = device;
            contact = advance(target);
        }
        assert!(!contact.violation && !self.solid.is_solid(state.proxy.voxel()));

        // what holds it there, and what that feels like
        let point = state.proxy.point();
        let held = contact
            .touching
            .then(|| Holders::of_contact(&scene, point, target / spacing, contact.stopped_by));
        let wanted = held.and_then(|holders| holders.mixed(&Halves));
        let way = device.distance(state.device);
        let depth = (point * spacing).distance(target);
        let feel = state.blend.follow(wanted, way, depth, h);
        let at = contact.touching.then_some(point * spacing);
        let friction = feel.map_or(Friction::NONE, |feel| feel.friction);
        state.friction.remember(&friction, target, at);

        let stiffness = feel.map_or(0.0, |feel| feel.stiffness);
        let force = at.map_or(DVec3::ZERO, |at| (at - device) * stiffness);
        let work = 0.5 * (force + self.force).dot(device - state.device);
        self.force = force;
        state.device = device;
        work
    }
}

#[test]
fn every_contact_has_something_that_holds_it() {
    let solid = noise(64, 0.3, 6);
    let mut random = Random::new(7);
    for spacing in SPACINGS {
        let mut hand = Hand::new(&solid, spacing, DVec3::splat(-3.0));
        let mut contacts = 0;
        for _ in 0..50_000 {
            let step = random.direction() * random.between(0.0, 3.0);
            let device = (hand.state.device + step).clamp(DVec3::splat(-3.0), DVec3::splat(40.0));
            hand.to(device);
            if hand.force != DVec3::ZERO {
                contacts += 1;
                let feel = hand.state.blend.feel().expect("a feel");
                // rounding of three products
                let range = 0.2 - 1e-12..=1.0 + 1e-12;
                assert!(range.contains(&feel.stiffness), "{feel:?}");
                assert!(feel.friction.check().is_ok(), "{feel:?}");
            }
        }
        assert!(contacts > 10_000, "{contacts}");
    }
}

#[test]
fn at_rest_among_voxels_nothing_changes_by_a_bit() {
    let solid = noise(64, 0.3, 8);
    let mut random = Random::new(9);
    let mut hand = Hand::new(&solid, SPACINGS[1], DVec3::splat(-3.0));
    for _ in 0..300 {
        let goal = random.point(-3.0, 40.0);
        for step in 1..=20 {
            let device = hand.state.device.lerp(goal, f64::from(step) / 20.0);
            hand.to(device);
        }
        let device = hand.state.device;
        // the stated number of ticks, see tests/exact.rs
        for _ in 0..16 {
            hand.to(device);
        }
        let rested = (hand.state, hand.force.to_array().map(f64::to_bits));
        for _ in 0..30 {
            hand.to(device);
            assert_eq!(
                (hand.state, hand.force.to_array().map(f64::to_bits)),
                rested
            );
        }
    }
}

/// Over the border of two surfaces, with stick and slip, pressed and lifted.
#[test]
fn on_a_floor_the_force_steps_by_no_more_than_the_hand_and_a_tenth_of_a_voxel() {
    let floor = Body(|voxel: IVec3| voxel.z < 20);
    for spacing in SPACINGS {
        let h = spacing.min_element();
        let surface = 20.0 * spacing.z;
        let middle = DVec3::new(32.0 * spacing.x, 32.0 * spacing.y, surface);
        let mut hand = Hand::new(&floor, spacing, middle + DVec3::Z * 3.0);
        let mut random = Random::new(10);
        let mut heading = random.direction();
        let mut crossed = 0;
        for _ in 0..200_000 {
            heading = (heading + random.direction() * 0.1).normalize();
            let way = h * random.between(0.0, 0.2);
            let wanted = hand.state.device + heading * way;
            let within = (wanted - middle).abs();
            if within.truncate().max_element() > 4.0 * h || within.z > 5.0 * h {
                heading = (middle - hand.state.device).normalize();
                continue;
            }
            let before = (hand.force, hand.state.device.x);
            hand.to(wanted);
            crossed += u32::from((before.1 < middle.x) != (wanted.x < middle.x));
            let step = hand.force.distance(before.0);
            assert!(step <= way + 0.1 * h, "{step} N for {way} mm, h {h}");
        }
        assert!(crossed > 100, "{crossed}");
    }
}

#[test]
fn rubbing_voxels_of_one_surface_gives_no_energy() {
    // all of it is bone
    let ball = Body(|v: IVec3| (v.as_dvec3() + 0.5).distance(DVec3::new(16.0, 32.0, 32.0)) < 14.0);
    let middle = DVec3::new(16.0, 32.0, 32.0);
    let mut random = Random::new(12);
    for _ in 0..20 {
        let outside = middle + random.direction() * 25.0;
        let mut hand = Hand::new(&ball, DVec3::ONE, outside);
        let [mut done, mut both_ways] = [0.0, 0.0];
        let places: Vec<DVec3> = (0..40)
            .map(|_| middle + random.direction() * random.between(9.0, 18.0))
            .chain([outside])
            .collect();
        for place in places {
            let start = hand.state.device;
            let steps = (start.distance(place) / 0.02).ceil();
            for step in 1..=steps as usize {
                let work = hand.to(start.lerp(place, step as f64 / steps));
                done += work;
                both_ways += work.abs();
            }
        }
        // the hard proxy drops from stair to stair, which the rule for the work cuts in half
        assert!(done <= 0.005 * both_ways, "{done} of {both_ways}");
    }
}
