//! `_core.drive_needle`, `drive_drill` and `press`: for `palpate scenario`.
//!
//! What comes back has one value a tick in each column, as `palpate.scenario_run` names them.

use numpy::{PyArray1, ToPyArray};
use palpate_engine::scenario::contacts::ContactEvent;
use palpate_engine::scenario::drilling::{DrillDrive, drive_drill as drill};
use palpate_engine::scenario::drive::{Drive, Sample};
use palpate_engine::scenario::needle::{NeedleLayer, drive_needle as needle};
use palpate_engine::scenario::palpation::{PressedLayer, press as press_one};
use palpate_engine::scenario::rearranging::{RearrangingDrive, drive_rearranging, thesis_bone};
use palpate_haptics::needle::NeedleForces;
use palpate_volume::tissue::Tissue;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays::{Triple, rows, vector};
use crate::errors::CoreError;
use crate::frame::dictionary;
use crate::material::material_named;
use crate::parallel::parallel;
use crate::segment::PySegment;
use crate::tool::{Event, drill_settings, event_tuple};
use crate::volume::PyVolume;

/// Figures of a tissue, in the order of the fields of `palpate.needle.Tissue`.
pub type Figures = [f64; 8];

/// Start, target, speed, force limit, rest and stiffness: what `palpate.drive.Drive.given` gives.
type GivenDrive = (Triple, Triple, f64, f64, f64, f64);

/// When a contact began (true) or ended: time, travel, force.
type Contact = (bool, f64, f64, f64);

/// The presets by name.
#[pyfunction]
pub fn needle_tissues() -> Vec<(&'static str, Figures)> {
    let presets = Tissue::PRESETS.into_iter();
    presets
        .map(|(name, tissue)| (name, tissue.figures()))
        .collect()
}

/// Drives a needle into layers; those without a tissue are hard.
#[pyfunction]
pub fn drive_needle<'py>(
    py: Python<'py>,
    volume: PyRef<'py, PyVolume>,
    layers: Vec<(PyRef<'py, PySegment>, Option<Figures>)>,
    drive: GivenDrive,
) -> PyResult<Bound<'py, PyDict>> {
    let layers: Vec<NeedleLayer> = layers
        .iter()
        .map(|(segment, figures)| NeedleLayer {
            segment: segment.segment.clone(),
            tissue: figures.map(Tissue::of_figures),
        })
        .collect();
    let (grid, values, drive) = (volume.grid, volume.intensities.clone(), drive_of(drive));
    let run = parallel(py, || needle(&grid, values, &layers, &drive)).map_err(CoreError::from)?;
    let events: Vec<Event> = run.events.iter().map(event_tuple).collect();
    let part = |of: fn(&NeedleForces) -> f64| column(py, run.parts.iter().map(of));
    let more = dictionary!(py,
        "stiffness": part(|parts| parts.stiffness),
        "cutting": part(|parts| parts.cutting),
        "friction": part(|parts| parts.friction),
        "wall": part(|parts| parts.wall),
        "lateral": part(|parts| parts.lateral),
        "events": events,
        "wall_at": run.wall,
        "violations": run.violations,
    );
    with(samples_dict(py, &run.samples)?, more)
}

/// Drives a drill into bone.
#[pyfunction]
pub fn drive_drill<'py>(
    py: Python<'py>,
    volume: PyRef<'py, PyVolume>,
    bone: PyRef<'py, PySegment>,
    drive: GivenDrive,
    radius: f64,
    air: Option<f64>,
    energy: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let given = DrillDrive {
        drive: drive_of(drive),
        radius,
        drill: drill_settings(air, energy),
    };
    let (grid, values, bone) = (
        volume.grid,
        volume.intensities.clone(),
        bone.segment.clone(),
    );
    let run = parallel(py, || drill(&grid, values, bone, &given)).map_err(CoreError::from)?;
    let more = dictionary!(py,
        "volume": column(py, run.volume.iter().copied()),
        "load": column(py, run.load.iter().copied()),
        "events": contacts(&run.events),
        "violations": run.violations,
        "bone": PySegment { segment: run.bone },
    );
    with(samples_dict(py, &run.samples)?, more)
}

/// Presses a ball into bone of particles, so many times weaker than the thesis', and takes it out.
#[pyfunction]
pub fn drive_rearranging_ball<'py>(
    py: Python<'py>,
    volume: PyRef<'py, PyVolume>,
    bone: PyRef<'py, PySegment>,
    drive: GivenDrive,
    radius: f64,
    softening: f64,
    is_hu: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let given = RearrangingDrive {
        drive: drive_of(drive),
        radius,
        law: thesis_bone(softening, is_hu).map_err(CoreError::from)?,
    };
    let (grid, values, bone) = (
        volume.grid,
        volume.intensities.clone(),
        bone.segment.clone(),
    );
    let run =
        parallel(py, || drive_rearranging(&grid, values, bone, &given)).map_err(CoreError::from)?;
    let more = dictionary!(py,
        "volume": column(py, run.volume.iter().copied()),
        "piled": column(py, run.piled.iter().copied()),
        "events": contacts(&run.events),
        "answers": run.answers[0],
        "slips": run.answers[1],
        "violations": run.violations,
        "bone": PySegment { segment: run.bone },
    );
    with(samples_dict(py, &run.samples)?, more)
}

fn contacts(events: &[ContactEvent]) -> Vec<Contact> {
    let each = events.iter();
    each.map(|event| (event.is_contact, event.time, event.travel, event.force))
        .collect()
}

/// Presses a ball into layers by a model; those without a material are hard.
#[pyfunction]
pub fn press<'py>(
    py: Python<'py>,
    volume: PyRef<'py, PyVolume>,
    layers: Vec<(PyRef<'py, PySegment>, Option<String>)>,
    drive: GivenDrive,
    deepest: f64,
    radius: f64,
    model: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let layers: Vec<PressedLayer> = layers
        .iter()
        .map(|(segment, material)| {
            let law = material.as_deref().map(material_named).transpose()?;
            let segment = segment.segment.clone();
            Ok(PressedLayer { segment, law })
        })
        .collect::<Result<_, CoreError>>()?;
    let (grid, values, drive) = (volume.grid, volume.intensities.clone(), drive_of(drive));
    let run = parallel(py, || {
        press_one(&grid, values, &layers, (model, radius), (&drive, deepest))
    })
    .map_err(CoreError::from)?;
    let told = samples_dict(py, &run.samples)?;
    told.set_item("answers", run.answers)?;
    told.set_item("violations", run.violations)?;
    Ok(told)
}

fn drive_of((start, target, speed, force_limit, rest_secs, stiffness): GivenDrive) -> Drive {
    Drive {
        start: vector(start),
        target: vector(target),
        speed,
        force_limit,
        rest_secs,
        stiffness,
    }
}

/// What all scenarios tell of each tick.
fn samples_dict<'py>(py: Python<'py>, samples: &[Sample]) -> PyResult<Bound<'py, PyDict>> {
    let of = |value: fn(&Sample) -> f64| column(py, samples.iter().map(value));
    let tools: Vec<_> = samples.iter().map(|sample| sample.tool).collect();
    let segments: Vec<u8> = samples.iter().map(|sample| sample.segment).collect();
    let phases = samples.iter().map(|sample| sample.phase.name());
    dictionary!(py,
        "time": of(|sample| sample.time),
        "phase": PyList::new(py, phases)?,
        "tool": rows(py, &tools),
        "travel": of(|sample| sample.travel),
        "tip": of(|sample| sample.tip),
        "probe": of(|sample| sample.probe),
        "force": of(|sample| sample.force),
        "across": of(|sample| sample.across),
        "segment": segments.to_pyarray(py),
    )
}

/// One dictionary of two.
fn with<'py>(
    told: Bound<'py, PyDict>,
    more: PyResult<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyDict>> {
    told.update(more?.as_mapping())?;
    Ok(told)
}

fn column<'py>(py: Python<'py>, values: impl Iterator<Item = f64>) -> Bound<'py, PyArray1<f64>> {
    values.collect::<Vec<f64>>().to_pyarray(py)
}
