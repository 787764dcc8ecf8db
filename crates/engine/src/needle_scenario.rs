//! A needle that is driven straight into a scan without a device: what a robot with a force limit
//! would feel. `palpate scenario needle-skull` and `needle-liver` are made of it.
//!
//! Servo and simulation are stepped in lock-step, a thousand ticks and a hundred passes in a
//! second of the scenario; there is no clock. The drive goes in at a constant speed until the
//! force comes to the limit or the way ends, rests, and goes out again.
//!
//! Frame: scene [mm]; travel is mm along the drive's line from its start; N, s.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc;

use glam::DVec3;
use palpate_device::{DeviceLimits, DeviceState};
use palpate_haptics::needle::NeedleForces;
use palpate_haptics::needle::events::NeedleEvent;
use palpate_tools::tool::{ToolKind, ToolSettings};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::tissue::Tissue;
use palpate_volume::voxels::Voxels;
use palpate_volume::walk::Walk;

use crate::deformation::Deformation;
use crate::deformation_loop::DeformationLoop;
use crate::error::SessionError;
use crate::feel::Feels;
use crate::handover::{Channels, DeviceSample, TickRecord};
use crate::mapping::Mapping;
use crate::scene::{Properties, Scene};
use crate::servo::{ServoLoop, ServoStart};
use crate::session_config::check_point;
use crate::settings::Settings;
use crate::shared::Shared;
use crate::simulation::{Simulation, SimulationStatus};
use crate::touchable::Touchable;

/// Ticks in a second.
const RATE_HZ: u32 = 1000;
/// Ticks between two passes of the simulation.
const TICKS_PER_PASS: u64 = 10;
/// Longest way of a drive [mm].
const LONGEST: f64 = 1000.0;
/// Ticks of a drive, at most.
const MOST_TICKS: f64 = 5e6;

/// A layer of the body.
#[derive(Clone, Debug)]
pub struct NeedleLayer {
    /// Its voxels.
    pub segment: Segment,
    /// What it is for the needle; none where no needle punctures it.
    pub tissue: Option<Tissue>,
}

/// How the needle is driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeedleDrive {
    /// Where the tip begins [mm], in a free voxel.
    pub start: DVec3,
    /// Where it goes to, unless the force stops it [mm].
    pub target: DVec3,
    /// How fast [mm/s], > 0.
    pub speed: f64,
    /// The force at which it stops [N], > 0.
    pub force_limit: f64,
    /// How long it rests before it goes out again [s].
    pub rest_secs: f64,
    /// Of the spring between drive and needle [N/mm].
    pub stiffness: f64,
}

impl NeedleDrive {
    /// From a point to another one, as fast and as hard as a person would.
    #[must_use]
    pub fn between(start: DVec3, target: DVec3) -> Self {
        Self {
            start,
            target,
            speed: 5.0,
            force_limit: 6.0,
            rest_secs: 1.0,
            stiffness: Settings::default().stiffness,
        }
    }
}

/// What the drive does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Goes in.
    In,
    /// Rests.
    Rest,
    /// Goes out.
    Out,
}

impl Phase {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::In => "in",
            Self::Rest => "rest",
            Self::Out => "out",
        }
    }
}

/// One tick of the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeedleSample {
    /// When [s].
    pub time: f64,
    /// What the drive does.
    pub phase: Phase,
    /// How far the drive is [mm].
    pub travel: f64,
    /// How far the tip is [mm]; less than the travel by what the spring gives.
    pub tip: f64,
    /// How far the hard probe is [mm].
    pub probe: f64,
    /// Force on the drive [N], against its way in where positive.
    pub force: f64,
    /// Size of the force across the way [N].
    pub across: f64,
    /// What holds the needle, by what holds it [N].
    pub parts: NeedleForces,
    /// The segment at the tip, or before it the one that is touched; 0 where there is none.
    pub segment: u8,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct NeedleRun {
    /// Every tick.
    pub samples: Vec<NeedleSample>,
    /// What happened.
    pub events: Vec<NeedleEvent>,
    /// Travel at which the line comes into what no needle punctures [mm].
    pub wall: Option<f64>,
    /// Ticks in which the probe was in a solid voxel: none, unless the engine is wrong.
    pub violations: u64,
}

/// Drives a needle into layers, numbered from 1 as they stand here.
///
/// # Errors
/// Where the drive is none, a layer belongs to another grid, or a tissue is none.
pub fn drive_needle(
    grid: &Grid,
    intensities: Intensities,
    layers: &[NeedleLayer],
    drive: &NeedleDrive,
) -> Result<NeedleRun, SessionError> {
    check(drive)?;
    let mut rig = Rig::new(grid, intensities, layers, drive)?;
    let line = drive.target - drive.start;
    let way = line.length();
    let direction = line / way;
    let step = drive.speed / f64::from(RATE_HZ);

    let mut run = NeedleRun {
        samples: Vec::new(),
        events: Vec::new(),
        wall: wall_on(grid, layers, drive),
        violations: 0,
    };
    let mut travel = 0.0;
    let mut push = |phase: Phase, travel: f64, rig: &mut Rig| {
        let sample = rig.tick(phase, travel, direction);
        run.samples.push(sample);
        sample.force
    };
    loop {
        let force = push(Phase::In, travel, &mut rig);
        if travel >= way || force >= drive.force_limit {
            break;
        }
        travel = (travel + step).min(way);
    }
    let rest = (drive.rest_secs * f64::from(RATE_HZ)).round() as u64;
    for _ in 0..rest {
        push(Phase::Rest, travel, &mut rig);
    }
    while travel > 0.0 {
        travel = (travel - step).max(0.0);
        push(Phase::Out, travel, &mut rig);
    }
    // so that what the servo has told last is heard
    for _ in 0..2 * TICKS_PER_PASS {
        push(Phase::Out, 0.0, &mut rig);
    }
    run.events = rig.simulation.needle_report().events;
    run.violations = rig.shared.counters.violations.load(Relaxed);
    Ok(run)
}

fn check(drive: &NeedleDrive) -> Result<(), SessionError> {
    check_point("start", drive.start)?;
    check_point("target", drive.target)?;
    let way = drive.start.distance(drive.target);
    let settings = Settings {
        stiffness: drive.stiffness,
        force_limit: drive.force_limit,
        ..Settings::default()
    };
    settings.check()?;
    let ticks = way / drive.speed * f64::from(RATE_HZ);
    let is_way = way > 0.0 && way <= LONGEST;
    let is_speed = drive.speed > 0.0 && ticks <= MOST_TICKS;
    if is_way && is_speed && (0.0..=3600.0).contains(&drive.rest_secs) {
        Ok(())
    } else {
        Err(SessionError::Drive {
            way,
            speed: drive.speed,
            rest: drive.rest_secs,
        })
    }
}

/// Where the line of a drive comes into a layer that no needle punctures [mm].
fn wall_on(grid: &Grid, layers: &[NeedleLayer], drive: &NeedleDrive) -> Option<f64> {
    let [from, to] =
        [drive.start, drive.target].map(|point| grid.grid_from_patient().transform_point3(point));
    let mut walk = Walk::new(from, to)?;
    let is_wall = |layer: &NeedleLayer| layer.tissue.is_none();
    loop {
        let voxel = walk.voxel();
        let mut hard = layers.iter().filter(|layer| is_wall(layer));
        if hard.any(|layer| layer.segment.contains(voxel)) {
            return Some(walk.fraction() * drive.start.distance(drive.target));
        }
        if !walk.advance() {
            return None;
        }
    }
}

/// Servo and simulation with a drive in place of a device.
struct Rig {
    servo: ServoLoop,
    simulation: Simulation,
    device: triple_buffer::Input<DeviceSample>,
    records: rtrb::Consumer<TickRecord>,
    // what nobody reads is kept, so that the writing ends stay whole
    _status: triple_buffer::Output<SimulationStatus>,
    _notices: mpsc::Receiver<crate::frame::Notice>,
    _news: mpsc::Receiver<crate::scene_news::SceneNews>,
    _deformation: DeformationLoop,
    shared: Arc<Shared>,
    start: DVec3,
    ticks: u64,
}

impl Rig {
    fn new(
        grid: &Grid,
        intensities: Intensities,
        layers: &[NeedleLayer],
        drive: &NeedleDrive,
    ) -> Result<Self, SessionError> {
        let settings = Settings {
            stiffness: drive.stiffness,
            force_limit: drive.force_limit,
            ..Settings::default()
        };
        let channels = Channels::new(drive.start);
        let shared = Arc::new(Shared::default());
        let (status, status_out) = triple_buffer::triple_buffer(&SimulationStatus::default());
        let (notices, notice_inbox) = mpsc::channel();
        let (news, news_inbox) = mpsc::channel();
        let start = ServoStart {
            grid: *grid,
            touchable: Touchable::new(grid, Vec::new(), settings.probe_radius)?,
            mapping: Mapping::IDENTITY,
            probe: drive.start,
            settings,
            feels: Feels::default(),
        };
        let limits = DeviceLimits {
            max_force: settings.force_limit,
            max_continuous_force: settings.force_limit,
            max_stiffness: settings.stiffness,
            damping: 0.0,
            workspace_radius: LONGEST,
        };
        // without a model nothing asks it for anything
        let (deformation, deformation_loop) = Deformation::new(true);
        let mut rig = Self {
            servo: ServoLoop::new(start, channels.servo, Arc::clone(&shared)),
            simulation: Simulation::new(
                (Scene::new(Voxels::new(*grid, intensities)?), deformation),
                settings,
                limits,
                channels.simulation,
                (status, notices, news),
            ),
            device: channels.device.samples,
            records: channels.records,
            _status: status_out,
            _notices: notice_inbox,
            _news: news_inbox,
            _deformation: deformation_loop,
            shared,
            start: drive.start,
            ticks: 0,
        };
        rig.take_needle(layers)?;
        Ok(rig)
    }

    /// Puts the layers there and the needle in the hand.
    fn take_needle(&mut self, layers: &[NeedleLayer]) -> Result<(), SessionError> {
        let (mut segments, mut tissues) = (Vec::<SegmentId>::new(), Vec::new());
        for layer in layers {
            let properties = Properties::of_threshold(true, None);
            let segment = layer.segment.clone();
            let id = self.simulation.add_segment(segment, properties, false)?;
            if let Some(tissue) = layer.tissue {
                segments.push(id);
                tissues.push(tissue);
            }
        }
        self.simulation.set_tool(Some(ToolSettings {
            tissues,
            ..ToolSettings::new(ToolKind::Needle, 0.5, segments)
        }))?;
        self.simulation.stroke(true)
    }

    /// One tick with the drive so far along its way [mm].
    fn tick(&mut self, phase: Phase, travel: f64, direction: DVec3) -> NeedleSample {
        let time = self.ticks as f64 / f64::from(RATE_HZ);
        let position = self.start + direction * travel;
        self.ticks += 1;
        self.device.write(DeviceSample {
            number: self.ticks,
            time,
            state: DeviceState {
                position,
                ..DeviceState::default()
            },
            sent_in_device: DVec3::ZERO,
        });
        self.servo.step(time);
        if self.ticks.is_multiple_of(TICKS_PER_PASS) {
            self.simulation.step();
        }
        let record = self.records.pop().expect("every tick is recorded");
        let along = |point: DVec3| (point - self.start).dot(direction);
        let force = -record.force.dot(direction);
        let needle = self.servo.needle();
        let inserted = needle.insertion();
        let tip = inserted.map(|insertion| insertion.line.at(insertion.shaft.tip));
        let at_tip = inserted.and_then(|insertion| insertion.segment(needle.tissues()));
        NeedleSample {
            time,
            phase,
            travel,
            tip: along(tip.unwrap_or(record.contact_point)),
            probe: along(record.proxy),
            force,
            across: (record.force + direction * force).length(),
            parts: needle.forces(),
            segment: at_tip.unwrap_or(self.servo.touched()),
        }
    }
}
