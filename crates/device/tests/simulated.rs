//! The simulated device against the physics it claims.

use glam::DVec3;
use palpate_device::simulated::{SettingsError, SimulatedDevice, SimulatedSettings};
use palpate_device::{HapticDevice, saturated};

const DT: f64 = 0.001;
/// 450 dots per inch, as of a Touch [mm].
const ENCODER_STEP: f64 = 25.4 / 450.0;

fn device(change: impl FnOnce(&mut SimulatedSettings)) -> SimulatedDevice {
    let mut settings = SimulatedSettings::default();
    change(&mut settings);
    SimulatedDevice::new(settings, DVec3::ZERO).expect("valid settings")
}

/// Force of a floor below y = 0 that only pushes [N].
fn floor_force(stiffness: f64, position: DVec3) -> DVec3 {
    DVec3::Y * (stiffness * -position.y).max(0.0)
}

#[test]
fn the_hand_brings_the_device_to_its_target_without_overshoot() {
    let mut device = device(|_| {});
    device.set_hand(Some(DVec3::X * 10.0));
    let mut furthest = 0.0_f64;
    for _ in 0..1000 {
        furthest = furthest.max(device.read(DT).position.x);
    }
    // critically damped with friction on top: never past the target
    assert!(furthest <= 10.0, "{furthest}");
    // after 1 s, 50 time constants: there, within rounding
    assert!((furthest - 10.0).abs() < 1e-6, "{furthest}");
}

#[test]
fn pressing_ends_where_hand_and_wall_balance() {
    let mut device = device(|s| s.encoder_step = ENCODER_STEP);
    device.set_hand(Some(DVec3::Y * -13.0));
    let mut state = device.read(DT);
    for _ in 0..3000 {
        device.write(floor_force(1.0, state.position), DVec3::ZERO);
        state = device.read(DT);
    }
    // 1.0 x = 0.3 (13 - x), so x = 3; the encoder step is 0.056 mm
    assert!((state.position.y + 3.0).abs() < 0.06, "{state:?}");
    assert!((state.force.y - 3.0).abs() < 0.06, "{state:?}");
}

/// A free fall under a constant force has a closed form: v = (F/b)(1 - exp(-b t/m)).
#[test]
fn a_constant_force_moves_the_mass_as_newton_says() {
    let mut device = device(|s| {
        s.delay_ticks = 0;
    });
    device.write(DVec3::X * 0.5, DVec3::ZERO);
    for _ in 0..50 {
        device.read(DT);
    }
    let (force, damping, mass, time) = (0.5_f64, 0.004_f64, 0.1_f64, 0.05_f64);
    let exact = force / damping * (1.0 - (-damping * 1000.0 * time / mass).exp());
    // the midpoint rule is of second order: (b dt / m)² / 12 = 2e-6 relative at 125 us
    assert!((device.true_velocity().x / exact - 1.0).abs() < 1e-5);
}

#[test]
fn the_result_does_not_depend_on_the_rate_it_is_read_at() {
    let path = |dt: f64, ticks: usize| {
        let mut device = device(|_| {});
        device.set_hand(Some(DVec3::new(4.0, -3.0, 2.0)));
        (0..ticks).fold(DVec3::ZERO, |_, _| device.read(dt).position)
    };
    let slow = path(0.001, 40);
    // both are cut into steps of 125 us, so that only rounding differs
    assert!((slow - path(0.00025, 160)).length() < 1e-9);
}

/// What a hand that taps and presses on a floor for 20 s is given.
#[derive(Default)]
struct Tapping {
    /// Highest net energy given to the hand at any moment [N·mm].
    net: f64,
    /// Highest gain of one contact, from entering to leaving, the device's friction paid.
    of_one_contact: f64,
    contacts: u32,
}

fn tapping(
    seed: u128,
    stiffness: f64,
    dt: f64,
    change: impl FnOnce(&mut SimulatedSettings),
) -> Tapping {
    let mut device = device(change);
    let mut random = oorandom::Rand64::new(seed);
    let mut state = device.read(dt);
    let mut result = Tapping::default();
    let mut entered = None;
    let ticks_per_target = (0.08 / dt) as usize;
    for tick in 0..(20.0 / dt) as usize {
        if tick % ticks_per_target == 0 {
            let lateral = 4.0 * random.rand_float() - 2.0;
            let height = 12.0 * random.rand_float() - 9.0;
            device.set_hand(Some(DVec3::new(lateral, height, 0.0)));
        }
        let force = floor_force(stiffness, state.position);
        device.write(force, DVec3::ZERO);
        state = device.read(dt);

        let work = device.work();
        let gained = work.by_feedback - work.lost;
        result.net = result.net.max(work.to_hand);
        // a contact lasts while a force is sent or still on its way
        if force != DVec3::ZERO || state.force != DVec3::ZERO {
            entered.get_or_insert(gained);
        } else if let Some(before) = entered.take() {
            result.contacts += 1;
            result.of_one_contact = result.of_one_contact.max(gained - before);
        }
    }
    result
}

/// Asserts that neither the whole session nor a single contact gives energy.
fn assert_passive(stiffness: f64, dt: f64) {
    for seed in 11..15 {
        let result = tapping(seed, stiffness, dt, |s| s.encoder_step = ENCODER_STEP);
        assert!(result.contacts > 50);
        // at no moment, so that a loan paid back later counts as well
        assert!(result.net <= 0.0, "{} N·mm at {dt} s", result.net);
        // a touch shorter than one encoder step can gain what the spring holds in it,
        // whatever the damping (Abbott & Okamura 2005): 0.0016 N·mm at 1 N/mm
        let one_step = 0.5 * stiffness * ENCODER_STEP * ENCODER_STEP;
        assert!(
            result.of_one_contact <= one_step,
            "{}",
            result.of_one_contact
        );
    }
}

#[test]
fn tapping_on_the_default_wall_gives_the_hand_no_energy() {
    assert_passive(1.0, 0.001);
    assert_passive(1.0, 0.00025);
}

#[test]
fn the_declared_stiffness_is_still_passive() {
    assert_passive(SimulatedSettings::default().limits.max_stiffness, 0.001);
}

/// The tests above can fail: above the bound K (T/2 + t_d) <= b a contact gives energy.
#[test]
fn a_wall_too_stiff_for_its_damping_is_seen_to_give_energy() {
    let result = tapping(11, 8.0, 0.001, |s| s.limits.max_force = 1e4);
    assert!(result.of_one_contact > 0.1, "{}", result.of_one_contact);
}

#[test]
fn the_balance_of_energy_closes() {
    let mut device = device(|_| {});
    // no hand: what the motors do is kept as motion or lost in friction
    device.write(DVec3::new(0.3, 0.1, -0.2), DVec3::ZERO);
    for _ in 0..200 {
        device.read(DT);
    }
    let work = device.work();
    assert!(work.by_feedback > 1.0);
    // nobody holds it, so nobody can be given energy: rounding of 1600 sums
    assert!(work.to_hand.abs() < 1e-9, "{work:?}");
    assert!((work.by_feedback - work.lost - device.kinetic_energy()).abs() < 1e-9);
}

#[test]
fn a_force_acts_after_the_stated_delay() {
    for delay_ticks in [0, 1, 5, 32] {
        let mut device = device(|s| s.delay_ticks = delay_ticks);
        device.write(DVec3::X, DVec3::ZERO);
        let acts_at = (0..100).position(|_| device.read(DT).force != DVec3::ZERO);
        assert_eq!(acts_at, Some(delay_ticks));
    }
}

#[test]
fn forces_saturate_with_their_direction_kept() {
    let wanted = DVec3::new(30.0, -40.0, 0.0);
    let cut = saturated(wanted, 10.0);
    // three operations of rounding
    assert!((cut - DVec3::new(6.0, -8.0, 0.0)).length() < 1e-12);
    for wanted in [DVec3::MAX, DVec3::splat(1e300), DVec3::splat(-1e-300)] {
        let cut = saturated(wanted, 10.0);
        assert!(cut.is_finite() && cut.length() <= 10.0 + 1e-12, "{cut}");
        assert!(cut.dot(wanted.signum()) >= 0.0);
    }
    assert_eq!(saturated(DVec3::new(1.0, f64::NAN, 0.0), 10.0), DVec3::ZERO);
    assert_eq!(saturated(DVec3::splat(f64::INFINITY), 10.0), DVec3::ZERO);
}

#[test]
fn nothing_that_is_sent_or_asked_makes_the_state_infinite() {
    let mut device = device(|_| {});
    let bad = [f64::NAN, f64::INFINITY, -1e300, 1e300, 0.0, 5.0];
    let mut random = oorandom::Rand64::new(3);
    let mut pick = || bad[random.rand_range(0..bad.len() as u64) as usize];
    for _ in 0..20_000 {
        device.set_hand(Some(DVec3::new(pick(), pick(), pick())));
        device.write(DVec3::new(pick(), pick(), pick()), DVec3::NAN);
        let state = device.read(pick() * 1e-3);
        assert!(state.position.is_finite() && state.velocity.is_finite());
        let radius = device.limits().workspace_radius;
        assert!(device.true_position().length() <= radius * (1.0 + 1e-12));
        assert!(state.force.length() <= device.limits().max_force + 1e-12);
    }
}

/// Settings no real device has: stiff hands on light arms, coarse encoders, long delay.
#[test]
fn any_allowed_settings_stay_finite() {
    let mut random = oorandom::Rand64::new(5);
    for _ in 0..200 {
        let mut any = |low: f64, high: f64| 10f64.powf(low + (high - low) * random.rand_float());
        let mut device = device(|s| {
            s.mass = any(-4.0, 2.0);
            s.damping = any(-6.0, 2.0);
            s.hand_stiffness = any(-3.0, 4.0);
            s.hand_damping = any(-6.0, 2.0);
            s.encoder_step = any(-4.0, 0.0);
        });
        device.set_hand(Some(DVec3::new(1.0, -8.0, 3.0)));
        let mut state = device.read(DT);
        for _ in 0..500 {
            device.write(floor_force(2.0, state.position), DVec3::ZERO);
            state = device.read(DT);
            assert!(state.position.is_finite() && state.position.length() < 4000.0);
        }
    }
}

#[test]
fn the_encoders_give_whole_steps_and_the_velocity_is_smooth() {
    let mut device = device(|s| s.encoder_step = ENCODER_STEP);
    device.set_hand(Some(DVec3::X * 20.0));
    for tick in 0..300 {
        let state = device.read(DT);
        let steps = state.position.x / ENCODER_STEP;
        assert!((steps - steps.round()).abs() < 1e-6);
        if tick > 20 {
            // a 5 ms filter lags 5 ms of the acceleration (below 60 m/s² here) and leaves
            // a sixth of the jumps of a step in dt = 56 mm/s
            let error = (state.velocity - device.true_velocity()).length();
            assert!(error < 0.005 * 6e3 + 56.0 / 6.0, "{error}");
        }
    }
}

#[test]
fn settings_that_are_not_physical_are_refused_by_name() {
    type Change = fn(&mut SimulatedSettings);
    let cases: [(Change, &str); 4] = [
        (|s| s.mass = 0.0, "mass"),
        (|s| s.damping = f64::NAN, "damping"),
        (|s| s.limits.max_force = f64::INFINITY, "max_force"),
        (|s| s.delay_ticks = 33, "delay_ticks"),
    ];
    for (change, name) in cases {
        let mut settings = SimulatedSettings::default();
        change(&mut settings);
        let error = SimulatedDevice::new(settings, DVec3::ZERO).expect_err("refused");
        assert!(error.to_string().contains(name), "{error}");
    }
    let lost = SimulatedDevice::new(SimulatedSettings::default(), DVec3::NAN);
    assert!(matches!(lost, Err(SettingsError::Position(_))));
}
