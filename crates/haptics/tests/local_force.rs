//! The contact as a law that the device follows at its own rate.

use crate::support::Random;
use glam::DVec3;
use palpate_haptics::force::{Coupling, LocalForce};
use proptest::prelude::*;

const WALL: Coupling = Coupling {
    stiffness: 1.5,
    damping: 0.002,
};

/// The law of the floor z = 0, as a servo makes it for a device below it.
fn on_floor(device: DVec3, sticks: bool) -> LocalForce {
    LocalForce {
        device,
        spring: DVec3::Z * -device.z,
        normal: DVec3::Z,
        coupling: WALL,
        sticks,
        scale: 1.0,
        held: DVec3::ZERO,
    }
}

#[test]
fn where_the_servo_looked_the_law_gives_its_force_to_the_bit() {
    let mut random = Random::new(1);
    for _ in 0..1000 {
        let spring = random.point(-3.0, 3.0);
        let device = random.point(-50.0, 50.0);
        let velocity = random.point(-300.0, 300.0);
        let law = LocalForce {
            device,
            spring,
            normal: spring.normalize(),
            coupling: WALL,
            sticks: random.below(2) == 0,
            scale: 1.0,
            held: DVec3::ZERO,
        };
        assert_eq!(law.force_at(device, velocity), WALL.force(spring, velocity));
    }
}

#[test]
fn on_a_plane_the_law_is_what_a_servo_would_find_at_the_new_place() {
    let law = on_floor(DVec3::new(4.0, 5.0, -1.0), false);
    let mut random = Random::new(2);
    for _ in 0..1000 {
        let device = law.device + random.point(-2.0, 2.0);
        let velocity = random.point(-300.0, 300.0);
        let found = WALL.force(DVec3::Z * (-device.z).max(0.0), velocity);
        // rounding of a sum and a product
        assert!((law.force_at(device, velocity) - found).length() < 1e-12);
    }
}

#[test]
fn a_sticking_contact_pulls_back_along_the_surface_and_a_sliding_one_does_not() {
    let device = DVec3::new(0.0, 0.0, -2.0);
    let aside = device + DVec3::X * 0.5;
    let sticking = on_floor(device, true).force_at(aside, DVec3::ZERO);
    assert!((sticking - DVec3::new(-0.75, 0.0, 3.0)).length() < 1e-12);
    let sliding = on_floor(device, false).force_at(aside, DVec3::ZERO);
    assert!((sliding - DVec3::Z * 3.0).length() < 1e-12);
}

#[test]
fn beyond_the_surface_there_is_nothing() {
    let law = on_floor(DVec3::new(0.0, 0.0, -0.5), true);
    for z in [0.0, 1e-9, 3.0] {
        let device = DVec3::new(0.2, 0.0, z);
        assert_eq!(law.force_at(device, DVec3::ZERO), DVec3::ZERO);
        assert_eq!(law.energy_at(device, 10.0), 0.0);
    }
}

#[test]
fn a_force_of_a_model_of_its_own_is_held() {
    let law = LocalForce::held(DVec3::new(1.0, 2.0, 3.0));
    for device in [DVec3::ZERO, DVec3::splat(40.0)] {
        assert_eq!(law.force_at(device, DVec3::ONE), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(law.energy_at(device, 10.0), 0.0);
    }
    assert_eq!(
        LocalForce::NONE.force_at(DVec3::ONE, DVec3::ONE),
        DVec3::ZERO
    );
}

/// What a spring holds is the work of pressing it in, also where the force is cut.
#[test]
fn the_energy_of_the_spring_is_the_work_of_pressing_it() {
    let law = LocalForce {
        coupling: Coupling {
            damping: 0.0,
            ..WALL
        },
        scale: 2.0,
        ..on_floor(DVec3::new(0.0, 0.0, -0.001), false)
    };
    for largest in [1e9, 4.0] {
        let mut work = 0.0;
        let steps = 10_000;
        for step in 0..steps {
            // the middle of each step, in device mm
            let z = -5.0 * (f64::from(step) + 0.5) / f64::from(steps);
            let force = law.force_at(DVec3::Z * z, DVec3::ZERO).length();
            work += force.min(largest) * 5.0 / f64::from(steps);
        }
        let held = law.energy_at(DVec3::Z * -5.0, largest);
        // the law begins 1 µm below the surface, which scale 2 makes 0.5 µm of the device
        assert!((held / work - 1.0).abs() < 1e-3, "{held} {work}");
    }
}

proptest! {
    #[test]
    fn no_law_pulls_into_the_surface_or_gives_what_is_no_force(
        spring in prop::array::uniform3(-10.0..10.0),
        moved in prop::array::uniform3(-20.0..20.0),
        velocity in prop::array::uniform3(-1e4..1e4),
        sticks: bool,
    ) {
        let spring = DVec3::from_array(spring);
        let normal = spring.normalize_or_zero();
        let law = LocalForce {
            device: DVec3::ONE,
            spring,
            normal,
            coupling: WALL,
            sticks,
            scale: 1.0,
            held: DVec3::ZERO,
        };
        let force = law.force_at(DVec3::ONE + DVec3::from_array(moved), DVec3::from_array(velocity));
        prop_assert!(force.is_finite());
        prop_assert!(force.dot(normal) >= 0.0);
        for bad in [f64::NAN, f64::INFINITY] {
            let nowhere = law.force_at(DVec3::splat(bad), DVec3::ZERO);
            prop_assert_eq!(nowhere, DVec3::ZERO);
        }
    }
}
