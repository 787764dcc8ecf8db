//! `_core.KeptSurface`: the surface of a segment as one mesh for files, and what it keeps.

use glam::DAffine3;
use numpy::PyArray2;
use palpate_surface::VoxelSource;
use palpate_surface::kept::{KeptSurface, kept_surface};
use palpate_volume::grid::Grid;
use pyo3::prelude::*;

use crate::arrays::{Triple, vector};
use crate::errors::CoreError;
use crate::parallel::parallel;
use crate::segment::PySegment;
use crate::surface::{MeshArrays, Values, arrays_of, rows, settings_of};
use crate::volume::{Direction, matrix_of_rows};

/// Places and volumes.
type ThinArrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// The whole surface of a segment.
#[pyclass(name = "KeptSurface", module = "palpate._core", frozen)]
pub struct PyKeptSurface {
    patient_from_grid: DAffine3,
    kept: KeptSurface,
}

#[pymethods]
impl PyKeptSurface {
    /// Makes it, of the same settings as `Surface`.
    #[new]
    #[pyo3(signature = (segment, spacing, origin, direction, step, smoothing, local, values = None))]
    #[expect(clippy::too_many_arguments, reason = "one type per argument")]
    fn new(
        py: Python<'_>,
        segment: &PySegment,
        spacing: Triple,
        origin: Triple,
        direction: Direction,
        step: Option<u8>,
        smoothing: Option<u8>,
        local: bool,
        values: Option<Values<'_>>,
    ) -> Result<Self, CoreError> {
        let axes = matrix_of_rows(direction);
        let dimensions = segment.segment.dimensions();
        let grid = Grid::new(dimensions, vector(spacing), vector(origin), axes)?;
        let settings = settings_of(dimensions, step, smoothing, local, values.as_ref())?;
        let bits = segment.segment.occupancy().clone();
        let values = values.map(|(volume, _)| volume.intensities.clone());
        let kept = parallel(py, || {
            let voxels = VoxelSource {
                bits: &bits,
                values: values.as_ref().map(|values| (values, None)),
            };
            kept_surface(&grid, &voxels, settings)
        })?;
        Ok(Self {
            patient_from_grid: grid.patient_from_grid(),
            kept,
        })
    }

    /// Positions [patient], normals and triangles, shapes [n, 3].
    fn mesh<'py>(&self, py: Python<'py>) -> MeshArrays<'py> {
        arrays_of(py, &self.kept.mesh, self.patient_from_grid.translation)
    }

    #[getter]
    fn triangle_count(&self) -> usize {
        self.kept.mesh.triangles.len()
    }

    /// [mm²]
    fn area(&self) -> f64 {
        self.kept.mesh.area()
    }

    /// Enclosed [mm³].
    fn volume(&self) -> f64 {
        self.kept.mesh.volume()
    }

    /// [mm³]
    #[getter]
    fn voxel_volume(&self) -> f64 {
        self.kept.voxel_volume
    }

    #[getter]
    fn voxel_bodies(&self) -> usize {
        self.kept.voxel_bodies
    }

    #[getter]
    fn bodies(&self) -> usize {
        self.kept.bodies
    }

    /// Volume that the voxels stand for [mm³].
    fn expected_volume(&self) -> f64 {
        self.kept.expected_volume()
    }

    /// Whether most of what is thin was measured with the threshold taken for halfway.
    #[getter]
    fn is_halfway(&self) -> bool {
        self.kept.is_halfway()
    }

    /// What is thin: places [patient], shape [n, 3]; volumes expected and kept [mm³],
    /// shape [n, 2].
    fn thin_parts<'py>(&self, py: Python<'py>) -> ThinArrays<'py> {
        let parts = || self.kept.thin_parts.iter();
        let places = parts().map(|part| self.patient_from_grid.transform_point3(part.place));
        let volumes = parts().map(|part| [part.expected, part.kept]);
        (
            rows(py, places.map(|place| place.to_array()).collect()),
            rows(py, volumes.collect()),
        )
    }

    #[getter]
    fn touching_edges(&self) -> usize {
        self.kept.touching_edges
    }
}
