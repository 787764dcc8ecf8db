//! A rig under random changes whose ticks and commands are recorded, to be replayed.

use glam::{DVec3, UVec3};
use palpate_engine::replay::{Recording, ReplayEnd, Replayed, Tape, replay};
use palpate_volume::edit::SegmentId;

use super::changes::change_something;
use super::*;

const DIMENSIONS: UVec3 = UVec3::splat(48);

/// Servo and simulation under random changes, and what of it was recorded.
pub struct Recorder {
    pub rig: Rig,
    pub ids: [SegmentId; 2],
    pub device: DVec3,
    pub random: Random,
    pub recording: Recording,
}

impl Recorder {
    pub fn new(seed: u128) -> Self {
        let start = DVec3::splat(-5.0);
        let mut rig = Rig::of_scan(waves(DIMENSIONS), start);
        rig.simulation.switch_mask_fractions(true);
        let ids = [3, 8].map(|one_in| {
            let segment = sponge(DIMENSIONS, one_in, one_in);
            rig.simulation
                .add_segment(segment, OBSTACLE, false)
                .unwrap()
        });
        rig.tick_at(start);
        rig.tick_at(start);
        Self {
            rig,
            ids,
            device: start,
            random: Random::new(seed),
            recording: Recording::default(),
        }
    }

    /// Ticks with random changes; the simulation takes its pass every `pass` ticks.
    pub fn run(&mut self, ticks: u32, pass: u32) {
        for tick in 0..ticks {
            change_something(&mut self.rig, &self.ids, &mut self.random);
            if tick % pass == 0 {
                self.rig.simulation.step();
                // occupancy fractions of masks come now and then
                if self.random.below(40) == 0 {
                    self.rig.fractions.step();
                }
            }
            self.tick();
        }
    }

    pub fn tick(&mut self) {
        let reach = if self.random.below(20) == 0 {
            12.0
        } else {
            0.7
        };
        self.device += self.random.point(-reach, reach);
        self.device = self.device.clamp(DVec3::splat(-4.0), DVec3::splat(52.0));
        // now and then the device was not read
        let record = if self.random.below(15) == 0 {
            self.rig.now += 1e-3 * self.random.share();
            self.rig.servo.step(self.rig.now);
            self.rig.records.pop().unwrap()
        } else {
            self.rig.tick_at(self.device)
        };
        self.recording.push(&record, 0);
    }

    pub fn begin(&mut self) {
        self.rig.simulation.begin_tape();
    }

    pub fn finish(self) -> (Recording, Tape) {
        let tape = self.rig.simulation.tape();
        let tape = tape.lock().unwrap().finish().unwrap();
        (self.recording, tape)
    }
}

pub fn recorded(seed: u128, ticks: u32, pass: u32) -> (Recording, Tape) {
    let mut recorder = Recorder::new(seed);
    recorder.begin();
    recorder.run(ticks, pass);
    recorder.finish()
}

pub fn replayed((recording, tape): &(Recording, Tape)) -> Replayed {
    replay(recording, tape).unwrap()
}

pub fn assert_equal(replayed: &Replayed) {
    assert_eq!(replayed.first_difference, None);
    assert!(replayed.is_equal());
    assert_eq!(replayed.recorded_hash, replayed.replayed_hash);
    assert_eq!(replayed.end, ReplayEnd::Whole);
}
