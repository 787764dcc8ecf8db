//! The loops of a session and what connects them, made from its configuration.

use std::sync::mpsc::{self, Sender};
use std::sync::{Arc, Mutex};

use glam::{DAffine3, DVec3};
use palpate_device::DeviceLimits;
use palpate_haptics::scene::{MAX_OBJECTS, ObjectPose};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::{Voxels, VoxelsError};
use triple_buffer::{Input, triple_buffer};

use crate::deformable::deformable_view::DeformableView;
use crate::deformable::deformation::Deformation;
use crate::error::SessionError;
use crate::notice::Notice;
use crate::picture::frame_collector::{FrameCollector, FrameSources, RateReaders};
use crate::picture::simulation_status::{PictureEnds, SimulationStatus};
use crate::picture::surface_loop::{SurfaceLoop, SurfacePace};
use crate::picture::surfaces::Surfaces;
use crate::replay::tape::TapeRecorder;
use crate::scene::mask_fractions::MaskFractions;
use crate::scene::{Properties, Scene, Step};
use crate::servo::channels::{Channels, SimulationChannels};
use crate::servo::device_loop::DeviceLoop;
use crate::servo::inputs::HandTarget;
use crate::servo::mapping::{Mapping, view_from_the_front};
use crate::servo::shared::Shared;
use crate::servo::{ServoLoop, ServoStart};
use crate::session::config::{Reference, SessionConfig};
use crate::session::live::Loops;
use crate::simulation::Simulation;
use crate::simulation::touch_sender::touchable_of;
use crate::threads::change_signal::ChangeSignal;
use crate::threads::pacing::{PICTURE_HZ, SIMULATION_HZ};
use crate::threads::rate::RateMeter;
use crate::touch::placement::{REACH, free_point, in_front_of};
use crate::touch::settings::Settings;

/// A session before it runs.
pub struct Assembly {
    /// What the threads will run.
    pub loops: Loops,
    /// What is shown.
    pub picture: Arc<Mutex<FrameCollector>>,
    /// Segments shown as surfaces, and what changed in the picture.
    pub surfaces: Arc<Mutex<Surfaces>>,
    /// How often they follow the voxels.
    pub pace: SurfacePace,
    /// Rung whenever they have followed.
    pub signal: Arc<ChangeSignal>,
    /// The parts of the deformation model.
    pub deformable_view: Arc<DeformableView>,
    /// Where the hand pulls to.
    pub hand: Input<HandTarget>,
    /// What all threads see.
    pub shared: Arc<Shared>,
    /// Takes notices from anybody.
    pub notices: Sender<Notice>,
    /// What is told to the servo, where it is recorded.
    pub tape: Arc<Mutex<TapeRecorder>>,
}

/// Makes all loops of a configuration that was checked.
///
/// # Errors
/// Where segments do not fit the scan, or there is no free place for the probe.
pub fn assemble(config: SessionConfig) -> Result<Assembly, SessionError> {
    let (device_rate_hz, safety) = (config.device_rate_hz(), config.safety());
    let SessionConfig {
        grid,
        device,
        reference,
        rate_hz,
        ..
    } = config;
    let limits = device.limits();
    let settings = config.settings.within(&limits);
    let scene = scene_of(grid, config.intensities, config.segments)?;
    let probe = first_point(&scene, config.start, settings.probe_radius)?;

    // what connects the loops
    let shared = Arc::new(Shared::default());
    let channels = Channels::new(probe);
    let (notices, notice_inbox) = mpsc::channel();
    let (updates, update_inbox) = mpsc::channel();
    let (status, status_out) = triple_buffer(&SimulationStatus::default());
    let (meters, rates) = meters(device_rate_hz, rate_hz);

    // the loops
    let dt = 1.0 / f64::from(device_rate_hz);
    let device = DeviceLoop::new(device, channels.device, Arc::clone(&shared), dt, safety);
    let start = servo_start(&scene, reference, probe, settings);
    let servo = ServoLoop::new(start, channels.servo, Arc::clone(&shared));
    let (pace, signal) = (SurfacePace::default(), Arc::new(ChangeSignal::default()));
    let surfaces = Surfaces::new(scene.voxels().intensities().clone());
    let surfaces = Arc::new(Mutex::new(surfaces));
    let ends = (status, notices.clone(), updates);
    let (deformation, deformation_loop) = Deformation::new(!config.real_time);
    let deformable_view = deformation_loop.view();
    let (mut fractions, fraction_loop) = MaskFractions::new();
    fractions.switch(config.mask_fractions);
    let simulation = first_simulation(
        (scene, deformation, fractions),
        (settings, limits),
        channels.simulation,
        ends,
        (reference, probe),
    )?;
    let tape = simulation.tape();
    let sources = FrameSources {
        records: channels.records,
        status: status_out,
        notices: notice_inbox,
        rates,
        shared: Arc::clone(&shared),
    };
    let picture = Arc::new(Mutex::new(FrameCollector::new(sources, rate_hz, probe)));

    report_start(&notices, config.start, probe);
    report_limits(&notices, &settings, &config.settings);
    let [device_meter, servo_meter, simulation_meter, picture_meter] = meters;
    Ok(Assembly {
        loops: Loops {
            device: (device, device_meter),
            servo: (servo, servo_meter),
            simulation: (simulation, simulation_meter),
            picture: (Arc::clone(&picture), picture_meter),
            surfaces: SurfaceLoop::new(
                update_inbox,
                Arc::clone(&surfaces),
                (pace.clone(), Arc::clone(&signal)),
            ),
            deformation: deformation_loop,
            fractions: fraction_loop,
        },
        picture,
        surfaces,
        pace,
        signal,
        deformable_view,
        hand: channels.hand,
        shared,
        notices,
        tape,
    })
}

fn servo_start(
    scene: &Scene,
    reference: Reference,
    probe: DVec3,
    settings: Settings,
) -> ServoStart {
    let grid = *scene.voxels().grid();
    ServoStart {
        grid,
        touchable: touchable_of(scene, settings.probe_radius),
        mapping: first_mapping(reference),
        probe,
        settings,
        feels: scene.feels(),
    }
}

/// A simulation that brings the device to the probe, where the device is not in the scene.
fn first_simulation(
    parts: (Scene, Deformation, MaskFractions),
    (settings, limits): (Settings, DeviceLimits),
    channels: SimulationChannels,
    ends: PictureEnds,
    (reference, probe): (Reference, DVec3),
) -> Result<Simulation, SessionError> {
    let mut simulation = Simulation::new(parts, settings, limits, channels, ends);
    if reference == Reference::View {
        simulation.place(probe, 0, true)?;
    }
    simulation.step();
    Ok(simulation)
}

/// A free place for the probe: the start, or the free voxel nearest to it.
fn first_point(scene: &Scene, start: Option<DVec3>, radius: f64) -> Result<DVec3, SessionError> {
    let grid = scene.voxels().grid();
    let point = start.unwrap_or_else(|| in_front_of(grid));
    let touchable = touchable_of(scene, radius);
    free_point(&touchable.scene(grid), point).ok_or(SessionError::NoFreeVoxel {
        point,
        reach: REACH,
    })
}

fn report_start(notices: &Sender<Notice>, start: Option<DVec3>, probe: DVec3) {
    if let Some(wanted) = start
        && wanted != probe
    {
        let moved = probe.distance(wanted);
        // the picture lives as long as the session
        let _ = notices.send(Notice::info(format!(
            "The start is inside a touchable segment: the probe begins in the nearest free \
             voxel, {moved:.1} mm away."
        )));
    }
}

fn report_limits(notices: &Sender<Notice>, settings: &Settings, wanted: &Settings) {
    if let Some(notice) = settings.notice_of_limits(wanted) {
        // the picture lives as long as the session
        let _ = notices.send(notice);
    }
}

fn scene_of(
    grid: Grid,
    intensities: Intensities,
    segments: Vec<(Segment, Properties)>,
) -> Result<Scene, SessionError> {
    if segments.len() > usize::from(u8::MAX) {
        return Err(VoxelsError::TooManySegments.into());
    }
    let bodies = segments.iter().filter_map(|(segment, properties)| {
        let of_own = segment.own_grid().map(|_| DAffine3::IDENTITY);
        Some((segment.grid(&grid), properties.pose.or(of_own)?))
    });
    for (own, pose) in bodies.clone() {
        ObjectPose::new(own, &grid, pose)?;
    }
    if bodies.count() > MAX_OBJECTS {
        return Err(SessionError::TooManyMoved);
    }
    let mut scene = Scene::new(Voxels::new(grid, intensities)?);
    for (id, (segment, properties)) in (1..=u8::MAX).zip(segments) {
        scene.perform(Step::Insert {
            id: SegmentId(id),
            segment,
            properties: Box::new(properties),
        })?;
    }
    Ok(scene)
}

fn first_mapping(reference: Reference) -> Mapping {
    match reference {
        Reference::Scene => Mapping::IDENTITY,
        Reference::View => Mapping {
            rotation: view_from_the_front(),
            ..Mapping::IDENTITY
        },
    }
}

fn meters(device_rate_hz: u32, rate_hz: u32) -> ([RateMeter; 4], RateReaders) {
    let (device, device_reader) = RateMeter::new(device_rate_hz);
    let (servo, servo_reader) = RateMeter::new(rate_hz);
    let (simulation, simulation_reader) = RateMeter::new(SIMULATION_HZ);
    let (picture, picture_reader) = RateMeter::new(PICTURE_HZ);
    let readers = RateReaders {
        device: device_reader,
        servo: servo_reader,
        simulation: simulation_reader,
        picture: picture_reader,
    };
    ([device, servo, simulation, picture], readers)
}
