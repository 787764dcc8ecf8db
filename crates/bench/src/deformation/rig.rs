//! Servo, simulation and model of a session with bare ends: whoever holds it steps them.
//!
//! Frame: scene [mm], which is the device's; N, s.

use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, mpsc};

use glam::DVec3;
use palpate_device::{DeviceLimits, DeviceState};
use palpate_engine::deformable::{Deformation, DeformationLoop};
use palpate_engine::error::SessionError;
use palpate_engine::picture::{PictureEnds, SimulationStatus};
use palpate_engine::scene::{MaskFractions, Properties, Scene};
use palpate_engine::servo::{
    Channels, DeviceChannels, DeviceSample, Mapping, ServoLoop, ServoStart, Shared, TickRecord,
};
use palpate_engine::simulation::{Simulation, SimulationParts};
use palpate_engine::touch::{Settings, TouchFeels, Touchable};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;
use triple_buffer::triple_buffer;

/// What a device of the rig bears.
pub const LIMITS: DeviceLimits = DeviceLimits {
    max_force: 10.0,
    max_continuous_force: 10.0,
    max_stiffness: 1.0,
    damping: 0.0,
    workspace_radius: 1000.0,
};

/// The loops of a session.
pub struct Rig {
    /// The servo with its device.
    pub servo: LedServo,
    /// The simulation.
    pub simulation: Simulation,
    /// The model's loop.
    pub deformation: DeformationLoop,
    /// What the simulation tells the picture.
    pub status: triple_buffer::Output<SimulationStatus>,
}

/// A servo whose device is led.
pub struct LedServo {
    /// The loop.
    pub servo: ServoLoop,
    /// What all threads see.
    pub shared: Arc<Shared>,
    records: rtrb::Consumer<TickRecord>,
    device: Option<DeviceChannels>,
    readings: u64,
}

impl Rig {
    /// A scan with segments that are obstacles, numbered from 1, and the probe at a free point.
    ///
    /// `in_step`: every answer of the model takes the same work.
    pub fn new(
        (grid, intensities): (Grid, Intensities),
        segments: Vec<Segment>,
        probe: DVec3,
        settings: Settings,
        in_step: bool,
    ) -> Result<Self, SessionError> {
        let channels = Channels::new(probe);
        let shared = Arc::new(Shared::default());
        let (status, status_out) = triple_buffer(&SimulationStatus::default());
        let start = ServoStart {
            grid,
            touchable: Touchable::new(&grid, Vec::new(), settings.probe_radius)?,
            mapping: Mapping::IDENTITY,
            probe,
            settings,
            feels: TouchFeels::default(),
        };
        let (deformation, deformation_loop) = Deformation::new(in_step);
        // nobody works them out: touch is by bits
        let (fractions, _) = MaskFractions::new();
        let scene = Scene::new(Voxels::new(grid, intensities)?);
        let mut simulation = Simulation::new(
            SimulationParts {
                scene,
                deformation,
                fractions,
            },
            settings,
            LIMITS,
            channels.simulation,
            // nobody draws and nobody reads: what is told ends here
            PictureEnds {
                status,
                notices: mpsc::channel().0,
                updates: mpsc::channel().0,
            },
        );
        for segment in segments {
            simulation.add_segment(segment, Properties::of_threshold(true, None), false)?;
        }
        Ok(Self {
            servo: LedServo {
                servo: ServoLoop::new(start, channels.servo, Arc::clone(&shared)),
                shared,
                records: channels.records,
                device: Some(channels.device),
                readings: 0,
            },
            simulation,
            deformation: deformation_loop,
            status: status_out,
        })
    }
}

impl LedServo {
    /// The device's ends, for a device loop that leads the servo from now on.
    pub fn take_device(&mut self) -> Option<DeviceChannels> {
        self.device.take()
    }

    /// A tick with the device at a point, where no device loop leads.
    pub fn tick_at(&mut self, position: DVec3, now: f64) -> TickRecord {
        self.readings += 1;
        if let Some(device) = &mut self.device {
            device.samples.write(DeviceSample {
                number: self.readings,
                time: now,
                state: DeviceState {
                    position,
                    ..DeviceState::default()
                },
                sent_in_device: DVec3::ZERO,
            });
        }
        self.tick(now)
    }

    /// A tick with the device where it was read last.
    pub fn tick(&mut self, now: f64) -> TickRecord {
        self.servo.step(now);
        self.records.pop().expect("every tick is recorded")
    }

    /// Ticks in which the servo found its own probe in a solid voxel.
    pub fn violations(&self) -> u64 {
        self.shared.counters.violations.load(Relaxed)
    }
}
