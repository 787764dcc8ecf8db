//! `_core.Renderer` and `_core.Picture`: pictures of a scan, drawn here.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::DAffine3;
use numpy::ndarray::{Array2, Array3};
use numpy::{PyArray2, PyArray3, PyReadonlyArray2, ToPyArray};
use palpate_engine::error::SessionError;
use palpate_engine::picture::{ShownDisplacements, ShownSurface as ShownSurfaceOfSession};
use palpate_engine::session::{Drawn, Session};
use palpate_render::displaced::Displacements;
use palpate_render::draw::Request;
use palpate_render::part::Part;
use palpate_render::picture::{Ground, Picture};
use palpate_render::renderer::Renderer;
use palpate_render::scene::SceneError;
use palpate_render::second::SecondScan;
use palpate_render::surfaces::{SegmentSurface, Triangles};
use palpate_surface::Patch;
use palpate_volume::edit::SegmentId;
use palpate_volume::simd_dispatch::SimdLevel;
use palpate_volume::voxels::Voxels;
use pyo3::prelude::*;

use crate::arrays::affine;
use crate::errors::CoreError;
use crate::given_look::{Colour, GivenAppearance, GivenCamera, GivenSecond};
use crate::parallel::{in_background, parallel};
use crate::segment::PySegment;
use crate::session::PySession;
use crate::surface::PySurface;
use crate::volume::PyVolume;

/// Most pixels of a picture along an edge.
const MOST_PIXELS: u32 = 16_384;

/// A scan that is drawn.
#[pyclass(name = "Renderer", module = "palpate._core", frozen)]
pub struct PyRenderer {
    renderer: Mutex<Renderer>,
    /// Of the session, as they are drawn.
    displacements: Mutex<ShownDisplacements>,
    /// Pictures of lower numbers are given up.
    newest: AtomicU64,
}

/// A second scan, shown through the first.
#[pyclass(name = "SecondScan", module = "palpate._core", frozen)]
pub struct PySecondScan {
    scan: Arc<SecondScan>,
}

/// A picture.
#[pyclass(name = "Picture", module = "palpate._core", frozen)]
pub struct PyPicture {
    picture: Picture,
}

/// Some pixels of a picture as Python has them: first column and row, columns and rows.
type GivenPart = (u32, u32, u32, u32);

/// A part of a surface that the session has too.
#[derive(Debug)]
struct SharedPatch(Arc<Patch>);

impl Triangles for SharedPatch {
    fn positions(&self) -> &[[f32; 3]] {
        &self.0.vertices
    }

    fn normals(&self) -> &[[f32; 3]] {
        &self.0.normals
    }

    fn corners(&self) -> &[[u32; 3]] {
        &self.0.triangles
    }
}

#[pymethods]
impl PyRenderer {
    #[new]
    #[pyo3(signature = (volume, segments = Vec::new()))]
    fn new(
        py: Python<'_>,
        volume: &PyVolume,
        segments: Vec<(u8, PyRef<'_, PySegment>)>,
    ) -> Result<Self, CoreError> {
        let mut voxels = Voxels::new(volume.grid, volume.intensities.clone())?;
        for (id, segment) in segments {
            voxels.insert_segment(SegmentId(id), segment.segment.clone())?;
        }
        Self::of(parallel(py, || Renderer::new(voxels)))
    }

    /// Draws what a session has, as it is now. Surfaces that are being made are waited for, or come with a later picture.
    #[staticmethod]
    #[pyo3(signature = (session, *, waits = false))]
    fn of_session(py: Python<'_>, session: &PySession, waits: bool) -> Result<Self, CoreError> {
        let voxels = py.detach(|| session.session.voxels())?;
        let renderer = Self::of(parallel(py, || Renderer::new(voxels)))?;
        renderer.follow(py, session)?;
        if waits {
            let surfaces = py.detach(|| session.session.made_surfaces())?;
            let surfaces = surfaces.into_iter().map(surface_of).collect();
            py.detach(|| renderer.lock().set_surfaces(surfaces));
        }
        Ok(renderer)
    }

    /// Takes what a session has now; true where voxels had changed or tissue stands elsewhere.
    fn follow(&self, py: Python<'_>, session: &PySession) -> Result<bool, CoreError> {
        let session = &session.session;
        let known = py.detach(|| {
            let renderer = self.lock_following(session)?;
            Ok::<_, SessionError>(renderer.edit_number())
        })?;
        let drawn = py.detach(|| session.drawn_since(known))?;
        Ok(parallel(py, || self.take(drawn)))
    }

    /// Takes the surfaces of segments, by their numbers.
    fn set_surfaces(&self, py: Python<'_>, surfaces: Vec<(u8, PyRef<'_, PySurface>)>) {
        let surfaces = surfaces.iter();
        let surfaces = surfaces
            .map(|(id, surface)| {
                let (origin, patches) = surface.patches();
                SegmentSurface {
                    id: *id,
                    origin,
                    pose: DAffine3::IDENTITY,
                    patches: patches.into_iter().map(shared).collect(),
                }
            })
            .collect();
        py.detach(|| self.lock().set_surfaces(surfaces));
    }

    /// Shows the scan in another way.
    fn set_appearance(&self, py: Python<'_>, appearance: GivenAppearance) -> Result<(), CoreError> {
        let appearance = appearance.checked()?;
        py.detach(|| self.lock().set_appearance(appearance));
        Ok(())
    }

    /// Shows a second scan through the first; the first alone where either is None.
    fn show_second(
        &self,
        py: Python<'_>,
        scan: Option<&PySecondScan>,
        appearance: Option<GivenSecond>,
    ) -> Result<(), CoreError> {
        let look = appearance.map(GivenSecond::checked).transpose()?;
        let scan = scan.map(|second| Arc::clone(&second.scan));
        py.detach(|| self.lock().show_second(scan.zip(look)));
        Ok(())
    }

    /// Gives up pictures of lower numbers that are being drawn or still wait.
    fn supersede(&self, number: u64) {
        self.newest.fetch_max(number, Relaxed);
    }

    /// Number of what is drawn; no other renderer has it.
    #[getter]
    fn state(&self) -> u64 {
        self.lock().state()
    }

    /// First column and row, columns and rows of the part of a picture that shows what was edited since a state; None
    /// where all of it may look different.
    fn part_edited_since(
        &self,
        state: u64,
        camera: GivenCamera,
        size: (u32, u32),
    ) -> Result<Option<GivenPart>, CoreError> {
        check_size(size)?;
        let camera = camera.checked()?;
        let part = self.lock().part_edited_since(state, &camera, size);
        Ok(part.map(|Part { first, size }| (first.x, first.y, size.x, size.y)))
    }

    /// Draws a picture; None where it was given up.
    #[pyo3(signature = (camera, size, *, part = None, steps_per_voxel = 1.0, samples = 1, jitter = false, haste = false, number = u64::MAX))]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are keywords in Python and options of one struct in the engine"
    )]
    fn draw(
        &self,
        py: Python<'_>,
        camera: GivenCamera,
        size: (u32, u32),
        part: Option<GivenPart>,
        steps_per_voxel: f32,
        samples: u32,
        jitter: bool,
        haste: bool,
        number: u64,
    ) -> Result<Option<PyPicture>, CoreError> {
        let camera = camera.checked()?;
        check_size(size)?;
        if !(0.01..=100.0).contains(&steps_per_voxel) {
            return Err(CoreError::value(format!(
                "steps_per_voxel {steps_per_voxel} given; allowed: 0.01 to 100"
            )));
        }
        let request = Request {
            camera,
            size,
            part: part.map(|part| checked_part(part, size)).transpose()?,
            steps_per_voxel,
            shift: (0.0, 0.0),
            noise: jitter.then_some(0),
            is_in_haste: haste,
            level: SimdLevel::widest(),
        };
        let picture = in_background(py, || {
            let stop = || self.newest.load(Relaxed) > number;
            self.lock().draw(&request, samples, &stop)
        })?;
        Ok(picture.map(|picture| PyPicture { picture }))
    }
}

impl PyRenderer {
    fn of(renderer: Result<Renderer, SceneError>) -> Result<Self, CoreError> {
        Ok(Self {
            renderer: Mutex::new(renderer?),
            displacements: Mutex::default(),
            newest: AtomicU64::new(0),
        })
    }

    /// Draws this from now on; whether anything has changed.
    fn take(&self, drawn: Drawn) -> bool {
        let mut renderer = self.lock();
        let has_edit = drawn.voxels.is_some_and(|voxels| renderer.follow(voxels));
        let mut known = self
            .displacements
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let both = known.iter().zip(&drawn.displacements);
        let is_same = known.len() == drawn.displacements.len()
            && both.into_iter().all(|(known, now)| Arc::ptr_eq(known, now));
        if !is_same {
            let given = drawn.displacements.iter().map(|now| Displacements {
                origin: now.origin,
                step: now.step,
                size: now.size,
                moved: &now.moved,
            });
            renderer.displace(&given.collect::<Vec<_>>());
            *known = drawn.displacements;
        }
        has_edit || !is_same
    }

    /// The renderer with the surfaces that a session shows, or while these are made with those before.
    fn lock_following(&self, session: &Session) -> Result<MutexGuard<'_, Renderer>, SessionError> {
        let surfaces = session.shown_surfaces()?;
        let mut renderer = self.lock();
        if let Some(surfaces) = surfaces {
            renderer.set_surfaces(surfaces.into_iter().map(surface_of).collect());
        }
        Ok(renderer)
    }

    fn lock(&self) -> MutexGuard<'_, Renderer> {
        // whatever a panic left is made anew with the next picture
        self.renderer.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl PySecondScan {
    #[new]
    fn new(
        py: Python<'_>,
        volume: &PyVolume,
        second_from_first: PyReadonlyArray2<'_, f64>,
    ) -> Result<Self, CoreError> {
        let place = affine(&second_from_first)?;
        let voxels = Voxels::new(volume.grid, volume.intensities.clone())?;
        let scan = Arc::new(parallel(py, || SecondScan::new(voxels, place))?);
        Ok(Self { scan })
    }

    /// The same scan elsewhere; reads nothing again.
    fn moved(&self, second_from_first: PyReadonlyArray2<'_, f64>) -> Result<Self, CoreError> {
        let scan = self.scan.moved(affine(&second_from_first)?);
        Ok(Self {
            scan: Arc::new(scan),
        })
    }
}

#[pymethods]
impl PyPicture {
    #[getter]
    fn size(&self) -> (u32, u32) {
        self.picture.size
    }

    /// Linear colour multiplied by opacity, and opacity; shape [rows, columns, 4].
    fn colours<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f32>> {
        let (columns, rows) = self.shape();
        let flat = self.picture.colours.as_flattened().to_vec();
        Array3::from_shape_vec((rows, columns, 4), flat)
            .expect("there is one colour per pixel")
            .to_pyarray(py)
    }

    /// Depth [mm], infinite where nothing is, negative where that of what is seen through; shape [rows, columns].
    fn depths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f32>> {
        let (columns, rows) = self.shape();
        Array2::from_shape_vec((rows, columns), self.picture.depths.clone())
            .expect("there is one depth per pixel")
            .to_pyarray(py)
    }

    /// The segment at each pixel, 0 of none; shape [rows, columns].
    fn segments<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<u8>> {
        let (columns, rows) = self.shape();
        Array2::from_shape_vec((rows, columns), self.picture.segments.clone())
            .expect("there is one segment per pixel")
            .to_pyarray(py)
    }

    /// sRGB with opacity as bytes, shape [rows, columns, 4].
    #[pyo3(signature = (ground = None, bends = true))]
    fn on_screen<'py>(
        &self,
        py: Python<'py>,
        ground: Option<(Colour, Colour)>,
        bends: bool,
    ) -> Bound<'py, PyArray3<u8>> {
        let (columns, rows) = self.shape();
        let ground = ground.map(|(centre, edge)| Ground {
            centre: centre.into(),
            edge: edge.into(),
        });
        let bytes = parallel(py, || self.picture.to_screen(ground, bends));
        Array3::from_shape_vec((rows, columns, 4), bytes.into_flattened())
            .expect("there are four bytes per pixel")
            .to_pyarray(py)
    }
}

impl PyPicture {
    fn shape(&self) -> (usize, usize) {
        let (columns, rows) = self.picture.size;
        (columns as usize, rows as usize)
    }
}

fn surface_of(shown: ShownSurfaceOfSession) -> SegmentSurface {
    SegmentSurface {
        id: shown.id.0,
        origin: shown.origin,
        pose: shown.pose,
        patches: shown.patches.into_iter().map(shared).collect(),
    }
}

fn shared(patch: Arc<Patch>) -> Arc<dyn Triangles> {
    Arc::new(SharedPatch(patch))
}

fn check_size(size: (u32, u32)) -> Result<(), CoreError> {
    let allowed = 1..=MOST_PIXELS;
    if allowed.contains(&size.0) && allowed.contains(&size.1) {
        return Ok(());
    }
    Err(CoreError::value(format!(
        "picture of {} × {} pixels given; allowed: 1 to {MOST_PIXELS} along each edge",
        size.0, size.1
    )))
}

fn checked_part(
    (column, row, columns, rows): GivenPart,
    size: (u32, u32),
) -> Result<Part, CoreError> {
    let part = Part {
        first: (column, row).into(),
        size: (columns, rows).into(),
    };
    if part.is_of(size) {
        return Ok(part);
    }
    Err(CoreError::value(format!(
        "part of {columns} × {rows} pixels from column {column} and row {row} on given; allowed: one within the picture that begins at a multiple of 4 columns and 8 rows"
    )))
}
