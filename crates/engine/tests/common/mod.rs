//! What the tests of the engine share: small scans, devices and a rig of bare loops.
#![allow(
    dead_code,
    missing_docs,
    reason = "each test file uses its part of this module"
)]

pub mod air;
pub mod changes;
pub mod recorder;

use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use glam::{DAffine3, DMat3, DVec3, IVec3, UVec3};
use palpate_device::scripted::{PathSample, ScriptedDevice};
use palpate_device::simulated::{SimulatedDevice, SimulatedSettings};
use palpate_device::{DeviceLimits, DeviceState, HapticDevice};
use palpate_engine::deformable::{Deformation, DeformationLoop};
use palpate_engine::notice::Notice;
use palpate_engine::picture::{Frame, PictureEnds, SceneUpdate, SimulationStatus};
use palpate_engine::scene::{FractionLoop, MaskFractions, Properties, Scene};
use palpate_engine::servo::{
    Channels, DeviceSample, HandTarget, Mapping, ServoLoop, ServoStart, Shared, TickRecord,
};
use palpate_engine::session::{Reference, Session, SessionConfig};
use palpate_engine::simulation::{Simulation, SimulationParts};
use palpate_engine::touch::{Settings, TouchFeel, TouchFeels, Touchable};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

/// Ticks after which everything that was told has arrived: the simulation takes its pass every
/// tenth, and the servo follows one change per tick, of which no test here sends more than three.
pub const ARRIVED: u32 = 20;
/// Ticks after which nothing changes any more: a move or a turn takes some 17, and the force
/// comes up to its depth by a tenth of a voxel per tick, of 5 voxels at most.
pub const SETTLED: u32 = 100;
/// How far before a face the probe stands at most [mm]: 1e-8 where it stops by itself, 1e-6 where
/// a body carries it.
pub const BEFORE_FACE: f64 = 2e-6;

pub const OBSTACLE: Properties = Properties {
    touchable: true,
    range: None,
    made_by: None,
    feel: TouchFeel {
        stiffness: None,
        friction_static: None,
        friction_kinetic: None,
    },
    pose: None,
    law: None,
    locked: false,
};

/// A motion of the scene [mm].
pub fn shifted(by: DVec3) -> DAffine3 {
    DAffine3::from_translation(by)
}

/// Voxels of 1 mm whose grid frame is the scene.
pub fn grid(dimensions: UVec3) -> Grid {
    let origin = DVec3::splat(0.5);
    Grid::new(dimensions, DVec3::ONE, origin, DMat3::IDENTITY).unwrap()
}

pub fn intensities(dimensions: UVec3) -> Intensities {
    let values = vec![0_i16; dimensions.as_usizevec3().element_product()];
    Intensities::new(dimensions, values, 1.0, 0.0).unwrap()
}

/// Values from -1000 to 1000 that rise and fall within some voxels, with noise.
pub fn waves(dimensions: UVec3) -> Intensities {
    let mut random = Random::new(77);
    let values: Vec<i16> = VoxelBox::of_dimensions(dimensions)
        .voxels()
        .map(|voxel| {
            let wave = (voxel.as_dvec3() * 0.45).map(f64::sin).element_product();
            (900.0 * wave + random.between(-100.0, 100.0)) as i16
        })
        .collect();
    Intensities::new(dimensions, values, 1.0, 0.0).unwrap()
}

/// Solid in a box of voxels.
pub fn box_segment(dimensions: UVec3, low: IVec3, high: IVec3) -> Segment {
    let solid = VoxelBox::new(low, high);
    Segment::from_fn(dimensions, move |voxel| solid.contains(voxel))
}

/// Every voxel of some is solid, by a hash of its place: a sponge.
pub fn sponge(dimensions: UVec3, seed: u64, one_in: u64) -> Segment {
    Segment::from_fn(dimensions, move |voxel| {
        let [x, y, z] = voxel.to_array().map(i32::cast_unsigned).map(u64::from);
        let mut hash = seed ^ (x << 42 | y << 21 | z).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        hash = (hash ^ hash >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (hash ^ hash >> 27).wrapping_mul(0x94d0_49bb_1331_11eb) >> 33 & 0xffff < 0x1_0000 / one_in
    })
}

pub fn limits() -> DeviceLimits {
    SimulatedSettings::default().limits
}

pub fn simulated() -> Box<dyn HapticDevice> {
    Box::new(SimulatedDevice::new(SimulatedSettings::default(), DVec3::ZERO).unwrap())
}

/// A device that goes from point to point, rows (time, x, y, z).
pub fn scripted(rows: &[[f64; 4]]) -> Box<dyn HapticDevice> {
    let samples = rows.iter().map(|&[time, x, y, z]| PathSample {
        time,
        position: DVec3::new(x, y, z),
    });
    Box::new(ScriptedDevice::new(samples.collect(), limits()).unwrap())
}

/// An offline session with one obstacle.
pub fn offline(
    dimensions: UVec3,
    segment: Segment,
    device: Box<dyn HapticDevice>,
    reference: Reference,
) -> SessionConfig {
    SessionConfig {
        segments: vec![(segment, OBSTACLE)],
        reference,
        real_time: false,
        ..SessionConfig::new(grid(dimensions), intensities(dimensions), device)
    }
}

pub fn started(config: SessionConfig) -> Session {
    Session::start(config).unwrap()
}

/// Waits until something holds. Threads on a busy machine may take their time: the limit is only
/// there so that what never comes fails the test and does not hang it.
pub fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < Duration::from_secs(60), "never: {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Takes frames of a session with threads until one is as wanted.
pub fn frame_where(session: &Session, wanted: impl Fn(&Frame) -> bool) -> Frame {
    let mut frame = session.frame();
    wait_until("a frame as wanted", || {
        frame = session.frame();
        wanted(&frame)
    });
    frame
}

/// Waits until the servo has ticked so often.
pub fn let_tick(session: &Session, ticks: u64) {
    let until = session.frame().tick + ticks;
    frame_where(session, |frame| frame.tick >= until);
}

/// What a device was made to do, seen from outside.
#[derive(Clone, Default)]
pub struct Seen(pub Arc<Mutex<Vec<DVec3>>>);

impl Seen {
    pub fn forces(&self) -> Vec<DVec3> {
        self.0.lock().unwrap().clone()
    }

    pub fn last(&self) -> DVec3 {
        let forces = self.0.lock().unwrap();
        forces.last().copied().unwrap_or(DVec3::ZERO)
    }
}

/// A device at a fixed place that notes every force, and may misbehave.
pub struct Probe {
    pub position: DVec3,
    pub seen: Seen,
    /// At each reading, with its number.
    pub on_read: Box<dyn FnMut(u64) + Send>,
    /// At each writing, with its number.
    pub on_write: Box<dyn FnMut(u64) + Send>,
    pub reads: u64,
    pub writes: u64,
}

impl Probe {
    pub fn at(position: DVec3, seen: &Seen) -> Self {
        Self {
            position,
            seen: seen.clone(),
            on_read: Box::new(|_| {}),
            on_write: Box::new(|_| {}),
            reads: 0,
            writes: 0,
        }
    }
}

impl HapticDevice for Probe {
    fn name(&self) -> &'static str {
        "probe"
    }

    fn limits(&self) -> DeviceLimits {
        limits()
    }

    fn read(&mut self, _dt: f64) -> DeviceState {
        self.reads += 1;
        (self.on_read)(self.reads);
        DeviceState {
            position: self.position,
            ..DeviceState::default()
        }
    }

    fn write(&mut self, force: DVec3, _torque: DVec3) {
        self.writes += 1;
        (self.on_write)(self.writes);
        self.seen.0.lock().unwrap().push(force);
    }
}

/// Servo and simulation with bare ends instead of device and picture.
pub struct Rig {
    pub servo: ServoLoop,
    pub simulation: Simulation,
    pub deformation: DeformationLoop,
    pub fractions: FractionLoop,
    pub device: triple_buffer::Input<DeviceSample>,
    pub forces: triple_buffer::Output<palpate_engine::servo::ForceCommand>,
    pub hand: triple_buffer::Input<HandTarget>,
    pub records: rtrb::Consumer<TickRecord>,
    pub status: triple_buffer::Output<SimulationStatus>,
    pub notices: Receiver<Notice>,
    pub updates: Receiver<SceneUpdate>,
    pub shared: Arc<Shared>,
    pub readings: u64,
    pub now: f64,
}

impl Rig {
    /// A rig without segments, whose scan has the value 0 everywhere; the device's frame is the
    /// scene.
    pub fn new(dimensions: UVec3, probe: DVec3) -> Self {
        Self::of_scan(intensities(dimensions), probe)
    }

    /// The same on a scan.
    pub fn of_scan(scan: Intensities, probe: DVec3) -> Self {
        let dimensions = scan.dimensions();
        let channels = Channels::new(probe);
        let shared = Arc::new(Shared::default());
        let (notices, notice_inbox) = mpsc::channel();
        let (news_in, updates) = mpsc::channel();
        let (status_in, status) = triple_buffer::triple_buffer(&SimulationStatus::default());
        let start = ServoStart {
            grid: grid(dimensions),
            touchable: Touchable::new(&grid(dimensions), Vec::new(), 0.0).unwrap(),
            mapping: Mapping::IDENTITY,
            probe,
            settings: Settings::default(),
            feels: TouchFeels::default(),
        };
        let scene = Scene::new(Voxels::new(grid(dimensions), scan).unwrap());
        let (deformation, deformation_loop) = Deformation::new(true);
        let (fractions, fraction_loop) = MaskFractions::new();
        Self {
            servo: ServoLoop::new(start, channels.servo, Arc::clone(&shared)),
            deformation: deformation_loop,
            fractions: fraction_loop,
            simulation: Simulation::new(
                SimulationParts {
                    scene,
                    deformation,
                    fractions,
                },
                Settings::default(),
                limits(),
                channels.simulation,
                PictureEnds {
                    status: status_in,
                    notices,
                    updates: news_in,
                },
            ),
            device: channels.device.samples,
            forces: channels.device.forces,
            hand: channels.hand,
            records: channels.records,
            status,
            notices: notice_inbox,
            updates,
            shared,
            readings: 0,
            now: 0.0,
        }
    }

    /// The device is read at a point [mm], and has sent nothing.
    pub fn read_at(&mut self, point: DVec3) {
        self.read_pressed(point, 0.0);
    }

    /// The device is read at a point [mm], and has sent so much upward [N].
    fn read_pressed(&mut self, point: DVec3, sent: f64) {
        self.readings += 1;
        self.device.write(DeviceSample {
            number: self.readings,
            time: self.now,
            state: DeviceState {
                position: point,
                ..DeviceState::default()
            },
            sent_in_device: DVec3::Z * sent,
        });
    }

    /// A tick of the servo with the device at a point; gives its record.
    pub fn tick_at(&mut self, point: DVec3) -> TickRecord {
        self.read_at(point);
        self.tick()
    }

    /// The same with a device that has sent so much upward [N].
    pub fn tick_sent(&mut self, point: DVec3, sent: f64) -> TickRecord {
        self.read_pressed(point, sent);
        self.tick()
    }

    fn tick(&mut self) -> TickRecord {
        self.servo.step(self.now);
        self.now += 1e-3;
        self.records.pop().expect("every tick is recorded")
    }

    /// 10 ms: ten ticks with the device at a point, which sends so much upward [N], and a pass of the
    /// simulation.
    pub fn pass(&mut self, device: DVec3, sent: f64) -> TickRecord {
        let mut last = TickRecord::default();
        for _ in 0..10 {
            self.read_pressed(device, sent);
            last = self.tick();
        }
        self.simulation.step();
        last
    }

    /// Ticks with the simulation between them, as a session has it; gives the last record.
    pub fn ticks(&mut self, count: u32, device: DVec3) -> TickRecord {
        let mut last = None;
        for tick in 0..count {
            last = Some(self.tick_at(device));
            if tick % 10 == 0 {
                self.simulation.step();
            }
            assert_eq!(self.violations(), 0);
        }
        self.simulation.step();
        last.expect("some ticks")
    }

    /// Makes a segment the voxels from `low` to `high`, as a dragged threshold does.
    pub fn set_threshold(&mut self, id: SegmentId, (low, high): (f64, f64)) {
        let segment = self.simulation.voxels().threshold(low, high);
        let range = Some((low, high));
        self.simulation.replace_segment(id, segment, range).unwrap();
    }

    pub fn violations(&self) -> u64 {
        let counters = &self.shared.counters;
        counters
            .violations
            .load(std::sync::atomic::Ordering::Relaxed)
    }
}

/// Seeded numbers.
pub struct Random(oorandom::Rand64);

impl Random {
    pub fn new(seed: u128) -> Self {
        Self(oorandom::Rand64::new(seed))
    }

    /// At least 0, below 1.
    pub fn share(&mut self) -> f64 {
        self.0.rand_float()
    }

    pub fn below(&mut self, end: u64) -> u64 {
        self.0.rand_range(0..end)
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    pub fn point(&mut self, low: f64, high: f64) -> DVec3 {
        DVec3::new(
            self.between(low, high),
            self.between(low, high),
            self.between(low, high),
        )
    }

    /// A box of at most `edge` voxels along each axis that begins in the grid.
    pub fn voxel_box(&mut self, dimensions: UVec3, edge: u64) -> VoxelBox {
        let low = dimensions
            .map(|n| self.below(u64::from(n)) as u32)
            .as_ivec3();
        let size = UVec3::ONE.map(|n| n + self.below(edge) as u32).as_ivec3();
        VoxelBox::new(low, low + size)
    }
}
