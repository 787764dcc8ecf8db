//! `_core.passivity_devices` and `_core.bench_passivity`: for `palpate bench passivity`.

use palpate_bench::passivity::{FlatWall, Report, Wall, device_named, device_names, report};
use palpate_engine::touch::{ScanValues, Threshold, ThresholdRange};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::CoreError;
use crate::segment::PySegment;
use crate::volume::PyVolume;

/// Rates that are taken [Hz].
const RATES: std::ops::RangeInclusive<u32> = 500..=10_000;
/// Longest run [s].
const LONGEST: f64 = 3600.0;
/// Place on a segment: the same in every run.
const SEED: u64 = 1;

/// Names of the devices, in the order of the report.
#[pyfunction]
pub fn passivity_devices() -> Vec<&'static str> {
    device_names()
}

/// A volume, a segment of it, and the threshold that made that.
type BoneWall<'py> = (
    PyRef<'py, PyVolume>,
    PyRef<'py, PySegment>,
    Option<ThresholdRange>,
);

/// Presses, taps and slides on a flat wall, or on a segment of a volume.
#[pyfunction]
#[pyo3(signature = (device, rate_hz, seconds, search_seconds, wall = None))]
pub fn bench_passivity<'py>(
    py: Python<'py>,
    device: &str,
    rate_hz: u32,
    seconds: f64,
    search_seconds: f64,
    wall: Option<BoneWall<'py>>,
) -> PyResult<Bound<'py, PyDict>> {
    let settings = device_named(device).ok_or_else(|| {
        let allowed = device_names().join(", ");
        CoreError::value(format!("device {device:?} given; allowed: {allowed}"))
    })?;
    if !RATES.contains(&rate_hz) {
        return Err(CoreError::value(format!(
            "rate {rate_hz} Hz given; allowed: {} to {} Hz",
            RATES.start(),
            RATES.end()
        ))
        .into());
    }
    for given in [seconds, search_seconds] {
        if !(1.0..=LONGEST).contains(&given) {
            return Err(
                CoreError::value(format!("{given} s given; allowed: 1 to {LONGEST} s")).into(),
            );
        }
    }
    let times = (seconds, search_seconds);
    let told = match wall {
        None => py.detach(|| {
            let flat = FlatWall::default();
            report(&flat.wall(), &settings, rate_hz, times)
        }),
        Some((volume, segment, range)) => {
            let (volume, segment) = (&*volume, &*segment);
            let (grid, segment) = (volume.grid, segment.segment.clone());
            if segment.dimensions() != grid.dimensions() {
                return Err(CoreError::value(format!(
                    "segment of {} voxels given; allowed: those of the volume, {}",
                    segment.dimensions(),
                    grid.dimensions()
                ))
                .into());
            }
            let threshold = range.map(|range| Threshold {
                range,
                values: ScanValues::of(&volume.intensities),
            });
            py.detach(|| {
                let made = (segment.occupancy(), threshold.as_ref());
                let wall = Wall::on(&grid, made, SEED)?;
                Some(report(&wall, &settings, rate_hz, times))
            })
            .ok_or_else(|| {
                CoreError::value(
                    "segment without a surface given; allowed: one that can be touched",
                )
            })?
        }
    };
    report_dict(py, &told)
}

fn report_dict<'py>(py: Python<'py>, told: &Report) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    for (name, value) in [
        ("stiffness", told.stiffness),
        ("to_hand", told.to_hand),
        ("of_one_contact", told.of_one_contact),
        ("largest_force", told.largest_force),
        ("contact_share", told.contact_fraction),
        ("damped", told.damped as f64),
        ("violations", told.violations as f64),
        ("largest_stiffness", told.largest_stiffness),
        ("bound", told.bound),
    ] {
        dictionary.set_item(name, value)?;
    }
    Ok(dictionary)
}
