//! Needles in a session: what is felt in layers, what is an obstacle meanwhile, and that all of it
//! can be replayed.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may fail a test, as the tests themselves"
)]

mod common;

use common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::needle_scenario::{
    NeedleDrive, NeedleLayer, NeedleRun, NeedleSample, Phase, drive_needle,
};
use palpate_haptics::needle::events::EventKind::{self, Punctured, Stopped, Withdrawn};
use palpate_volume::tissue::Tissue;

const DIMENSIONS: UVec3 = UVec3::new(40, 40, 90);
const SKIN: u8 = 1;
const FAT: u8 = 2;
const LIVER: u8 = 3;
const BONE: u8 = 4;
/// Where each layer ends from above [mm]: skin from 80 down, bone down to 10.
const BORDERS: [i32; 5] = [80, 76, 62, 30, 10];

fn layers() -> Vec<NeedleLayer> {
    let tissues = [
        Some(Tissue::SKIN),
        Some(Tissue::FAT),
        Some(Tissue::LIVER),
        None,
    ];
    let layer = |(place, tissue): (usize, Option<Tissue>)| NeedleLayer {
        segment: box_segment(
            DIMENSIONS,
            IVec3::new(0, 0, BORDERS[place + 1]),
            IVec3::new(40, 40, BORDERS[place]),
        ),
        tissue,
    };
    tissues.into_iter().enumerate().map(layer).collect()
}

fn straight() -> NeedleDrive {
    NeedleDrive {
        rest_secs: 0.5,
        ..NeedleDrive::between(DVec3::new(20.3, 20.4, 84.0), DVec3::new(20.3, 20.4, 2.0))
    }
}

fn run(drive: &NeedleDrive) -> NeedleRun {
    let values = intensities(DIMENSIONS);
    drive_needle(&grid(DIMENSIONS), values, &layers(), drive).unwrap()
}

fn way_in(run: &NeedleRun) -> Vec<NeedleSample> {
    let samples = run.samples.iter().copied();
    samples.filter(|sample| sample.phase == Phase::In).collect()
}

fn kinds(run: &NeedleRun) -> Vec<(EventKind, u8)> {
    let events = run.events.iter();
    events.map(|event| (event.kind, event.segment)).collect()
}

/// Largest force of the way in within so many ticks before an event.
fn peak_before(run: &NeedleRun, kind: EventKind, segment: u8) -> f64 {
    let mut events = run.events.iter();
    let event = events
        .find(|event| (event.kind, event.segment) == (kind, segment))
        .unwrap();
    let near = |sample: &&NeedleSample| (0.0..0.1).contains(&(event.time - sample.time));
    let near = run.samples.iter().filter(near);
    near.map(|sample| sample.force).fold(0.0, f64::max)
}

#[test]
fn the_force_rises_at_the_skin_falls_at_the_puncture_rises_at_the_liver_and_ends_at_the_bone() {
    let run = run(&straight());
    let expected = [
        (Punctured, SKIN),
        (Punctured, FAT),
        (Punctured, LIVER),
        (Stopped, BONE),
        (Withdrawn, 0),
    ];
    assert_eq!(kinds(&run), expected);
    assert_eq!(run.violations, 0);

    // the peaks are the puncture forces, with the friction of what is in by then
    let skin = peak_before(&run, Punctured, SKIN);
    assert!((skin - Tissue::SKIN.puncture).abs() < 0.02, "{skin}");
    let liver = peak_before(&run, Punctured, LIVER);
    let friction = liver - Tissue::LIVER.puncture;
    assert!((0.0..0.4).contains(&friction), "{liver}");
    // between them the needle meets less than half of either
    let way = way_in(&run);
    let lowest = |from: EventKind, of: u8, until: u8| {
        let time = |segment: u8| {
            let mut events = run.events.iter();
            events
                .find(|event| (event.kind, event.segment) == (from, segment))
                .unwrap()
                .time
        };
        let between = way
            .iter()
            .filter(|sample| (time(of)..time(until)).contains(&sample.time));
        between.map(|sample| sample.force).fold(9.0, f64::min)
    };
    assert!(lowest(Punctured, SKIN, LIVER) < 0.5 * liver);

    // the drive ends by its force, and the tip before the bone
    let wall = run.wall.unwrap();
    assert!((wall - 54.0).abs() < 1e-9, "{wall}");
    let last = way.last().unwrap();
    assert!(last.force >= 6.0 && last.force < 6.01 && last.travel > wall);
    for sample in &run.samples {
        assert!(sample.tip <= wall && sample.probe <= wall, "{sample:?}");
        assert!(sample.force <= 6.01 && sample.across < 1e-9, "{sample:?}");
    }
}

/// At steady speed, outside of events, no force is above one and a half times the median of its
/// neighbours.
#[test]
fn there_is_no_spike_outside_of_events() {
    for oblique in [0.0, 6.0] {
        let drive = NeedleDrive {
            target: straight().target + DVec3::new(oblique, 0.4 * oblique, 0.0),
            ..straight()
        };
        let run = run(&drive);
        assert!(run.events.len() >= 5, "{:?}", kinds(&run));
        for phase in [Phase::In, Phase::Out] {
            let samples: Vec<&NeedleSample> = run
                .samples
                .iter()
                .filter(|sample| sample.phase == phase)
                .collect();
            for window in samples.windows(21) {
                let middle = window[10];
                let (from, to) = (window[0].time, window[20].time);
                if run
                    .events
                    .iter()
                    .any(|event| (from..=to).contains(&event.time))
                {
                    continue;
                }
                let mut forces: Vec<f64> = window.iter().map(|sample| sample.force.abs()).collect();
                forces.sort_by(f64::total_cmp);
                // where it passes through zero a millinewton is no spike
                let most = 1.5 * forces[10] + 1e-3;
                let force = middle.force.abs();
                assert!(force <= most, "{force} at {} of {most}", middle.time);
            }
        }
    }
}

#[test]
fn half_the_speed_gives_the_same_curve() {
    let fast = run(&straight());
    let slow = run(&NeedleDrive {
        speed: 2.5,
        ..straight()
    });
    assert_eq!(kinds(&fast), kinds(&slow));
    let slow = way_in(&slow);
    let mut apart = 0;
    for sample in way_in(&fast) {
        let same = slow.partition_point(|other| other.travel < sample.travel - 1e-9);
        let same = slow[same.min(slow.len() - 1)];
        assert!((same.travel - sample.travel).abs() < 2.6e-3);
        // a hundredth of a newton: the way of a tick, what a tip relaxes meanwhile
        apart += i32::from((same.force - sample.force).abs() > 0.02);
    }
    // some ticks around each puncture, of 10 000: the probe follows a pass later
    assert!(apart < 60, "{apart}");
}
