//! The servo's tick where its neighbours misbehave.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use crate::common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::servo::{
    Channels, HandTarget, Mapping, ServoCommand, ServoLoop, ServoStart, ServoStatus, Shared,
};
use palpate_engine::touch::{Garbage, Settings, TouchFeels, Touchable};

const DIMENSIONS: UVec3 = UVec3::splat(40);

/// The device presses 2 mm into a block whose front face is the plane y = 20 mm.
fn pressing() -> (Rig, DVec3) {
    let free = DVec3::new(20.0, 15.0, 20.0);
    let mut rig = Rig::new(DIMENSIONS, free);
    let block = box_segment(DIMENSIONS, IVec3::new(5, 20, 5), IVec3::new(35, 35, 35));
    rig.simulation.add_segment(block, OBSTACLE, false).unwrap();
    rig.tick_at(free);
    (rig, free.with_y(22.0))
}

#[test]
fn a_reading_that_is_too_old_gives_no_force_and_leaves_the_probe() {
    let (mut rig, pressed) = pressing();
    assert!(rig.tick_at(pressed).contact);
    // the same reading for 30 ms
    let mut contacts = Vec::new();
    for _ in 0..30 {
        rig.now += 1e-3;
        rig.servo.step(rig.now);
        contacts.push(rig.records.pop().unwrap());
    }
    let held = contacts.iter().take_while(|record| record.contact).count();
    // 10 ms, one tick more or less by rounding
    assert!((8..=10).contains(&held), "{held}");
    let last = contacts.last().unwrap();
    assert_eq!(last.force, DVec3::ZERO);
    assert!(last.proxy.y < 20.0);
}

#[test]
fn readings_that_are_no_point_give_no_force_and_leave_the_probe() {
    let (mut rig, pressed) = pressing();
    let before = rig.tick_at(pressed).proxy;
    for nonsense in [DVec3::NAN, DVec3::INFINITY, DVec3::splat(1e300)] {
        let record = rig.tick_at(nonsense);
        assert_eq!((record.force, record.contact), (DVec3::ZERO, false));
        assert_eq!(record.proxy, before);
    }
    assert!(rig.tick_at(pressed).contact);
    assert_eq!(rig.violations(), 0);
}

#[test]
fn before_the_first_reading_there_is_no_force() {
    let start = DVec3::splat(7.0);
    let mut rig = Rig::new(DIMENSIONS, start);
    rig.servo.step(0.0);
    let record = rig.records.pop().unwrap();
    assert_eq!(record.force, DVec3::ZERO);
    assert_eq!((record.proxy, record.device), (start, start));
}

#[test]
fn records_that_nobody_takes_are_lost_and_counted_and_the_ticks_go_on() {
    let (mut rig, pressed) = pressing();
    for _ in 0..10_000 {
        rig.read_at(pressed);
        rig.servo.step(rig.now);
        rig.now += 1e-3;
    }
    let lost = rig.shared.counters.lost_records.load(Ordering::Relaxed);
    assert!(lost > 1_000, "{lost}");
    let mut kept = 0;
    while rig.records.pop().is_ok() {
        kept += 1;
    }
    assert_eq!(kept + lost, 10_000);
}

/// A target that was on its way when the probe was placed does not pull it back.
#[test]
fn hand_targets_from_before_a_placement_are_forgotten() {
    let (mut rig, pressed) = pressing();
    let at = |number: u64| HandTarget {
        point: DVec3::splat(30.0),
        number,
    };
    rig.hand.write(at(4));
    let point = DVec3::new(2.0, 3.0, 4.0);
    assert_eq!(rig.simulation.place(point, 4, true).unwrap(), point);
    assert_eq!(rig.tick_at(pressed).hand, point);
    rig.hand.write(at(5));
    assert_eq!(rig.tick_at(pressed).hand, DVec3::splat(30.0));
}

/// A status goes over every tick and a command waits in a ring of 4096: what is long and rare has
/// ways of its own.
#[test]
fn what_goes_over_every_tick_is_small() {
    assert!(
        size_of::<ServoStatus>() <= 640,
        "{}",
        size_of::<ServoStatus>()
    );
    assert!(
        size_of::<ServoCommand>() <= 256,
        "{}",
        size_of::<ServoCommand>()
    );
}

#[test]
fn the_needle_is_told_of_while_it_is_felt_and_once_when_it_is_not_any_more() {
    let Channels {
        servo, simulation, ..
    } = Channels::new(DVec3::ZERO);
    let start = ServoStart {
        grid: grid(DIMENSIONS),
        touchable: Touchable::new(&grid(DIMENSIONS), Vec::new(), 0.0).unwrap(),
        mapping: Mapping::IDENTITY,
        probe: DVec3::splat(20.0),
        settings: Settings::default(),
        feels: TouchFeels::default(),
    };
    let mut servo = ServoLoop::new(start, servo, Arc::new(Shared::default()));
    let (mut needle, mut inbox) = (simulation.needle, simulation.inbox);
    let mut garbage = simulation.garbage;
    let mut told = |ticks: u32, servo: &mut ServoLoop| {
        let updates = (0..ticks).filter(|_| {
            servo.step(0.0);
            needle.update()
        });
        (updates.count(), needle.output_buffer().on)
    };
    // what may have been before counts once
    assert_eq!(told(1, &mut servo), (1, false));
    assert_eq!(told(50, &mut servo), (0, false));
    let command = |on| ServoCommand::Needle(on, Box::default());
    inbox.push(command(true)).unwrap();
    assert_eq!(told(50, &mut servo), (50, true));
    inbox.push(command(false)).unwrap();
    assert_eq!(told(50, &mut servo), (1, false));
    // the tissues come back to be freed
    assert!(matches!(garbage.pop(), Ok(Garbage::Tissues(_))));
    assert!(matches!(garbage.pop(), Ok(Garbage::Tissues(_))));
    assert!(garbage.pop().is_err());
}
