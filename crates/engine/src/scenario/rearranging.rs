//! A ball that presses bone of particles aside: the thesis' drilling, which rearranges voxels and removes
//! none.
//!
//! The hand feels the particles' own force. That of the voxels alone (5.23) is not enough for a ball: it reaches
//! one voxel ahead, where voxels at its rim stay more than half full and hold it.
//!
//! Source: thesis 5.28.3, figures 5.26 and 5.27; 5.23, its last paragraph.

use glam::DVec3;
use palpate_deform::material::{MaterialError, MaterialLaw, SolidSi};
use palpate_deform::registry::ModelOptions;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;

use super::contacts::{ContactEvent, contacts};
use super::drive::{Drive, Sample};
use super::rig::Rig;
use crate::error::SessionError;
use crate::scene::Properties;

/// Cells along an edge of the particles' box.
const BOX_CELLS: u32 = 17;
/// Ticks for which a tool that has come out waits at least for particles to come to rest, and at most.
const SETTLING_TICKS: [u64; 2] = [100, 3000];

/// A ball and how it is driven into particles.
#[derive(Clone, Copy, Debug)]
pub struct RearrangingDrive {
    /// Where it goes, and how fast.
    pub drive: Drive,
    /// Of the ball, and of the probe [mm].
    pub radius: f64,
    /// What the particles are made of.
    pub law: MaterialLaw,
}

/// Bone as the thesis has it (5.28.3), so many times weaker; by HU where the scan has that, else that of its
/// upper end.
///
/// The particles' law has one scale of force, D: weaker ones move alike, and push so many times less.
///
/// # Errors
/// Where `softening` leaves no matter.
pub fn thesis_bone(softening: f64, is_hu: bool) -> Result<MaterialLaw, MaterialError> {
    let solid = |young: f64, poisson, density| SolidSi {
        young: young / softening,
        poisson,
        density,
        fracture_energy: f64::INFINITY,
        friction: 0.0,
        stiffening: 0.0,
    };
    let (low, high) = (solid(5e9, 0.30, 920.0), solid(21e9, 0.32, 1900.0));
    Ok(match is_hu {
        true => MaterialLaw::linear([700.0, 3000.0], low, high)?,
        false => MaterialLaw::constant(high)?,
    })
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct RearrangingRun {
    /// Every tick; the tool is the ball's centre, held by the bone.
    pub samples: Vec<Sample>,
    /// Places of bone that are empty by each of them [mm³].
    pub volume: Vec<f64>,
    /// Empty places that are bone by then [mm³].
    pub piled: Vec<f64>,
    /// Contacts that began and ended.
    pub events: Vec<ContactEvent>,
    /// Answers of the model, and of them those in which particles slipped.
    pub answers: [u64; 2],
    /// The bone afterwards.
    pub bone: Segment,
    /// Ticks in which the probe was in a solid voxel: none, unless the engine is wrong.
    pub violations: u64,
}

/// Drives a ball into bone, segment 1, and out, and waits until particles are at rest.
///
/// # Errors
/// Where drive or radius are none, or the bone belongs to another grid.
pub fn drive_rearranging(
    grid: &Grid,
    intensities: Intensities,
    bone: Segment,
    given: &RearrangingDrive,
) -> Result<RearrangingRun, SessionError> {
    let drive = &given.drive;
    drive.check()?;
    let mut rig = Rig::new(grid, intensities, drive, given.radius)?;
    let properties = Properties {
        law: Some(given.law),
        ..Properties::of_threshold(true, None)
    };
    let before = bone.clone();
    let id = rig.simulation.add_segment(bone, properties, false)?;
    let options = ModelOptions {
        edge: Some(BOX_CELLS),
        rearranges: true,
        ..ModelOptions::default()
    };
    rig.simulation
        .set_deformation(Some("fcc-lj"), &options, false)?;

    let near = around(grid, drive);
    let mut run = RearrangingRun {
        samples: Vec::new(),
        volume: Vec::new(),
        piled: Vec::new(),
        events: Vec::new(),
        answers: [0; 2],
        bone: before.clone(),
        violations: 0,
    };
    let mut moved = [0.0; 2];
    let mut seen = rig.simulation.voxels().edit_number();
    drive.run(|phase, travel| {
        let record = rig.tick(drive.start + drive.direction() * travel);
        let sample = Sample::of(drive, (phase, travel), &record, rig.servo.touched());
        let now = rig.simulation.voxels();
        if now.edit_number() != seen {
            seen = now.edit_number();
            moved = now.segment(id).map_or(moved, |now| {
                differing(&before, now, &near).map(|count| count * grid.voxel_volume())
            });
        }
        // what no force holds is where the drive is; its proxy waits before the hard voxels
        let is_free = record.force == DVec3::ZERO;
        let free = sample.with_tool(drive, drive.start + drive.direction() * travel);
        run.samples.push(if is_free { free } else { sample });
        run.volume.push(moved[0]);
        run.piled.push(moved[1]);
        sample.force < drive.force_limit
    });
    let [least, most] = SETTLING_TICKS;
    for tick in 0..most {
        let comes_back = rig.simulation.deformation().report.comes_back();
        if tick >= least && !comes_back {
            break;
        }
        rig.tick(drive.start);
    }
    let status = rig.simulation.deformation();
    run.answers = [status.answers, status.slips];
    run.events = contacts(&run.samples);
    run.violations = rig.violations();
    if let Some(now) = rig.simulation.voxels().segment(id) {
        run.bone = now.clone();
    }
    Ok(run)
}

/// Voxels that the particles of a drive can reach.
fn around(grid: &Grid, drive: &Drive) -> VoxelBox {
    let reach = f64::from(BOX_CELLS) * grid.smallest_spacing();
    let (low, high) = (
        drive.start.min(drive.target) - reach,
        drive.start.max(drive.target) + reach,
    );
    let corners = (0..8).map(|corner| {
        let pick = |axis: usize| [low, high][corner >> axis & 1][axis];
        grid.grid_from_patient()
            .transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
    });
    let corners: Vec<DVec3> = corners.collect();
    let least = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let most = corners
        .iter()
        .copied()
        .fold(DVec3::NEG_INFINITY, DVec3::max);
    VoxelBox::new(least.floor().as_ivec3(), most.ceil().as_ivec3()).intersect(&grid.bounds())
}

/// How many voxels are gone, and how many have come.
fn differing(before: &Segment, now: &Segment, near: &VoxelBox) -> [f64; 2] {
    let (mut gone, mut come) = (0_u32, 0_u32);
    for voxel in near.voxels() {
        match (before.contains(voxel), now.contains(voxel)) {
            (true, false) => gone += 1,
            (false, true) => come += 1,
            _ => {}
        }
    }
    [gone, come].map(f64::from)
}
