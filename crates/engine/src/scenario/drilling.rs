//! A drill that is driven straight into bone. Source of the scenario: thesis 5.28.3, figure 5.27.

use palpate_tools::drill::DrillSettings;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;

use super::contacts::{ContactEvent, contacts};
use super::drive::{Drive, Phase, Sample};
use super::rig::Rig;
use crate::error::SessionError;
use crate::scene::Properties;

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

/// What came of it.
#[derive(Clone, Debug)]
pub struct DrillRun {
    /// Every tick; the tool is the burr's centre, held by the bone.
    pub samples: Vec<Sample>,
    /// Matter that is gone by each of them [mm³].
    pub volume: Vec<f64>,
    /// The power on it [N·mm/s].
    pub load: Vec<f64>,
    /// Contacts that began and ended.
    pub events: Vec<ContactEvent>,
    /// Ticks in which the probe was in a solid voxel: none, unless the engine is wrong.
    pub violations: u64,
    /// The bone afterwards.
    pub bone: Segment,
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
    let before = bone.clone();
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
        bone: before,
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
    run.events = contacts(&run.samples);
    run.violations = rig.violations();
    if let Some(now) = rig.simulation.voxels().segment(bone) {
        run.bone = now.clone();
    }
    Ok(run)
}
