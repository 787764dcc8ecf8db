//! Devices as the package names them.

use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use palpate_device::HapticDevice;
use palpate_device::scripted::{PathSample, ScriptedDevice};
use palpate_device::simulated::{SimulatedDevice, SimulatedSettings};
use palpate_engine::session::Reference;

use crate::arrays::vector;
use crate::errors::CoreError;

/// The rows (time, x, y, z) of a path.
pub fn path_samples(path: &PyReadonlyArray2<'_, f64>) -> Result<Vec<PathSample>, CoreError> {
    let shape = path.shape();
    if shape[1] != 4 {
        return Err(CoreError::value(format!(
            "path of shape {shape:?} given; allowed: [count, 4], rows (time, x, y, z)"
        )));
    }
    let rows = path.as_array();
    let samples = rows.rows().into_iter().map(|row| PathSample {
        time: row[0],
        position: vector((row[1], row[2], row[3])),
    });
    Ok(samples.collect())
}

/// The device of this name, and how it moves the probe.
pub fn device_named(
    name: &str,
    path: Option<Vec<PathSample>>,
) -> Result<(Box<dyn HapticDevice>, Reference), CoreError> {
    let settings = SimulatedSettings::default();
    match (name, path) {
        ("simulated", None) => {
            let device = SimulatedDevice::new(settings, glam::DVec3::ZERO)?;
            Ok((Box::new(device), Reference::View))
        }
        ("scripted", Some(samples)) => {
            let device = ScriptedDevice::new(samples, settings.limits)?;
            Ok((Box::new(device), Reference::Scene))
        }
        ("simulated", Some(_)) => Err(CoreError::value(
            "device 'simulated' given with a path; allowed: a path with 'scripted' only",
        )),
        ("scripted", None) => Err(CoreError::value(
            "device 'scripted' given without a path; allowed: with an array [count, 4]",
        )),
        _ => Err(CoreError::value(format!(
            "device {name:?} given; allowed: 'simulated', 'scripted'"
        ))),
    }
}
