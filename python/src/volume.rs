//! `_core.Volume`: a scan's values and where they stand.

use std::sync::Arc;

use glam::DMat3;
use numpy::ndarray::ArrayView3;
use numpy::{PyArray1, PyArray2, PyArray3, PyReadonlyArray3};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::threshold::threshold;
use pyo3::prelude::*;

use crate::arrays::{Triple, dimensions_of, matrix, triple, values_of, vector};
use crate::errors::CoreError;
use crate::parallel::parallel;
use crate::segment::PySegment;

/// Nine numbers of a matrix, row by row, as ITK gives a direction.
pub type Direction = (f64, f64, f64, f64, f64, f64, f64, f64, f64);

/// Values on a grid that stands in the patient.
#[pyclass(name = "Volume", module = "palpate._core", frozen)]
pub struct PyVolume {
    pub grid: Grid,
    pub intensities: Intensities,
}

#[pymethods]
impl PyVolume {
    #[new]
    fn new(
        py: Python<'_>,
        values: PyReadonlyArray3<'_, i16>,
        spacing: Triple,
        origin: Triple,
        direction: Direction,
        slope: f64,
        intercept: f64,
    ) -> Result<Self, CoreError> {
        let dimensions = dimensions_of(&values)?;
        let axes = matrix_of_rows(direction);
        let grid = Grid::new(dimensions, vector(spacing), vector(origin), axes)?;
        let stored = values_of(&values)?;
        let copied: Arc<[i16]> = parallel(py, || Arc::from(stored));
        let intensities = Intensities::new(dimensions, copied, slope, intercept)?;
        Ok(Self { grid, intensities })
    }

    #[getter]
    fn dimensions(&self) -> (u32, u32, u32) {
        self.grid.dimensions().into()
    }

    #[getter]
    fn spacing(&self) -> Triple {
        triple(self.grid.spacing())
    }

    #[getter]
    fn slope(&self) -> f64 {
        self.intensities.slope()
    }

    #[getter]
    fn intercept(&self) -> f64 {
        self.intensities.intercept()
    }

    #[getter]
    fn patient_from_grid<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.grid.patient_from_grid())
    }

    /// The stored values, a read-only view.
    fn values(slf: Bound<'_, Self>) -> PyResult<Bound<'_, PyArray3<i16>>> {
        let volume = slf.get();
        let [x, y, z] = volume.grid.dimensions().to_array().map(|n| n as usize);
        let view = ArrayView3::from_shape((z, y, x), volume.intensities.values())
            .expect("there is one value per voxel");
        // SAFETY: the values are behind an Arc that this object holds and never replaces, the
        // array keeps the object alive, and it is made read-only before anybody has it
        let array = unsafe { PyArray3::borrow_from_array(&view, slf.clone().into_any()) };
        array.call_method1("setflags", (false,))?;
        Ok(array)
    }

    fn stored_range(&self, py: Python<'_>) -> (i16, i16) {
        parallel(py, || self.intensities.stored_range())
    }

    fn histogram<'py>(
        &self,
        py: Python<'py>,
        bins: usize,
    ) -> Result<(f64, f64, Bound<'py, PyArray1<u64>>), CoreError> {
        if !(1..=1 << 20).contains(&bins) {
            return Err(CoreError::value(format!(
                "{bins} bins given; allowed: 1 to 1048576"
            )));
        }
        let histogram = parallel(py, || self.intensities.histogram(bins));
        let counts = PyArray1::from_vec(py, histogram.counts);
        Ok((histogram.low, histogram.high, counts))
    }

    fn threshold(&self, py: Python<'_>, low: f64, high: f64) -> Result<PySegment, CoreError> {
        if !(low.is_finite() && high.is_finite() && low <= high) {
            return Err(CoreError::value(format!(
                "threshold {low} to {high} given; allowed: finite, low not above high"
            )));
        }
        let segment = parallel(py, || threshold(&self.intensities, None, low, high));
        Ok(PySegment { segment })
    }
}

/// The matrix of nine numbers.
pub fn matrix_of_rows(rows: Direction) -> DMat3 {
    let (xx, xy, xz, yx, yy, yz, zx, zy, zz) = rows;
    DMat3::from_cols_array(&[xx, yx, zx, xy, yy, zy, xz, yz, zz])
}
