//! `_core.Segment`: the solid voxels of one structure.

use glam::{DVec3, IVec3};
use numpy::ndarray::Array3;
use numpy::{PyArray1, PyArray3, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;
use pyo3::prelude::*;

use crate::arrays::{Triple, dimensions_of, triple, values_of, vector};
use crate::errors::CoreError;
use crate::parallel::parallel;
use crate::volume::{Direction, matrix_of_rows};

/// Lowest voxel and one past the highest, (x, y, z).
type Bounds = ((i32, i32, i32), (i32, i32, i32));

/// The solid voxels of one structure.
#[pyclass(name = "Segment", module = "palpate._core", frozen)]
pub struct PySegment {
    pub segment: Segment,
}

#[pymethods]
impl PySegment {
    #[staticmethod]
    fn from_mask(py: Python<'_>, mask: PyReadonlyArray3<'_, u8>) -> Result<Self, CoreError> {
        let dimensions = dimensions_of(&mask)?;
        let values = values_of(&mask)?;
        let segment = parallel(py, || Segment::from_mask(dimensions, values))?;
        Ok(Self { segment })
    }

    /// The same voxels on a grid of their own instead of a scan's.
    fn on_grid(
        &self,
        spacing: Triple,
        origin: Triple,
        direction: Direction,
    ) -> Result<Self, CoreError> {
        let axes = matrix_of_rows(direction);
        let dimensions = self.segment.dimensions();
        let grid = Grid::new(dimensions, vector(spacing), vector(origin), axes)?;
        let segment = self.segment.clone().on_grid(grid);
        Ok(Self { segment })
    }

    /// Spacing and origin [mm] and direction, row by row, of the grid of its own; None without.
    #[getter]
    fn own_grid(&self) -> Option<(Triple, Triple, [f64; 9])> {
        let grid = self.segment.own_grid()?;
        let origin = grid.patient_from_grid().transform_point3(DVec3::splat(0.5));
        let direction = grid.direction().transpose().to_cols_array();
        Some((triple(grid.spacing()), triple(origin), direction))
    }

    #[getter]
    fn dimensions(&self) -> (u32, u32, u32) {
        self.segment.dimensions().into()
    }

    #[getter]
    fn voxel_count(&self) -> u64 {
        self.segment.count()
    }

    #[getter]
    fn bounding_box(&self) -> Option<Bounds> {
        let bounds = self.segment.bounding_box()?;
        Some((bounds.min.into(), bounds.max.into()))
    }

    #[getter]
    fn memory_bytes(&self) -> usize {
        self.segment.memory_bytes()
    }

    /// One byte per voxel, 1 where solid, shape [z, y, x].
    fn mask<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<u8>> {
        let mask = parallel(py, || self.segment.mask());
        let [x, y, z] = self.segment.dimensions().to_array().map(|n| n as usize);
        let array = Array3::from_shape_vec((z, y, x), mask).expect("there is one byte per voxel");
        PyArray3::from_owned_array(py, array)
    }

    /// Whether each point, shape [count, 3] in the grid frame, lies in a solid voxel.
    fn contains<'py>(
        &self,
        py: Python<'py>,
        points_in_grid: PyReadonlyArray2<'_, f64>,
    ) -> Result<Bound<'py, PyArray1<bool>>, CoreError> {
        let shape = points_in_grid.shape();
        if shape[1] != 3 {
            return Err(CoreError::value(format!(
                "points of shape {shape:?} given; allowed: [count, 3]"
            )));
        }
        let points = points_in_grid.as_array();
        let solid = points.rows().into_iter().map(|row| {
            let point = DVec3::new(row[0], row[1], row[2]);
            point.is_finite() && self.segment.contains(voxel_of(point))
        });
        Ok(PyArray1::from_iter(py, solid))
    }
}

/// The voxel that holds a finite point; a point too far away is in no voxel of any grid.
fn voxel_of(point_in_grid: DVec3) -> IVec3 {
    point_in_grid.floor().as_ivec3()
}
