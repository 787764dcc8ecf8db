//! The scripted path: where it is when, and which paths are refused.

use glam::DVec3;
use palpate_device::scripted::{PathError, PathSample, ScriptedDevice};
use palpate_device::simulated::SimulatedSettings;
use palpate_device::{DeviceLimits, HapticDevice};

fn limits() -> DeviceLimits {
    SimulatedSettings::default().limits
}

fn path(points: &[(f64, f64)]) -> Result<ScriptedDevice, PathError> {
    let sample = |&(time, x)| PathSample {
        time,
        position: DVec3::X * x,
    };
    ScriptedDevice::new(points.iter().map(sample).collect(), limits())
}

#[test]
fn the_path_is_linear_between_samples_and_stays_at_its_ends() {
    let mut device = path(&[(0.5, 1.0), (1.0, 3.0), (2.0, 2.0)]).expect("a path");
    let expected = [
        (0.25, 1.0, 0.0),
        (0.50, 1.0, 4.0),
        (0.75, 2.0, 4.0),
        (1.00, 3.0, -1.0),
        (1.25, 2.75, -1.0),
    ];
    for (time, x, velocity) in expected {
        let state = device.read(0.25);
        assert_eq!((state.time, state.position.x), (time, x));
        assert_eq!(state.velocity.x, velocity);
    }
    for _ in 0..10 {
        device.read(0.25);
    }
    assert_eq!(device.read(0.25).position.x, 2.0);
    assert_eq!(device.read(0.25).velocity, DVec3::ZERO);
    assert_eq!(device.duration(), 2.0);
}

#[test]
fn one_tick_may_pass_many_samples() {
    let samples: Vec<_> = (0..1000)
        .map(|i| (f64::from(i) * 1e-4, f64::from(i)))
        .collect();
    let mut device = path(&samples).expect("a path");
    // 0.05 s is sample 500, up to rounding of the division
    assert!((device.read(0.05).position.x - 500.0).abs() < 1e-9);
}

#[test]
fn the_force_is_kept_and_saturated_and_moves_nothing() {
    let mut device = path(&[(0.0, 1.0)]).expect("a path");
    device.write(DVec3::Y * 1e9, DVec3::ZERO);
    let state = device.read(0.001);
    assert_eq!(state.force, DVec3::Y * limits().max_force);
    assert_eq!(state.position, DVec3::X);
}

#[test]
fn a_path_that_cannot_be_followed_is_refused() {
    assert_eq!(path(&[]).err(), Some(PathError::Empty));
    assert_eq!(
        path(&[(0.0, 1.0), (1.0, f64::NAN)]).err(),
        Some(PathError::NotFinite { index: 1 })
    );
    let error = path(&[(0.0, 1.0), (1.0, 1.0), (1.0, 2.0)]).expect_err("time stands");
    assert_eq!(
        error.to_string(),
        "scripted path: sample 2 is at 1 s, not after 1 s; allowed: rising times"
    );
}
