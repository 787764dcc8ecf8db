//! `_core.bench_stress`: for `palpate bench stress`.

use palpate_bench::stress::{Report, Source, on_threads, runs};
use palpate_engine::touch::Model;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::CoreError;
use crate::segment::PySegment;
use crate::settings::model_named;
use crate::volume::PyVolume;

/// Most threads.
const MAX_THREADS: usize = 256;

/// Makes runs `first` to `first + count` of a seed, in parts of this bone.
#[pyfunction]
#[pyo3(signature = (seed, first, count, model, threads, volume = None, segment = None))]
#[expect(
    clippy::too_many_arguments,
    reason = "they are keywords in Python, and what a violation is replayed by"
)]
pub fn bench_stress<'py>(
    py: Python<'py>,
    seed: u64,
    first: u64,
    count: u64,
    model: &str,
    threads: usize,
    volume: Option<&PyVolume>,
    segment: Option<&PySegment>,
) -> PyResult<Bound<'py, PyDict>> {
    let model = model_named(model)?;
    let end = first.checked_add(count).ok_or_else(|| {
        CoreError::value(format!("{count} runs from {first} given; allowed: 64 bits"))
    })?;
    if !(1..=MAX_THREADS).contains(&threads) {
        return Err(CoreError::value(format!(
            "{threads} threads given; allowed: 1 to {MAX_THREADS}"
        ))
        .into());
    }
    let report = py.detach(|| {
        let bone = volume.zip(segment).map(|(volume, segment)| Source {
            grid: &volume.grid,
            bits: segment.segment.occupancy(),
        });
        on_threads(threads, || runs(seed, first..end, model, bone))
    });
    let report =
        report.map_err(|error| CoreError::value(format!("{threads} threads given: {error}")))?;
    report_dict(py, model, &report)
}

fn report_dict<'py>(
    py: Python<'py>,
    model: Model,
    report: &Report,
) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    for (name, value) in [
        ("moves", report.moves),
        ("contacts", report.contacts),
        ("edits", report.edits),
        ("poses", report.poses),
        ("cuts", report.cuts),
    ] {
        dictionary.set_item(name, value)?;
    }
    let found = report.violation.as_ref().map(|found| {
        let told = PyDict::new(py);
        told.set_item("run", found.run)?;
        told.set_item("move", found.at_move)?;
        told.set_item("model", model.name())?;
        told.set_item("guarantee", found.violation.guarantee as u8)?;
        told.set_item("what", &found.violation.what)?;
        told.set_item("plan", format!("{:?}", found.plan))?;
        PyResult::Ok(told)
    });
    dictionary.set_item("violation", found.transpose()?)?;
    Ok(dictionary)
}
