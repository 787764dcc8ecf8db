//! Between device and scene: gain and clutch.

use crate::common::{OBSTACLE, Rig, box_segment};
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::servo::TickRecord;
use palpate_engine::touch::Settings;

const DIMENSIONS: UVec3 = UVec3::splat(48);
const START: DVec3 = DVec3::new(24.5, 24.5, 30.5);
/// Of coordinates of some ten mm.
const ROUNDING: f64 = 1e-12 * 100.0;

fn ticks(rig: &mut Rig, count: u32, device: DVec3) -> TickRecord {
    let mut last = TickRecord::default();
    for _ in 0..count {
        rig.simulation.step();
        last = rig.tick_at(device);
        assert_eq!(rig.violations(), 0);
    }
    rig.simulation.step();
    last
}

#[test]
fn with_a_gain_the_probe_goes_farther_than_the_device_from_where_both_are() {
    let mut rig = Rig::new(DIMENSIONS, START);
    ticks(&mut rig, 5, START);
    let settings = Settings {
        gain: 3.0,
        ..Settings::default()
    };
    rig.simulation.set_settings(settings).unwrap();
    // the change itself moves nothing
    assert!(ticks(&mut rig, 5, START).proxy.distance(START) < ROUNDING);
    let moved = ticks(&mut rig, 5, START + DVec3::X * 2.0);
    assert!(
        moved.proxy.distance(START + DVec3::X * 6.0) < ROUNDING,
        "{moved:?}"
    );
    for gain in [f64::NAN, 0.0, -1.0, 11.0] {
        let bad = Settings { gain, ..settings };
        assert!(rig.simulation.set_settings(bad).is_err(), "{gain}");
    }
}

#[test]
fn a_stiff_spring_is_softened_by_as_much_as_the_gain_stretches_it() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let stiffest = crate::common::limits().max_stiffness;
    let settings = Settings {
        gain: 4.0,
        stiffness: stiffest.min(10.0),
        ..Settings::default()
    };
    let held = rig.simulation.set_settings(settings).unwrap();
    assert!(held.stiffness * 4.0 <= stiffest + ROUNDING, "{held:?}");
}

#[test]
fn with_the_clutch_the_device_moves_alone_and_goes_on_from_there() {
    let mut rig = Rig::new(DIMENSIONS, START);
    ticks(&mut rig, 5, START);
    rig.simulation.clutch(true);
    let away = START + DVec3::new(-9.0, 4.0, 7.0);
    let still = ticks(&mut rig, 10, away);
    assert!(still.proxy.distance(START) < ROUNDING, "{still:?}");
    assert!(still.device.distance(START) < ROUNDING);
    rig.simulation.clutch(false);
    ticks(&mut rig, 5, away);
    let moved = ticks(&mut rig, 5, away + DVec3::Y * 3.0);
    assert!(
        moved.proxy.distance(START + DVec3::Y * 3.0) < ROUNDING,
        "{moved:?}"
    );
}

#[test]
fn the_clutch_takes_the_force_of_a_contact_away_and_gives_it_none_back() {
    let mut rig = Rig::new(DIMENSIONS, START);
    let floor = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::new(48, 48, 20));
    rig.simulation.add_segment(floor, OBSTACLE, true).unwrap();
    ticks(&mut rig, 30, START);
    let pressed = START - DVec3::Z * 12.0;
    let contact = ticks(&mut rig, 100, pressed);
    assert!(contact.contact && contact.force.z > 0.1, "{contact:?}");
    rig.simulation.clutch(true);
    // however far the device goes meanwhile
    let free = ticks(&mut rig, 100, pressed - DVec3::Z * 40.0);
    assert!(free.force.length() < 0.05, "{free:?}");
    rig.simulation.clutch(false);
    let again = ticks(&mut rig, 100, pressed - DVec3::Z * 40.0);
    assert!(again.force.length() < 0.05, "{again:?}");
}
