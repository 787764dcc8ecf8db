//! NumPy arrays from and to the engine's types.

use glam::{DAffine3, DVec3, UVec3};
use numpy::ndarray::Array2;
use numpy::{
    Element, PyArray2, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods, ToPyArray,
};
use pyo3::prelude::*;

use crate::errors::CoreError;

/// A point or vector as Python has it.
pub type Triple = (f64, f64, f64);

/// A point or vector as the engine has it.
pub fn vector((x, y, z): Triple) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A point or vector for Python.
pub fn triple(vector: DVec3) -> Triple {
    vector.into()
}

/// Voxels along x, y, z of an array [z, y, x].
pub fn dimensions_of<T: Element>(array: &PyReadonlyArray3<'_, T>) -> Result<UVec3, CoreError> {
    let [z, y, x] = *array.shape() else {
        return Err(CoreError::value("array given without three axes"));
    };
    let axis = |count: usize| {
        u32::try_from(count)
            .map_err(|_| CoreError::value(format!("axis of {count} given; allowed: 65535")))
    };
    Ok(UVec3::new(axis(x)?, axis(y)?, axis(z)?))
}

/// The values of an array, x fastest.
pub fn values_of<'a, T: Element>(array: &'a PyReadonlyArray3<'_, T>) -> Result<&'a [T], CoreError> {
    array.as_slice().map_err(|_| {
        CoreError::value("array given that is not contiguous; allowed: C-contiguous [z, y, x]")
    })
}

/// Rows (x, y, z), shape [count, 3].
pub fn rows<'py>(py: Python<'py>, vectors: &[DVec3]) -> Bound<'py, PyArray2<f64>> {
    Array2::from_shape_fn((vectors.len(), 3), |(row, axis)| vectors[row][axis]).to_pyarray(py)
}

/// A homogeneous matrix, shape [4, 4].
pub fn matrix<'py>(py: Python<'py>, transform: DAffine3) -> Bound<'py, PyArray2<f64>> {
    let columns = glam::DMat4::from(transform).to_cols_array_2d();
    Array2::from_shape_fn((4, 4), |(row, column)| columns[column][row]).to_pyarray(py)
}

/// The transform of a homogeneous matrix.
pub fn affine(matrix: &PyReadonlyArray2<'_, f64>) -> Result<DAffine3, CoreError> {
    let shape = matrix.shape();
    if shape != [4, 4] {
        return Err(CoreError::value(format!(
            "pose of shape {shape:?} given; allowed: [4, 4]"
        )));
    }
    let rows = matrix.as_array();
    let column = |axis: usize| vector((rows[[0, axis]], rows[[1, axis]], rows[[2, axis]]));
    let last = [rows[[3, 0]], rows[[3, 1]], rows[[3, 2]], rows[[3, 3]]];
    if last != [0.0, 0.0, 0.0, 1.0] {
        return Err(CoreError::value(format!(
            "pose with the last row {last:?} given; allowed: 0, 0, 0, 1"
        )));
    }
    Ok(DAffine3::from_cols(
        column(0),
        column(1),
        column(2),
        column(3),
    ))
}
