//! The coupling never pulls, starts from zero and refuses what is no spring.

use crate::support::Random;
use glam::DVec3;
use palpate_haptics::force::{Coupling, CouplingError};
use proptest::prelude::*;

#[test]
fn without_damping_the_force_is_stiffness_times_depth_along_the_spring() {
    let coupling = Coupling {
        stiffness: 0.8,
        damping: 0.0,
    };
    let mut random = Random::new(1);
    for _ in 0..1000 {
        let spring = random.point(-5.0, 5.0);
        let force = coupling.force(spring, random.point(-500.0, 500.0));
        // a length and a division of rounding
        assert!((force - 0.8 * spring).length() < 1e-14);
    }
}

#[test]
fn damping_adds_on_the_way_in_and_takes_on_the_way_out_but_never_turns_the_force() {
    let coupling = Coupling {
        stiffness: 1.0,
        damping: 0.002,
    };
    let out = DVec3::Z * 2.0;
    assert!(coupling.force(out, -DVec3::Z * 100.0).z > 2.0);
    assert!(coupling.force(out, DVec3::Z * 100.0).z < 2.0);
    // at any speed: between nothing and twice the spring
    assert_eq!(coupling.force(out, DVec3::Z * 1e6), DVec3::ZERO);
    assert_eq!(coupling.force(out, -DVec3::Z * 1e6), DVec3::Z * 4.0);
    // sideways motion adds no friction
    assert_eq!(coupling.force(out, DVec3::X * 300.0), DVec3::Z * 2.0);
    // and at the surface nothing jumps
    assert_eq!(coupling.force(DVec3::ZERO, DVec3::Z * 9.0), DVec3::ZERO);
}

proptest! {
    #[test]
    fn no_force_points_into_the_obstacle(
        spring in prop::array::uniform3(-1e3..1e3),
        velocity in prop::array::uniform3(-1e5..1e5),
        stiffness in 0.0..20.0,
        damping in 0.0..1.0,
    ) {
        let spring = DVec3::from_array(spring);
        let coupling = Coupling { stiffness, damping };
        prop_assert!(coupling.check().is_ok());
        let force = coupling.force(spring, DVec3::from_array(velocity));
        prop_assert!(force.dot(spring) >= 0.0);
        // rounding of three products
        prop_assert!(force.length() <= 2.0 * stiffness * spring.length() * (1.0 + 1e-12));
    }
}

/// The servo must not stop for a figure that slipped through.
#[test]
fn what_is_no_spring_gives_no_force_and_no_panic() {
    for stiffness in [f64::NAN, -5.0, f64::NEG_INFINITY] {
        for damping in [0.0, 0.01, f64::NAN, f64::INFINITY, -1.0] {
            let coupling = Coupling { stiffness, damping };
            let force = coupling.force(DVec3::Z, DVec3::new(0.0, 3.0, -5.0));
            assert_eq!(force, DVec3::ZERO, "{coupling:?}");
        }
    }
}

#[test]
fn figures_that_are_no_spring_are_refused() {
    for stiffness in [f64::NAN, -1.0, 1e9, f64::INFINITY] {
        let coupling = Coupling {
            stiffness,
            damping: 0.0,
        };
        let error = coupling.check().expect_err("refused");
        assert!(matches!(error, CouplingError::Stiffness(_)));
        assert!(
            error.to_string().contains("allowed: finite, 0..=20"),
            "{error}"
        );
    }
    let coupling = Coupling {
        stiffness: 1.0,
        damping: f64::NAN,
    };
    assert!(matches!(coupling.check(), Err(CouplingError::Damping(_))));
    assert_eq!(Coupling::default().check(), Ok(()));
}
