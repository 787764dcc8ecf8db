//! `_core.Surface`: the triangles of a segment, for files and for `palpate bench surface`.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Instant;

use glam::{DVec3, IVec3, UVec3, Vec3};
use numpy::ndarray::Array2;
use numpy::{Element, PyArray2, PyReadonlyArray2, ToPyArray};
use palpate_surface::mesh::joined;
use palpate_surface::voxelise::{Filling, voxelise};
use palpate_surface::{Limits, Patch, SegmentSurface, SmoothingMode, SurfaceSettings, VoxelSource};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::phantom::bones;
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;

use crate::arrays::{Triple, vector};
use crate::errors::CoreError;
use crate::parallel::parallel;
use crate::phantom::checked_dimensions;
use crate::segment::PySegment;
use crate::volume::{Direction, PyVolume, matrix_of_rows};

/// A scan, and the limits of the threshold that made a segment of it.
pub(crate) type Values<'py> = (PyRef<'py, PyVolume>, (f64, f64));

/// Positions [mm], normals, triangles.
pub(crate) type MeshArrays<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray2<u32>>,
);

/// The bones of the phantom by their labels, without its values.
#[pyfunction]
pub fn phantom_bones(py: Python<'_>, dimensions: (u32, u32, u32)) -> PyResult<PySegment> {
    let dimensions = checked_dimensions(dimensions)?;
    let (_, bits) = parallel(py, || bones(dimensions)).map_err(CoreError::from)?;
    let segment = parallel(py, || Segment::from_bits(bits));
    Ok(PySegment { segment })
}

/// The voxels of a mesh in the patient [mm], shapes [n, 3], on a grid.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one type per argument")]
pub fn voxelise_mesh(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    triangles: PyReadonlyArray2<'_, u32>,
    dimensions: (u32, u32, u32),
    spacing: Triple,
    origin: Triple,
    direction: Direction,
    shell: bool,
) -> Result<PySegment, CoreError> {
    let axes = matrix_of_rows(direction);
    let grid = Grid::new(dimensions.into(), vector(spacing), vector(origin), axes)?;
    let grid_from_patient = grid.grid_from_patient();
    let in_grid: Vec<DVec3> = triples(&vertices)?
        .into_iter()
        .map(|point| grid_from_patient.transform_point3(point.into()))
        .collect();
    let triangles = triples(&triangles)?;
    let filling = if shell {
        Filling::Shell
    } else {
        Filling::Solid
    };
    let bits = parallel(py, || {
        voxelise(grid.dimensions(), &in_grid, &triangles, filling)
    })?;
    let segment = parallel(py, || Segment::from_bits(bits));
    Ok(PySegment { segment })
}

/// Rows of three numbers.
fn triples<T: Element + Copy>(array: &PyReadonlyArray2<'_, T>) -> Result<Vec<[T; 3]>, CoreError> {
    let array = array.as_array();
    if array.ncols() != 3 {
        return Err(CoreError::value(format!(
            "array of {} columns given; allowed: 3",
            array.ncols()
        )));
    }
    let rows = array.rows().into_iter();
    Ok(rows.map(|row| [row[0], row[1], row[2]]).collect())
}

/// The surface of a segment.
#[pyclass(name = "Surface", module = "palpate._core", frozen)]
pub struct PySurface {
    grid: Grid,
    state: Mutex<State>,
}

struct State {
    bits: Bits,
    /// Of the scan, where the surface is made from them.
    values: Option<Intensities>,
    surface: SegmentSurface,
}

impl State {
    /// Makes the patches again that a change of the voxels in `dirty` can have changed.
    fn update(&mut self, dirty: &VoxelBox) {
        let source = VoxelSource {
            bits: &self.bits,
            values: self.values.as_ref().map(|values| (values, None)),
        };
        self.surface.update(&source, dirty);
    }
}

impl PySurface {
    /// From where positions are counted [patient mm], and its parts, which are shared.
    pub(crate) fn patches(&self) -> (DVec3, Vec<Arc<Patch>>) {
        let surface = &self.state().surface;
        let patches = surface.patches().map(|(_, patch)| Arc::clone(patch));
        (surface.origin(), patches.collect())
    }
}

#[pymethods]
impl PySurface {
    /// Makes the whole surface; without a step or a degree of smoothing the usual one. From the
    /// values of a scan where they are given with the limits of the threshold that made the
    /// segment, else from its bits.
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
        let mut state = State {
            bits: segment.segment.occupancy().clone(),
            values: values.map(|(volume, _)| volume.intensities.clone()),
            surface: SegmentSurface::new(&grid, settings)?,
        };
        parallel(py, || state.update(&grid.bounds()));
        let state = Mutex::new(state);
        Ok(Self { grid, state })
    }

    #[getter]
    fn patch_count(&self) -> usize {
        self.state().surface.patches().len()
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.sum(|patch| patch.vertices.len())
    }

    #[getter]
    fn triangle_count(&self) -> usize {
        self.sum(|patch| patch.triangles.len())
    }

    /// [mm²]
    fn area(&self, py: Python<'_>) -> f64 {
        parallel(py, || self.state().surface.area())
    }

    /// Enclosed [mm³].
    fn volume(&self, py: Python<'_>) -> f64 {
        parallel(py, || self.state().surface.volume())
    }

    /// All patches as one: positions [patient], shape [n, 3], normals and triangles.
    fn mesh<'py>(&self, py: Python<'py>) -> MeshArrays<'py> {
        let (mesh, origin) = parallel(py, || {
            let state = self.state();
            (joined(&state.surface), state.surface.origin())
        });
        arrays_of(py, &mesh, origin)
    }

    /// Makes the whole surface anew, on so many threads; returns how long it took [s].
    fn time_all(&self, py: Python<'_>, threads: usize) -> Result<f64, CoreError> {
        self.timed(py, threads, |state| {
            state.surface = SegmentSurface::new(&self.grid, *state.surface.settings())
                .expect("these settings made a surface before");
            let start = Instant::now();
            state.update(&self.grid.bounds());
            start.elapsed().as_secs_f64()
        })
    }

    /// The same as one mesh, its patches joined.
    fn time_joined(&self, py: Python<'_>) -> Result<f64, CoreError> {
        self.timed(py, 1, |state| {
            let start = Instant::now();
            let mesh = joined(&state.surface);
            let seconds = start.elapsed().as_secs_f64();
            drop(mesh);
            seconds
        })
    }

    /// Takes a ball of voxels away and makes the surface follow; returns how long that took
    /// until the new patches were ready [s]. The edit is taken back.
    fn time_drill(
        &self,
        py: Python<'_>,
        voxel: (i32, i32, i32),
        radius: i32,
        threads: usize,
    ) -> Result<f64, CoreError> {
        let centre = IVec3::from(voxel);
        self.timed(py, threads, |state| {
            let dirty = VoxelBox::of_voxel(centre)
                .dilate(radius)
                .intersect(&self.grid.bounds());
            let mut swaps = ball_removed(&state.bits, centre, radius, dirty);
            let mut exchange = |state: &mut State| {
                for swap in &mut swaps {
                    state.bits.swap(swap);
                }
                let start = Instant::now();
                state.update(&dirty);
                start.elapsed().as_secs_f64()
            };
            let seconds = exchange(state);
            exchange(state);
            seconds
        })
    }
}

impl PySurface {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("no extraction panics")
    }

    fn sum(&self, count: impl Fn(&Patch) -> usize) -> usize {
        self.state()
            .surface
            .patches()
            .map(|(_, patch)| count(patch))
            .sum()
    }

    /// Runs on a pool of its own, which is there before the clock starts.
    fn timed(
        &self,
        py: Python<'_>,
        threads: usize,
        work: impl Fn(&mut State) -> f64 + Send + Sync,
    ) -> Result<f64, CoreError> {
        if !(1..=1024).contains(&threads) {
            return Err(CoreError::value(format!(
                "{threads} threads given; allowed: 1 to 1024"
            )));
        }
        parallel(py, || {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.map_err(|error| CoreError::value(error.to_string()))?;
            Ok(pool.install(|| work(&mut self.state())))
        })
    }
}

/// Settings as given; what is not given is as usual.
pub(crate) fn settings_of(
    dimensions: UVec3,
    step: Option<u8>,
    smoothing: Option<u8>,
    local: bool,
    values: Option<&Values<'_>>,
) -> Result<SurfaceSettings, CoreError> {
    if let Some((volume, _)) = values
        && volume.intensities.dimensions() != dimensions
    {
        return Err(CoreError::value("values of another grid given".to_owned()));
    }
    let usual = SurfaceSettings::default();
    Ok(SurfaceSettings {
        step: step.unwrap_or(usual.step),
        smoothing: smoothing.unwrap_or(usual.smoothing),
        mode: if local {
            SmoothingMode::Local
        } else {
            SmoothingMode::Global
        },
        limits: values.map(|&(_, (low, high))| Limits { low, high }),
        ..usual
    })
}

/// Bricks without the voxels of a ball.
fn ball_removed(
    bits: &Bits,
    centre: IVec3,
    radius: i32,
    dirty: VoxelBox,
) -> Vec<BrickSwap<BitBrick>> {
    let bricks = bits.bricks();
    let indices = bricks.indices_in(&dirty).into_iter();
    let swaps = indices.filter_map(|index| {
        let mut brick = **bricks.get(index)?;
        for voxel in bricks.box_of(index).intersect(&dirty).voxels() {
            if (voxel - centre).length_squared() <= radius * radius {
                brick.set(voxel, false);
            }
        }
        let brick = brick.shared();
        Some(BrickSwap { index, brick })
    });
    swaps.collect()
}

/// A mesh whose positions are counted from `origin` [patient] as arrays.
pub(crate) fn arrays_of<'py>(py: Python<'py>, mesh: &Patch, origin: DVec3) -> MeshArrays<'py> {
    let vertices = mesh.vertices.iter();
    let vertices = vertices.map(|&vertex| (origin + Vec3::from(vertex).as_dvec3()).to_array());
    (
        rows(py, vertices.collect()),
        rows(py, mesh.normals.clone()),
        rows(py, mesh.triangles.clone()),
    )
}

pub(crate) fn rows<T: Element + Copy, const N: usize>(
    py: Python<'_>,
    rows: Vec<[T; N]>,
) -> Bound<'_, PyArray2<T>> {
    let shape = (rows.len(), N);
    Array2::from_shape_vec(shape, rows.into_flattened())
        .expect("as many numbers in each row")
        .to_pyarray(py)
}
