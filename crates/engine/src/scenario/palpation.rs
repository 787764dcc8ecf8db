//! A ball that presses soft tissue, place by place, as a finger palpates.
//!
//! Every press begins from tissue at rest. Design, section 6; issue of deformation, scenarios.

use palpate_deform::material::MaterialLaw;
use palpate_deform::registry::ModelOptions;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;

use super::drive::{Drive, Sample};
use super::rig::Rig;
use crate::error::SessionError;
use crate::scene::Properties;
use crate::touch::TouchFeel;

/// A layer of the body.
#[derive(Clone, Debug)]
pub struct PressedLayer {
    /// Its voxels.
    pub segment: Segment,
    /// What it is made of; none where it is hard.
    pub law: Option<MaterialLaw>,
}

/// What one press felt.
#[derive(Clone, Debug, PartialEq)]
pub struct Press {
    /// Every tick; the tool is the ball in the tissue.
    pub samples: Vec<Sample>,
    /// Answers of the model.
    pub answers: u64,
    /// Ticks in which the probe was in a solid voxel: none, unless the engine is wrong.
    pub violations: u64,
}

/// Presses a ball of a radius [mm] into layers, numbered from 1 as they stand here, by a model of
/// a name, until it has gone `deepest` along the drive's way [mm] or the force stops it.
///
/// # Errors
/// Where the drive is none, there is no such model, the ball is too large, or a layer belongs to
/// another grid.
pub fn press(
    grid: &Grid,
    intensities: Intensities,
    layers: &[PressedLayer],
    (model, radius): (&str, f64),
    (drive, deepest): (&Drive, f64),
) -> Result<Press, SessionError> {
    drive.check()?;
    let mut rig = Rig::new(grid, intensities, drive, radius)?;
    for layer in layers {
        let properties = Properties {
            law: layer.law,
            // what holds the ball aside would be taken for what is under it
            feel: TouchFeel::SLIPPERY,
            ..Properties::of_threshold(true, None)
        };
        let segment = layer.segment.clone();
        let _: SegmentId = rig.simulation.add_segment(segment, properties, false)?;
    }
    rig.simulation
        .set_deformation(Some(model), &ModelOptions::default(), false)?;
    let mut samples = Vec::new();
    drive.run(|phase, travel| {
        let record = rig.tick(drive.start + drive.direction() * travel);
        let sample = Sample::of(drive, (phase, travel), &record, rig.servo.touched());
        samples.push(sample);
        sample.force < drive.force_limit && sample.tip < deepest
    });
    Ok(Press {
        samples,
        answers: rig.simulation.deformation().answers,
        violations: rig.violations(),
    })
}
