//! One tick of the servo: from where the device is to the force that it feels.
//!
//! The tick is closed: it neither allocates nor frees, locks, logs, waits or panics, and its work
//! is bounded. Frames: scene mm (LPS) unless a name says otherwise; N, s.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use glam::{DAffine3, DVec3};
use palpate_haptics::coupling::Coupling;
use palpate_haptics::local_force::LocalForce;
use palpate_haptics::needle::{Needle, NeedleInput};
use palpate_haptics::placement::nearest_free_in;
use palpate_haptics::proxy::Proxy;
use palpate_haptics::soft_contact::{SoftContact, SoftInput};
use palpate_haptics::tick::{TickCache, TickInput, TickOutput, TickState, tick};
use palpate_volume::bits::Bits;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;

use crate::device_loop::WATCHDOG_SECS;
use crate::feel::Feels;
use crate::handover::{
    DeviceSample, ForceCommand, GivingWay, HandTarget, ServoChannels, ServoCommand, ServoStatus,
    Snapshot, TickRecord,
};
use crate::mapping::Mapping;
use crate::model::LimitedModel;
use crate::moved_poses::{CurrentPoses, MovedPoses};
use crate::needle::{self, NeedleMatter, NeedleStatus};
use crate::owners::Owners;
use crate::probe::Probe;
use crate::servo_state::{ServoState, TickInputs};
use crate::settings::{Settings, Smoothing};
use crate::shared::Shared;
use crate::touch_occupancy::TouchOccupancy;
use crate::touchable::Touchable;
use crate::touched_surfaces::TouchedSurfaces;

/// Commands obeyed per tick, at most, and one change of the occupancy.
pub const MAX_COMMANDS_PER_TICK: usize = 16;

/// How far around a placement's point a free voxel is searched [voxels]. The simulation has
/// found one; this is for changes that are still on their way.
const PLACE_REACH: i32 = 3;

/// What a servo begins with.
#[derive(Debug)]
pub struct ServoStart {
    /// Where the scan stands.
    pub grid: Grid,
    /// What is touched.
    pub touchable: Touchable,
    /// `scene_from_device`.
    pub mapping: Mapping,
    /// Where the probe is, in a free voxel.
    pub probe: DVec3,
    /// Settings that the device bears.
    pub settings: Settings,
    /// How each segment feels, by its number.
    pub feels: Feels,
}

/// The state of the servo thread.
#[derive(Debug)]
pub struct ServoLoop {
    grid: Grid,
    state: ServoState,
    occupancy: TouchOccupancy,
    cache: TickCache,
    /// Kept beside the state like the cache: it changes no result.
    owners: Owners,
    /// Whether the state is asked for at the end of this tick.
    marked: bool,
    /// Whether a moved segment stands elsewhere than was told.
    moved: bool,
    ends: Ends,
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
    poses: triple_buffer::Input<CurrentPoses>,
    records: rtrb::Producer<TickRecord>,
    snapshots: rtrb::Producer<Snapshot>,
}

impl ServoLoop {
    /// A servo at its start.
    ///
    /// # Panics
    /// Where the probe's start is not a point: whoever starts a session has checked it.
    #[must_use]
    pub fn new(start: ServoStart, channels: ServoChannels, shared: Arc<Shared>) -> Self {
        let probe_in_grid = start.grid.grid_from_patient().transform_point3(start.probe);
        let mut mapping = start.mapping;
        mapping.rescale(mapping.point_to_device(start.probe), start.settings.gain);
        let proxy = Proxy::at(probe_in_grid).expect("the probe starts at a finite point");
        let state = ServoState {
            touch: TickState::new(proxy),
            mapping,
            settings: start.settings,
            feels: start.feels,
            radius: start.touchable.radius,
            poses: MovedPoses::default(),
            touched: 0,
            giving_way: GivingWay::default(),
            soft: SoftContact::default(),
            needle: Needle::default(),
            hand: start.probe,
            clutch: None,
            forgotten_hand: 0,
            received: 0,
            refused_places: 0,
            command: 0,
            tick: 0,
        };
        Self::resume(start.grid, start.touchable, state, (channels, shared))
    }

    /// A servo that goes on from a state.
    #[must_use]
    pub fn resume(
        grid: Grid,
        mut touchable: Touchable,
        mut state: ServoState,
        (channels, shared): (ServoChannels, Arc<Shared>),
    ) -> Self {
        let ServoChannels {
            samples,
            forces,
            hand,
            inbox,
            garbage,
            status,
            poses,
            records,
            snapshots,
        } = channels;
        state.poses.follow_root(&mut touchable, &grid);
        // who starts a session or reads a tape has checked that it fits
        let _ = touchable.set_radius(state.radius);
        let mut occupancy = TouchOccupancy::new(touchable, garbage);
        occupancy.want_radius(state.settings.probe_radius);
        Self {
            grid,
            state,
            occupancy,
            cache: TickCache::default(),
            owners: Owners::default(),
            marked: false,
            moved: true,
            ends: Ends {
                samples,
                forces,
                hand,
                inbox,
                status,
                poses,
                records,
                snapshots,
            },
            shared,
        }
    }

    /// What is solid for the probe now.
    #[must_use]
    pub fn solid(&self) -> &Bits {
        &self.occupancy.touchable().world.inner().bits
    }

    /// The needle in the hand, or none.
    #[must_use]
    pub fn needle(&self) -> &Needle {
        &self.state.needle
    }

    /// The segment that is touched; 0 where there is none.
    #[must_use]
    pub fn touched(&self) -> u8 {
        self.state.touched
    }

    /// One tick at `now` [s] with what device and person say by then.
    pub fn step(&mut self, now: f64) {
        let sample = *self.ends.samples.read();
        let hand = *self.ends.hand.read();
        let inputs = TickInputs::new(now, &sample, hand, self.occupancy.has_room());
        self.tick(&inputs, sample.sent_in_device);
    }

    /// One tick. What comes out follows from state, inputs and waiting commands alone; the
    /// force that was last sent to the device [N] is only noted.
    pub fn tick(&mut self, inputs: &TickInputs, sent_in_device: DVec3) {
        self.follow_hand(inputs.hand);
        if inputs.has_room {
            self.retry_held_changes();
        }
        self.obey(inputs);
        self.hold_clutch(inputs);
        self.move_segments();

        let input = self.input(inputs);
        let needle = self.needle_input(inputs.time, &input);
        let led = self.lead_needle(&needle, &input);
        let mut output = self.touch(&led);
        self.give_way(inputs.time, &input, &mut output);
        self.follow_needle(&needle, &mut output);

        self.publish_force(inputs, &output);
        self.publish_poses();
        self.publish_status(inputs, &output, sent_in_device);
        self.record(inputs, &output, sent_in_device);
        self.state.tick += 1;
        self.publish_snapshot();
    }

    fn follow_hand(&mut self, target: HandTarget) {
        if target.number > self.state.forgotten_hand && self.state.clutch.is_none() {
            self.state.hand = target.point;
        }
    }

    /// Takes the mapping along with the device, so that it stands where the probe was.
    fn hold_clutch(&mut self, inputs: &TickInputs) {
        if let Some(point) = self.state.clutch {
            self.state.hand = point;
            if inputs.is_read() {
                self.state.mapping.place(inputs.position_in_device, point);
            }
        }
    }

    fn retry_held_changes(&mut self) {
        let mut probe = Probe {
            grid: &self.grid,
            proxy: &mut self.state.touch.proxy,
        };
        self.occupancy.retry(&mut probe);
        self.state.radius = self.occupancy.touchable().radius;
    }

    /// Takes a step of each segment that moves; the one that is touched takes along what friction
    /// holds.
    fn move_segments(&mut self) {
        self.moved |= self.state.poses.is_moving();
        let (proxy, touched) = (&mut self.state.touch.proxy, SegmentId(self.state.touched));
        let carried =
            self.occupancy
                .step_poses(&mut self.state.poses, &self.grid, (proxy, touched));
        if let Some(motion) = carried {
            let friction = &mut self.state.touch.friction;
            friction.carry(&along_axes(&self.grid, &motion));
        }
    }

    /// Obeys the simulation, in its order, as far as one tick allows.
    fn obey(&mut self, inputs: &TickInputs) {
        for _ in 0..MAX_COMMANDS_PER_TICK {
            match self.ends.inbox.peek() {
                Ok(ServoCommand::Root { .. } | ServoCommand::Bricks(_)) => {
                    return self.follow_changes();
                }
                // the device must have been read once, so that it can be brought along
                Ok(ServoCommand::Place { .. }) if !inputs.is_read() => return,
                // what comes after a mark is obeyed after the state is told
                Ok(ServoCommand::Mark) => return self.obey_next(inputs),
                Ok(_) => self.obey_next(inputs),
                Err(_) => return,
            }
        }
    }

    /// Takes the next command.
    fn pop(&mut self) -> Option<ServoCommand> {
        let command = self.ends.inbox.pop().ok()?;
        self.state.command += 1;
        Some(command)
    }

    /// Takes the change that comes next, where there is room for what it replaces.
    fn follow_changes(&mut self) {
        if !self.occupancy.has_room() {
            return;
        }
        let command = self.pop();
        let mut probe = Probe {
            grid: &self.grid,
            proxy: &mut self.state.touch.proxy,
        };
        match command {
            Some(ServoCommand::Root {
                sequence,
                mut touchable,
            }) => {
                self.state.poses.follow_root(&mut touchable, &self.grid);
                self.moved = true;
                self.state.received = sequence;
                self.occupancy.take_root(sequence, touchable, &mut probe);
            }
            Some(ServoCommand::Bricks(change)) => {
                self.state.received = change.sequence;
                self.occupancy.take_bricks(change, &mut probe);
            }
            // whoever calls has looked
            Some(_) | None => {}
        }
    }

    /// Obeys a command that changes no occupancy.
    fn obey_next(&mut self, inputs: &TickInputs) {
        let device = inputs.position_in_device;
        match self.pop() {
            Some(ServoCommand::Place {
                point,
                hand,
                device_too,
            }) => {
                self.state.forgotten_hand = hand;
                self.place(point, device_too.then_some(device));
            }
            Some(ServoCommand::Turn(rotation)) => self.state.mapping.turn(device, rotation),
            Some(ServoCommand::Clutch(on)) => {
                let proxy = self.state.touch.proxy.point();
                let point = self.grid.patient_from_grid().transform_point3(proxy);
                self.state.clutch = on.then_some(point);
                self.state.forgotten_hand = self.state.forgotten_hand.max(inputs.hand.number);
            }
            Some(ServoCommand::Settings(settings)) => {
                self.state.mapping.rescale(device, settings.gain);
                self.state.settings = settings;
                self.occupancy.want_radius(settings.probe_radius);
                self.state.touch.blend.tell();
            }
            Some(ServoCommand::Feel(id, feel)) => {
                self.state.feels.set(id, feel);
                self.state.touch.blend.tell();
            }
            Some(ServoCommand::Pose(id, target)) => {
                if let Some((bounds, own_grid)) = self.occupancy.place_of(id) {
                    let grid = own_grid.unwrap_or(&self.grid);
                    self.state.poses.lead(id, target, grid, bounds);
                }
            }
            Some(ServoCommand::GiveWay(giving_way)) => {
                self.state.giving_way = giving_way;
                self.state
                    .soft
                    .take(giving_way.contact.as_ref(), inputs.time);
            }
            Some(ServoCommand::Needle(on, tissues)) => self.state.needle.hold(on, &tissues),
            Some(ServoCommand::Mark) => {
                self.marked = true;
                // a replay knows only what is read from here on
                self.cache.forget();
            }
            // changes of occupancy are taken elsewhere
            Some(ServoCommand::Root { .. } | ServoCommand::Bricks(_)) | None => {}
        }
    }

    /// Brings the probe to a free point, and the device there by moving the mapping.
    fn place(&mut self, point: DVec3, device: Option<DVec3>) {
        let point_in_grid = self.grid.grid_from_patient().transform_point3(point);
        let scene = self.occupancy.scene(&self.grid);
        let Some(proxy) = nearest_free_in(&scene, point_in_grid, PLACE_REACH) else {
            self.state.refused_places += 1;
            return;
        };
        self.state.touch = TickState::new(proxy);
        self.state.needle.forget();
        self.state.soft = SoftContact::default();
        let placed = self
            .grid
            .patient_from_grid()
            .transform_point3(proxy.point());
        self.state.hand = placed;
        self.state.clutch = self.state.clutch.map(|_| placed);
        if let Some(device) = device {
            self.state.mapping.place(device, placed);
        }
    }

    /// What touch is given; a device that was not read in time has no position.
    fn input(&self, inputs: &TickInputs) -> TickInput {
        let known = inputs.is_read() && inputs.time - inputs.read_at <= WATCHDOG_SECS;
        let device = self.device_in_scene(inputs);
        TickInput {
            device_in_scene: if known { device } else { DVec3::NAN },
            velocity_in_scene: if self.state.clutch.is_some() {
                DVec3::ZERO
            } else {
                self.state
                    .mapping
                    .velocity_to_scene(inputs.velocity_in_device)
            },
            damping: self.state.settings.damping,
            smoothing: self.state.settings.smoothing,
        }
    }

    /// Where the device is; until it was read, where the hand is.
    fn device_in_scene(&self, inputs: &TickInputs) -> DVec3 {
        if !inputs.is_read() {
            return self.state.hand;
        }
        self.state.mapping.point_to_scene(inputs.position_in_device)
    }

    fn touch(&mut self, input: &TickInput) -> TickOutput {
        self.cache.set_epoch(self.occupancy.version());
        self.owners.set_version(self.occupancy.version());
        let has_needle = self.state.needle.is_felt();
        let sharp = needle::sharp(&self.state.settings);
        let surfaces = TouchedSurfaces {
            touchable: self.occupancy.touchable(),
            owners: &self.owners,
            settings: if has_needle {
                &sharp
            } else {
                &self.state.settings
            },
            // a needle is one spring, whatever it touches
            feels: (!has_needle).then_some(&self.state.feels),
        };
        let model = LimitedModel {
            model: surfaces.settings.model,
            limits: self.occupancy.touchable().limits(),
        };
        let output = tick(
            &self.occupancy.scene(&self.grid),
            &model,
            &surfaces,
            input,
            &mut self.state.touch,
            &mut self.cache,
        );
        self.state.touched = match output.held_by {
            _ if !output.contact => 0,
            Some(solid) => surfaces.owner(solid).map_or(0, |id| id.0),
            // under the smooth surface, but not held back yet
            None => self.state.touched,
        };
        if output.violation {
            self.shared.counters.violations.fetch_add(1, Relaxed);
        }
        output
    }

    /// Feels matter that gives way as it answers, instead of its voxels.
    fn give_way(&mut self, time: f64, input: &TickInput, output: &mut TickOutput) {
        let touched = SegmentId(self.state.touched);
        let settings = self.state.feels.of(touched).over(&self.state.settings);
        // in a dent the proxy may be under the smooth surface alone, held by no voxel yet: whose
        // that is nobody knows
        let is_hard = touched.0 != 0 && !self.state.giving_way.includes(touched);
        let input = SoftInput {
            device: input.device_in_scene,
            velocity: input.velocity_in_scene,
            gives_way: !self.state.needle.is_felt() && (!output.contact || !is_hard),
            coupling: Coupling {
                stiffness: settings.stiffness,
                damping: settings.damping,
            },
            spacing: self.grid.smallest_spacing(),
            time,
        };
        self.state.soft.follow(&input, output);
    }

    fn needle_input(&mut self, time: f64, input: &TickInput) -> NeedleInput {
        NeedleInput {
            device: input.device_in_scene,
            velocity: input.velocity_in_scene,
            coupling: self.state.settings.coupling(),
            spacing: self.grid.smallest_spacing(),
            time,
            dt: self.state.needle.pass(time),
        }
    }

    /// Where touch is led: to the device, or to the needle that is in.
    fn lead_needle(&mut self, needle: &NeedleInput, input: &TickInput) -> TickInput {
        let matter = NeedleMatter::of(self.occupancy.touchable(), &self.state.needle);
        let tool = self.state.needle.lead(needle, &self.grid, &matter);
        tool.map_or(*input, |tool| TickInput {
            device_in_scene: tool,
            // its contact is hard or none
            smoothing: Smoothing::Off,
            ..*input
        })
    }

    /// Feels the needle instead of the hard contact.
    fn follow_needle(&mut self, input: &NeedleInput, output: &mut TickOutput) {
        let holder = output.held_by.map(|_| self.state.touched);
        let matter = NeedleMatter::of(self.occupancy.touchable(), &self.state.needle);
        let world = (&self.grid, &matter);
        self.state.needle.follow(input, holder, world, output);
    }

    fn publish_force(&mut self, inputs: &TickInputs, output: &TickOutput) {
        let mapping = &self.state.mapping;
        self.ends.forces.write(ForceCommand {
            time: inputs.time,
            tick: self.state.tick + 1,
            law: law_in_device(mapping, inputs, output),
            hand_in_device: mapping.point_to_device(self.state.hand),
            max_force: self.state.settings.force_limit,
        });
    }

    /// Where matter meets the tool: at the near end of the spring, or where the device is while
    /// matter that gives way does not push yet.
    fn tool(&self, inputs: &TickInputs, output: &TickOutput) -> DVec3 {
        if self.state.soft.is_felt() {
            self.device_in_scene(inputs) + output.spring
        } else {
            output.contact_point_in_scene
        }
    }

    /// Before the status, so that who reads that one finds poses as new.
    fn publish_poses(&mut self) {
        if std::mem::take(&mut self.moved) {
            self.ends.poses.write(self.state.poses.current());
        }
    }

    fn publish_status(&mut self, inputs: &TickInputs, output: &TickOutput, sent_in_device: DVec3) {
        self.ends.status.write(ServoStatus {
            received: self.state.received,
            held_root: self.occupancy.held_root(),
            held_edits: self.occupancy.held_edits(),
            skipped: self.occupancy.skipped(),
            stopped: self.state.poses.stopped(),
            refused_places: self.state.refused_places,
            radius: self.state.radius,
            device: self.device_in_scene(inputs),
            proxy: output.proxy_in_scene,
            tool: self.tool(inputs, output),
            contact: output.contact,
            touched: self.state.touched,
            time: inputs.time,
            normal: output.normal,
            sent_force: sent_in_device.length(),
            axes: self.state.mapping.rotation,
            orientation: inputs.orientation,
            origin: self.state.mapping.offset,
            command: self.state.command,
            needle: NeedleStatus::of(&self.state.needle),
        });
    }

    fn record(&mut self, inputs: &TickInputs, output: &TickOutput, sent_in_device: DVec3) {
        let recorded = self.ends.records.push(TickRecord {
            tick: self.state.tick,
            time: inputs.time,
            device: self.device_in_scene(inputs),
            hand: self.state.hand,
            proxy: output.proxy_in_scene,
            contact_point: output.contact_point_in_scene,
            normal: output.normal,
            force: output.force,
            sent_force: self.state.mapping.force_to_scene(sent_in_device),
            contact: output.contact,
            depth: output.depth,
            visits: output.visits,
            inputs: *inputs,
            command: self.state.command,
        });
        if recorded.is_err() {
            self.shared.counters.lost_records.fetch_add(1, Relaxed);
        }
    }

    /// Tells the state between this tick and the next, where it was asked for.
    fn publish_snapshot(&mut self) {
        if !self.marked {
            return;
        }
        self.marked = false;
        let snapshot = Snapshot {
            state: self.state,
            held: self.occupancy.holds_back(),
        };
        // whoever asks asks once, and takes what he asked for
        let _ = self.ends.snapshots.push(snapshot);
    }
}

/// A rigid motion of the scene along the axes of a grid, in mm from its corner, as friction has it.
fn along_axes(grid: &Grid, motion: &DAffine3) -> DAffine3 {
    let mm_from_voxels = DAffine3::from_scale(grid.spacing());
    let voxels_from_mm = DAffine3::from_scale(1.0 / grid.spacing());
    mm_from_voxels * grid.grid_from_patient() * *motion * grid.patient_from_grid() * voxels_from_mm
}

/// The contact as the device can follow it.
fn law_in_device(mapping: &Mapping, inputs: &TickInputs, output: &TickOutput) -> LocalForce {
    if output.spring == DVec3::ZERO {
        return LocalForce::held(mapping.force_to_device(output.force));
    }
    LocalForce {
        device: inputs.position_in_device,
        spring: mapping.force_to_device(output.spring),
        normal: mapping.force_to_device(output.normal),
        coupling: output.coupling,
        sticks: output.sticks,
        scale: mapping.scale,
        held: DVec3::ZERO,
    }
}
