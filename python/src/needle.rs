//! `_core.needle_tissues` and `_core.drive_needle`: for `palpate scenario needle-…`.

use numpy::{PyArray1, ToPyArray};
use palpate_engine::needle_scenario::{
    NeedleDrive, NeedleLayer, NeedleRun, NeedleSample, drive_needle as drive,
};
use palpate_haptics::needle::events::NeedleEvent;
use palpate_volume::tissue::Tissue;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays::{Triple, vector};
use crate::errors::CoreError;
use crate::frame::dictionary;
use crate::segment::PySegment;
use crate::volume::PyVolume;

/// Figures of a tissue, in the order of the fields of `palpate.needle.Tissue`.
pub type Figures = [f64; 8];

/// The presets by name.
#[pyfunction]
pub fn needle_tissues() -> Vec<(&'static str, Figures)> {
    let presets = Tissue::PRESETS.into_iter();
    presets
        .map(|(name, tissue)| (name, tissue.figures()))
        .collect()
}

/// Drives a needle into layers; those without a tissue are hard. Samples are arrays of one value
/// a tick.
#[pyfunction(name = "drive_needle")]
#[pyo3(signature = (volume, layers, start, target, speed, force_limit, rest_secs, stiffness))]
#[expect(
    clippy::too_many_arguments,
    reason = "the binding takes one type per argument"
)]
pub fn drive_a_needle<'py>(
    py: Python<'py>,
    volume: PyRef<'py, PyVolume>,
    layers: Vec<(PyRef<'py, PySegment>, Option<Figures>)>,
    start: Triple,
    target: Triple,
    speed: f64,
    force_limit: f64,
    rest_secs: f64,
    stiffness: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let given = NeedleDrive {
        start: vector(start),
        target: vector(target),
        speed,
        force_limit,
        rest_secs,
        stiffness,
    };
    let layers: Vec<NeedleLayer> = layers
        .iter()
        .map(|(segment, figures)| NeedleLayer {
            segment: segment.segment.clone(),
            tissue: figures.map(Tissue::of_figures),
        })
        .collect();
    let (grid, values) = (volume.grid, volume.intensities.clone());
    let run = py
        .detach(|| drive(&grid, values, &layers, &given))
        .map_err(CoreError::from)?;
    run_dict(py, &run)
}

fn event_dict<'py>(py: Python<'py>, event: &NeedleEvent) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "kind": event.kind.name(),
        "segment": event.segment,
        "time": event.time,
        "depth": event.depth,
        "force": event.force,
    )
}

fn run_dict<'py>(py: Python<'py>, run: &NeedleRun) -> PyResult<Bound<'py, PyDict>> {
    let column = |of: fn(&NeedleSample) -> f64| -> Bound<'py, PyArray1<f64>> {
        let values: Vec<f64> = run.samples.iter().map(of).collect();
        values.to_pyarray(py)
    };
    let segments: Vec<u8> = run.samples.iter().map(|sample| sample.segment).collect();
    let phases = run.samples.iter().map(|sample| sample.phase.name());
    let events = PyList::empty(py);
    for event in &run.events {
        events.append(event_dict(py, event)?)?;
    }
    dictionary!(py,
        "time": column(|sample| sample.time),
        "phase": PyList::new(py, phases)?,
        "travel": column(|sample| sample.travel),
        "tip": column(|sample| sample.tip),
        "probe": column(|sample| sample.probe),
        "force": column(|sample| sample.force),
        "across": column(|sample| sample.across),
        "stiffness": column(|sample| sample.parts.stiffness),
        "cutting": column(|sample| sample.parts.cutting),
        "friction": column(|sample| sample.parts.friction),
        "wall": column(|sample| sample.parts.wall),
        "lateral": column(|sample| sample.parts.lateral),
        "segment": segments.to_pyarray(py),
        "events": events,
        "wall_at": run.wall,
        "violations": run.violations,
    )
}
