//! Servo, simulation and model of deformation with a drive in place of a device, in lock-step.

use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, mpsc};

use glam::DVec3;
use palpate_device::{DeviceLimits, DeviceState};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::voxels::Voxels;

use super::drive::Drive;
use crate::deformable::{Deformation, DeformationLoop};
use crate::error::SessionError;
use crate::notice::Notice;
use crate::picture::{PictureEnds, SceneUpdate, SimulationStatus};
use crate::scene::{MaskFractions, Scene};
use crate::servo::{Channels, DeviceSample, Mapping, ServoLoop, ServoStart, Shared, TickRecord};
use crate::simulation::{Simulation, SimulationParts};
use crate::touch::{TouchFeels, Touchable};

/// Ticks in a second.
pub(super) const RATE_HZ: u32 = 1000;
/// Ticks between two passes of the simulation.
pub(super) const TICKS_PER_PASS: u64 = 10;
/// Passes between two answers of the model: some 33 come in a second.
const PASSES_PER_ANSWER: u64 = 3;
/// Longest way of a drive [mm].
pub(super) const LONGEST: f64 = 1000.0;

/// A session without threads, device and picture.
pub(super) struct Rig {
    pub servo: ServoLoop,
    pub simulation: Simulation,
    deformation: DeformationLoop,
    device: triple_buffer::Input<DeviceSample>,
    records: rtrb::Consumer<TickRecord>,
    // what nobody reads is kept, so that the writing ends stay whole
    _status: triple_buffer::Output<SimulationStatus>,
    _notices: mpsc::Receiver<Notice>,
    _updates: mpsc::Receiver<SceneUpdate>,
    shared: Arc<Shared>,
    ticks: u64,
    force: DVec3,
}

impl Rig {
    /// A scan without segments, and a probe of a radius [mm] at the drive's start.
    pub fn new(
        grid: &Grid,
        intensities: Intensities,
        drive: &Drive,
        radius: f64,
    ) -> Result<Self, SessionError> {
        let settings = drive.settings(radius);
        settings.check()?;
        let channels = Channels::new(drive.start);
        let shared = Arc::new(Shared::default());
        let (status, status_out) = triple_buffer::triple_buffer(&SimulationStatus::default());
        let (notices, notice_inbox) = mpsc::channel();
        let (updates, update_inbox) = mpsc::channel();
        let start = ServoStart {
            grid: *grid,
            touchable: Touchable::new(grid, Vec::new(), radius)?,
            mapping: Mapping::IDENTITY,
            probe: drive.start,
            settings,
            feels: TouchFeels::default(),
        };
        let limits = DeviceLimits {
            max_force: settings.force_limit,
            max_continuous_force: settings.force_limit,
            max_stiffness: settings.stiffness,
            damping: 0.0,
            workspace_radius: LONGEST,
        };
        let (deformation, deformation_loop) = Deformation::new(true);
        // layers have no flat slopes whose occupancy fractions would matter
        let (fractions, _) = MaskFractions::new();
        let scene = Scene::new(Voxels::new(*grid, intensities)?);
        Ok(Self {
            servo: ServoLoop::new(start, channels.servo, Arc::clone(&shared)),
            simulation: Simulation::new(
                SimulationParts {
                    scene,
                    deformation,
                    fractions,
                },
                settings,
                limits,
                channels.simulation,
                PictureEnds {
                    status,
                    notices,
                    updates,
                },
            ),
            deformation: deformation_loop,
            device: channels.device.samples,
            records: channels.records,
            _status: status_out,
            _notices: notice_inbox,
            _updates: update_inbox,
            shared,
            ticks: 0,
            force: DVec3::ZERO,
        })
    }

    /// One tick with the drive at a point [mm], which feels the force of the tick before.
    pub fn tick(&mut self, position: DVec3) -> TickRecord {
        let time = self.ticks as f64 / f64::from(RATE_HZ);
        self.ticks += 1;
        self.device.write(DeviceSample {
            number: self.ticks,
            time,
            state: DeviceState {
                position,
                ..DeviceState::default()
            },
            sent_in_device: self.force,
        });
        self.servo.step(time);
        if self.ticks.is_multiple_of(TICKS_PER_PASS) {
            self.simulation.step();
        }
        if self
            .ticks
            .is_multiple_of(TICKS_PER_PASS * PASSES_PER_ANSWER)
        {
            self.deformation.step();
        }
        let record = self.records.pop().expect("every tick is recorded");
        self.force = record.force;
        record
    }

    /// Ticks in which the probe was in a solid voxel.
    pub fn violations(&self) -> u64 {
        self.shared.counters.violations.load(Relaxed)
    }
}
