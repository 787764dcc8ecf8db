//! Whatever is wanted, what is sent is finite, small enough, and grows slowly enough.

use crate::support::Random;
use glam::DVec3;
use palpate_haptics::force::{ForceLimits, ForceOff, Safety, SafetyCounters, SafetySettings};
use proptest::prelude::*;

const LIMITS: ForceLimits = ForceLimits {
    max_force: 8.0,
    max_growth: 1000.0,
};
const DT: f64 = 0.001;

/// Sends the same force until it is reached.
fn settled(safety: &mut Safety, wanted: DVec3) -> DVec3 {
    (0..1000).fold(DVec3::ZERO, |_, _| safety.limit(wanted, DT))
}

#[test]
fn a_force_grows_by_the_slew_limit_and_then_is_what_is_wanted() {
    let mut safety = Safety::new(LIMITS);
    let wanted = DVec3::new(3.0, 0.0, 4.0);
    for tick in 1..=4 {
        let sent = safety.limit(wanted, DT);
        assert!((sent.length() - f64::from(tick)).abs() < 1e-12);
    }
    assert_eq!(safety.limit(wanted, DT), wanted);
    assert_eq!(safety.counters().slewed, 4);
}

#[test]
fn a_fall_is_never_limited() {
    let mut safety = Safety::new(LIMITS);
    let wanted = DVec3::new(0.0, 6.0, 0.0);
    settled(&mut safety, wanted);
    let slewed = safety.counters().slewed;
    assert_eq!(safety.limit(wanted * 0.1, DT), wanted * 0.1);
    assert_eq!(safety.limit(DVec3::ZERO, DT), DVec3::ZERO);
    // also where time stands still
    settled(&mut safety, wanted);
    let slewed_again = safety.counters().slewed;
    assert_eq!(safety.limit(DVec3::ZERO, 0.0), DVec3::ZERO);
    assert_eq!(safety.counters().slewed, slewed_again);
    assert!(slewed_again > slewed);
}

#[test]
fn a_force_that_turns_around_drops_what_points_against_the_new_one() {
    let mut safety = Safety::new(LIMITS);
    settled(&mut safety, DVec3::X * 8.0);
    let sent = safety.limit(-DVec3::X * 8.0, DT);
    assert_eq!(sent, -DVec3::X);
}

#[test]
fn a_large_force_is_cut_with_its_direction_kept() {
    let mut safety = Safety::new(LIMITS);
    let sent = settled(&mut safety, DVec3::new(3e200, -4e200, 0.0));
    assert!((sent - DVec3::new(4.8, -6.4, 0.0)).length() < 1e-12);
    assert_eq!(safety.counters().clamped, 1000);
}

#[test]
fn a_force_that_is_not_finite_becomes_none_and_is_counted() {
    let mut safety = Safety::new(LIMITS);
    settled(&mut safety, DVec3::Z * 5.0);
    let clean = safety.counters();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(safety.limit(DVec3::new(1.0, bad, 0.0), DT), DVec3::ZERO);
    }
    let counters = SafetyCounters {
        not_finite: 3,
        ..clean
    };
    assert_eq!(safety.counters(), counters);
    assert_eq!(safety.sent(), DVec3::ZERO);
}

#[test]
fn a_release_forgets_the_force() {
    let mut safety = Safety::new(LIMITS);
    settled(&mut safety, DVec3::Z * 5.0);
    assert_eq!(safety.release(ForceOff::ServoLate, DT), DVec3::ZERO);
    assert_eq!(safety.off(), Some(ForceOff::ServoLate));
    // and what comes next grows from zero again
    assert_eq!(safety.limit(DVec3::Z * 5.0, DT), DVec3::Z);
}

/// A wanted force: ordinary ones, tiny, huge, and none at all.
fn any_force(random: &mut Random) -> DVec3 {
    match random.below(8) {
        0 => DVec3::ZERO,
        1 => random.direction() * 1e300,
        2 => random.direction() * 1e-300,
        3 => DVec3::new(f64::NAN, 1.0, 2.0),
        4 => DVec3::new(f64::INFINITY, -1.0, 0.0),
        5 => random.direction() * 1e-160,
        _ => random.direction() * random.between(0.0, 20.0),
    }
}

/// Guarantees 5 and 6 over a million ticks of anything.
#[test]
fn whatever_is_wanted_what_is_sent_is_safe() {
    for settings in [
        SafetySettings::AT_ONCE,
        SafetySettings {
            continuous_force: CONTINUOUS,
            ..START
        },
    ] {
        stay_safe(settings);
    }
}

fn stay_safe(settings: SafetySettings) {
    let mut random = Random::new(9);
    let mut safety = Safety::starting(LIMITS, settings);
    let mut before = DVec3::ZERO;
    for _ in 0..1_000_000 {
        let wanted = any_force(&mut random);
        let dt = [0.0, -1.0, f64::NAN, 0.00025, 0.001][random.below(5)];
        let sent = safety.limit(wanted, dt);

        assert!(sent.is_finite());
        assert!(sent.length() <= LIMITS.max_force * (1.0 + 1e-15), "{sent}");
        let step = (LIMITS.max_growth * dt).max(0.0);
        // 1e-12 is rounding of lengths of up to 8 N
        assert!(sent.length() - before.length() <= step + 1e-12);
        if wanted.is_finite() {
            // compared as directions, so that 1e300 does not overflow nor 1e-300 vanish
            let direction = wanted / wanted.abs().max_element().max(f64::MIN_POSITIVE);
            assert!(sent.dot(direction) >= -1e-12, "{sent} {wanted}");
        } else {
            assert_eq!(sent, DVec3::ZERO);
        }
        before = sent;
    }
    let counters = safety.counters();
    assert!(counters.clamped > 0 && counters.slewed > 0 && counters.not_finite > 0);
}

proptest! {
    /// A turn at equal magnitude goes no faster than a growth would.
    #[test]
    fn a_change_of_direction_is_slew_limited(angle in -3.1..3.1_f64, magnitude in 0.1..8.0) {
        let mut safety = Safety::new(LIMITS);
        let start = settled(&mut safety, DVec3::X * magnitude);
        let wanted = DVec3::new(angle.cos(), angle.sin(), 0.0) * magnitude;
        let sent = safety.limit(wanted, DT);
        // what pointed against the new force is a fall; all else is a step of 1 N at most
        let fallen = start - wanted.normalize() * start.dot(wanted.normalize()).min(0.0);
        prop_assert!((sent - fallen).length() <= 1.0 + 1e-12);
        prop_assert!(sent.dot(wanted) >= 0.0);
    }
}

#[test]
fn limits_that_are_no_numbers_let_nothing_through_and_are_refused_at_the_door() {
    for bad in [f64::NAN, -1.0, 0.0] {
        let limits = ForceLimits {
            max_force: bad,
            max_growth: 1000.0,
        };
        assert!(
            limits
                .check()
                .expect_err("refused")
                .to_string()
                .contains('N')
        );
        assert_eq!(settled(&mut Safety::new(limits), DVec3::X), DVec3::ZERO);
        let limits = ForceLimits {
            max_force: 1.0,
            max_growth: bad,
        };
        assert!(limits.check().is_err());
        assert_eq!(settled(&mut Safety::new(limits), DVec3::X), DVec3::ZERO);
    }
    assert_eq!(ForceLimits::default().check(), Ok(()));
}

/// What a desktop device bears for long [N].
const CONTINUOUS: f64 = 0.88;

const START: SafetySettings = SafetySettings {
    ramp_secs: 2.0,
    start_below: 0.2,
    continuous_force: f64::INFINITY,
    continuous_secs: 5.0,
    take_back: true,
};

#[test]
fn after_the_first_small_force_forces_are_faded_in_over_the_ramp() {
    let mut safety = Safety::starting(LIMITS, START);
    assert_eq!(safety.off(), Some(ForceOff::NotStarted));
    assert_eq!(safety.limit(DVec3::ZERO, DT), DVec3::ZERO);
    for tick in 1..2000 {
        let sent = safety.limit(DVec3::X * 4.0, DT);
        // by 2 mN a tick; rounding of 2000 sums
        assert!(
            (sent.x - 0.002 * f64::from(tick)).abs() < 1e-9,
            "{tick} {sent}"
        );
    }
    assert_eq!(safety.off(), None);
    safety.limit(DVec3::X * 4.0, DT);
    assert_eq!(safety.limit(DVec3::X * 4.0, DT), DVec3::X * 4.0);
    let counters = safety.counters();
    assert!((1999..=2000).contains(&counters.ramped), "{counters:?}");
    assert_eq!((counters.waited, counters.slewed), (0, 0));
}

#[test]
fn a_hand_that_stands_in_an_obstacle_at_the_start_is_not_pushed_until_it_came_out() {
    let mut safety = Safety::starting(LIMITS, START);
    for _ in 0..5000 {
        assert_eq!(safety.limit(DVec3::Y * 0.2, DT), DVec3::ZERO);
        assert_eq!(safety.off(), Some(ForceOff::Waiting));
    }
    // a force that is no number is zero, and no small force
    safety.limit(DVec3::splat(f64::NAN), DT);
    assert_eq!(safety.off(), Some(ForceOff::NotFinite));
    assert_eq!(safety.limit(DVec3::Y * 1e200, DT), DVec3::ZERO);
    assert_eq!(safety.counters().waited, 5001);

    safety.limit(DVec3::Y * 0.19, DT);
    assert_eq!(safety.off(), None);
    for _ in 0..2001 {
        safety.limit(DVec3::Y * 3.0, DT);
    }
    assert_eq!(safety.sent(), DVec3::Y * 3.0);
}

#[test]
fn a_force_above_the_continuous_one_falls_to_it_smoothly_and_comes_back_after_a_rest() {
    let settings = SafetySettings {
        continuous_force: CONTINUOUS,
        ..SafetySettings::AT_ONCE
    };
    let limits = ForceLimits {
        max_force: 3.3,
        max_growth: 1000.0,
    };
    let mut safety = Safety::starting(limits, settings);
    let wanted = DVec3::Z * 3.3;
    // a second of the full force is borne, to the rounding of the clamp
    for tick in 1..=1000 {
        let sent = safety.limit(wanted, DT);
        assert!(tick < 5 || (sent.z - 3.3).abs() < 1e-9, "{tick} {sent}");
    }
    let mut before = safety.sent();
    for _ in 0..60_000 {
        let sent = safety.limit(wanted, DT);
        // it only falls, by no more than 2 N in a tenth of a second
        assert!(
            sent.z <= before.z + 1e-12 && before.z - sent.z < 0.02,
            "{sent}"
        );
        before = sent;
    }
    // and within a minute comes to what can be held
    assert!((before.z - CONTINUOUS).abs() < 0.01, "{before}");
    assert!(safety.counters().eased > 50_000);
    // what is below the continuous force is never touched
    let small = DVec3::X * 0.87;
    assert_eq!(settled(&mut safety, small), small);
    for _ in 0..20_000 {
        safety.limit(DVec3::ZERO, DT);
    }
    let sent = settled(&mut safety, wanted);
    assert!((sent.z - 3.3).abs() < 1e-9, "{sent}");
}

#[test]
fn a_continuous_force_that_is_no_number_lets_nothing_through() {
    for bad in [f64::NAN, 0.0, -1.0] {
        let settings = SafetySettings {
            continuous_force: bad,
            ..SafetySettings::AT_ONCE
        };
        let mut safety = Safety::starting(LIMITS, settings);
        safety.limit(DVec3::X, DT);
        assert_eq!(settled(&mut safety, DVec3::X), DVec3::ZERO);
    }
}

#[test]
fn each_cause_of_no_force_has_a_number_and_a_name_of_its_own() {
    assert_eq!(ForceOff::of_number(0), None);
    for cause in ForceOff::ALL {
        assert_eq!(ForceOff::of_number(cause as u8), Some(cause));
        let same = ForceOff::ALL
            .iter()
            .filter(|other| other.name() == cause.name());
        assert_eq!(same.count(), 1);
    }
}
