//! The loops of a session and what connects them, made from its configuration.

use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex};

use glam::{DAffine3, DVec3};
use palpate_haptics::scene::{MAX_OBJECTS, ObjectPose};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::{Voxels, VoxelsError};
use triple_buffer::{Output, triple_buffer};

use crate::deformable::{DeformableView, Deformation};
use crate::error::SessionError;
use crate::notice::Notice;
use crate::picture::{
    FrameCollector, FrameSources, PictureEnds, RateReaders, SceneUpdate, SimulationStatus,
    SurfaceLoop, SurfacePace, Surfaces,
};
use crate::replay::TapeRecorder;
use crate::scene::{MaskFractions, Properties, Scene, Step};
use crate::servo::{
    Channels, DeviceLoop, Mapping, ServoLoop, ServoStart, Shared, view_from_the_front,
};
use crate::session::config::{Reference, SessionConfig};
use crate::session::live::{Loops, Metered};
use crate::simulation::{SharedHand, Simulation, SimulationParts, touchable_of};
use crate::threads::{ChangeSignal, PICTURE_HZ, RateMeter, SIMULATION_HZ};
use crate::touch::{PLACEMENT_REACH, Settings, free_point, in_front_of};

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
    pub hand: SharedHand,
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
    let (device_hz, safety) = (config.device_rate_hz(), config.safety());
    let limits = config.device.limits();
    let settings = config.settings.within(&limits);
    let scene = scene_of(config.grid, config.intensities, config.segments)?;
    let probe = first_point(&scene, config.start, settings.probe_radius)?;

    // what connects the loops
    let shared = Arc::new(Shared::default());
    let channels = Channels::new(probe);
    let hand = SharedHand::new(channels.hand, config.device.hand_stiffness());
    let meters = Meters::new(device_hz, config.rate_hz);
    let (ends, inbox) = picture_channels();
    let notices = ends.notices.clone();

    // the loops
    let dt = 1.0 / f64::from(device_hz);
    let to_device = Arc::clone(&shared);
    let device = DeviceLoop::new(config.device, channels.device, to_device, dt, safety);
    let start = servo_start(&scene, config.reference, probe, settings);
    let servo = ServoLoop::new(start, channels.servo, Arc::clone(&shared));
    let surfaces = ShownSurfaces::new(&scene, inbox.updates);
    let (deformation, deformation_loop) = Deformation::new(!config.real_time);
    let (mut fractions, fraction_loop) = MaskFractions::new();
    fractions.switch(config.mask_fractions);
    let parts = SimulationParts {
        scene,
        deformation,
        fractions,
    };
    let mut simulation = Simulation::new(parts, settings, limits, channels.simulation, ends);
    simulation.lead(hand.clone());
    begin(&mut simulation, config.reference, probe)?;
    let sources = FrameSources {
        records: channels.records,
        status: inbox.status,
        notices: inbox.notices,
        rates: meters.readers,
        shared: Arc::clone(&shared),
    };
    let picture = FrameCollector::new(sources, config.rate_hz, probe);
    let picture = Arc::new(Mutex::new(picture));

    report_start(&notices, config.start, probe);
    report_limits(&notices, &settings, &config.settings);
    Ok(Assembly {
        picture: Arc::clone(&picture),
        surfaces: surfaces.surfaces,
        pace: surfaces.pace,
        signal: surfaces.signal,
        deformable_view: deformation_loop.view(),
        hand,
        shared,
        notices,
        tape: simulation.tape(),
        loops: Loops {
            device: Metered::new(device, meters.device),
            servo: Metered::new(servo, meters.servo),
            simulation: Metered::new(simulation, meters.simulation),
            picture: Metered::new(picture, meters.picture),
            surfaces: surfaces.follow,
            deformation: deformation_loop,
            fractions: fraction_loop,
        },
    })
}

/// The picture's ends of what the simulation publishes.
struct PictureInbox {
    status: Output<SimulationStatus>,
    notices: Receiver<Notice>,
    updates: Receiver<SceneUpdate>,
}

fn picture_channels() -> (PictureEnds, PictureInbox) {
    let (status, status_out) = triple_buffer(&SimulationStatus::default());
    let (notices, notice_inbox) = mpsc::channel();
    let (updates, update_inbox) = mpsc::channel();
    let ends = PictureEnds {
        status,
        notices,
        updates,
    };
    let inbox = PictureInbox {
        status: status_out,
        notices: notice_inbox,
        updates: update_inbox,
    };
    (ends, inbox)
}

/// Surfaces, and the loop that makes them follow the voxels.
struct ShownSurfaces {
    surfaces: Arc<Mutex<Surfaces>>,
    pace: SurfacePace,
    signal: Arc<ChangeSignal>,
    follow: SurfaceLoop,
}

impl ShownSurfaces {
    fn new(scene: &Scene, updates: Receiver<SceneUpdate>) -> Self {
        let (pace, signal) = (SurfacePace::default(), Arc::new(ChangeSignal::default()));
        let surfaces = Surfaces::new(scene.voxels().intensities().clone());
        let surfaces = Arc::new(Mutex::new(surfaces));
        Self {
            follow: SurfaceLoop::new(
                updates,
                Arc::clone(&surfaces),
                pace.clone(),
                Arc::clone(&signal),
            ),
            surfaces,
            pace,
            signal,
        }
    }
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

/// The first pass of a simulation, which brings the device to the probe where the device is not in
/// the scene.
fn begin(
    simulation: &mut Simulation,
    reference: Reference,
    probe: DVec3,
) -> Result<(), SessionError> {
    if reference == Reference::View {
        simulation.place(probe, 0, true)?;
    }
    simulation.step();
    Ok(())
}

/// A free place for the probe: the start, or the free voxel nearest to it.
fn first_point(scene: &Scene, start: Option<DVec3>, radius: f64) -> Result<DVec3, SessionError> {
    let grid = scene.voxels().grid();
    let point = start.unwrap_or_else(|| in_front_of(grid));
    let touchable = touchable_of(scene, radius);
    free_point(&touchable.scene(grid), point).ok_or(SessionError::NoFreeVoxel {
        point,
        reach: PLACEMENT_REACH,
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

/// What counts the ticks of each thread, and where that can be read.
struct Meters {
    device: RateMeter,
    servo: RateMeter,
    simulation: RateMeter,
    picture: RateMeter,
    readers: RateReaders,
}

impl Meters {
    fn new(device_hz: u32, servo_hz: u32) -> Self {
        let (device, device_reader) = RateMeter::new(device_hz);
        let (servo, servo_reader) = RateMeter::new(servo_hz);
        let (simulation, simulation_reader) = RateMeter::new(SIMULATION_HZ);
        let (picture, picture_reader) = RateMeter::new(PICTURE_HZ);
        Self {
            device,
            servo,
            simulation,
            picture,
            readers: RateReaders {
                device: device_reader,
                servo: servo_reader,
                simulation: simulation_reader,
                picture: picture_reader,
            },
        }
    }
}
