//! One tick of the servo: from where the device is to the force that it feels.
//!
//! The tick is closed: it neither allocates nor frees, locks, logs, waits or panics, and its work
//! is bounded. Frames: scene mm (LPS) unless a name says otherwise; N, s.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use glam::{DAffine3, DVec3, IVec3};
use palpate_haptics::contact::ContactModel as _;
use palpate_haptics::contact::Proxy;
use palpate_haptics::force::{Coupling, Friction};
use palpate_haptics::needle::press::Press;
use palpate_haptics::needle::tissues::NeedleScan;
use palpate_haptics::needle::{Needle, NeedleInput};
use palpate_haptics::soft_contact::{SoftContact, SoftInput, Stop};
use palpate_haptics::tick::{TickCache, TickInput, TickOutput, TickState, tick};
use palpate_volume::bits::Bits;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;

use crate::servo::channels::ServoChannels;
use crate::servo::guarantee_watch::keeps_guarantees;
use crate::touch::{
    CurrentPoses, LimitedModel, MovedPoses, NeedleStatus, Owners, Probe, RigidObstacles,
    RigidWorld, Settings, Smoothing, TouchFeels, TouchOccupancy, Touchable, TouchedSurfaces, sharp,
};

mod channels;
mod commands;
mod device_loop;
mod force_state;
mod guarantee_watch;
mod inputs;
mod mapping;
mod publish;
mod servo_state;
mod shared;

pub use channels::{
    Channels, DeviceChannels, ForceCommand, ServoCommand, ServoStatus, SimulationChannels,
    Snapshot, TickRecord,
};
pub use commands::MAX_COMMANDS_PER_TICK;
pub use device_loop::{DeviceLoop, WATCHDOG_SECS};
pub use force_state::ForceState;
pub use inputs::{DeformableContact, DeviceSample, HandTarget, TickInputs};
pub use mapping::{Mapping, ViewError, rotation_of_view, view_from_the_front};
pub use servo_state::ServoState;
pub use shared::Shared;

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
    pub feels: TouchFeels,
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
    /// The same of what soft tissue leads no tool into.
    hard: RigidObstacles,
    /// Whether the state is asked for at the end of this tick.
    marked: bool,
    /// Whether a moved segment stands elsewhere than was told.
    moved: bool,
    /// What has pressed until now [N·s], and the time of the last tick [s]: told, and else without effect.
    pressed: f64,
    last_time: f64,
    /// Where soft tissue is to be asked about [mm]; none where nothing gives way.
    aimed: Option<DVec3>,
    /// Whether a needle was felt when it was last told of.
    had_needle: bool,
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
    needle: triple_buffer::Input<NeedleStatus>,
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
            deformable_contact: DeformableContact::default(),
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
            needle,
            records,
            snapshots,
        } = channels;
        state.poses.follow_root(&mut touchable, &grid);
        // too large for the voxels, the probe is as large as touch was made for
        if touchable.set_radius(state.radius).is_err() {
            state.radius = touchable.radius;
        }
        let hard = RigidObstacles::new(&touchable);
        let mut occupancy = TouchOccupancy::new(touchable, garbage);
        occupancy.want_radius(state.settings.probe_radius);
        Self {
            grid,
            state,
            occupancy,
            cache: TickCache::default(),
            owners: Owners::default(),
            hard,
            marked: false,
            moved: true,
            pressed: 0.0,
            last_time: f64::INFINITY,
            aimed: None,
            had_needle: true,
            ends: Ends {
                samples,
                forces,
                hand,
                inbox,
                status,
                poses,
                needle,
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

    /// How much of a voxel that stands in the scan is solid, if more is known than its bit.
    #[must_use]
    pub fn share(&self, voxel: IVec3) -> Option<f32> {
        let world = self.occupancy.touchable().world.inner();
        let known = world.fractions.as_ref()?;
        known.share(voxel, world.bits.is_solid(voxel))
    }

    /// Whether friction holds the probe away from the device.
    #[must_use]
    pub fn is_held_by_friction(&self) -> bool {
        self.state.touch.friction.holds()
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
        self.execute_commands(inputs);
        self.hold_clutch(inputs);
        self.move_segments();

        let input = self.input(inputs);
        let needle = self.needle_input(inputs.time, &input);
        let led = self.lead_needle(&needle, &input);
        let mut output = self.touch(&led);
        self.follow_soft_tissue(inputs.time, &input, &mut output);
        let press = self.follow_needle(&needle, &mut output);

        self.publish_force(inputs, &output);
        self.publish_poses();
        self.publish_needle(press);
        self.note_pressure(inputs, &output, sent_in_device);
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
        let sharp = has_needle.then(|| sharp(&self.state.settings));
        let surfaces = TouchedSurfaces {
            touchable: self.occupancy.touchable(),
            owners: &self.owners,
            settings: sharp.as_ref().unwrap_or(&self.state.settings),
            // a needle is one spring, whatever it touches
            feels: (!has_needle).then_some(&self.state.feels),
        };
        let model = LimitedModel {
            model: surfaces.settings.model,
            limits: self.occupancy.touchable().limits(),
        };
        let scene = self.occupancy.scene(&self.grid);
        let touch = &mut self.state.touch;
        let had_friction = has_friction(touch);
        let output = tick(&scene, &model, &surfaces, input, touch, &mut self.cache);
        // the thesis' forces promise nothing
        let is_spring = !had_friction && !has_friction(touch) && !model.has_own_force();
        let device = input.device_in_scene;
        if !keeps_guarantees(&scene, &touch.proxy, device, &output, is_spring) {
            self.shared.counters.violations.fetch_add(1, Relaxed);
        }
        self.state.touched = match output.held_by {
            _ if !output.contact => 0,
            Some(solid) => surfaces.owner(solid).map_or(0, |id| id.0),
            // under the smooth surface, but not held back yet
            None => self.state.touched,
        };
        output
    }

    /// Touches soft tissue as it answers, instead of its voxels, and what is rigid beside or under
    /// it as ever.
    fn follow_soft_tissue(&mut self, time: f64, input: &TickInput, output: &mut TickOutput) {
        self.aimed = None;
        if !self.state.soft.is_awaited() && self.state.deformable_contact.segments.is_empty() {
            return;
        }
        let touched = SegmentId(self.state.touched);
        let settings = self.state.feels.of(touched).over(&self.state.settings);
        // in a dent the proxy may be under the smooth surface alone, held by no voxel yet: whose
        // that is nobody knows
        let is_hard = touched.0 != 0 && !self.state.deformable_contact.segments.contains(touched);
        let input = SoftInput {
            device: input.device_in_scene,
            velocity: input.velocity_in_scene,
            gives_way: !self.state.needle.is_felt() && (!output.contact || !is_hard),
            coupling: Coupling {
                stiffness: settings.stiffness,
                damping: settings.damping,
            },
            friction: Friction {
                stick: settings.friction_static,
                slip: settings.friction_kinetic,
            },
            reach: self.state.radius.max(self.grid.smallest_spacing()),
            spacing: self.grid.smallest_spacing(),
            time,
        };
        let world = RigidWorld {
            touchable: self.occupancy.touchable(),
            version: self.occupancy.version(),
            grid: &self.grid,
            soft: self.state.deformable_contact.segments,
        };
        let (proxy, feels) = (&self.state.touch.proxy, &self.state.feels);
        let mut visits = 0;
        let stop = |tool| {
            let stop = self.hard.stop(world, proxy, tool, &mut visits)?;
            let felt = stop.by.map_or(self.state.settings, |id| {
                feels.of(id).over(&self.state.settings)
            });
            Some(Stop {
                tool: stop.tool,
                stiffness: felt.stiffness,
            })
        };
        self.aimed = self.state.soft.follow(&input, output, stop);
        output.visits += visits;
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
        let scan = NeedleScan {
            grid: &self.grid,
            map: self.occupancy.touchable(),
        };
        let tool = self.state.needle.lead(needle, scan);
        tool.map_or(*input, |tool| TickInput {
            device_in_scene: tool,
            // its contact is hard or none
            smoothing: Smoothing::Off,
            ..*input
        })
    }

    /// Touches the needle instead of the hard contact; how it presses tissue in that it is not in.
    fn follow_needle(&mut self, input: &NeedleInput, output: &mut TickOutput) -> Option<Press> {
        let holder = output.held_by.map(|_| self.state.touched);
        let scan = NeedleScan {
            grid: &self.grid,
            map: self.occupancy.touchable(),
        };
        self.state.needle.follow(input, holder, scan, output)
    }
}

/// Whether what is touched has friction, so that the probe may be held aside of the device.
fn has_friction(touch: &TickState) -> bool {
    let feel = touch.blend.feel();
    feel.is_some_and(|feel| feel.friction.stick > 0.0)
}

/// A rigid motion of the scene along the axes of a grid, in mm from its corner, as friction has it.
fn along_axes(grid: &Grid, motion: &DAffine3) -> DAffine3 {
    let mm_from_voxels = DAffine3::from_scale(grid.spacing());
    let voxels_from_mm = DAffine3::from_scale(1.0 / grid.spacing());
    mm_from_voxels * grid.grid_from_patient() * *motion * grid.patient_from_grid() * voxels_from_mm
}
