//! `_core.bench_touch`: timing loops for `palpate bench haptics`.

use palpate_engine::bench::{Report, Work, run};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::CoreError;
use crate::segment::PySegment;
use crate::settings::model_named;
use crate::volume::PyVolume;

/// Most calls that one run times.
const MAX_COUNT: usize = 10_000_000;

/// Times `count` calls of `work` on a segment, with the contact model of a name.
#[pyfunction]
#[pyo3(signature = (volume, segment, work, count, seed, model = "exact"))]
pub fn bench_touch<'py>(
    py: Python<'py>,
    volume: &PyVolume,
    segment: &PySegment,
    work: &str,
    count: usize,
    seed: u64,
    model: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let work = work_named(work)?;
    let model = model_named(model)?;
    if !(1..=MAX_COUNT).contains(&count) {
        return Err(
            CoreError::value(format!("{count} calls given; allowed: 1 to {MAX_COUNT}")).into(),
        );
    }
    let given = segment.segment.dimensions();
    let allowed = volume.grid.dimensions();
    if given != allowed {
        return Err(CoreError::value(format!(
            "segment of {given} voxels given; allowed: those of the volume, {allowed}"
        ))
        .into());
    }
    let report = py
        .detach(|| {
            let solid = segment.segment.occupancy();
            run(&volume.grid, solid, work, model, count, seed)
        })
        .ok_or_else(|| {
            CoreError::value("segment without a surface given; allowed: one that can be touched")
        })?;
    report_dict(py, &report)
}

fn work_named(name: &str) -> Result<Work, CoreError> {
    match name {
        "detection" => Ok(Work::Detection),
        "proxy" => Ok(Work::Proxy),
        "tick" => Ok(Work::Tick),
        _ => Err(CoreError::value(format!(
            "work {name:?} given; allowed: 'detection', 'proxy', 'tick'"
        ))),
    }
}

fn report_dict<'py>(py: Python<'py>, report: &Report) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    dictionary.set_item("count", report.timing.count)?;
    for (name, value) in [
        ("per_second", report.timing.per_second),
        ("median_ns", report.timing.median_ns),
        ("p99_ns", report.timing.p99_ns),
        ("p999_ns", report.timing.p999_ns),
        ("max_ns", report.timing.max_ns),
        ("contact_share", report.contact_share),
        ("mean_visits", report.mean_visits),
        ("mean_step", report.mean_step),
    ] {
        dictionary.set_item(name, value)?;
    }
    Ok(dictionary)
}
