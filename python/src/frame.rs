//! Frames and segments as the dictionaries that the package reads.
//!
//! The keys of a frame are the fields of `protocol.State`, and three more: `notices`,
//! `segments_version` and `voxels_version`.

use glam::DVec3;
use palpate_engine::notice::{Notice, NoticeLevel};
use palpate_engine::picture::{ForceOff, Frame, Rates, Safety};
use palpate_engine::servo::ForceState;
use palpate_engine::simulation::SegmentState;
use palpate_engine::threads::Rate;
use palpate_engine::touch::TouchFeel;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::triple;
use crate::material::{deformation_dict, material_dict};
use crate::tool::{needle_dict, tool_dict};

/// Makes a dictionary of `name: value` pairs.
macro_rules! dictionary {
    ($py:expr, $($name:literal: $value:expr),* $(,)?) => {{
        let dictionary = PyDict::new($py);
        $(dictionary.set_item(pyo3::intern!($py, $name), $value)?;)*
        Ok(dictionary)
    }};
}

pub(crate) use dictionary;

/// All of a frame.
pub fn frame_dict<'py>(py: Python<'py>, frame: &Frame) -> PyResult<Bound<'py, PyDict>> {
    let samples = frame.samples.iter().map(|sample| {
        let DVec3 { x, y, z } = sample.force;
        (sample.time, x, y, z)
    });
    dictionary!(py,
        "tick": frame.tick,
        "time": frame.time,
        "edit": frame.edit,
        "device": triple(frame.device),
        "hand": triple(frame.hand),
        "proxy": triple(frame.proxy),
        "contact_point": triple(frame.contact_point),
        "normal": triple(frame.normal),
        "force": triple(frame.force),
        "contact": frame.contact,
        "depth": frame.depth,
        "touched": frame.touched,
        "probe_radius": frame.probe_radius,
        "poses": frame.poses.iter().map(|pose| pose_dict(py, *pose)).collect::<PyResult<Vec<_>>>()?,
        "grabbed": frame.grabbed,
        "clutched": frame.clutched,
        "device_origin": triple(frame.device_origin),
        "pending": frame.pending,
        "can_undo": frame.can_undo,
        "can_redo": frame.can_redo,
        "step": frame.step,
        "steps_made": frame.steps_made,
        "tool": tool_dict(py, frame)?,
        "needle": needle_dict(py, &frame.needle)?,
        "matter": deformation_dict(py, &frame.matter)?,
        "rates": rates_dict(py, &frame.rates)?,
        "safety": safety_dict(py, frame.safety)?,
        "recording": frame.recording,
        "samples": samples.collect::<Vec<_>>(),
        "segments_version": frame.segments_version,
        "voxels_version": frame.voxels_version,
        "notices": frame.notices.iter().map(notice_pair).collect::<Vec<_>>(),
    )
}

/// One segment.
pub fn segment_dict<'py>(py: Python<'py>, segment: &SegmentState) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "id": segment.id.0,
        "voxels": segment.voxels,
        "volume": segment.volume,
        "grid": segment.own_grid.map(|grid| rows_of(grid.patient_from_grid())),
        "bounds": segment.bounds.map(|bounds| (bounds.min.to_array(), bounds.max.to_array())),
        "touchable": segment.touchable,
        "locked": segment.locked,
        "pending": segment.pending,
        "range": segment.range,
        "made_by": segment.made_by,
        "feel": feel_dict(py, segment.feel)?,
        "material": segment.law.map(|law| material_dict(py, &law)).transpose()?,
        "pose": segment.pose.map(rows_of),
    )
}

fn pose_dict(py: Python<'_>, (id, pose): (u8, glam::DAffine3)) -> PyResult<Bound<'_, PyDict>> {
    dictionary!(py, "id": id, "pose": rows_of(pose))
}

/// A homogeneous matrix by rows, sixteen numbers.
fn rows_of(transform: glam::DAffine3) -> Vec<f64> {
    glam::DMat4::from(transform)
        .transpose()
        .to_cols_array()
        .to_vec()
}

fn feel_dict(py: Python<'_>, feel: TouchFeel) -> PyResult<Bound<'_, PyDict>> {
    dictionary!(py,
        "stiffness": feel.stiffness,
        "friction_static": feel.friction_static,
        "friction_kinetic": feel.friction_kinetic,
    )
}

/// How late the ticks of each thread began.
pub fn lateness_dict<'py>(py: Python<'py>, rates: &Rates) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "device": thread_dict(py, &rates.device)?,
        "servo": thread_dict(py, &rates.servo)?,
        "simulation": thread_dict(py, &rates.simulation)?,
        "picture": thread_dict(py, &rates.picture)?,
    )
}

fn thread_dict<'py>(py: Python<'py>, rate: &Rate) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "asked_hz": rate.asked_hz,
        "hz": rate.hz,
        "ticks": rate.ticks,
        "late": rate.late,
        "missed": rate.missed,
        "worst_late_ms": rate.worst_late_ms,
        "worst_ever_ms": rate.worst_ever_ms,
        "lateness": rate.lateness.to_vec(),
        "lateness_bins_us": palpate_engine::threads::LATENESS_BINS_US.to_vec(),
    )
}

fn rates_dict<'py>(py: Python<'py>, rates: &Rates) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "device": rate_dict(py, &rates.device)?,
        "servo": rate_dict(py, &rates.servo)?,
        "simulation": rate_dict(py, &rates.simulation)?,
        "picture": rate_dict(py, &rates.picture)?,
        "real_time": rates.real_time,
    )
}

fn rate_dict<'py>(py: Python<'py>, rate: &Rate) -> PyResult<Bound<'py, PyDict>> {
    dictionary!(py,
        "asked_hz": rate.asked_hz,
        "hz": rate.hz,
        "ticks": rate.ticks,
        "late": rate.late,
        "worst_late_ms": rate.worst_late_ms,
    )
}

fn safety_dict(py: Python<'_>, safety: Safety) -> PyResult<Bound<'_, PyDict>> {
    dictionary!(py,
        "clamped": safety.clamped,
        "slewed": safety.slewed,
        "not_finite": safety.not_finite,
        "ramped": safety.ramped,
        "waited": safety.waited,
        "eased": safety.eased,
        "damped": safety.damped,
        "watchdog": safety.watchdog,
        "violations": safety.violations,
        "force": force_state(safety.force),
        "off": safety.off.map(ForceOff::name),
    )
}

fn force_state(state: ForceState) -> &'static str {
    match state {
        ForceState::On => "on",
        ForceState::Waiting => "waiting",
        ForceState::Ramping => "ramping",
        ForceState::Easing => "easing",
        ForceState::Off => "off",
    }
}

fn notice_pair(notice: &Notice) -> (&'static str, &str) {
    let level = match notice.level {
        NoticeLevel::Info => "info",
        NoticeLevel::Warning => "warning",
        NoticeLevel::Error => "error",
    };
    (level, &notice.text)
}
