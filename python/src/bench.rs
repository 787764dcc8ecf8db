//! `_core.Ground`, `_core.TouchBench`, `_core.bench_embedded`: for `palpate bench haptics`.

use std::sync::Mutex;

use palpate_bench::haptics::{Embedded, Ground, Report, Timing, TouchBench, Work, compare};
use palpate_engine::touch::Smoothing;
use palpate_volume::phantom::bones;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::CoreError;
use crate::phantom::checked_dimensions;
use crate::segment::PySegment;
use crate::settings::model_named;
use crate::volume::PyVolume;

/// Most calls that one run times.
const MAX_COUNT: usize = 10_000_000;

/// Most segments, as in a scene.
const MAX_SEGMENTS: usize = 255;

/// What can be timed, by name.
const WORKS: [(&str, Work); 8] = [
    ("detection, 1 voxel", Work::Detection { length: 1.0 }),
    ("detection, 4 voxels", Work::Detection { length: 4.0 }),
    ("detection, 10 voxels", Work::Detection { length: 10.0 }),
    ("proxy", Work::Proxy),
    ("tick", Work::TICK),
    (
        "tick, by bits",
        Work::Tick {
            smoothing: Smoothing::Bits,
            friction: true,
        },
    ),
    (
        "tick, no smoothing",
        Work::Tick {
            smoothing: Smoothing::Off,
            friction: true,
        },
    ),
    (
        "tick, no friction",
        Work::Tick {
            smoothing: Smoothing::Intensities,
            friction: false,
        },
    ),
];

/// Segments of one scan that are touched together.
#[pyclass(name = "Ground", module = "palpate._core", frozen)]
pub struct PyGround {
    ground: Ground,
}

#[pymethods]
impl PyGround {
    #[new]
    #[pyo3(signature = (volume, segments, ranges = Vec::new()))]
    fn new(
        volume: &PyVolume,
        segments: Vec<PyRef<'_, PySegment>>,
        ranges: Vec<Option<(f64, f64)>>,
    ) -> Result<Self, CoreError> {
        if !(1..=MAX_SEGMENTS).contains(&segments.len()) {
            return Err(CoreError::value(format!(
                "{} segments given; allowed: 1 to {MAX_SEGMENTS}",
                segments.len()
            )));
        }
        let allowed = volume.grid.dimensions();
        let bits = segments
            .iter()
            .map(|segment| {
                let given = segment.segment.dimensions();
                if given == allowed {
                    return Ok(segment.segment.occupancy().clone());
                }
                Err(CoreError::value(format!(
                    "segment of {given} voxels given; allowed: those of the volume, {allowed}"
                )))
            })
            .collect::<Result<_, _>>()?;
        Ok(Self {
            ground: Ground::new(volume.grid, bits).made_by(&volume.intensities, &ranges),
        })
    }

    /// The bones of the phantom, by their labels.
    #[staticmethod]
    fn phantom(py: Python<'_>, dimensions: (u32, u32, u32)) -> PyResult<Self> {
        let dimensions = checked_dimensions(dimensions)?;
        let (grid, bits) = py.detach(|| bones(dimensions)).map_err(CoreError::from)?;
        Ok(Self {
            ground: Ground::new(grid, vec![bits]),
        })
    }

    /// The same voxels in the middle of a larger scan.
    fn embedded(&self, py: Python<'_>, dimensions: (u32, u32, u32)) -> PyResult<Self> {
        let dimensions = checked_dimensions(dimensions)?;
        let least = self.ground.grid.dimensions();
        if dimensions.cmplt(least).any() {
            return Err(CoreError::value(format!(
                "{dimensions} voxels given; allowed: {least} or more"
            ))
            .into());
        }
        let ground = py
            .detach(|| self.ground.embedded(dimensions))
            .map_err(CoreError::from)?;
        Ok(Self { ground })
    }

    #[getter]
    fn dimensions(&self) -> (u32, u32, u32) {
        self.ground.grid.dimensions().into()
    }
}

/// A probe that presses and slides over a ground.
#[pyclass(name = "TouchBench", module = "palpate._core", frozen)]
pub struct PyTouchBench {
    bench: Mutex<TouchBench>,
}

#[pymethods]
impl PyTouchBench {
    #[new]
    fn new(
        py: Python<'_>,
        ground: &PyGround,
        radius: f64,
        count: usize,
        seed: u64,
    ) -> PyResult<Self> {
        let count = checked_count(count)?;
        let bench = py
            .detach(|| TouchBench::new(&ground.ground, radius, count, seed))
            .map_err(CoreError::from)?;
        Ok(Self {
            bench: Mutex::new(bench),
        })
    }

    /// Times one call for each update of its path.
    #[pyo3(signature = (work, model = "exact"))]
    fn run<'py>(&self, py: Python<'py>, work: &str, model: &str) -> PyResult<Bound<'py, PyDict>> {
        let work = work_named(work)?;
        let model = model_named(model)?;
        let report = py
            .detach(|| {
                let bench = self.bench.lock().expect("no run panics");
                bench.run(work, model)
            })
            .map_err(CoreError::from)?;
        report_dict(py, &report)
    }
}

/// The same body and path in a small and a large scan.
#[pyfunction]
pub fn bench_embedded<'py>(
    py: Python<'py>,
    small: &PyGround,
    large: &PyGround,
    work: &str,
    count: usize,
    cold_count: usize,
    seed: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let work = work_named(work)?;
    let counts = [checked_count(count)?, checked_count(cold_count)?];
    let grounds = [&small.ground, &large.ground];
    let embedded = py
        .detach(|| compare(grounds, work, counts, seed))
        .map_err(CoreError::from)?;
    embedded_dict(py, &embedded)
}

fn work_named(name: &str) -> Result<Work, CoreError> {
    let found = WORKS.iter().find(|(known, _)| *known == name);
    found.map(|(_, work)| *work).ok_or_else(|| {
        let allowed = WORKS.map(|(known, _)| format!("'{known}'"));
        CoreError::value(format!(
            "work {name:?} given; allowed: {}",
            allowed.join(", ")
        ))
    })
}

fn checked_count(count: usize) -> Result<usize, CoreError> {
    if (1..=MAX_COUNT).contains(&count) {
        return Ok(count);
    }
    Err(CoreError::value(format!(
        "{count} calls given; allowed: 1 to {MAX_COUNT}"
    )))
}

fn report_dict<'py>(py: Python<'py>, report: &Report) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = timing_dict(py, &report.timing)?;
    for (name, value) in [
        ("contact_share", report.contact_fraction),
        ("mean_visits", report.mean_visits),
        ("mean_step", report.mean_step),
    ] {
        dictionary.set_item(name, value)?;
    }
    Ok(dictionary)
}

fn embedded_dict<'py>(py: Python<'py>, embedded: &Embedded) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    let ratio = embedded.large_per_second / embedded.small_per_second;
    for (name, value) in [
        ("small_per_second", embedded.small_per_second),
        ("large_per_second", embedded.large_per_second),
        ("ratio", ratio),
        ("contact_share", embedded.contact_fraction),
    ] {
        dictionary.set_item(name, value)?;
    }
    dictionary.set_item("small_cold", timing_dict(py, &embedded.small_cold)?)?;
    dictionary.set_item("large_cold", timing_dict(py, &embedded.large_cold)?)?;
    Ok(dictionary)
}

fn timing_dict<'py>(py: Python<'py>, timing: &Timing) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    dictionary.set_item("count", timing.count)?;
    for (name, value) in [
        ("per_second", timing.per_second),
        ("median_ns", timing.median_ns),
        ("p99_ns", timing.p99_ns),
        ("p999_ns", timing.p999_ns),
        ("max_ns", timing.max_ns),
    ] {
        dictionary.set_item(name, value)?;
    }
    Ok(dictionary)
}
