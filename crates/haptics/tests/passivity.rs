//! The observer counts what came from nowhere, and the controller takes it back.

use crate::support::Random;
use glam::DVec3;
use palpate_haptics::force::Passivity;

const DT: f64 = 0.001;
const K: f64 = 1.0;

/// A mass of 0.1 kg thrown at 200 mm/s against a wall of `stiffness` [N/mm] that is sampled;
/// gives its energy before and after [N·mm].
fn thrown(stiffness: f64, damping: f64, controlled: bool) -> (f64, f64, Passivity) {
    let inertia = 1e-4; // N·s²/mm
    let (mut position, mut velocity) = (5.0_f64, -200.0_f64);
    let before = 0.5 * inertia * velocity * velocity;
    let mut passivity = Passivity::default();
    let mut force = DVec3::ZERO;
    for _ in 0..300 {
        // the force is held for a tick, the mass moves in small steps
        let start = position;
        for _ in 0..20 {
            velocity += (force.z - damping * velocity) / inertia * DT / 20.0;
            position += velocity * DT / 20.0;
        }
        let moved = DVec3::Z * (position - start);
        let spring = (-position).max(0.0);
        let eaten = damping * moved.length_squared() / DT;
        passivity.observe(force, moved, eaten, 0.5 * stiffness * spring * spring);
        let wanted = DVec3::Z * stiffness * spring;
        force = if controlled {
            passivity.control(wanted, moved, DT)
        } else {
            wanted
        };
    }
    let after = 0.5 * inertia * velocity * velocity;
    (before, after, passivity)
}

#[test]
fn a_sampled_wall_throws_a_mass_back_faster_and_the_observer_knows_by_how_much() {
    let (before, after, passivity) = thrown(K, 0.0, false);
    let gained = after - before;
    assert!(gained > 0.05 * before, "{before} {after}");
    // the wall is left within a tick, and the credit is small
    assert!(
        (passivity.excess() - gained).abs() < 0.1 * gained,
        "{gained} {passivity:?}"
    );
}

#[test]
fn the_controller_takes_back_what_a_sampled_wall_gives() {
    let (before, without, _) = thrown(K, 0.0, false);
    let (_, with, passivity) = thrown(K, 0.0, true);
    assert!(passivity.acted() > 0);
    let [gained, left] = [without - before, with - before];
    assert!(left < 0.4 * gained, "{gained} {left}");
}

/// b > K T / 2: what sampling gives, the device eats.
#[test]
fn a_wall_within_the_bound_of_its_device_is_left_alone() {
    let (before, after, passivity) = thrown(K, 0.001, true);
    assert_eq!(passivity.acted(), 0);
    assert_eq!(passivity.excess(), 0.0);
    assert!(after < before, "{before} {after}");
}

#[test]
fn at_rest_and_on_the_way_in_nothing_is_changed() {
    let mut random = Random::new(3);
    let mut passivity = Passivity::default();
    // from nowhere
    passivity.observe(DVec3::X * 5.0, DVec3::X, 0.0, 0.0);
    assert!((passivity.excess() - 5.0).abs() < 1e-12);
    for _ in 0..1000 {
        let wanted = random.direction() * random.between(0.0, 10.0);
        assert_eq!(passivity.control(wanted, DVec3::ZERO, DT), wanted);
        let inward = -wanted * random.between(0.0, 1.0);
        assert_eq!(passivity.control(wanted, inward, DT), wanted);
    }
    assert_eq!(passivity.acted(), 0);
}

#[test]
fn a_controlled_force_is_shorter_never_turned() {
    let mut random = Random::new(4);
    for _ in 0..10_000 {
        let mut passivity = Passivity::default();
        passivity.observe(DVec3::X * random.between(0.0, 9.0), DVec3::X, 0.0, 0.0);
        let wanted = random.direction() * random.between(0.0, 10.0);
        let moved = random.direction() * random.between(0.0, 2.0);
        let sent = passivity.control(wanted, moved, DT);
        assert!(sent.length() <= wanted.length() * (1.0 + 1e-15));
        assert!(sent.dot(wanted) >= 0.0 && sent.cross(wanted).length() < 1e-12);
    }
}

#[test]
fn what_was_rubbed_away_pays_for_no_later_kick() {
    let mut passivity = Passivity::default();
    for _ in 0..10_000 {
        passivity.observe(DVec3::NEG_X, DVec3::X * 0.1, 0.0, 0.0);
    }
    // 1000 N·mm were lost; of a kick of 2, all but a store of 0.05 count
    passivity.observe(DVec3::X, DVec3::X * 2.0, 0.0, 0.0);
    assert!((passivity.excess() - 1.95).abs() < 1e-9, "{passivity:?}");
}

#[test]
fn readings_that_are_no_numbers_begin_the_account_anew() {
    let mut passivity = Passivity::default();
    passivity.observe(DVec3::X * 5.0, DVec3::X, 0.0, 0.0);
    for bad in [f64::NAN, f64::INFINITY] {
        passivity.observe(DVec3::X, DVec3::splat(bad), 0.0, 0.0);
        assert_eq!(passivity.excess(), 0.0);
        passivity.observe(DVec3::X, DVec3::ZERO, 0.0, 0.0);
        assert_eq!(passivity.excess(), 0.0);
    }
}
