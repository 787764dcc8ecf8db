//! Needles in a session: what is felt in layers, what is an obstacle meanwhile, and that all of it
//! can be replayed.

use crate::common::*;
use glam::{DVec3, IVec3, UVec3};
use palpate_engine::replay::{Recording, ReplayEnd, Tape, TapeColumns, replay};
use palpate_engine::scenario::drive::{Drive, Phase, Sample};
use palpate_engine::scenario::needle::{NeedleLayer, NeedleRun, drive_needle};
use palpate_engine::servo::TickRecord;
use palpate_engine::session::{Reference, SessionConfig};
use palpate_haptics::needle::events::EventKind::{self, Punctured, Stopped, Withdrawn};
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::tool::ToolError;
use palpate_volume::edit::SegmentId;
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

fn straight() -> Drive {
    Drive {
        rest_secs: 0.5,
        ..Drive::between(DVec3::new(20.3, 20.4, 84.0), DVec3::new(20.3, 20.4, 2.0))
    }
}

fn run(drive: &Drive) -> NeedleRun {
    let values = intensities(DIMENSIONS);
    drive_needle(&grid(DIMENSIONS), values, &layers(), drive).unwrap()
}

fn way_in(run: &NeedleRun) -> Vec<Sample> {
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
    let near = |sample: &&Sample| (0.0..0.1).contains(&(event.time - sample.time));
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

/// A threshold takes all soft tissue, and bone, where label maps take each apart.
#[test]
fn segments_within_segments_give_the_same_events_as_segments_beside_them() {
    let mut layers = layers();
    layers[0].segment = box_segment(
        DIMENSIONS,
        IVec3::ZERO.with_z(BORDERS[4]),
        IVec3::new(40, 40, BORDERS[0]),
    );
    let values = intensities(DIMENSIONS);
    let nested = drive_needle(&grid(DIMENSIONS), values, &layers, &straight()).unwrap();
    let beside = run(&straight());
    assert_eq!(kinds(&nested), kinds(&beside));
    for (one, other) in nested.samples.iter().zip(&beside.samples) {
        assert_eq!((one.force, one.tip), (other.force, other.tip));
    }
    assert_eq!(nested.violations, 0);
}

/// At steady speed, outside of events, no force is above one and a half times the median of its
/// neighbours.
#[test]
fn there_is_no_spike_outside_of_events() {
    for oblique in [0.0, 6.0] {
        let drive = Drive {
            target: straight().target + DVec3::new(oblique, 0.4 * oblique, 0.0),
            ..straight()
        };
        let run = run(&drive);
        assert!(run.events.len() >= 5, "{:?}", kinds(&run));
        for phase in [Phase::In, Phase::Out] {
            let samples: Vec<&Sample> = run
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
    let slow = run(&Drive {
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

fn needle() -> ToolSettings {
    ToolSettings {
        tissues: vec![Tissue::SKIN, Tissue::FAT, Tissue::LIVER],
        ..ToolSettings::new(
            ToolKind::Needle,
            0.5,
            [SKIN, FAT, LIVER].map(SegmentId).to_vec(),
        )
    }
}

/// A needle in the hand above the layers.
pub struct Hand {
    pub rig: Rig,
    device: DVec3,
    ticks: u64,
    recording: Recording,
}

pub const ABOVE: DVec3 = DVec3::new(20.3, 20.4, 84.0);

impl Hand {
    pub fn new() -> Self {
        let mut rig = Rig::new(DIMENSIONS, ABOVE);
        for layer in layers() {
            rig.simulation
                .add_segment(layer.segment, OBSTACLE, false)
                .unwrap();
        }
        rig.simulation.set_tool(Some(needle())).unwrap();
        rig.simulation.stroke(true).unwrap();
        Self {
            rig,
            device: ABOVE,
            ticks: 0,
            recording: Recording::default(),
        }
    }

    fn tick(&mut self, device: DVec3) -> TickRecord {
        self.device = device;
        self.ticks += 1;
        let record = self.rig.tick_at(device);
        if self.ticks.is_multiple_of(10) {
            self.rig.simulation.step();
        }
        self.recording.push(&record, 0);
        record
    }

    /// Straight to a point at a speed [mm/s].
    pub fn go(&mut self, to: DVec3, speed: f64) -> Vec<TickRecord> {
        let (from, way) = (self.device, to - self.device);
        let ticks = (way.length() / speed * 1000.0).round().max(1.0) as u32;
        let at = |tick: u32| from + way * f64::from(tick) / f64::from(ticks);
        (1..=ticks).map(|tick| self.tick(at(tick))).collect()
    }

    pub fn rest(&mut self, ticks: u32) -> TickRecord {
        let records = (0..ticks).map(|_| self.tick(self.device));
        records.collect::<Vec<_>>().last().copied().unwrap()
    }

    /// Begins a recording.
    pub fn record(&mut self) {
        self.recording = Recording::default();
        self.rig.simulation.begin_tape();
    }

    /// Ends the recording, which is computed again bit for bit.
    pub fn expect_equal_replay(&self) {
        let tape = self.rig.simulation.tape();
        let tape = tape.lock().unwrap().finish().unwrap();
        let read = Tape::try_from(&TapeColumns::from(&tape)).unwrap();
        let replayed = replay(&self.recording, &read).unwrap();
        assert_eq!(replayed.end, ReplayEnd::Whole);
        assert!(replayed.is_equal(), "{:?}", replayed.first_difference);
    }

    /// Whether a voxel of a layer on the needle's way stops the probe.
    fn is_hard(&self, z: i32) -> bool {
        self.rig.servo.solid().is_solid(IVec3::new(20, 20, z))
    }

    fn in_liver() -> Self {
        let mut hand = Self::new();
        hand.go(ABOVE.with_z(44.0), 20.0);
        hand
    }
}

#[test]
fn what_is_punctured_is_no_obstacle_until_the_needle_is_out_and_no_voxel_changes() {
    let mut hand = Hand::in_liver();
    // skin, fat, liver and bone
    assert_eq!(
        [78, 70, 50, 20].map(|z| hand.is_hard(z)),
        [false, false, false, true]
    );
    let proxy = hand.rest(20).proxy;
    assert!(proxy.z < 55.0 && proxy.z > 30.0, "{proxy}");
    let report = hand.rig.simulation.needle_report();
    assert_eq!(report.punctured, [SKIN, FAT, LIVER].map(SegmentId));
    assert!(report.forces.cutting > 0.5 && report.forces.friction > 0.0);
    assert!(report.place.unwrap().depth > 20.0);

    hand.go(ABOVE, 40.0);
    hand.rest(40);
    assert_eq!([78, 70, 50, 20].map(|z| hand.is_hard(z)), [true; 4]);
    let report = hand.rig.simulation.needle_report();
    assert!(report.punctured.is_empty() && report.place.is_none());
    for (id, layer) in (1..).map(SegmentId).zip(layers()) {
        let now = hand.rig.simulation.voxels().segment(id).unwrap();
        assert_eq!(now.count(), layer.segment.count());
    }
    // without the needle, the skin is as hard as ever
    hand.rig.simulation.stroke(false).unwrap();
    let pressed = hand.go(ABOVE.with_z(75.0), 40.0);
    let last = pressed.last().unwrap();
    assert!(last.proxy.z >= 80.0 && last.force.z > 4.5, "{last:?}");
    assert_eq!(hand.rig.violations(), 0);
}

/// Pulled aside and pushed down beside its line, with all that is around.
#[test]
fn a_push_at_another_angle_meets_the_tissue_beside_the_shaft_and_pops_through_nothing() {
    let mut hand = Hand::in_liver();
    hand.rest(50);
    let before = hand.rig.servo.needle().insertion().copied().unwrap();
    let mut last = hand.tick(hand.device);
    for record in hand.go(hand.device + DVec3::new(9.0, 0.0, -14.0), 30.0) {
        // the coupling's 1 N/mm over the hand's 0.03 mm and what the law lets grow by itself,
        // in any direction; the fall of a cut is free
        let grown = record.force.length() - last.force.length();
        assert!(grown <= 0.03 + 0.02 + 1e-9, "{grown}");
        assert!(record.proxy.z >= 30.0, "{record:?}");
        last = record;
    }
    let after = hand.rig.servo.needle().insertion().copied().unwrap();
    assert_eq!(after.line, before.line);
    assert_eq!(after.punctured, before.punctured);
    // pulled back to its line: skin, fat and liver hold it with 0.3 to 1 N/mm
    assert!(
        last.force.x < -9.0 * 0.25 && last.force.x > -9.0,
        "{last:?}"
    );
    let aside = after.line.aside_of(last.proxy).length();
    assert!(aside > 1.0 && aside < 7.0, "{aside}");

    // far down and aside: bone holds what the tissue does not
    for record in hand.go(DVec3::new(39.0, 39.0, -30.0), 200.0) {
        assert!(record.proxy.z >= 30.0 && record.force.is_finite());
    }
    assert_eq!(hand.rig.violations(), 0);
}

#[test]
fn a_needle_that_is_let_go_stays_in_until_it_is_drawn_out() {
    let mut hand = Hand::in_liver();
    hand.rig.simulation.stroke(false).unwrap();
    let held = hand.rest(40);
    assert!(held.force.z > 1.0 && !hand.is_hard(70));
    let back = hand.go(ABOVE, 40.0);
    assert!(back.iter().any(|record| record.force.z < -0.3));
    hand.rest(40);
    assert!(hand.is_hard(78) && hand.is_hard(70) && hand.is_hard(50));
    // it is not in the hand any more
    let pressed = hand.go(ABOVE.with_z(70.0), 40.0);
    assert!(pressed.last().unwrap().proxy.z >= 80.0);
}

#[test]
fn a_placement_takes_the_needle_out() {
    let mut hand = Hand::in_liver();
    let placed = hand.rig.simulation.place(ABOVE, 0, true).unwrap();
    assert_eq!(placed, ABOVE);
    // the device stays where it is and stands for the new place now
    let after = hand.rest(60);
    assert_eq!((after.proxy, after.force), (ABOVE, DVec3::ZERO));
    assert!(hand.is_hard(78) && hand.is_hard(70) && hand.is_hard(50));
    assert!(hand.rig.simulation.needle_report().punctured.is_empty());
}

#[test]
fn at_rest_in_tissue_probe_and_force_are_constant_to_the_bit_in_the_end() {
    let mut hand = Hand::in_liver();
    // relaxation of 2 s, to a ten-thousandth of a millimetre
    let rest = hand.rest(25_000);
    for _ in 0..500 {
        let record = hand.tick(hand.device);
        assert_eq!((record.proxy, record.force), (rest.proxy, rest.force));
    }
}

/// From before the needle is in, and from a state with a needle in.
#[test]
fn a_recorded_needle_is_computed_again_bit_for_bit() {
    for begins_inside in [false, true] {
        let mut hand = if begins_inside {
            Hand::in_liver()
        } else {
            Hand::new()
        };
        hand.rest(30);
        hand.record();
        hand.go(DVec3::new(22.0, 19.0, 36.0), 30.0);
        hand.go(DVec3::new(25.0, 20.0, 50.0), 60.0);
        hand.go(ABOVE, 60.0);
        hand.rest(50);
        hand.go(DVec3::new(10.0, 25.0, 40.0), 60.0);
        hand.expect_equal_replay();
        assert!(hand.rig.servo.needle().events().count() >= 5);
    }
}

/// A mouse: mass, a hand that pulls, a tick of delay, the whole session around it.
#[test]
fn a_simulated_device_pushes_the_needle_in_comes_to_rest_and_draws_it_out() {
    let mut segments = Vec::new();
    for layer in layers() {
        segments.push((layer.segment, OBSTACLE));
    }
    let none = box_segment(DIMENSIONS, IVec3::ZERO, IVec3::ZERO);
    let session = started(SessionConfig {
        segments,
        ..offline(DIMENSIONS, none, simulated(), Reference::Scene)
    });
    session.place(ABOVE).unwrap();
    session.set_tool(Some(needle())).unwrap();
    session.stroke(true).unwrap();
    // the hand's own spring is 0.3 N/mm: it has to go far to press with 2 N
    session.hand(ABOVE.with_z(58.0)).unwrap();
    session.run(3.0).unwrap();
    session.start_recording().unwrap();
    session.run(0.5).unwrap();
    let rest = session.stop_recording().unwrap();
    let report = session.needle_report().unwrap();
    assert!(report.punctured.contains(&SegmentId(SKIN)), "{report:?}");
    let force = |row: usize| rest.force[row].length();
    let (low, high) = (0..rest.len()).fold((f64::INFINITY, 0.0_f64), |(low, high), row| {
        (low.min(force(row)), high.max(force(row)))
    });
    // it creeps by the tissue's relaxation and does not buzz
    assert!(high > 0.2 && high - low < 0.05, "{low} to {high}");

    session.hand(ABOVE).unwrap();
    session.run(3.0).unwrap();
    let report = session.needle_report().unwrap();
    assert!(report.place.is_none() && report.punctured.is_empty());
    assert_eq!(report.events.last().unwrap().kind, Withdrawn);
    let frame = session.frame();
    assert_eq!(frame.safety.violations, 0);
    assert_eq!((frame.force, frame.pending), (DVec3::ZERO, 0));
}

#[test]
fn a_needle_that_does_not_know_its_tissues_is_refused() {
    let mut hand = Hand::new();
    let mut two = needle();
    two.tissues.pop();
    let error = hand.rig.simulation.set_tool(Some(two)).unwrap_err();
    let expected = ToolError::Tissues {
        tissues: 2,
        segments: 3,
    };
    assert_eq!(error.to_string(), expected.to_string());
    let mut wrong = needle();
    wrong.tissues[1].puncture = f64::NAN;
    assert!(hand.rig.simulation.set_tool(Some(wrong)).is_err());
}

#[test]
fn a_drive_that_is_none_is_refused() {
    for bad in [
        Drive {
            speed: 0.0,
            ..straight()
        },
        Drive {
            target: straight().start,
            ..straight()
        },
        Drive {
            force_limit: f64::NAN,
            ..straight()
        },
        Drive {
            rest_secs: -1.0,
            ..straight()
        },
    ] {
        let values = intensities(DIMENSIONS);
        assert!(drive_needle(&grid(DIMENSIONS), values, &layers(), &bad).is_err());
    }
}
