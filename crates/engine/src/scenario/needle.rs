//! A needle that is driven straight into layers of tissue.

use glam::DVec3;
use palpate_haptics::needle::NeedleForces;
use palpate_haptics::needle::events::NeedleEvent;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::tissue::Tissue;
use palpate_volume::walk::Walk;

use super::drive::{Drive, Phase, Sample};
use super::rig::{Rig, TICKS_PER_PASS};
use crate::error::SessionError;
use crate::scene::Properties;

/// Of the ball that the tool would be, which a needle is not [mm].
const RADIUS: f64 = 0.5;

/// A layer of the body.
#[derive(Clone, Debug)]
pub struct NeedleLayer {
    /// Its voxels.
    pub segment: Segment,
    /// What it is for the needle; none where no needle punctures it.
    pub tissue: Option<Tissue>,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct NeedleRun {
    /// Every tick; the tool is the tip, the segment that at the tip, or before it the one that
    /// is touched.
    pub samples: Vec<Sample>,
    /// What holds the needle in each of them, by what holds it [N].
    pub parts: Vec<NeedleForces>,
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
    drive: &Drive,
) -> Result<NeedleRun, SessionError> {
    drive.check()?;
    let mut rig = Rig::new(grid, intensities, drive, 0.0)?;
    take_needle(&mut rig, layers)?;
    let mut run = NeedleRun {
        samples: Vec::new(),
        parts: Vec::new(),
        events: Vec::new(),
        wall: wall_on(grid, layers, drive),
        violations: 0,
    };
    let mut tick = |phase, travel| {
        let (sample, parts) = tick(&mut rig, drive, (phase, travel));
        run.samples.push(sample);
        run.parts.push(parts);
        sample.force < drive.force_limit
    };
    drive.run(&mut tick);
    // so that what the servo has told last is heard
    for _ in 0..2 * TICKS_PER_PASS {
        tick(Phase::Out, 0.0);
    }
    run.events = rig.simulation.needle_report().events;
    run.violations = rig.violations();
    Ok(run)
}

/// Puts the layers there and the needle in the hand.
fn take_needle(rig: &mut Rig, layers: &[NeedleLayer]) -> Result<(), SessionError> {
    let (mut segments, mut tissues) = (Vec::<SegmentId>::new(), Vec::new());
    for layer in layers {
        let properties = Properties::of_threshold(true, None);
        let segment = layer.segment.clone();
        let id = rig.simulation.add_segment(segment, properties, false)?;
        if let Some(tissue) = layer.tissue {
            segments.push(id);
            tissues.push(tissue);
        }
    }
    rig.simulation.set_tool(Some(ToolSettings {
        tissues,
        ..ToolSettings::new(ToolKind::Needle, RADIUS, segments)
    }))?;
    rig.simulation.stroke(true)
}

/// One tick with the drive so far along its way [mm].
fn tick(rig: &mut Rig, drive: &Drive, now: (Phase, f64)) -> (Sample, NeedleForces) {
    let record = rig.tick(drive.start + drive.direction() * now.1);
    let needle = rig.servo.needle();
    let inserted = needle.insertion();
    let at_tip = inserted.and_then(|insertion| insertion.segment(needle.tissues()));
    let segment = at_tip.unwrap_or(rig.servo.touched());
    let sample = Sample::of(drive, now, &record, segment);
    let sample = match inserted {
        Some(insertion) => sample.with_tool(drive, insertion.line.at(insertion.shaft.tip)),
        None => sample,
    };
    (sample, needle.forces())
}

/// Where the line of a drive comes into a layer that no needle punctures [mm].
fn wall_on(grid: &Grid, layers: &[NeedleLayer], drive: &Drive) -> Option<f64> {
    let [from, to]: [DVec3; 2] =
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
