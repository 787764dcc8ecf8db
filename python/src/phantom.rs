//! `_core.phantom`: the built-in trunk.

use glam::UVec3;
use numpy::PyArray3;
use numpy::ndarray::Array3;
use palpate_volume::phantom;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::CoreError;
use crate::parallel::parallel;
use crate::volume::PyVolume;

/// Largest phantom in voxels: 1024³.
const MAX_VOXELS: u64 = 1 << 30;

/// A scan, its labels [z, y, x] and the number of each part by name.
type Phantom<'py> = (PyVolume, Bound<'py, PyArray3<u8>>, Bound<'py, PyDict>);

/// Makes the phantom; the same dimensions (x, y, z) and seed make the same one.
#[pyfunction(name = "phantom")]
pub fn make_phantom(
    py: Python<'_>,
    dimensions: (u32, u32, u32),
    seed: u64,
) -> PyResult<Phantom<'_>> {
    let dimensions = checked_dimensions(dimensions)?;
    let made = parallel(py, || phantom::phantom(dimensions, seed)).map_err(CoreError::from)?;

    let [x, y, z] = dimensions.to_array().map(|count| count as usize);
    let labels = Array3::from_shape_vec((z, y, x), made.labels)
        .expect("the phantom has one label per voxel");
    let names = PyDict::new(py);
    for (name, label) in made.names {
        names.set_item(name, label)?;
    }
    let volume = PyVolume {
        grid: made.grid,
        intensities: made.intensities,
    };
    Ok((volume, PyArray3::from_owned_array(py, labels), names))
}

/// Dimensions (x, y, z) of not too many voxels.
pub fn checked_dimensions(dimensions: (u32, u32, u32)) -> Result<UVec3, CoreError> {
    let dimensions = UVec3::from(dimensions);
    let counts = dimensions.to_array().map(u128::from);
    if counts.iter().product::<u128>() <= u128::from(MAX_VOXELS) {
        return Ok(dimensions);
    }
    Err(CoreError::value(format!(
        "phantom of {dimensions} voxels given; allowed: {MAX_VOXELS} in all"
    )))
}
