//! One tick of the servo: from where the device is to the force that it feels.
//!
//! The tick is closed: it neither allocates nor frees, locks, logs, waits or panics, and its work
//! is bounded. Frames: scene mm (LPS) unless a name says otherwise; N, s.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;
use palpate_haptics::local_force::LocalForce;
use palpate_haptics::placement::nearest_free;
use palpate_haptics::proxy::Proxy;
use palpate_haptics::scene::TouchScene;
use palpate_haptics::tick::{TickInput, TickOutput, TickState, tick};
use palpate_volume::bits::Bits;
use palpate_volume::grid::Grid;

use crate::device_loop::WATCHDOG_SECS;
use crate::feel::Feel;
use crate::handover::{
    DeviceSample, ForceCommand, HandTarget, ServoChannels, ServoCommand, ServoStatus, TickRecord,
};
use crate::mapping::Mapping;
use crate::probe::Probe;
use crate::settings::Settings;
use crate::shared::Shared;
use crate::touch_occupancy::TouchOccupancy;

/// Commands obeyed per tick, at most, and one change of the occupancy.
const MAX_COMMANDS_PER_TICK: usize = 16;

/// How far around a placement's point a free voxel is searched [voxels]. The simulation has
/// found one; this is for changes that are still on their way.
const PLACE_REACH: i32 = 3;

/// What a servo begins with.
#[derive(Debug)]
pub struct ServoStart {
    /// Where the scan stands.
    pub grid: Grid,
    /// What is solid.
    pub bits: Bits,
    /// `scene_from_device`.
    pub mapping: Mapping,
    /// Where the probe is, in a free voxel.
    pub probe: DVec3,
    /// Settings that the device bears.
    pub settings: Settings,
    /// How each segment feels, by its number.
    pub feels: [Feel; 256],
}

/// The state of the servo thread.
#[derive(Debug)]
pub struct ServoLoop {
    grid: Grid,
    state: TickState,
    occupancy: TouchOccupancy,
    mapping: Mapping,
    settings: Settings,
    /// How each segment feels, by its number.
    feels: [Feel; 256],
    hand: DVec3,
    /// Hand targets up to this number are older than the last placement.
    forgotten_hand: u64,
    ends: Ends,
    received: u64,
    refused_places: u64,
    tick: u64,
    shared: Arc<Shared>,
}

/// The servo's channels without the garbage ring, which the occupancy fills.
#[derive(Debug)]
struct Ends {
    samples: triple_buffer::Output<DeviceSample>,
    forces: triple_buffer::Input<ForceCommand>,
    hand: triple_buffer::Output<HandTarget>,
    inbox: rtrb::Consumer<ServoCommand>,
    status: triple_buffer::Input<ServoStatus>,
    records: rtrb::Producer<TickRecord>,
}

impl ServoLoop {
    /// A servo at its start.
    ///
    /// # Panics
    /// Where the probe's start is not a point: whoever starts a session has checked it.
    #[must_use]
    pub fn new(start: ServoStart, channels: ServoChannels, shared: Arc<Shared>) -> Self {
        let ServoChannels {
            samples,
            forces,
            hand,
            inbox,
            garbage,
            status,
            records,
        } = channels;
        let probe_in_grid = start.grid.grid_from_patient().transform_point3(start.probe);
        let proxy = Proxy::at(probe_in_grid).expect("the probe starts at a finite point");
        Self {
            grid: start.grid,
            state: TickState { proxy },
            occupancy: TouchOccupancy::new(start.bits, garbage),
            mapping: start.mapping,
            settings: start.settings,
            feels: start.feels,
            hand: start.probe,
            forgotten_hand: 0,
            ends: Ends {
                samples,
                forces,
                hand,
                inbox,
                status,
                records,
            },
            received: 0,
            refused_places: 0,
            tick: 0,
            shared,
        }
    }

    /// What is solid for the probe now.
    #[must_use]
    pub fn solid(&self) -> &Bits {
        self.occupancy.bits()
    }

    /// One tick at `now` [s].
    pub fn step(&mut self, now: f64) {
        let sample = *self.ends.samples.read();
        self.follow_hand();
        self.retry_held_changes();
        self.obey(&sample);

        let input = self.input(&sample, now);
        let output = self.touch(&input);

        self.publish_force(&sample, &output, now);
        self.publish_status(&sample, &output);
        self.record(&sample, &output, now);
        self.tick += 1;
    }

    fn follow_hand(&mut self) {
        let target = *self.ends.hand.read();
        if target.number > self.forgotten_hand {
            self.hand = target.point;
        }
    }

    fn retry_held_changes(&mut self) {
        let mut probe = Probe {
            grid: &self.grid,
            proxy: &mut self.state.proxy,
        };
        self.occupancy.retry(&mut probe);
    }

    /// Obeys the simulation, in its order, as far as one tick allows.
    fn obey(&mut self, sample: &DeviceSample) {
        for _ in 0..MAX_COMMANDS_PER_TICK {
            match self.ends.inbox.peek() {
                Ok(ServoCommand::Root { .. } | ServoCommand::Bricks(_)) => {
                    return self.follow_changes();
                }
                // the device must have been read once, so that it can be brought along
                Ok(ServoCommand::Place { .. }) if sample.number == 0 => return,
                Ok(_) => self.obey_next(sample),
                Err(_) => return,
            }
        }
    }

    /// Takes the change that comes next, where there is room for what it replaces.
    fn follow_changes(&mut self) {
        if !self.occupancy.has_room() {
            return;
        }
        let mut probe = Probe {
            grid: &self.grid,
            proxy: &mut self.state.proxy,
        };
        match self.ends.inbox.pop() {
            Ok(ServoCommand::Root { sequence, bits }) => {
                self.received = sequence;
                self.occupancy.take_root(sequence, bits, &mut probe);
            }
            Ok(ServoCommand::Bricks(change)) => {
                self.received = change.sequence;
                self.occupancy.take_bricks(change, &mut probe);
            }
            // whoever calls has looked
            Ok(_) | Err(_) => {}
        }
    }

    /// Obeys a command that changes no occupancy.
    fn obey_next(&mut self, sample: &DeviceSample) {
        let device = sample.state.position;
        match self.ends.inbox.pop() {
            Ok(ServoCommand::Place {
                point,
                hand,
                device_too,
            }) => {
                self.forgotten_hand = hand;
                self.place(point, device_too.then_some(device));
            }
            Ok(ServoCommand::Turn(rotation)) => self.mapping.turn(device, rotation),
            Ok(ServoCommand::Settings(settings)) => self.settings = settings,
            Ok(ServoCommand::Feel(id, feel)) => self.feels[usize::from(id.0)] = feel,
            // changes of occupancy are taken elsewhere
            Ok(ServoCommand::Root { .. } | ServoCommand::Bricks(_)) | Err(_) => {}
        }
    }

    /// Brings the probe to a free point, and the device there by moving the mapping.
    fn place(&mut self, point: DVec3, device: Option<DVec3>) {
        let point_in_grid = self.grid.grid_from_patient().transform_point3(point);
        let bits = self.occupancy.bits();
        let Some(proxy) = nearest_free(bits, &self.grid, point_in_grid, PLACE_REACH) else {
            self.refused_places += 1;
            return;
        };
        self.state.proxy = proxy;
        let placed = self
            .grid
            .patient_from_grid()
            .transform_point3(proxy.point());
        self.hand = placed;
        if let Some(device) = device {
            self.mapping.place(device, placed);
        }
    }

    /// What the tick is given; a device that was not read in time has no position.
    fn input(&self, sample: &DeviceSample, now: f64) -> TickInput {
        let known = sample.number > 0 && now - sample.time <= WATCHDOG_SECS;
        let device = self.device_in_scene(sample);
        TickInput {
            device_in_scene: if known { device } else { DVec3::NAN },
            velocity_in_scene: self.mapping.velocity_to_scene(sample.state.velocity),
            coupling: self.settings.coupling(),
        }
    }

    /// Where the device is; until it was read, where the hand is.
    fn device_in_scene(&self, sample: &DeviceSample) -> DVec3 {
        if sample.number == 0 {
            return self.hand;
        }
        self.mapping.point_to_scene(sample.state.position)
    }

    fn touch(&mut self, input: &TickInput) -> TickOutput {
        let scene = TouchScene::of_world(self.occupancy.bits(), &self.grid);
        let output = tick(&scene, &self.settings.model, input, &mut self.state);
        if output.violation {
            self.shared.counters.violations.fetch_add(1, Relaxed);
        }
        output
    }

    fn publish_force(&mut self, sample: &DeviceSample, output: &TickOutput, now: f64) {
        self.ends.forces.write(ForceCommand {
            time: now,
            tick: self.tick + 1,
            law: self.law(sample, output),
            hand_in_device: self.mapping.point_to_device(self.hand),
            max_force: self.settings.force_limit,
        });
    }

    /// The contact as the device can follow it.
    fn law(&self, sample: &DeviceSample, output: &TickOutput) -> LocalForce {
        let turned = |vector| self.mapping.force_to_device(vector);
        if output.spring == DVec3::ZERO {
            return LocalForce::held(turned(output.force));
        }
        LocalForce {
            device: sample.state.position,
            spring: turned(output.spring),
            normal: turned(output.normal),
            coupling: output.coupling,
            sticks: output.sticks,
            scale: self.mapping.scale,
            held: DVec3::ZERO,
        }
    }

    fn publish_status(&mut self, sample: &DeviceSample, output: &TickOutput) {
        self.ends.status.write(ServoStatus {
            received: self.received,
            held_root: self.occupancy.held_root(),
            held_edits: self.occupancy.held_edits(),
            skipped: self.occupancy.skipped(),
            refused_places: self.refused_places,
            device: self.device_in_scene(sample),
            proxy: output.proxy_in_scene,
            contact: output.contact,
        });
    }

    fn record(&mut self, sample: &DeviceSample, output: &TickOutput, now: f64) {
        let recorded = self.ends.records.push(TickRecord {
            tick: self.tick,
            time: now,
            device: self.device_in_scene(sample),
            hand: self.hand,
            proxy: output.proxy_in_scene,
            contact_point: output.contact_point_in_scene,
            normal: output.normal,
            force: output.force,
            sent_force: self.mapping.force_to_scene(sample.sent_in_device),
            contact: output.contact,
            depth: output.depth,
            visits: output.visits,
        });
        if recorded.is_err() {
            self.shared.counters.lost_records.fetch_add(1, Relaxed);
        }
    }
}
