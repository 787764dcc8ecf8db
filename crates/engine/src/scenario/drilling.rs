//! A drill that is driven straight into bone. Source of the scenario: thesis 5.28.3, figure 5.27.

use palpate_tools::drill::DrillSettings;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;

use super::drive::{Drive, Phase, Sample};
use super::rig::{Rig, TICKS_PER_PASS};
use crate::error::SessionError;
use crate::scene::Properties;

/// A contact that is gone for so long is over [ticks]; voxels that go part it for less.
const APART_TICKS: u64 = 100;

/// A drill and how it is driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrillDrive {
    /// Where it goes, and how fast.
    pub drive: Drive,
    /// Of the burr, and of the probe [mm].
    pub radius: f64,
    /// How it works.
    pub drill: DrillSettings,
}

/// What happened to the drill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrillEvent {
    /// Whether it came to the bone, or came free.
    pub is_contact: bool,
    /// When [s].
    pub time: f64,
    /// How far the drive was [mm].
    pub travel: f64,
    /// With which force [N].
    pub force: f64,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct DrillRun {
    /// Every tick; the tool is the burr's centre, held by the bone.
    pub samples: Vec<Sample>,
    /// Matter that is gone by each of them [mm³].
    pub volume: Vec<f64>,
    /// The power on it [N·mm/s].
    pub load: Vec<f64>,
    /// What happened.
    pub events: Vec<DrillEvent>,
    /// Ticks in which the probe was in a solid voxel: none, unless the engine is wrong.
    pub violations: u64,
}

/// Drives a drill into bone, segment 1. It turns on the way in and at rest.
///
/// # Errors
/// Where drive, radius or drill are none, or the bone belongs to another grid.
pub fn drive_drill(
    grid: &Grid,
    intensities: Intensities,
    bone: Segment,
    given: &DrillDrive,
) -> Result<DrillRun, SessionError> {
    let drive = &given.drive;
    drive.check()?;
    let mut rig = Rig::new(grid, intensities, drive, given.radius)?;
    let properties = Properties::of_threshold(true, None);
    let bone = rig.simulation.add_segment(bone, properties, false)?;
    rig.simulation.set_tool(Some(ToolSettings {
        drill: given.drill,
        ..ToolSettings::new(ToolKind::Drill, given.radius, vec![bone])
    }))?;
    rig.simulation.stroke(true)?;

    let mut run = DrillRun {
        samples: Vec::new(),
        volume: Vec::new(),
        load: Vec::new(),
        events: Vec::new(),
        violations: 0,
    };
    let mut ended = Ok(());
    drive.run(|phase, travel| {
        if phase == Phase::Out && run.samples.last().is_some_and(|last| last.phase != phase) {
            ended = rig.simulation.stroke(false);
        }
        let record = rig.tick(drive.start + drive.direction() * travel);
        let sample = Sample::of(drive, (phase, travel), &record, rig.servo.touched());
        let report = rig.simulation.tool_report();
        run.samples.push(sample);
        run.volume.push(report.volume);
        run.load.push(report.load);
        sample.force < drive.force_limit
    });
    ended?;
    run.events = events(&run.samples);
    run.violations = rig.violations();
    Ok(run)
}

/// Contacts that began and ended, by their force, which can begin later than voxels hold the burr; one
/// that is gone for some passes of the simulation goes on.
fn events(samples: &[Sample]) -> Vec<DrillEvent> {
    let apart = APART_TICKS.max(TICKS_PER_PASS) as usize;
    let mut events = Vec::new();
    let mut last_contact = None;
    for (place, sample) in samples.iter().enumerate() {
        let is_contact = sample.force > 0.0;
        let event = |is_contact, sample: &Sample| DrillEvent {
            is_contact,
            time: sample.time,
            travel: sample.travel,
            force: sample.force,
        };
        match (is_contact, last_contact) {
            (true, None) => events.push(event(true, sample)),
            (false, Some(last)) if place - last >= apart => {
                events.push(event(false, &samples[last]));
                last_contact = None;
            }
            _ => {}
        }
        if is_contact {
            last_contact = Some(place);
        }
    }
    events
}
