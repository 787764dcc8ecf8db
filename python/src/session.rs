//! `_core.Session`: a scan that is touched with a device.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use glam::IVec3;
use numpy::PyReadonlyArray2;
use palpate_engine::scene::{Properties, SurfaceOptions, SurfaceSource};
use palpate_engine::session::{Session, SessionConfig};
use palpate_engine::touch::{Settings, ThresholdRange, TouchFeel};
use palpate_tools::journal::ScanHash;
use palpate_volume::clip::Plane;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::{Triple, affine, triple, vector};
use crate::device::{device_named, path_samples};
use crate::errors::CoreError;
use crate::frame::{frame_dict, lateness_dict, segment_dict};
use crate::given_look::plane;
use crate::material::{
    LinearTuple, OptionsTuple, RegionTuple, SolidTuple, constant_material, deformation_dict,
    force_source, linear_material, material_named, model_options, parts_dict, region,
};
use crate::painted::{GivenLine, painted};
use crate::parallel::is_forked;
use crate::picture::{change_dict, voxels_dict};
use crate::recording::{recording_dict, tape_dict};
use crate::running::note;
use crate::segment::PySegment;
use crate::settings::{changed, settings_dict};
use crate::tool::{Event, event_tuple, tool_settings};
use crate::volume::PyVolume;

/// A segment to begin with: its voxels, whether it is an obstacle, the threshold that it is.
type FirstSegment<'py> = (PyRef<'py, PySegment>, bool, Option<ThresholdRange>);

/// The columns of a recording and of its tape.
type RecordingDicts<'py> = (Bound<'py, PyDict>, Option<Bound<'py, PyDict>>);

/// A voxel, (x, y, z).
type Voxel = (i32, i32, i32);

/// A running session.
#[pyclass(name = "Session", module = "palpate._core", frozen)]
pub struct PySession {
    pub session: Arc<Session>,
}

#[pymethods]
impl PySession {
    #[new]
    #[pyo3(signature = (volume, *, device = "simulated", path = None, rate_hz = 1000,
        device_rate_hz = None, real_time = true, start = None, settings = None, segments = Vec::new()))]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are keywords in Python and options of one struct in the engine"
    )]
    fn new(
        py: Python<'_>,
        volume: &PyVolume,
        device: &str,
        path: Option<PyReadonlyArray2<'_, f64>>,
        rate_hz: u32,
        device_rate_hz: Option<u32>,
        real_time: bool,
        start: Option<Triple>,
        settings: Option<&Bound<'_, PyDict>>,
        segments: Vec<FirstSegment<'_>>,
    ) -> PyResult<Self> {
        let path = path.as_ref().map(path_samples).transpose()?;
        let first_point = path.as_ref().and_then(|samples| samples.first());
        let first_point = first_point.map(|sample| sample.position);
        let (device, reference) = device_named(device, path)?;

        let mut config = SessionConfig::new(volume.grid, volume.intensities.clone(), device);
        config.reference = reference;
        config.start = start.map(vector).or(first_point);
        config.settings = changed(Settings::default(), settings)?;
        config.rate_hz = rate_hz;
        config.device_rate_hz = device_rate_hz;
        config.real_time = real_time;
        config.segments = segments
            .into_iter()
            .map(|(segment, touchable, range)| {
                (
                    segment.segment.clone(),
                    Properties::of_threshold(touchable, range),
                )
            })
            .collect();
        if is_forked() {
            return Err(PyRuntimeError::new_err(
                "a session was asked for in a process that was forked from one at work; allowed: in \
                 a process of its own, as multiprocessing.get_context('spawn') makes it",
            ));
        }
        let session = py.detach(|| Session::start(config));
        let session = Arc::new(session.map_err(CoreError::from)?);
        note(&session);
        Ok(Self { session })
    }

    #[getter]
    fn device(&self) -> &str {
        self.session.device_name()
    }

    /// The largest stiffness [N/mm] and force [N] that the device bears.
    #[getter]
    fn device_limits(&self) -> (f64, f64) {
        let limits = self.session.device_limits();
        (limits.max_stiffness, limits.max_force)
    }

    #[getter]
    fn is_running(&self) -> bool {
        self.session.is_running()
    }

    fn hand(&self, x: f64, y: f64, z: f64) -> Result<(), CoreError> {
        Ok(self.session.hand(vector((x, y, z)))?)
    }

    /// Presses with so much force [N] on what a ray of the scene meets first.
    fn press(&self, origin: Triple, direction: Triple, pressure: f64) -> Result<(), CoreError> {
        let (origin, direction) = (vector(origin), vector(direction));
        Ok(self.session.press(origin, direction, pressure)?)
    }

    fn lift(&self) -> Result<(), CoreError> {
        Ok(self.session.lift()?)
    }

    fn place(&self, py: Python<'_>, x: f64, y: f64, z: f64) -> Result<Triple, CoreError> {
        let placed = py.detach(|| self.session.place(vector((x, y, z))))?;
        Ok(triple(placed))
    }

    fn view(&self, py: Python<'_>, right: Triple, up: Triple) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.view(vector(right), vector(up)))?)
    }

    /// Cuts the scene for touch at planes, each a normal toward what is cut away and an offset [mm].
    fn set_clip(&self, py: Python<'_>, planes: Vec<(Triple, f64)>) -> Result<(), CoreError> {
        let planes = planes.into_iter().map(plane).collect();
        Ok(py.detach(|| self.session.set_clip(planes))?)
    }

    /// The planes that cut the scene for touch.
    fn clip(&self, py: Python<'_>) -> Result<Vec<(Triple, f64)>, CoreError> {
        let planes = py.detach(|| self.session.clip())?;
        let told = |plane: Plane| (triple(plane.normal), plane.offset);
        Ok(planes.into_iter().map(told).collect())
    }

    /// Changes the settings that are given by name; returns those that hold.
    #[pyo3(signature = (changes = None))]
    fn settings<'py>(
        &self,
        py: Python<'py>,
        changes: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let now = py
            .detach(|| self.session.settings())
            .map_err(CoreError::from)?;
        let wanted = changed(now, changes)?;
        let held = if wanted == now {
            now
        } else {
            py.detach(|| self.session.set_settings(wanted))
                .map_err(CoreError::from)?
        };
        settings_dict(py, held)
    }

    #[pyo3(signature = (segment, touchable, threshold_range = None, undoable = true))]
    fn add_segment(
        &self,
        py: Python<'_>,
        segment: &PySegment,
        touchable: bool,
        threshold_range: Option<ThresholdRange>,
        undoable: bool,
    ) -> Result<u8, CoreError> {
        let voxels = segment.segment.clone();
        let properties = Properties::of_threshold(touchable, threshold_range);
        let id = py.detach(|| self.session.add_segment(voxels, properties, undoable))?;
        Ok(id.0)
    }

    #[pyo3(signature = (segment_id, segment, threshold_range = None))]
    fn replace_segment(
        &self,
        py: Python<'_>,
        segment_id: u8,
        segment: &PySegment,
        threshold_range: Option<ThresholdRange>,
    ) -> Result<(), CoreError> {
        let voxels = segment.segment.clone();
        Ok(py.detach(|| {
            self.session
                .replace_segment(SegmentId(segment_id), voxels, threshold_range)
        })?)
    }

    fn remove_segment(&self, py: Python<'_>, segment_id: u8) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.remove_segment(SegmentId(segment_id)))?)
    }

    fn set_touchable(
        &self,
        py: Python<'_>,
        segment_id: u8,
        touchable: bool,
    ) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.set_touchable(SegmentId(segment_id), touchable))?)
    }

    /// Makes segments obstacles, or no obstacles, all at once.
    fn set_all_touchable(&self, py: Python<'_>, wanted: Vec<(u8, bool)>) -> Result<(), CoreError> {
        let wanted = wanted
            .into_iter()
            .map(|(id, touchable)| (SegmentId(id), touchable))
            .collect();
        Ok(py.detach(|| self.session.set_all_touchable(wanted))?)
    }

    fn set_locked(&self, py: Python<'_>, segment_id: u8, locked: bool) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.set_locked(SegmentId(segment_id), locked))?)
    }

    /// Changes how the surface of a segment feels; None is as the settings say.
    #[pyo3(signature = (segment_id, stiffness = None, friction_static = None,
        friction_kinetic = None))]
    fn set_feel(
        &self,
        py: Python<'_>,
        segment_id: u8,
        stiffness: Option<f64>,
        friction_static: Option<f64>,
        friction_kinetic: Option<f64>,
    ) -> Result<(), CoreError> {
        let feel = TouchFeel {
            stiffness,
            friction_static,
            friction_kinetic,
        };
        Ok(py.detach(|| self.session.set_feel(SegmentId(segment_id), feel))?)
    }

    /// Moves a segment to a pose, a homogeneous matrix, shape [4, 4] [mm]; where it `goes_on` the
    /// next move belongs to the same step of undo.
    #[pyo3(signature = (segment_id, pose, goes_on = false))]
    fn move_segment(
        &self,
        py: Python<'_>,
        segment_id: u8,
        pose: PyReadonlyArray2<'_, f64>,
        goes_on: bool,
    ) -> Result<(), CoreError> {
        let (id, pose) = (SegmentId(segment_id), affine(&pose)?);
        Ok(py.detach(|| match goes_on {
            true => self.session.drag_segment(id, pose),
            false => self.session.move_segment(id, pose),
        })?)
    }

    fn clutch(&self, py: Python<'_>, on: bool) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.clutch(on))?)
    }

    /// Radius of the ball that the device reaches [device mm].
    #[getter]
    fn device_reach(&self) -> f64 {
        self.session.device_limits().workspace_radius
    }

    /// Takes a segment in the hand, or lets go of the one that is.
    #[pyo3(signature = (segment_id = None, collides = false))]
    fn grab(
        &self,
        py: Python<'_>,
        segment_id: Option<u8>,
        collides: bool,
    ) -> Result<(), CoreError> {
        let id = segment_id.map(SegmentId);
        Ok(py.detach(|| self.session.grab(id, collides))?)
    }

    /// Turns the segment in the hand about the probe by a rotation vector [rad].
    fn turn_grabbed(&self, py: Python<'_>, x: f64, y: f64, z: f64) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.turn_grabbed(vector((x, y, z))))?)
    }

    /// Parts a segment by a plane; returns the number of the part before it.
    fn cut(
        &self,
        py: Python<'_>,
        segment_id: u8,
        point: Triple,
        normal: Triple,
    ) -> Result<u8, CoreError> {
        let (point, normal) = (vector(point), vector(normal));
        let cut = py.detach(|| self.session.cut(SegmentId(segment_id), point, normal));
        Ok(cut?.0)
    }

    /// Parts a segment along a painted line; returns the number of the smaller part.
    fn cut_along(
        &self,
        py: Python<'_>,
        segment_id: u8,
        line: GivenLine<'_>,
    ) -> Result<u8, CoreError> {
        let painted = painted(&line)?;
        let cut = py.detach(|| self.session.cut_along(SegmentId(segment_id), &painted));
        Ok(cut?.0)
    }

    /// Volumes of the larger and the smaller part that `cut_along` would make [mm³].
    fn preview_cut(
        &self,
        py: Python<'_>,
        segment_id: u8,
        line: GivenLine<'_>,
    ) -> Result<[f64; 2], CoreError> {
        let painted = painted(&line)?;
        Ok(py.detach(|| self.session.preview_cut(SegmentId(segment_id), &painted))?)
    }

    /// Minimum and mean distance [mm] of one segment's surface to another, overlap [mm³].
    fn gap(&self, py: Python<'_>, from_id: u8, to_id: u8) -> Result<Triple, CoreError> {
        let gap = py.detach(|| self.session.gap(SegmentId(from_id), SegmentId(to_id)))?;
        Ok((gap.minimum, gap.mean, gap.overlap))
    }

    /// Makes a segment of a threshold of the scan as edited, or gives it to a segment.
    #[pyo3(signature = (low, high, segment_id = None))]
    fn threshold(
        &self,
        py: Python<'_>,
        low: f64,
        high: f64,
        segment_id: Option<u8>,
    ) -> Result<u8, CoreError> {
        let id = segment_id.map(SegmentId);
        Ok(py.detach(|| self.session.threshold(id, (low, high)))?.0)
    }

    /// Takes matter away: voxels of a mask get one stored value, and are in no segment any more.
    fn remove_matter(
        &self,
        py: Python<'_>,
        mask: &PySegment,
        stored: i16,
    ) -> Result<(), CoreError> {
        let mask = mask.segment.clone();
        Ok(py.detach(|| self.session.remove_matter(mask, stored))?)
    }

    /// The voxels that a range of values makes of the scan, as edits have left it.
    fn as_edited(
        &self,
        py: Python<'_>,
        made: &PySegment,
        low: f64,
        high: f64,
    ) -> Result<PySegment, CoreError> {
        let segment = py.detach(|| self.session.as_edited(&made.segment, (low, high)))?;
        Ok(PySegment { segment })
    }

    /// Makes the voxels from `low` up to, but without, `high` solid or free in one segment.
    fn fill_box(
        &self,
        py: Python<'_>,
        segment_id: u8,
        low: Voxel,
        high: Voxel,
        solid: bool,
    ) -> Result<(), CoreError> {
        let (low, high) = (IVec3::from(low), IVec3::from(high));
        Ok(py.detach(|| {
            self.session
                .fill_box(SegmentId(segment_id), low, high, solid)
        })?)
    }

    /// Shows a segment as a surface: smoothing degree and step [voxels] of its cells, and
    /// whether it is made from bits although a threshold made the segment.
    #[pyo3(signature = (segment_id, *, smoothing, step = 1, of_bits = false))]
    fn show_surface(
        &self,
        py: Python<'_>,
        segment_id: u8,
        smoothing: u8,
        step: u8,
        of_bits: bool,
    ) -> Result<(), CoreError> {
        let source = if of_bits {
            SurfaceSource::Bits
        } else {
            SurfaceSource::Intensities
        };
        let making = SurfaceOptions::new(smoothing, step, source);
        Ok(py.detach(|| {
            self.session
                .show_surface(SegmentId(segment_id), Some(making))
        })?)
    }

    fn hide_surface(&self, py: Python<'_>, segment_id: u8) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.show_surface(SegmentId(segment_id), None))?)
    }

    /// Has the picture follow edits every so many-th of its frames, 1 to 4.
    fn follow_edits(&self, every: u32) {
        self.session.follow_edits(every);
    }

    /// Names the segments whose labels edits tell, the last of several on top.
    fn set_labelled(&self, py: Python<'_>, segment_ids: Vec<u8>) -> Result<(), CoreError> {
        let labelled = segment_ids.into_iter().map(SegmentId).collect();
        Ok(py.detach(|| self.session.set_labelled(labelled))?)
    }

    /// Waits until the picture has changed more than `heard` times, at most so many seconds;
    /// gives how often it has.
    fn wait_for_changes(&self, py: Python<'_>, heard: u64, seconds: f64) -> u64 {
        let patience = Duration::from_secs_f64(seconds.clamp(0.0, 10.0));
        py.detach(|| self.session.wait_for_changes(heard, patience))
    }

    /// What changed in the picture since the call before.
    fn picture_changes<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let changes = self.session.picture_changes();
        changes
            .iter()
            .map(|change| change_dict(py, change))
            .collect()
    }

    /// Stored values at rest of a box around all tissue that tools press; none where none is pressed.
    fn values_at_rest<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let values = py.detach(|| self.session.values_at_rest());
        let values = values.map_err(CoreError::from)?;
        values.map(|values| voxels_dict(py, &values)).transpose()
    }

    /// All surfaces as they are now.
    fn whole_surfaces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let whole = py.detach(|| self.session.whole_surfaces());
        change_dict(py, &whole)
    }

    /// Chooses the tool for the next strokes by its name; none empties the hand.
    #[pyo3(signature = (kind, *, radius = 0.0, segment_ids = Vec::new(), air = None,
        energy = None, tissues = Vec::new(), paint = (None, false)))]
    #[expect(
        clippy::too_many_arguments,
        reason = "the binding takes one type per argument"
    )]
    fn set_tool(
        &self,
        py: Python<'_>,
        kind: Option<&str>,
        radius: f64,
        segment_ids: Vec<u8>,
        air: Option<f64>,
        energy: Option<f64>,
        tissues: Vec<[f64; 8]>,
        paint: (Option<f64>, bool),
    ) -> Result<(), CoreError> {
        let settings =
            kind.map(|kind| tool_settings(kind, radius, segment_ids, air, energy, tissues, paint));
        let settings = settings.transpose()?;
        Ok(py.detach(|| self.session.set_tool(settings))?)
    }

    /// Chooses the model of soft tissue by its name; none makes all matter hard.
    fn set_deformation(
        &self,
        py: Python<'_>,
        model: Option<String>,
        options: OptionsTuple,
        undoable: bool,
    ) -> Result<(), CoreError> {
        let options = model_options(options)?;
        Ok(py.detach(|| self.session.set_deformation(model, options, undoable))?)
    }

    /// Tells what a segment is made of: by name, by constants, or linear in HU; else it is hard.
    #[pyo3(signature = (segment_id, undoable, *, name = None, constant = None, linear = None))]
    fn set_material(
        &self,
        py: Python<'_>,
        segment_id: u8,
        undoable: bool,
        name: Option<&str>,
        constant: Option<SolidTuple>,
        linear: Option<LinearTuple>,
    ) -> Result<(), CoreError> {
        let law = match (name, constant, linear) {
            (Some(name), _, _) => Some(material_named(name)?),
            (None, Some(constant), _) => Some(constant_material(constant)?),
            (None, None, Some(linear)) => Some(linear_material(linear)?),
            (None, None, None) => None,
        };
        let id = SegmentId(segment_id);
        Ok(py.detach(|| self.session.set_material(id, law, undoable))?)
    }

    /// Tells how regions of a segment take part: treatment, box of voxels, other segment.
    fn set_regions(
        &self,
        py: Python<'_>,
        segment_id: u8,
        regions: Vec<RegionTuple>,
    ) -> Result<(), CoreError> {
        let regions = regions.into_iter().map(region).collect::<Result<_, _>>()?;
        Ok(py.detach(|| self.session.set_regions(SegmentId(segment_id), regions))?)
    }

    /// Chooses what a tool feels of soft tissue, by name.
    fn set_force_source(&self, py: Python<'_>, source: &str) -> Result<(), CoreError> {
        let source = force_source(source)?;
        Ok(py.detach(|| self.session.set_force_source(source))?)
    }

    fn deformation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let now = py.detach(|| self.session.deformation());
        deformation_dict(py, &now.map_err(CoreError::from)?)
    }

    /// What happened to the needle since it was taken in the hand.
    fn needle_events(&self, py: Python<'_>) -> Result<Vec<Event>, CoreError> {
        let report = py.detach(|| self.session.needle_report())?;
        Ok(report.events.iter().map(event_tuple).collect())
    }

    /// Sets the direction in which the needle goes in, inward; None for that of the push.
    fn set_needle_direction(
        &self,
        py: Python<'_>,
        direction: Option<Triple>,
    ) -> Result<(), CoreError> {
        let direction = direction.map(vector);
        Ok(py.detach(|| self.session.set_needle_direction(direction))?)
    }

    /// Takes the needle out on the way that it went in; False where none is in.
    fn withdraw_needle(&self, py: Python<'_>) -> Result<bool, CoreError> {
        Ok(py.detach(|| self.session.withdraw_needle())?)
    }

    fn show_model_parts(&self, on: bool) {
        self.session.show_model_parts(on);
    }

    /// The parts of the model that were not given before, or None.
    fn model_parts<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let parts = py.detach(|| self.session.model_parts());
        parts.map(|parts| parts_dict(py, &parts)).transpose()
    }

    fn stroke(&self, py: Python<'_>, on: bool) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.stroke(on))?)
    }

    /// How many steps a journal holds and how many bytes of it are lost; None without a file.
    fn look_at_journal(
        &self,
        py: Python<'_>,
        path: PathBuf,
        scan_hash: [u8; 32],
    ) -> Result<Option<(usize, u64)>, CoreError> {
        let kept = py.detach(|| self.session.inspect_journal(path, ScanHash(scan_hash)))?;
        Ok(kept.map(|kept| (kept.steps, kept.ignored_bytes)))
    }

    fn begin_journal(
        &self,
        py: Python<'_>,
        path: PathBuf,
        scan_hash: [u8; 32],
    ) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.begin_journal(path, ScanHash(scan_hash)))?)
    }

    fn keep_state(
        &self,
        py: Python<'_>,
        path: PathBuf,
        scan_hash: [u8; 32],
    ) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.keep_state(path, ScanHash(scan_hash)))?)
    }

    /// Steps, bytes that are lost, and notes of a journal that is followed.
    fn recover_journal<'py>(
        &self,
        py: Python<'py>,
        path: PathBuf,
        scan_hash: [u8; 32],
    ) -> Result<(usize, u64, Vec<Bound<'py, PyBytes>>), CoreError> {
        let found = py.detach(|| self.session.recover_journal(path, ScanHash(scan_hash)))?;
        let notes = found.notes.iter().map(|note| PyBytes::new(py, note));
        Ok((found.steps, found.ignored_bytes, notes.collect()))
    }

    fn note_in_journal(&self, py: Python<'_>, note: Vec<u8>) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.note_in_journal(note))?)
    }

    fn end_journal(&self, py: Python<'_>) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.end_journal())?)
    }

    fn undo(&self, py: Python<'_>) -> Result<bool, CoreError> {
        Ok(py.detach(|| self.session.undo())?)
    }

    fn redo(&self, py: Python<'_>) -> Result<bool, CoreError> {
        Ok(py.detach(|| self.session.redo())?)
    }

    fn segment(&self, py: Python<'_>, segment_id: u8) -> Result<PySegment, CoreError> {
        let segment: Segment = py.detach(|| self.session.segment(SegmentId(segment_id)))?;
        Ok(PySegment { segment })
    }

    fn segments_state<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let segments = py
            .detach(|| self.session.segments())
            .map_err(CoreError::from)?;
        segments
            .iter()
            .map(|segment| segment_dict(py, segment))
            .collect()
    }

    fn frame<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let frame = py.detach(|| self.session.frame());
        frame_dict(py, &frame)
    }

    /// How late the ticks of each thread began since the start.
    fn lateness<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let rates = py.detach(|| self.session.rates());
        lateness_dict(py, &rates)
    }

    fn start_recording(&self, py: Python<'_>) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.start_recording())?)
    }

    /// The columns of the ticks, and those of what else a replay needs, or None.
    fn stop_recording<'py>(&self, py: Python<'py>) -> PyResult<RecordingDicts<'py>> {
        let (recording, tape) = py
            .detach(|| self.session.finish_recording())
            .unwrap_or_default();
        let tape = tape.map(|tape| tape_dict(py, &tape)).transpose()?;
        Ok((recording_dict(py, recording)?, tape))
    }

    fn run(&self, py: Python<'_>, seconds: f64) -> Result<(), CoreError> {
        Ok(py.detach(|| self.session.run(seconds))?)
    }

    fn stop(&self, py: Python<'_>) {
        py.detach(|| self.session.stop());
    }
}
