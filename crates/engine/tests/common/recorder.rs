//! A rig under random changes whose ticks and commands are recorded, to be replayed.

use glam::{DAffine3, DMat3, DVec3, UVec3};
use palpate_engine::feel::Feel;
use palpate_engine::handover::HandTarget;
use palpate_engine::recording::Recording;
use palpate_engine::replay::{ReplayEnd, Replayed, replay};
use palpate_engine::settings::Settings;
use palpate_engine::tape::Tape;
use palpate_haptics::smooth::Smoothing;
use palpate_volume::edit::SegmentId;

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
        rig.simulation.switch_mask_shares(true);
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
            self.change_something();
            if tick % pass == 0 {
                self.rig.simulation.step();
                // shares of masks come now and then
                if self.random.below(40) == 0 {
                    self.rig.shares.step();
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

    fn change_something(&mut self) {
        let Self { rig, random, .. } = self;
        let id = self.ids[random.below(2) as usize];
        let simulation = &mut rig.simulation;
        match random.below(60) {
            0 if random.below(2) == 0 => {
                let low = random.between(50.0, 700.0);
                rig.set_threshold(id, (low, low + random.between(100.0, 2000.0)));
            }
            0 => {
                let other = sponge(DIMENSIONS, random.below(99), 2 + random.below(9));
                simulation.replace_segment(id, other, None).unwrap();
            }
            1..=9 => {
                let solid = random.below(2) == 0;
                let region = random.voxel_box(DIMENSIONS, 40);
                simulation.fill_box(id, &region, solid).unwrap();
            }
            10..=14 => _ = simulation.undo().unwrap(),
            15 => _ = simulation.redo().unwrap(),
            16 => simulation.set_touchable(id, random.below(2) == 0).unwrap(),
            17 => _ = simulation.place(random.point(0.0, 48.0), 0, random.below(2) == 0),
            18 => {
                let angle = random.between(-3.0, 3.0);
                simulation.turn(DMat3::from_rotation_z(angle));
            }
            19 => {
                let friction = random.between(0.0, 0.8);
                let radius = random.between(-2.0, 2.0).max(0.0);
                let settings = Settings {
                    stiffness: random.between(0.1, 0.9),
                    damping: random.between(0.0, 0.01),
                    friction_static: friction,
                    friction_kinetic: friction * random.share(),
                    smoothing: Smoothing::ALL[random.below(3) as usize],
                    probe_radius: radius,
                    ..Settings::default()
                };
                simulation.set_settings(settings).unwrap();
            }
            20 => {
                let feel = Feel {
                    stiffness: Some(random.between(0.1, 0.9)),
                    friction_static: Some(random.share()),
                    friction_kinetic: Some(0.0),
                };
                simulation.set_feel(id, feel).unwrap();
            }
            22 => {
                let turn = DMat3::from_rotation_z(random.between(-0.4, 0.4));
                let pose = DAffine3::from_mat3_translation(turn, random.point(-4.0, 4.0));
                simulation.move_segment(id, pose).unwrap();
            }
            21 => rig.hand.write(HandTarget {
                point: random.point(0.0, 48.0),
                number: random.below(5),
            }),
            _ => {}
        }
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
